"""The plan: what comes out, complete enough to be checked and exported alone."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any, Literal

import numpy as np

from zerorev.model._arrays import Array
from zerorev.model.corner import CornerKind
from zerorev.model.finding import Finding
from zerorev.model.hole import Hole
from zerorev.model.job import Settings
from zerorev.model.measures import Measures
from zerorev.model.profile import Profile
from zerorev.model.robot import Robot
from zerorev.model.shown import Shown
from zerorev.model.stated import Choice, Switch, Whole, with_attributes
from zerorev.model.stated_figures import Count, Figure, SixCounts, SixFigures, Text, Texts
from zerorev.model.tool import Tool
from zerorev.model.units import DEG, DEG_PER_MM, MM, PERCENT, S

__all__ = [
    "Baseline",
    "Certificate",
    "Clearance",
    "Corner",
    "Event",
    "HolePlan",
    "LostMotion",
    "LostMotionEvent",
    "Motion",
    "Optimality",
    "Plan",
    "Score",
    "Strokes",
    "Transition",
    "Verification",
    "Within",
    "named_holes",
]

LegName = Literal["plunge", "target", "retract"]
Strokes = Literal["asked", "deepest"]

HOLES_NAMED = 6  # in one sentence; more are counted
NOT_COVERED = "it is not covered, or this is a move between holes"


def named_holes(ids: Iterable[str]) -> str:
    """`hole a`, or `holes a, b and 3 more`; an id that comes twice is named once."""
    ids = list(dict.fromkeys(ids))
    more = f" and {len(ids) - HOLES_NAMED:,} more" if len(ids) > HOLES_NAMED else ""
    return f"hole{'s' if len(ids) > 1 else ''} {', '.join(ids[:HOLES_NAMED])}{more}"


@dataclass(frozen=True)
class Event:
    """A reversal: where one joint changes direction, within a leg or at the target, the corner."""

    joint: Annotated[int, Whole(least=1, to=6)]
    leg: Annotated[LegName, Choice(words={"plunge": "", "target": "at the corner", "retract": ""})]
    standoff: Annotated[float, Figure("where", MM)]


@dataclass(frozen=True)
class LostMotionEvent:
    """Where the load of a joint changes its sign without a reversal: its gear crosses to the other flank."""

    joint: Annotated[int, Whole(least=1, to=6)]
    leg: Annotated[LegName, Choice(words={"plunge": "", "target": "at the corner", "retract": ""})]
    standoff: Annotated[float, Figure("where", MM)]
    friction: Annotated[float, Figure("share of the nominal dry friction that lies behind the gear then", least=0)]


@dataclass(frozen=True)
class LostMotion:
    """What the gears are predicted to add to a motion at the tip, with guessed drives: to compare motions by.

    Attributes:
        events: where loads change their sign without a reversal, in order of motion.
    """

    at_tip: Annotated[
        float, Figure("greatest deviation across the drill axis, half a stroke about the turn", MM, least=0)
    ]
    twin_at_tip: Annotated[
        float | None,
        Figure("the same of the motion with its legs swapped", MM, least=0, null=None, none="it cannot be run"),
    ]
    events: tuple[LostMotionEvent, ...] = ()


@dataclass(frozen=True)
class Score:
    """What a motion does to the joints.

    `min_rate` is |d theta / d path| (rule `pointwise`), `mean_rate` the average of a leg (rule `mean`); the arrays have
    shape (6,).

    Attributes:
        events: where the joints reverse, in order of motion.
    """

    reversals_per_joint: Annotated[tuple[int, ...], SixCounts("reversals of each joint", total="reversals")]
    events: tuple[Event, ...]
    travel: Annotated[float, Figure("sum over the joints of the angle moved", DEG, least=0)]
    min_rate: Annotated[Array, SixFigures("slowest motion of each joint at any point", DEG_PER_MM, none="undefined")]
    mean_rate: Annotated[
        Array, SixFigures("each joint's lesser mean motion of the two legs", DEG_PER_MM, none="undefined")
    ]
    limit_distance: Annotated[
        Array, SixFigures("least distance to a joint limit, negative beyond it", DEG, none="undefined")
    ]

    @property
    def reversals(self) -> int:
        """Count of direction changes over all joints."""
        return sum(self.reversals_per_joint)


@dataclass(frozen=True)
class Motion:
    """The joints at the breakpoints of a profile on one branch.

    Attributes:
        profile: the spin along the path.
        branch: 0..7 (conventions: branch).
        joints: controller angles with turns [rad] at the profile's breakpoints, shape (n, 6).
    """

    profile: Profile
    branch: int
    joints: Array


@dataclass(frozen=True)
class Corner:
    """How a motion turns round at its deepest point, and what that costs.

    Attributes:
        interval: least and greatest shortfall [m].
    """

    kind: Annotated[
        CornerKind,
        Choice(
            words={
                "blend": "of straight moves",
                "joint": "of joint moves",
                "spin": "of joint moves, on which the tool spins on",
                "stop": "all joints rest",
            }
        ),
    ]
    shortfall: Annotated[float, Figure("how far short of the programmed corner the tip turns back", MM, least=0)]
    interval: tuple[float, float]
    law: Annotated[str, Text("by what that is expected")]
    reach: Annotated[float, Figure("how far from the corner joint moves begin and end; 0: there are none", MM, least=0)]
    off_axis: Annotated[float, Figure("the tip off the drill axis on the joint moves, at most", MM, least=0)]
    tilt: Annotated[float, Figure("the tool tilted against it there, at most", DEG, least=0)]
    dwell: Annotated[
        float | None, Figure("for which the tool dwells there", S, least=0, null=None, none="not at all", added=True)
    ] = None
    spin: Annotated[
        float | None, Figure("by which it spins on meanwhile", DEG, null=None, none="it does not", added=True)
    ] = None
    spin_moves: Annotated[
        int | None, Count("joint moves in which it spins on, just before the corner", none="it does not", added=True)
    ] = None


@dataclass(frozen=True)
class Clearance:
    """How near a motion comes to what stands around the arm.

    Attributes:
        between: the body of the arm, and what it comes near to.
    """

    least: Annotated[float, Figure("least distance of any body from the part and the fixtures", MM)]
    standoff: Annotated[
        float | None, Figure("where that is", MM, null=None, none="on a move between holes", added=True)
    ]
    between: Annotated[tuple[str, ...], Texts("what is so near to what")]
    certified: Annotated[
        bool,
        Switch("whether it is proven that no body comes nearer, nor that two of the arm's touch, between samples, too"),
    ]
    lead_in: Annotated[
        float | None, Figure("lead-in that is covered", MM, least=0, null=None, none=NOT_COVERED, added=True)
    ] = None
    approach: Annotated[
        float | None, Figure("approach that is covered", MM, least=0, null=None, none=NOT_COVERED, added=True)
    ] = None
    retract: Annotated[
        float | None, Figure("retract that is covered", MM, least=0, null=None, none=NOT_COVERED, added=True)
    ] = None


@dataclass(frozen=True)
class Baseline:
    """The same hole drilled with constant spin psi = psi_start on the plan's branch."""

    reversals_per_joint: Annotated[tuple[int, ...], SixCounts("reversals of each joint", total="reversals")]
    travel: Annotated[float, Figure("sum over the joints of the angle moved", DEG, least=0)]

    @property
    def reversals(self) -> int:
        """Count of direction changes over all joints."""
        return sum(self.reversals_per_joint)


