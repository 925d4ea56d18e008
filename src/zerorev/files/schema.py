"""The form of a job file: a robot, a tool, holes, and how they are to be drilled; in millimetres and degrees.

Each field's description says what is accepted; error messages (`zerorev.files.validation`) and the published JSON
Schemas (docs/schemas) both show it.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Discriminator, Field, Tag, model_validator

from zerorev.files.body_schema import MOST_SOLIDS, ObstacleForm, PartForm
from zerorev.files.cad.select_form import SelectForm
from zerorev.files.kuka_frames import with_direction
from zerorev.files.robot_schema import GivenFrameForm, GivenToolForm
from zerorev.files.stated_forms import Form, keys_of, kind
from zerorev.files.values import (
    MOST_HOLES,
    MOST_TOOLS,
    AnglesDeg,
    Branch,
    Depth,
    Id,
    Length,
    Name,
    PlaceMm,
    Positive,
    SpinsDeg,
    StandoffsMm,
    Three,
)
from zerorev.model.controller import CALL, HEADER_LINE
from zerorev.model.cycle import Cycle
from zerorev.model.settings import Settings

__all__ = ["ColumnsForm", "HoleForm", "JobFile", "SettingsForm", "ToolUseForm"]

CallTexts = Annotated[list[Name], Field(max_length=20)]


class ExternalAxisForm(Form):
    """An axis besides the robot's six."""

    name: Literal["E1", "E2", "E3", "E4", "E5", "E6"] = Field(description="E1 to E6")
    at: Length = Field(description="a number [mm or deg]: where it stands, as the controller shows it")


class CallsForm(Form):
    """Programs of the controller that are called where the robot stands still."""

    before_job: CallTexts = Field(default=[], description=f"a list of calls before the first move; each {CALL}")
    before_hole: CallTexts = Field(
        default=[], description=f"a list of calls at the first point of each hole; each {CALL}"
    )
    after_hole: CallTexts = Field(
        default=[], description=f"a list of calls at the last point of each hole; each {CALL}"
    )
    after_job: CallTexts = Field(default=[], description=f"a list of calls after the last move; each {CALL}")


@keys_of(Cycle)
class CycleForm(Form):
    """How a hole is drilled."""


@keys_of(Settings)
class SettingsForm(Form):
    """How to plan and how to run the motion."""

    robroot: (
        Annotated[Annotated[Name, Tag("<text>")] | Annotated[GivenFrameForm, Tag("<mapping>")], Discriminator(kind)]
        | None
    ) = Field(
        default=None,
        description="text: the variable that says where the robot's own base stands in the controller's world, "
        "e.g. $ROBROOT; or a mapping of xyz_mm and rpy_deg, or of KUKA's x, y, z, a, b, c: that frame; or null: one",
    )
    external_axes: Annotated[list[ExternalAxisForm], Field(max_length=6)] = Field(
        default=[],
        description="a list of name and at: where axes besides the robot's six stand, e.g. {name: E1, at: 1500}",
    )
    calls: CallsForm = Field(
        default=CallsForm(),
        description="a mapping of before_job, before_hole, after_hole and after_job to lists of calls",
    )
    header: Annotated[list[Name], Field(max_length=20)] = Field(
        default=[], description=f"a list of lines that go before the program; each {HEADER_LINE}"
    )
    cycle: CycleForm = Field(
        default=CycleForm(),
        description="a mapping of kind, depth_mm, back_mm and dwell_s: how each hole is drilled that does not say so "
        "itself",
    )


def _with_direction_of_a_frame(schema: dict[str, Any]) -> None:
    """The published form of a hole has a direction, or the angles of a frame."""
    schema["required"].remove("direction")
    schema["anyOf"] = [{"required": ["direction"]}, {"required": ["abc_deg", "drill_axis"]}]


