"""The forms of the files: what may stand in a robot, tool or job file, in millimetres and degrees.

Each field's description says what is accepted; error messages (`zerorev.files.validation`) and the published JSON
Schemas (docs/schemas) both show it.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    BeforeValidator,
    ConfigDict,
    Discriminator,
    Field,
    Tag,
    WithJsonSchema,
    model_validator,
)

from zerorev.files.kuka_frames import KEYS, in_own_keys, with_direction
from zerorev.files.stated_forms import Form, Many, Words, keys_of, kind
from zerorev.model.controller import CALL, HEADER_LINE
from zerorev.model.settings import Settings
from zerorev.visible import one_line

__all__ = [
    "MOST_BREAKPOINTS",
    "MOST_HOLES",
    "Angle",
    "ColumnsForm",
    "Depth",
    "DynamicsForm",
    "Form",
    "FrameForm",
    "GivenFrameForm",
    "GivenToolForm",
    "HoleForm",
    "JobFile",
    "Length",
    "Name",
    "NotNegative",
    "PlaceMm",
    "Positive",
    "Rate",
    "RobotFile",
    "RobotForm",
    "SettingsForm",
    "SpinBound",
    "Three",
    "ToolFile",
    "ToolForm",
    "Twist",
    "kind",
]  # fmt: skip

MOST_HOLES = 100_000
MOST_BREAKPOINTS = 10_000  # of a motion


def _id_text(value: object) -> object:
    return str(value) if isinstance(value, int) and not isinstance(value, bool) else value


Name = Annotated[str, Field(min_length=1, max_length=100, pattern=r"^[^\x00-\x1f\x7f]+$"), AfterValidator(one_line)]
Id = Annotated[Name, BeforeValidator(_id_text), WithJsonSchema({"type": ["string", "integer"]})]

# Far beyond any arm, and near enough that no number overflows and no search takes hours.
Length = Annotated[float, Field(ge=-1e6, le=1e6)]  # [mm]
Depth = Annotated[float, Field(gt=0, le=1e6)]  # [mm]
Angle = Annotated[float, Field(ge=-36_000, le=36_000)]  # [deg]
SpinBound = Annotated[float, Field(gt=0, le=3_600)]  # [deg]
Rate = Annotated[float, Field(ge=0, le=1e4)]  # [deg/mm]
Twist = Annotated[float, Field(gt=0, le=1e4)]  # [deg/mm]
Positive = Annotated[float, Field(gt=0, le=1e12)]
NotNegative = Annotated[float, Field(ge=0, le=1e15)]

Three = Annotated[list[float], Field(min_length=3, max_length=3)]
PlaceMm = Annotated[list[Length], Field(min_length=3, max_length=3)]
AnglesDeg = Annotated[list[Angle], Field(min_length=3, max_length=3)]
SixDeg = Annotated[list[Angle], Field(min_length=6, max_length=6)]
SixPositive = Annotated[list[Positive], Field(min_length=6, max_length=6)]
StandoffsMm = Annotated[list[Length], Field(min_length=3, max_length=MOST_BREAKPOINTS, fail_fast=True)]
SpinsDeg = Annotated[list[Angle], Field(min_length=3, max_length=MOST_BREAKPOINTS, fail_fast=True)]
SixSigns = Annotated[list[Annotated[int, Field(ge=-1, le=1)]], Field(min_length=6, max_length=6)]
Branch = Annotated[int, Field(ge=0, le=7)]
CallTexts = Annotated[list[Name], Field(max_length=20)]
Inertia = Annotated[list[Annotated[float, Field(ge=-1e9, le=1e9)]], Field(min_length=6, max_length=6)]
INERTIA = "six numbers [kg m^2]: xx, xy, xz, yy, yz, zz about the centre of mass"


# --- robot and tool ---------------------------------------------------------------------------------------------------


SOURCES = "a mapping of text to text: where the numbers come from"


def _with_keys_of_kuka(schema: dict[str, Any]) -> None:
    """The published form of a frame has the keys that are read in place of its own, too."""
    three = {"items": {"type": "number"}, "maxItems": 3, "minItems": 3, "type": "array"}
    for key, means in KEYS.items():
        schema["properties"][key] = {"description": means} | (three if key == "abc_deg" else {"type": "number"})


class FrameForm(Form):
    """A frame in the base frame."""

    xyz_mm: PlaceMm = Field(default=[0.0, 0.0, 0.0], description="three numbers [mm]: the origin, base frame")
    rpy_deg: AnglesDeg = Field(
        default=[0.0, 0.0, 0.0], description="three numbers [deg]: roll, pitch, yaw; R = Rz(yaw) Ry(pitch) Rx(roll)"
    )


class GivenFrameForm(FrameForm):
    """A frame in the base frame, as a user gives it: also as KUKA's controllers have it."""

    model_config = ConfigDict(json_schema_extra=_with_keys_of_kuka)

    @model_validator(mode="before")
    @classmethod
    def _own_keys(cls, data: Any) -> Any:
        return in_own_keys(data, "xyz_mm")


