"""Whole motions against their slow twin: reversals and their places, slowest motion, extents, angles moved."""

from __future__ import annotations

import numpy as np
import pytest

from oracles.motion import dense
from oracles.starts import SLOW, TOOL, starts
from zerorev.kernels import motion as kernels
from zerorev.model.profile import Profile
from zerorev.motion.drilling import Drilling

JUMP = 0.5
DENSE = 300 if SLOW else 4000


def turning(robot, hole, profile, branch, room=64):
    plane, slowest, turns = Drilling(robot, TOOL, hole).plane, np.empty(6), np.full((room, 3), np.nan)
    count = kernels.turning_points(
        robot.arm, plane, branch, profile.standoff, profile.psi, profile.corner, robot.nil_rate, slowest, turns
    )
    return count, slowest, turns


def followed(robot, hole, profile, branch, turns, samples=300):
    plane = Drilling(robot, TOOL, hole).plane
    joints, low, high, moved = np.empty((profile.psi.size, 6)), np.empty(6), np.empty(6), np.empty((2, 6))
    runs = kernels.follow(
        robot.arm, plane, branch, profile.standoff, profile.psi, profile.corner, samples, turns, JUMP,
        joints, low, high, moved,
    )  # fmt: skip
    return runs, joints, low, high, moved


def motions(count, seed):
    """Motions of two to six segments, from hardly spinning to steep, on the branch that reaches the hole."""
    rng = np.random.default_rng(seed)
    for start in starts(count, seed):
        inner = [np.sort(rng.uniform(0.1, 0.9, rng.integers(0, 3))) * start.hole.depth for _ in range(2)]
        standoff = np.concatenate([[start.hole.depth], inner[0][::-1], [0.0], inner[1], [start.hole.depth]])
        slopes = rng.normal(size=standoff.size - 1) * rng.choice([1.0, 10.0, 40.0])
        psi = start.psi_t + np.concatenate([[0.0], np.cumsum(slopes * np.diff(standoff))])
        yield start, Profile(standoff, psi)


def between(place, profile):
    """Segment and fraction -> stand-off."""
    k, x = int(place[0]), place[1]
    return profile.standoff[k] + x * (profile.standoff[k + 1] - profile.standoff[k])


def test_reversals_and_slowest_motion_are_those_of_dense_samples():
    compared = turned = 0
    for start, profile in motions(1 if SLOW else 8, seed=3):
        twin = dense(start.robot, TOOL, start.hole, profile, start.branch, DENSE)
        if twin is None or np.abs(np.diff(twin.joints, axis=0)).max() > 0.05:
            continue  # out of reach, or so close to a singularity that samples show little
        count, slowest, turns = turning(start.robot, start.hole, profile, start.branch)
        places = twin.turns
        assert count == sum(map(len, places))
        step = np.abs(np.diff(twin.standoff)).max()
        for joint in range(6):
            mine = sorted(tuple(turn[1:]) for turn in turns[:count].tolist() if turn[0] == joint + 1)
            found = [between(place, profile) for place in mine]
            np.testing.assert_allclose(found, twin.standoff[places[joint]], rtol=0, atol=2.01 * step)
            if not places[joint]:
                assert slowest[joint] == pytest.approx(twin.slowest[joint], rel=0.05, abs=0.02)
        compared, turned = compared + 1, turned + count
    assert compared >= (2 if SLOW else 25)
    assert turned >= (2 if SLOW else 60)


def test_what_goes_beyond_the_room_is_counted():
    start, profile = next(
        (start, profile)
        for start, profile in motions(2, seed=3)
        if turning(start.robot, start.hole, profile, start.branch)[0] > 2
    )
    count, _, turns = turning(start.robot, start.hole, profile, start.branch)
    again, _, few = turning(start.robot, start.hole, profile, start.branch, room=2)
    assert again == count
    np.testing.assert_array_equal(few, turns[:2])


def test_a_place_at_a_breakpoint_is_fraction_zero():
    """Constant spin turns joints round at the corner itself."""
    for start, _ in motions(1, seed=5):
        depth = start.hole.depth
        count, _, turns = turning(start.robot, start.hole, Profile.straight(depth, *[start.psi_t] * 3), start.branch)
        at_corner = turns[:count][(turns[:count, 1] == 1) & (turns[:count, 2] == 0.0)]
        assert len(at_corner) >= 3


def test_extents_and_angles_moved_are_those_of_dense_samples():
    compared = 0
    for start, profile in motions(1 if SLOW else 8, seed=4):
        twin = dense(start.robot, TOOL, start.hole, profile, start.branch, DENSE)
        if twin is None or np.abs(np.diff(twin.joints, axis=0)).max() > 0.02:
            continue
        count, _, turns = turning(start.robot, start.hole, profile, start.branch)
        order = sorted(tuple(turn[1:]) for turn in turns[:count].tolist() if turn[2] > 0)
        runs, joints, low, high, moved = followed(
            start.robot, start.hole, profile, start.branch, np.array(order).reshape(-1, 2)
        )
        assert runs
        rows = DENSE * np.arange(profile.psi.size)
        np.testing.assert_allclose(joints, twin.joints[rows], rtol=0, atol=1e-10)
        # at its turning points a joint is exact; dense samples are below by the bend of a step
        short = 1e-4 if SLOW else 1e-6
        np.testing.assert_allclose(low, twin.joints.min(axis=0), rtol=0, atol=short)
        np.testing.assert_allclose(high, twin.joints.max(axis=0), rtol=0, atol=short)
        np.testing.assert_allclose(moved, twin.moved, rtol=0, atol=10 * short)
        assert (low <= twin.joints.min(axis=0) + 1e-12).all()
        assert (moved >= twin.moved - 1e-10).all()
        compared += 1
    assert compared >= (2 if SLOW else 25)


def test_a_jump_between_samples_is_not_a_motion_however_many_points_lie_in_it():
    """The step of one sample is cut in two by a further point; the joints still go as far from sample to sample."""
    start, _ = next(motions(1, seed=6))
    depth, none = start.hole.depth, np.empty((0, 2))
    swung = Profile.straight(depth, start.psi_t + 2.0, start.psi_t, start.psi_t + 0.1)
    fine = followed(start.robot, start.hole, swung, start.branch, none, samples=2000)
    assert fine[0]
    coarse = followed(start.robot, start.hole, swung, start.branch, none, samples=4)
    further = np.array([[0.0, x] for x in np.linspace(0.01, 0.99, 41)])
    assert not coarse[0]
    assert not followed(start.robot, start.hole, swung, start.branch, further, samples=4)[0]


def test_out_of_reach_is_not_a_motion():
    start, profile = next(motions(1, seed=6))
    far = Profile(profile.standoff + 9.0, profile.psi)
    assert not followed(start.robot, start.hole, far, start.branch, np.empty((0, 2)))[0]
