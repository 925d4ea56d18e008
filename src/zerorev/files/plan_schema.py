"""The forms of the plan file and the depth file: what comes out, complete enough to be checked and exported alone."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import ConfigDict, Field

from zerorev.files.schema import (
    MOST_BREAKPOINTS,
    MOST_HOLES,
    Branch,
    Depth,
    Form,
    FrameForm,
    Many,
    Measured,
    Name,
    NotNegative,
    PlaceMm,
    RobotForm,
    SettingsForm,
    SixDeg,
    SpinsDeg,
    StandoffsMm,
    Text,
    ToolForm,
)
from zerorev.files.stated_forms import form_of
from zerorev.model.measures import Measures

__all__ = [
    "BaselineForm",
    "CertificateForm",
    "CriteriaForm",
    "DepthFile",
    "DepthHole",
    "FindingForm",
    "GivenForm",
    "JointsDegForm",
    "PlanFile",
    "PlanHead",
    "PlanHole",
    "VerifiedForm",
]

SixMeasured = Annotated[list[Measured | None], Field(min_length=6, max_length=6)]
Unit = Annotated[list[Annotated[float, Field(ge=-1.001, le=1.001)]], Field(min_length=3, max_length=3)]
Count = Annotated[int, Field(ge=0, le=10**9)]
SixCounts = Annotated[list[Count], Field(min_length=6, max_length=6)]
Sha256 = Annotated[str, Field(pattern="^[0-9a-f]{64}$")]


class PlanRobot(RobotForm):
    """The robot of a plan."""

    sha256: Sha256 = Field(description="64 hexadecimal digits: SHA-256 of the robot's numbers")


class PlanTool(ToolForm):
    """The tool of a plan."""

    sha256: Sha256 = Field(description="64 hexadecimal digits: SHA-256 of the tool's numbers")


class FindingForm(Form):
    """Something a user should know."""

    level: Literal["error", "warning", "info"] = Field(description="error, warning or info")
    kind: Text = Field(description="text: a fixed word for machines")
    message: Text = Field(description="text: one sentence for people")
    hole: Text | None = Field(description="text: the hole's id; or null: the whole plan is meant")


if TYPE_CHECKING:

    class CriteriaForm(Form):
        """What the criteria measure of a motion beside its reversals; null where it is undefined."""

else:
    CriteriaForm = form_of(
        Measures,
        "CriteriaForm",
        "What the criteria measure of a motion beside its reversals; null where it is undefined.",
    )


class EventForm(Form):
    """A reversal."""

    joint: Annotated[int, Field(ge=1, le=6)] = Field(description="a whole number from 1 to 6")
    leg: Literal["plunge", "target", "retract"] = Field(description="plunge, target (at the corner) or retract")
    standoff_mm: Measured = Field(description="a number [mm]: where")


class GivenForm(Form):
    """What the job fixed beforehand."""

    standoff_mm: StandoffsMm | None = Field(description="stand-offs [mm] of the given motion, in order; or null")
    psi_deg: SpinsDeg | None = Field(description="spins [deg] of the given motion; or null: it was searched for")
    branch: Branch | None = Field(description="a whole number from 0 to 7: the branch asked for; or null: any")


class JointsDegForm(Form):
    """The joints along a motion: controller angles with turns."""

    start: SixDeg = Field(description="six numbers [deg] at the start")
    target: SixDeg = Field(description="six numbers [deg] at the corner")
    end: SixDeg = Field(description="six numbers [deg] at the end")
    breakpoints: Annotated[list[SixDeg], Field(min_length=3, max_length=MOST_BREAKPOINTS, fail_fast=True)] = Field(
        description="six numbers [deg] for each entry of standoff_mm"
    )


class OptimalityForm(Form):
    """How much better a motion of straight legs could be, by a global search that bounds."""

    reversals_at_least: NotNegative = Field(description="a number: no motion has fewer reversals (weighted)")
    travel_at_least_deg: NotNegative | None = Field(
        description="a number [deg]: none with so few reversals that keeps the threshold travels less; null: no bound"
    )
    gap_percent: NotNegative | None = Field(
        description="a number [%]: what the planned motion travels above that, of its own travel; null: no bound"
    )
    proven: bool = Field(
        description="true or false: whether nothing was left undecided (without a motion: that there is none; below"
        " the motion threshold: that no motion with so few reversals keeps it; else: a gap of at most 0.1 %)"
    )


class BaselineForm(Form):
    """The same hole drilled with constant spin, psi = psi_start, on the plan's branch."""

    reversals: Count = Field(description="a whole number: reversals of all joints")
    reversals_per_joint: SixCounts = Field(description="six whole numbers")
    travel_deg: NotNegative = Field(description="a number [deg]: sum over the joints of the angle moved")


class VerifiedForm(Form):
    """What the independent check looked at, and what it found."""

    passed: bool = Field(description="true or false: whether the plan's claims hold")
    samples: Count = Field(description="a whole number: points looked at on the two legs")
    blend_samples: Count = Field(description="a whole number: points looked at on the blended corner")
    reversals_per_joint: SixCounts = Field(description="six whole numbers, as counted by the check")
    max_position_error_mm: Measured | None = Field(description="a number [mm]: the tip off its path; null: undefined")
    max_rotation_error_deg: Measured | None = Field(
        description="a number [deg]: the tool off its pose; null: undefined"
    )
    max_joint_step_deg: Measured | None = Field(
        description="a number [deg]: greatest step between neighbouring samples; null: undefined"
    )
    min_limit_distance_deg: Measured | None = Field(
        description="a number [deg]: least distance to a joint limit; null: undefined"
    )
    failures: Many[Text] = Field(description="a list of text: one sentence a failed check")


