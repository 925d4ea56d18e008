"""The corner as two joint moves: how far the tool leaves the drill axis on them, and how long they may be.

The tool is placed by the check's own forward kinematics, on many points of the moves and of the triangle between them.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import count, islice

import numpy as np
import pytest

from oracles.holes import random_hole
from zerorev.model.hole import Hole
from zerorev.model.plan import Motion
from zerorev.model.profile import Profile
from zerorev.model.settings import Settings
from zerorev.motion.drilling import Drilling
from zerorev.motion.joint_corner import joint_corner
from zerorev.motion.joint_path import joint_path
from zerorev.motion.kinematics import forward
from zerorev.planning.hole import plan
from zerorev.search.optimum import best_motion
from zerorev.verify.arm import skeleton

TOLERANCE, TILT = 2e-5, np.deg2rad(0.01)
ANY = 1.0  # [m], [rad]: a tolerance that nothing exceeds


def tool_at(drilling, joints):
    """Distance from the drill axis [m], tilt [rad] and stand-off [m] at joint vectors (N, 6), by the check's arm."""
    body, T = skeleton(drilling.robot.arm, np.asfortranarray(joints)), drilling.tool.T_flange_tcp
    from_target = (body.flange + np.einsum("ijn,j->in", body.R_base_flange, T[:3, 3])).T - drilling.hole.target
    z = np.einsum("ijn,j->in", body.R_base_flange, T[:3, 2]).T
    d = drilling.hole.direction
    off_axis = np.linalg.norm(from_target - np.outer(from_target @ d, d), axis=1)
    return off_axis, np.arctan2(np.linalg.norm(np.cross(z, -d), axis=1), -z @ d), -from_target @ d


def along(joints, points=1000):
    """The two joint moves, entry to corner to exit, point by point."""
    share = np.linspace(0, 1, points)[:, None]
    return np.concatenate([a + share * (b - a) for a, b in ((joints[0], joints[1]), (joints[1], joints[2]))])


def scattered(joints, points, seed=0):
    """Points all over the triangle of three joint vectors."""
    return np.random.default_rng(seed).dirichlet([0.7] * 3, points) @ joints


def goes_one_way(joints):
    return bool((np.diff(joints, axis=0).prod(axis=0) > 0).all())


def on_any_robot(seed, *, free_legs=False):
    """A hole of the five robots, of three sizes; every fourth one with free legs, or none."""
    drilled = random_hole(seed, legs="free" if free_legs and seed % 4 == 0 else "straight")
    return drilled.asking(proof_boxes=0).both


def by_the_thesis_drill(robot, tool, seed):
    """A hole of the thesis' robot and drill, 10 to 30 mm deep, anywhere above the floor."""
    rng = np.random.default_rng([7, seed])
    while True:
        T = forward(robot, rng.uniform(robot.limits.lower, robot.limits.upper)) @ tool.T_flange_tcp
        if T[2, 3] > 0.1:
            hole = Hole("random", T[:3, 3], -T[:3, 2], rng.uniform(0.01, 0.03), psi_zero=T[:3, 1])
            return Drilling(robot, tool, hole), Settings(proof_boxes=0)


def reversal_free(holes):
    """The best motions of holes, those without a reversal."""
    for drilling, settings in holes:
        best = best_motion(drilling, settings)
        if best is not None and best.reversals == 0:
            yield drilling, best.evaluation.motion


@pytest.fixture(scope="module")
def planned(robot, tool, positions):
    """The motions of the three positions, planned with the defaults."""
    holes = [replace(position.hole, profile=None) for position in positions]
    plans = [plan(robot, tool, hole, Settings(proof_boxes=0)) for hole in holes]
    return [(Drilling(robot, tool, one.hole), one.motion) for one in plans]


