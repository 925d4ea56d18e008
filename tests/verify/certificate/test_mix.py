"""Blends with any curve: what is certified holds for every mix, what is refuted is wrong for the mix that is named."""

from __future__ import annotations

from functools import cache
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import pytest
from flint import arb
from scipy.spatial.transform import Rotation

from oracles.mixes import any_curve, joints_on, one_way_curve, outermost, places, velocities
from oracles.search import random_hole
from zerorev.files.io import read_robot, read_tool
from zerorev.model.hole import Hole
from zerorev.model.plan import HolePlan
from zerorev.model.profile import Profile
from zerorev.model.robot import Robot
from zerorev.model.settings import Settings
from zerorev.model.tool import Tool
from zerorev.motion import kinematics
from zerorev.planning.hole import plan
from zerorev.verify.certificate.arm import Setting, posture_of
from zerorev.verify.certificate.certify import certify_motion
from zerorev.verify.certificate.legs import planned_motion
from zerorev.verify.certificate.mix import mixed
from zerorev.verify.certificate.path import Rig, Segment
from zerorev.verify.certificate.piece import ball_arithmetic
from zerorev.verify.certificate.triangle import Triangle
from zerorev.verify.certificate.vector import vector
from zerorev.verify.certificate.walk import LostError

SAMPLE = (7, 13, 61, 107, 117)  # of random holes that are drilled without a reversal
TURNING = (165, 230)  # in a few of whose wide blends that turn one way a joint turns round
RADII = (1e-3, 2e-3, 5e-3, 10e-3)
MIXES = ("any", "one_way")
SETTINGS = Settings(proof_boxes=0)
DIFFERENCE = 3e-5  # [rad/m]: more than finite differences are off


class Case(NamedTuple):
    robot: Robot
    tool: Tool
    plan: HolePlan


ROBOT, TOOL = read_robot("kuka_kr6_r700_2"), read_tool("thesis_drill")


@cache
def random_case(seed):
    return case_of(random_hole(ROBOT, seed))


def case_of(hole):
    """The best plan of a hole; None where there is none without a reversal."""
    found = plan(ROBOT, TOOL, hole, SETTINGS)
    return None if found.motion is None or found.score.reversals else Case(ROBOT, TOOL, found)


@pytest.fixture(scope="session")
def thesis(positions):
    return [case_of(each.hole) for each in positions]


def ways_of(case):
    """The direction of each joint in the motion."""
    return np.sign(np.diff(case.plan.motion.joints[[0, -1]], axis=0)[0]).astype(int)


def triangle_of(case, radius):
    motion = planned_motion(case.robot.arm, case.tool, case.plan.hole, case.plan.motion.profile, radius)
    return Triangle.between(*motion.blends[0].moves)


def asked(case, radius, mixes, ways=None):
    """What is proven, and the radius as clipped."""
    with ball_arithmetic():
        setting = Setting(case.robot.arm, posture_of(case.robot.arm, case.plan.motion.joints[0]))
        triangle = triangle_of(case, radius)
        found = mixed(setting, triangle, dict(enumerate(ways_of(case))) if ways is None else ways, mixes)
        return found, float(triangle.cut)


def cut_of(case, radius):
    return min(radius, case.plan.hole.depth / 2)


def least_rates(case, cut, mixes, points):
    """Least rate of each joint in its direction, over samples of the triangle [rad/m], shape (6,)."""
    left, done = cut * places(points)
    before, behind = velocities(case, left, done) * ways_of(case)
    weights = outermost(mixes, cut, left, done)
    rates = weights[:, 0, :, None] * before + weights[:, 1, :, None] * behind
    return np.nanmin(rates, axis=(0, 1))


def holds(case, radius, mixes, points=41):
    """Hold an answer against samples; whether no joint turns round."""
    found, cut = asked(case, radius, mixes)
    assert not found.undecided
    assert not found.still
    least, ways = least_rates(case, cut, mixes, points), ways_of(case)
    for joint in range(6):
        if joint not in found.turns:
            assert 0 <= found.least[joint] <= least[joint] + DIFFERENCE
            continue
        assert np.isnan(found.least[joint])
        counter = found.turns[joint]
        left, done = np.array([counter.left]), np.array([counter.done])
        before, behind = velocities(case, left, done)[:, 0, joint] * ways[joint]
        outer = outermost(mixes, cut, left, done)[:, 0, 0]
        share = counter.weights[0] / sum(counter.weights)
        assert share * before + (1 - share) * behind < DIFFERENCE
        assert counter.left >= 0
        assert counter.done >= 0
        assert counter.left + counter.done <= cut * (1 + 1e-12)
        if np.isfinite(outer).all():
            assert min(outer) - 1e-9 <= share <= max(outer) + 1e-9
        assert counter.rest == "" or (counter.rest == "or more") == (before < behind)
    return not found.turns


