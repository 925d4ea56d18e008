"""Reversals as located events, travel, slowest motion, limits; the published figures."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq, minimize_scalar

from oracles import arm as twin
from zerorev.model.hole import Hole
from zerorev.model.job import Settings
from zerorev.model.profile import Profile
from zerorev.model.robot import JointLimits
from zerorev.model.tool import Tool
from zerorev.motion import kinematics
from zerorev.motion.drilling import Drilling, joint_rates
from zerorev.motion.evaluation import evaluate, meets_threshold
from zerorev.motion.joint_path import joint_path, joints_along, outward_rates, sample_distances

AT_0_01_DEG_PER_MM = np.deg2rad(10.0)


def deg_per_mm(rate):
    return np.rad2deg(rate) / 1e3


def score_of(robot, tool, hole, profile, branch, settings=None):
    evaluation = evaluate(robot, tool, hole, profile, branch, settings)
    assert evaluation.findings == ()
    return evaluation.score


def unlimited(robot):
    """The arm without joint limits."""
    return replace(robot, limits=JointLimits(np.full(6, -20.0), np.full(6, 20.0), robot.limits.speed))


class TestPublished:
    """Theory §7, and §5 for the slowest motion."""

    def test_spins_reverse_no_joint_and_travel_as_published(self, robot, tool, position):
        score = score_of(robot, tool, position.hole, position.profile, position.branch)
        assert score.reversals_per_joint == (0,) * 6
        assert score.events == ()
        assert np.rad2deg(score.travel) == pytest.approx(position.travel_deg, abs=0.05)

    def test_held_spin_reverses_every_joint_that_moves_at_the_target(self, robot, tool, position):
        score = score_of(robot, tool, position.hole, position.held_spin, position.branch)
        assert score.reversals_per_joint == position.baseline
        assert {(event.leg, event.standoff) for event in score.events} == {("target", 0.0)}
        assert np.rad2deg(score.travel) == pytest.approx(position.baseline_travel_deg, abs=0.05)

    def test_position_2_reverses_four_joints_that_a_threshold_can_see(self, robot, tool, positions):
        """Joint 4 does not turn, and joint 5 backs up by 0.041 deg: the thesis counts 4."""
        second = positions[1]
        evaluation = evaluate(robot, tool, second.hole, second.held_spin, second.branch)
        A4, A5 = np.rad2deg(evaluation.motion.joints[:, 3:5]).T
        assert np.ptp(A4) < 1e-9
        assert A5[1] - A5[0] == pytest.approx(0.041, abs=5e-4)
        slow = deg_per_mm(evaluation.score.mean_rate) < 0.01
        assert slow.tolist() == [False, False, False, True, True, False]
        assert np.array(evaluation.score.reversals_per_joint)[~slow].sum() == 4

    def test_slowest_joints(self, robot, tool, position):
        score = score_of(robot, tool, position.hole, position.profile, position.branch)
        unit = 10.0 ** np.floor(np.log10(position.slowest_deg_per_mm))  # to the digits that theory §5 gives
        assert deg_per_mm(score.min_rate.min()) == pytest.approx(position.slowest_deg_per_mm, abs=unit)

    def test_none_meets_the_threshold_at_every_point(self, robot, tool, position):
        score = score_of(robot, tool, position.hole, position.profile, position.branch)
        assert not meets_threshold(score, Settings(min_rate=AT_0_01_DEG_PER_MM, min_rate_rule="pointwise"))

    def test_on_the_mean_over_a_leg_positions_1_and_3_meet_it(self, robot, tool, positions):
        """Per mm, that is: per step of 200 on its own 60 mm path, position 3 misses the thesis' 0.005 deg."""
        rule = Settings(min_rate=AT_0_01_DEG_PER_MM, min_rate_rule="mean")
        scores = [score_of(robot, tool, p.hole, p.profile, p.branch) for p in positions]
        assert [meets_threshold(score, rule) for score in scores] == [True, False, True]
        per_step = [
            np.rad2deg(s.mean_rate.min()) * 2 * p.depth_mm / 1e3 / 200 for s, p in zip(scores, positions, strict=True)
        ]
        assert [step > 0.005 for step in per_step] == [True, False, False]

    def test_joints_at_the_breakpoints_are_those_of_appendix_b(self, robot, tool, position):
        near = Settings(near_joints=tuple(np.deg2rad(position.axis_deg[0])))
        motion = evaluate(robot, tool, position.hole, position.profile, position.branch, near).motion
        np.testing.assert_allclose(np.rad2deg(motion.joints), position.axis_deg, atol=0.005)


