"""plan() and plan_job(): from a hole to a checked motion, a baseline, and what a user should know."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from zerorev.model.hole import Hole
from zerorev.model.job import Job, Settings
from zerorev.model.robot import JointLimits
from zerorev.model.tool import Tool
from zerorev.motion.kinematics import forward
from zerorev.planning.hole import plan, plan_deepest
from zerorev.planning.job import plan_job
from zerorev.search.deepest import deepest_stroke

X = np.array([1.0, 0.0, 0.0])


def kinds(findings):
    """What is said, but of the loads on the gears and the turn of the tool, which is said of most motions."""
    return [finding.kind for finding in findings if finding.kind not in ("lost_motion", "tcp_calibration", "tool_turn")]


@pytest.fixture(scope="module")
def planned(robot, tool, positions):
    """Position 1, planned with the defaults."""
    return plan(robot, tool, positions[0].hole)


class TestPlannedHole:
    def test_has_a_motion_without_reversal_that_was_checked(self, planned):
        assert planned.status == "planned"
        assert planned.score.reversals == 0
        assert planned.verified.passed
        assert kinds(planned.findings) == []

    def test_says_how_long_the_lever_is(self, planned):
        assert planned.wrist_offset == pytest.approx(0.155)

    def test_has_the_same_hole_with_held_spin_as_its_baseline(self, planned):
        assert planned.baseline.reversals_per_joint == (1,) * 6
        assert 40 < np.rad2deg(planned.baseline.travel) < 70

    def test_runs_from_the_depth_to_the_target_and_back(self, planned):
        np.testing.assert_allclose(planned.motion.profile.standoff, [0.05, 0.0, 0.05])


class TestGivenProfile:
    def test_is_evaluated_as_theory_7_has_it(self, robot, tool, position):
        hole = replace(position.hole, profile=position.profile)
        answer = plan(robot, tool, hole)
        assert answer.status == "evaluated"
        assert answer.motion.branch == position.branch
        assert answer.score.reversals == 0
        assert np.rad2deg(answer.score.travel) == pytest.approx(position.travel_deg, abs=0.05)
        assert answer.baseline.reversals_per_joint == position.baseline
        assert np.rad2deg(answer.baseline.travel) == pytest.approx(position.baseline_travel_deg, abs=0.05)
        assert answer.verified.passed
        assert kinds(answer.findings) == ["threshold"]  # no published plan keeps it at every point (theory §5)

    def test_stays_on_the_branch_that_it_names(self, robot, tool, positions):
        """The other wrist flip takes A4 over its limit; no better branch is taken instead."""
        hole = replace(positions[0].hole, profile=positions[0].profile, branch=5)
        answer = plan(robot, tool, hole)
        assert answer.status == "infeasible"
        assert kinds(answer.findings) == ["limit"]
        assert answer.findings[0].message.startswith("A4 runs from 158.37 to 191.30 deg")

    def test_that_reverses_says_which_joint_and_where(self, robot, tool, positions):
        hole = replace(positions[0].hole, profile=positions[0].held_spin, branch=4)
        answer = plan(robot, tool, hole)
        assert kinds(answer.findings) == ["reversal"] * 6
        assert answer.findings[0].message == "A1 reverses at the target"
        assert {finding.level for finding in answer.findings} == {"warning"}

    def test_out_of_reach_says_where(self, robot, tool, positions):
        first = positions[0]
        hole = replace(first.hole, target=first.hole.target + 0.6 * X, profile=first.profile)
        answer = plan(robot, tool, hole)
        assert answer.status == "infeasible"
        assert kinds(answer.findings) == ["unreachable"]


class TestThreshold:
    def test_where_it_cannot_be_met_a_finding_says_what_can(self, robot, tool, positions):
        """Position 3, 36 mm deep: 36.4 mm is the deepest without a reversal (theory §7), and little margin is left."""
        answer = plan(robot, tool, replace(positions[2].hole, depth=0.036))
        assert answer.score.reversals == 0
        assert 0 < answer.score.min_rate.min() < Settings().min_rate
        assert kinds(answer.findings) == ["threshold", "near_limit"]
        message = answer.findings[0].message
        assert f"{np.rad2deg(answer.score.min_rate.min()) / 1e3:.5f} deg/mm" in message
        assert "threshold of 0.01 deg/mm" in message
        assert message.endswith("no motion with so few reversals was found that keeps more")
        assert answer.verified.passed

    def test_switched_off_there_is_no_such_finding(self, robot, tool, positions):
        answer = plan(robot, tool, replace(positions[2].hole, depth=0.036), Settings(min_rate=0.0))
        assert kinds(answer.findings) == []


class TestDeeperCorner:
    def test_the_blend_then_just_meets_the_true_depth(self, robot, tool, positions):
        """A parabolic blend of radius r turns back r/2 short of its corner (theory §5)."""
        settings = Settings(blend=4e-3, deepen_corner=True)
        answer = plan(robot, tool, positions[0].hole, settings)
        np.testing.assert_allclose(answer.motion.profile.standoff, [0.05, -2e-3, 0.05])
        assert answer.score.reversals == 0
        assert answer.verified.passed
        assert answer.hole.depth == 0.05
        tip = (forward(robot, answer.motion.joints) @ tool.T_flange_tcp)[:, :3, 3]
        np.testing.assert_allclose(tip[1], positions[0].hole.target + 2e-3 * X, atol=1e-9)

    def test_a_shortfall_measured_on_the_controller_takes_the_place_of_half_the_radius(self, robot, tool, positions):
        settings = Settings(blend=4e-3, blend_shortfall=1.1e-3, deepen_corner=True)
        answer = plan(robot, tool, positions[0].hole, settings)
        assert answer.motion.profile.standoff[1] == pytest.approx(-1.1e-3)


class TestDeepest:
    """What becomes of the deepest stroke; that it is the deepest is for the tests of `deepest_stroke`."""

    def test_a_plan_says_how_deep_it_could_go(self, planned, robot, tool, positions):
        assert planned.deepest == pytest.approx(deepest_stroke(robot, tool, positions[0].hole).depth)
        assert planned.deepest > planned.hole.depth

    def test_the_deepest_motion_is_planned_and_checked(self, robot, tool, positions):
        hole = replace(positions[1].hole, profile=positions[1].profile, branch=1)
        answer = plan_deepest(robot, tool, hole, Settings(min_rate=0.0))
        assert answer.status == "planned"
        assert answer.hole.depth == answer.deepest == answer.motion.profile.standoff[0]
        assert 25e-3 < answer.deepest < 30e-3  # theory §7
        assert answer.score.reversals == 0
        assert answer.verified.passed
        assert kinds(answer.findings) == ["near_limit"]
        assert answer.hole.profile is None

    def test_from_a_deeper_corner_the_depth_counts_from_the_target(self, robot, tool, positions):
        settings = Settings(blend=4e-3, deepen_corner=True)
        hole = replace(positions[0].hole, branch=4)
        answer = plan_deepest(robot, tool, hole, settings)
        below = replace(hole, target=hole.target + 2e-3 * X)
        assert answer.deepest == pytest.approx(deepest_stroke(robot, tool, below, settings).depth - 2e-3)
        np.testing.assert_allclose(answer.motion.profile.standoff, [answer.deepest, -2e-3, answer.deepest])
        assert answer.score.reversals == 0
        assert answer.verified.passed

    def test_without_a_lever_there_is_none(self, robot, positions):
        straight = Tool.from_mm_deg((0, 0, 120), (180, 0, 0))
        answer = plan_deepest(robot, straight, positions[0].hole)
        assert answer.status == "infeasible"
        assert answer.deepest == 0.0
        assert answer.motion is None
        assert [(f.level, f.kind, f.hole) for f in answer.findings] == [("error", "no_stroke", "position 1")]
        assert "0.01 deg/mm" in answer.findings[0].message

    def test_out_of_reach_says_so(self, robot, tool):
        answer = plan_deepest(robot, tool, Hole("far", np.array([1.5, 0.0, 0.8]), X, 0.02))
        assert answer.deepest == 0.0
        assert kinds(answer.findings) == ["unreachable"]


class TestTurns:
    def test_near_joints_chooses_among_the_turns_that_fit(self, robot, tool, positions):
        far = plan(robot, tool, positions[0].hole)
        asked = far.motion.joints[0].copy()
        asked[5] += 2 * np.pi if asked[5] < 0 else -2 * np.pi
        near = plan(robot, tool, positions[0].hole, Settings(near_joints=tuple(asked)))
        np.testing.assert_allclose(near.motion.joints[0], asked, atol=1e-6)
        assert near.verified.passed


class TestInfeasible:
    def test_out_of_reach(self, robot, tool):
        answer = plan(robot, tool, Hole("far", np.array([1.5, 0.0, 0.8]), X, 0.02))
        assert answer.status == "infeasible"
        assert answer.motion is None
        assert [(f.level, f.kind, f.hole) for f in answer.findings] == [("error", "unreachable", "far")]
        assert "1500.0, 0.0, 800.0" in answer.findings[0].message

    def test_within_reach_but_over_the_limits(self, robot, tool, positions):
        lower, upper = robot.limits.lower.copy(), robot.limits.upper.copy()
        lower[1], upper[1] = np.deg2rad([20, 45])
        narrow = replace(robot, limits=JointLimits(lower, upper, robot.limits.speed))
        answer = plan(narrow, tool, positions[0].hole)
        assert answer.status == "infeasible"
        assert kinds(answer.findings) == ["limit"]


@pytest.fixture(scope="module")
def three_holes(robot, tool, positions):
    """The plan of a job whose second hole is out of reach, and the progress that was reported."""
    far = Hole("far", np.array([1.5, 0.0, 0.8]), X, 0.02)
    holes = (positions[0].hole, far, replace(positions[1].hole, profile=positions[1].profile))
    reported = []
    return plan_job(Job(robot, tool, holes, name="three"), lambda done, total: reported.append((done, total))), reported


class TestJob:
    def test_one_unreachable_hole_leaves_the_others_planned(self, three_holes):
        plan, _ = three_holes
        assert [hole.status for hole in plan.holes] == ["planned", "infeasible", "evaluated"]
        assert [f.hole for f in plan.all_findings if f.level == "error"] == ["far"]

    def test_progress_is_reported_before_the_first_hole_and_after_each(self, three_holes):
        assert three_holes[1] == [(0, 3), (1, 3), (2, 3), (3, 3)]

    def test_holes_come_in_the_order_of_the_job(self, three_holes, positions):
        assert [hole.hole.id for hole in three_holes[0].holes] == ["position 1", "far", "position 2"]
        assert three_holes[0].name == "three"

    @pytest.mark.parametrize(("offset_mm", "says"), [(0.0, "cannot"), (5.0, "5.00 mm"), (50.0, None)])
    def test_a_short_lever_is_a_finding_of_the_plan(self, robot, positions, offset_mm, says):
        tool = Tool.from_mm_deg((offset_mm, 0, 120), (180, 0, 0))
        hole = replace(positions[0].hole, profile=positions[0].profile)
        findings = plan_job(Job(robot, tool, (hole,))).findings
        if says is None:
            assert kinds(findings) == []
        else:
            assert kinds(findings) == ["wrist_offset"]
            assert says in findings[0].message
            assert findings[0].hole is None
