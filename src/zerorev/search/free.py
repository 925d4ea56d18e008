"""Free legs: the deepest stroke, and the best motion of a given one, with a spin that varies freely (theory §4).

At each spin at the target tubes of reachable spins are carried outwards on both sides of the critical rates
(`kernels.tube`). Their common length is the deepest stroke there, so that one dimension is left to search, in each of
eight branches. A motion is then taken out of the tubes and reduced to a few straight segments (`search.segments`).
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from zerorev.kernels import free as kernels
from zerorev.kernels import legs, segments, tube
from zerorev.model._arrays import Array
from zerorev.model.job import Settings
from zerorev.motion.drilling import Drilling
from zerorev.search.line import climb, edge, golden
from zerorev.search.rank import Candidate, Order
from zerorev.search.segments import Goal, improved, legs_through, motion_of
from zerorev.search.straight import LEAST_RATE, constraints, target_spins
from zerorev.search.viable import ROWS_SLACK, Grain

__all__ = ["SEGMENTS", "search_free"]

GRID = 120  # spins at the target in one turn
WORTH = 0.9  # of the best of the grid: what is less deep is not closed in on
PEAKS = 4  # closed in on, at most
CLOSING_STEPS, LAST_STEPS = 12, 8
SEGMENTS = (1, 2, 4, 8, 16)  # of a leg
ROWS = 48  # of a tube that a motion is taken out of, at least
GUARD = float(np.deg2rad(0.2))  # [rad/m] 0.0002 deg/mm aimed at beyond the threshold
MORE = 0.01  # by which more segments have to be better
GUARDS = tuple(np.deg2rad([0.0, 1.0, 4.0]).tolist())  # [rad/m] up to 0.004 deg/mm for what lies between the points


def search_free(drilling: Drilling, settings: Settings) -> Candidate | None:
    """The best motion of zero reversals on free legs at the depth of the hole.

    Where the motion threshold cannot be kept, it is the one of greatest margin.

    Args:
        drilling: robot, tool and hole; its `branch`, if any, is the only one searched.
        settings: `min_rate`, at every point by either rule; `max_twist`; `psi_bound`; `objective`.

    Returns:
        the motion, or None where there is none.
    """
    depth = drilling.hole.depth
    found = _FreeLegs(drilling, settings).best(depth)
    if found is None and settings.min_rate > LEAST_RATE:
        found = _FreeLegs(drilling, replace(settings, min_rate=0.0, objective="margin")).best(depth)
    return None if found is None else Order(drilling, settings).candidate(found.profile, found.branch)


class _Place(NamedTuple):
    """A point of the target line on a branch, and how deep it gets [m]."""

    depth: float
    branch: int
    psi_t: float


def _grain(reach: float, fineness: float, finest: float) -> Grain:
    """In proportion to the length of the stretched arm [m]."""
    return Grain(reach / 200 / fineness, 0.4 / fineness, 0.2 / fineness, finest * reach)


class _FreeLegs:
    """One hole, and the tubes out of its target."""

    def __init__(self, drilling: Drilling, settings: Settings) -> None:
        self.drilling, self.settings = drilling, settings
        robot, self.plane = drilling.robot, drilling.plane
        self.arm = robot.arm
        self.branches = np.array([drilling.hole.branch in (None, branch) for branch in range(8)])
        self.reach = robot.reach
        self.coarse = _grain(self.reach, 1, 1e-3)
        self.fine = _grain(self.reach, 3, 1e-6)
        self.constraints = constraints(
            drilling, settings, settings.min_rate, slack=ROWS_SLACK, steepest=settings.max_twist
        )
        self.longest = 2 * self.reach
        self.periodic = settings.psi_bound is None
        self.psi = target_spins(settings.psi_bound, GRID)
        self.room, self.rows = tube.workspace(), np.ones(2, dtype=np.int64)
        self.tubes = np.empty((2, tube.MAX_ROWS, tube.WIDTH))
        self.sense, self.at_target = np.empty(6), np.empty(6)

    def depth(self, branch: int, psi_t: float, longest: float) -> float:
        """How deep two legs get; the tubes are left as made."""
        return float(
            kernels.depth_at(
                self.arm, self.plane, branch, psi_t, self.constraints, self.fine, longest,
                self.room, self.tubes, self.rows, self.sense, self.at_target,
            )
        )  # fmt: skip

    def value(self, branch: int, psi_t: float, depth: float) -> float:
        """What the best two legs of a depth are worth, inf where there are none; the tubes are left as made."""
        mode = legs.PLUNGE_ROTATION if self.settings.objective == "plunge_rotation" else legs.TRAVEL
        grain = self.fine._replace(step=min(self.fine.step, depth / ROWS))
        return float(
            kernels.value_at(
                self.arm, self.plane, branch, psi_t, self.constraints, grain, depth, mode,
                self.room, self.tubes, self.rows, self.sense, self.at_target,
            )
        )  # fmt: skip

    def scan(self, longest: float) -> Array:
        """Depths on the grid of spins at the target, shape (8, K)."""
        out = np.empty((8, self.psi.size))
        kernels.scan(self.arm, self.plane, self.psi, self.branches, self.constraints, self.coarse, longest, WORTH, out)
        return out

    def around(self, psi_t: float) -> tuple[float, float]:
        """The spins within a step of the grid."""
        step = self.psi[1] - self.psi[0]
        low, high = psi_t - step, psi_t + step
        return (low, high) if self.periodic else (max(low, self.psi[0]), min(high, self.psi[-1]))

    def peaks(self, depth: Array) -> list[tuple[int, float]]:
        """The highest local maxima along the target line, highest first: branch and spin."""
        left, right = np.roll(depth, 1, axis=1), np.roll(depth, -1, axis=1)
        high = (depth > WORTH * depth.max()) & (depth >= left) & (depth >= right)
        high[1::2] &= depth[1::2] != depth[::2]  # where no limit tells them apart, the wrist flips are as deep
        found = sorted((-depth[branch, n], branch, n) for branch, n in np.argwhere(high).tolist())
        return [(branch, float(self.psi[n])) for _, branch, n in found[:PEAKS]]

    def deepest_places(self) -> list[_Place]:
        """The deepest points of the target line, deepest first."""
        places = []
        for branch, start in self.peaks(self.scan(self.longest)):

            def lack(psi: float, branch: int = branch) -> float:
                return -self.depth(branch, psi, self.longest)

            psi_t = min(golden(lack, *self.around(start), CLOSING_STEPS), start, key=lack)
            places.append(_Place(-lack(psi_t), branch, psi_t))
        return sorted((place for place in places if place.depth > 0), reverse=True)

    def motion(self, branch: int, psi_t: float, depth: float, goal: Goal, count: int) -> Candidate | None:
        """A motion of few segments, begun in the middle of the tubes and improved from there.

        Args:
            branch: 0..7.
            psi_t: spin at the target to begin with [rad].
            depth: [m], to begin with or, but for the goal `depth`, to stay.
            goal: what is improved.
            count: segments of each leg.
        """
        if self.value(branch, psi_t, depth) == np.inf:
            return None
        tubes, narrowed = [], []
        for k in range(2):
            side, rows = (1 - 2 * k) * self.sense, self.tubes[k, : self.rows[k]]
            viable = np.empty((len(rows), 2))
            viable[-1] = self.ends(branch, side, rows[-1])
            args = self.arm, self.plane, branch // 2, side, self.constraints, rows, len(rows), self.room, viable
            if not segments.narrow(*args):
                return None
            tubes.append(rows)
            narrowed.append(viable)
        better = legs_through(tubes, narrowed, count)
        given, sense = self.constraints, self.sense.copy()
        for guard in GUARDS:
            rules = given._replace(min_rate=given.min_rate + guard + GUARD)
            better, lack = improved(self.arm, self.plane, branch, sense, rules, better, goal)
            if lack > GUARD:
                return None
            profile = motion_of(better, periodic=self.periodic)
            found = self.order(better.depth).candidate(profile, branch)
            if found is not None and found.reversals == 0 and found.keeps_threshold:
                return found
        return None

    def ends(self, branch: int, side: Array, row: Array) -> tuple[float, float]:
        """The spins around that of least travel at which a leg may end within the limits."""
        psi, travel = np.empty((2, tube.KEPT, kernels.ENDS))
        kernels.ends_within(self.arm, self.plane, branch, side, self.at_target, self.constraints, row, psi, travel)
        k, n = (int(at) for at in np.unravel_index(np.argmin(travel), travel.shape))
        within = np.isfinite(travel[k])
        last = n + int(np.argmin(np.append(within[n:], False))) - 1
        first = n - int(np.argmin(np.append(within[n::-1], False))) + 1
        return float(psi[k, first]), float(psi[k, last])

    def order(self, depth: float) -> Order:
        """Which motion of a depth is better: by the objective alone, which free legs are made for."""
        return Order(self.drilling.deep(depth), replace(self.settings, weights=()))

    def best(self, depth: float) -> Candidate | None:
        """The best motion of a depth, by the objective."""
        if self.settings.objective == "margin":
            # most room is where legs could go on longest
            starts = [(place.branch, place.psi_t) for place in self.deepest_places() if place.depth >= depth]
            found = [motion for start in starts if (motion := self.few_segments(*start, depth)) is not None]
        else:
            found = []
            for start in self.best_places(depth):
                if (motion := self.few_segments(*start, depth)) is not None:
                    found = [motion]
                    break
        return self.order(depth).best(found)

    def few_segments(self, branch: int, psi_t: float, depth: float) -> Candidate | None:
        """A motion of as few segments as do about as well, by the objective, as more."""
        order, best, least = self.order(depth), None, np.inf
        for count in SEGMENTS:
            found = self.motion(branch, psi_t, depth, self.settings.objective, count)
            if found is None:
                continue
            cost = order.rank(found).cost
            if best is not None and cost > least - MORE * abs(least):
                break
            best, least = found, cost
        return best

    def best_places(self, depth: float) -> list[tuple[int, float]]:
        """Branch and spin of the best points of the target line for a depth, best first."""
        scan = self.scan(depth)
        values = np.full(scan.shape, np.inf)
        for branch, n in np.argwhere(scan > WORTH * depth).tolist():
            values[branch, n] = self.value(branch, self.psi[n], depth)
        left, right = np.roll(values, 1, axis=1), np.roll(values, -1, axis=1)
        valleys = np.argwhere(np.isfinite(values) & (values <= left) & (values <= right)).tolist()
        starts = [(b, float(self.psi[n])) for b, n in sorted(valleys, key=lambda at: values[tuple(at)])[:PEAKS]]
        places = []
        for branch, psi_t in starts or self.thin_windows(scan, depth):

            def worth(psi: float, branch: int = branch) -> float:
                return self.value(branch, psi, depth)

            low, high = (edge(worth, psi_t, outside, LAST_STEPS) for outside in self.around(psi_t))
            best = min(golden(worth, low, high, CLOSING_STEPS), psi_t, key=worth)
            places.append((worth(best), branch, best))
        return [(branch, psi_t) for _, branch, psi_t in sorted(places)]

    def thin_windows(self, scan: Array, depth: float) -> list[tuple[int, float]]:
        """Branch and spin of places between those of the grid that get deep enough."""
        found = []
        for branch, start in self.peaks(scan):

            def lack(psi: float, branch: int = branch) -> float:
                return depth - self.depth(branch, psi, depth)

            psi_t = climb(lack, *self.around(start), CLOSING_STEPS + LAST_STEPS)
            if lack(psi_t) <= 0:
                found.append((branch, psi_t))
        return found
