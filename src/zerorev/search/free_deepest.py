"""The deepest stroke of free legs, and a motion that reaches it but for a few per cent (theory §4).

Viable sets estimate how deep legs get that are any curves (`search.viable`). What a controller runs are straight
segments: `kernels.polyline` makes viable sets for these, with the breakpoints where the curve bends most, and a search
along the depth ends with the deepest pair of such legs. Limits of joints that can turn more than once round depend on
the turns: they are left out at first, and where a motion passes one the search is repeated with the turns that leave it
most room.

A greater bound on the twist rate never gives a lesser stroke: where it allows no curve to get deeper than a lesser
bound does, from a fixed series, the lesser bound is taken.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from zerorev.kernels import polyline as kernels
from zerorev.kernels.arm import angles_along
from zerorev.kernels.layout import Constraints
from zerorev.model._arrays import Array
from zerorev.model.job import Settings
from zerorev.model.profile import Profile
from zerorev.motion.drilling import Drilling
from zerorev.motion.evaluation import evaluated
from zerorev.search.segments import SegmentedLegs, breakpoints_of, motion_of
from zerorev.search.straight import constraints
from zerorev.search.viable import MOST_ROWS, ROWS, ROWS_SLACK, Family, Grain, Pair, Viable

__all__ = ["CLOSEST", "SEGMENTS", "Effort", "deepest_free"]

SEGMENTS = 64  # of a leg
KEPT_BACK = (0.001, 0.003, 0.01)  # of the deepest, so that legs keep away from the ends of the viable sets
CLOSE = 2e-3  # relative: to which the depth is located
FIRST, SHALLOWEST = 0.97, 0.1  # of the depth of all curves: where the search along the depth begins, and ends
SERIES = tuple(2.0**n for n in range(20, -8, -1))  # of bounds on the twist rate, times the length of the stretched arm
SAME = 5e-3  # relative: what a greater bound on the twist rate must gain to be tried
OWN = 1e-2  # the same of the bound that is set, against the series, which all bounds share
NEARLY = 0.97  # of the deepest: which lesser bounds may lead to better motions
GOOD = 0.9  # of the depth of all curves: a motion that is less deep was not found well
SHORT = 0.96  # of that depth: where a motion is less deep the sets, too, may be at fault, which jump what is thin


Deepest = tuple[float, Profile | None, int | None]  # depth [m], profile, branch


class Effort(NamedTuple):
    """How closely legs are searched.

    Attributes:
        rows: of the sets of spins, within the depth.
        finer: rows that are tried where the motion found with the first is well short of their sets; 0: none.
        segments: of a leg.
        guards: what joints keep beyond the threshold, for what lies between the points that are examined: what is tried
            one after the other [rad/m].
    """

    rows: int
    finer: int
    segments: int
    guards: tuple[float, ...]


USUAL = Effort(ROWS, 4 * ROWS, SEGMENTS, tuple(np.deg2rad([0.05, 0.2, 1.0, 4.0]).tolist()))
# for comparison: what legs of very many segments attain
CLOSEST = Effort(MOST_ROWS, 0, 8 * SEGMENTS, tuple(np.deg2rad([0.02, 0.2, 1.0, 4.0]).tolist()))


def deepest_free(drilling: Drilling, settings: Settings, effort: Effort = USUAL) -> Deepest:
    """The deepest stroke with zero reversals on free legs, and a motion that reaches it.

    Args:
        drilling: target, direction and reference of the spin; its `branch`, if any, is the only one searched; its
            depth does not matter.
        settings: `min_rate`, kept by every joint at every point; `max_twist`; `psi_bound`.
        effort: how closely legs are searched.

    Returns:
        depth [m], profile and branch; 0, None, None where no stroke has zero reversals.
    """
    best, short = _deepest(drilling, settings, effort, (0.0, None, None))
    if short and effort.finer:
        best, _ = _deepest(drilling, settings, effort._replace(rows=effort.finer), best)
    return best


def _deepest(drilling: Drilling, settings: Settings, effort: Effort, best: Deepest) -> tuple[Deepest, bool]:
    """The deepest stroke with the bound on the twist rate or a lesser one; and whether one is far short of its sets."""
    short = False
    for steepest in (settings.max_twist, *_gentler(settings.max_twist, drilling.robot.reach)):
        search = _Search(drilling, replace(settings, max_twist=steepest), effort)
        pairs = search.viable.pairs(best[0])
        best = max(best, search.best(pairs, best[0]), key=lambda deepest: deepest[0])
        short = short or bool(pairs and best[0] < SHORT * pairs[0].depth)
        if not pairs or best[0] > GOOD * pairs[0].depth:
            break
    return best, short


def _gentler(steepest: float, reach: float) -> Iterator[float]:
    """The lesser bounds on the twist rate of a fixed series [rad/m], greatest first."""
    return (bound / reach for bound in SERIES if bound / reach < steepest)


class _Curves(NamedTuple):
    """How deep curves get with a bound on the twist rate.

    Attributes:
        depth: [m].
        steepest: the bound [rad/m].
        grain: with which that was found.
    """

    depth: float
    steepest: float
    grain: Grain


class _Search:
    """One hole, and the deepest legs of straight segments out of its target."""

    def __init__(self, drilling: Drilling, settings: Settings, effort: Effort) -> None:
        self.drilling, self.settings, self.effort = drilling, settings, effort
        robot = drilling.robot
        self.constraints = constraints(
            drilling, settings, settings.min_rate, slack=ROWS_SLACK, steepest=settings.max_twist
        )
        branches = np.array([drilling.hole.branch in (None, branch) for branch in range(8)])
        self.viable = Viable(robot.arm, drilling.plane, self.constraints, branches, robot.reach, effort.rows)
        self.beyond: SegmentedLegs | None = None  # what passed a limit last
        self.shares = 0.5 - 0.5 * np.cos(np.linspace(0, np.pi, kernels.SAMPLES))

    def best(self, pairs: list[Pair], enough: float) -> Deepest:
        """The deepest motion of some pairs, if it is deeper than `enough`: depth, profile and branch."""
        best: Deepest = (enough, None, None)
        done: list[Family] = []
        for pair in pairs:
            if pair.depth <= best[0]:
                break
            if any(pair.family is family for family in done):
                continue  # where no limit tells them apart, the wrist flips have the same motions
            found = self.deepest(pair, best[0])
            if found is not None:
                best = max(best, (float(found.standoff[0]), found, pair.branch), key=lambda deepest: deepest[0])
                if not pair.limited:
                    done.append(pair.family)
        return best

    def deepest(self, pair: Pair, enough: float) -> Profile | None:
        """The deepest motion of a pair, if it is deeper than `enough`."""
        best, depth = None, enough
        for curves in self.series(pair):
            if curves.depth <= depth:
                break
            self.viable.constraints = self.constraints._replace(steepest=curves.steepest)
            self.viable.bound(pair.family, pair.branch, True, curves.grain)
            found = self.polyline(pair, curves)
            if found is None and self.beyond is not None:
                found = self.within_turns(pair, self.beyond)
            if found is not None and found.standoff[0] > depth:
                best, depth = found, float(found.standoff[0])
        return best

    def series(self, pair: Pair) -> list[_Curves]:
        """How deep a pair gets with the bound on the twist rate and lesser ones, from the deepest on.

        A bound that gets no deeper than a lesser one does is left out, so that a motion found with a bound is a
        candidate with every greater one.
        """
        found: list[_Curves] = []
        for steepest in (self.constraints.steepest, *_gentler(self.constraints.steepest, self.viable.stretched)):
            self.viable.constraints = self.constraints._replace(steepest=steepest)
            found.append(self.alone(pair))
            if found[-1].depth < NEARLY * found[0].depth:
                break
        kept: list[_Curves] = []
        for curves in reversed(found):
            own = OWN if curves is found[0] else SAME
            if not kept or curves.depth > kept[-1].depth * (1 + own):
                kept.append(curves)
        return kept[::-1]

    def alone(self, pair: Pair) -> _Curves:
        """How deep a pair gets: of nothing but the pair and the bound on the twist rate; its tubes are left as made."""
        sets = self.viable
        bound = sets.bound(pair.family, pair.branch, True, sets.coarse)
        grain = Grain.of(bound, sets.rows)
        bound = sets.bound(pair.family, pair.branch, True, grain)
        depth = sets.depth(pair.family, pair.branch, True, grain, SHALLOWEST * bound, bound) if bound > 0 else 0.0
        return _Curves(depth, sets.constraints.steepest, grain)

    def polyline(self, pair: Pair, curves: _Curves) -> Profile | None:
        """The deepest motion of straight segments that is found, given how deep curves get."""
        self.beyond = None
        depth, grain = curves.depth, curves.grain
        part = self.breakpoints(pair, grain, depth)
        if part is None:
            return None
        for guard in self.effort.guards:
            guarded = self.viable.constraints._replace(min_rate=self.constraints.min_rate + guard)
            deepest = self.closed_in(pair, guarded, grain, part, depth)
            for back in KEPT_BACK:
                legs = self.legs(pair, guarded, grain, part, deepest * (1 - back))
                if legs is None:
                    continue
                found = self.accepted(pair, legs)
                if found is not None:
                    return found
                if self.beyond is not None:
                    return None
        return None

    def within_turns(self, pair: Pair, legs: SegmentedLegs) -> Profile | None:
        """The deepest motion with the turns at the target that fit legs best which pass a limit.

        Only of joints that can turn more than once round: of the others the turns are known.
        """
        joints = np.empty((2, self.effort.segments + 1, 6))
        for k in range(2):
            angles_along(
                self.drilling.robot.arm, self.viable.plane, legs.standoff[k], legs.psi[k], pair.branch, joints[k]
            )
        joints = np.unwrap(np.concatenate([joints[0, ::-1], joints[1, 1:]]), axis=0)
        limits = self.drilling.limits
        middle = 0.5 * (joints.min(axis=0) + joints.max(axis=0))
        turns = 2 * np.pi * np.rint((0.5 * (limits.lower + limits.upper) - middle) / (2 * np.pi))
        at_target = self.viable.room[-1]
        wide = (limits.upper - limits.lower >= 2 * np.pi) & np.isfinite(limits.upper - limits.lower)
        at_target[wide] = (joints[self.effort.segments] + turns)[wide]
        curves = self.alone(pair)
        found = self.polyline(pair, curves) if curves.depth > 0 else None
        at_target[:] = np.nan
        return found

    def breakpoints(self, pair: Pair, grain: Grain, depth: float) -> Array | None:
        """Where segments meet, as shares of the depth, shape (2, N + 1): close together where the slope changes."""
        sets, out = self.viable, np.empty((2, self.effort.segments + 1))
        if not self.meets(pair, grain, depth * (1 - CLOSE)):
            return None
        psi_t = sets.overlap.mean()
        for k in range(2):
            rows = int(sets.viable.rows[k])
            tube = tuple(each[k] for each in sets.viable.raw)
            path, corridor = np.empty(rows), np.empty((rows, 2))
            kernels.follow(
                sets.arm, sets.plane, pair.branch, (1 - 2 * k) * pair.family.sense, sets.constraints, grain, tube, rows,
                psi_t, sets.room, path, corridor,
            )  # fmt: skip
            out[k] = breakpoints_of(tube[0][:rows], path, self.effort.segments)
        return out

    def meets(self, pair: Pair, grain: Grain, depth: float) -> bool:
        """Whether curves get to a depth; the viable sets are left as made."""
        return self.viable.depth(pair.family, pair.branch, True, grain, depth, depth) > 0

    def closed_in(self, pair: Pair, guarded: Constraints, grain: Grain, part: Array, depth: float) -> float:
        """The greatest depth to which segments are found [m]."""
        low, high, trial = SHALLOWEST * depth, depth, FIRST * depth
        while high - low > CLOSE * depth:
            if self.width(pair, guarded, grain, part, trial)[0] >= 0:
                low = trial
            else:
                high = trial
            trial = 0.5 * (low + high)
        return low

    def width(self, pair: Pair, guarded: Constraints, grain: Grain, part: Array, depth: float) -> tuple[float, Array]:
        """See `kernels.polyline.pair_width`; its result, and the viable spins at the breakpoints."""
        sets, spins = self.viable, np.empty((*part.shape, 2))
        wide = kernels.pair_width(
            sets.arm, sets.plane, pair.branch, pair.family.sense, sets.constraints, guarded, True, grain, depth, part,
            self.shares, sets.room, sets.reached.raw, sets.reached.rows, sets.viable.raw, sets.viable.rows, spins,
            sets.overlap,
        )  # fmt: skip
        return float(wide), spins

    def legs(self, pair: Pair, guarded: Constraints, grain: Grain, part: Array, depth: float) -> SegmentedLegs | None:
        """Two legs of a depth, through the middle of what is viable."""
        wide, spins = self.width(pair, guarded, grain, part, depth)
        if wide < 0:
            return None
        sets, psi = self.viable, np.empty(part.shape)
        psi[:, 0] = sets.overlap.mean()
        for k in range(2):
            if not kernels.leg_out(
                sets.arm, sets.plane, pair.family.posture, (1 - 2 * k) * pair.family.sense, guarded, part[k] * depth,
                self.shares, sets.room[0], spins[k], psi[k],
            ):  # fmt: skip
                return None
        return SegmentedLegs(part * depth, psi)

    def accepted(self, pair: Pair, legs: SegmentedLegs) -> Profile | None:
        """The motion of two legs, if it has no reversal and keeps the threshold."""
        profile = motion_of(legs, periodic=self.settings.psi_bound is None)
        seen = evaluated(self.drilling.deep(legs.depth), profile, pair.branch, self.settings)
        self.beyond = legs if any(finding.kind == "limit" for finding in seen.findings) else None
        score = seen.score
        good = score is not None and score.reversals == 0 and score.min_rate.min() >= self.settings.min_rate
        return profile if good else None
