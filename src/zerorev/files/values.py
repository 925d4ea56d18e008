"""The values that may stand in files, whichever: how long a name may be, and how large a number."""

from __future__ import annotations

from typing import Annotated

from pydantic import AfterValidator, BeforeValidator, Field, WithJsonSchema

from zerorev.visible import one_line

__all__ = [
    "INERTIA", "MOST_BREAKPOINTS", "MOST_HOLES", "MOST_STROKES", "MOST_TOOLS", "Angle", "AnglesDeg", "Branch", "Depth",
    "Id", "Inertia", "Length", "Name", "NotNegative", "PlaceMm", "Positive", "SixDeg", "SixPositive", "SpinsDeg",
    "StandoffsMm", "StrokeName", "Three",
]  # fmt: skip

MOST_HOLES = 100_000
MOST_STROKES = 1_000  # of a hole
MOST_TOOLS = 20  # of a job
MOST_BREAKPOINTS = 10_000  # of a motion


def _id_text(value: object) -> object:
    return str(value) if isinstance(value, int) and not isinstance(value, bool) else value


_LINE = r"^[^\x00-\x1f\x7f]+$"
Name = Annotated[str, Field(min_length=1, max_length=100, pattern=_LINE), AfterValidator(one_line)]
StrokeName = Annotated[str, Field(min_length=1, max_length=120, pattern=_LINE), AfterValidator(one_line)]
Id = Annotated[Name, BeforeValidator(_id_text), WithJsonSchema({"type": ["string", "integer"]})]

# Far beyond any arm, and near enough that no number overflows and no search takes hours.
Length = Annotated[float, Field(ge=-1e6, le=1e6)]  # [mm]
Depth = Annotated[float, Field(gt=0, le=1e6)]  # [mm]
Angle = Annotated[float, Field(ge=-36_000, le=36_000)]  # [deg]
Positive = Annotated[float, Field(gt=0, le=1e12)]
NotNegative = Annotated[float, Field(ge=0, le=1e15)]

Three = Annotated[list[float], Field(min_length=3, max_length=3)]
PlaceMm = Annotated[list[Length], Field(min_length=3, max_length=3)]
AnglesDeg = Annotated[list[Angle], Field(min_length=3, max_length=3)]
SixDeg = Annotated[list[Angle], Field(min_length=6, max_length=6)]
SixPositive = Annotated[list[Positive], Field(min_length=6, max_length=6)]
StandoffsMm = Annotated[list[Length], Field(min_length=3, max_length=MOST_BREAKPOINTS, fail_fast=True)]
SpinsDeg = Annotated[list[Angle], Field(min_length=3, max_length=MOST_BREAKPOINTS, fail_fast=True)]
Branch = Annotated[int, Field(ge=0, le=7)]
Inertia = Annotated[list[Annotated[float, Field(ge=-1e9, le=1e9)]], Field(min_length=6, max_length=6)]
INERTIA = "six numbers [kg m^2]: xx, xy, xz, yy, yz, zz about the centre of mass"
