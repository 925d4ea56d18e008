"""The check's own figures of a joint corner: against those of the planner, and where a joint does not keep its way."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from zerorev.model.plan import Motion
from zerorev.model.profile import Profile
from zerorev.motion.drilling import Drilling
from zerorev.motion.joint_corner import joint_corner
from zerorev.verify.arm import branch_of, posture_of
from zerorev.verify.joint_corner import corner_figures, triangle_figures
from zerorev.verify.lever import line_rates
from zerorev.verify.path import Path, follow

REACH = 1e-3


def motion_of(robot, tool, hole, profile, start):
    path = Path(profile.standoff, profile.psi, (), profile.corner)
    joints = follow(robot, tool, hole, path, posture_of(robot.arm, start), start)
    return Motion(profile, branch_of(robot.arm, joints[0]), joints)


@pytest.mark.parametrize("number", [1, 2, 3])
def test_are_those_of_the_planner(kuka, drill, published, number):
    answer = published(number)
    planned = joint_corner(Drilling(kuka, drill, answer.hole), answer.motion, REACH, 1.0, 1.0)
    found = corner_figures(kuka, drill, answer.hole, answer.motion, REACH)
    np.testing.assert_allclose(found.joints, planned.joints, atol=1e-11)
    assert found.off_axis == pytest.approx(planned.off_axis, rel=2e-3)
    assert found.tilt == pytest.approx(planned.tilt, rel=2e-3)
    assert found.keeps == (True,) * 6


@pytest.mark.parametrize("seed", range(8))
def test_are_those_of_the_planner_on_every_robot(robot, drill, random_hole, seed):
    hole, profile, start = random_hole(robot, drill, seed)
    motion = motion_of(robot, drill, hole, profile, start)
    reach = min(REACH, hole.depth / 2)
    planned = joint_corner(Drilling(robot, drill, hole), motion, reach, 1.0, 1.0)
    found = corner_figures(robot, drill, hole, motion, reach)
    np.testing.assert_allclose(found.joints, planned.joints, atol=1e-10)
    assert found.off_axis == pytest.approx(planned.off_axis, rel=2e-3)
    assert found.tilt == pytest.approx(planned.tilt, rel=2e-3)


def test_a_joint_that_reverses_at_the_corner_keeps_the_way_of_its_legs(kuka, drill, published):
    answer = published(1, (14.0, 14.0, 14.0))
    found = corner_figures(kuka, drill, answer.hole, answer.motion, REACH)
    assert (np.diff(found.joints, axis=0).prod(axis=0) < 0).all()
    assert found.keeps == (True,) * 6


@pytest.mark.parametrize("leg", ["plunge", "retract"])
@pytest.mark.parametrize("joint", [1, 4])
def test_a_joint_that_turns_round_on_the_way_does_not_keep_its_way(kuka, drill, published, joint, leg):
    """The leg's slope is the joint's critical rate a little below or above the place where the joint move begins."""
    answer = published(1)
    hole, given = answer.hole, answer.motion
    psi_t = float(given.profile.psi[1])

    def with_slope(slope):
        psi = given.profile.psi.copy()
        psi[0 if leg == "plunge" else 2] = psi_t + slope * hole.depth
        return motion_of(kuka, drill, hole, Profile(given.profile.standoff, psi), given.joints[0])

    def turning_at(share):
        """The slope with which the joint turns round at a share of the reach."""
        slope = 0.0
        for _ in range(12):
            motion = with_slope(slope)
            row = 0 if leg == "plunge" else 2
            at = corner_figures(kuka, drill, hole, motion, share * REACH).joints[[row]]
            along, around = (line_rates(kuka, drill, hole, at, *way)[0, joint] for way in ((1.0, 0.0), (0.0, 1.0)))
            slope = -along / around
        return slope

    inside, outside = (with_slope(turning_at(share)) for share in (0.9, 1.1))
    # between the corner and the entry it goes one way on the whole, near the entry the other way
    assert corner_figures(kuka, drill, hole, inside, REACH).keeps[joint] is False
    assert corner_figures(kuka, drill, hole, outside, REACH).keeps[joint] is True


def test_out_of_reach_nothing_is_a_number(kuka, drill, published):
    answer = published(1)
    away = replace(answer.hole, target=np.array([5.0, 0.0, 0.0]))
    found = corner_figures(kuka, drill, away, answer.motion, REACH)
    assert np.isnan([found.off_axis, found.tilt]).all()
    assert found.keeps == (False,) * 6


def test_a_triangle_that_is_a_point_is_where_the_tool_is(kuka, drill, published):
    answer = published(2)
    off_axis, tilt = triangle_figures(kuka, drill, answer.hole, np.tile(answer.motion.joints[1], (3, 1)))
    assert off_axis < 1e-12
    assert tilt < 1e-12
    away = replace(answer.hole, target=answer.hole.target + np.array([0.0, 3e-3, 4e-3]))
    assert triangle_figures(kuka, drill, away, answer.motion.joints)[0] > 4.9e-3
