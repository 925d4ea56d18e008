"""Random targets of every robot that ships, and the legs that set out from them."""

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np

from oracles import legs as twin
from oracles.holes import ROBOTS
from zerorev.files.io import read_tool
from zerorev.kernels import field, leg_search, legs
from zerorev.kernels.layout import Constraints
from zerorev.model.hole import Hole
from zerorev.motion import kinematics
from zerorev.motion.drilling import Drilling, joint_rates

TOOL = read_tool("thesis_drill")
SLOW = bool(numba.config.DISABLE_JIT)
ALL_JOINTS = np.ones(6, dtype=bool)
LEAST_RATE = np.deg2rad(1e-4)


def asked(robot, hole, *, min_rate=LEAST_RATE, mean_rule=False, turn_inside=False, limits=True, bound=0.0):
    low, high = (robot.limits.lower, robot.limits.upper) if limits else (np.full(6, -np.inf), np.full(6, np.inf))
    steepest = 2 * np.pi / hole.depth
    return Constraints(
        low, high, min_rate, bound, steepest, depth=hole.depth, mean_rule=mean_rule, turn_inside=turn_inside
    )


@dataclass(frozen=True)
class Start:
    """One leg out of one target, on the branch that a random joint vector stands on."""

    robot: object
    hole: Hole
    branch: int
    psi_t: float
    slope: float

    @property
    def plane(self):
        return Drilling(self.robot, TOOL, self.hole).plane

    def traced(self, nodes, branch=None):
        """Rows of the leg, or None where it cannot be run."""
        leg, work = np.empty((legs.ROWS, 6)), np.empty(field.ROOM)
        branch = self.branch if branch is None else branch
        args = self.robot.arm, self.plane, branch, self.psi_t, self.slope, self.hole.depth, nodes, work, leg
        return leg if legs.trace_leg(*args) else None

    def naive(self):
        return twin.trace(self.robot, TOOL, self.hole, self.branch, self.psi_t, self.slope)

    def at_target(self):
        """Principal angles, critical rates, and signs of theta_psi."""
        pose = kinematics.tcp_pose(self.hole, 0.0, self.psi_t) @ np.linalg.inv(TOOL.T_flange_tcp)
        joints = kinematics.inverse(self.robot, pose)[self.branch]
        theta_s, theta_psi = joint_rates(Drilling(self.robot, TOOL, self.hole), 0.0, self.psi_t)
        kappa = -theta_s[self.branch] / theta_psi[self.branch]
        return joints, kappa, np.sign(theta_psi[self.branch])

    def best_leg(self, side, wanted, mode=legs.TRAVEL, keep=ALL_JOINTS, nodes=field.BLOCK):
        """(least cost, its slope, greatest margin)."""
        joints, kappa, sense = self.at_target()
        best, work = np.empty(3), np.empty(field.ROOM)
        held = (side * sense, keep, joints)
        args = self.robot.arm, self.plane, self.branch, self.psi_t, side, kappa, held, wanted, mode, nodes, work, best
        leg_search.best_leg(*args)
        return best


def starts(count, seed, robots=ROBOTS[:: 2 if SLOW else 1], deepest=0.06):
    """Random reachable targets, `count` a robot, with slopes of up to 3 deg/mm."""
    rng, found = np.random.default_rng(seed), []
    for robot in robots:
        scale = (robot.arm.c2 + robot.arm.c3) / 0.7
        taken = 0
        while taken < count:
            T = kinematics.forward(robot, rng.uniform(robot.limits.lower, robot.limits.upper)) @ TOOL.T_flange_tcp
            hole = Hole("random", T[:3, 3], -T[:3, 2], rng.uniform(0.01, deepest) * scale, psi_zero=T[:3, 1])
            start = Start(robot, hole, int(rng.integers(8)), rng.uniform(-0.3, 0.3), rng.normal() * 15 / scale)
            if np.isfinite(start.at_target()[1]).all():
                found.append(start)
                taken += 1
    return found
