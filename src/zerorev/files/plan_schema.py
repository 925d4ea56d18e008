"""The forms of the plan file and the depth file: what comes out, complete enough to be checked and exported alone."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Field

from zerorev.files.body_schema import SurroundingsForm
from zerorev.files.robot_schema import FrameForm, RobotForm, ToolForm
from zerorev.files.schema import CycleForm, SettingsForm
from zerorev.files.stated_forms import Counted, Form, Many, SixMeasured, keys_of
from zerorev.files.values import (
    MOST_BREAKPOINTS,
    MOST_HOLES,
    MOST_STROKES,
    MOST_TOOLS,
    Branch,
    Depth,
    Name,
    NotNegative,
    PlaceMm,
    Positive,
    SixDeg,
    SpinsDeg,
    StandoffsMm,
    StrokeName,
)
from zerorev.model.finding import Finding
from zerorev.model.measures import Measures
from zerorev.model.plan import (
    Baseline,
    Certificate,
    Clearance,
    Corner,
    Event,
    HolePlan,
    LostMotion,
    LostMotionEvent,
    Optimality,
    Score,
    Stroke,
    Transition,
    Verification,
    Within,
)

__all__ = [
    "BaselineForm",
    "CertificateForm",
    "CriteriaForm",
    "DepthFile",
    "DepthHole",
    "FindingForm",
    "GivenForm",
    "JointsDegForm",
    "LostMotionEventForm",
    "LostMotionForm",
    "PlanFile",
    "PlanHead",
    "PlanHole",
    "StrokeForm",
    "ToolPlanForm",
    "TransitionForm",
    "VerifiedForm",
]

Unit = Annotated[list[Annotated[float, Field(ge=-1.001, le=1.001)]], Field(min_length=3, max_length=3)]
Sha256 = Annotated[str, Field(pattern="^[0-9a-f]{64}$")]


class PlanRobot(RobotForm):
    """The robot of a plan."""

    sha256: Sha256 = Field(description="64 hexadecimal digits: SHA-256 of the robot's numbers")


class PlanTool(ToolForm):
    """The tool of a plan."""

    sha256: Sha256 = Field(description="64 hexadecimal digits: SHA-256 of the tool's numbers")


@keys_of(Finding, needed=True)
class FindingForm(Form):
    """Something a user should know."""


@keys_of(Measures)
class CriteriaForm(Form):
    """What the criteria measure of a motion beside its reversals; null where it is undefined."""


@keys_of(Event, needed=True)
class EventForm(Form):
    """A reversal."""


class GivenForm(Form):
    """What the job fixed beforehand."""

    standoff_mm: StandoffsMm | None = Field(description="stand-offs [mm] of the given motion, in order; or null")
    psi_deg: SpinsDeg | None = Field(description="spins [deg] of the given motion; or null: it was searched for")
    branch: Branch | None = Field(description="a whole number from 0 to 7: the branch asked for; or null: any")


class JointsDegForm(Form):
    """The joints along a motion: controller angles with turns, of the joints that turn.

    A controller that shows joint 3 less joint 2 (`display` of the robot, FANUC) shows another joint 3 than stands here.
    """

    start: SixDeg = Field(description="six numbers [deg] at the start")
    target: SixDeg = Field(description="six numbers [deg] at the corner")
    end: SixDeg = Field(description="six numbers [deg] at the end")
    breakpoints: Annotated[list[SixDeg], Field(min_length=3, max_length=MOST_BREAKPOINTS, fail_fast=True)] = Field(
        description="six numbers [deg] for each entry of standoff_mm"
    )


@keys_of(Optimality, needed=True)
class OptimalityForm(Form):
    """How much better a motion of straight legs could be, by a global search that bounds."""


@keys_of(LostMotionEvent, needed=True)
class LostMotionEventForm(Form):
    """Where the load of a joint changes its sign without a reversal."""


@keys_of(LostMotion, needed=True)
class LostMotionForm(Form):
    """The lost motion that is predicted at the tip, with guessed drives."""

    events: Many[LostMotionEventForm] = Field(
        description="a list of joint, leg, standoff_mm and friction: where loads change their sign without a reversal"
    )


@keys_of(Clearance, needed=True)
class ClearanceForm(Form):
    """How near a motion comes to what stands around the arm."""


@keys_of(Corner, needed=True)
class CornerForm(Form):
    """How the motion turns round at the corner, and what that costs."""

    interval_mm: Annotated[list[NotNegative], Field(min_length=2, max_length=2)] = Field(
        description="two numbers [mm]: least and greatest shortfall"
    )


@keys_of(Baseline, needed=True)
class BaselineForm(Form):
    """The same hole drilled with constant spin, psi = psi_start, on the plan's branch."""


