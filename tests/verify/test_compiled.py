"""The check's kernels against one pose at a time; this file passes with the JIT off, too."""

import os

import numpy as np
import pytest

from oracles import check_arm as slow
from zerorev.model.hole import Hole
from zerorev.verify import compiled
from zerorev.verify.arm import Posture, posture_of
from zerorev.verify.path import Path, follow, residual

SLOW = os.environ.get("NUMBA_DISABLE_JIT") == "1"
SAMPLES = 2 * compiled.BLOCK + 7  # whole blocks, and a part of one


def random_joints(robot, count, seed):
    rng = np.random.default_rng(seed)
    return rng.uniform(robot.limits.lower, robot.limits.upper, (count, 6))


def standing(robot, tool, seed):
    """Joints, and the hole at which the robot then stands."""
    joints = random_joints(robot, 1, seed)[0]
    T = slow.forward(robot.arm, joints) @ tool.T_flange_tcp
    return joints, Hole("here", T[:3, 3], -T[:3, 2], 0.01, psi_zero=T[:3, 1])


def apart(a, b):
    """How far angles are from each other [rad], but for whole turns."""
    return np.abs(np.angle(np.exp(1j * (a - b))))


class TestSineAndArctangent:
    def test_cosine_and_sine(self):
        x = np.random.default_rng(0).uniform(-20, 20, 500 if SLOW else 100_000)
        x = np.concatenate([x, np.arange(-26, 27) * np.pi / 4, [0.0, -0.0, 1e-300, np.pi, -np.pi]])
        found = np.array([compiled.cos_sin(value) for value in x])
        np.testing.assert_allclose(found, np.transpose([np.cos(x), np.sin(x)]), rtol=0, atol=2.5e-16)

    def test_arctangent(self):
        angle = np.random.default_rng(1).uniform(-np.pi, np.pi, 500 if SLOW else 100_000)
        angle = np.concatenate([angle, np.arange(-7, 8) * np.pi / 8, np.arange(-7, 8) * np.pi / 8 + 1e-15])
        size = np.exp(np.random.default_rng(2).uniform(-30, 3, angle.size))
        y, x = size * np.sin(angle), size * np.cos(angle)
        found = np.array([compiled.angle_of(*pair) for pair in zip(y, x, strict=True)])
        np.testing.assert_allclose(found, np.arctan2(y, x), rtol=0, atol=4.5e-16)

    def test_small_angles_keep_their_digits(self):
        y = np.geomspace(1e-12, 1e-2, 50)
        found = np.array([compiled.angle_of(value, np.float64(2.0)) for value in y])
        np.testing.assert_allclose(found, np.arctan2(y, 2.0), rtol=3e-16, atol=0)

    def test_of_no_angle_is_none(self):
        with np.errstate(invalid="ignore"):
            assert np.isnan(compiled.cos_sin(np.float64(np.nan))).all()
            assert np.isnan(compiled.angle_of(np.float64(0.0), np.float64(0.0)))


def test_forward_is_the_product_of_elementary_motions(robot):
    joints = random_joints(robot, SAMPLES, 1)
    body = np.empty((4, 3, SAMPLES))
    compiled.forward(robot.arm, np.ascontiguousarray(joints.T), body)
    for k, row in enumerate(joints):
        T = slow.forward(robot.arm, row)
        np.testing.assert_allclose(body[:3, :, k].T, T[:3, :3], atol=2e-15)
        np.testing.assert_allclose(body[3, :, k], T[:3, 3] - robot.arm.c4 * T[:3, 2], atol=3e-15)


@pytest.mark.parametrize("seed", range(3))
def test_inverse_is_that_of_one_pose_at_a_time(robot, drill, seed):
    """In all eight postures, those out of reach among them."""
    start, hole = standing(robot, drill, seed)
    standoff, psi = np.linspace(0, 0.02, SAMPLES), np.linspace(-3.0, 3.0, SAMPLES)
    for signs in np.ndindex(2, 2, 2):
        posture = Posture(*(1.0 - 2.0 * s for s in signs))
        with np.errstate(all="ignore"):
            found = follow(robot, drill, hole, Path(standoff, psi, (), 0), posture, start)
            slowly = [
                slow.backward(robot.arm, slow.pose(drill, hole, s, p), posture)
                for s, p in zip(standoff, psi, strict=True)
            ]
        out = np.isnan(slowly)
        np.testing.assert_array_equal(np.isnan(found), out)
        off = np.where(out, 0.0, apart(found, np.array(slowly)))
        # next to the end of the reach and to a straight wrist the angles are ill-conditioned, not wrong
        assert np.median(off) < 1e-14
        assert off.max() < 1e-8


def test_inverse_goes_through_the_joints_that_it_started_from(robot, drill):
    start, hole = standing(robot, drill, 5)
    path = Path(np.zeros(1), np.zeros(1), (), 0)
    found = follow(robot, drill, hole, path, posture_of(robot.arm, start), start)
    np.testing.assert_allclose(found[0], start, atol=1e-9)


def test_residual_is_the_distance_of_two_poses(robot, drill):
    """Joints that are not those of the path, so that there is something to measure."""
    _, hole = standing(robot, drill, 7)
    rng = np.random.default_rng(7)
    path = Path(rng.uniform(0, 0.02, SAMPLES), rng.uniform(-9.0, 9.0, SAMPLES), (), 0)
    joints = random_joints(robot, SAMPLES, 8)
    position, rotation = residual(robot, drill, hole, path, joints)
    for k, row in enumerate(joints):
        reached = slow.forward(robot.arm, row) @ drill.T_flange_tcp
        asked = slow.pose(drill, hole, path.standoff[k], path.psi[k]) @ drill.T_flange_tcp
        assert position[k] == pytest.approx(np.linalg.norm(reached[:3, 3] - asked[:3, 3]), rel=1e-12)
        turned = np.arccos(np.clip((np.trace(reached[:3, :3].T @ asked[:3, :3]) - 1) / 2, -1, 1))
        assert rotation[k] == pytest.approx(turned, abs=1e-7)


def test_residual_sees_the_smallest_of_errors(kuka, drill, published):
    plan = published(1)
    profile, hole = plan.motion.profile, plan.hole
    path = Path(profile.standoff, profile.psi, (), profile.corner)
    for joint in range(6):
        for off in (1e-9, 1e-6):
            joints = plan.motion.joints + off * np.eye(6)[joint]
            position, rotation = residual(kuka, drill, hole, path, joints)
            assert (position.max() > 0.01 * off) or (rotation.max() > 0.5 * off)
            assert rotation.max() == pytest.approx(off, rel=1e-5)


def test_out_of_reach_and_singular_are_nan(kuka, drill):
    _, hole = standing(kuka, drill, 1)
    far = Hole("far", [*hole.target[:2], 9.0], hole.direction, 0.01, psi_zero=hole.psi_zero)
    path = Path(np.zeros(3), np.linspace(0, 1, 3), (), 0)
    with np.errstate(all="ignore"):
        found = follow(kuka, drill, far, path, Posture(1.0, 1.0, 1.0), np.zeros(6))
    assert np.isnan(found).any(axis=1).all()
