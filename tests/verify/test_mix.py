"""The sampled blends with any curve, against finite differences of the kernels' joints."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from oracles.mixes import outermost, places, velocities
from zerorev.files.io import read_robot, read_tool
from zerorev.model.profile import Profile
from zerorev.model.settings import Settings
from zerorev.planning.hole import plan
from zerorev.verify.mix import mix_holds, mixed

ROBOT, TOOL = read_robot("kuka_kr6_r700_2"), read_tool("thesis_drill")
MIXES = ("any", "one_way")


@pytest.fixture(scope="module")
def plans(positions):
    return [plan(ROBOT, TOOL, each.hole, Settings(proof_boxes=0)) for each in positions]


def parts_of(found):
    return ROBOT, TOOL, found.hole, found.motion.profile, found.motion.joints


@pytest.mark.parametrize("radius", [1e-3, 5e-3, 40e-3])
@pytest.mark.parametrize("mixes", MIXES)
def test_the_slowest_mix(plans, mixes, radius):
    for found in plans:
        cut = min(radius, found.hole.depth / 2)
        left, done = cut * places(65)
        ways = np.sign(np.diff(found.motion.joints[[0, -1]], axis=0)[0])
        before, behind = velocities((ROBOT, TOOL, found), left, done) * ways
        weights = outermost(mixes, cut, left, done)
        rates = weights[:, 0, :, None] * before + weights[:, 1, :, None] * behind
        least = np.nanmin(rates, axis=(0, 1))
        sampled = mixed(*parts_of(found), 1, radius, mixes, points=65)
        np.testing.assert_allclose(sampled.slowest, least, rtol=0.02, atol=0.02)
        # where it is said to be, it is
        for joint in range(6):
            at = np.array([sampled.left[joint]]), np.array([sampled.done[joint]])
            first, second = velocities((ROBOT, TOOL, found), *at)[:, 0, joint] * ways[joint]
            share = sampled.share[joint]
            assert share * first + (1 - share) * second == pytest.approx(sampled.slowest[joint], abs=1e-4)
        turned = [name for name, rate in zip(ROBOT.joint_names, sampled.slowest, strict=True) if rate < 0]
        said = list(mix_holds(*parts_of(found), 1, radius, mixes, points=65))
        assert [sentence.split()[4] for sentence in said] == turned


def test_the_words(plans):
    assert list(mix_holds(*parts_of(plans[1]), 1, 2e-3)) == []
    assert list(mix_holds(*parts_of(plans[1]), 1, 5e-3)) == [
        "in the blended corner, A6 turns round in a blend with 5 mm of the plunge left, 0 mm of the retract done, and "
        "0 % of its velocity from the plunge"
    ]
    assert list(mix_holds(*parts_of(plans[1]), 1, 5e-3, "one_way")) == []


def test_a_joint_that_turns_round_without_a_blend_is_left_out(plans):
    found = plans[0]
    profile = found.motion.profile
    held = Profile(profile.standoff, np.full(3, profile.psi[1]))
    sampled = mixed(ROBOT, TOOL, found.hole, held, found.motion.joints[[1, 1, 1]], 1, 2e-3)
    assert np.isnan(sampled.slowest).all()
    assert list(mix_holds(ROBOT, TOOL, found.hole, held, found.motion.joints[[1, 1, 1]], 1, 2e-3)) == []


def test_a_blend_within_a_leg(plans):
    """A bend of the spin that a joint just stands."""
    found = plans[0]
    plain = found.motion.profile
    standoff = np.array([50, 30, 10, 0, 50]) * 1e-3
    psi = np.array([*np.interp(standoff[:4], [0, 50e-3], plain.psi[1::-1]), plain.psi[2]])
    psi[2] -= 0.02
    joints = np.repeat(found.motion.joints[1:2], 5, axis=0)
    bent = ROBOT, TOOL, found.hole, Profile(standoff, psi), joints
    assert list(mix_holds(*bent, 2, 2e-3, "one_way")) == []
    assert list(mix_holds(*bent, 2, 2e-3)) == [
        "in the blend at breakpoint 3, A2 turns round in a blend with 0 mm of the move before left, 2 mm of the move "
        "behind done, and 100 % of its velocity from the move before"
    ]


def test_out_of_reach(plans):
    found = plans[0]
    far = replace(found.hole, target=found.hole.target + np.array([0.4, 0.0, 0.0]))
    said = list(mix_holds(ROBOT, TOOL, far, found.motion.profile, found.motion.joints, 1, 1e-3))
    assert said == ["in the blended corner, out of reach or singular at some place between entry, bend and exit"]
