"""The deepest stroke of a hole that has no reversal, over all branches (theory §4).

A leg that keeps its directions to some depth keeps them to any lesser one, so the greatest margin that a pair of legs
can have falls as the stroke grows. The deepest stroke is where it falls to the motion threshold: a root in one unknown.
A coarse look at growing depths tells which spins at the target are in question; in each valley that is left the root is
located, and the deepest is taken.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from zerorev.evaluation import evaluate
from zerorev.kernels import legs, pairs
from zerorev.kinematics import twist_plane
from zerorev.model._arrays import Array
from zerorev.model.hole import Hole
from zerorev.model.job import Settings
from zerorev.model.profile import Profile
from zerorev.model.robot import Robot
from zerorev.model.tool import Tool
from zerorev.search.exact import COARSE_NODES, FINE_NODES, GRID, LIMIT_SLACK, NODES, Asked
from zerorev.search.free import deepest_free
from zerorev.search.straight import LEAST_RATE, LONGEST_TWIST, straight_motion, target_spins

__all__ = ["Deepest", "deepest_stroke"]

FIRST_LOOK = 0.06  # of the stretched arm's length: about what a middling hole allows
STEP = 1.5  # from one depth of the coarse look to the next
MOST_LOOKS = 16
SHALLOWEST = 1e-4  # of the stretched arm's length: a stroke that is none
VALLEYS = 8  # looked into, at most
FORESIGHT = 1.15  # a root may lie so much deeper than a first secant has it
FIRST_STEP = 1.15  # of the root search
ROOT_STEPS = 24
WINDOW_STEPS, MOST_WINDOWS = 10, 4  # of the golden section over the spin; how often its window is moved on
FINE_WINDOW = 0.005  # of a step of the grid
PRECISION = 2e-5  # of the depth
KEPT_BACK = (
    1e-5,
    4e-5,
    1e-4,
    1e-3,
    1e-2,
)  # of the depth: at the deepest a joint stops, so the plan ends a little before


@dataclass(frozen=True)
class Deepest:
    """The deepest stroke of a hole, and the motion that reaches it.

    Attributes:
        depth: [m]; 0 where no stroke, however short, has zero reversals.
        profile: two legs of that stroke, or None.
        branch: 0..7, or None.
    """

    depth: float
    profile: Profile | None = None
    branch: int | None = None


def deepest_stroke(robot: Robot, tool: Tool, hole: Hole, settings: Settings | None = None) -> Deepest:
    """The greatest stroke that still has zero reversals (theory §4); the hole's own depth is not looked at.

    Args:
        robot: the arm.
        tool: the drill.
        hole: target, direction and reference of the spin; its `branch`, if any, is the only one searched.
        settings: whose `min_rate` every joint keeps at every point, whose `psi_bound` holds the spin, and whose `legs`
            are straight, or free with twist rates up to `max_twist`.
    """
    settings = settings or Settings()
    straight = _Search(robot, tool, hole, settings).run()
    if settings.legs == "straight":
        return straight
    free = Deepest(*deepest_free(robot, tool, hole, settings))
    steepest = 0.0 if straight.profile is None else float(np.abs(straight.profile.twist_rate).max())
    return straight if straight.depth > free.depth and steepest <= settings.max_twist else free


@dataclass(frozen=True)
class _Valley:
    """A spin at the target around which the margin is greatest."""

    posture: int
    psi_t: float


class _Search:
    """One hole, and the greatest margin of its pairs of legs as the stroke grows."""

    def __init__(self, robot: Robot, tool: Tool, hole: Hole, settings: Settings) -> None:
        self.robot, self.tool, self.hole = robot, tool, hole
        self.plane = twist_plane(robot, tool, hole)
        self.branches = np.array([hole.branch in (None, branch) for branch in range(8)])
        self.stretched = float(robot.arm.c2 + np.hypot(robot.arm.a2, robot.arm.c3))
        self.min_rate = max(settings.min_rate, LEAST_RATE)
        self.psi_bound = settings.psi_bound
        self.psi = target_spins(settings.psi_bound, GRID)
        self.step = float(self.psi[1] - self.psi[0])

    def run(self) -> Deepest:
        """Look coarsely at growing depths, then locate the root in each valley that may beat the best so far."""
        alive, depth = self._survivors()
        while depth > SHALLOWEST * self.stretched:
            found = self._deepest_of(self._valleys(depth, self._around(alive)), depth)
            if found is not None:
                return self._settled(*found)
            # the coarse look told too much: from a lesser depth, then
            depth /= STEP
            alive = self._look(depth, self._every_other()) > self.min_rate
        return Deepest(0.0)

    def _deepest_of(self, valleys: list[_Valley], start: float) -> tuple[float, Array] | None:
        best: tuple[float, Array] | None = None
        for valley in valleys[:VALLEYS]:
            found = self._root(valley, start, 0.0 if best is None else best[0])
            if found is not None and (best is None or found[0] > best[0]):
                best = found
        return best

    def asked(self, depth: float) -> Asked:
        """What legs of a depth are held to."""
        limits = self.robot.limits
        return Asked(
            depth, self.min_rate, False, False, limits.lower + LIMIT_SLACK, limits.upper - LIMIT_SLACK,
            LONGEST_TWIST / depth, self.psi_bound or 0.0,
        )  # fmt: skip

    def _survivors(self) -> tuple[npt.NDArray[np.bool_], float]:
        """Where some pair may do at a depth, shape (4, K), of which coarse looks show none at half as much again."""
        depth, looks = FIRST_LOOK * self.stretched, MOST_LOOKS
        margin = self._look(depth, self._every_other())
        while not (margin > self.min_rate).any() and depth > SHALLOWEST * self.stretched:
            depth, looks = depth / STEP**2, 2  # more is known to lack
            margin = self._look(depth, self._every_other())
        for _ in range(looks):
            deeper = self._look(depth * STEP, self._around(margin > self.min_rate))
            if not (deeper > self.min_rate).any():
                break
            margin, depth = deeper, depth * STEP
        return margin > self.min_rate, depth

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
        """What the margin of a pair is at most, at every spin of the grid, shape (4, K)."""
        out = np.empty((4, self.psi.size, 3))
        pairs.look(
            self.robot.arm, self.plane, self.psi, lines, np.ones(6, dtype=bool), self.asked(depth), legs.TRAVEL, out
        )
        return out[..., 1]

    def _valleys(self, depth: float, lines: npt.NDArray[np.bool_]) -> list[_Valley]:
        """Local maxima of the greatest margin over the spins of the grid, highest first."""
        out = np.empty((4, self.psi.size, pairs.COLUMNS))
        asked = self.asked(depth)
        pairs.best_pairs(
            self.robot.arm, self.plane, self.psi, lines, np.ones(6, dtype=bool), asked, asked.unlimited(),
            legs.GREATEST_MARGIN, COARSE_NODES, out,
        )  # fmt: skip
        margin = out[..., pairs.MARGIN]
        left, right = np.roll(margin, 1, axis=1), np.roll(margin, -1, axis=1)
        if self.psi_bound is not None:
            left[:, 0] = right[:, -1] = -np.inf
        peaks = np.argwhere((margin > -np.inf) & (margin >= left) & (margin > right)).tolist()
        peaks.sort(key=lambda peak: (-margin[*peak], peak))
        return [_Valley(p, float(self.psi[n])) for p, n in peaks]

    def _root(self, valley: _Valley, start: float, beaten: float) -> tuple[float, Array] | None:
        """The depth at which the valley's greatest margin falls to the threshold, and its pair.

        None where it has none at the start, or where it plainly falls short of a depth that is had elsewhere.
        """
        best = self._top(start, valley.posture, valley.psi_t, self.step)
        if not np.isfinite(best[pairs.VALUE]):
            return None
        good, f_good = start, best[pairs.MARGIN] - self.min_rate
        bad, f_bad = np.inf, -np.inf
        depth, around = good * FIRST_STEP, self.step
        for step in range(ROOT_STEPS):
            pair = self._top(depth, valley.posture, float(best[pairs.SPIN]), around)
            if around < self.step and not np.isfinite(pair[pairs.VALUE]):
                pair = self._top(depth, valley.posture, float(best[pairs.SPIN]), self.step)
            f = pair[pairs.MARGIN] - self.min_rate
            # the spin moves the less, the nearer the root
            around = min(max(4 * abs(pair[pairs.SPIN] - best[pairs.SPIN]), 0.05 * self.step), self.step)
            if step == 0 and f < f_good:
                foreseen = start + (depth - start) * f_good / (f_good - f)
                if foreseen * FORESIGHT < beaten:
                    return None
            # Anderson and Bjoerck: the end that stays is weighed down, so that it will not stay for ever
            if np.isfinite(pair[pairs.VALUE]):
                f_bad *= 1 - f / f_good if 0 < f < f_good else 0.5
                good, f_good, best = depth, f, pair
            else:
                f_good *= 1 - f / f_bad if f_bad < f < 0 else 0.5
                bad, f_bad = depth, f
            close = PRECISION * good
            if bad - good < close:
                break
            if bad == np.inf:
                depth = good * FIRST_STEP
            else:
                share = f_good / (f_good - f_bad) if np.isfinite(f_bad) else 0.5
                depth = min(max(good + share * (bad - good), good + 0.4 * close), bad - 0.4 * close)
        return good, best

    def _top(
        self,
        depth: float,
        posture: int,
        psi_t: float,
        around: float,
        *,
        nodes: int = NODES,
    ) -> Array:
        """The pair of greatest margin around a spin, as `kernels.pairs` writes it."""
        asked, row = self.asked(depth), np.empty(pairs.COLUMNS)
        low, high = psi_t - around, psi_t + around
        for _ in range(MOST_WINDOWS):
            if self.psi_bound is not None:
                low, high = max(low, -self.psi_bound), min(high, self.psi_bound)
            pairs.descend(
                self.robot.arm, self.plane, posture, low, high, np.ones(6, dtype=bool), asked, asked.unlimited(),
                self.branches, legs.GREATEST_MARGIN, nodes, WINDOW_STEPS, np.inf, True, row,
            )  # fmt: skip
            spin, edge = float(row[pairs.SPIN]), 0.03 * (high - low)
            if low + edge < spin < high - edge or row[pairs.MARGIN] == -np.inf:
                break
            low, high = spin - around, spin + around
        return row

    def _settled(self, depth: float, pair: Array) -> Deepest:
        """The deepest stroke whose motion, followed closely, has no reversal."""
        posture, psi_t = int(pair[pairs.BRANCH]) // 2, float(pair[pairs.SPIN])
        for kept_back in KEPT_BACK:
            stroke = depth * (1 - kept_back)
            row = self._top(stroke, posture, psi_t, FINE_WINDOW * self.step, nodes=FINE_NODES)
            if not np.isfinite(row[pairs.VALUE]):
                continue
            branch = int(row[pairs.BRANCH])
            slopes = float(row[pairs.SLOPE_ABOVE]), float(row[pairs.SLOPE_BELOW])
            profile = straight_motion(stroke, float(row[pairs.SPIN]), slopes, periodic=self.psi_bound is None)
            score = evaluate(self.robot, self.tool, replace(self.hole, depth=stroke), profile, branch).score
            if score is not None and score.reversals == 0 and score.min_rate.min() >= self.min_rate * (1 - 1e-6):
                return Deepest(stroke, profile, branch)
        return Deepest(0.0)