class CertificateForm(Form):
    """What is proven of the continuous motion; bounds are null where nothing is proven.

    It is not recomputed by `zerorev check`, which leaves it out; with --certify it is proven again and replaced.
    """

    verdict: Literal["certified", "refuted", "undecided"] = Field(
        description="certified (proven), refuted (proven to be wrong) or undecided"
    )
    pieces: Count = Field(description="a whole number: pieces into which the motion was cut")
    min_rate_deg_per_mm: SixMeasured = Field(description="six numbers [deg/mm]: on the legs no joint moves slower")
    blend_min_rate_deg_per_mm: SixMeasured = Field(
        description="six numbers [deg/mm]: in the blends no joint moves slower; null without one"
    )
    limit_distance_deg: SixMeasured = Field(description="six numbers [deg]: no joint comes nearer to a limit")
    reasons: Many[Text] = Field(description="a list of text: what is refuted or undecided, one sentence each")


class WithinForm(Form):
    """How far the part may stand off its part frame."""

    mm: NotNegative = Field(description="a number [mm]: its origin, along each axis of the part frame")
    deg: NotNegative = Field(description="a number [deg]: turned about that origin, about any axis")


class PlanHole(Form):
    """One hole's answer; what describes a motion is null where there is none."""

    id: Name = Field(description="text: the hole's id")
    target_mm: PlaceMm = Field(description="three numbers [mm]: bottom of the stroke, base frame")
    direction: Unit = Field(description="three numbers: unit vector into the material, base frame")
    depth_mm: Depth = Field(description="a number above 0 [mm]: the stroke")
    deepest_mm: NotNegative | None = Field(
        default=None,
        description="a number [mm]: the deepest stroke without a reversal, 0: none; or null: not looked for",
    )
    deepest_at_most_mm: NotNegative | None = Field(
        default=None,
        description="a number [mm]: no stroke without a reversal is as deep, of straight or free legs as the settings"
        " say; or null: not proven",
    )
    psi_zero: Unit = Field(description="three numbers: unit vector of Y_tcp at psi = 0, base frame")
    given: GivenForm | None = Field(
        default=None,
        description="a mapping of standoff_mm, psi_deg and branch as the job fixed them; or null: it fixed none",
    )
    status: Literal["planned", "evaluated", "infeasible"] = Field(
        description="planned (searched for), evaluated (given and looked at) or infeasible (no motion at all)"
    )
    branch: Branch | None = Field(description="a whole number from 0 to 7: the IK branch")
    standoff_mm: StandoffsMm | None = Field(description="three numbers or more [mm]: breakpoints in order of motion")
    psi_deg: SpinsDeg | None = Field(description="as many numbers [deg] as standoff_mm: the spins there")
    joints_deg: JointsDegForm | None = Field(description="a mapping of start, target, end and breakpoints")
    reversals: Count | None = Field(description="a whole number: reversals of all joints")
    reversals_per_joint: SixCounts | None = Field(description="six whole numbers")
    events: Many[EventForm] | None = Field(description="a list of joint, leg and standoff_mm: where joints reverse")
    travel_deg: NotNegative | None = Field(description="a number [deg]: sum over the joints of the angle moved")
    min_rate_deg_per_mm: SixMeasured | None = Field(
        description="six numbers [deg/mm]: slowest motion of each joint at any point; null: undefined"
    )
    mean_rate_deg_per_mm: SixMeasured | None = Field(
        description="six numbers [deg/mm]: each joint's lesser mean motion of the two legs; null: undefined"
    )
    limit_distance_deg: SixMeasured | None = Field(
        description="six numbers [deg]: least distance to a joint limit, negative beyond it; null: undefined"
    )
    critical_rates_deg_per_mm: SixMeasured | None = Field(
        default=None,
        description="six numbers [deg/mm]: twist rate at which each joint stands still at the corner; null: none",
    )
    twist_spread_deg_per_mm: NotNegative | None = Field(
        default=None, description="a number [deg/mm]: greatest less least critical rate; or null: a joint has none"
    )
    wrist_offset_mm: NotNegative = Field(description="a number [mm]: distance of the wrist centre from the drill axis")
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
    findings: Many[FindingForm] = Field(description="a list of level, kind, message and hole")


class DepthHole(Form):
    """One hole's deepest stroke."""

    id: Name = Field(description="text: the hole's id")
    deepest_mm: NotNegative = Field(
        description="a number [mm]: the deepest stroke without a reversal; 0: there is none"
    )
    plan: PlanHole = Field(description="a mapping: the motion that reaches it, as a hole of a plan file")


class PlanHead(Form):
    """What a file says of all its holes."""

    format: str = Field(description="text: the kind of file")
    name: Name = Field(description="text: name of the job")
    robot: PlanRobot = Field(description="a mapping: name, numbers and sha256 of the robot")
    tool: PlanTool = Field(description="a mapping: name, numbers and sha256 of the tool")
    part_frame: FrameForm = Field(description="a mapping of xyz_mm and rpy_deg: the part frame in the base frame")
    settings: SettingsForm = Field(description="a mapping of the job's settings")
    findings: Many[FindingForm] = Field(description="a list of level, kind, message and hole, about the whole plan")


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