class TestEvents:
    def turning(self, robot, tool, hole, branch):
        """A motion of several segments on which joints turn within both legs."""
        depth = hole.depth
        standoff = np.array([1.0, 0.6, 0.3, 0.0, 0.5, 1.0]) * depth
        psi = np.deg2rad([170, 182, 176, 178, 150, 160])
        return Profile(standoff, psi)

    @pytest.mark.parametrize("branch", [0, 4])
    def test_are_what_a_naive_counter_sees(self, robot, tool, positions, branch):
        hole = positions[1].hole
        profile = self.turning(robot, tool, hole, branch)
        score = score_of(robot, tool, hole, profile, branch)
        distance = sample_distances(profile, 20_000)
        joints = joints_along(Drilling(robot, tool, hole), branch, *profile.at(distance))
        rows = twin.reversals(joints)
        assert score.reversals_per_joint == tuple(map(len, rows))
        assert sum(score.reversals_per_joint) >= 6
        step = np.diff(distance).max()
        for joint in range(6):
            found = [event.standoff for event in score.events if event.joint == joint + 1]
            np.testing.assert_allclose(found, profile.at(distance[rows[joint]])[0], atol=2 * step)

    @pytest.mark.parametrize("branch", [0, 4])
    def test_are_located_to_a_nanometre(self, robot, tool, positions, branch):
        """Against the twin: J^-1 [-d; u Z] has a root there, or the leg bends there."""
        hole = positions[1].hole
        profile = self.turning(robot, tool, hole, branch)
        within = 0
        for event in score_of(robot, tool, hole, profile, branch).events:
            if np.abs(profile.standoff - event.standoff).min() < 1e-12:
                continue
            segments = range(profile.corner) if event.leg == "plunge" else range(profile.corner, 5)
            (k,) = (
                k
                for k in segments
                if min(profile.standoff[k : k + 2]) < event.standoff < max(profile.standoff[k : k + 2])
            )
            a, slope = profile.standoff[k], profile.twist_rate[k]

            def rate(s, joint=event.joint, start=a, psi_start=profile.psi[k], slope=slope):
                T = kinematics.tcp_pose(hole, s, psi_start + slope * (s - start))
                joints = kinematics.inverse(robot, T @ np.linalg.inv(tool.T_flange_tcp))[branch]
                theta_s, theta_psi = twin.rates(robot, tool, hole.direction, joints)
                return (theta_s + slope * theta_psi)[joint - 1]

            root = brentq(rate, event.standoff - 1e-5, event.standoff + 1e-5, xtol=1e-13)
            assert event.standoff == pytest.approx(root, abs=1e-9)
            within += 1
        assert within >= 1

    def test_come_in_order_of_motion(self, robot, tool, positions):
        hole = positions[1].hole
        events = score_of(robot, tool, hole, self.turning(robot, tool, hole, 0), 0).events
        order = {"plunge": 0, "target": 1, "retract": 2}
        keys = [(order[e.leg], -e.standoff if e.leg == "plunge" else e.standoff) for e in events]
        assert keys == sorted(keys)

    @pytest.mark.parametrize("depth", [0.0501, 0.0493, 0.0487])  # so that the dip falls elsewhere between samples
    def test_a_joint_that_turns_round_and_back_within_5_micrometres_is_seen(self, robot, tool, positions, depth):
        """The leg is bent until joint 4's rate dips just below zero, for 5 um of its 50 mm."""
        robot, hole, slope = unlimited(robot), replace(positions[0].hole, depth=depth), np.deg2rad(-1e3)

        def rate(s, psi_t):
            s = np.atleast_1d(s)
            return outward_rates(Drilling(robot, tool, hole), 6, s, psi_t + slope * s, slope)[:, 3]

        side = np.sign(rate(0.01, np.deg2rad(90))[0])

        def bottom(psi_t):
            return minimize_scalar(
                lambda s: side * rate(s, psi_t)[0], bounds=(0.02, 0.035), options={"xatol": 1e-10}, method="bounded"
            )

        curvature = 1.1e4  # of the dip [rad/m^3]
        psi_t = brentq(lambda p: bottom(p).fun + curvature / 2 * 2.5e-6**2, *np.deg2rad([91, 94]), xtol=1e-16)
        profile = Profile.straight(depth, psi_t + slope * depth, psi_t, psi_t + slope * 0.04)
        events = [e for e in score_of(robot, tool, hole, profile, 6).events if e.joint == 4 and e.leg == "plunge"]
        assert len(events) == 2
        assert events[0].standoff - events[1].standoff == pytest.approx(5e-6, rel=0.2)
        assert np.mean([e.standoff for e in events]) == pytest.approx(bottom(psi_t).x, abs=2e-6)

    def test_a_joint_that_does_not_move_does_not_reverse(self, robot, tool):
        hole = Hole("middle", np.array([0.5, 0.0, 0.8]), np.array([1.0, 0.0, 0.0]), 0.04)
        running = [
            score
            for branch in range(8)
            if (score := evaluate(unlimited(robot), tool, hole, Profile.straight(0.04, 0, 0, 0), branch).score)
        ]
        assert len(running) >= 4
        for score in running:
            assert [score.reversals_per_joint[i] for i in (0, 3, 5)] == [0, 0, 0]
            assert score.min_rate[[0, 3, 5]].max() < 1e-10
            assert score.reversals >= 3

    def test_a_motion_that_touches_a_singularity_reverses_nothing_by_it(self, robot):
        """At the target joint 5 is at zero, where rates are NaN; the joints themselves run on smoothly."""
        straight = Tool.from_mm_deg((0, 0, 120), (180, 0, 0))
        T = kinematics.forward(robot, np.deg2rad([0, -80, 100, 0, 0, 0])) @ straight.T_flange_tcp
        hole = Hole("here", T[:3, 3], -T[:3, 2], 0.02, psi_zero=T[:3, 1])
        assert np.isnan(joint_rates(Drilling(robot, straight, hole), 0.0, 0.0)[0][0]).all()
        score = score_of(robot, straight, hole, Profile.straight(0.02, 0, 0, 0), 0)
        assert score.reversals_per_joint == (0, 1, 1, 0, 1, 0)
        assert {round(event.standoff, 9) for event in score.events} == {0.0}
        assert np.isfinite(score.min_rate).all()


