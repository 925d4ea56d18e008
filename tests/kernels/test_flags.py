"""The bits of the eight branches against what is known of each branch alone: its joints, and its two fields."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from oracles.starts import ROBOTS, SLOW, TOOL
from zerorev import kinematics
from zerorev.kernels import flags
from zerorev.model.hole import Hole
from zerorev.model.robot import JointLimits
from zerorev.model.tool import Tool

FULL = 2 * np.pi
BY_NAME = pytest.mark.parametrize("robot", ROBOTS, ids=lambda robot: robot.name)


def limits(robot, rng):
    """The robot's own, and random ones: narrow, wide, beyond a turn, and anywhere on the circle."""
    yield robot.limits
    for _ in range(1 if SLOW else 6):
        lower = rng.uniform(-FULL, np.pi, 6)
        yield JointLimits(lower, lower + rng.choice([0.5, 2.0, 4.0, 6.0, 7.0], 6), robot.limits.speed)


def places(robot, rng, count):
    """Holes near random arms' tips, in random directions."""
    for joints in rng.uniform(robot.limits.lower, robot.limits.upper, (count, 6)):
        T = kinematics.forward(robot, joints) @ TOOL.T_flange_tcp
        yield Hole("any", T[:3, 3], rng.normal(size=3), 0.1, psi_zero=T[:3, 0])


def bits_of(robot, tool, hole, standoff, psi):
    """`sign_flags`, as whether each bit is set: shape (8, 19, N)."""
    out = np.full((8, standoff.size), -1, dtype=np.int32)
    plane = kinematics.twist_plane(robot, tool, hole)
    flags.sign_flags(robot.arm, plane, robot.limits.lower, robot.limits.upper, standoff, psi, out)
    assert ((out >= 0) & (out < 1 << 19)).all()
    return (out[:, None] >> np.arange(19)[:, None] & 1).astype(bool)


def compare(robot, tool, hole, standoff, psi, many_limits):
    """Assert that every bit is what the fields and the joints say; how many signs and joints outside were seen."""
    theta_s, theta_psi = (
        np.moveaxis(field, 0, -1) for field in kinematics.joint_rates(robot, tool, hole, standoff, psi)
    )
    poses = kinematics.tcp_pose(hole, standoff, psi) @ np.linalg.inv(tool.T_flange_tcp)
    joints = np.moveaxis(kinematics.inverse(robot, poses), 0, -1)
    none, seen, outside = np.isnan(theta_s[:, 0]), 0, 0
    for held in many_limits:
        bits = bits_of(replace(robot, limits=held), tool, hole, standoff, psi)
        np.testing.assert_array_equal(bits[:, flags.NO_POSE], none)
        assert not bits[:, : flags.NO_POSE].any(axis=1)[none].any()
        for rates, first in ((theta_s, flags.RISES_WITH_S), (theta_psi, flags.RISES_WITH_PSI)):
            # rounding may turn the sign of what is next to nothing beside the other joints
            size = np.abs(rates).max(axis=1, keepdims=True)
            clear = np.abs(rates) > 1e-11 * (1 + size) ** 2
            np.testing.assert_array_equal(bits[:, first : first + 6][clear], (rates > 0)[clear])
            seen += clear.sum()
        lower, upper = held.lower[:, None], held.upper[:, None]
        turned = lower + (joints - lower) % FULL  # the first turn above the lower limit
        beyond = turned > upper
        clear = np.minimum(np.abs(turned - upper), np.abs((turned - lower + np.pi) % FULL - np.pi)) > 1e-6
        found = bits[:, flags.OUTSIDE : flags.OUTSIDE + 6]
        np.testing.assert_array_equal(found[clear], beyond[clear])
        outside += beyond[clear].sum()
    return seen, outside


class TestSignFlags:
    @BY_NAME
    def test_are_the_signs_of_the_fields_and_the_joints_outside_their_limits(self, robot):
        rng, seen = np.random.default_rng(1), np.zeros(2)
        points = 20 if SLOW else 300
        for hole in places(robot, rng, 2 if SLOW else 8):
            standoff, psi = rng.uniform(-0.1, 0.4, points), rng.uniform(-4, 4, points)
            seen += compare(robot, TOOL, hole, standoff, psi, limits(robot, rng))
        assert (seen > (5 if SLOW else 1000)).all()

    @pytest.mark.parametrize("pose", [((80, -40, 90), (20, 35, -70)), ((0, 0, 120), (180, 0, 0))])
    def test_tools_of_other_shapes(self, robot, pose):
        """A flange that is turned three ways in the tcp frame, and a drill axis that meets the wrist centre."""
        rng, seen = np.random.default_rng(3), np.zeros(2)
        for hole in places(robot, rng, 2 if SLOW else 6):
            standoff, psi = rng.uniform(0, 0.1, 50), rng.uniform(-3, 3, 50)
            seen += compare(robot, Tool.from_mm_deg(*pose), hole, standoff, psi, limits(robot, rng))
        assert (seen > 100).all()

    def test_blocks_of_any_size_are_the_same(self, robot, positions):
        standoff, psi = np.linspace(0, 0.05, 200), np.linspace(-3, 3, 200)
        whole = bits_of(robot, TOOL, positions[0].hole, standoff, psi)
        for count in (1, 3, flags.BLOCK - 1, flags.BLOCK, flags.BLOCK + 1, 199):
            some = bits_of(robot, TOOL, positions[0].hole, standoff[:count], psi[:count])
            np.testing.assert_array_equal(some, whole[..., :count])

    @BY_NAME
    def test_there_is_no_pose_out_of_reach_or_where_the_wrist_is_straight(self, robot):
        here = np.zeros(1)
        far = Hole(
            "far", np.array([9.0, 0.0, 0.0]), np.array([0.0, 0.0, -1.0]), 0.1, psi_zero=np.array([1.0, 0.0, 0.0])
        )
        assert bits_of(robot, TOOL, far, here, here)[:, flags.NO_POSE].all()
        joints = (robot.limits.lower + robot.limits.upper) / 2
        joints[4] = 0.0
        T = kinematics.forward(robot, joints) @ TOOL.T_flange_tcp
        straight = Hole("straight", T[:3, 3], -T[:3, 2], 0.1, psi_zero=T[:3, 1])
        none = np.isnan(kinematics.joint_rates(robot, TOOL, straight, 0.0, 0.0)[0][:, 0])
        np.testing.assert_array_equal(bits_of(robot, TOOL, straight, here, here)[:, flags.NO_POSE, 0], none)
        assert none.any()

    def test_a_joint_that_may_turn_all_the_way_round_is_never_outside(self, robot, positions):
        held = JointLimits(np.full(6, -np.pi), np.full(6, np.pi), robot.limits.speed)
        bits = bits_of(
            replace(robot, limits=held), TOOL, positions[0].hole, np.full(100, 0.02), np.linspace(-3, 3, 100)
        )
        assert not bits[:, flags.OUTSIDE : flags.OUTSIDE + 6].any()