class TestThesisPositions:
    @pytest.mark.parametrize(("index", "on_the_moves"), [(0, 2.6e-6), (1, 11.1e-6), (2, 7.3e-6)])
    def test_a_millimetre_is_within_two_hundredths_and_a_hundredth_of_a_degree(self, planned, index, on_the_moves):
        drilling, motion = planned[index]
        corner = joint_corner(drilling, motion, 1e-3, TOLERANCE, TILT)
        assert corner.reach == 1e-3
        assert corner.off_axis < TOLERANCE
        assert corner.tilt < TILT
        assert goes_one_way(corner.joints)
        off_axis, tilt, _ = tool_at(drilling, along(corner.joints))
        assert off_axis.max() == pytest.approx(on_the_moves, abs=0.1e-6)
        assert tilt.max() <= corner.tilt

    def test_published_plans(self, robot, tool, positions):
        for position, seen in zip(positions, (3e-6, 11e-6, 7e-6), strict=True):
            drilling = Drilling(robot, tool, position.hole)
            path = joint_path(drilling, position.profile, position.branch)
            corner = joint_corner(drilling, path.at_breakpoints(position.profile, position.branch), None, ANY, ANY)
            assert corner.reach == 1e-3
            off_axis, _, _ = tool_at(drilling, along(corner.joints))
            assert off_axis.max() == pytest.approx(seen, abs=1e-6)

    def test_the_figures_hold_for_every_blend(self, planned):
        """Anywhere in the triangle, and they are met there; nowhere is the tip deeper than at the corner."""
        for drilling, motion in planned:
            corner = joint_corner(drilling, motion, 1e-3, ANY, ANY)
            off_axis, tilt, standoff = tool_at(drilling, scattered(corner.joints, 50_000))
            for stated, seen in ((corner.off_axis, off_axis), (corner.tilt, tilt)):
                assert 0.98 * stated < seen.max() < 1.002 * stated
            assert standoff.min() > motion.profile.standoff.min() - 1e-12


class TestEnds:
    def test_lie_on_the_motion_with_its_turns(self, planned):
        for drilling, motion in planned:
            turned = Motion(motion.profile, motion.branch, motion.joints + 2 * np.pi * np.array([0, 0, 0, 1, 0, -1]))
            corner = joint_corner(drilling, turned, 1e-3, ANY, ANY)
            np.testing.assert_array_equal(corner.joints[1], turned.joints[1])
            assert np.abs(np.diff(corner.joints, axis=0)).max() < 0.1
            off_axis, tilt, standoff = tool_at(drilling, corner.joints)
            np.testing.assert_allclose(off_axis, 0, atol=1e-12)
            np.testing.assert_allclose(tilt, 0, atol=1e-12)
            np.testing.assert_allclose(standoff, [1e-3, 0, 1e-3], atol=1e-12)

    def test_are_the_motion_at_their_stand_offs(self, planned):
        for drilling, motion in planned:
            corner = joint_corner(drilling, motion, 1e-3, ANY, ANY)
            turn = motion.profile.distance[1]
            path = joint_path(drilling, motion.profile, motion.branch, through=[turn - 1e-3, turn + 1e-3])
            rows = np.searchsorted(path.distance, turn + np.array([-1e-3, 0, 1e-3]) - 1e-12)
            np.testing.assert_allclose(corner.joints, path.joints[rows], atol=1e-9)

    def test_lie_above_a_corner_that_is_placed_deeper(self, robot, tool, positions):
        settings = Settings(proof_boxes=0, blend=4e-3, deepen_corner=True)
        answer = plan(robot, tool, replace(positions[1].hole, profile=None), settings)
        drilling = Drilling(robot, tool, answer.hole)
        corner = joint_corner(drilling, answer.motion, 1e-3, ANY, ANY)
        np.testing.assert_allclose(tool_at(drilling, corner.joints)[2], [-1e-3, -2e-3, -1e-3], atol=1e-12)


