"""The best motion that keeps a set of joints: every valley of the target line descended to its bottom (theory §2, §3).

For one spin at the target, one leg has to lie above the critical rates of all joints that are to keep their direction
and the other below them, and the best leg on each side is found on its own, by a root search along one line of slopes
(`kernels.legs`). What is left is one dimension, psi_t, on each branch: it is sampled on a grid, and every valley of
the grid is descended to its bottom.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from typing import NamedTuple

import numpy as np

from zerorev.kernels import legs, pairs
from zerorev.kernels.field import ROOM
from zerorev.kernels.layout import Constraints
from zerorev.model._arrays import Array
from zerorev.motion.evaluation import event_distance
from zerorev.motion.joint_path import outward_rates
from zerorev.search.problem import Mask, Problem
from zerorev.search.rank import Candidate
from zerorev.search.straight import LEAST_RATE, LIMIT_SLACK

__all__ = ["Valleys"]

NODES, FINE_NODES = 24, 96  # points on a leg: going down, the last polish
DESCENT_STEPS = 10  # golden section from two steps of the grid to some 0.02 deg
POLISH_STEPS, AGAIN_STEPS = 20, 12  # the same on fine legs, to some 4e-6 deg; and where more is asked of them
# steps of the grid around a pair within which it is polished; the wider ones where nothing closer is admissible
CLOSE, CLOSEST = (0.02, 1.0), (0.0007, 0.02, 1.0)
MOST_SHIFTS = 8  # windows of two steps that a valley is followed over
CANDIDATES = 8  # valleys descended, at most
PATIENCE, LONG_PATIENCE = 4, 30  # valleys descended in vain: for a set of joints, for all six
WORTH_A_DESCENT = 1.1  # a valley this much above the best bottom so far may still lie lower than it looks on the grid
WORTH_A_GUESS = 1.5  # the same where the grid has no admissible pair, but one nearly so
LEAST_MORE = 0.02 * LEAST_RATE  # [rad/m] by which a leg's threshold is raised beyond its shortfall between points, ...
MORE_AND_MORE = 6.0  # ... times this from one time to the next: how far below zero a rate was is not known


class _Pair(NamedTuple):
    """Two legs out of one point of the target line, and what they are worth (least is best)."""

    value: float
    branch: int
    psi_t: float
    above: float
    below: float

    @classmethod
    def of(cls, row: Array) -> _Pair:
        """From a row that `kernels.pairs` writes."""
        branch = int(row[pairs.BRANCH])
        return cls(row[pairs.VALUE], branch, row[pairs.SPIN], row[pairs.SLOPE_ABOVE], row[pairs.SLOPE_BELOW])


class Valleys:
    """The target line of a hole on one branch or several, and the search along it."""

    def __init__(self, problem: Problem, branches: list[int]) -> None:
        """Look at nothing yet.

        Args:
            problem: what is asked.
            branches: where to look; of all of them it is the best motion that is wanted.
        """
        self.problem = problem
        self.arm, self.plane, self.psi = problem.drilling.robot.arm, problem.plane, problem.psi
        self.step, self.periodic = problem.step, problem.periodic
        self.branches = np.isin(np.arange(8), branches)

    def motions(self, keep: Mask) -> Iterator[Candidate]:
        """The best motions that keep a set of joints: the others turning at the target alone, and within legs, too.

        Args:
            keep: whether a joint is to keep its direction, shape (6,).
        """
        if not self._can_keep(keep):
            return
        for turn_inside in (False, True):
            motion = self.best_motion(keep, turn_inside=turn_inside)
            if motion is not None:
                yield motion

    def best_motion(self, keep: Mask, *, turn_inside: bool = False) -> Candidate | None:
        """The best motion that keeps a set of joints, or None: the threshold first, then the objective.

        Args:
            keep: whether a joint is to keep its direction, shape (6,).
            turn_inside: whether the others may turn within a leg, too, and not at the target alone.
        """
        constraints, mode = self.problem.objective(turn_inside=turn_inside)
        pair = min(self._bottoms(keep, constraints, mode), default=None)
        # at the mean rule, too, it is the points that must not turn round
        least = self.problem.constraints(0.0, turn_inside=turn_inside)
        if pair is None and constraints.min_rate > least.min_rate:
            # the threshold cannot be met: the greatest margin that can
            constraints, mode = least, legs.GREATEST_MARGIN
            pair = min(self._bottoms(keep, constraints, mode), default=None)
        return None if pair is None else self._polished(keep, constraints, mode, pair)

    def _can_keep(self, keep: Mask) -> bool:
        """Whether any motion keeps these joints: most sets are tried in vain, and once is enough."""
        if (keep & self._hopeless).any():
            return False
        constraints = self.problem.constraints(0.0, turn_inside=True)
        return next(self._bottoms(keep, constraints, legs.GREATEST_MARGIN), None) is not None

    @cached_property
    def _hopeless(self) -> Mask:
        """Joints that cannot be kept even on their own, as far as the coarse sample can tell, shape (6,)."""
        constraints = self.problem.constraints(0.0, turn_inside=True)
        return np.array(
            [not (self._look(alone, constraints, legs.TRAVEL)[1] > 0).any() for alone in np.eye(6, dtype=bool)]
        )

    def _look(self, keep: Mask, constraints: Constraints, mode: int) -> tuple[Array, Array, Array]:
        """What a coarse sample finds at every spin of the grid, in each posture, shapes (4, K); see `kernels.pairs`."""
        out = np.empty((4, self.psi.size, pairs.SAMPLED))
        lines = np.repeat(self.branches[:, None], self.psi.size, axis=1)
        pairs.sample_line(self.arm, self.plane, self.psi, lines, keep, constraints, mode, -np.inf, out)
        value, margin, guess = np.moveaxis(out[..., :3], -1, 0)
        return value, margin, guess

    def _bottoms(self, keep: Mask, constraints: Constraints, mode: int) -> Iterator[_Pair]:
        """Descend every valley of the coarse sample that may hold the best pair; each pair improves those before it."""
        value, margin, guess = self._look(keep, constraints, mode)
        # between the grid's spins, too, the margin may just be enough
        peaks = [(np.inf, -margin[p, n], p, n) for p, n in self._peaks(margin)]
        if mode == legs.GREATEST_MARGIN:
            valleys = peaks
        else:
            valleys = [(value[p, n], -margin[p, n], p, n) for p, n in self._peaks(-value)]
            valleys += [peak for peak in peaks if value[peak[2:]] == np.inf]
        best: _Pair | None = None
        vain, patience = 0, LONG_PATIENCE if keep.all() else PATIENCE
        descended: list[tuple[int, float, float]] = []  # posture, and the spins between which all was examined
        for examined, (rough, _, posture, n) in enumerate(sorted(valleys)):
            spin = self.psi[n]
            if vain == patience or not self._may_reach(margin, posture, n, constraints.min_rate):
                continue
            if best is not None and mode != legs.GREATEST_MARGIN and keep.all():
                if examined >= CANDIDATES and rough < np.inf:
                    continue
                if best.value < min(rough / WORTH_A_DESCENT, guess[posture, n] / WORTH_A_GUESS):
                    continue
            if any(posture == other and low <= spin <= high for other, low, high in descended):
                continue
            bound = np.inf if best is None else best.value
            pair = self._descend(keep, constraints, mode, posture, n, bound)
            if pair is None and rough < np.inf:
                # the limits cut the bottom off, which the grid does not know in full: where the valley begins to do
                shoulders = self._shoulders(keep, constraints, mode, value[posture], posture, n)
                pairs_there = [self._descend(keep, constraints, mode, posture, m, bound) for m in shoulders]
                pair = min((one for one in pairs_there if one is not None), default=None)
            vain += pair is None
            if pair is not None:
                descended.append(
                    (posture, min(spin, pair.psi_t) - self.step / 2, max(spin, pair.psi_t) + self.step / 2)
                )
            if pair is not None and (best is None or pair.value < best.value - 1e-9):
                best = pair
                yield pair

    def _peaks(self, height: Array) -> list[tuple[int, int]]:
        """Posture and grid index of every local maximum of `height`, shape (4, K), that is not -inf."""
        left, right = np.roll(height, 1, axis=1), np.roll(height, -1, axis=1)
        if not self.periodic:
            left[:, 0] = right[:, -1] = -np.inf
        # a plateau across the whole circle has no strict right side
        found = np.argwhere((height > -np.inf) & (height >= left) & (height > right))
        return [(int(p), int(n)) for p, n in found]

    def _may_reach(self, margin: Array, posture: int, n: int, wanted: float) -> bool:
        """Whether the margin, which varies from one grid spin to the next, may reach `wanted` in between."""
        row, k = margin[posture], self.psi.size
        if row[n] >= wanted:
            return True
        around = [row[(n + d) % k] for d in (-2, -1, 1, 2) if self.periodic or 0 <= n + d < k]
        known = [value for value in around if value > -np.inf]
        variation = max((abs(row[n] - value) for value in known), default=np.inf)
        return bool(row[n] + 2 * variation >= wanted)

    def _descend(
        self, keep: Mask, constraints: Constraints, mode: int, posture: int, n: int, bound: float
    ) -> _Pair | None:
        """The bottom of the valley around one spin of the grid."""
        return self._followed(keep, constraints, mode, posture, self.psi[n], self.step, NODES, DESCENT_STEPS, bound)

    def _followed(
        self,
        keep: Mask,
        constraints: Constraints,
        mode: int,
        posture: int,
        spin: float,
        around: float,
        nodes: int,
        steps: int,
        bound: float = np.inf,
    ) -> _Pair | None:
        """The best pair around a spin; a valley that is lowest at the edge of the examined spins continues beyond."""
        for _ in range(MOST_SHIFTS):
            pair = self._bottom(keep, constraints, mode, posture, spin - around, spin + around, nodes, steps, bound)
            if pair is None or abs(pair.psi_t - spin) < 0.98 * around:
                break
            spin = pair.psi_t
        return pair

    def _shoulders(
        self, keep: Mask, constraints: Constraints, mode: int, value: Array, posture: int, n: int
    ) -> list[int]:
        """The nearest spins of the grid to either side of one, within its valley, that have an admissible pair."""
        found, row, work = [], np.empty(pairs.COLUMNS), np.empty(ROOM)
        for side in (-1, 1):
            for away in range(1, MOST_SHIFTS + 1):
                m = n + side * away
                if not (self.periodic or 0 <= m < self.psi.size) or value[m % self.psi.size] == np.inf:
                    break
                pairs.best_pair(
                    self.arm, self.plane, posture, self.psi[m % self.psi.size], keep, constraints,
                    constraints.unlimited(), self.branches, mode, NODES, np.inf, work, row,
                )  # fmt: skip
                if np.isfinite(row[pairs.VALUE]):
                    found.append(m % self.psi.size)
                    break
        return found

    def _bottom(
        self,
        keep: Mask,
        constraints: Constraints,
        mode: int,
        posture: int,
        low: float,
        high: float,
        nodes: int,
        steps: int,
        bound: float = np.inf,
    ) -> _Pair | None:
        """The best pair between two spins, or None where none is admissible."""
        if not self.periodic:
            low, high = max(low, self.psi[0]), min(high, self.psi[-1])
        row = np.empty(pairs.COLUMNS)
        pairs.descend(
            self.arm, self.plane, posture, low, high, keep, constraints, constraints.unlimited(), self.branches, mode,
            nodes, steps, bound, row,
        )  # fmt: skip
        return _Pair.of(row) if np.isfinite(row[pairs.VALUE]) else None

    def _polished(self, keep: Mask, constraints: Constraints, mode: int, pair: _Pair) -> Candidate | None:
        """The pair followed on finer legs; the threshold is raised a little where the located extremes are below it."""
        goal = constraints.min_rate
        # nobody asked for the floor: half of it is enough
        enough = goal * (1 - 1e-9) if goal > LEAST_RATE else 0.5 * goal
        # few points predict the travel of a leg to some 0.1 %, and so where a flat valley is lowest only roughly
        pair = self._nearby(keep, constraints, mode, pair, POLISH_STEPS, CLOSE) or pair
        found, shy, more = None, LIMIT_SLACK, LEAST_MORE
        for _ in range(6):
            found = self._motion(pair)
            if found is None:
                # over a limit by what the nodes do not see
                shy *= 4.0
                constraints = constraints._replace(lower=constraints.lower + shy, upper=constraints.upper - shy)
            else:
                least = self._least_rate(found, keep, mean_rule=constraints.mean_rule)
                if least >= enough:
                    break
                # the lowest point lies between the nodes: raise the threshold by the shortfall, search again
                constraints = constraints._replace(min_rate=constraints.min_rate + max(goal - least, 0.0) + more)
                more *= MORE_AND_MORE
            pair = self._nearby(keep, constraints, mode, pair, AGAIN_STEPS, CLOSEST) or pair
        return found

    def _nearby(
        self, keep: Mask, constraints: Constraints, mode: int, pair: _Pair, steps: int, close: tuple[float, ...]
    ) -> _Pair | None:
        """The best pair around another, on fine legs, as close to it as possible; `close` in steps of the grid."""
        for around in np.array(close) * self.step:
            near = self._followed(keep, constraints, mode, pair.branch // 2, pair.psi_t, around, FINE_NODES, steps)
            if near is not None:
                return near
        return None

    def _least_rate(self, found: Candidate, keep: Mask, *, mean_rule: bool) -> float:
        """The least rate of the joints to be kept [rad/m]; a joint that turns round and back counts as backwards."""
        score, problem = found.score, self.problem
        least = float((score.mean_rate if mean_rule else score.min_rate)[keep].min(initial=np.inf))
        for joint in np.flatnonzero(keep & (np.array(score.reversals_per_joint) > 0)):
            turns = [event for event in score.events if event.joint == joint + 1]
            least = min(least, 0.0)
            if len(turns) == 2 and turns[0].leg == turns[1].leg != "target":
                # about the middle of the way back it is fastest
                middle = np.mean([event_distance(found.profile, event) for event in turns], keepdims=True)
                slope = found.profile.twist_rate[0 if turns[0].leg == "plunge" else 1]
                rates = outward_rates(problem.drilling, found.branch, *found.profile.at(middle), slope)
                least = min(least, -abs(float(rates[0, joint])))
        return least

    def _motion(self, pair: _Pair) -> Candidate | None:
        return self.problem.found(pair.branch, pair.psi_t, (pair.above, pair.below))
