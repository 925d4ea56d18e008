"""Planted faults: each must be caught, and named by joint, place and figure; none may raise."""

from dataclasses import replace

import numpy as np
import pytest

from zerorev.model.job import Settings
from zerorev.model.plan import Event
from zerorev.model.profile import Profile
from zerorev.verify import verify_hole
from zerorev.verify.arm import Posture, posture_of
from zerorev.verify.path import follow, legs


@pytest.fixture
def check(kuka, drill, settings):
    def run(plan, *, robot=kuka, **changes):
        verdict = verify_hole(robot, drill, replace(settings, **changes), plan)
        assert verdict.passed == (not verdict.failures)
        return verdict

    return run


@pytest.fixture
def plan(published):
    return published(1)


def score(plan, **changes):
    return replace(plan, score=replace(plan.score, **changes))


def motion(plan, **changes):
    return replace(plan, motion=replace(plan.motion, **changes))


def said(verdict, *words):
    """Exactly these words stand together in one of the sentences."""
    assert not verdict.passed
    assert any(all(word in failure for word in words) for failure in verdict.failures), verdict.failures


def test_reversals_that_are_not_there(check, plan):
    said(check(score(plan, reversals_per_joint=(0, 0, 1, 0, 0, 0))), "A3 reverses 0 times", "claims 1")


def test_reversals_that_are_kept_quiet(check, published):
    hidden = score(published(1, (14.1646,) * 3), reversals_per_joint=(0,) * 6, events=())
    verdict = check(hidden)
    for joint in range(1, 7):
        said(verdict, f"A{joint} reverses once (at the corner, stand-off 0 mm)", "claims 0")


def test_events_that_do_not_add_up(check, plan):
    said(check(score(plan, events=(Event(4, "plunge", 0.01),))), "A4 has 1 reversals listed")


def test_a_kink_between_the_samples_of_a_coarse_grid(kuka, drill, settings, build, plan):
    """A twitch of the spin within 0.01 mm: 50 samples a leg step over it, unless breakpoints are samples."""
    s, psi = plan.motion.profile.standoff, plan.motion.profile.psi
    at = 0.0213
    slope = (psi[0] - psi[1]) / s[0]
    middle = psi[1] + slope * at
    standoff = np.array([s[0], at + 1e-5, at, at - 1e-5, 0, s[2]])
    twitch = np.array([psi[0], middle + slope * 1e-5, middle + 1e-3, middle - slope * 1e-5, psi[1], psi[2]])
    kinked = build(kuka, drill, plan.hole, Profile(standoff, twitch), plan.motion.joints[0])
    assert kinked.score.reversals >= 6
    quiet = score(kinked, reversals_per_joint=(0,) * 6, events=(), travel=plan.score.travel)
    verdict = verify_hole(kuka, drill, settings, quiet, samples=100)
    said(verdict, "A6 reverses", "on the plunge, stand-off 21.3 mm")


def test_a_limit_passed(check, kuka, plan):
    upper = kuka.limits.upper.copy()
    upper[4] = np.deg2rad(110.0)  # A5 ends at 110.9973 deg
    tight = replace(kuka, limits=replace(kuka.limits, upper=upper))
    verdict = check(plan, robot=tight)
    said(verdict, "A5 at 110.9973 deg is 0.997 deg beyond its limits", "on the retract, stand-off 50 mm")
    said(verdict, "A5 comes within", "claims")
    assert verdict.min_limit_distance == pytest.approx(np.deg2rad(-0.9973), abs=1e-5)


def test_a_wrong_turn(check, plan):
    turn = 2 * np.pi * np.eye(6)[5]
    verdict = check(motion(plan, joints=plan.motion.joints + turn))
    said(verdict, "A6", "beyond its limits")
    broken = plan.motion.joints.copy()
    broken[2] -= turn
    said(check(motion(plan, joints=broken)), "A6 at breakpoint 3", "360 deg off the path")


