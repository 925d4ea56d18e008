"""Pairs of legs out of the target, many at a time, judged by their legs alone (theory §3).

Every criterion is taken leg by leg and then joined: added up (travel), or the worse of the two (margin, compliance,
manipulability, distance to limits).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar, NamedTuple

import numpy as np
import numpy.typing as npt

from zerorev.kernels.arm import flip_sign
from zerorev.kernels.field import rates as rate_fields
from zerorev.kernels.layout import TwistPlane
from zerorev.kernels.legs import NIL
from zerorev.model._arrays import Array
from zerorev.model.job import Settings
from zerorev.model.measures import CRITERIA, Measures
from zerorev.model.robot import JointLimits
from zerorev.motion.criteria import AT_POSES, Poses, objective_of, worst
from zerorev.motion.drilling import Drilling
from zerorev.motion.joint_path import JUMP, turns_within
from zerorev.motion.loads import leg_gives, pair_lost_motion
from zerorev.search.straight import LEAST_RATE, LIMIT_SLACK, steepest_twist

__all__ = ["FINE_NODES", "NODES", "LegPairs", "LegRows", "Point", "Sides", "turns_round"]

CLOSER_SLOPES = 6  # around the greatest margin
NODES, FINE_NODES = 25, 97  # points on a leg; odd, for Simpson's rule
HALF_TURNS = np.pi * np.array([0, 0, 0, 1, 0, 1])

Mask = npt.NDArray[np.bool_]
Counts = npt.NDArray[np.int64]


class Point(NamedTuple):
    """Two legs out of one spin at the target, and what they cost."""

    cost: float
    branch: int
    psi_t: float
    slopes: tuple[float, float]


class Sides(NamedTuple):
    """Where legs start, and what they are held to: one row for each leg of a pair at each spin.

    Attributes:
        branch: 0..7.
        psi_t: spin at the target [rad], shape (R,).
        sense: wanted sign of each joint's outward rate at the target, shape (R, 6).
        inside: how often each joint may turn round within the leg, shape (R, 6).
        keep: whether a joint is to keep the motion threshold, shape (6,).
        room: how far each joint may go down and up from where it is at the target [rad], shape (R, 2, 6).
    """

    branch: int
    psi_t: Array
    sense: Array
    inside: Counts
    keep: Mask
    room: Array


class LegRows(NamedTuple):
    """Admissible legs, in order of their rows, and what they are worth; shape (n,), extents (n, 6).

    `at_poses` has a column for each criterion of a pose (`zerorev.motion.criteria.AT_POSES`), NaN where it does not
    weigh. `gives` is where the gears let the tip go along each leg (`zerorev.motion.loads.leg_gives`), of no size where
    the lost motion does not weigh.
    """

    row: Counts
    slope: Array
    margin: Array
    travel: Array
    low: Array
    high: Array
    at_poses: Array
    gives: Array

    def of(self, chosen: Mask | slice) -> LegRows:
        """Some of them."""
        return LegRows(self.row[chosen], *(values[chosen] for values in self[1:]))

    def flipped(self) -> LegRows:
        """The same legs on the other wrist flip: joints 4 and 6 half a turn on, joint 5 with the other sign.

        What the gears do is left as it was: the links of the wrist weigh little.
        """
        low, high = self.low + HALF_TURNS, self.high + HALF_TURNS
        low[:, 4], high[:, 4] = -self.high[:, 4], -self.low[:, 4]
        return self._replace(low=low, high=high)


@dataclass(frozen=True)
class LegPairs:
    """One hole, and what is asked of the legs out of its target.

    Attributes:
        drilling: robot, tool and hole.
        settings: motion threshold, bound on the spin, turns, weights.
        bisections: to locate the end of an interval of slopes, sampled as usual and closely.
    """

    drilling: Drilling
    settings: Settings
    bisections: ClassVar[tuple[int, int]] = (8, 24)

    @cached_property
    def plane(self) -> TwistPlane:
        """The hole's twist plane."""
        return self.drilling.plane

    def rates(self, branch: int, psi_t: Array, slope: Array, nodes: int) -> Array:
        """Outward rates [rad/m] along legs, shape (6, n, nodes); NaN out of reach.

        Args:
            branch: 0..7.
            psi_t: spins at the target [rad], shape (n,).
            slope: twist rates [rad/m], shape (n,).
            nodes: points on a leg.
        """
        standoff = np.tile(np.linspace(0.0, self.drilling.hole.depth, nodes), (psi_t.size, 1))
        psi = psi_t[:, None] + slope[:, None] * standoff
        theta_s, theta_psi = np.empty((2, 6, psi.size))
        rate_fields(self.drilling.robot.arm, self.plane, branch // 2, standoff.ravel(), psi.ravel(), theta_s, theta_psi)
        rates = theta_s.reshape(6, *psi.shape) + slope[:, None] * theta_psi.reshape(6, *psi.shape)
        rates[4] *= flip_sign(self.drilling.robot.arm, branch)
        return rates

    def judged(self, sides: Sides, row: Counts, slope: Array, least: float, nodes: int) -> tuple[Array, Array]:
        """The slack of each leg [rad/m], below 0 where it is not admissible, and its margin [rad/m], each (n,).

        Args:
            sides: what the legs are held to.
            row: of each leg, shape (n,).
            slope: twist rates [rad/m], shape (n,).
            least: motion threshold [rad/m].
            nodes: points on a leg.
        """
        psi_t, depth = sides.psi_t[row], self.drilling.hole.depth
        rates = self.rates(sides.branch, psi_t, slope, nodes) * sides.sense[row].T[..., None]
        slowest, mean = _least(rates), _mean(rates)
        spare = slowest - LEAST_RATE
        if self.settings.min_rate_rule == "mean":
            slowest = mean
        spare[sides.keep] = np.minimum(spare, slowest - max(least, LEAST_RATE))[sides.keep]
        for i in np.flatnonzero(sides.inside.any(axis=0)):
            # a joint that turns round within a leg has no least rate; it must only not do so more often
            fits = (turns_round(rates[i]) <= sides.inside[row, i]) & (rates[i, :, 0] > 0)
            spare[i] = np.where(sides.inside[row, i] > 0, np.where(fits, np.inf, -1.0), spare[i])
        end = mean * sides.sense[row].T * depth  # exact where a joint keeps its direction
        worst = np.minimum(spare, np.minimum(end + sides.room[row, 0].T, sides.room[row, 1].T - end)).min(axis=0)
        worst[np.isnan(worst) | (np.abs(slope) > steepest_twist(self.settings, depth))] = -np.inf
        if self.settings.psi_bound is not None:
            worst[np.abs(psi_t + slope * depth) > self.settings.psi_bound] = -np.inf
        return worst, slowest[sides.keep].min(axis=0, initial=np.inf)

    def slack(self, sides: Sides, row: Counts, slope: Array, least: float, nodes: int) -> Array:
        """The slack of each leg, shape (n,), below 0 where it is not admissible; see `judged`."""
        return self.judged(sides, row, slope, least, nodes)[0]

    def slopes(self, sides: Sides, slopes: Array, least: float, *, fine: bool) -> tuple[Counts, Array]:
        """Of given slopes the admissible ones, with the ends of their intervals: rows and slopes, each (n,).

        Args:
            sides: what the legs are held to.
            slopes: in order, for each row, shape (R, M).
            least: motion threshold [rad/m].
            fine: whether to sample closely.
        """
        nodes, ends = FINE_NODES if fine else NODES, self.bisections[fine]
        rows = np.arange(len(slopes))

        def spare(row: Counts, slope: Array) -> Array:
            return self.slack(sides, row, slope, least, nodes)

        def spare_at(slopes: Array) -> Array:
            return spare(np.repeat(rows, slopes.shape[1]), slopes.ravel()).reshape(slopes.shape)

        spared = spare_at(slopes)
        # an interval between two slopes lies around the greatest margin
        peak = spared.argmax(axis=1)
        before, after = slopes[rows, np.maximum(peak - 1, 0)], slopes[rows, np.minimum(peak + 1, slopes.shape[1] - 1)]
        closer = np.linspace(before, after, CLOSER_SLOPES + 2, axis=1)[:, 1:-1]
        order = np.argsort(both := np.hstack([slopes, closer]), axis=1)
        slopes = np.take_along_axis(both, order, axis=1)
        admissible = np.take_along_axis(np.hstack([spared, spare_at(closer)]), order, axis=1) >= 0

        row, j = np.nonzero(admissible[:, 1:] != admissible[:, :-1])
        good = np.where(admissible[row, j], slopes[row, j], slopes[row, j + 1])
        bad = np.where(admissible[row, j], slopes[row, j + 1], slopes[row, j])
        for _ in range(ends if row.size else 0):
            middle = (good + bad) / 2
            fits = spare(row, middle) >= 0
            good, bad = np.where(fits, middle, good), np.where(fits, bad, middle)
        return np.concatenate([np.nonzero(admissible)[0], row]), np.concatenate([slopes[admissible], good])

    def followed(self, sides: Sides, row: Counts, slope: Array, least: float, nodes: int) -> LegRows:
        """Admissible legs, with all that the criteria take of them; those that jump are left out.

        The margin is taken from the nodes asked for; all else varies slowly and is taken from NODES.
        """
        order = np.argsort(row, kind="stable")
        row, slope = row[order], slope[order]
        margin = self.judged(sides, row, slope, least, nodes)[1]
        standoff = np.linspace(0.0, self.drilling.hole.depth, NODES)
        psi = sides.psi_t[row, None] + slope[:, None] * standoff
        joints = np.unwrap(self.drilling.angles_on(sides.branch, standoff, psi), axis=1)
        steps = np.abs(np.diff(joints, axis=1))
        weighed = [name for name in AT_POSES if name in dict(self.settings.weights)]
        figures, unweighed = worst(Poses(self.drilling, self.settings, joints), weighed), np.full(row.shape, np.nan)
        at_poses = np.stack([figures.get(name, unweighed) for name in AT_POSES], axis=-1)
        travel = steps.sum(axis=(1, 2))
        legs = LegRows(
            row, slope, margin, travel, joints.min(axis=1), joints.max(axis=1), at_poses, self._gives(sides, row, slope)
        )
        return legs.of(steps.max(axis=(1, 2)) < JUMP)

    def _gives(self, sides: Sides, row: Counts, slope: Array) -> Array:
        if "lost_motion" not in dict(self.settings.weights):
            return np.empty((row.size, 0))
        return leg_gives(self.drilling, sides.branch, sides.psi_t[row], slope, self.settings.thrust)

    def paired(self, legs: LegRows, other: LegRows) -> Array:
        """What all pairs of legs out of one spin cost, shape (n, m); inf beyond the limits."""
        low = np.minimum(legs.low[:, None], other.low)
        high = np.maximum(legs.high[:, None], other.high)
        limits = self.drilling.robot.limits
        turns, fits = turns_within(low, high, self.limits(LIMIT_SLACK), self.settings.near_joints)
        distance = np.minimum(low + turns - limits.lower, limits.upper - high - turns)
        gentler = np.minimum(np.abs(legs.slope[:, None]), np.abs(other.slope))  # the plunge, see `straight_motion`
        measures = Measures(
            travel=np.add.outer(legs.travel, other.travel),
            margin=np.minimum.outer(legs.margin, other.margin),
            plunge_rotation=gentler * self.drilling.hole.depth,
            tool_speed_change=gentler * self.settings.feed_plunge,
            limit_distance=(2 * distance / (limits.upper - limits.lower)).min(axis=-1),
            lost_motion=np.nan if legs.gives.size == 0 else pair_lost_motion(legs.gives, other.gives),
            **{
                name: (np.minimum if CRITERIA[name].more_is_better else np.maximum).outer(one, two)
                for name, one, two in zip(AT_POSES, legs.at_poses.T, other.at_poses.T, strict=True)
            },
        )
        return np.where(fits.all(axis=-1), objective_of(self.settings)(measures), np.inf)

    def best_pairs(self, sides: Sides, legs: LegRows) -> Iterator[Point]:
        """The best pair of each spin that has one; rows 2k and 2k + 1 are the two sides of spin k."""
        ends = np.searchsorted(legs.row, np.arange(len(sides.psi_t) + 1))
        for row in range(0, len(sides.psi_t), 2):
            first, middle, last = ends[row : row + 3]
            if first == middle or middle == last:
                continue
            one, other = legs.of(slice(first, middle)), legs.of(slice(middle, last))
            cost = self.paired(one, other)
            n, m = np.unravel_index(np.argmin(cost), cost.shape)
            if np.isfinite(cost[n, m]):
                slopes = float(one.slope[n]), float(other.slope[m])
                yield Point(float(cost[n, m]), sides.branch, float(sides.psi_t[row]), slopes)

    def limits(self, slack: float) -> JointLimits:
        """The limits with a little kept to them [rad]."""
        limits = self.drilling.limits
        return JointLimits(limits.lower + slack, limits.upper - slack, limits.speed)


def _least(rates: Array) -> Array:
    """Least rates along legs, between the nodes as well: from the parabola through three of them.

    Args:
        rates: shape (6, n, nodes).
    """
    centre = np.clip(rates.argmin(axis=-1), 1, rates.shape[-1] - 2)[..., None]
    before, at, after = (np.take_along_axis(rates, centre + step, axis=-1)[..., 0] for step in (-1, 0, 1))
    tilt, bend = after - before, before - 2 * at + after
    inside = np.abs(tilt) < 2 * bend
    lowest = at - tilt**2 / np.where(inside, 8 * bend, np.inf)
    return np.asarray(np.minimum(rates.min(axis=-1), lowest))


def _mean(rates: Array) -> Array:
    """Mean rates along legs, shape (6, n), by Simpson's rule."""
    weights = np.ones(rates.shape[-1])
    weights[1:-1:2], weights[2:-1:2] = 4.0, 2.0
    return np.asarray(rates @ (weights / weights.sum()))


def turns_round(rates: Array) -> Counts:
    """How often a joint turns round along each leg, shape (n,), of rates (n, nodes)."""
    signs = np.where(np.abs(rates) > NIL, np.sign(rates), 0.0)
    return np.asarray((signs[:, 1:] * signs[:, :-1] < 0).sum(axis=1), dtype=np.int64)
