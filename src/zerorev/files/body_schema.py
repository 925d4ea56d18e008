"""The forms of solids: those that move with the arm, and those that stand around it; mm and degrees."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from zerorev.files.stated_forms import Form
from zerorev.files.values import AnglesDeg, Id, Length, Name, PlaceMm

__all__ = ["MOST_SOLIDS", "LinkBodyForm", "MeshForm", "ObstacleForm", "PartForm", "SolidForm", "SurroundingsForm",
           "ToolBodyForm"]  # fmt: skip

MOST_SOLIDS = 200
Above0 = Annotated[Length, Field(gt=0)]
Size = Annotated[list[Above0], Field(min_length=3, max_length=3)]
RPY = "three numbers [deg]: roll, pitch, yaw; R = Rz(yaw) Ry(pitch) Rx(roll)"
UNIT = "mm, m or in: of the lengths in an STL, OBJ, PLY or GLB file; left out: mm. A STEP file states its own"
FILE = "text: the path of an STL, OBJ, PLY, GLB or STEP file, which need not be closed"


class CapsuleForm(Form):
    """All points within a radius of a straight line."""

    from_mm: PlaceMm = Field(description="three numbers [mm]: where the line begins")
    to_mm: PlaceMm = Field(description="three numbers [mm]: where it ends")
    radius_mm: Above0 = Field(description="a number above 0 [mm]: the radius")


class BoxForm(Form):
    """A box."""

    size_mm: Size = Field(description="three numbers above 0 [mm]: along x, y and z of its own frame")
    xyz_mm: PlaceMm = Field(default=[0.0, 0.0, 0.0], description="three numbers [mm]: its centre")
    rpy_deg: AnglesDeg = Field(default=[0.0, 0.0, 0.0], description=RPY)


class MeshForm(Form):
    """Triangles as zerorev writes them into files of answers."""

    vertices: str = Field(description="text: single precision numbers [mm], compressed, in base 64")
    faces: str = Field(description="text: whole numbers of 32 bits, compressed, in base 64")


class SolidForm(Form):
    """What all solids have in common."""

    id: Id = Field(description="text or a whole number: how answers call it; one line, 1 to 100 characters")
    box: BoxForm | None = Field(default=None, description="a mapping of size_mm, xyz_mm (its centre) and rpy_deg")
    file: Name | None = Field(default=None, description=FILE)
    unit: Literal["mm", "m", "in"] | None = Field(default=None, description=UNIT)
    mesh: MeshForm | None = Field(default=None, description="a mapping of vertices and faces: a mesh of an answer")
    xyz_mm: PlaceMm = Field(default=[0.0, 0.0, 0.0], description="three numbers [mm]: the origin of the file's frame")
    rpy_deg: AnglesDeg = Field(default=[0.0, 0.0, 0.0], description=RPY)


class BodyForm(SolidForm):
    """A solid that moves with a link."""

    capsule: CapsuleForm | None = Field(default=None, description="a mapping of from_mm, to_mm and radius_mm")


class LinkBodyForm(BodyForm):
    """A solid on a link of the arm."""

    link: Annotated[int, Field(ge=0, le=6)] = Field(
        description="a whole number from 0, the base, to 6, the flange. The frame of link i lies on axis i and turns "
        "with it; with the arm straight up (model angles 0) all are parallel to the base frame"
    )


class ToolBodyForm(BodyForm):
    """A solid of the tool."""

    frame: Literal["flange", "tcp"] = Field(default="flange", description="flange or tcp: the frame it is given in")
    touches_part: bool = Field(
        default=False,
        description="true or false: whether it touches the part at a hole, as a drill and a pressure foot do: on a "
        "hole's own moves it is not held apart from the part, between holes drawn back by 1 mm",
    )


class ObstacleForm(SolidForm):
    """A solid that stands still."""

    frame: Literal["base", "part"] = Field(default="base", description="base or part: the frame it is given in")


class PartForm(Form):
    """The shape of the part."""

    file: Name | None = Field(default=None, description=FILE + "; in the part frame")
    mesh: MeshForm | None = Field(
        default=None, description="a mapping of vertices and faces, in place of file: a mesh of an answer"
    )
    unit: Literal["mm", "m", "in"] | None = Field(default=None, description=UNIT)


class SurroundingsForm(Form):
    """What stands around the arm, in a file of answers."""

    part: ObstacleForm | None = Field(default=None, description="a mapping: the part; or null: its shape is not known")
    fixtures: Annotated[list[ObstacleForm], Field(max_length=MOST_SOLIDS)] = Field(
        default=[], description="a list of solids"
    )
    floor_mm: Length | None = Field(default=None, description="a number [mm]: height of the floor; or null: none")
