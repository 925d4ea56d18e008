"""What is shown of a motion is what `evaluate` says of it, and where it fails is where the arm fails."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from oracles.published import POSITIONS
from zerorev.model.job import Settings
from zerorev.model.profile import Profile
from zerorev.motion.drilling import Drilling, joint_rates
from zerorev.motion.evaluation import evaluate, steady_rates
from zerorev.motion.kinematics import inverse, tcp_pose
from zerorev.report.scene.motion_look import curves, held, look, signed_distance

HOLE, BRANCH = POSITIONS[0].hole, POSITIONS[0].branch
REVERSING = Profile.straight(0.05, *np.deg2rad([14.16, -5.94, -14.0]))
FREE = Profile(np.array([50, 20, 0, 30, 50]) * 1e-3, np.deg2rad([20, 5, 30, -10, -4]))
TURNS_WITHIN = Profile.straight(0.05, *np.deg2rad([14.16, 60.0, -30.0]))
FAR = Profile.straight(0.05, *np.deg2rad([20.0, 160.0, -20.0]))
OVER = Profile.straight(0.05, *np.deg2rad([-70.0, -5.0, -70.0]))


@pytest.mark.parametrize("position", POSITIONS, ids=lambda position: position.name)
def test_numbers_are_those_of_the_evaluation(robot, tool, position):
    settings = Settings()
    seen = look(Drilling(robot, tool, position.hole), position.profile, position.branch, settings)
    score = evaluate(robot, tool, position.hole, position.profile, position.branch, settings).score
    assert seen.runs
    assert seen.faults == ()
    assert (seen.reversals, seen.score.travel) == (score.reversals, score.travel)
    assert seen.margin == steady_rates(score, settings).min()
    assert (seen.score.limit_distance == score.limit_distance).all()


@pytest.mark.parametrize("profile", [REVERSING, FREE, TURNS_WITHIN], ids=["target", "free", "within"])
def test_a_reversal_is_marked_on_the_leg_where_its_joint_turns(robot, tool, profile):
    seen = look(Drilling(robot, tool, HOLE), profile, BRANCH, Settings(min_rate=0.0))
    assert seen.reversals == len(seen.marks) > 0
    assert [mark.distance for mark in seen.marks] == sorted(mark.distance for mark in seen.marks)
    knots = signed_distance(profile, profile.distance)
    for mark in seen.marks:
        assert mark.name == robot.joint_names[mark.joint - 1]
        assert mark.psi == pytest.approx(np.interp(mark.distance, knots, profile.psi))
        standoff = abs(mark.distance)

        def rate(at, mark=mark):
            """Of the joint along the motion, by two poses close together."""
            step = 1e-7
            s, p = profile.at(profile.distance[profile.corner] + np.array([at - step, at + step]))
            poses = tcp_pose(HOLE, s, p) @ np.linalg.inv(tool.T_flange_tcp)
            before, after = inverse(robot, poses)[:, BRANCH, mark.joint - 1]
            return (after - before) / (2 * step)

        assert rate(mark.distance - 2e-6) * rate(mark.distance + 2e-6) < 0, (mark, standoff)


def test_a_motion_out_of_reach_says_where(robot, tool):
    seen = look(Drilling(robot, tool, HOLE), FAR, BRANCH, Settings())
    assert not seen.runs
    assert seen.reversals is None
    assert seen.marks == ()
    (fault,) = seen.faults
    assert fault.kind == "unreachable"
    assert -0.05 < fault.start < 0 < fault.end < 0.05
    for edge, inwards in ((fault.start, 1), (fault.end, -1)):
        s, p = FAR.at(FAR.distance[1] + edge + inwards * np.array([-2e-4, 2e-4]))
        reached = ~np.isnan(joint_rates(Drilling(robot, tool, HOLE), s, p)[0][:, BRANCH, 0])
        assert reached.tolist() == [True, False]
    standoff, psi = FAR.at(np.array([FAR.distance[1] + fault.start]))
    for part in ("out of reach on the plunge", f"{standoff[0] * 1e3:.1f} mm", f"{np.rad2deg(psi[0]):.1f} deg"):
        assert part in seen.why


def test_a_motion_over_a_limit_names_joint_and_stretches(robot, tool):
    seen = look(Drilling(robot, tool, HOLE), OVER, BRANCH, Settings())
    assert not seen.runs
    assert {(fault.kind, fault.joint) for fault in seen.faults} == {("limit", 5)}
    plunge, retract = seen.faults  # at either end of this symmetric motion
    assert (plunge.start, retract.end) == (-0.05, 0.05)
    assert plunge.end == pytest.approx(-retract.start)
    assert "A5 runs from" in seen.why
    assert "120" in seen.why
    joints = curves(Drilling(robot, tool, HOLE), OVER, BRANCH, Settings(), samples=1000)
    beyond = (joints.joints[:, 4] > robot.limits.upper[4]) | (joints.joints[:, 4] < robot.limits.lower[4])
    inside = (joints.distance > plunge.end + 2e-4) & (joints.distance < retract.start - 2e-4)
    assert not beyond[inside].any()
    assert beyond[(joints.distance <= plunge.end) | (joints.distance >= retract.start)].all()


def test_a_jump_says_which_joint(robot, tool):
    """On position 2's other branches the wrist is singular near psi = 90 deg: somewhere there a joint jumps."""
    seen = [
        look(Drilling(robot, tool, HOLE), Profile.straight(0.05, psi, psi + 0.2, psi), branch, Settings())
        for psi in np.deg2rad(np.arange(-180, 180, 10.0))
        for branch in range(8)
    ]
    jumps = [each for each in seen if any(fault.kind == "jump" for fault in each.faults)]
    for each in jumps:
        assert "jumps by" in each.why
        assert all(fault.end - fault.start < 2e-4 for fault in each.faults)


