"""The plan: what comes out, complete enough to be checked and exported alone."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from zerorev.model._arrays import Array
from zerorev.model.hole import Hole
from zerorev.model.job import Settings
from zerorev.model.measures import Measures, V
from zerorev.model.profile import Profile
from zerorev.model.robot import Robot
from zerorev.model.tool import Tool

__all__ = [
    "UNFINISHED",
    "Baseline",
    "Certificate",
    "Event",
    "Finding",
    "HolePlan",
    "Level",
    "Measures",
    "Motion",
    "Optimality",
    "Plan",
    "Score",
    "Strokes",
    "V",
    "Verification",
    "Within",
    "named_holes",
]

Level = Literal["error", "warning", "info"]
LegName = Literal["plunge", "target", "retract"]
Strokes = Literal["asked", "deepest"]

UNFINISHED = "unfinished"  # kind of the finding that holes of the job are missing from the plan
HOLES_NAMED = 6  # in one sentence; more are counted


def named_holes(ids: Iterable[str]) -> str:
    """`hole a`, or `holes a, b and 3 more`; an id that comes twice is named once."""
    ids = list(dict.fromkeys(ids))
    more = f" and {len(ids) - HOLES_NAMED:,} more" if len(ids) > HOLES_NAMED else ""
    return f"hole{'s' if len(ids) > 1 else ''} {', '.join(ids[:HOLES_NAMED])}{more}"


@dataclass(frozen=True)
class Finding:
    """Something a user should know about a plan or one of its holes.

    Attributes:
        level: `error` (no program can be made of it), `warning` (look at it first), `info`.
        kind: a fixed word for machines, e.g. `unreachable`, `limit`, `reversal`, `threshold`.
        message: one sentence for people.
        hole: the hole's id, or None where the whole plan is meant.
    """

    level: Level
    kind: str
    message: str
    hole: str | None = None


@dataclass(frozen=True)
class Event:
    """A reversal: where one joint changes direction.

    Attributes:
        joint: 1 to 6.
        leg: `plunge` or `retract` where it happens within a leg, `target` where it happens at the corner.
        standoff: where [m].
    """

    joint: int
    leg: LegName
    standoff: float


@dataclass(frozen=True)
class Score:
    """What a motion does to the joints.

    Attributes:
        reversals_per_joint: count of direction changes, shape (6,), int.
        events: where they happen, in order of motion.
        travel: sum over the joints of the angle moved [rad].
        min_rate: least |d theta / d path| at any point of the motion [rad/m], shape (6,) (rule `pointwise`).
        mean_rate: the lesser of the two legs' average |d theta / d path| [rad/m], shape (6,) (rule `mean`).
        limit_distance: least distance to a joint limit [rad], shape (6,); negative beyond it.
    """

    reversals_per_joint: tuple[int, ...]
    events: tuple[Event, ...]
    travel: float
    min_rate: Array
    mean_rate: Array
    limit_distance: Array

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
class Baseline:
    """The same hole drilled with constant spin psi = psi_start on the plan's branch."""

    reversals_per_joint: tuple[int, ...]
    travel: float  # [rad]

    @property
    def reversals(self) -> int:
        """Count of direction changes over all joints."""
        return sum(self.reversals_per_joint)


@dataclass(frozen=True)
class Verification:
    """What the independent check looked at, and what it found.

    Attributes:
        passed: whether the plan's claims hold.
        samples: points looked at on the two legs.
        blend_samples: points looked at on the blended corner.
        reversals_per_joint: as counted by the check, shape (6,).
        max_position_error: greatest distance between the tip by forward kinematics and the drill axis' point [m].
        max_rotation_error: greatest angle between the tool by forward kinematics and the one asked for [rad].
        max_joint_step: greatest joint step between neighbouring samples [rad].
        min_limit_distance: least distance to a joint limit [rad].
        failures: one sentence a failed check; empty where passed.
        subject: fingerprint of what was examined (`zerorev.verify.check.subject`); None where that is not known, as of
            what a plan file says.
    """

    passed: bool
    samples: int
    blend_samples: int
    reversals_per_joint: tuple[int, ...]
    max_position_error: float
    max_rotation_error: float
    max_joint_step: float
    min_limit_distance: float
    failures: tuple[str, ...] = ()
    subject: str | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True)
