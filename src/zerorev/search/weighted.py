"""The best motion of two straight legs for a weighted sum of criteria, among those of fewest reversals (theory §3).

All pairs of legs out of one spin at the target are judged by their legs alone (`leg_pairs`). The slopes that reverse no
joint and keep the motion threshold form a few intervals on either side of the critical rates; at every spin of a grid
they are sampled, their ends located, and all pairs compared. The best few points are then zoomed in on, all pairs at
every step: such a sum has creases, where the worse of two changes or an interval ends, and a descent would stop there.

The exact answers for the single criteria are candidates, too, so what comes out is never worse than any of them.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import get_args

import numpy as np

from zerorev.model._arrays import Array
from zerorev.model.settings import Objective, Settings
from zerorev.motion.criteria import measure, objective_of
from zerorev.motion.drilling import Drilling, joint_rates
from zerorev.motion.joint_path import turns_within
from zerorev.search.exact import search
from zerorev.search.leg_pairs import FINE_NODES, NODES, LegPairs, Point, Sides, turns_round
from zerorev.search.rank import Candidate, Order
from zerorev.search.straight import GRID, LEAST_RATE, LIMIT_SLACK, steepest_twist, straight_motion, target_spins

__all__ = ["WeightedLegs", "apart", "search_weighted"]

SLOPES = 24  # on one side of the critical rates
VALLEYS, FINALISTS = 6, 2  # points of the grid that are zoomed in on; of those, that are zoomed in on finely
ZOOM_SPINS, ZOOM_SLOPES = 3, 5  # on either side of the best point so far, at distances that quarter
ROUGH, FINE = 1e-4, 1e-7  # [rad] of psi_t at which zooming in ends
MOST_STEPS = 60
GOLDEN = (np.sqrt(5) - 1) / 2
ATTEMPTS = 4  # to make good what the points on a leg did not see


def search_weighted(drilling: Drilling, settings: Settings, known: Sequence[Candidate] = ()) -> Candidate | None:
    """The best motion of one hole: fewest reversals (weighted), then the motion threshold, then the weighted sum.

    Args:
        drilling: robot, tool and hole, as for the exact search.
        settings: with `weights`; without, the objective's one criterion is all that weighs.
        known: motions of this hole that were found otherwise; the answer is no worse than any of them.

    Returns:
        the motion, or None where no branch can run any. Without reversals, all of the twist plane is looked over; where
        joints have to reverse, what is around the exact search's motions and makes the same joints reverse.
    """
    alone = (replace(settings, objective=word, weights=()) for word in get_args(Objective))
    singly = (search(drilling, one, known) for one in alone)
    found = [*(one for one in singly if one is not None), *known]
    if not found:
        return None
    problem = WeightedLegs(drilling, settings)
    order = problem.order
    best = min(found, key=order.rank)
    if not best.keeps_threshold:
        return best  # the greatest margin comes first, and leaves nothing to weigh
    straight = [one for one in found if one.profile.psi.size == 3]
    seeds = [problem.point(one) for one in straight if order.rank(one)[:2] == order.rank(best)[:2]]
    if best.reversals == 0:
        seeds += problem.survey()
    points = [problem.zoomed(seed, settings.min_rate, fine=False) for seed in apart(seeds)]
    found += [better for point in apart(points)[:FINALISTS] if (better := problem.polished(point)) is not None]
    if "lost_motion" in dict(settings.weights):  # it depends on the order of the legs
        swapped = (order.candidate(one.profile.reversed(), one.branch) for one in found)
        found += [one for one in swapped if one is not None]
    return min(found, key=order.rank)


@dataclass(frozen=True)
class WeightedLegs(LegPairs):
    """One hole, and the search for its best pair of legs."""

    @cached_property
    def order(self) -> Order:
        """Which motion is better than another."""
        return Order(self.drilling, self.settings)

    def point(self, found: Candidate) -> Point:
        """The motion as two legs out of one spin."""
        plunge, retract = found.profile.twist_rate.tolist()
        measures = measure(self.drilling, found.evaluation, self.settings)
        return Point(objective_of(self.settings)(measures), found.branch, found.psi_target, (plunge, retract))

    def survey(self) -> list[Point]:
        """The best pairs without reversal of a grid of spins, the least of each valley, best first."""
        return self.valleys(point for posture in range(4) for point in self.surveyed(posture, self.spins))

    @cached_property
    def spins(self) -> Array:
        """The spins of the grid [rad], shape (K,)."""
        return target_spins(self.settings.psi_bound, GRID)

    def valleys(self, points: Iterable[Point]) -> list[Point]:
        """Of points of the grid those whose neighbours are no better, best first."""
        at = {(point.branch, int(np.searchsorted(self.spins, point.psi_t))): point for point in points}
        size, periodic = self.spins.size, self.settings.psi_bound is None
        found: list[Point] = []
        for (branch, n), point in at.items():
            around = [(branch, (n + step) % size if periodic else n + step) for step in (-1, 1)]
            if all(point.cost <= at[other].cost for other in around if other in at):
                found.append(point)
        return sorted(found)[:VALLEYS]

    def surveyed(self, posture: int, psi: Array) -> Iterator[Point]:
        """The best pairs of some spins on either wrist flip of a posture.

        Args:
            posture: 0..3.
            psi: spins at the target [rad], shape (n,).
        """
        theta_s, theta_psi = joint_rates(self.drilling, np.zeros(psi.size), psi)
        branches = [branch for branch in (2 * posture, 2 * posture + 1) if self.drilling.hole.branch in (None, branch)]
        with np.errstate(divide="ignore", invalid="ignore"):
            kappa = (-theta_s / theta_psi)[:, 2 * posture]
        reached = np.isfinite(kappa).all(axis=1)
        if not branches or not reached.any():
            return
        kappa, sense = kappa[reached], np.sign(theta_psi[reached, 2 * posture])
        steepest = steepest_twist(self.settings, self.drilling.hole.depth)
        # measured along each side, from the outermost critical rate outwards, close together at first
        nearest = np.stack([kappa.max(axis=1), -kappa.min(axis=1)], axis=1).ravel()
        share = np.concatenate([[0.0], np.geomspace(1e-4, 1.0, SLOPES)])
        slopes = nearest[:, None] + np.maximum(steepest - nearest, 0.0)[:, None] * share
        outwards = np.tile([1.0, -1.0], reached.sum())[:, None]
        senses = np.stack([sense, -sense], axis=1).reshape(-1, 6)
        # the limits are left to the pairs, which know the turns
        sides = Sides(2 * posture, np.repeat(psi[reached], 2), senses, np.zeros(senses.shape, int), np.ones(6, bool),
                       np.full((len(senses), 2, 6), np.inf))  # fmt: skip
        least = self.settings.min_rate
        rows, twist = self.slopes(sides, np.sort(slopes * outwards, axis=1), least, fine=False)
        legs = self.followed(sides, rows, twist, least, NODES)
        for branch in branches:
            on_branch = legs if branch % 2 == 0 else legs.flipped()
            yield from self.best_pairs(sides._replace(branch=branch), on_branch)

    def like(self, seed: Point, psi_t: Array) -> Sides:
        """Sides at spins (P,) that are held to what the seed's legs do to the joints, with the turns that it takes."""
        rates = self.rates(seed.branch, np.full(2, seed.psi_t), np.array(seed.slopes), FINE_NODES)
        sense, inside = np.sign(rates[..., 0]), np.stack([turns_round(rate) for rate in rates])
        keep = (inside.sum(axis=1) == 0) & (sense.prod(axis=1) < 0)
        P = psi_t.size
        everywhere = np.full((2 * P, 2, 6), np.inf)
        sides = Sides(seed.branch, np.repeat(psi_t, 2), np.tile(sense.T, (P, 1)), np.tile(inside.T, (P, 1)), keep,
                       everywhere)  # fmt: skip
        held = self.limits(3 * LIMIT_SLACK)
        at_seed = sides._replace(psi_t=np.full(2, seed.psi_t))
        legs = self.followed(at_seed, np.arange(2), np.array(seed.slopes), 0.0, NODES)
        if legs.row.size < 2:
            return sides
        turns, _ = turns_within(legs.low.min(axis=0), legs.high.max(axis=0), held, self.settings.near_joints)
        # the seed's own angles, and those of the other spins next to them
        spins = np.concatenate([[seed.psi_t], psi_t])
        first, *others = self.drilling.angles(0.0, spins)[:, seed.branch]
        at_target = others + turns - 2 * np.pi * np.round((others - first) / (2 * np.pi))
        room = np.stack([at_target - held.lower, held.upper - at_target], axis=1)
        return sides._replace(room=np.repeat(np.where(inside.any(axis=1), np.inf, room), 2, axis=0))

    def zoomed(self, seed: Point, least: float, *, fine: bool) -> Point:
        """The best point around, as far as a window that follows it and shrinks can tell; inf where there is none.

        What is examined lies at distances of many sizes, others at every step: where the sum has a crease, only few
        directions lead down.

        Args:
            seed: where to begin.
            least: motion threshold [rad/m].
            fine: whether the window begins where the rough pass ended.
        """
        best = seed._replace(cost=np.inf)
        begin, end = (10 * ROUGH, FINE) if fine else (2 * np.pi / GRID, ROUGH)
        width, bound = begin, self.settings.psi_bound
        for step in range(MOST_STEPS):
            psi = best.psi_t + width * _offsets(ZOOM_SPINS, step / 3)
            if bound is not None:
                psi = np.clip(psi, -bound, bound)
            # half of what the slopes are apart, to begin with
            reach = 0.5 * abs(seed.slopes[0] - seed.slopes[1]) * width / (2 * np.pi / GRID)
            offsets = [_offsets(ZOOM_SLOPES, (step + phase) * GOLDEN) for phase in (1 / 3, 2 / 3)]
            window = np.array(best.slopes)[:, None] + reach * np.array(offsets)
            sides = self.like(seed, psi)
            rows, chosen = self.slopes(sides, np.tile(window, (psi.size, 1)), least, fine=fine)
            legs = self.followed(sides, rows, chosen, least, FINE_NODES if fine else NODES)
            better = min([best, *self.best_pairs(sides, legs)])
            moved = np.abs(np.array(better.slopes) - best.slopes).max() / reach, abs(better.psi_t - best.psi_t) / width
            if better.cost == best.cost or max(moved) < 0.25:
                width *= 0.7
            best = better
            if width < end:
                break
        return best

    def polished(self, rough: Point) -> Candidate | None:
        """The motion of a point, zoomed in on finely until it keeps what it should at what the points did not see."""
        least = self.settings.min_rate
        for _ in range(ATTEMPTS):
            point = self.zoomed(rough, least, fine=True)
            if not np.isfinite(point.cost):
                return None
            periodic = self.settings.psi_bound is None
            profile = straight_motion(self.drilling.hole.depth, point.psi_t, point.slopes, periodic=periodic)
            found = self.order.candidate(profile, point.branch)
            if found is None or found.keeps_threshold:
                return found
            least += max(1.5 * self.order.lack(found), LEAST_RATE)
        return None


def _offsets(sizes: int, phase: float) -> Array:
    """Offsets of several sizes within +-1, in order, 0 among them, shape (2 * sizes + 1,).

    Args:
        sizes: how many on either side.
        phase: moves them between one size and the next; those of 1 are those of 0.
    """
    size = 4.0 ** -(np.arange(sizes) + phase % 1.0)
    return np.concatenate([-size, [0.0], size[::-1]])


def apart(points: list[Point]) -> list[Point]:
    """Best first, without those that lie next to a better one, or are it on the other wrist flip."""
    kept: list[Point] = []
    for point in sorted(points):
        next_to = (other for other in kept if abs(other.psi_t - point.psi_t) < 100 * ROUGH)
        same = (
            other.branch == point.branch or (other.branch == point.branch ^ 1 and point.cost - other.cost < 1e-9)
            for other in next_to
        )
        if not any(same):
            kept.append(point)
    return kept