def turned_round(case, cut, curve):
    """The joints that turn round on a blend of some curve, shares (2, N)."""
    joints = joints_on(case, *(cut * curve))
    return set(np.flatnonzero((np.diff(joints, axis=0) * ways_of(case) < -1e-11).any(axis=0)).tolist())


# --- the triangle -----------------------------------------------------------------------------------------------------


def finely(values):
    return tuple(arb(float(value)) for value in values)


def test_rates_of_two_moves_about_axes_of_their_own(positions):
    """And not in line, as printed moves are by a hair: against finite differences of the kernels' joints."""
    rng = np.random.default_rng(0)
    joints = np.deg2rad(positions[0].axis_deg[1])
    T = kinematics.forward(ROBOT, joints)
    tip, branch = T[:3, :3] @ TOOL.T_flange_tcp[:3, 3] + T[:3, 3], positions[0].branch
    ahead, after = ([0.04, 0.01, -0.02] * rng.uniform(0.5, 1, 3) for _ in range(2))
    axes = [each / np.linalg.norm(each) for each in rng.normal(size=(2, 3))]
    angles, lengths = (0.3, -0.4), [np.linalg.norm(each) for each in (ahead, after)]
    lever = T[:3, 3] - ROBOT.arm.c4 * T[:3, 2] - tip
    back = Rotation.from_rotvec(-0.3 * axes[0]).as_matrix()

    def pose(left, done):
        R = (
            Rotation.from_rotvec(axes[1] * angles[1] * done / lengths[1])
            * Rotation.from_rotvec(-axes[0] * angles[0] * left / lengths[0])
        ).as_matrix()
        there = np.eye(4)
        there[:3, :3] = R @ T[:3, :3]
        place = tip - ahead * left / lengths[0] + after * done / lengths[1]
        there[:3, 3] = place + R @ (T[:3, 3] - tip)
        return kinematics.inverse(ROBOT, there)[branch]

    with ball_arithmetic():
        rig = Rig(vector(back @ lever), tuple(vector(back @ T[:3, k]) for k in range(3)))
        still = tuple(vector(T[:3, k]) for k in range(3))
        moves = [
            Segment(
                "on the plunge", "in the blended corner", vector(begin), vector(end), held, vector(axis),
                finely((0, angle)), finely((0.1, 0.1)), arb(length), arb(0.01),
            )
            for begin, end, held, axis, angle, length in (
                (tip - ahead, tip, rig, axes[0], angles[0], lengths[0]),
                (tip, tip + after, Rig(vector(lever), still), axes[1], angles[1], lengths[1]),
            )
        ]  # fmt: skip
        triangle = Triangle.between(*moves)
        setting, h = Setting(ROBOT.arm, posture_of(ROBOT.arm, joints)), 1e-6
        for left, done in ((0.0, 0.0), (0.01, 0.0), (0.0, 0.01), (0.004, 0.003)):
            found = triangle.rates(setting, arb(left), arb(done))
            before = (pose(left - h, done) - pose(left + h, done)) / (2 * h)
            behind = (pose(left, done + h) - pose(left, done - h)) / (2 * h)
            np.testing.assert_allclose([float(rate) for rate in found.before], before, rtol=1e-6, atol=1e-5)
            np.testing.assert_allclose([float(rate) for rate in found.behind], behind, rtol=1e-6, atol=1e-5)


def test_its_sides_are_the_legs_and_the_parabola_lies_in_it(thesis):
    case = thesis[0]
    with ball_arithmetic():
        motion = planned_motion(case.robot.arm, case.tool, case.plan.hole, case.plan.motion.profile, 4e-3)
        triangle, arc = Triangle.between(*motion.blends[0].moves), motion.blends[0].arc
        for t in (0.0, 0.25, 0.5, 1.0):
            left, done = triangle.cut * (1 - t) ** 2, triangle.cut * t**2
            pose, before, behind = triangle._around(left, done)
            for mine, theirs in zip(
                (*pose.wrist, *pose.axis_6), (*arc.at(t)[0].wrist, *arc.at(t)[0].axis_6), strict=True
            ):
                assert abs(mine - theirs) < 1e-30
            _, twist = arc.around(arb(t), arb(1))
            for one, other, both in zip(before.velocity, behind.velocity, twist.velocity, strict=True):
                assert abs(((1 - t) * one + t * other) * 2 * triangle.cut - both[0]) < 1e-30
        assert triangle.place(1e-3, 2e-3) == "in the blended corner, stand-off 3 mm"