@keys_of(Verification, needed=True)
class VerifiedForm(Form):
    """What the independent check examined, and what it found."""


@keys_of(Certificate, needed=True)
class CertificateForm(Form):
    """What is proven of the continuous motion; bounds are null where nothing is proven.

    It is not recomputed by `zerorev check`, which leaves it out; with --certify it is proven again and replaced.
    """


@keys_of(Within, needed=True)
class WithinForm(Form):
    """How far the part may stand off its part frame."""


class FeedsForm(Form):
    """Feeds of a stroke."""

    plunge: Positive = Field(description="a number above 0 [mm/s]")
    retract: Positive = Field(description="a number above 0 [mm/s]")


@keys_of(Stroke, needed=True)
class StrokeForm(Form):
    """One stroke of a hole."""

    depth_mm: Depth = Field(description="a number above 0 [mm]: how deep it goes")
    standoff_mm: StandoffsMm = Field(
        description="three numbers or more [mm]: breakpoints in order of motion, counted from the hole's own target"
    )
    psi_deg: SpinsDeg = Field(description="as many numbers [deg] as standoff_mm: the spins there")
    joints_deg: JointsDegForm = Field(description="a mapping of start, target, end and breakpoints")
    feeds_mm_s: FeedsForm = Field(description="a mapping of plunge and retract [mm/s]")
    corner: CornerForm | None = Field(
        description="a mapping of how the motion turns round at the corner, and what that costs; or null: not said"
    )
    reversals_in_material: Counted = Field(description="a whole number: reversals of all joints in the stroke itself")
    answer: PlanHole | None = Field(
        description="a mapping: the stroke as a hole of its own, which ends where the stroke does; or null: it is the "
        "only one of the first tool, of which the hole itself is said, or one of a further tool, which is said in tools"
    )


