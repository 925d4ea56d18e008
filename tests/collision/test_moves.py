"""How near the tool comes to the part: against many samples of each move, and of each body."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from oracles.holes import ROBOTS, random_hole
from zerorev.collision import moves
from zerorev.collision.moves import EXACT, nearest
from zerorev.collision.shapes import BODIES, capsules_of
from zerorev.motion.kinematics import forward

SAMPLES, ALONG = 4_001, 41


def sampled(robot, tool, radius, move, planes, thickness):
    """Least distance of the bodies from the part, sample by sample; and which body it is."""
    joints = move[0] + np.linspace(0, 1, SAMPLES)[:, None] * (move[1] - move[0])
    T = forward(robot, joints)
    tip, back = tool.T_flange_tcp[:3, 3], tool.T_flange_tcp[:3, 2]
    foot = tip + max(0.0, -tip @ back) * back
    wrist = np.array([0, 0, -robot.arm.c4])
    found = {}
    for body, one, other, thick in (
        ("drill", tip, foot, 0.0), ("tool", foot, np.zeros(3), 0.0), ("wrist", np.zeros(3), wrist, radius),
    ):  # fmt: skip
        points = one + np.linspace(0, 1, ALONG)[:, None] * (other - one)
        at = np.einsum("nij,kj->nki", T[:, :3, :3], points) + T[:, None, :3, 3]
        depth = np.min([at @ plane[:3] - plane[3] for plane in planes], axis=0)
        distance = -depth if thickness is None else np.abs(depth - thickness / 2) - thickness / 2
        found[body] = float(distance.min()) - thick
    return found


@pytest.mark.parametrize("seed", range(60))
def test_no_sample_is_nearer(seed):
    rng = np.random.default_rng(seed)
    drilled = random_hole(seed)
    robot, tool = drilled.robot, drilled.tool
    limits = robot.limits
    move = rng.uniform(np.maximum(limits.lower, -3), np.minimum(limits.upper, 3), (2, 6))
    if seed % 2:
        move[1] = move[0] + rng.normal(0, 0.2, 6)
    normals = rng.normal(size=(2, 3))
    normals[1] = normals[0] + 0.3 * normals[1]
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    tip = (forward(robot, move) @ tool.T_flange_tcp)[:, :3, 3]
    offset = np.einsum("pi,pi->p", normals, tip) + rng.uniform(-0.2, 0.3, 2)
    planes = np.concatenate([normals, offset[:, None]], axis=1)
    thickness = None if seed % 3 == 0 else float(rng.uniform(0.002, 0.3))
    capsules = capsules_of(robot, tool)
    (found,) = nearest(robot, capsules, move[None], planes[None], thickness)
    assert found.body in BODIES
    tried = sampled(robot, tool, capsules.radius[2], move, planes, thickness)
    assert found.clearance - EXACT <= min(tried.values())
    # a body that lies across the sheet is only met where it is sampled
    step = 0.0 if thickness is None else 2 * robot.size * 2 / ALONG
    assert min(tried.values()) <= found.clearance + 2e-4 * robot.size + step
    if thickness is None:
        assert tried[found.body] <= min(tried.values()) + 2e-4 * robot.size


def test_points_stay_within_their_reach_of_each_axis():
    """Any joint turned by a little moves a point by no more than the stated distance times the turn."""
    rng = np.random.default_rng(0)
    for seed in range(len(ROBOTS)):  # each of another robot
        drilled = random_hole(seed)
        robot, capsules = drilled.robot, capsules_of(drilled.robot, drilled.tool)
        joints = rng.uniform(-3, 3, (200, 6))
        for axis in range(6):
            turned = joints.copy()
            turned[:, axis] += 1e-6
            one, other = forward(robot, joints), forward(robot, turned)
            for body in range(3):
                for end in range(2):
                    point = capsules.ends[body, end]
                    at = [T[:, :3, :3] @ point + T[:, :3, 3] for T in (one, other)]
                    speed = np.linalg.norm(at[1] - at[0], axis=1) / 1e-6
                    assert speed.max() <= capsules.reach[body, end, axis] + 1e-6


def test_a_sheet_is_passed_by_and_is_met():
    """A line on both sides of a sheet is in it, one wholly behind it is as far away as it is behind."""
    drilled = random_hole(3)
    robot, capsules = drilled.robot, capsules_of(drilled.robot, drilled.tool)
    lines = replace(capsules, radius=0 * capsules.radius)
    joints = np.zeros((1, 2, 6))
    T = forward(robot, joints[0, 0])
    ends = (capsules.ends @ T[:3, :3].T + T[:3, 3])[..., 2]
    for height, expected in ((ends.min() - 0.3, 0.3), (ends.max() + 0.3 + 0.01, 0.3), (ends.mean(), None)):
        plane = np.array([0.0, 0.0, -1.0, -height])  # the part lies below the height, and ends 10 mm below it
        (found,) = nearest(robot, lines, joints, np.array([[plane, plane]]), 0.01)
        if expected is None:
            assert -0.005 - 1e-12 <= found.clearance <= 0
        else:
            assert found.clearance == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize("seed", range(10))
def test_ends_move_as_fast_as_is_said_and_bend_no_more(seed):
    """By differences along a move."""
    rng = np.random.default_rng(seed)
    drilled = random_hole(seed)
    robot, capsules = drilled.robot, capsules_of(drilled.robot, drilled.tool)
    move = rng.uniform(-2, 2, (1, 2, 6))
    turn = move[:, 1] - move[:, 0]
    planes = np.concatenate([rng.normal(size=(1, 2, 3)), rng.normal(size=(1, 2, 1))], axis=2)
    planes[..., :3] /= np.linalg.norm(planes[..., :3], axis=-1, keepdims=True)
    share, step = np.linspace(0.01, 0.99, 99), 1e-4

    def behind(at):
        joints = move[0, 0] + at[:, None] * turn
        return moves._behind(robot, capsules, joints, np.repeat(planes, len(at), axis=0))

    before, here, after = (behind(share + by) for by in (-step, 0.0, step))
    joints = move[0, 0] + share[:, None] * turn
    many = np.repeat(turn, 99, axis=0), np.repeat(planes, 99, axis=0)
    rates = moves._rates(robot, capsules, joints, *many)
    np.testing.assert_allclose(rates, (after - before) / (2 * step), rtol=0, atol=1e-5 * robot.size)
    _, bend = moves._sweep(np.abs(turn), capsules)
    bent = np.abs(after - 2 * here + before).max(axis=(0, 3)) / step**2
    assert (bent <= bend[0] * (1 + 1e-6)).all()
    assert (bent > 0.01 * bend[0]).any()
