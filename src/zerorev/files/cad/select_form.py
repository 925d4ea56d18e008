"""The form of `select` in a job: which holes of a CAD file are drilled, and what the file does not say of them."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Discriminator, Field, Tag

from zerorev.files.stated_forms import Form, kind
from zerorev.files.values import Depth, Id, Length, Name, PlaceMm, Three

__all__ = ["LayerForm", "SelectForm"]

MOST = 1_000  # entries of a list

Above = Annotated[Length, Field(gt=0)]
Side = Annotated[Annotated[Literal["robot"], Tag("<text>")] | Annotated[Three, Tag("<list>")], Discriminator(kind)]


class LayerForm(Form):
    """What a layer of a drawing means."""

    diameter_mm: Above | None = Field(
        default=None, description="a number above 0 [mm]: the diameter of its holes, in place of that of its circles"
    )
    depth_mm: Depth | None = Field(default=None, description="a number above 0 [mm]: how deep its holes are")
    direction: Three | None = Field(
        default=None, description="three numbers, not all 0: into the material, part frame, of any length"
    )


class SelectForm(Form):
    """Which holes of a CAD file are drilled."""

    id: Annotated[list[Id], Field(min_length=1, max_length=100_000, fail_fast=True)] | None = Field(
        default=None, description="a list of ids, as zerorev holes shows them: these holes alone"
    )
    kind: (
        Annotated[
            list[Literal["through", "blind", "countersunk", "counterbored", "circle", "point"]],
            Field(min_length=1, max_length=6),
        ]
        | None
    ) = Field(
        default=None,
        description="a list of through, blind, countersunk, counterbored, circle, point: holes that are one of them",
    )
    diameter_mm: Annotated[list[Above], Field(min_length=2, max_length=2)] | None = Field(
        default=None, description="two numbers above 0 [mm]: the least and the largest diameter"
    )
    solid: Annotated[list[Name], Field(min_length=1, max_length=MOST, fail_fast=True)] | None = Field(
        default=None, description="a list of solids of a STEP file, by the names that zerorev holes shows"
    )
    face_mm: Annotated[list[PlaceMm], Field(min_length=1, max_length=MOST, fail_fast=True)] | None = Field(
        default=None,
        description="a list of points [mm], part frame, each on a face of a STEP file: the holes that open in these "
        "faces, drilled from there",
    )
    layers: Annotated[dict[Name, LayerForm], Field(min_length=1, max_length=MOST)] | None = Field(
        default=None,
        description="a mapping of layers of a DXF file to diameter_mm, depth_mm and direction of their holes, {} where "
        "nothing is to be said: the holes on these layers alone",
    )
    side: Side | None = Field(
        default=None,
        description="robot, or three numbers (a vector in the part frame, out of the part): from where holes are "
        "drilled whose two ends are alike",
    )
