"""The bound of a joint corner: no sample exceeds it, it is close to what is met, and the joints' ways are proven."""

from __future__ import annotations

from dataclasses import replace
from decimal import Decimal
from itertools import product

import numpy as np
import pytest
from flint import arb

from zerorev.model.hole import Hole
from zerorev.model.tool import Tool
from zerorev.verify.arm import skeleton
from zerorev.verify.certificate import joint_corner as module
from zerorev.verify.certificate.joint_corner import axis_of, bound_corner, drill_of
from zerorev.verify.certificate.piece import ball_arithmetic
from zerorev.verify.certificate.vector import vector
from zerorev.verify.joint_corner import corner_figures
from zerorev.verify.lever import lever

REACH = 1e-3
# the tip straight ahead of the flange, the drill across
LONG = Tool("long", np.array([[0.0, 0.0, -1.0, 0.0], [0.0, 1.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.2], [0.0, 0.0, 0.0, 1.0]]))


def exact(joints):
    return [[arb(angle) for angle in row] for row in joints.tolist()]


def bound(robot, tool, hole, joints):
    return bound_corner(robot, drill_of(tool), axis_of(hole), exact(joints))


def sampled(robot, tool, hole, joints, points=20_000):
    """Greatest distance from the axis and tilt of random points of the triangle, its sides and corners among them."""
    rng = np.random.default_rng(0)
    shares = np.concatenate([np.eye(3), *(rng.dirichlet([a] * 3, points // 2) for a in (1.0, 0.02))])
    body, T = skeleton(robot.arm, np.asfortranarray(shares @ joints)), tool.T_flange_tcp
    tip = body.flange + np.einsum("ijn,j->in", body.R_base_flange, T[:3, 3])
    z = np.einsum("ijn,j->in", body.R_base_flange, T[:3, 2])
    off_axis = np.linalg.norm(np.cross(tip.T - hole.target, hole.direction), axis=1)
    sine = np.linalg.norm(np.cross(z.T, hole.direction), axis=1)
    return off_axis.max(), np.arctan2(sine, -hole.direction @ z).max()


def holds(found, off_axis, tilt):
    """The samples are within the bounds but for their own rounding, and what is said to be met is met."""
    assert off_axis <= found.off_axis + 1e-14
    assert tilt <= found.tilt + 1e-14
    assert found.off_axis_met <= found.off_axis
    assert found.tilt_met <= found.tilt


def is_close(found):
    assert found.off_axis <= 1.1 * found.off_axis_met + 1.0001e-6
    assert found.tilt <= 1.1 * found.tilt_met + np.deg2rad(1.0001e-4)


@pytest.mark.parametrize(("number", "off_axis"), [(1, 6.7e-6), (2, 15.1e-6), (3, 11.2e-6)])
def test_thesis_positions(kuka, drill, published, number, off_axis):
    """Two hundredths of a millimetre and a hundredth of a degree are proven, for every blend."""
    answer = published(number)
    figures = corner_figures(kuka, drill, answer.hole, answer.motion, REACH)
    found = bound(kuka, drill, answer.hole, figures.joints)
    holds(found, *sampled(kuka, drill, answer.hole, figures.joints))
    is_close(found)
    assert figures.off_axis == pytest.approx(off_axis, abs=0.1e-6)
    assert found.off_axis_met == pytest.approx(figures.off_axis, rel=0.05)
    assert found.off_axis < 2e-5
    assert np.rad2deg(found.tilt) < 0.01
    assert found.one_way == (True,) * 6
    assert found.signs[0] == tuple(np.sign(figures.joints[1] - figures.joints[0]))


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("turn", [1e-4, 1e-2])
def test_no_sample_of_a_random_triangle_exceeds_the_bound(robot, drill, seed, turn):
    """Three joint vectors near each other, whose tool stands anywhere beside the axis, at any tilt."""
    rng = np.random.default_rng(seed)
    limits = robot.limits
    joints = rng.uniform(limits.lower, limits.upper) + turn * rng.normal(size=(3, 6))
    body, T = skeleton(robot.arm, np.asfortranarray(joints)), drill.T_flange_tcp
    R = body.R_base_flange[:, :, 1] @ T[:3, :3]
    tip = body.flange[:, 1] + body.R_base_flange[:, :, 1] @ T[:3, 3]
    hole = Hole("beside", tip + turn * rng.normal(size=3), -R[:, 2] + turn * rng.normal(size=3), 0.01, R[:, 1])
    found = bound(robot, drill, hole, joints)
    holds(found, *sampled(robot, drill, hole, joints))
    is_close(found)


def stretched(arm):
    """Joints with which the arm lies straight ahead of its shoulder."""
    bend = np.arctan2(arm.a2, arm.c3)
    return np.array(arm.sign) * (np.array([0.0, np.pi / 2, -bend, 0.0, bend, 0.0]) + arm.offset)


@pytest.mark.parametrize("halvings", range(5))
def test_what_lies_between_the_vertices_is_bounded(kuka, monkeypatch, halvings):
    """One joint turns the stretched arm: the tip goes on a circle, farthest from the axis midway between two vertices.

    Nothing cancels here: of the 2/9 that are allowed for 1/8 is used up, the most that is possible on a side.
    """
    monkeypatch.setattr(module, "SHARE", 0.0)
    monkeypatch.setattr(module, "CLOSE", np.zeros(2))
    monkeypatch.setattr(module, "HALVINGS", halvings)
    arm, width, at = kuka.arm, 0.02, 0.5**halvings - 1
    joints = stretched(arm) + width * np.outer([-1.0, 1.0, 1.0], np.eye(6)[0])
    flange = skeleton(arm, stretched(arm)[None]).flange[:, 0]
    radius = flange[0] + LONG.T_flange_tcp[2, 3]
    bend = radius * width**2
    top = arm.sign[0] * width * at  # where the circle goes along the axis [rad]
    out = np.array([np.cos(top), np.sin(top), 0.0])
    height = bend * (1 - at) ** 2 / 2  # there; at the farther end the tip is on the axis
    hole = Hole("tangent", out * (radius - height) + [0, 0, flange[2]], [-np.sin(top), np.cos(top), 0.0], 0.01, out)
    found = bound(kuka, LONG, hole, joints)
    assert abs(flange[1]) < 1e-12
    assert found.triangles == 4**halvings
    assert sampled(kuka, LONG, hole, joints)[0] == pytest.approx(height, rel=1e-3)
    assert height < found.off_axis < height + 1.01 * (2 / 9 - 1 / 8) * 4 * bend / 4**halvings


def bent(robot, tool, joints, side, step=1e-3):
    """Second derivative of the tip [m] and of the tool's direction along a side, by a difference; shape (2,)."""
    body, T = skeleton(robot.arm, np.asfortranarray(joints + step * np.outer([-1, 0, 1], side))), tool.T_flange_tcp
    z = np.einsum("ijn,j->in", body.R_base_flange, T[:3, 2])
    tip = body.flange + np.einsum("ijn,j->in", body.R_base_flange, T[:3, 3])
    return np.array([np.linalg.norm(np.diff(way, 2)) / step**2 for way in (tip, z)])


@pytest.mark.parametrize("seed", range(20))
def test_no_way_bends_more_than_the_curvature(robot, drill, published, seed):
    rng = np.random.default_rng(seed)
    limits = robot.limits
    corner = rng.uniform(limits.lower, limits.upper)
    moving = rng.random(6) < (1.0 if seed % 2 else 0.3)
    joints = corner + 0.1 * moving * rng.normal(size=(3, 6))
    with ball_arithmetic():
        triangle = module._Triangle(robot, drill_of(drill), axis_of(published(1).hole), exact(joints))
        most = np.array([float(bend) for bend in triangle._curvature()])
    for one, other in ((0, 1), (1, 2), (2, 0)):
        for point in rng.dirichlet([1.0] * 3, 5) @ joints:
            assert (bent(robot, drill, point, joints[other] - joints[one]) <= most * (1 + 1e-6) + 1e-9).all()


def test_the_way_of_the_stretched_arm_bends_as_much(kuka, drill, published):
    """Axis 2 alone turns, back and forth: tip and direction of the tool lie in the plane in which it turns them."""
    sides = 0.1 * np.outer([-1.0, 0.0, 1.0], np.eye(6)[1])
    with ball_arithmetic():
        exactly = exact(stretched(kuka.arm) + sides)
        triangle = module._Triangle(kuka, drill_of(LONG), axis_of(published(1).hole), exactly)
        most = [float(bend) for bend in triangle._curvature()]
    np.testing.assert_allclose(bent(kuka, LONG, stretched(kuka.arm), sides[2] - sides[0]), most, rtol=1e-4)


def test_the_tip_is_no_further_from_an_axis_than_the_lengths_of_the_arm_allow(robot, drill):
    limits, tip = robot.limits, drill.T_flange_tcp[:3, 3]
    joints = np.random.default_rng(1).uniform(limits.lower, limits.upper, (2000, 6))
    arms = np.array([float(length) for length in module._arms(robot.arm, vector(tip))])
    assert (distances(robot, drill, joints) <= arms[:, None] * (1 + 1e-12)).all()
    if robot.arm.b == 0 and robot.arm.a1 >= 0:  # then they add up in one line
        arms = [float(length) for length in module._arms(robot.arm, vector(LONG.T_flange_tcp[:3, 3]))]
        np.testing.assert_allclose(distances(robot, LONG, stretched(robot.arm)[None])[:3, 0], arms[:3], rtol=1e-12)


def distances(robot, tool, joints):
    """Of the tip from the six axes [m], shape (6, N)."""
    parts, body = lever(robot, tool, np.asfortranarray(joints)), skeleton(robot.arm, np.asfortranarray(joints))
    places = [np.zeros((3, 1)), body.shoulder, body.elbow, body.wrist, body.wrist, body.wrist]
    return np.array(
        [
            np.linalg.norm(np.cross(axis.T, (parts.tip - place).T), axis=1)
            for axis, place in zip(parts.axes, places, strict=True)
        ]
    )


def test_the_parts_of_a_triangle_are_all_of_it():
    parts = np.array(list(module._cut((1.0, 0.0), (0.0, 0.0), (0.0, 1.0))))
    shares = np.random.default_rng(0).dirichlet([1.0] * 3, 500)
    within = [
        (np.linalg.solve(np.vstack([part.T, np.ones(3)]), np.vstack([shares[:, :2].T, np.ones(500)])) > 0).all(axis=0)
        for part in parts
    ]
    np.testing.assert_array_equal(np.sum(within, axis=0), 1)


def test_joints_that_are_known_within_balls_are_bounded_wherever_they_are(kuka, drill, published, monkeypatch):
    monkeypatch.setattr(module, "HALVINGS", 2)
    answer, within = published(2), 1e-5
    hole = replace(answer.hole, target=answer.hole.target + np.array([0.0, 1e-3, 0.0]))
    joints = np.tile(answer.motion.joints[1], (3, 1))
    balls = [[arb(angle, within) for angle in row] for row in joints.tolist()]
    found = bound_corner(kuka, drill_of(drill), axis_of(hole), balls)
    shifted = [joints + within * np.array(signs) for signs in product((-1.0, 1.0), repeat=6)]
    seen = np.array([sampled(kuka, drill, hole, each, 2) for each in shifted])
    assert (seen[:, 0] <= found.off_axis).all()
    assert (seen[:, 1] <= found.tilt).all()
    assert (seen[:, 0] >= found.off_axis_met).all()
    assert np.ptp(seen[:, 0]) > 5e-6
    assert found.off_axis < seen[:, 0].max() + 2e-5


def test_a_triangle_that_is_too_large_to_be_close_is_bounded_all_the_same(kuka, drill, published):
    answer = published(1)
    joints = answer.motion.joints[1] + np.random.default_rng(3).normal(size=(3, 6))
    found = bound(kuka, drill, answer.hole, joints)
    holds(found, *sampled(kuka, drill, answer.hole, joints))
    assert found.triangles <= 20_000


def test_ways_of_the_joints(kuka, drill, published):
    """One way, back, at rest on both moves, at rest on one; and a rest that is one but for the rounding."""
    answer = published(1)
    corner = answer.motion.joints[1]
    entry = corner + np.array([-1, -1, 0, 0, 1, 1e-11]) * 1e-3
    leave = corner + np.array([1, -1, 0, 1, -1, -1e-11]) * 1e-3
    found = bound(kuka, drill, answer.hole, np.array([entry, corner, leave]))
    assert found.signs == ((1, 1, 0, 0, -1, 0), (1, -1, 0, 1, -1, 0))
    assert found.one_way == (True, False, True, False, True, True)


def test_printed_joints_are_taken_as_they_are_printed(kuka, drill, published):
    """To 0.001 deg the tip leaves the axis by up to some hundredths of a millimetre, as a program would have it."""
    answer = published(3)
    joints = corner_figures(kuka, drill, answer.hole, answer.motion, REACH).joints
    proven = bound(kuka, drill, answer.hole, joints)
    for digits, more in ((3, 3e-5), (6, 3e-8)):
        printed = [[Decimal(f"{np.rad2deg(angle):.{digits}f}") for angle in row] for row in joints]
        with ball_arithmetic():
            balls = [[arb(str(angle)) * arb.pi() / 180 for angle in row] for row in printed]
        found = bound_corner(kuka, drill_of(drill), axis_of(answer.hole), balls)
        rounded = np.deg2rad(np.array(printed, dtype=float))
        holds(found, *sampled(kuka, drill, answer.hole, rounded))
        is_close(found)
        assert abs(found.off_axis - proven.off_axis) < more
        assert found.one_way == (True,) * 6