class GeometryForm(Form):
    """The seven lengths of Brandstoetter, Angerer, Hofbaur (2014), fig. 1."""

    a1: Length = Field(description="a number [mm]: shoulder forward of axis 1")
    a2: Length = Field(description="a number [mm]: elbow offset")
    b: Length = Field(description="a number [mm]: lateral offset")
    c1: Length = Field(description="a number [mm]: height of the shoulder")
    c2: Depth = Field(description="a number above 0 [mm]: upper arm")
    c3: Length = Field(description="a number [mm]: forearm")
    c4: Length = Field(description="a number [mm]: wrist centre to flange")


class JointsForm(Form):
    """The joints as the controller shows them; model angle = sign * controller angle - offset."""

    names: Annotated[list[Name], Field(min_length=6, max_length=6)] = Field(description="six names, e.g. A1 to A6")
    sign: Annotated[list[Annotated[int, Field(ge=-1, le=1)]], Field(min_length=6, max_length=6)] = Field(
        description="six of 1 or -1"
    )
    offset_deg: SixDeg = Field(description="six numbers [deg]")
    lower_deg: SixDeg = Field(description="six numbers [deg]: the lower joint limits")
    upper_deg: SixDeg = Field(description="six numbers [deg]: the upper joint limits")
    speed_deg_s: SixPositive = Field(description="six numbers above 0 [deg/s]: the greatest joint speeds")
    acceleration_deg_s2: SixPositive | None = Field(
        default=None,
        description="six numbers above 0 [deg/s^2]: the greatest joint accelerations; or null: guessed for times",
    )


class LinkForm(Form):
    """A link that moves, as a rigid body."""

    mass_kg: Positive = Field(description="a number above 0 [kg]")
    com_mm: PlaceMm = Field(description="three numbers [mm]: the centre of mass in the link's frame")
    inertia_kgm2: Inertia = Field(description=f"{INERTIA}; axes of the link's frame")
    frame: FrameForm = Field(
        default=FrameForm(),
        description="a mapping of xyz_mm and rpy_deg: the link's frame in the base frame where all joints show 0",
    )


class DynamicsForm(Form):
    """What the links of an arm weigh."""

    links: Annotated[list[LinkForm], Field(min_length=6, max_length=6)] = Field(
        description="a list of six mappings of mass_kg, com_mm, inertia_kgm2 and frame: the links that move, in order"
    )
    payload_kg: Positive = Field(description="a number above 0 [kg]: the rated load, from which the drives are guessed")
    effort_limit_nm: SixPositive | None = Field(
        default=None, description="six numbers above 0 [N m]: the greatest torque of each joint"
    )
    source: Words = Field(default="", description="text: where the numbers come from")


class RobotForm(Form):
    """The numbers of a robot."""

    name: Name = Field(description="text: how jobs call the robot")
    manufacturer: Words = Field(default="", description="text: who makes it")
    model: Words = Field(default="", description="text: the maker's name of it")
    geometry_mm: GeometryForm = Field(description="a mapping of the seven lengths a1, a2, b, c1, c2, c3, c4 [mm]")
    joints: JointsForm = Field(
        description="a mapping of names, sign, offset_deg, lower_deg, upper_deg and speed_deg_s, six entries each"
    )
    dynamics: DynamicsForm | None = Field(
        default=None, description="a mapping of links, payload_kg, effort_limit_nm and source: what the arm weighs"
    )


