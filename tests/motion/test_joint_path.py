"""Joint paths: continuous, on one branch, with turns that fit the whole path; and what can be wrong with them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from oracles import arm as twin
from zerorev.model.hole import Hole
from zerorev.model.profile import Profile
from zerorev.model.robot import JointLimits
from zerorev.model.tool import Tool
from zerorev.motion import kinematics
from zerorev.motion.drilling import Drilling
from zerorev.motion.joint_path import choose_turns, joint_path, joints_along, sample_distances

FULL = 2 * np.pi
STRAIGHT = Tool.from_mm_deg((0, 0, 120), (180, 0, 0))  # drill axis = axis 6: spin moves joint 6 alone


def with_limits(robot, joint, lower_deg, upper_deg):
    lower, upper = robot.limits.lower.copy(), robot.limits.upper.copy()
    lower[joint - 1], upper[joint - 1] = np.deg2rad([lower_deg, upper_deg])
    return replace(robot, limits=JointLimits(lower, upper, robot.limits.speed))


def hole_under(robot, tool, joints, *, depth, standoff):
    """A hole that the tool meets at this stand-off, with psi = 0, when the joints are these."""
    T = kinematics.forward(robot, joints) @ tool.T_flange_tcp
    return Hole("here", T[:3, 3] - standoff * T[:3, 2], -T[:3, 2], depth, psi_zero=T[:3, 1])


class TestPath:
    def test_follows_the_twin_that_knows_no_branches(self, robot, tool, position):
        path = joint_path(Drilling(robot, tool, position.hole), position.profile, position.branch, samples=60)
        traced = twin.trace(robot, tool, position.hole, path.standoff, path.psi, path.joints[0])
        np.testing.assert_allclose(path.joints, traced, atol=1e-11)

    def test_follows_the_twin_on_every_robot(self, any_robot):
        tool = Tool.from_mm_deg((60, 20, 180), (0, -120, 10))
        bent = np.array([0.3, 0.2, 1.4, 0.4, 0.9, 0.2])
        joints = np.array(any_robot.arm.sign) * (bent + any_robot.arm.offset)
        hole = hole_under(any_robot, tool, joints, depth=0.04, standoff=0.02)
        profile = Profile(np.array([0.04, 0.02, 0.0, 0.01, 0.04]), np.array([0.2, 0.0, -0.1, -0.3, -0.2]))
        seen = 0
        for branch in range(8):
            path = joint_path(Drilling(any_robot, tool, hole), profile, branch, samples=30)
            if path.fault is None and path.jump is None:
                traced = twin.trace(any_robot, tool, hole, path.standoff, path.psi, path.joints[0])
                np.testing.assert_allclose(path.joints, traced, atol=1e-10)
                seen += 1
        assert seen >= 4

    def test_breakpoints_are_among_the_samples(self, robot, tool, positions):
        hole = positions[0].hole
        profile = Profile(np.array([0.05, 0.0123, 0.0, 0.0307, 0.05]), np.deg2rad([14, 2, -6, -20, -30]))
        path = joint_path(Drilling(robot, tool, hole), profile, 4, samples=37)
        motion = path.at_breakpoints(profile, 4)
        T = kinematics.forward(robot, motion.joints) @ tool.T_flange_tcp
        np.testing.assert_allclose(T, kinematics.tcp_pose(hole, profile.standoff, profile.psi), atol=1e-12)

    def test_samples_lie_evenly_and_reach_both_ends(self):
        profile = Profile(np.array([0.03, 0.0, 0.01]), np.zeros(3))
        distance = sample_distances(profile, 100)
        assert distance[0] == 0.0
        assert distance[-1] == profile.distance[-1]
        assert 0.03 in distance
        steps = np.diff(distance)
        assert (steps > 0).all()
        assert steps.max() <= 0.04 / 100 * (1 + 1e-9)

    def test_the_corner_may_lie_deeper_than_the_target(self, robot, tool, positions):
        first = positions[0]
        profile = Profile.straight(0.05, *first.profile.psi, corner=-0.002)
        path = joint_path(Drilling(robot, tool, first.hole), profile, first.branch)
        assert path.runs
        assert path.standoff.min() == -0.002


class TestTurns:
    @pytest.mark.parametrize("way", [1, -1])
    def test_a_long_spin_is_found_regardless_of_the_turn_of_its_first_point(self, robot, way):
        """The thesis fixes each joint's turn at the first point, and loses motions by it (theory §2)."""
        joints = np.deg2rad([20, -80, 100, 15, 40, 170 * way])
        hole = hole_under(robot, STRAIGHT, joints, depth=0.01, standoff=0.01)
        profile = Profile.straight(0.01, *np.deg2rad([0, 170 * way, 340 * way]))
        first_turn = joints_along(Drilling(robot, STRAIGHT, hole), 0, *profile.at(sample_distances(profile, 400)))[:, 5]
        low, high = robot.limits.lower[5], robot.limits.upper[5]
        assert first_turn.min() < low or first_turn.max() > high

        path = joint_path(Drilling(robot, STRAIGHT, hole), profile, 0)
        assert path.runs
        assert np.ptp(path.joints[:, 5]) > np.deg2rad(330)
        assert low <= path.joints[:, 5].min() <= path.joints[:, 5].max() <= high

    def test_from_10_to_350_deg_fits_limits_of_0_to_360(self):
        limits = JointLimits(np.zeros(6), np.full(6, FULL), np.ones(6))
        low, high = np.deg2rad([10.0] * 6), np.deg2rad([350.0] * 6)
        for turn in (-2, -1, 0, 1, 2):
            turns, over = choose_turns(low + turn * FULL, high + turn * FULL, limits)
            assert over == ()
            np.testing.assert_allclose(turns, -turn * FULL)

    @given(
        low=st.floats(-400, 400),
        span=st.floats(0, 700),
        lower=st.floats(-400, 100),
        width=st.floats(10, 800),
        near=st.none() | st.floats(-400, 400),
    )
    def test_are_the_best_of_all(self, low, span, lower, width, near):
        """Against the list of all turns: those that fit, and of them the farthest from the limits or the nearest."""
        extent, window = np.deg2rad([low, low + span]), np.deg2rad([lower, lower + width])
        limits = JointLimits(np.full(6, window[0]), np.full(6, window[1]), np.ones(6))
        aim = None if near is None else (np.deg2rad(near),) * 6
        turns, over = choose_turns(np.full(6, extent[0]), np.full(6, extent[1]), limits, aim)

        def margin(turn):
            return min(extent[0] + turn - window[0], window[1] - extent[1] - turn)

        def cost(turn):
            return -margin(turn) if aim is None else abs(extent.mean() + turn - aim[0])

        everything = FULL * np.arange(-6, 7)
        fitting = [turn for turn in everything if margin(turn) >= 0]
        if over:
            assert over == (1, 2, 3, 4, 5, 6)
            assert not [turn for turn in fitting if margin(turn) > 1e-9]
            assert margin(turns[0]) == pytest.approx(max(map(margin, everything)), abs=1e-9)
        else:
            assert margin(turns[0]) >= -1e-9
            if fitting:
                assert cost(turns[0]) == pytest.approx(min(map(cost, fitting)), abs=1e-9)

    def test_free_turns_lie_farthest_from_the_limits_unless_asked_near(self, robot, tool, positions):
        first = positions[0]
        middle = joint_path(Drilling(robot, tool, first.hole), first.profile, first.branch).joints[0]
        assert np.rad2deg(middle[5]) == pytest.approx(217.3562 - 360, abs=1e-3)
        published = tuple(np.deg2rad(first.axis_deg[0]))
        near = joint_path(Drilling(robot, tool, first.hole), first.profile, first.branch, near=published).joints[0]
        np.testing.assert_allclose(np.rad2deg(near), first.axis_deg[0], atol=1e-3)
        assert np.rad2deg(near[5]) == pytest.approx(217.3562, abs=1e-3)


