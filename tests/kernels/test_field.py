"""The two rate fields at many points at once, against the arm's own point by point, whose own twin is in test_arm."""

from __future__ import annotations

import numpy as np
import pytest

from oracles.starts import ROBOTS, SLOW, TOOL, starts
from zerorev.kernels import arm as one_by_one
from zerorev.kernels import field
from zerorev.model.hole import Hole
from zerorev.motion import kinematics
from zerorev.motion.drilling import Drilling

BY_NAME = pytest.mark.parametrize("robot", ROBOTS, ids=lambda robot: robot.name)


class TestCosSin:
    def test_is_numpys_to_the_last_two_bits(self):
        x = np.random.default_rng(0).uniform(-20, 20, 2_000 if SLOW else 200_000)
        x = np.concatenate([x, np.arange(-26, 27) * np.pi / 4, [0.0, -0.0, 1e-300, np.pi, -np.pi]])
        found = np.array([field.cos_sin(value) for value in x])
        np.testing.assert_allclose(found, np.transpose([np.cos(x), np.sin(x)]), rtol=0, atol=3e-16)

    def test_of_no_angle_is_none(self):
        assert np.isnan(field.cos_sin(np.float64(np.nan))).all()


def one_at_a_time(robot, plane, posture, standoff, psi):
    """`arm.twist_field` at every point, shape (2, 6, N), NaN where it cannot reach."""
    out = np.full((2, 6, standoff.size), np.nan)
    cs, theta_s, theta_psi = np.empty((6, 2)), np.empty(6), np.empty(6)
    for n in range(standoff.size):
        if one_by_one.twist_field(robot.arm, plane, standoff[n], psi[n], posture, cs, theta_s, theta_psi):
            out[:, :, n] = theta_s, theta_psi
    return out


def many_at_once(robot, plane, posture, standoff, psi):
    out = np.empty((2, 6, standoff.size))
    field.rates(robot.arm, plane, posture, standoff, psi, out[0], out[1])
    return out


def random_planes(robot, count, seed):
    """Twist planes at the edge of reach and well within it, skew to the arm."""
    rng = np.random.default_rng(seed)
    size = robot.arm.c1 + robot.arm.c2 + robot.arm.c3
    for _ in range(count):
        direction = rng.normal(size=3)
        across = np.cross(direction, rng.normal(size=3))
        hole = Hole("any", rng.uniform(-0.7, 0.7, 3) * size, direction, 0.1, psi_zero=across)
        yield Drilling(robot, TOOL, hole).plane


class TestFields:
    @BY_NAME
    def test_are_those_of_the_arm_point_by_point(self, robot):
        rng, reached = np.random.default_rng(1), 0
        points = 60 if SLOW else 500
        for plane in random_planes(robot, 3 if SLOW else 40, seed=2):
            standoff, psi = rng.uniform(-0.1, 0.6, points) * robot.arm.c2, rng.uniform(-4, 4, points)
            for posture in range(4):
                ours = many_at_once(robot, plane, posture, standoff, psi)
                theirs = one_at_a_time(robot, plane, posture, standoff, psi)
                np.testing.assert_array_equal(np.isnan(ours), np.isnan(theirs))
                # next to a singularity rates are great, and what rounding does to them grows with their square
                size = np.abs(theirs).max(axis=(0, 1))
                assert (np.abs(ours - theirs) <= 1e-13 * (1 + size) ** 2)[~np.isnan(theirs)].all()
                reached += np.isfinite(theirs[0, 0]).sum()
        assert reached > 100

    @BY_NAME
    def test_blocks_of_any_size_are_the_same(self, robot):
        start = next(start for start in starts(1, seed=3, robots=[robot]))
        posture = start.branch // 2
        standoff, psi = np.linspace(0, start.hole.depth, 2 * field.BLOCK), start.psi_t + np.linspace(-0.1, 0.1, 192)
        whole = many_at_once(robot, start.plane, posture, standoff, psi)
        work = np.empty(field.ROOM)
        for count in [1, 2, 3, 5, 95] if SLOW else range(1, field.BLOCK + 1):
            np.testing.assert_allclose(
                many_at_once(robot, start.plane, posture, standoff[:count], psi[:count]), whole[..., :count], rtol=1e-12
            )
            # what lies beyond the count is left alone
            work[:] = 7.0
            work[field.STANDOFF * field.BLOCK :][:count] = standoff[:count]
            work[field.PSI * field.BLOCK :][:count] = psi[:count]
            field.fields(robot.arm, start.plane, posture, count, work)
            rows = work.reshape(-1, field.BLOCK)
            assert (rows[:, count:] == 7.0).all()
            assert (rows[field.THETA_PSI + 6 :] == 7.0).all()
            np.testing.assert_allclose(rows[field.THETA_S :][:6, :count], whole[0, :, :count], rtol=1e-12)
            np.testing.assert_allclose(rows[field.THETA_PSI :][:6, :count], whole[1, :, :count], rtol=1e-12)
        for count in (field.BLOCK + 1, 2 * field.BLOCK - 1):
            np.testing.assert_allclose(
                many_at_once(robot, start.plane, posture, standoff[:count], psi[:count]), whole[..., :count], rtol=1e-12
            )

    @BY_NAME
    def test_are_nan_in_every_joint_where_there_are_none(self, robot):
        """Where the wrist is straight, the wrist centre lies on axis 1, or nothing reaches."""
        arm, down = robot.arm, np.array([0.0, 0.0, -1.0])
        joints = (robot.limits.lower + robot.limits.upper) / 2
        joints[4] = 0.0
        straight = kinematics.forward(robot, joints) @ TOOL.T_flange_tcp
        bent = Hole("any", np.zeros(3), down, 0.1, psi_zero=np.array([0.6, 0.8, 0.0]))
        lever = kinematics.tcp_pose(bent, 0.0, 0.0)[:3, :3] @ Drilling(robot, TOOL, bent).plane.wrist
        over = np.array([0.0, 0.0, arm.c1 + 0.6 * (arm.c2 + arm.c3)]) - lever
        for target, direction, across in (
            (straight[:3, 3], -straight[:3, 2], straight[:3, 1]),
            (over, down, bent.psi_zero),
            (np.array([9.0, 0.0, 0.0]), down, bent.psi_zero),
        ):
            plane = Drilling(robot, TOOL, Hole("any", target, direction, 0.1, psi_zero=across)).plane
            found = [many_at_once(robot, plane, posture, np.zeros(1), np.zeros(1)) for posture in range(4)]
            assert np.isnan(found).all(axis=(1, 2, 3)).any()
            for fields in found:
                assert np.isnan(fields).all() or np.isfinite(fields).all()