def test_a_wrong_branch(check, kuka, drill, plan):
    said(check(motion(plan, branch=5)), "of branch 4, the plan says 5")
    # the other flip of the wrist reaches every pose too; only the number of the branch tells
    path, start = legs(plan.motion.profile, 3), plan.motion.joints[0]
    posture = posture_of(kuka.arm, start)
    flipped = follow(kuka, drill, plan.hole, path, Posture(*posture[:2], -posture.flip), start)
    said(check(motion(plan, joints=flipped[list(path.knots)])), "of branch 5, the plan says 4")


def test_a_branch_that_was_not_asked_for(check, plan):
    said(check(replace(plan, hole=replace(plan.hole, branch=0))), "branch 0 is asked for, the plan says 4")


@pytest.mark.parametrize("joint", range(6))
@pytest.mark.parametrize("breakpoint", [0, 1, 2])
def test_joints_off_by_a_hundredth_of_a_degree(check, plan, joint, breakpoint):
    joints = plan.motion.joints.copy()
    joints[breakpoint, joint] += np.deg2rad(0.01)
    verdict = check(motion(plan, joints=joints))
    said(verdict, f"A{joint + 1} at breakpoint {breakpoint + 1}", "0.01 deg off the path")
    assert len(verdict.failures) == 1


def test_an_altered_zero_of_the_spin(check, plan):
    turned = np.array([0, np.cos(0.01), np.sin(0.01)])
    said(check(replace(plan, hole=replace(plan.hole, psi_zero=turned))), "at breakpoint 1", "off the path")


def test_a_target_moved_by_a_hundredth_of_a_millimetre(check, plan):
    moved = replace(plan, hole=replace(plan.hole, target=plan.hole.target + np.array([0, 0, 1e-5])))
    said(check(moved), "off the path")


def test_an_unreachable_stretch(check, kuka, plan):
    """A shorter forearm cannot follow the deep part of the stroke; nothing is raised, and every figure is filled in."""
    short = replace(kuka, arm=kuka.arm._replace(c3=0.2))
    verdict = check(plan, robot=short)
    said(verdict, "out of reach or singular at", "samples, first")
    nowhere = replace(plan, hole=replace(plan.hole, target=plan.hole.target * 9))
    said(check(nowhere), "out of reach or singular at 40001 samples")
    said(check(nowhere), "in the blended corner, out of reach")


def test_a_jump_of_the_wrist(check, kuka, drill, build, random_hole, settings):
    """Straight through the wrist singularity: A5 bounces off zero and A4 springs half a turn."""
    hole, profile, start = random_hole(kuka, drill, 0, joints_deg=(0, -100, 100, 0, 1e-3, 0))
    verdict = check(build(kuka, drill, hole, profile, start))
    said(verdict, "A4 jumps by")


@pytest.mark.parametrize("factor", [1 - 1e-5, 1 + 1e-5, 0.5])
def test_travel_misstated(check, plan, factor):
    said(check(score(plan, travel=plan.score.travel * factor)), "the joints travel 107.118")


@pytest.mark.parametrize("joint", range(6))
def test_a_slowest_motion_overstated(check, plan, joint):
    more = plan.score.min_rate.copy()
    more[joint] *= 1.2
    said(check(score(plan, min_rate=more)), f"A{joint + 1} has a least rate of", "deg/mm", "stand-off")
    more = plan.score.mean_rate.copy()
    more[joint] *= 1.2
    said(check(score(plan, mean_rate=more)), f"A{joint + 1} has a mean rate of", "on a leg")


def test_a_distance_to_the_limits_overstated(check, plan):
    room = plan.score.limit_distance + np.deg2rad([0, 0, 0, 0, 0, 0.001])
    said(check(score(plan, limit_distance=room)), "A6 comes within", "of a limit", "stand-off")


def test_understating_is_not_a_fault(check, plan):
    modest = score(plan, min_rate=plan.score.min_rate * 0.5, limit_distance=plan.score.limit_distance - 0.1)
    assert check(modest).passed