class HoleForm(Form):
    """One hole of a job, in the part frame."""

    model_config = ConfigDict(json_schema_extra=_with_direction_of_a_frame)

    id: Id = Field(description="text or a whole number: how the hole is called; one line, 1 to 100 characters")
    target_mm: PlaceMm = Field(description="three numbers [mm]: bottom of the stroke, part frame")
    direction: Three = Field(description="three numbers, not all 0: into the material, part frame, of any length")
    abc_deg: AnglesDeg | None = Field(
        default=None,
        description="three numbers [deg], in place of direction: KUKA's A, B, C of the hole's frame, part frame; "
        "drill_axis beside it says which axis of that points into the material",
    )
    drill_axis: Literal["x", "z"] | None = Field(
        default=None,
        description="x or z: which axis of the frame of abc_deg points into the material; in place of direction",
    )
    depth_mm: Depth | None = Field(
        default=None, description="a number above 0 [mm]: the stroke; zerorev depth alone does without it"
    )
    psi_deg: SpinsDeg | None = Field(
        default=None,
        description="three numbers [deg]: spins at start, target and end of a motion to be evaluated, not searched; "
        "or more, with standoff_mm beside them",
    )
    standoff_mm: StandoffsMm | None = Field(
        default=None,
        description="as many numbers [mm] as psi_deg: stand-offs in order of motion, falling from depth_mm to the "
        "target, drawn back on the way by 2 mm at most to break chips, then strictly rising to depth_mm; left out, "
        "they are depth_mm, 0, depth_mm",
    )
    branch: Branch | None = Field(
        default=None,
        description="a whole number from 0 to 7: the IK branch of the given motion, or the only one to search",
    )
    group: Id | None = Field(
        default=None, description="text or a whole number: with which it is drilled where the order is by groups"
    )
    cycle: CycleForm | None = Field(
        default=None,
        description="a mapping of kind, depth_mm, back_mm and dwell_s: how it is drilled; or null: as the job says",
    )

    @model_validator(mode="before")
    @classmethod
    def _direction(cls, data: Any) -> Any:
        return with_direction(data)


class ColumnsForm(Form):
    """How a CSV file of holes calls its columns, where it does not call them so."""

    id: Name | None = Field(default=None, description="text: the column of the ids")
    x_mm: Name | None = Field(default=None, description="text: the column of the point's x")
    y_mm: Name | None = Field(default=None, description="text: the column of the point's y")
    z_mm: Name | None = Field(default=None, description="text: the column of the point's z")
    i: Name | None = Field(default=None, description="text: the column of the direction's x")
    j: Name | None = Field(default=None, description="text: the column of the direction's y")
    k: Name | None = Field(default=None, description="text: the column of the direction's z")
    depth_mm: Name | None = Field(default=None, description="text: the column of the depth")
    entry_x_mm: Name | None = Field(default=None, description="text: the column of the entry point's x")
    entry_y_mm: Name | None = Field(default=None, description="text: the column of the entry point's y")
    entry_z_mm: Name | None = Field(default=None, description="text: the column of the entry point's z")
    exit_x_mm: Name | None = Field(default=None, description="text: the column of the exit point's x")
    exit_y_mm: Name | None = Field(default=None, description="text: the column of the exit point's y")
    exit_z_mm: Name | None = Field(default=None, description="text: the column of the exit point's z")
    branch: Name | None = Field(default=None, description="text: the column of the only IK branch to search")
    group: Name | None = Field(default=None, description="text: the column of the groups")


class FeedMmMinForm(Form):
    """Feeds of the tip."""

    plunge: Annotated[Length, Field(gt=0)] = Field(description="a number above 0 [mm/min]: feed of the plunge")
    retract: Annotated[Length, Field(gt=0)] = Field(description="a number above 0 [mm/min]: feed of the retract")


AnyTool = Annotated[Annotated[Name, Tag("<text>")] | Annotated[GivenToolForm, Tag("<mapping>")], Discriminator(kind)]


class ToolFeedsForm(Form):
    """Feeds of one of several tools."""

    plunge: Positive | None = Field(default=None, description="a number above 0 [mm/s]; or null: the job's")
    retract: Positive | None = Field(default=None, description="a number above 0 [mm/s]; or null: the job's")


class ToolUseForm(Form):
    """One of several tools, and how it drills."""

    tool: AnyTool = Field(
        description="a name that ships with zerorev, the path of a tool file, or a mapping of tcp_mm and rpy_deg"
    )
    tool_number: Annotated[int, Field(ge=1, le=16)] | None = Field(
        default=None, description="a whole number from 1 to 16: on the controller; or null: none is set"
    )
    depth_mm: Depth | None = Field(
        default=None, description="a number above 0 [mm]: its stroke in each hole; or null: that of the hole"
    )
    feed_mm_s: ToolFeedsForm = Field(default=ToolFeedsForm(), description="a mapping of plunge and retract [mm/s]")
    cycle: CycleForm | None = Field(
        default=None, description="a mapping of kind, depth_mm and back_mm: how it drills; or null: as hole or job say"
    )


def _with_tool_or_tools(schema: dict[str, Any]) -> None:
    """The published form of a job has one tool or a list of them."""
    schema["anyOf"] = [{"required": ["tool"]}, {"required": ["tools"]}]


