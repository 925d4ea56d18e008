"""EAIK (Ostermeier et al.): analytic inverse kinematics by subproblems (C++), a batch of poses on one thread."""

from __future__ import annotations

from typing import Any

import numpy as np
from eaik.IK_HP import HPRobot

from zerorev.model._arrays import Array
from zerorev.model.robot import ArmGeometry

__all__ = ["Eaik"]

X, Y, Z = np.eye(3)


class Eaik:
    """One arm, given to the library by its joint axes and the steps between them, and a batch of poses."""

    def __init__(self, arm: ArmGeometry, T: Array) -> None:
        steps = [
            0 * X,
            (arm.a1, arm.b, arm.c1),
            (0, 0, arm.c2),
            (arm.a2, 0, arm.c3),
            0 * X,
            0 * X,
            (0, 0, arm.c4),
        ]
        self.arm, self.poses = arm, list(T)
        self.robot = HPRobot(np.array([Z, Y, Y, Z, Y, Z]), np.array(steps, dtype=float))

    def solve(self) -> Any:
        """The library's own answers, one a pose."""
        return self.robot.IK_batched(self.poses, 1)

    def solutions(self) -> Array:
        """Controller angles [rad], shape (N, 8, 6), NaN where there are none."""
        out = np.full((len(self.poses), 8, 6), np.nan)
        sign, offset = np.array(self.arm.sign), np.array(self.arm.offset)
        for n, answer in enumerate(self.solve()):
            model = np.array(answer.Q)[~np.array(answer.is_LS, dtype=bool)]
            out[n, : len(model)] = (model + offset) * sign
        return out
