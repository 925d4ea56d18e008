"""The check's own figures: against finite differences, against planning's, and against what is planted."""

from dataclasses import replace

import numpy as np
import pytest

from zerorev.model.job import Settings
from zerorev.model.profile import Profile
from zerorev.motion.criteria import compliance as planned_compliance
from zerorev.motion.criteria import manipulability as planned_manipulability
from zerorev.motion.criteria import measure
from zerorev.motion.drilling import Drilling
from zerorev.motion.evaluation import evaluate
from zerorev.motion.kinematics import jacobian
from zerorev.verify.arm import posture_of
from zerorev.verify.digits import moved_figures
from zerorev.verify.figures import figures, nearer_turn
from zerorev.verify.lever import compliance, line_rates, manipulability
from zerorev.verify.path import Path, follow
from zerorev.verify.turning import Course, turning


def bent(profile, rng, inner=2):
    """The same stroke with random spins at breakpoints within both legs."""
    depth = float(profile.standoff[0])
    shares = np.sort(rng.uniform(0.1, 0.9, (2, inner)), axis=1)
    standoff = np.concatenate([[depth], depth * shares[0, ::-1], [0.0], depth * shares[1], [depth]])
    return Profile(standoff, rng.uniform(-0.2, 0.2, standoff.size))


@pytest.mark.parametrize("seed", range(3))
def test_rates_are_those_of_the_motion(robot, drill, random_hole, seed):
    """Central differences of the inverse kinematics, lateral offsets and negative signs among them."""
    hole, profile, start = random_hole(robot, drill, seed)
    s, psi = np.linspace(profile.standoff[0], 0, 9), np.linspace(0.0, 0.1, 9)
    posture = posture_of(robot.arm, start)

    def joints(s, psi):
        return follow(robot, drill, hole, Path(s, psi, (), 0), posture, start)

    for by, step in (((1.0, 0.0), 1e-6), ((0.0, 1.0), 1e-5), ((1.0, -7.0), 1e-6)):
        there, back = (joints(s + sign * step * by[0], psi + sign * step * by[1]) for sign in (1, -1))
        found = line_rates(robot, drill, hole, joints(s, psi), *by)
        np.testing.assert_allclose(found, (there - back) / (2 * step), rtol=1e-6, atol=1e-6 * np.abs(found).max())


def test_compliance_and_manipulability(robot, drill, random_hole):
    hole, _, start = random_hole(robot, drill, 1)
    rng = np.random.default_rng(0)
    joints = start + rng.uniform(-1, 1, (50, 6))
    stiffness = tuple(rng.uniform(1e4, 1e5, 6).tolist())
    own = compliance(robot, drill, joints, stiffness, hole.direction)
    planned = planned_compliance(jacobian(robot, drill, joints), stiffness, hole.direction)
    np.testing.assert_allclose(own, np.array(planned), rtol=1e-10)
    own = manipulability(robot, drill, joints)
    np.testing.assert_allclose(own, planned_manipulability(robot, joints), rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize("seed", range(6))
def test_they_are_those_of_planning(robot, drill, random_hole, build, seed):
    """Two ways to every figure: reversals within legs, at breakpoints and at the target among them."""
    rng = np.random.default_rng(seed)
    settings = Settings(joint_stiffness=(1e5, 2e5, 1e5, 5e4, 3e4, 2e4), feed_plunge=7e-3)
    hole, profile, start = random_hole(robot, drill, seed)
    profile = bent(profile, rng)
    plan = build(robot, drill, hole, profile, start, samples=500)
    evaluation = evaluate(robot, drill, hole, profile, plan.motion.branch, settings)
    if evaluation.score is None:
        pytest.skip("the motion cannot be run")
    own = figures(robot, drill, settings, replace(plan, motion=evaluation.motion))
    score, planned = own.answer.score, evaluation.score
    assert score.reversals_per_joint == planned.reversals_per_joint
    assert [(e.joint, e.leg) for e in score.events] == [(e.joint, e.leg) for e in planned.events]
    places = [[e.standoff for e in each.events] for each in (score, planned)]
    np.testing.assert_allclose(*places, rtol=0, atol=1e-11)
    assert score.travel == pytest.approx(planned.travel, rel=1e-11)
    np.testing.assert_allclose(score.min_rate, planned.min_rate, rtol=2e-6, atol=1e-9)
    for name in ("mean_rate", "limit_distance"):
        np.testing.assert_allclose(getattr(score, name), getattr(planned, name), rtol=1e-9, atol=1e-9)
    for name, value in vars(measure(Drilling(robot, drill, hole), evaluation, settings)).items():
        assert getattr(own.answer.measures, name) == pytest.approx(value, rel=2e-6, abs=1e-9, nan_ok=True), name


def test_joints_that_turn_round_within_a_leg(kuka, drill, published):
    """On legs of one slope after the other a joint turns round, or round and back, where its rate comes to rest."""
    plan, found = published(1), 0
    for slope in np.linspace(-12, 12, 97):
        profile = Profile.straight(0.05, slope * 0.05, 0.0, slope * 0.05)
        evaluation = evaluate(kuka, drill, plan.hole, profile, plan.motion.branch)
        if evaluation.score is None:
            continue
        own = turning(Course(kuka, drill, plan.hole, profile, evaluation.motion.joints[0]))
        assert [(e.joint, e.leg) for e in own.events] == [(e.joint, e.leg) for e in evaluation.score.events]
        found += sum(event.leg != "target" for event in own.events)
    assert found > 20


def test_where_a_joint_turns_within_a_leg_it_is_at_rest(kuka, drill, published):
    plan = published(1)
    profile = Profile.straight(0.05, *np.deg2rad([14.0, 10.0, 6.0]))
    evaluation = evaluate(kuka, drill, plan.hole, profile, plan.motion.branch)
    within = {event.joint - 1 for event in evaluation.score.events if event.leg != "target"}
    own = turning(Course(kuka, drill, plan.hole, profile, evaluation.motion.joints[0]))
    assert within
    for joint in range(6):
        assert (evaluation.score.min_rate[joint] == 0) == (joint in within)
        assert (own.slowest[joint] == 0) == (joint in within)


def test_what_cannot_be_followed_has_no_figures(kuka, drill, settings, published):
    plan = published(1)
    assert figures(kuka, drill, settings, replace(plan, motion=None)) is None
    far = replace(plan, hole=replace(plan.hole, target=plan.hole.target + 5.0))
    assert figures(kuka, drill, settings, far) is None


def test_turns_are_those_that_the_settings_ask_for(kuka, drill, settings, published):
    plan = published(1)
    own = figures(kuka, drill, settings, plan)
    # the thesis' own turns of joint 6 are not the ones farthest from the limits
    joint, angle = nearer_turn(kuka, settings, plan.motion, own.joints)
    assert (joint, round(np.rad2deg(angle), 4)) == (5, round(217.3562 - 360, 4))
    near = replace(settings, near_joints=tuple(plan.motion.joints[0].tolist()))
    assert nearer_turn(kuka, near, plan.motion, own.joints) is None


def test_the_digits_of_a_file_move_figures_by_little(kuka, drill, settings, published):
    plan = published(1)
    own = figures(kuka, drill, settings, plan).answer
    moved = list(moved_figures(kuka, drill, settings, plan))
    assert len(moved) == 10
    travels = np.array([each.score.travel for each in moved])
    assert 0 < np.abs(travels - own.score.travel).max() < 1e-10
    assert {each.score.reversals for each in moved} == {0}