@pytest.mark.parametrize("bad", [np.nan, np.inf])
@pytest.mark.parametrize("name", ["travel", "min_rate", "mean_rate", "limit_distance", "joints"])
def test_nan_anywhere(check, plan, name, bad):
    if name == "joints":
        joints = plan.motion.joints.copy()
        joints[1, 3] = bad
        said(check(motion(plan, joints=joints)), "the joints at the breakpoints have NaN or infinite")
    else:
        value = getattr(plan.score, name) * np.where(np.arange(6) == 2, bad, 1.0)
        value = bad if name == "travel" else value
        said(check(score(plan, **{name: value})), f"the score's {name} is NaN or infinite")


def test_nothing_to_check(check, plan):
    said(check(replace(plan, motion=None)), "no motion")
    said(check(replace(plan, score=None)), "no score")
    said(check(motion(plan, joints=plan.motion.joints[:2])), "have shape (2, 6), not (3, 6)")
    said(check(score(plan, min_rate=plan.score.min_rate[:5])), "min_rate has shape (5,)")
    said(check(score(plan, reversals_per_joint=(0, 0))), "reversals_per_joint has shape (2,)")


def test_a_stroke_that_is_not_the_holes(check, plan):
    deeper = replace(plan, hole=replace(plan.hole, depth=0.06))
    verdict = check(deeper)
    said(verdict, "starts at 50 mm of stand-off, not at the depth of 60 mm")
    said(verdict, "ends at 50 mm")


def test_a_corner_short_of_the_target(check, kuka, drill, build, plan):
    psi = plan.motion.profile.psi
    short = build(kuka, drill, plan.hole, Profile([0.05, 0.002, 0.05], psi), plan.motion.joints[0])
    said(check(short), "the corner lies 2 mm short of the target")


def test_a_spin_past_its_bound(check, plan):
    assert check(plan, psi_bound=np.deg2rad(31)).passed
    said(check(plan, psi_bound=np.deg2rad(30)), "a spin of 30.4599 deg passes the bound of 30 deg")


def test_a_wrong_lever(check, plan):
    said(check(replace(plan, wrist_offset=0.1)), "the wrist centre is 155 mm off the drill axis, the plan says 100 mm")


def test_a_blend_that_makes_a_joint_reverse(check, kuka, drill, build, random_hole):
    """3.6 deg from the wrist's singularity a wide blend turns A1 round twice, which neither leg does."""
    joints = (0, -114.41, 47.94, 62.05, 3.55, 0)
    hole, _, start = random_hole(kuka, drill, 0, joints_deg=joints, depth=0.03)
    # the joints stand at the target, the hole lies behind them
    hole = replace(hole, target=hole.target - hole.depth * hole.direction)
    profile = Profile.straight(0.03, *np.deg2rad([-32.94, 0.0, 21.13]))
    plan = build(kuka, drill, hole, profile, start)
    assert plan.score.reversals_per_joint[0] == 0
    said(check(plan, blend=0.01), "in the blended corner, A1 reverses: 2 times in all", "0 without")
    assert check(plan, blend=0.0).reversals_per_joint == check(plan, blend=0.01).reversals_per_joint
    assert not any("blended A1" in failure for failure in check(plan, blend=0.0).failures)


def test_the_blends_at_other_breakpoints_are_examined_too(check, kuka, drill, build, plan):
    cut = Profile(*plan.motion.profile.at(np.array([0.0, 0.02, 0.05, 0.08, 0.1])))
    five = build(kuka, drill, plan.hole, cut, plan.motion.joints[0])
    assert check(five, blend=0.01).passed
    assert [check(five, blend=blend).blend_samples for blend in (0.01, 0.0)] == [6_000, 2_000]
    upper = kuka.limits.upper.copy()
    upper[4] = five.motion.joints[3, 4] - 1e-3  # A5 rises all along
    failures = verify_hole(replace(kuka, limits=replace(kuka.limits, upper=upper)), drill, Settings(), five).failures
    assert any(failure.startswith("in the blend at breakpoint 4, A5") for failure in failures), failures
