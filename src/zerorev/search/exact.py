"""The exact search over straight legs: pairs of legs that bracket the critical rates (theory §2, §3).

A set of joints is to keep its direction. For one spin at the target, one leg has to lie above the critical rates of all
those joints and the other below them, and the best leg on each side is found on its own, by a root search along one line
of slopes (`kernels.legs`). What is left is one dimension, psi_t, in each of eight branches: it is looked over on a grid,
and every valley of the grid is gone down to its bottom. The sets of joints are tried in the order of what it costs to
leave the others out, so the first set that can be kept is the answer with the fewest reversals.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import combinations
from typing import NamedTuple

import numpy as np

from zerorev.evaluation import Evaluation, evaluate, meets_threshold
from zerorev.kernels import legs as kernels
from zerorev.kinematics import TwistPlane, twist_plane
from zerorev.model._arrays import Array
from zerorev.model.hole import Hole
from zerorev.model.job import Settings
from zerorev.model.profile import Profile
from zerorev.model.robot import Robot
from zerorev.model.tool import Tool

__all__ = ["Found", "search"]

GRID = 240  # spins at the target in one turn
COARSE_NODES, NODES, FINE_NODES = 13, 25, 97  # points on a leg: looking over, going down, the last polish
LONGEST_TWIST = 2 * np.pi  # [rad] of one leg
DESCENT_STEPS = 16  # golden section from two steps of the grid to some 0.001 deg
POLISH_STEPS = 10
CANDIDATES = 8  # valleys gone down, at most
WORTH_A_LOOK = 1.1  # a valley this much above the best bottom so far may still lie lower than it looks on the grid
LEAST_RATE = float(np.deg2rad(1e-4))  # [rad/m] 1e-7 deg/mm: a joint that must not stop keeps at least so much
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


class _Pair(NamedTuple):
    """Two legs out of one point of the target line, and what they are worth (least is best)."""

    value: float
    branch: int
    psi_t: float
    above: float
    below: float


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
    best: Found | None = None
    for cost, keep in _joint_sets(settings.reversal_weights, problem):
        if best is not None and cost >= problem.cost(best) - 1e-12:
            break
        # a joint left out turns at the target if it can, and within a leg only where it must
        for turn_inside in (False,) if keep.all() else (False, True):
            found = problem.keeping(keep, turn_inside)
            if found is not None and (best is None or problem.cost(found) < problem.cost(best)):
                best = found
            if found is not None and problem.cost(found) <= cost + 1e-12:
                return found
    return best


def _joint_sets(weights: tuple[float, ...], problem: _Problem) -> Iterator[tuple[float, Array]]:
    """Sets of joints to keep, cheapest to leave out first: (cost, keep (6,) bool)."""
    yield 0.0, np.ones(6, dtype=bool)
    # a joint that cannot be kept even on its own is in no set
    hopeless = {i for i in range(6) if not problem.can_keep(np.arange(6) == i)}
    left_out = [
        set(chosen) for size in range(1, 7) for chosen in combinations(range(6), size) if hopeless <= set(chosen)
    ]
    for chosen in sorted(left_out, key=lambda s: (sum(weights[i] for i in s), len(s), sorted(s))):
        yield sum(weights[i] for i in chosen), np.array([i not in chosen for i in range(6)])


class _Problem:
    """One hole, and the search for the best pair of legs that keeps a given set of joints."""

    def __init__(self, robot: Robot, tool: Tool, hole: Hole, settings: Settings) -> None:
        self.robot, self.tool, self.hole, self.settings = robot, tool, hole, settings
        self.plane: TwistPlane = twist_plane(robot, tool, hole)
        self.branches = np.array([hole.branch in (None, branch) for branch in range(8)])
        bound = settings.psi_bound
        self.periodic = bound is None
        if bound is None:
            self.psi = np.linspace(-np.pi, np.pi, GRID, endpoint=False)
        else:
            self.psi = np.linspace(-bound, bound, max(3, int(np.ceil(GRID * bound / np.pi))) + 1)

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
        assert found.evaluation.score is not None
        return float(np.dot(self.settings.reversal_weights, found.evaluation.score.reversals_per_joint))

    def can_keep(self, keep: Array) -> bool:
        """Whether the coarse look finds any pair that keeps these joints."""
        return bool((self._scan(keep, self.asked(0.0))[..., 1] > 0).any())

    def keeping(self, keep: Array, turn_inside: bool) -> Found | None:
        """The best motion that keeps a set of joints: the threshold first, then the objective; None if there is none."""
        settings = self.settings
        asked = self.asked(
            settings.min_rate, mean_rule=settings.min_rate_rule == "mean", turn_inside=turn_inside
        )
        mode = {
            "travel": kernels.TRAVEL,
            "margin": kernels.GREATEST_MARGIN,
            "plunge_rotation": kernels.PLUNGE_ROTATION,
        }[settings.objective]
        pair = self._best(keep, asked, mode)
        if pair is None:
            # the threshold cannot be met: the greatest margin that can (at the mean rule, too, it is the points that
            # must not turn round)
            asked = self.asked(0.0, turn_inside=turn_inside)
            mode = kernels.GREATEST_MARGIN
            pair = self._best(keep, asked, mode)
        return None if pair is None else self._polished(keep, asked, mode, pair)

    def _scan(self, keep: Array, asked: Asked) -> Array:
        out = np.empty((8, self.psi.size, 2))
        kernels.scan(self.robot.arm, self.plane, self.psi, keep, asked, COARSE_NODES, self.branches, out)
        return out

    def _best(self, keep: Array, asked: Asked, mode: int) -> _Pair | None:
        """Go down every valley of the coarse look that may hold the best pair."""
        travel, margin = np.moveaxis(self._scan(keep, asked), -1, 0)
        if mode == kernels.GREATEST_MARGIN:
            valleys = [(-margin[b, n], b, n) for b, n in self._peaks(margin) if self._may_reach(margin, b, n, 0.0)]
        else:
            valleys = [(travel[b, n], b, n) for b, n in self._peaks(-travel)]
            # between the grid's spins, too, the margin may just be enough
            valleys += [
                (np.inf, b, n)
                for b, n in self._peaks(margin)
                if margin[b, n] < asked.min_rate and self._may_reach(margin, b, n, asked.min_rate)
            ]
        best: _Pair | None = None
        in_vain: set[tuple[int, int]] = set()  # the wrist flips share their legs, so what one cannot keep neither can
        for looked_at, (rough, branch, n) in enumerate(sorted(valleys)):
            if (branch // 2, n) in in_vain:
                continue
            if best is not None and np.isfinite(rough) and looked_at >= CANDIDATES:
                continue
            if best is not None and mode == kernels.TRAVEL and WORTH_A_LOOK * best.value < rough < np.inf:
                continue
            pair = self._descend(keep, asked, mode, int(branch), n)
            if pair is None and margin[branch, n] == margin[branch ^ 1, n]:
                in_vain.add((branch // 2, n))
            if pair is not None and (best is None or pair.value < best.value - 1e-9):
                best = pair
        return best

    def _peaks(self, height: Array) -> list[tuple[int, int]]:
        """Branch and grid index of every local maximum of `height`, shape (8, K), that is not -inf."""
        left, right = np.roll(height, 1, axis=1), np.roll(height, -1, axis=1)
        if not self.periodic:
            left[:, 0] = right[:, -1] = -np.inf
        found = np.argwhere((height > -np.inf) & (height >= left) & (height > right))
        # a plateau across the whole circle has no strict right side
        return [(int(b), int(n)) for b, n in found]

    def _may_reach(self, margin: Array, branch: int, n: int, wanted: float) -> bool:
        """Whether the margin, which varies from one grid spin to the next, may reach `wanted` in between."""
        row, k = margin[branch], self.psi.size
        around = [row[(n + d) % k] for d in (-2, -1, 1, 2) if self.periodic or 0 <= n + d < k]
        known = [value for value in around if value > -np.inf]
        variation = max((abs(row[n] - value) for value in known), default=np.inf)
        return bool(row[n] + 2 * variation >= wanted)

    def _pair(self, keep: Array, asked: Asked, mode: int, branch: int, psi_t: float, nodes: int) -> tuple[_Pair, float]:
        out = np.empty(4)
        kernels.best_pair(self.robot.arm, self.plane, branch, psi_t, keep, asked, asked.unlimited(), mode, nodes, out)
        return _Pair(out[kernels.VALUE], branch, psi_t, out[kernels.SLOPE_ABOVE], out[kernels.SLOPE_BELOW]), float(
            out[kernels.MARGIN]
        )

    def _descend(self, keep: Array, asked: Asked, mode: int, branch: int, n: int) -> _Pair | None:
        """The bottom of the valley around one spin of the grid."""
        step = self.psi[1] - self.psi[0]

        def value(psi_t: float) -> float:
            return self._pair(keep, asked, mode, branch, psi_t, NODES)[0].value

        def lack(psi_t: float) -> float:
            return asked.min_rate - self._pair(keep, asked, kernels.GREATEST_MARGIN, branch, psi_t, NODES)[1]

        low, high = self.psi[n] - step, self.psi[n] + step
        if not self.periodic:
            low, high = max(low, self.psi[0]), min(high, self.psi[-1])
        inside = float(self.psi[n])
        if not np.isfinite(value(inside)):
            inside = _climb(lack, low, high)
            if not np.isfinite(value(inside)):
                return None
        low, high = _edge(value, inside, low), _edge(value, inside, high)
        bottom = _golden(value, low, high, DESCENT_STEPS)
        return min(self._pair(keep, asked, mode, branch, psi, NODES)[0] for psi in (bottom, inside, low, high))

    def _polished(self, keep: Array, asked: Asked, mode: int, pair: _Pair) -> Found | None:
        """The pair followed on finer legs, and asked for a little more where the located extremes fall short."""
        wanted = asked.min_rate
        for _ in range(6):
            around = 0.02 * (self.psi[1] - self.psi[0])
            low, high = pair.psi_t - around, pair.psi_t + around
            if not self.periodic:
                low, high = max(low, self.psi[0]), min(high, self.psi[-1])

            def value(psi_t: float, asked: Asked = asked) -> float:
                return self._pair(keep, asked, mode, pair.branch, psi_t, FINE_NODES)[0].value

            psi_t = _golden(value, low, high, POLISH_STEPS)
            fine = min(self._pair(keep, asked, mode, pair.branch, psi, FINE_NODES)[0] for psi in (psi_t, pair.psi_t))
            found = self._found(fine if np.isfinite(fine.value) else pair)
            if found is not None and found.evaluation.score is not None:
                score = found.evaluation.score
                turned = np.array(score.reversals_per_joint)[keep].sum()
                rates = score.min_rate[keep] if not asked.mean_rule else score.mean_rate[keep]
                short = wanted - rates.min(initial=np.inf)
                if not turned and short <= 0:
                    return found
            else:
                turned, short = 0, 0.0
            # the sampled legs did not see the lowest point: ask for what was missing, and look again
            asked = asked._replace(min_rate=asked.min_rate + max(1.5 * short, LEAST_RATE))
        return found

    def _found(self, pair: _Pair) -> Found | None:
        hole, depth = self.hole, self.hole.depth
        psi_t = pair.psi_t
        if self.periodic:
            psi_t -= 2 * np.pi * np.ceil((psi_t - np.pi) / (2 * np.pi))
        # of the two twins the one that turns the tool less while it cuts (theory §2)
        plunge, retract = sorted((pair.above, pair.below), key=abs)
        profile = Profile.straight(depth, psi_t + plunge * depth, psi_t, psi_t + retract * depth)
        evaluation = evaluate(self.robot, self.tool, hole, profile, pair.branch, self.settings)
        if evaluation.score is None:
            return None
        return Found(profile, pair.branch, evaluation, meets_threshold(evaluation.score, self.settings))


def _golden(f: Callable[[float], float], low: float, high: float, steps: int) -> float:
    """Where f is least between low and high, if it has one valley there."""
    ratio = (np.sqrt(5) - 1) / 2
    x, y = high - ratio * (high - low), low + ratio * (high - low)
    fx, fy = f(x), f(y)
    for _ in range(steps):
        if fx <= fy:
            high, y, fy = y, x, fx
            x = high - ratio * (high - low)
            fx = f(x)
        else:
            low, x, fx = x, y, fy
            y = low + ratio * (high - low)
            fy = f(y)
    return float(x if fx <= fy else y)


def _climb(lack: Callable[[float], float], low: float, high: float) -> float:
    """A spin between low and high at which nothing is lacking, or where least is.

    Golden section that stops as soon as nothing is lacking, or as soon as what is gained has become too little to get
    there: near the bottom of a valley the gains of each step shrink.
    """
    ratio = (np.sqrt(5) - 1) / 2
    x, y = high - ratio * (high - low), low + ratio * (high - low)
    fx, fy = lack(x), lack(y)
    least = [min(fx, fy)]
    while least[-1] > 0 and len(least) < DESCENT_STEPS:
        if fx <= fy:
            high, y, fy = y, x, fx
            x = high - ratio * (high - low)
            fx = lack(x)
        else:
            low, x, fx = x, y, fy
            y = low + ratio * (high - low)
            fy = lack(y)
        least.append(min(fx, fy, least[-1]))
        if len(least) > 4 and least[-4] - least[-1] < 0.2 * least[-1]:
            break
    return float(x if fx <= fy else y)


def _edge(f: Callable[[float], float], inside: float, outside: float) -> float:
    """The last spin towards `outside` at which f is finite."""
    if np.isfinite(f(outside)):
        return outside
    for _ in range(DESCENT_STEPS):
        middle = (inside + outside) / 2
        if np.isfinite(f(middle)):
            inside = middle
        else:
            outside = middle
    return inside