class TestScore:
    def test_travel_and_mean_rate_of_a_monotone_motion_depend_on_its_breakpoints_alone(self, robot, tool, position):
        """Theory §2."""
        evaluation = evaluate(robot, tool, position.hole, position.profile, position.branch)
        legs = np.abs(np.diff(evaluation.motion.joints, axis=0))
        assert evaluation.score.travel == pytest.approx(legs.sum(), abs=1e-12)
        np.testing.assert_allclose(evaluation.score.mean_rate, legs.min(axis=0) / position.hole.depth, rtol=1e-9)

    def test_travel_of_a_turning_motion_is_what_dense_samples_add_up_to(self, robot, tool, positions):
        hole = positions[1].hole
        profile = TestEvents().turning(robot, tool, hole, 0)
        joints = joints_along(Drilling(robot, tool, hole), 0, *profile.at(sample_distances(profile, 40_000)))
        dense = np.abs(np.diff(joints, axis=0)).sum()
        assert score_of(robot, tool, hole, profile, 0).travel == pytest.approx(dense, abs=1e-6)

    def test_least_rate_is_that_of_dense_samples(self, robot, tool, position):
        path = joint_path(Drilling(robot, tool, position.hole), position.profile, position.branch, samples=20_000)
        dense = np.abs(np.diff(path.joints, axis=0) / np.diff(path.distance)[:, None]).min(axis=0)
        score = score_of(robot, tool, position.hole, position.profile, position.branch)
        np.testing.assert_allclose(score.min_rate, dense, rtol=2e-3, atol=1e-4)

    def test_limit_distance_is_the_least_over_the_motion(self, robot, tool, position):
        path = joint_path(Drilling(robot, tool, position.hole), position.profile, position.branch)
        score = score_of(robot, tool, position.hole, position.profile, position.branch)
        room = np.minimum(path.joints - robot.limits.lower, robot.limits.upper - path.joints)
        np.testing.assert_array_equal(score.limit_distance, room.min(axis=0))

    def test_threshold_leaves_out_joints_that_reverse(self, robot, tool, positions):
        score = score_of(robot, tool, positions[0].hole, positions[0].profile, 4)
        one_turns = replace(score, reversals_per_joint=(0, 0, 0, 0, 0, 1))
        rule = Settings(min_rate=float(np.sort(score.min_rate)[1]))
        assert score.min_rate.argmin() == 5
        assert not meets_threshold(score, rule)
        assert meets_threshold(one_turns, rule)


class TestFindings:
    def kinds(self, evaluation):
        assert evaluation.score is None
        assert evaluation.motion is None
        assert all(f.level == "error" for f in evaluation.findings)
        return [f.kind for f in evaluation.findings]

    def test_out_of_reach(self, robot, tool):
        hole = Hole("far", np.array([0.9, 0.0, 0.8]), np.array([1.0, 0.0, 0.0]), 0.05)
        evaluation = evaluate(robot, tool, hole, Profile.straight(0.05, 0, 0, 0), 0)
        assert self.kinds(evaluation) == ["unreachable"]
        assert evaluation.findings[0].hole == "far"

    def test_over_a_limit_names_the_joint_and_its_range(self, robot, tool, positions):
        first = positions[0]
        lower = robot.limits.lower.copy()
        lower[3] = np.deg2rad(-20)
        narrow = replace(robot, limits=JointLimits(lower, robot.limits.upper, robot.limits.speed))
        evaluation = evaluate(narrow, tool, first.hole, first.profile, first.branch)
        assert self.kinds(evaluation) == ["limit"]
        assert "A4 runs from -21.63 to 11.30 deg, allowed are -20 to 185 deg" in evaluation.findings[0].message

    def test_through_the_wrist_singularity(self, robot):
        straight = Tool.from_mm_deg((0, 0, 120), (180, 0, 0))
        T = kinematics.forward(robot, np.deg2rad([25, -80, 100, 0, 0, 10])) @ straight.T_flange_tcp
        hole = Hole("through", T[:3, 3] - 0.0151 * T[:3, 2], -T[:3, 2], 0.03, psi_zero=T[:3, 1])
        evaluation = evaluate(robot, straight, hole, Profile.straight(0.03, 0, 0, 0), 0)
        assert "jump" in self.kinds(evaluation)