@keys_of(HolePlan, needed=True)
@keys_of(Score, or_null=True)
class PlanHole(Form):
    """One hole's answer; what describes a motion is null where there is none."""

    # Any: as it is stated in Score or HolePlan

    id: StrokeName = Field(description="text: the hole's id")
    group: Name | None = Field(
        default=None, description="text: with which it is drilled in an order by groups; or null"
    )
    target_mm: PlaceMm = Field(description="three numbers [mm]: bottom of the stroke, base frame")
    direction: Unit = Field(description="three numbers: unit vector into the material, base frame")
    depth_mm: Depth = Field(description="a number above 0 [mm]: the stroke")
    deepest_mm: Any
    deepest_at_most_mm: Any
    psi_zero: Unit = Field(description="three numbers: unit vector of Y_tcp at psi = 0, base frame")
    given: GivenForm | None = Field(
        default=None,
        description="a mapping of standoff_mm, psi_deg and branch as the job fixed them; or null: it fixed none",
    )
    cycle: CycleForm | None = Field(
        default=None,
        description="a mapping of kind, depth_mm, back_mm and dwell_s: how it is drilled; or null: as the job says",
    )
    status: Literal["planned", "evaluated", "infeasible"] = Field(
        description="planned (searched for), evaluated (given, not searched for) or infeasible (no motion at all)"
    )
    branch: Branch | None = Field(description="a whole number from 0 to 7: the IK branch")
    standoff_mm: StandoffsMm | None = Field(description="three numbers or more [mm]: breakpoints in order of motion")
    psi_deg: SpinsDeg | None = Field(description="as many numbers [deg] as standoff_mm: the spins there")
    joints_deg: JointsDegForm | None = Field(description="a mapping of start, target, end and breakpoints")
    reversals: Any
    reversals_per_joint: Any
    events: Many[EventForm] | None = Field(description="a list of joint, leg and standoff_mm: where joints reverse")
    travel_deg: Any
    min_rate_deg_per_mm: Any
    mean_rate_deg_per_mm: Any
    limit_distance_deg: Any
    critical_rates_deg_per_mm: SixMeasured | None = Field(
        default=None,
        description="six numbers [deg/mm]: twist rate at which each joint stands still at the corner; null: none",
    )
    twist_spread_deg_per_mm: NotNegative | None = Field(
        default=None, description="a number [deg/mm]: greatest less least critical rate; or null: a joint has none"
    )
    wrist_offset_mm: Any
    optimality: OptimalityForm | None = Field(
        default=None,
        description="a mapping of what no motion of straight legs can beat; or null: no proof was asked for",
    )
    baseline: BaselineForm | None = Field(
        description="a mapping of reversals, reversals_per_joint and travel_deg; or null: it cannot be run"
    )
    verified: VerifiedForm | None = Field(
        description="a mapping of what was checked, and the outcome; or null: it was not"
    )
    certificate: CertificateForm | None = Field(
        default=None,
        description="what is proven of the continuous motion; not recomputed by zerorev check, which leaves it out, "
        "but by check --certify; or null: it was not asked for",
    )
    certified_within: WithinForm | None = Field(
        default=None,
        description="a mapping of mm and deg: certified for every part frame within; not recomputed by zerorev check, "
        "which leaves it out, but by check --certify; or null: not proven",
    )
    criteria: CriteriaForm | None = Field(
        default=None, description="a mapping of what the criteria measure of the motion; or null: it was not measured"
    )
    lost_motion: LostMotionForm | None = Field(
        default=None,
        description="a mapping of what the gears are predicted to add at the tip, and where loads change their sign; "
        "or null: the robot's masses are not known",
    )
    corner: CornerForm | None = Field(
        default=None,
        description="a mapping of how the motion turns round at the corner, and what that costs; or null: not said",
    )
    clearance: ClearanceForm | None = Field(
        default=None,
        description="a mapping of least_mm, standoff_mm, between and certified: how near the hole's own moves come to "
        "what stands around; left out: nothing is known to",
    )
    strokes: Many[StrokeForm] | None = Field(
        default=None,
        min_length=1,
        max_length=MOST_STROKES,
        description="a list of the strokes with which the hole is drilled, in order; or null: not said. Of several, "
        "standoff_mm, psi_deg, joints_deg, corner and critical rates of the hole are those of the first one, the other "
        "figures those of all together",
    )
    findings: Many[FindingForm] = Field(description="a list of level, kind, message and hole")


@keys_of(Transition, needed=True)
class TransitionForm(Form):
    """The move of all axes at once from where one hole ends to where the next one begins."""

    model_config = ConfigDict(populate_by_name=True)

    start: Name | None = Field(
        alias="from", description="text: id of the hole that is left; or null: the home position"
    )
    to: Name | None = Field(description="text: id of the hole that is drilled next; or null: the home position")
    joints_deg: Annotated[list[SixDeg], Field(min_length=2, max_length=100)] = Field(
        description="a list of two or more entries of six numbers [deg]: where the move begins, stops and ends"
    )
    around: ClearanceForm | None = Field(
        default=None, description="a mapping as clearance of a hole has it; left out: nothing is known to stand around"
    )
    findings: Many[FindingForm] = Field(description="a list of level, kind, message and hole")


