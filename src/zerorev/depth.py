"""The deepest stroke of a hole that has no reversal, over all branches, straight legs (theory §4).

There is no bisection over the depth and no search inside one: at every spin at the target the two legs march out on
their own until a joint would stop, and the spin at which the lesser of the two runs farthest is closed in on.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from zerorev.kernels import reach as kernels
from zerorev.kinematics import twist_plane
from zerorev.model._arrays import Array
from zerorev.model.hole import Hole
from zerorev.model.job import Settings
from zerorev.model.profile import Profile
from zerorev.model.robot import Robot
from zerorev.model.tool import Tool
from zerorev.search.line import golden
from zerorev.search.straight import LEAST_RATE, LONGEST_TWIST, straight_motion, target_spins

__all__ = ["Deepest", "deepest_stroke"]

GRID = 180  # spins at the target in one turn
STEPS_ALONG_ARM = (200, 800)  # points looked at per length of the stretched arm: looking over, closing in
STEEPEST = float(np.deg2rad(20e3))  # [rad/m] 20 deg/mm
LIMIT_SLACK = 1e-5  # [rad] kept to the limits, against the sums by which a leg knows its angles
PEAKS = 10  # closed in on, at most
CLOSING_STEPS = 24
KEPT_BACK = 1e-6  # of the depth: the deepest leg ends where a joint stops, the plan a little before


class Sought(NamedTuple):
    """What a leg is held to; a NamedTuple, so that kernels take it whole. SI units."""

    lower: Array
    upper: Array
    min_rate: float
    psi_bound: float  # 0: periodic
    steepest: float
    longest: float
    longest_twist: float


@dataclass(frozen=True)
class Deepest:
    """The deepest stroke of a hole, and the motion that reaches it.

    Attributes:
        depth: [m]; 0 where no stroke, however short, has zero reversals.
        profile: two straight legs of that stroke, or None.
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
        settings: whose `min_rate` every joint keeps at every point, and whose `psi_bound` holds the spin.
    """
    settings = settings or Settings()
    return _Search(robot, tool, hole, settings).run()


class _Search:
    """One hole, and the marching of legs out of its target."""

    def __init__(self, robot: Robot, tool: Tool, hole: Hole, settings: Settings) -> None:
        self.arm, self.plane = robot.arm, twist_plane(robot, tool, hole)
        self.branches = np.array([hole.branch in (None, branch) for branch in range(8)])
        stretched = float(robot.arm.c2 + np.hypot(robot.arm.a2, robot.arm.c3))
        self.coarse, self.fine = (stretched / steps for steps in STEPS_ALONG_ARM)
        self.sought = Sought(
            robot.limits.lower + LIMIT_SLACK,
            robot.limits.upper - LIMIT_SLACK,
            max(settings.min_rate, LEAST_RATE),
            settings.psi_bound or 0.0,
            STEEPEST,
            2 * stretched,
            LONGEST_TWIST,
        )
        self.periodic = settings.psi_bound is None
        self.psi = target_spins(settings.psi_bound, GRID)

    def run(self) -> Deepest:
        depth = np.empty((8, self.psi.size))
        kernels.scan_depth(self.arm, self.plane, self.psi, self.sought, self.coarse, self.branches, depth)
        best = (0.0, -1, 0.0, 0.0, 0.0)
        for branch, n in self._peaks(depth):
            best = max(best, self._close_in(branch, n))
        reached, branch, psi_t, above, below = best
        if branch < 0:
            return Deepest(0.0)
        stroke = reached * (1 - KEPT_BACK)
        return Deepest(stroke, straight_motion(stroke, psi_t, (above, below), periodic=self.periodic), branch)

    def _peaks(self, depth: Array) -> list[tuple[int, int]]:
        """The highest local maxima along the target line, highest first."""
        left, right = np.roll(depth, 1, axis=1), np.roll(depth, -1, axis=1)
        found = np.argwhere((depth > 0) & (depth >= left) & (depth >= right))
        ordered = sorted(((-depth[b, n], int(b), int(n)) for b, n in found))
        return [(b, n) for _, b, n in ordered[:PEAKS]]

    def _close_in(self, branch: int, n: int) -> tuple[float, int, float, float, float]:
        """Depth, branch, spin and slopes of the peak around one spin of the grid."""
        step = self.psi[1] - self.psi[0]
        low, high = self.psi[n] - step, self.psi[n] + step
        if not self.periodic:
            low, high = max(low, self.psi[0]), min(high, self.psi[-1])
        out, middle = np.empty(3), float(self.psi[n])

        def height(psi_t: float) -> float:
            kernels.deepest_pair(self.arm, self.plane, branch, psi_t, self.sought, self.coarse, True, out)
            return -float(out[0])

        best = min(golden(height, low, high, CLOSING_STEPS), middle, key=height)
        kernels.deepest_pair(self.arm, self.plane, branch, best, self.sought, self.fine, True, out)
        return float(out[0]), branch, best, float(out[1]), float(out[2])