@dataclass(frozen=True)
class Verification:
    """What the independent check examined, and what it found.

    Attributes:
        subject: fingerprint of what was examined (`zerorev.verify.check.subject`); None where that is not known, as of
            what a plan file says.
    """

    passed: Annotated[bool, Switch("whether the plan's claims hold")]
    samples: Annotated[int, Count("points examined on the two legs")]
    blend_samples: Annotated[int, Count("points examined on the blended corner")]
    reversals_per_joint: Annotated[tuple[int, ...], SixCounts("as counted by the check")]
    max_position_error: Annotated[float, Figure("the tip off its path", MM, null=math.nan, none="undefined")]
    max_rotation_error: Annotated[float, Figure("the tool off its pose", DEG, null=math.nan, none="undefined")]
    max_joint_step: Annotated[
        float, Figure("greatest step between neighbouring samples", DEG, null=math.nan, none="undefined")
    ]
    min_limit_distance: Annotated[
        float, Figure("least distance to a joint limit", DEG, null=math.nan, none="undefined")
    ]
    failures: Annotated[tuple[str, ...], Texts("one sentence per failed check")] = ()
    subject: str | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True)
class Certificate:
    """What is proven of the continuous motion, not of samples of it.

    Certified: no joint reverses, no limit is passed, every pose is in reach and clear of singularities, also where
    breakpoints are blended, and the claims hold. The arrays have shape (6,).
    """

    verdict: Annotated[
        Literal["certified", "refuted", "undecided"],
        Choice(words={"certified": "proven", "refuted": "proven to be wrong", "undecided": ""}),
    ]
    pieces: Annotated[int, Count("pieces into which the motion was cut")]
    min_rate: Annotated[Array, SixFigures("on the legs no joint moves slower", DEG_PER_MM)]
    # counted by the path that a blend replaces
    blend_min_rate: Annotated[Array, SixFigures("in the blends no joint moves slower; null without one", DEG_PER_MM)]
    limit_distance: Annotated[Array, SixFigures("no joint comes nearer to a limit", DEG)]
    reasons: Annotated[tuple[str, ...], Texts("what is refuted or undecided, one sentence each")] = ()
    curve: Annotated[
        Literal["any", "one_way", "parabola"] | None,
        Choice(
            "the blends of which it is proven",
            words={
                "any": "every mix of the velocities of the two moves",
                "one_way": "every mix in which the share of the second never falls",
                "parabola": "a parabola alone",
            },
            none="no blend, or nothing is proven",
            added=True,
        ),
    ] = None


