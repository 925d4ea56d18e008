"""The form of a map file: where to drill, in which directions, and what to ask there; millimetres and degrees."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import ConfigDict, Discriminator, Field, Tag

from zerorev.files.robot_schema import ToolForm
from zerorev.files.schema import CycleForm
from zerorev.files.stated_forms import Form, keys_of, kind
from zerorev.files.values import Depth, Length, Name, Three
from zerorev.model.map_task import SETTINGS
from zerorev.model.quantity import in_words, quantities
from zerorev.model.settings import Settings

__all__ = [
    "MOST_CELLS",
    "ConeForm",
    "ConesForm",
    "MapFile",
    "MapSettingsForm",
    "RangeForm",
    "SphereForm",
    "TargetsForm",
]

MOST_CELLS = 100_000_000

if TYPE_CHECKING:
    QuantityName = str
else:
    QuantityName = Literal[tuple(quantities())]
Count = Annotated[int, Field(ge=1, le=100_000)]


class RangeForm(Form):
    """Evenly spaced values."""

    start: Length = Field(description="a number [mm]: the first")
    stop: Length = Field(description="a number [mm], start or more: the last, where a step meets it")
    step: Depth = Field(description="a number above 0 [mm]: from one to the next")


Axis = Annotated[
    Annotated[list[Length], Field(min_length=1, fail_fast=True), Tag("<list>")]
    | Annotated[RangeForm, Tag("<mapping>")],
    Discriminator(kind),
]
AXIS = "one number or more in a list, or a mapping of start, stop and step [mm]"


class TargetsForm(Form):
    """A plane, a box or a line of targets."""

    x_mm: Axis = Field(description=f"{AXIS}: X of the targets, base frame")
    y_mm: Axis = Field(description=f"{AXIS}: Y of the targets, base frame")
    z_mm: Axis = Field(description=f"{AXIS}: Z of the targets, base frame")


class ConeForm(Form):
    """Directions within a cone."""

    axis: Three = Field(description="three numbers, not all 0: the middle direction, base frame, of any length")
    half_angle_deg: Annotated[float, Field(gt=0, le=180)] = Field(
        description="a number above 0, 180 at most [deg]: from the axis to the rim"
    )
    count: Count = Field(description="a whole number, 1 or more: directions; the first is the axis")


class ConesForm(Form):
    """Directions given as a cone."""

    cone: ConeForm = Field(description="a mapping of axis, half_angle_deg and count")


class SphereForm(Form):
    """Directions all round."""

    sphere: Count = Field(description="a whole number, 1 or more: directions, spread evenly over the sphere")


def _directions(value: object) -> str | None:
    tag = kind(value)
    return ("<cone>" if "cone" in value else "<sphere>") if isinstance(value, dict) else tag


@keys_of(Settings, SETTINGS)
class MapSettingsForm(Form):
    """The settings that a map heeds."""

    cycle: CycleForm = Field(
        default=CycleForm(),
        description="a mapping of kind, depth_mm and back_mm: how the holes are drilled; a deepest stroke that breaks "
        "chips is the deepest that is found, not proven to be so",
    )


class MapFile(MapSettingsForm):
    """A map file, YAML: a robot, a tool, targets, directions, and what is asked of each."""

    model_config = ConfigDict(title="zerorev map")

    format: Literal["zerorev.map_file/1"] = Field(default="zerorev.map_file/1", description="zerorev.map_file/1")
    robot: Name = Field(description="text: a name that ships with zerorev, or the path of a robot file")
    tool: Annotated[Annotated[Name, Tag("<text>")] | Annotated[ToolForm, Tag("<mapping>")], Discriminator(kind)] = (
        Field(description="a name that ships with zerorev, the path of a tool file, or a mapping of tcp_mm and rpy_deg")
    )
    psi_reference: Annotated[
        Annotated[Literal["base_y", "nearest_base"], Tag("<text>")] | Annotated[Three, Tag("<list>")],
        Discriminator(kind),
    ] = Field(
        default="base_y",
        description="base_y, nearest_base, or three numbers (a vector in the base frame): the direction of Y_tcp at"
        " psi = 0",
    )
    targets: TargetsForm | None = Field(default=None, description="a mapping of x_mm, y_mm and z_mm; or points instead")
    points: Name | None = Field(
        default=None,
        description="the path of a CSV file with the columns id,x_mm,y_mm,z_mm; or targets instead",
    )
    directions: Annotated[
        Annotated[list[Three], Field(min_length=1), Tag("<list>")]
        | Annotated[ConesForm, Tag("<cone>")]
        | Annotated[SphereForm, Tag("<sphere>")],
        Discriminator(_directions),
    ] = Field(description="a list of vectors into the material, base frame; or a mapping of cone, or of sphere")
    quantity: QuantityName = Field(default="deepest", description=in_words(lambda each: True, "or"))
    depth_mm: Depth | None = Field(
        default=None,
        description=f"a number above 0 [mm]: the stroke; for {in_words(lambda each: each.needs_depth, 'and')} alone",
    )
    seed: Annotated[int, Field(ge=0, le=2**63 - 1)] | None = Field(
        default=None,
        description=f"a whole number, 0 or more: of the swarm; for {in_words(lambda each: each.seeded, 'and')} alone",
    )