class Certificate:
    """What is proven of the continuous motion, not of samples of it (issue 3: a certificate).

    Attributes:
        verdict: `certified` (no joint reverses, no limit is passed, every pose is in reach and clear of singularities,
            also where breakpoints are blended, and the claims hold), `refuted` (something is proven to be wrong), or
            `undecided`.
        pieces: into how many the motion was cut.
        min_rate: no |d theta / d path| on the two legs is less [rad/m], shape (6,); NaN where nothing is proven.
        blend_min_rate: the same in the blends, counted by the path that a blend replaces; NaN without one.
        limit_distance: no distance to a joint limit is less [rad], shape (6,); NaN where nothing is proven.
        reasons: what is refuted or undecided, one sentence each; empty where certified.
    """

    verdict: Literal["certified", "refuted", "undecided"]
    pieces: int
    min_rate: Array
    blend_min_rate: Array
    limit_distance: Array
    reasons: tuple[str, ...] = ()


@dataclass(frozen=True)
class Within:
    """How far a part may stand off where it was modelled: a bound of the placement error.

    The origin of the part frame is off by at most so much along each of its axes, and the part is turned about that
    origin, about any axis, by at most so much.

    Attributes:
        position: along each axis of the part frame [m].
        rotation: about any axis [rad].
    """

    position: float
    rotation: float


@dataclass(frozen=True)
class Optimality:
    """How much better a motion of straight legs could be, by a global search that bounds (theory §3).

    Attributes:
        reversals_at_least: weighted count; no motion has fewer.
        travel_at_least: no motion that keeps the motion threshold with the planned reversals travels less [rad]; None
            where the planned one does not keep it, or where another criterion decides.
        gap: what the planned motion travels above that, as a share of its own travel; None likewise.
        proven: whether nothing was left undecided: without a motion, that there is none; of a motion below the motion
            threshold, that no motion with so few reversals keeps it; otherwise that the gap is at most 0.1 %.
    """

    reversals_at_least: float
    travel_at_least: float | None
    gap: float | None
    proven: bool


@dataclass(frozen=True)
class HolePlan:
    """One hole's answer.

    Attributes:
        hole: what was asked.
        status: `planned` (searched for), `evaluated` (given and looked at), `infeasible` (no motion at all).
        motion: the motion, or None where there is none.
        score: what the motion does to the joints, or None.
        baseline: the same with constant spin, or None where that cannot be run.
        verified: the independent check, or None where it was not run.
        findings: what a user should know.
        wrist_offset: distance of the wrist centre from the drill axis [m], the lever of the spin (theory §1).
        certificate: the rigorous proof, or None where it was not asked for.
        measures: what the criteria measure of the motion, or None.
        deepest: the deepest stroke without a reversal [m], on the hole's own branch if it names one; 0 where there is
            none, None where it was not looked for.
        deepest_at_most: no stroke without a reversal of legs of the kind asked for is as deep [m]; None: not proven.
        optimality: how much better a motion could be, or None where that was not asked.
        critical_rates: twist rates at which the joints stand still at the motion's corner [rad/m], shape (6,); not
            finite where a joint has none; None without a motion.
        certified_within: every placement error of the part within these bounds is certified, too; None until proven.
    """

    hole: Hole
    status: Literal["planned", "evaluated", "infeasible"]
    wrist_offset: float
    motion: Motion | None = None
    score: Score | None = None
    baseline: Baseline | None = None
    verified: Verification | None = None
    findings: tuple[Finding, ...] = ()
    certificate: Certificate | None = None
    measures: Measures[float] | None = None
    deepest: float | None = None
    deepest_at_most: float | None = None
    optimality: Optimality | None = None
    critical_rates: Array | None = None
    certified_within: Within | None = None


@dataclass(frozen=True)
class Plan:
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
    """

    robot: Robot
    tool: Tool
    settings: Settings
    holes: tuple[HolePlan, ...]
    T_base_part: Array = field(default_factory=lambda: np.eye(4))
    name: str = "job"
    findings: tuple[Finding, ...] = ()
    strokes: Strokes = "asked"

    @property
    def all_findings(self) -> tuple[Finding, ...]:
        """The plan's findings, then each hole's."""
        return self.findings + tuple(finding for hole in self.holes for finding in hole.findings)
