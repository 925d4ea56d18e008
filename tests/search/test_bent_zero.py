"""A joint 5 that does not show 0 where the wrist is straight: the same motions, counted otherwise."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from zerorev.model.job import Job
from zerorev.model.robot import JointLimits, Robot
from zerorev.model.settings import Settings
from zerorev.motion.kinematics import forward, inverse
from zerorev.planning.job import plan_job
from zerorev.planning.restated import check_plan
from zerorev.verify.arm import branch_of

BENT = np.deg2rad(-90.0)


@pytest.fixture(scope="module", params=[1.0, -1.0], ids=["as it is", "the other way"])
def pair(request, robot) -> tuple[Robot, Robot]:
    """The thesis' arm with joint 5 counted either way, and the same with an offset."""
    sign = (*robot.arm.sign[:4], request.param, robot.arm.sign[5])
    straight = replace(robot, arm=robot.arm._replace(sign=sign), dynamics=None)
    offset = (*robot.arm.offset[:4], BENT, robot.arm.offset[5])
    moved = np.array([0, 0, 0, 0, request.param * BENT, 0])
    limits = straight.limits
    bent = replace(
        straight,
        arm=straight.arm._replace(offset=offset),
        limits=JointLimits(limits.lower + moved, limits.upper + moved, limits.speed, limits.acceleration),
    )
    return straight, bent


def test_poses_and_branches_are_the_same(pair):
    straight, bent = pair
    moved = np.array([0, 0, 0, 0, bent.arm.sign[4] * BENT, 0])
    joints = np.random.default_rng(3).uniform(straight.limits.lower, straight.limits.upper, (200, 6))
    np.testing.assert_allclose(forward(bent, joints + moved), forward(straight, joints), atol=1e-12)
    there, here = inverse(bent, forward(straight, joints)), inverse(straight, forward(straight, joints))
    np.testing.assert_allclose(np.angle(np.exp(1j * (there - moved - here))), 0 * here, atol=1e-9)
    np.testing.assert_allclose(bent.bend(joints + moved), straight.bend(joints), atol=1e-12)
    for q in joints:
        assert branch_of(bent.arm, q + moved) == branch_of(straight.arm, q)


def test_plans_are_the_same_and_hold_in_the_check(pair, tool, positions):
    straight, bent = pair
    moved = np.array([0, 0, 0, 0, bent.arm.sign[4] * BENT, 0])
    holes = tuple(replace(position.hole, branch=None) for position in positions)
    one, other = (plan_job(Job(arm, tool, holes, Settings(proof_boxes=2000))) for arm in (straight, bent))
    for a, b in zip(one.holes, other.holes, strict=True):
        assert a.motion is not None
        assert b.motion is not None
        assert a.motion.branch == b.motion.branch
        np.testing.assert_allclose(a.motion.profile.psi, b.motion.profile.psi, atol=1e-7)
        np.testing.assert_allclose(a.motion.joints + moved, b.motion.joints, atol=1e-6)
        assert a.score.reversals == b.score.reversals
        assert b.verified.passed
    assert not check_plan(other).wrong