class TestFaults:
    def test_out_of_reach_names_the_first_standoff_lost(self, robot, tool):
        joints = np.deg2rad([0, -60, 90, 0, 60, 0])
        hole = hole_under(robot, tool, joints, depth=0.6, standoff=0.0)
        path = joint_path(Drilling(robot, tool, hole), Profile.straight(0.6, 0, 0, 0), 0)
        reached = ~np.isnan(path.joints[:, 0])
        assert path.fault is not None
        assert not path.runs
        assert path.fault == path.standoff[~reached][0]

    def test_a_joint_over_its_limits_is_named(self, robot, tool, positions):
        first = positions[0]
        narrow = with_limits(robot, 4, -10, 11)
        path = joint_path(Drilling(narrow, tool, first.hole), first.profile, first.branch)
        assert path.over_limit == (4,)
        assert path.fault is path.jump is None
        assert not path.runs

    def test_crossing_the_wrist_singularity_is_a_jump(self, robot):
        """On one branch joint 5 keeps its sign, so joints 4 and 6 jump by half a turn where it passes zero."""
        joints = np.deg2rad([25, -80, 100, 0, 0, 10])
        hole = hole_under(robot, STRAIGHT, joints, depth=0.03, standoff=0.0151)
        for branch in (0, 1):
            path = joint_path(Drilling(robot, STRAIGHT, hole), Profile.straight(0.03, 0, 0, 0), branch)
            assert path.fault is None
            assert path.jump == pytest.approx(0.0151, abs=1e-4)
            assert not path.runs