# --- what is proven ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("mixes", MIXES)
@pytest.mark.parametrize("radius", RADII)
def test_the_three_positions(thesis, radius, mixes):
    held = [holds(case, radius, mixes) for case in thesis]
    assert held == ([radius < 10e-3, radius < 5e-3, radius < 10e-3] if mixes == "any" else [True] * 3)


@pytest.mark.parametrize("seed", SAMPLE)
@pytest.mark.parametrize("mixes", MIXES)
def test_random_plans(seed, mixes):
    case = random_case(seed)
    held = [holds(case, radius, mixes) for radius in RADII]
    assert held == sorted(held, reverse=True)  # what holds for a radius holds for every smaller one


@pytest.mark.parametrize("seed", SAMPLE)
def test_curves(seed):
    """No joint turns round on any curve of which it is proven."""
    case, rng = random_case(seed), np.random.default_rng(seed)
    for mixes, make in (("any", any_curve), ("one_way", one_way_curve)):
        for radius in RADII[1:]:
            found, cut = asked(case, radius, mixes)
            for _ in range(20):
                assert turned_round(case, cut, make(rng, 400)) <= found.turns.keys()


@pytest.mark.parametrize("mixes", MIXES)
def test_the_curve_of_a_refuted_mix(mixes):
    """Straight from the entry to the place, or a step of the one move there, or of the other: the joint turns round."""
    refuted = 0
    for seed in TURNING:
        case = random_case(seed)
        found, cut = asked(case, 30e-3, mixes)
        for joint, counter in found.turns.items():
            left, done = counter.left / cut, counter.done / cut
            if mixes == "one_way":
                path = [(1, 0), (left, done), (0, 1)]
            else:
                step = 1e-3
                left, done = min(max(left, step), 1 - 2 * step), min(max(done, step), 1 - 2 * step)
                left -= max(left + done - 1 + step, 0)
                path = [(1, 0), (left + step, 0), (left + step, done), (left, done), (left, done + step), (0, 1)]
            corners = np.array(path, dtype=float)
            share = np.linspace(0, 1, 300, endpoint=False)[:, None]
            curve = np.concatenate([a + share * (b - a) for a, b in pairwise(corners)])
            assert joint in turned_round(case, cut, curve.T)
            refuted += 1
    assert refuted


@pytest.mark.parametrize("seed", SAMPLE)
def test_to_the_last_hair_of_the_radius(seed):
    """Where the samples of another code begin to find a joint that turns round, the proof ends."""
    case = random_case(seed)
    low, high = 1e-4, 20e-3
    assert least_rates(case, low, "any", 21).min() > 0
    assert least_rates(case, cut_of(case, high), "any", 21).min() < 0
    while high > low * 1.0001:
        middle = (low * high) ** 0.5
        low, high = (middle, high) if least_rates(case, cut_of(case, middle), "any", 21).min() > 0 else (low, middle)
    assert not asked(case, 0.999 * low, "any")[0].turns
    assert asked(case, 1.001 * high, "any")[0].turns


@pytest.mark.parametrize("mixes", MIXES)
def test_bounds_are_tight(thesis, mixes):
    for case in thesis:
        found, cut = asked(case, 2e-3, mixes)
        least = least_rates(case, cut, mixes, 61)
        assert (found.least >= 0.97 * least).all()


def test_a_joint_that_stands_still():
    """In the arm's plane of symmetry only joints 2, 3 and 5 move, and reverse, and are not followed."""
    tool = Tool.from_mm_deg((0.0, 0.0, 150.0), (0.0, 180.0, 0.0))
    hole = Hole("in the plane", [0.5, 0.0, 0.5], [0, 0, -1], 0.02)
    start = np.deg2rad([[0.0, -60.0, 90.0, 0.0, 60.0, 0.0]])
    with ball_arithmetic():
        motion = planned_motion(ROBOT.arm, tool, hole, Profile.straight(0.02, 0.0, 0.0, 0.0), 2e-3)
        triangle, setting = (
            Triangle.between(*motion.blends[0].moves),
            Setting(ROBOT.arm, posture_of(ROBOT.arm, start[0])),
        )
        for mixes in MIXES:
            found = mixed(setting, triangle, {0: 0, 3: 0, 5: 0}, mixes)
            assert not {**found.undecided, **found.turns, **found.still}
            np.testing.assert_allclose(found.least[[0, 3, 5]], 0, atol=1e-12)
            assert np.isnan(found.least[[1, 2, 4]]).all()
            # one that moves elsewhere on the legs, and one that does not
            found = mixed(setting, triangle, {0: 1, 1: 0}, mixes)
            assert (set(found.still), set(found.undecided)) == ({0}, {1})


