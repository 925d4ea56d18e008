"""The forms of robots, tools and frames: of their own files, and where they stand in other files; mm and degrees.

Each field's description says what is accepted; error messages (`zerorev.files.validation`) and the published JSON
Schemas (docs/schemas) both show it.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Field, model_validator

from zerorev.files.body_schema import MOST_SOLIDS, LinkBodyForm, ToolBodyForm
from zerorev.files.kuka_frames import KEYS, in_own_keys
from zerorev.files.stated_forms import Form, Many, Words, keys_of
from zerorev.files.values import AnglesDeg, Name, PlaceMm, SixDeg
from zerorev.model.dynamics import Dynamics, Link, Load
from zerorev.model.robot import LENGTHS, ArmGeometry, Display, JointLimits, Robot

__all__ = [
    "DynamicsForm", "FrameForm", "GivenFrameForm", "GivenToolForm", "RobotFile", "RobotForm", "ToolFile", "ToolForm",
]  # fmt: skip


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


@keys_of(ArmGeometry, LENGTHS)
class GeometryForm(Form):
    """The seven lengths of Brandstoetter, Angerer, Hofbaur (2014), fig. 1."""


@keys_of(JointLimits)
class JointsForm(Form):
    """The joints as the controller counts them, each against the link before it (`display`).

    Model angle = sign * controller angle - offset.
    """

    names: Annotated[list[Name], Field(min_length=6, max_length=6)] = Field(description="six names, e.g. A1 to A6")
    sign: Annotated[list[Annotated[int, Field(ge=-1, le=1)]], Field(min_length=6, max_length=6)] = Field(
        description="six of 1 or -1"
    )
    offset_deg: SixDeg = Field(description="six numbers [deg]")


@keys_of(Link)
class LinkForm(Form):
    """A link that moves, as a rigid body."""

    frame: FrameForm = Field(
        default=FrameForm(),
        description="a mapping of xyz_mm and rpy_deg: the link's frame in the base frame where all joints show 0",
    )


@keys_of(Dynamics)
class DynamicsForm(Form):
    """What the links of an arm weigh."""

    links: Annotated[list[LinkForm], Field(min_length=6, max_length=6)] = Field(
        description="a list of six mappings of mass_kg, com_mm, inertia_kgm2 and frame: the links that move, in order"
    )


@keys_of(Display)
class DisplayForm(Form):
    """What the controller shows of the joints where that is not the joint that turns."""


class BaseInRootForm(Form):
    """The base frame from which the controller counts, in the base frame of the arm."""

    xyz_mm: PlaceMm = Field(
        default=[0.0, 0.0, 0.0], description="three numbers [mm]: the origin, from the height from which c1 is measured"
    )
    rpy_deg: AnglesDeg = Field(
        default=[0.0, 0.0, 0.0], description="three numbers [deg]: roll, pitch, yaw; R = Rz(yaw) Ry(pitch) Rx(roll)"
    )


@keys_of(Robot, ("pulses_per_deg", "payload"))
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
    display: DisplayForm = Field(
        default=DisplayForm(),
        description="a mapping of j3_less_j2: what the controller shows in place of the joints that turn",
    )
    base_in_root: BaseInRootForm | None = Field(
        default=None,
        description="a mapping of xyz_mm and rpy_deg: the base frame from which the controller counts, in the base "
        "frame of the arm; or null: they are one",
    )
    bodies: Annotated[list[LinkBodyForm], Field(max_length=MOST_SOLIDS)] = Field(
        default=[],
        description="a list of solids on the links; none: capsules about the lines of the arm stand for them",
    )


class RobotFile(RobotForm):
    """A robot file, YAML."""

    format: Literal["zerorev.robot/1"] = Field(description="zerorev.robot/1")
    sources: dict[Words, Words] = Field(
        default={}, description="a mapping of text to text: where the numbers come from"
    )
    second_sources: Many[Words] = Field(default=[], description="a list of text: what a second source says")
    caveats: Many[Words] = Field(default=[], description="a list of text: what to know before trusting the numbers")


@keys_of(Load, optional=True)
class ToolForm(Form):
    """The numbers of a tool: flange to TCP, Z_tcp against the plunge."""

    name: Name = Field(default="tool", description="text: how jobs call the tool")
    tcp_mm: PlaceMm = Field(description="three numbers [mm]: the TCP in the flange frame")
    rpy_deg: AnglesDeg = Field(
        description="three numbers [deg]: roll, pitch, yaw of the TCP; R = Rz(yaw) Ry(pitch) Rx(roll)"
    )
    bodies: Annotated[list[ToolBodyForm], Field(max_length=MOST_SOLIDS)] = Field(
        default=[], description="a list of solids; none: capsules about drill and holder stand for them"
    )


class GivenToolForm(ToolForm):
    """The numbers of a tool as a user gives them: also as KUKA's controllers have them."""

    model_config = ConfigDict(json_schema_extra=_with_keys_of_kuka)

    tool_x: Literal["drill"] | None = Field(
        default=None,
        description="drill: X of the tool points along the drill, as TOOL_DATA of a KUKA has it; beside rpy_deg or "
        "abc_deg it may be left out, and Z points against the plunge",
    )

    @model_validator(mode="before")
    @classmethod
    def _own_keys(cls, data: Any) -> Any:
        changed = in_own_keys(data, "tcp_mm")
        if changed is not data and "abc_deg" not in data:
            changed.setdefault("tool_x", "not given")  # which axis of KUKA's frame drills has to be said
        return changed


class ToolFile(GivenToolForm):
    """A tool file, YAML."""

    format: Literal["zerorev.tool/1"] = Field(description="zerorev.tool/1")
    name: Name = Field(description="text: how jobs call the tool")
    sources: dict[Words, Words] = Field(
        default={}, description="a mapping of text to text: where the numbers come from"
    )
