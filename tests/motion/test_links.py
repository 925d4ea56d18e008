"""The chain of the arm and its link frames, against elementary transforms and the forward kinematics."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from oracles import arm as naive
from zerorev.motion.kinematics import forward
from zerorev.motion.links import chain, link_frames

ROWS = 40


@pytest.fixture(scope="module")
def joints():
    return np.random.default_rng(5).uniform(-3, 3, (ROWS, 6))


def aside(robot, b):
    """The robot with its arm standing aside of axis 1."""
    return replace(robot, arm=robot.arm._replace(b=b))


def test_frames_are_the_products_of_elementary_transforms(any_robot, joints):
    frames = link_frames(any_robot, joints)
    assert frames.shape == (ROWS, 6, 4, 4)
    for row, found in zip(joints, frames, strict=True):
        before, flange = naive.joint_frames(any_robot, row)
        turned = naive.model_angles(any_robot, row)
        for i, (T, axis) in enumerate(before):
            expected = flange if i == 5 else T @ naive.rotation(axis, turned[i])
            assert found[i] == pytest.approx(expected, abs=1e-12), f"link {i + 1}"


@pytest.mark.parametrize("b", [0.0, 0.04])
def test_the_last_frame_is_the_flange(any_robot, joints, b):
    robot = aside(any_robot, b)
    assert link_frames(robot, joints)[:, 5] == pytest.approx(forward(robot, joints), abs=1e-12)


def test_each_frame_lies_on_the_axis_of_its_joint(any_robot, joints):
    """A frame and its axis stay where they are while only that joint turns."""
    for i, joint in enumerate(chain(any_robot)):
        moved = joints.copy()
        moved[:, i] += 0.7
        before, after = (link_frames(any_robot, q)[:, i] for q in (joints, moved))
        assert after[:, :3, 3] == pytest.approx(before[:, :3, 3], abs=1e-12)
        assert after[:, :3, joint.axis] == pytest.approx(before[:, :3, joint.axis], abs=1e-12)