class JobFile(SettingsForm):
    """A job file, YAML: a robot, a tool, holes, and how they are to be drilled."""

    model_config = ConfigDict(title="zerorev job", json_schema_extra=_with_tool_or_tools)

    format: Literal["zerorev.job/1"] = Field(default="zerorev.job/1", description="zerorev.job/1")
    name: Name | None = Field(default=None, description="text: names the program; left out, it is the file's name")
    robot: Name = Field(description="text: a name that ships with zerorev, or the path of a robot file")
    tool: AnyTool | None = Field(
        default=None,
        description="a name that ships with zerorev, the path of a tool file, or a mapping of tcp_mm and rpy_deg",
    )
    tools: Annotated[list[ToolUseForm], Field(min_length=1, max_length=MOST_TOOLS)] | None = Field(
        default=None,
        description="in place of tool: a list of the tools that drill all holes one after the other, each a mapping of "
        "tool, tool_number, depth_mm, feed_mm_s and cycle; what is left out is the job's",
    )
    part_frame: GivenFrameForm = Field(
        default=GivenFrameForm(),
        description="a mapping of xyz_mm and rpy_deg, or of KUKA's x, y, z, a, b, c: the part frame in the base frame",
    )
    psi_reference: Annotated[
        Annotated[Literal["base_y", "nearest_base", "part_x", "part_y"], Tag("<text>")]
        | Annotated[Three, Tag("<list>")],
        Discriminator(kind),
    ] = Field(
        default="base_y",
        description="base_y, nearest_base, part_x, part_y, or three numbers (a vector in the part frame): "
        "the direction of Y_tcp at psi = 0",
    )
    holes: Annotated[
        Annotated[list[HoleForm], Field(min_length=1, max_length=MOST_HOLES, fail_fast=True), Tag("<list>")]
        | Annotated[Name, Tag("<text>")],
        Discriminator(kind),
    ] = Field(
        description="a list of one hole or more, or the path of a CSV file with the columns "
        "id,x_mm,y_mm,z_mm,i,j,k,depth_mm, or of a STEP or DXF file (.step, .stp, .dxf)"
    )
    select: SelectForm | None = Field(
        default=None,
        description="a mapping of id, kind, diameter_mm, solid, face_mm, layers, side: which holes of a CAD file are "
        "drilled, and from where; left out: all",
    )
    part: (
        Annotated[Annotated[Name, Tag("<text>")] | Annotated[PartForm, Tag("<mapping>")], Discriminator(kind)] | None
    ) = Field(
        default=None,
        description="text: the path of an STL, OBJ, PLY, GLB or STEP file with the shape of the part, in the part "
        "frame; or a mapping of file and unit",
    )
    fixtures: Annotated[list[ObstacleForm], Field(max_length=MOST_SOLIDS)] = Field(
        default=[],
        description="a list of solids that stand around: id, and box, or file with xyz_mm and rpy_deg; in the base "
        "frame, or with frame: part",
    )
    floor_mm: Length | None = Field(
        default=None, description="a number [mm]: height of the floor in the base frame; or null: none"
    )
    depth_mm: Depth | None = Field(
        default=None, description="a number above 0 [mm]: the stroke of each hole that has none of its own"
    )
    branch: Branch | None = Field(
        default=None, description="a whole number from 0 to 7: the only IK branch of each hole that names none"
    )
    normals: Literal["in", "out"] = Field(
        default="in", description="in or out: whether directions point into the material, or out of it"
    )
    point: Literal["bottom", "entry"] = Field(
        default="bottom",
        description="bottom or entry: whether targets are bottoms of strokes, or points where the drill enters; "
        "the bottom is then depth_mm further along the direction",
    )
    breakthrough_mm: Annotated[Length, Field(ge=0)] = Field(
        default=0.0,
        description="a number, 0 or more [mm]: how far the tip runs beyond the bottom of each hole, but of those that "
        "are blind in a STEP file",
    )
    feed_mm_rev: Annotated[Length, Field(gt=0)] | None = Field(
        default=None,
        description="a number above 0 [mm]: feed of the plunge for each turn of the spindle, in place of "
        "feed_mm_s.plunge; spindle_rpm beside it",
    )
    feed_mm_min: FeedMmMinForm | None = Field(
        default=None, description="a mapping of plunge and retract [mm/min], in place of feed_mm_s"
    )
    columns: ColumnsForm | None = Field(
        default=None,
        description="a mapping of columns to the names that a CSV file has for them, e.g. {x_mm: LOCX, y_mm: LOCY}",
    )
    unit: Literal["mm", "m", "in"] | None = Field(
        default=None,
        description="mm, m or in: of the lengths in a CSV file, but for columns whose name says mm; left out: mm. Of "
        "a CAD file in place of the unit that it states",
    )
    decimal: Literal["point", "comma"] | None = Field(
        default=None, description="point or comma: the decimal sign in a CSV file; left out, it is found"
    )