@dataclass(frozen=True)
class Within:
    """How far a part may stand off where it was modelled: a bound of the placement error."""

    position: Annotated[float, Figure("its origin, along each axis of the part frame", MM, key="mm", least=0)]
    rotation: Annotated[float, Figure("turned about that origin, about any axis", DEG, key="deg", least=0)]


@dataclass(frozen=True)
class Optimality:
    """How much better a motion of straight legs could be, by a global search that bounds (theory §3).

    The bound of the travel is None where the planned motion does not keep the motion threshold, or where another
    criterion decides.
    """

    reversals_at_least: Annotated[float, Figure("no motion has fewer reversals (weighted)", least=0)]
    travel_at_least: Annotated[
        float | None,
        Figure(
            "none with so few reversals that keeps the threshold travels less",
            DEG,
            least=0,
            null=None,
            none="no bound",
        ),
    ]
    gap: Annotated[
        float | None,
        Figure(
            "what the planned motion travels above that, of its own travel",
            PERCENT,
            least=0,
            null=None,
            none="no bound",
        ),
    ]
    proven: Annotated[
        bool,
        Switch(
            "whether nothing was left undecided (without a motion: that there is none; below the motion threshold: "
            "that no motion with so few reversals keeps it; else: a gap of at most 0.1 %)"
        ),
    ]


@dataclass(frozen=True)
class Stroke:
    """One of several strokes of a hole: a motion of its own, from a stop outside the material to the next one.

    Attributes:
        answer: of the hole that ends where the stroke does (`zerorev.model.strokes.stroke_hole`), with the motion of
            the stroke and all that is said of that.
        tool: which of the job's tools makes it, from 0.
    """

    answer: HolePlan
    reversals_in_air: Annotated[
        int, Count("reversals outside the material since the stroke before; for the first one 0")
    ] = 0
    tool: Annotated[int, Count("which of the tools makes it, from 0")] = 0


@dataclass(frozen=True)
class HolePlan(Shown):
    """One hole's answer.

    The wrist's distance from the drill axis is the lever of the spin (theory §1). The deepest stroke is on the hole's
    own branch if it names one, of legs of the kind asked for.

    Attributes:
        hole: what was asked.
        status: `planned` (searched for), `evaluated` (given, not searched for), `infeasible` (no motion at all).
        motion: the motion, or None where there is none.
        score: what the motion does to the joints, or None.
        baseline: the same with constant spin, or None where that cannot be run.
        verified: the independent check, or None where it was not run.
        findings: what a user should know.
        certificate: the rigorous proof, or None where it was not asked for.
        measures: what the criteria measure of the motion, or None.
        optimality: how much better a motion could be, or None where that was not asked.
        critical_rates: twist rates at which the joints stand still at the motion's corner [rad/m], shape (6,); not
            finite where a joint has none; None without a motion.
        certified_within: every placement error of the part within these bounds is certified, too; None until proven.
        lost_motion: what the gears are predicted to add at the tip; None where the robot's masses are not known.
        corner: how the motion turns round; None without one, and in files of before it was said.
        feeds: of the plunge and of the retract [m/s]; None without a motion, and in files of before they were said.
        unlike: what the file, from which this was read, says of its strokes otherwise than of their motions, a sentence
            each.
        strokes_as_read: its list of strokes but for their answers, as plain data, where it says anything otherwise: it
            is given back as it was, for `check` to name it; else empty.
        strokes: all of them, of a hole that is drilled in several. Motion, corner and critical rates are those of the
            first one then, stand-offs counted from the hole's own target; the score is that of all together.
        clearance: how near it comes to what stands around; None where nothing is known to.
    """

    hole: Hole
    status: Literal["planned", "evaluated", "infeasible"]
    wrist_offset: Annotated[float, Figure("distance of the wrist centre from the drill axis", MM, least=0)]
    motion: Motion | None = None
    score: Score | None = None
    baseline: Baseline | None = None
    verified: Verification | None = None
    findings: tuple[Finding, ...] = ()
    certificate: Certificate | None = None
    measures: Measures[float] | None = None
    deepest: Annotated[
        float | None,
        Figure(
            "the deepest stroke without a reversal as the hole is drilled, 0: none; where chips are broken the deepest "
            "that was found, a lower bound that nothing proves",
            MM,
            least=0,
            null=None,
            none="not looked for",
            added=True,
        ),
    ] = None
    deepest_at_most: Annotated[
        float | None,
        Figure(
            "no stroke without a reversal is as deep, of straight or free legs as the settings say; null where chips "
            "are broken, for which neither bound holds",
            MM,
            least=0,
            null=None,
            none="not proven",
            added=True,
        ),
    ] = None
    optimality: Optimality | None = None
    critical_rates: Array | None = None
    certified_within: Within | None = None
    lost_motion: LostMotion | None = None
    corner: Corner | None = None
    cycle_time: Annotated[
        float | None,
        Figure("time of the hole's own moves at their feeds", S, least=0, null=None, none="no motion", added=True),
    ] = None
    feeds: tuple[float, float] | None = None
    strokes: tuple[Stroke, ...] = ()
    unlike: tuple[str, ...] = field(default=(), compare=False)
    strokes_as_read: tuple[Mapping[str, Any], ...] = field(default=(), compare=False)
    clearance: Clearance | None = None


