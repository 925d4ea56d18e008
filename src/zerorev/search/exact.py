"""The exact search over straight legs: pairs of legs that bracket the critical rates (theory §2, §3).

A set of joints is to keep its direction. For one spin at the target, one leg has to lie above the critical rates of
all those joints and the other below them, and the best leg on each side is found on its own, by a root search along one
line of slopes (`kernels.legs`). What is left is one dimension, psi_t, in each of eight branches: it is looked over on a
grid, and every valley of the grid is gone down to its bottom.

All six joints are tried first. Where they cannot all be kept, all pairs of legs of a grid are counted, which bounds the
fewest reversals from above; sets of joints that would cost less are then tried, as the grid may have missed a thin one.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from zerorev.evaluation import Evaluation, evaluate, meets_threshold
from zerorev.kernels import fan as fans
from zerorev.kernels import legs, pairs
from zerorev.kernels.field import ROOM
from zerorev.kinematics import TwistPlane, twist_plane
from zerorev.model._arrays import Array
from zerorev.model.hole import Hole
from zerorev.model.job import Settings
from zerorev.model.plan import Score
from zerorev.model.profile import Profile
from zerorev.model.robot import Robot
from zerorev.model.tool import Tool
from zerorev.search.straight import LEAST_RATE, LONGEST_TWIST, straight_motion, target_spins

__all__ = ["Found", "can_run", "search"]

GRID = 240  # spins at the target in one turn
COARSE_NODES, NODES, FINE_NODES = 12, 24, 96  # points on a leg: looking over, going down, the last polish
DESCENT_STEPS = 10  # golden section from two steps of the grid to some 0.02 deg
POLISH_STEPS, FINE_STEPS = 16, 12  # the same from there to 3e-5 deg, and on fine legs to 6e-6 deg
MOST_SHIFTS = 8  # windows of two steps that a valley is followed over
CANDIDATES = 8  # valleys gone down, at most
SEEDS, MOST_SEEDS = 6, 24  # pairs of the grid that are refined, where joints have to reverse: good ones, all
PATIENCE, LONG_PATIENCE = 4, 30  # valleys gone down in vain: for a set of joints, for all six
PATTERNS = 3  # sets of reversing joints, equal in cost, of which the best motion is looked for
WORTH_A_LOOK = 1.1  # a valley this much above the best bottom so far may still lie lower than it looks on the grid
WORTH_A_GUESS = 1.5  # the same where the grid has no pair that will do, but one nearly so
LIMIT_SLACK = 1e-6  # [rad] kept to the limits, so that rounding passes none


class Asked(NamedTuple):
    """What a leg is held to; a NamedTuple, so that kernels take it whole. SI units."""

    depth: float
    min_rate: float
    mean_rule: bool
    turn_inside: bool
    lower: Array
    upper: Array
    steepest: float
    psi_bound: float  # 0: periodic

    def unlimited(self) -> Asked:
        """The same without joint limits."""
        return self._replace(lower=np.full(6, -np.inf), upper=np.full(6, np.inf))


@dataclass(frozen=True)
class Found:
    """The best motion that the search found.

    Attributes:
        profile: two straight legs.
        branch: 0..7.
        evaluation: what the motion does to the joints.
        keeps_threshold: whether the motion threshold is met.
    """

    profile: Profile
    branch: int
    evaluation: Evaluation
    keeps_threshold: bool

    @property
    def score(self) -> Score:
        """What the motion does to the joints."""
        assert self.evaluation.score is not None
        return self.evaluation.score

    @property
    def reversals(self) -> int:
        """Count of direction changes over all joints."""
        return self.score.reversals


class Fan(NamedTuple):
    """Legs out of every spin of a grid, in 4 postures; a NamedTuple, so that kernels take it whole.

    Attributes:
        legs: as traced on the unflipped wrist, shape (4, K, MAX_FAN, ROWS, 6).
        slopes: twist rates, rising [rad/m], shape (4, K, MAX_FAN).
        critical: whether a slope is a critical rate, shape (4, K, MAX_FAN).
        fits: whether a leg can be run within the limits on either wrist flip, shape (4, K, MAX_FAN, 2).
        counts: how many slopes there are, shape (4, K).
    """

    legs: Array
    slopes: Array
    critical: npt.NDArray[np.bool_]
    fits: npt.NDArray[np.bool_]
    counts: npt.NDArray[np.int64]


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


def search(robot: Robot, tool: Tool, hole: Hole, settings: Settings) -> Found | None:
    """The best motion of one hole: fewest reversals (weighted), then the motion threshold, then the objective.

    Args:
        robot: the arm.
        tool: the drill.
        hole: what is drilled; its `branch`, if any, is the only one searched; its stand-off counts from its target.
        settings: threshold, bound on the spin, objective, weights of the joints.

    Returns:
        the motion, or None where no branch can run any.
    """
    problem = _Problem(robot, tool, hole, settings)
    best = problem.keeping(np.ones(6, dtype=bool), turn_inside=False)
    if best is not None and best.reversals == 0:
        return best
    found = problem.surveyed() + ([] if best is None else [best])
    if not found:
        return None
    best = min(found, key=problem.rank)
    for keep in [*problem.cheaper_sets(best), *problem.like(best, found)]:
        if problem.cost_without(keep) > problem.cost(best) + 1e-9:
            break
        # a joint left out turns at the target if it can, and within a leg only where it must
        for turn_inside in (False, True):
            better = problem.keeping(keep, turn_inside)
            if better is not None and problem.rank(better) < problem.rank(best):
                best = better
    return best


def can_run(robot: Robot, tool: Tool, hole: Hole, settings: Settings) -> bool:
    """Whether any branch and spin can run the hole at all, whatever reverses; as far as a grid can tell."""
    return bool(np.isfinite(_Problem(robot, tool, hole, settings).survey()).any())


class _Problem:
    """One hole, and the search for the best pair of legs that keeps a given set of joints."""

    def __init__(self, robot: Robot, tool: Tool, hole: Hole, settings: Settings) -> None:
        self.robot, self.tool, self.hole, self.settings = robot, tool, hole, settings
        self.plane: TwistPlane = twist_plane(robot, tool, hole)
        self.branches = np.array([hole.branch in (None, branch) for branch in range(8)])
        self.weights = np.array(settings.reversal_weights, dtype=float)
        self._fan: Fan | None = None
        self.periodic = settings.psi_bound is None
        self.psi = target_spins(settings.psi_bound, GRID)

    def asked(self, min_rate: float, *, mean_rule: bool = False, turn_inside: bool = False) -> Asked:
        """What the legs are held to."""
        limits = self.robot.limits
        return Asked(
            self.hole.depth,
            max(min_rate, LEAST_RATE),
            mean_rule,
            turn_inside,
            limits.lower + LIMIT_SLACK,
            limits.upper - LIMIT_SLACK,
            LONGEST_TWIST / self.hole.depth,
            self.settings.psi_bound or 0.0,
        )

    def cost(self, found: Found) -> float:
        """Weighted count of reversals of what was found."""
        return float(np.dot(self.weights, found.score.reversals_per_joint))

    def cost_without(self, keep: Array) -> float:
        """What it costs, at least, to leave out the joints that are not in a set."""
        return float(self.weights[np.logical_not(keep)].sum())

    def rank(self, found: Found) -> tuple[float, float, float]:
        """The order of plans: fewest reversals, then the motion threshold, then the objective; least is best."""
        settings, score = self.settings, found.score
        rates = score.min_rate if settings.min_rate_rule == "pointwise" else score.mean_rate
        margin = float(rates[np.array(score.reversals_per_joint) == 0].min(initial=np.inf))
        lack = 0.0 if found.keeps_threshold else settings.min_rate - margin
        start, target, _ = found.profile.psi
        value = {"travel": score.travel, "margin": -margin, "plunge_rotation": abs(target - start)}
        return round(self.cost(found), 9), lack, value[settings.objective]

    def cheaper_sets(self, best: Found) -> list[Array]:
        """Sets of joints to keep that would cost less than what was found, cheapest first."""
        # a joint that cannot be kept even on its own is in no set
        hopeless = {i for i in range(6) if not self._can_keep(np.arange(6) == i)}
        sets = [
            np.array([i not in left_out for i in range(6)])
            for size in range(1, 6)
            for left_out in combinations(range(6), size)
            if hopeless <= set(left_out)
        ]
        cheaper = [keep for keep in sets if self.cost_without(keep) < self.cost(best) - 1e-9]
        return sorted(cheaper, key=lambda keep: (self.cost_without(keep), keep.tolist()))

    def like(self, best: Found, found: list[Found]) -> list[Array]:
        """Sets of joints that the best of what was found keep."""
        kept: dict[tuple[int, ...], Array] = {}
        for one in sorted(found, key=self.rank):
            keep = np.array(one.score.reversals_per_joint) == 0
            if self.cost(one) <= self.cost(best) + 1e-9:
                kept.setdefault(tuple(keep.tolist()), keep)
        return list(kept.values())[:PATTERNS]

    def survey(self) -> Array:
        """Cost, lack, value and slopes of the best pair of the grid at every spin, shape (8, K, 5) (theory §3)."""
        out = np.empty((8, self.psi.size, 5))
        asked, mode = self.objective()
        fans.survey(self.robot.arm, self.plane, self.psi, self.fan, self.weights, asked, mode, self.branches, out)
        return out

    def surveyed(self) -> list[Found]:
        """The best pairs of the grid, each refined, whatever reverses."""
        survey, (asked, mode) = self.survey(), self.objective()
        seeds = sorted((tuple(survey[b, n, :3]), b, n) for b, n in np.argwhere(np.isfinite(survey[..., 0])).tolist())
        found: list[Found] = []
        fewest = np.inf
        taken: list[tuple[tuple[float, ...], int, int, int]] = []
        for rough, branch, n in seeds:
            # the coarse nodes may have jumped over a singularity: what cannot be run after all is no bound
            if len(found) == SEEDS or len(taken) == MOST_SEEDS or (found and rough[0] > fewest + 1e-9):
                break
            # the wrist flips share their legs, and a neighbour goes down the same valley
            if any(
                (rough, branch // 2) == other[:2] or (branch == other[2] and abs(n - other[3]) <= 4) for other in taken
            ):
                continue
            taken.append((rough, branch // 2, branch, n))
            refined = self._refined(asked, mode, branch, np.array([self.psi[n], *survey[branch, n, 3:]]))
            if refined is not None:
                found.append(refined)
                fewest = min(fewest, self.cost(refined))
        return found

    def _refined(self, asked: Asked, mode: int, branch: int, seed: Array) -> Found | None:
        found, best = None, np.empty(3)
        for nodes in (NODES, FINE_NODES, 4 * FINE_NODES):
            point = seed.copy()
            step = 0.5 * (self.psi[1] - self.psi[0])
            fans.refine(self.robot.arm, self.plane, branch, point, step, self.weights, asked, mode, nodes, best)
            found = self._found(_Pair(best[2], branch, *point))
            # what the nodes did not see: look again, more closely
            if found is not None and self.cost(found) <= best[0] + 1e-9:
                break
        return found

    @property
    def fan(self) -> Fan:
        """Legs out of every spin of the grid, followed once."""
        if self._fan is None:
            shape = (4, self.psi.size, fans.MAX_FAN)
            self._fan = Fan(
                legs=np.empty((*shape, legs.ROWS, 6)),
                slopes=np.empty(shape),
                critical=np.zeros(shape, dtype=np.bool_),
                fits=np.zeros((*shape, 2), dtype=np.bool_),
                counts=np.zeros(shape[:2], dtype=np.int64),
            )
            asked = self.asked(0.0)
            fans.follow(self.robot.arm, self.plane, self.psi, asked, COARSE_NODES, self.branches, self._fan)
        return self._fan

    def objective(self, *, turn_inside: bool = False) -> tuple[Asked, int]:
        """What the settings ask of the legs, and what makes one better than another."""
        settings = self.settings
        mode = {
            "travel": legs.TRAVEL,
            "margin": legs.GREATEST_MARGIN,
            "plunge_rotation": legs.PLUNGE_ROTATION,
        }[settings.objective]
        mean_rule = settings.min_rate_rule == "mean"
        return self.asked(settings.min_rate, mean_rule=mean_rule, turn_inside=turn_inside), mode

    def _can_keep(self, keep: Array) -> bool:
        """Whether the coarse look finds any pair that keeps these joints."""
        return bool((self._look(keep, self.asked(0.0, turn_inside=True), legs.TRAVEL)[1] > 0).any())

    def keeping(self, keep: Array, turn_inside: bool) -> Found | None:
        """The best motion that keeps a set of joints, or None: the threshold first, then the objective."""
        asked, mode = self.objective(turn_inside=turn_inside)
        # at the mean rule, too, it is the points that must not turn round
        least = self.asked(0.0, turn_inside=turn_inside)
        if not keep.all() and self._best(keep, least, legs.GREATEST_MARGIN) is None:
            return None  # most sets are tried in vain: once is enough
        pair = self._best(keep, asked, mode)
        if pair is None and asked.min_rate > least.min_rate:
            # the threshold cannot be met: the greatest margin that can
            asked, mode = least, legs.GREATEST_MARGIN
            pair = self._best(keep, asked, mode)
        return None if pair is None else self._polished(keep, asked, mode, pair)

    def _look(self, keep: Array, asked: Asked, mode: int) -> tuple[Array, Array, Array]:
        """What a coarse look finds at every spin of the grid, in each posture, shapes (4, K); see `kernels.pairs`."""
        out = np.empty((4, self.psi.size, pairs.LOOKED))
        lines = np.repeat(self.branches[:, None], self.psi.size, axis=1)
        pairs.look(self.robot.arm, self.plane, self.psi, lines, keep, asked, mode, out)
        value, margin, guess = np.moveaxis(out[..., :3], -1, 0)
        return value, margin, guess

    def _best(self, keep: Array, asked: Asked, mode: int) -> _Pair | None:
        """Go down every valley of the coarse look that may hold the best pair."""
        value, margin, guess = self._look(keep, asked, mode)
        # between the grid's spins, too, the margin may just be enough
        peaks = [(np.inf, -margin[p, n], p, n) for p, n in self._peaks(margin)]
        if mode == legs.GREATEST_MARGIN:
            valleys = peaks
        else:
            valleys = [(value[p, n], -margin[p, n], p, n) for p, n in self._peaks(-value)]
            valleys += [peak for peak in peaks if value[peak[2:]] == np.inf]
        best: _Pair | None = None
        vain, patience = 0, LONG_PATIENCE if keep.all() else PATIENCE
        step = self.psi[1] - self.psi[0]
        gone_down: list[tuple[int, float, float]] = []  # posture, and the spins between which all was looked at
        for looked_at, (rough, _, posture, n) in enumerate(sorted(valleys)):
            spin = self.psi[n]
            if vain == patience or not self._may_reach(margin, posture, n, asked.min_rate):
                continue
            if best is not None and mode != legs.GREATEST_MARGIN:
                if looked_at >= CANDIDATES and rough < np.inf:
                    continue
                if best.value < min(rough / WORTH_A_LOOK, guess[posture, n] / WORTH_A_GUESS):
                    continue
            if any(posture == other and low <= spin <= high for other, low, high in gone_down):
                continue
            bound = np.inf if best is None else best.value
            pair = self._descend(keep, asked, mode, posture, n, bound)
            if pair is None and rough < np.inf:
                # the limits cut the bottom off, which the grid does not know in full: where the valley begins to do
                shoulders = self._shoulders(keep, asked, mode, value[posture], posture, n)
                pairs_there = [self._descend(keep, asked, mode, posture, m, bound) for m in shoulders]
                pair = min((one for one in pairs_there if one is not None), default=None)
            vain += pair is None
            if pair is not None:
                gone_down.append((posture, min(spin, pair.psi_t) - step / 2, max(spin, pair.psi_t) + step / 2))
            if pair is not None and (best is None or pair.value < best.value - 1e-9):
                best = pair
        return best

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

    def _descend(self, keep: Array, asked: Asked, mode: int, posture: int, n: int, bound: float) -> _Pair | None:
        """The bottom of the valley around one spin of the grid."""
        step = self.psi[1] - self.psi[0]
        low, high = self.psi[n] - step, self.psi[n] + step
        for _ in range(MOST_SHIFTS):
            pair = self._bottom(keep, asked, mode, posture, low, high, NODES, DESCENT_STEPS, bound)
            if pair is None or low + 0.02 * step < pair.psi_t < high - 0.02 * step:
                break
            # the rough look was mistaken about where the bottom is: go on over the edge
            low, high = (pair.psi_t - step, pair.psi_t + step)
        return pair

    def _shoulders(self, keep: Array, asked: Asked, mode: int, value: Array, posture: int, n: int) -> list[int]:
        """The nearest spins of the grid to either side of one, within its valley, at which some pair will do."""
        found, row, work = [], np.empty(pairs.COLUMNS), np.empty(ROOM)
        for side in (-1, 1):
            for away in range(1, MOST_SHIFTS + 1):
                m = n + side * away
                if not (self.periodic or 0 <= m < self.psi.size) or value[m % self.psi.size] == np.inf:
                    break
                pairs.best_pair(
                    self.robot.arm, self.plane, posture, self.psi[m % self.psi.size], keep, asked, asked.unlimited(),
                    self.branches, mode, NODES, np.inf, work, row,
                )  # fmt: skip
                if np.isfinite(row[pairs.VALUE]):
                    found.append(m % self.psi.size)
                    break
        return found

    def _bottom(
        self,
        keep: Array,
        asked: Asked,
        mode: int,
        posture: int,
        low: float,
        high: float,
        nodes: int,
        steps: int,
        bound: float = np.inf,
    ) -> _Pair | None:
        """The best pair between two spins, or None where none will do."""
        if not self.periodic:
            low, high = max(low, self.psi[0]), min(high, self.psi[-1])
        row = np.empty(pairs.COLUMNS)
        pairs.descend(
            self.robot.arm, self.plane, posture, low, high, keep, asked, asked.unlimited(), self.branches, mode,
            nodes, steps, bound, row,
        )  # fmt: skip
        return _Pair.of(row) if np.isfinite(row[pairs.VALUE]) else None

    def _polished(self, keep: Array, asked: Asked, mode: int, pair: _Pair) -> Found | None:
        """The pair followed on finer legs, and asked for a little more where the located extremes fall short."""
        wanted = asked.min_rate
        around = 0.02 * (self.psi[1] - self.psi[0])
        pair = (
            self._bottom(
                keep, asked, mode, pair.branch // 2, pair.psi_t - around, pair.psi_t + around, NODES, POLISH_STEPS
            )
            or pair
        )
        around /= 30
        found, shy = None, LIMIT_SLACK
        for _ in range(6):
            low, high = pair.psi_t - around, pair.psi_t + around
            fine = self._bottom(keep, asked, mode, pair.branch // 2, low, high, FINE_NODES, FINE_STEPS)
            found = self._found(pair if fine is None else fine)
            if found is not None and found.evaluation.score is not None:
                score = found.evaluation.score
                turned = np.array(score.reversals_per_joint)[keep].sum()
                rates = score.min_rate[keep] if not asked.mean_rule else score.mean_rate[keep]
                short = wanted - rates.min(initial=np.inf)
                if not turned and short <= 1e-9 * wanted:
                    return found
            else:
                # over a limit by what the nodes do not see
                short, shy = 0.0, 4.0 * shy
                asked = asked._replace(lower=asked.lower + shy, upper=asked.upper - shy)
            # the sampled legs did not see the lowest point: ask for what was missing, and look again
            asked = asked._replace(min_rate=asked.min_rate + max(1.5 * short, LEAST_RATE))
        return found

    def _found(self, pair: _Pair) -> Found | None:
        hole, depth = self.hole, self.hole.depth
        profile = straight_motion(depth, pair.psi_t, (pair.above, pair.below), periodic=self.periodic)
        evaluation = evaluate(self.robot, self.tool, hole, profile, pair.branch, self.settings)
        if evaluation.score is None:
            return None
        return Found(profile, pair.branch, evaluation, meets_threshold(evaluation.score, self.settings))