class DepthHole(Form):
    """One hole's deepest stroke."""

    id: Name = Field(description="text: the hole's id")
    deepest_mm: NotNegative = Field(
        description="a number [mm]: the deepest stroke without a reversal; 0: there is none"
    )
    plan: PlanHole = Field(description="a mapping: the motion that reaches it, as a hole of a plan file")


class ToolPlanForm(Form):
    """What a further tool does to the holes of a plan."""

    name: Name = Field(description="text: names its program")
    tool: PlanTool = Field(description="a mapping: name, numbers and sha256 of the tool")
    settings: SettingsForm = Field(description="a mapping of the job's settings as they are for this tool")
    holes: Many[PlanHole] = Field(
        min_length=1, max_length=MOST_HOLES, description="a list of the same holes, in the order of the plan's own"
    )
    order: Annotated[list[Name], Field(max_length=MOST_HOLES, fail_fast=True)] | None = Field(
        default=None, description="as that of the plan, for this tool"
    )
    transitions: Annotated[list[TransitionForm], Field(max_length=MOST_HOLES + 1, fail_fast=True)] | None = Field(
        default=None, description="as those of the plan, for this tool"
    )
    cycle_time_s: NotNegative | None = Field(
        default=None, description="a number, 0 or more [s]: as that of the plan, for this tool"
    )
    findings: Many[FindingForm] = Field(description="a list of level, kind, message and hole, about this tool")


class PlanHead(Form):
    """What a file says of all its holes."""

    format: str = Field(description="text: the kind of file")
    name: Name = Field(description="text: name of the job")
    robot: PlanRobot = Field(description="a mapping: name, numbers and sha256 of the robot")
    tool: PlanTool = Field(description="a mapping: name, numbers and sha256 of the tool")
    part_frame: FrameForm = Field(description="a mapping of xyz_mm and rpy_deg: the part frame in the base frame")
    settings: SettingsForm = Field(description="a mapping of the job's settings")
    surroundings: SurroundingsForm | None = Field(
        default=None, description="a mapping of part, fixtures and floor_mm: what stands around; left out: nothing"
    )
    order: Annotated[list[Name], Field(max_length=MOST_HOLES, fail_fast=True)] | None = Field(
        default=None,
        description="a list of the ids of the holes that have a motion, as they are drilled; or null: as listed",
    )
    transitions: Annotated[list[TransitionForm], Field(max_length=MOST_HOLES + 1, fail_fast=True)] | None = Field(
        default=None,
        description="a list of from, to, joints_deg, time_s, changes_posture, largest_axis_move_deg, clearance_mm and "
        "findings: the moves between the holes in their order; or null: not computed",
    )
    cycle_time_s: NotNegative | None = Field(
        default=None,
        description="a number, 0 or more [s]: holes and transitions together; or null: not computed",
    )
    findings: Many[FindingForm] = Field(description="a list of level, kind, message and hole, about the whole plan")
    tools: Annotated[list[ToolPlanForm], Field(max_length=MOST_TOOLS)] | None = Field(
        default=None,
        description="a list of what each further tool does to the same holes; or null: there is one tool alone",
    )


class PlanFile(PlanHead):
    """A plan file, JSON: complete enough to be checked and exported alone."""

    model_config = ConfigDict(title="zerorev plan")

    format: Literal["zerorev.plan/1"] = Field(description="zerorev.plan/1")
    holes: Many[PlanHole] = Field(
        min_length=1, max_length=MOST_HOLES, description="a list of one hole or more, in the job's order"
    )


class DepthFile(PlanHead):
    """A depth file, JSON: the deepest strokes and the plans that reach them, checked and exported as a plan file is."""

    model_config = ConfigDict(title="zerorev depth")

    format: Literal["zerorev.depth/1"] = Field(description="zerorev.depth/1")
    holes: Many[DepthHole] = Field(
        min_length=1,
        max_length=MOST_HOLES,
        description="a list of id, deepest_mm and plan of one hole or more, in the job's order",
    )
