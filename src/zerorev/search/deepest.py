"""The deepest stroke of a hole that has no reversal, over all branches (theory §4).

A leg that keeps its directions to some depth keeps them to any lesser one, so the greatest margin that a pair of legs
can have falls as the stroke grows. A coarse sample at growing depths shows which spins at the target are in question.
From each of those that are left the two legs are improved, with the depth as one of their unknowns, until no gain is
possible. The deepest is taken.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from zerorev.kernels import legs, pairs
from zerorev.kernels.layout import LONGEST_TWIST, Constraints
from zerorev.model._arrays import Array
from zerorev.model.hole import Hole
from zerorev.model.job import Settings
from zerorev.model.profile import Profile
from zerorev.model.resized import resized_profile
from zerorev.model.robot import Robot
from zerorev.model.tool import Tool
from zerorev.motion.drilling import Drilling
from zerorev.motion.evaluation import evaluated
from zerorev.search.free_deepest import deepest_free
from zerorev.search.rank import Candidate
from zerorev.search.segments import STEPS, Goal, SegmentedLegs, improved, motion_of, sense_at
from zerorev.search.straight import GRID, LEAST_RATE, constraints, target_spins

__all__ = ["WORTH_RAISING", "Deepest", "deepened", "deepest_of", "deepest_stroke"]

FIRST_DEPTH = 0.06  # of the stretched arm's length: about what a middling hole allows
STEP = 1.5  # from one depth of the coarse sample to the next
MOST_DEPTHS = 16
SHALLOWEST = 1e-4  # of the stretched arm's length: a stroke that is none
SAMPLES = 9  # points of a leg
WORTH_RAISING = 1e-4  # relative
ROUGH, ENOUGH = 1e-6, 1e-7  # relative: a smaller gain does not count
DESCENTS = 10  # from the end of a valley, at most
ENOUGH_LACK = 1e-6  # [rad/m]
SHORTER = 0.4  # of the legs of a start
SPARE = 1e-3 * LEAST_RATE  # kept to the threshold, for rounding
# points of a leg, and shares of the depth kept back: at the deepest a joint stops, so a plan ends a little before,
# and where rates change steeply next to the end of the reach it takes many points to see that it does
CLOSER = ((33, (1e-5,)), (65, (1e-5,)), (257, (1e-5, 1e-4, 1e-3, 3e-3, 6e-3, 1e-2)))


@dataclass(frozen=True)
class Deepest:
    """The deepest stroke of a hole, and the motion that reaches it.

    Attributes:
        depth: [m]; 0 where no stroke, however short, has zero reversals.
        profile: two legs of that stroke, or None.
        branch: 0..7, or None.
        beyond_cap: of free legs, how deep straight ones go that twist more than `max_twist` [m]; 0 where no deeper.
        at_most: no stroke of such legs is as deep [m]; None: not proven.
    """

    depth: float
    profile: Profile | None = None
    branch: int | None = None
    beyond_cap: float = 0.0
    at_most: float | None = None

    def resized(self, factor: float) -> Deepest:
        """The same at another size."""
        profile = None if self.profile is None else resized_profile(self.profile, factor)
        return Deepest(self.depth * factor, profile, self.branch, self.beyond_cap * factor)


def deepest_stroke(robot: Robot, tool: Tool, hole: Hole, settings: Settings | None = None) -> Deepest:
    """The greatest stroke that still has zero reversals (theory §4); the hole's own depth is not examined.

    Args:
        robot: the arm.
        tool: the drill.
        hole: target, direction and reference of the spin; its `branch`, if any, is the only one searched.
        settings: whose `min_rate` every joint keeps at every point, whose `psi_bound` holds the spin, and whose `legs`
            are straight, or free with twist rates up to `max_twist`.
    """
    settings = settings or Settings()
    return deepest_of(Drilling(robot, tool, hole, settings.limit_margin), settings)


def deepest_of(drilling: Drilling, settings: Settings) -> Deepest:
    """`deepest_stroke` of a hole whose twist plane is known."""
    size = drilling.robot.size
    if size != 1:
        # the tolerances of the search are made for one size of arm
        return deepest_of(*drilling.resized(settings, 1 / size)).resized(size)
    straight = _Search(drilling, settings).run()
    if settings.legs == "straight":
        return straight
    free = Deepest(*deepest_free(drilling, settings))
    steepest = 0.0 if straight.profile is None else float(np.abs(straight.profile.twist_rate).max())
    beyond = 0.0
    if straight.depth > free.depth and steepest > settings.max_twist:
        beyond = straight.depth
        straight = _Search(drilling, settings, steepest=settings.max_twist).run()
    return replace(straight if straight.depth > free.depth else free, beyond_cap=beyond)


def deepened(drilling: Drilling, settings: Settings, motion: Candidate) -> Deepest:
    """The deepest stroke to which a motion leads; its own depth, at least.

    Args:
        drilling: target, direction and reference of the spin.
        settings: as for `deepest_stroke`.
        motion: of zero reversals, every joint of which keeps `min_rate` at every point.
    """
    own = Deepest(motion.depth, motion.profile, motion.branch)
    if motion.profile.psi.size > 3:
        return own
    steepest = settings.max_twist if settings.legs == "free" else np.inf
    deeper = _Search(drilling, settings, steepest=steepest).run_from(motion)
    # a smaller gain does not count, so that from the end of a valley the search does not continue
    return deeper if deeper.depth > own.depth * (1 + WORTH_RAISING) else own


@dataclass(frozen=True)
class _Start:
    """Two legs from which to go deeper.

    Attributes:
        posture: 0..3.
        legs: the two.
    """

    posture: int
    legs: SegmentedLegs


@dataclass(frozen=True)
class _End:
    """The deepest legs of a valley.

    Attributes:
        legs: the two.
        branch: 0..7.
        sense: signs of the outward rates of the first leg on the unflipped wrist, shape (6,).
    """

    legs: SegmentedLegs
    branch: int
    sense: Array


class _Search:
    """One hole, and its deepest pairs of straight legs."""

    def __init__(self, drilling: Drilling, settings: Settings, *, steepest: float = np.inf) -> None:
        robot, hole = drilling.robot, drilling.hole
        self.drilling, self.arm, self.plane = drilling, robot.arm, drilling.plane
        self.branches = np.array([hole.branch in (None, branch) for branch in range(8)])
        self.stretched = robot.reach
        self.min_rate = max(settings.min_rate, LEAST_RATE)
        self.psi_bound = settings.psi_bound
        self.psi = target_spins(settings.psi_bound, GRID)
        self.rules = constraints(drilling, settings, settings.min_rate, steepest=steepest)
        self.valleys: set[tuple[int, float, float]] = set()  # gone down: posture, depth, spin at the target
        self.unlimited = self.rules.unlimited()

    def run(self) -> Deepest:
        """Look coarsely at growing depths, then go from the deepest that seem possible to the end of each valley."""
        ends: list[_End] = []
        for depth, found in reversed(self._samples()):
            for start in self._starts(depth, found):
                ends += self._deepened(start, max((end.legs.depth for end in ends), default=0.0))
            if any(end.legs.depth >= depth for end in ends):
                break  # what a coarse sample does not think so deep is left out
        return self._deepest(ends)

    def run_from(self, motion: Candidate) -> Deepest:
        """To the end of the valley in which a motion lies."""
        plunge, retract = motion.profile.twist_rate
        psi = motion.psi_target + motion.depth * np.array([[0.0, max(plunge, retract)], [0.0, min(plunge, retract)]])
        start = _Start(motion.branch // 2, SegmentedLegs(np.array([[0.0, motion.depth]] * 2), psi))
        return self._deepest(self._deepened(start, 0.0))

    def _deepest(self, ends: list[_End]) -> Deepest:
        """The deepest motion without a reversal at the ends of some valleys."""
        for end in sorted(ends, key=lambda end: -end.legs.depth):
            settled = self._settled(end)
            if settled is not None:
                return settled
        return Deepest(0.0)

    def constraints_at(self, depth: float) -> Constraints:
        """What legs of a depth are held to."""
        return self.rules._replace(depth=depth, steepest=min(LONGEST_TWIST / depth, self.rules.steepest))

    def _samples(self) -> list[tuple[float, Array]]:
        """Depths at which some pair may do, least first, and what coarse samples found there, shape (4, K, SAMPLED)."""
        depth = FIRST_DEPTH * self.stretched
        found = self._look(depth, self._every_other())
        while not self._alive(found).any() and depth > SHALLOWEST * self.stretched:
            depth /= STEP
            found = self._look(depth, self._every_other())
        samples: list[tuple[float, Array]] = []
        while self._alive(found).any() and len(samples) < MOST_DEPTHS:
            samples.append((depth, found))
            depth *= STEP
            found = self._look(depth, self._around(self._alive(found)))
        return samples

    def _alive(self, found: Array) -> npt.NDArray[np.bool_]:
        return np.asarray(found[..., pairs.MARGIN_SAMPLED] > self.min_rate)

    def _every_other(self) -> npt.NDArray[np.bool_]:
        """Every other line of the grid, shape (8, K): enough as long as much is alive."""
        lines = np.repeat(self.branches[:, None], self.psi.size, axis=1)
        lines[:, 1::2] = False
        return lines

    def _around(self, alive: npt.NDArray[np.bool_]) -> npt.NDArray[np.bool_]:
        """Lines of the grid, shape (8, K), around those alive: what lacks margin lacks it at any greater depth."""
        for _ in range(2):  # the neighbours, because a grid is a grid, and because every other line was left out
            alive = alive | np.roll(alive, 1, axis=1) | np.roll(alive, -1, axis=1)
        return np.asarray(self.branches[:, None] & np.repeat(alive, 2, axis=0))

    def _look(self, depth: float, lines: npt.NDArray[np.bool_]) -> Array:
        out, wanted, keep = (
            np.empty((4, self.psi.size, pairs.SAMPLED)),
            self.constraints_at(depth),
            np.ones(6, dtype=bool),
        )
        pairs.sample_line(self.arm, self.plane, self.psi, lines, keep, wanted, legs.TRAVEL, self.min_rate, out)
        return out

    def _starts(self, depth: float, found: Array) -> list[_Start]:
        """Pairs at the local maxima of what the margin may be, over the spins of the grid, highest first."""
        margin = np.where(self._alive(found), found[..., pairs.MARGIN_SAMPLED], -np.inf)
        peaks = margin > -np.inf
        for away in (1, 2):  # two, where every other line was left out
            left, right = np.roll(margin, away, axis=1), np.roll(margin, -away, axis=1)
            if self.psi_bound is not None:
                left[:, :away] = right[:, -away:] = -np.inf
            peaks &= (margin >= left) & (margin > right)
        starts = []
        for posture, n in sorted(np.argwhere(peaks).tolist(), key=lambda peak: (-margin[*peak], peak)):
            psi = self.psi[n] + depth * np.append(0.0, found[posture, n, pairs.SLOPES_SAMPLED :])
            starts.append(_Start(posture, SegmentedLegs(np.array([[0.0, depth]] * 2), psi[[[0, 1], [0, 2]]])))
        return starts

    def _deepened(self, start: _Start, beaten: float) -> list[_End]:
        """The deepest legs from a start on the branches of its posture; none where they are no deeper than `beaten`."""
        sense = sense_at(self.arm, self.plane, start.posture, float(start.legs.psi[0, 0]))
        if sense is None:
            return []
        # limits seldom bind: what is deepest without them is often within them, and nothing is deeper
        deepest, _ = self._go(
            2 * start.posture, sense, self.unlimited, start.legs, "depth", SAMPLES, enough=ROUGH, weighed=True
        )
        ends = []
        valley = start.posture, round(deepest.depth / self.stretched, 4), round(float(deepest.psi[0, 0]), 3)
        if deepest.depth > beaten and valley not in self.valleys:
            self.valleys.add(valley)
            for branch in (2 * start.posture, 2 * start.posture + 1):
                if not self.branches[branch]:
                    continue
                _, lack = self._go(branch, sense, self.rules, deepest, "depth", SAMPLES, steps=0, weighed=True)
                if lack <= ENOUGH_LACK:
                    ends.append(_End(deepest, branch, sense))
                    continue
                # which limit is met first depends on where one comes from, so from shorter legs, too
                for begin in (start.legs, _shortened(start.legs, SHORTER)):
                    legs, lack = self._go(
                        branch, sense, self.rules, begin, "depth", SAMPLES, enough=ROUGH, weighed=True
                    )
                    if lack <= ENOUGH_LACK:
                        ends.append(_End(legs, branch, sense))
        return ends

    def _go(
        self, branch: int, sense: Array, rules: Constraints, legs: SegmentedLegs, goal: Goal, samples: int, *,
        steps: int = STEPS, enough: float = ENOUGH, weighed: bool = False,
    ) -> tuple[SegmentedLegs, float]:  # fmt: skip
        return improved(
            self.arm, self.plane, branch, sense, rules, legs, goal,
            samples=samples, steps=steps, enough=enough, weighed=weighed,
        )  # fmt: skip

    def _settled(self, end: _End) -> Deepest | None:
        """The deepest stroke of a valley whose motion, followed closely, has no reversal."""
        rules = self.rules._replace(min_rate=self.min_rate + SPARE)
        for stage, (samples, shares) in enumerate(CLOSER):
            deepest = self._deepest_legs(end, rules, samples)
            if stage:  # next to a singularity what is weighed seems to be missing less than it is
                deepest, _ = self._go(end.branch, end.sense, rules, deepest, "depth", samples)
            for kept_back in shares:
                room = _shortened(deepest, 1 - kept_back)
                room, _ = self._go(end.branch, end.sense, rules, room, "margin", samples)
                profile = motion_of(room, periodic=self.psi_bound is None)
                score = evaluated(self.drilling.deep(room.depth), profile, end.branch).score
                if score is not None and score.reversals == 0 and score.min_rate.min() >= self.min_rate:
                    return Deepest(room.depth, profile, end.branch)
        return None

    def _deepest_legs(self, end: _End, rules: Constraints, samples: int) -> SegmentedLegs:
        """The legs of a valley's end as deep as they go, closely examined; on flat ground one descent ends too soon."""
        legs = end.legs
        for _ in range(DESCENTS):
            before = legs.depth
            legs, _ = self._go(end.branch, end.sense, rules, legs, "depth", samples, weighed=True)
            if legs.depth <= before * (1 + WORTH_RAISING):
                break
        return legs


def _shortened(legs: SegmentedLegs, share: float) -> SegmentedLegs:
    """The inner part of two legs."""
    return SegmentedLegs(legs.standoff * share, legs.psi[:, :1] + share * (legs.psi - legs.psi[:, :1]))