class TestReach:
    def test_the_error_goes_as_its_square(self, planned):
        for drilling, motion in planned:
            one, half = (joint_corner(drilling, motion, reach, ANY, ANY) for reach in (1e-3, 0.5e-3))
            assert one.off_axis / half.off_axis == pytest.approx(4, rel=0.05)
            assert one.tilt / half.tilt == pytest.approx(4, rel=0.1)

    @pytest.mark.parametrize(("tolerance", "tilt"), [(2e-6, ANY), (ANY, np.deg2rad(2e-4)), (1e-6, np.deg2rad(1e-4))])
    def test_is_as_long_as_the_tolerances_allow(self, planned, tolerance, tilt):
        for drilling, motion in planned:
            corner = joint_corner(drilling, motion, 1e-3, tolerance, tilt)
            assert corner.reach < 1e-3
            assert 0.93 < max(corner.off_axis / tolerance, corner.tilt / tilt) <= 1

    def test_is_never_more_than_asked_nor_than_half_a_move(self, robot, tool, positions):
        hole, given = positions[0].hole, positions[0].profile
        assert np.isclose(given.standoff[0], 0.05)
        psi = np.interp(0.5e-3, given.standoff[[1, 2]], given.psi[[1, 2]])
        profile = Profile(np.array([0.05, 0.0, 0.5e-3, 0.05]), np.insert(given.psi, 2, psi))
        drilling = Drilling(robot, tool, hole)
        motion = joint_path(drilling, profile, positions[0].branch).at_breakpoints(profile, positions[0].branch)
        assert joint_corner(drilling, motion, 1e-3, ANY, ANY).reach == pytest.approx(0.25e-3, abs=1e-12)
        assert joint_corner(drilling, motion, 0.1e-3, ANY, ANY).reach == 0.1e-3

    def test_none_is_found_where_every_reach_is_too_long(self, planned):
        drilling, motion = planned[1]
        assert joint_corner(drilling, motion, 1e-3, 1e-9, ANY) is None
        assert joint_corner(drilling, motion, 1e-3, ANY, 1e-9) is None
        assert joint_corner(drilling, motion, 1e-6, ANY, ANY) is None

    def test_none_is_found_where_the_motion_cannot_be_followed(self, planned):
        drilling, motion = planned[0]
        away = replace(drilling, hole=replace(drilling.hole, target=np.array([5.0, 0.0, 0.0])))
        assert joint_corner(away, motion, 1e-3, ANY, ANY) is None

    def test_grows_with_the_arm(self, planned):
        for drilling, motion in planned:
            large, _ = drilling.resized(Settings(), 4.0)
            moved = replace(motion, profile=replace(motion.profile, standoff=4 * motion.profile.standoff))
            one = joint_corner(drilling, motion, None, 5e-6, ANY)
            other = joint_corner(large, moved, None, 20e-6, ANY)
            assert other.reach == 4 * one.reach
            assert other.off_axis == pytest.approx(4 * one.off_axis, rel=1e-9)
            assert other.tilt == pytest.approx(one.tilt, rel=1e-9)


def within_tolerance(drilling, motion):
    """The joint corner by the tolerances of the issue, asked of every motion without a reversal."""
    corner = joint_corner(drilling, motion, None, TOLERANCE, TILT)
    assert corner is not None
    assert goes_one_way(corner.joints)
    off_axis, tilt, out = tool_at(drilling, np.concatenate([along(corner.joints), scattered(corner.joints, 1000)]))
    assert out.min() > motion.profile.standoff.min() - 1e-12
    assert off_axis.max() <= TOLERANCE
    assert tilt.max() <= TILT
    assert off_axis.max() <= 1.002 * corner.off_axis
    assert tilt.max() <= 1.002 * corner.tilt
    return corner


def test_random_holes_without_a_reversal():
    found = [(within_tolerance(*each), each) for each in reversal_free(map(on_any_robot, range(20)))]
    assert len(found) > 12
    assert any(corner.reach < 1e-3 * drilling.robot.size for corner, (drilling, _) in found)


@pytest.mark.long
@pytest.mark.parametrize("free_legs", [True, False], ids=["any robot, also free legs", "thesis drill"])
def test_300_random_holes_without_a_reversal(robot, tool, free_legs, record_property):
    """The reach is found for all of them; at a fixed one some exceed the tolerances, at a quarter of it hardly any."""
    holes = (on_any_robot(n, free_legs=True) if free_legs else by_the_thesis_drill(robot, tool, n) for n in count())
    reaches, exceeding, sides, pieces, worst = [], [], [], set(), np.zeros(2)
    for drilling, motion in islice(reversal_free(holes), 300):
        pieces.add(motion.profile.psi.size - 1)
        reaches.append(within_tolerance(drilling, motion).reach)
        fixed = [joint_corner(drilling, motion, reach, ANY, ANY) for reach in (1e-3, 0.25e-3)]
        exceeding.append([one.off_axis > TOLERANCE or one.tilt > TILT for one in fixed])
        off_axis, tilt, _ = tool_at(drilling, along(fixed[0].joints))
        sides.append(off_axis.max() > TOLERANCE or tilt.max() > TILT)
        worst = np.maximum(worst, [off_axis.max(), tilt.max()])
    assert len(pieces) > 2 or not free_legs
    one, quarter = np.mean(exceeding, axis=0)
    assert 0.01 < np.mean(sides) <= one < 0.15
    assert quarter < 0.02
    record_property(
        "measured",
        f"joint corner, 300 holes ({'any robot' if free_legs else 'thesis drill'}): reach {min(reaches) * 1e3:.3f} mm "
        f"or more; at a fixed 1 mm {one:.1%} exceed 0.02 mm or 0.01 deg, {np.mean(sides):.1%} on the two moves alone, "
        f"there by up to {worst[0] * 1e3:.2f} mm and {np.rad2deg(worst[1]):.3f} deg; at 0.25 mm {quarter:.1%}",
    )