def test_too_slow_a_joint_is_reported_by_its_name(robot, tool):
    slow = look(Drilling(robot, tool, HOLE), POSITIONS[0].profile, BRANCH, Settings())
    assert slow.runs
    assert not slow.meets_threshold
    score = evaluate(robot, tool, HOLE, POSITIONS[0].profile, BRANCH).score
    for i, name in enumerate(robot.joint_names):
        assert (name in slow.why) == (score.min_rate[i] < Settings().min_rate)
    assert look(Drilling(robot, tool, HOLE), POSITIONS[0].profile, BRANCH, Settings(min_rate=0.0)).why == ""


@pytest.mark.parametrize("profile", [REVERSING, FREE], ids=["straight", "free"])
def test_curves_run_through_the_joints_of_the_motion(robot, tool, profile):
    settings = Settings(near_joints=(0.0,) * 6)
    found = curves(Drilling(robot, tool, HOLE), profile, BRANCH, settings, samples=100)
    motion = evaluate(robot, tool, HOLE, profile, BRANCH, settings).motion
    knots = signed_distance(profile, profile.distance)
    assert found.distance[[0, -1]] == pytest.approx(knots[[0, -1]])
    rows = [int(np.abs(found.distance - knot).argmin()) for knot in knots]
    assert found.joints[rows] == pytest.approx(motion.joints, abs=1e-9)
    still = evaluate(robot, tool, HOLE, held(profile), BRANCH, settings).motion
    assert found.baseline[rows] == pytest.approx(still.joints, abs=1e-9)
    assert found.limits is robot.limits


def test_curves_of_what_cannot_be_run_have_gaps(robot, tool):
    found = curves(Drilling(robot, tool, HOLE), FAR, BRANCH, Settings())
    assert np.isnan(found.joints).any()
    assert not np.isnan(found.joints[0]).any()
    far = replace(FAR, psi=FAR.psi[[1, 0, 1]])
    assert curves(Drilling(robot, tool, HOLE), far, BRANCH, Settings()).baseline is None