class RobotFile(RobotForm):
    """A robot file, YAML."""

    format: Literal["zerorev.robot/1"] = Field(description="zerorev.robot/1")
    sources: dict[Words, Words] = Field(
        default={}, description="a mapping of text to text: where the numbers come from"
    )
    second_sources: Many[Words] = Field(default=[], description="a list of text: what a second source says")
    caveats: Many[Words] = Field(default=[], description="a list of text: what to know before trusting the numbers")


class ToolForm(Form):
    """The numbers of a tool: flange to TCP, Z_tcp against the plunge."""

    name: Name = Field(default="tool", description="text: how jobs call the tool")
    tcp_mm: PlaceMm = Field(description="three numbers [mm]: the TCP in the flange frame")
    rpy_deg: AnglesDeg = Field(
        description="three numbers [deg]: roll, pitch, yaw of the TCP; R = Rz(yaw) Ry(pitch) Rx(roll)"
    )
    mass_kg: Positive | None = Field(default=None, description="a number above 0 [kg]: what the tool weighs")
    com_mm: PlaceMm | None = Field(
        default=None, description="three numbers [mm]: its centre of mass in the flange frame, beside mass_kg"
    )
    inertia_kgm2: Inertia | None = Field(
        default=None, description=f"{INERTIA}; axes of the flange frame; left out, the mass is taken for a point"
    )


class GivenToolForm(ToolForm):
    """The numbers of a tool as a user gives them: also as KUKA's controllers have them."""

    model_config = ConfigDict(json_schema_extra=_with_keys_of_kuka)

    tool_x: Literal["drill"] | None = Field(
        default=None,
        description="drill: X of the tool points along the drill, as TOOL_DATA of a KUKA has it; left out, Z points "
        "against the plunge",
    )

    @model_validator(mode="before")
    @classmethod
    def _own_keys(cls, data: Any) -> Any:
        changed = in_own_keys(data, "tcp_mm")
        if changed is not data and "abc_deg" not in data:
            changed.setdefault("tool_x", "left out")  # which axis of KUKA's frame drills has to be said
        return changed


class ToolFile(GivenToolForm):
    """A tool file, YAML."""

    format: Literal["zerorev.tool/1"] = Field(description="zerorev.tool/1")
    name: Name = Field(description="text: how jobs call the tool")
    sources: dict[Words, Words] = Field(
        default={}, description="a mapping of text to text: where the numbers come from"
    )


# --- job --------------------------------------------------------------------------------------------------------------


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
        description="as many numbers [mm] as psi_deg: stand-offs in order of motion, strictly falling from depth_mm to "
        "the target, then strictly rising to depth_mm; left out, they are depth_mm, 0, depth_mm",
    )
    branch: Branch | None = Field(
        default=None,
        description="a whole number from 0 to 7: the IK branch of the given motion, or the only one to search",
    )
    group: Id | None = Field(
        default=None, description="text or a whole number: with which it is drilled where the order is by groups"
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


class JobFile(SettingsForm):
    """A job file, YAML: a robot, a tool, holes, and how they are to be drilled."""

    model_config = ConfigDict(title="zerorev job")

    format: Literal["zerorev.job/1"] = Field(default="zerorev.job/1", description="zerorev.job/1")
    name: Name | None = Field(default=None, description="text: names the program; left out, it is the file's name")
    robot: Name = Field(description="text: a name that ships with zerorev, or the path of a robot file")
    tool: Annotated[
        Annotated[Name, Tag("<text>")] | Annotated[GivenToolForm, Tag("<mapping>")], Discriminator(kind)
    ] = Field(description="a name that ships with zerorev, the path of a tool file, or a mapping of tcp_mm and rpy_deg")
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
        "id,x_mm,y_mm,z_mm,i,j,k,depth_mm"
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
        default=0.0, description="a number, 0 or more [mm]: how far the tip runs beyond the bottom of each hole"
    )
    columns: ColumnsForm | None = Field(
        default=None,
        description="a mapping of columns to the names that a CSV file has for them, e.g. {x_mm: LOCX, y_mm: LOCY}",
    )
    unit: Literal["mm", "m", "in"] | None = Field(
        default=None,
        description="mm, m or in: of the lengths in a CSV file, but for columns whose name says mm; left out: mm",
    )
    decimal: Literal["point", "comma"] | None = Field(
        default=None, description="point or comma: the decimal sign in a CSV file; left out, it is found"
    )
