"""Plans to export: the published positions, and holes in any direction; and the reader of what was written."""

import dataclasses

import numpy as np
import pytest

from oracles import krl_reader
from zerorev.files.io import read_robot, read_tool
from zerorev.model.hole import Hole
from zerorev.model.job import Settings
from zerorev.model.plan import HolePlan, Plan, Verification
from zerorev.model.profile import Profile
from zerorev.model.tool import Tool
from zerorev.motion.evaluation import evaluate
from zerorev.motion.kinematics import inverse, tcp_pose, wrist_offset

# thesis Appendix B with theory §6 and §7: target [mm], stroke [mm], spins [deg], axis values at the start [deg]
PUBLISHED = {
    1: ((500, 300, 800), 50, (14.1646, -5.9388, -30.4599), (143.1752, -107.9003, -79.0638, 11.3008, 88.3939, 217.3562)),
    2: ((200, 400, 600), 20, (180.0, 178.1001, 142.4918), (-78.6901, -86.9817, 87.6934, 0.0, 89.2884, 101.3099)),
    3: ((200, 200, 1000), 30, (20.2431, -4.5475, -9.6903), (115.5591, -64.3099, -87.1047, 12.4793, 43.6965, 236.7431)),
}
PASSED = Verification(True, 40_000, 1_000, (0,) * 6, 1e-12, 1e-12, 1e-3, 0.1)


@pytest.fixture(scope="session")
def krl():
    """The reader of what was written."""
    return krl_reader


@pytest.fixture(scope="session")
def kuka():
    return read_robot("kuka_kr6_r700_2")


@pytest.fixture(scope="session")
def drill():
    return read_tool("thesis_drill")


@pytest.fixture(scope="session")
def planned(kuka, drill):
    """A verified answer for a given motion: by default on the first branch that can run it."""

    def planned(hole, profile, *, near=None, robot=kuka, tool=drill):
        joints = None if near is None else tuple(np.deg2rad(near))
        branches = range(8) if joints is None else [_branch_near(robot, tool, hole, profile, np.array(joints))]
        for branch in branches:
            seen = evaluate(robot, tool, hole, profile, branch, Settings(near_joints=joints))
            if seen.motion is not None:
                offset = wrist_offset(robot, tool)
                return HolePlan(hole, "evaluated", offset, seen.motion, seen.score, None, PASSED)
        pytest.fail(f"no branch runs {hole}")

    return planned


def _branch_near(robot, tool, hole, profile, joints):
    flange = tcp_pose(hole, profile.standoff[0], profile.psi[0]) @ np.linalg.inv(tool.T_flange_tcp)
    turned = inverse(robot, flange) - joints
    return int(np.nanargmin(np.abs(turned - 2 * np.pi * np.round(turned / (2 * np.pi))).max(axis=1)))


@pytest.fixture(scope="session")
def published(planned):
    """One of the thesis' three positions as a hole's plan."""

    def published(number, *, corner=0.0):
        target, depth, psi, start = PUBLISHED[number]
        hole = Hole(
            f"position {number}",
            np.array(target) * 1e-3,
            np.array([1.0, 0, 0]),
            depth * 1e-3,
            np.array([0, 1.0, 0]),
        )
        return planned(hole, Profile.straight(depth * 1e-3, *np.deg2rad(psi), corner=corner), near=start)

    return published


@pytest.fixture(scope="session")
def plan_of(kuka, drill):
    """A plan of holes, with settings given by name."""

    def plan_of(*holes, T_base_part=None, robot=kuka, tool=drill, name="test", **settings):
        part = np.eye(4) if T_base_part is None else T_base_part
        return Plan(robot, tool, Settings(**settings), holes, part, name)

    return plan_of


@pytest.fixture(scope="session")
def spoil():
    """A copy of a frozen noun with some attributes changed."""
    return dataclasses.replace


@pytest.fixture(scope="session")
def straight_down_tool():
    """A drill along the flange's own axis, a little beside it: spin is nearly joint 6 alone, so there is much of it."""
    return Tool.from_mm_deg((20, 0, 120), (180, 0, 0), name="straight")