def test_out_of_reach_between_two_legs_in_reach():
    hole = Hole("at the edge of reach", [0.502, 0.0, 0.643], [-1.0, 0.0, -0.05], 0.02)
    profile = Profile.straight(0.02, 0.13 + 1.8, 0.13, 0.13 - 1.8)
    T = kinematics.tcp_pose(hole, profile.standoff, profile.psi) @ np.linalg.inv(TOOL.T_flange_tcp)
    joints = kinematics.inverse(ROBOT, T)[:, 0]
    with ball_arithmetic():
        setting = Setting(ROBOT.arm, posture_of(ROBOT.arm, joints[0]))
        motion = planned_motion(ROBOT.arm, TOOL, hole, profile, 10e-3)
        with pytest.raises(LostError, match="out of reach in the blended corner, stand-off") as lost:
            mixed(setting, Triangle.between(*motion.blends[0].moves), {}, "any")
    assert lost.value.proven


# --- the certificate --------------------------------------------------------------------------------------------------


def test_a_certificate_of_every_blend(thesis):
    case = thesis[1]
    motion = case.plan.motion
    parts = ROBOT, TOOL, case.plan.hole, motion.profile, motion.joints
    usual = certify_motion(*parts, blend=SETTINGS.blend)
    for mixes in MIXES:
        answer = certify_motion(*parts, blend=SETTINGS.blend, mixes=mixes)
        assert answer.verdict == "certified"
        assert answer.pieces > usual.pieces
        np.testing.assert_array_equal(answer.min_rate, usual.min_rate)
        assert (answer.blend_min_rate <= usual.blend_min_rate).all()
        assert (answer.blend_min_rate > 0).all()


def test_a_refuted_one_says_for_which_blend():
    motion, hole = random_case(117).plan.motion, random_case(117).plan.hole
    parts = ROBOT, TOOL, hole, motion.profile, motion.joints
    assert certify_motion(*parts, blend=5e-3).verdict == "certified"
    answer = certify_motion(*parts, blend=5e-3, mixes="any")
    assert answer.verdict == "refuted"
    assert answer.reasons == (
        "A4 turns round: it moves the other way in the blended corner, stand-off 5 mm, for a blend with 0 mm of the "
        "plunge left there, 5 mm of the retract done, and 87 % or more of its velocity from the plunge",
        "A5 turns round: it moves the other way in the blended corner, stand-off 5 mm, for a blend with 0 mm of the "
        "plunge left there, 5 mm of the retract done, and 99 % or more of its velocity from the plunge",
    )
    assert certify_motion(*parts, blend=5e-3, mixes="one_way").verdict == "certified"


def test_blends_within_the_legs(thesis):
    """A spin that bends at every breakpoint: each bend is examined, not the corner alone."""
    case = thesis[0]
    standoff = np.array([50, 30, 10, 0, 10, 30, 50]) * 1e-3
    plain = case.plan.motion.profile
    ends = [0, 50e-3]
    psi = np.concatenate(
        [np.interp(standoff[:4], ends, plain.psi[1::-1]), np.interp(standoff[4:], ends, plain.psi[1:])]
    )
    psi[2] -= 0.02
    moved = ROBOT, TOOL, case.plan.hole, Profile(standoff, psi), case.plan.motion.joints[:1]
    blends = {"blend": 1e-3, "passing_blend": 2e-3}
    assert certify_motion(*moved, **blends, mixes="one_way").verdict == "certified"
    answer = certify_motion(*moved, **blends, mixes="any")
    assert answer.reasons == (
        "A2 turns round: it moves the other way in the blend at breakpoint 3, stand-off 8 mm, for a blend with 0 mm of "
        "the move before it left there, 2 mm of the move behind it done, and 99 % or more of its velocity from the "
        "move before it",
    )


# --- many plans -------------------------------------------------------------------------------------------------------


def zero_reversal_cases(count):
    """Random holes that are drilled without a reversal."""
    found, seed = list[Case](), 0
    while len(found) < count:
        case = random_case(seed)
        found += [] if case is None else [case]
        seed += 1
    return found


@pytest.mark.soak
def test_354_plans(record_property):
    """How many of the plans that hold with the parabola do not hold for every mix, by the radius."""
    cases, table = zero_reversal_cases(354), {}
    for case in cases:
        motion = case.plan.motion
        for radius in RADII:
            parts = ROBOT, TOOL, case.plan.hole, motion.profile, motion.joints
            assert certify_motion(*parts, blend=radius).verdict == "certified"
    for mixes in MIXES:
        for radius in RADII:
            table[mixes, radius * 1e3] = sum(not holds(case, radius, mixes) for case in cases)
    record_property("measured", f"of 354 plans do not hold for every blend: {table}")
    assert [table["any", radius * 1e3] for radius in RADII] == sorted(table["any", radius * 1e3] for radius in RADII)
    assert table["any", 10.0] > 100
    assert sum(table["one_way", radius * 1e3] for radius in RADII) == 0