@dataclass(frozen=True)
class Transition:
    """The move of all axes at once from where one hole ends to where the next one begins.

    Attributes:
        start: id of the hole that is left; None: the home position.
        to: id of the hole that is drilled next; None: the home position.
        joints: where it begins and ends, and between which points it stops [rad], shape (n, 6).
        findings: what a user should know of it.
        around: how near it comes to what stands around; None where nothing is known to.
    """

    start: str | None
    to: str | None
    joints: Array
    time: Annotated[float, Figure("all axes together, each with its greatest speed and acceleration", S, least=0)]
    changes_posture: Annotated[bool, Switch("whether the two ends are of different branches")]
    largest_axis_move: Annotated[float, Figure("greatest turn of one axis", DEG, least=0)]
    clearance: Annotated[
        float | None,
        Figure(
            "least distance of drill, tool and wrist from the part, to 0.01 mm; below 0 inside it",
            MM,
            null=None,
            none="not known",
            added=True,
        ),
    ] = None
    findings: tuple[Finding, ...] = ()
    around: Clearance | None = None


@dataclass(frozen=True)
class Plan(Shown):
    """A job's answer, hole by hole.

    Attributes:
        robot: the arm.
        tool: the drill.
        settings: how it was planned.
        holes: one answer a hole, in the job's order.
        T_base_part: part frame, shape (4, 4), translation [m].
        name: of the job.
        findings: about the whole plan.
        strokes: whether the stroke of each hole is the one `asked` for or its `deepest` without a reversal.
        order: ids of the holes that have a motion, as they are drilled; empty: as they are listed.
        transitions: the moves between them, in order.
        cycle_time: of the holes and transitions together [s]; None: not known.
        further: plans of the same holes for the further tools, in order.
    """

    robot: Robot
    tool: Tool
    settings: Settings
    holes: tuple[HolePlan, ...]
    T_base_part: Array = field(default_factory=lambda: np.eye(4))
    name: str = "job"
    findings: tuple[Finding, ...] = ()
    strokes: Strokes = "asked"
    order: tuple[str, ...] = ()
    transitions: tuple[Transition, ...] = ()
    cycle_time: float | None = None
    further: tuple[Plan, ...] = ()

    @property
    def of_all_tools(self) -> tuple[Plan, ...]:
        """This plan, of the first tool, and those of the further ones."""
        return (self, *self.further)

    @property
    def all_findings(self) -> tuple[Finding, ...]:
        """The plan's findings, then each hole's, then each transition's."""
        return (
            self.findings
            + tuple(finding for hole in self.holes for finding in hole.findings)
            + tuple(finding for move in self.transitions for finding in move.findings)
        )

    @property
    def in_order(self) -> tuple[HolePlan, ...]:
        """The holes as they are drilled, then those that have no motion."""
        place = {hole_id: n for n, hole_id in enumerate(self.order)}
        return tuple(sorted(self.holes, key=lambda hole: place.get(hole.hole.id, len(place))))


for _noun in (
    Finding,
    Corner,
    Event,
    LostMotionEvent,
    LostMotion,
    Score,
    Verification,
    Clearance,
    Baseline,
    Certificate,
    Within,
    Optimality,
    Stroke,
    HolePlan,
    Transition,
):
    _noun.__doc__ = with_attributes(_noun)
