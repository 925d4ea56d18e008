"""The skeleton has the arm's lengths, ends at the tip, and stands where the hole is."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from oracles.published import POSITIONS
from zerorev.motion.drilling import Drilling
from zerorev.report.scene.skeleton import home, joints_at, skeleton


@pytest.mark.parametrize("seed", range(4))
def test_links_are_as_long_as_the_arm_says(any_robot, tool, seed):
    joints = np.random.default_rng(seed).uniform(-3, 3, 6)
    arm = any_robot.arm
    lengths = np.linalg.norm(np.diff(skeleton(any_robot, tool, joints), axis=0), axis=1)
    reach = np.linalg.norm(tool.T_flange_tcp[:3, 3])
    wanted = (arm.c1, abs(arm.a1), np.hypot(arm.c2, arm.b), abs(arm.a2), arm.c3, arm.c4, reach)
    # the forearm joins two points that come from different formulas: forward kinematics and the links
    np.testing.assert_allclose(lengths, wanted, atol=1e-12)


def test_at_home_the_upper_arm_is_upright_and_the_forearm_ahead(any_robot, tool):
    places = skeleton(any_robot, tool, home(any_robot))
    arm = any_robot.arm
    np.testing.assert_allclose(places[3] - places[2], (0, arm.b, arm.c2), atol=1e-12)
    np.testing.assert_allclose(places[5] - places[4], (arm.c3, 0, 0), atol=1e-12)


def test_it_stands_in_the_published_postures(robot, tool):
    for position in POSITIONS:
        joints = joints_at(Drilling(robot, tool, position.hole), position.profile.psi[1], position.branch)
        apart = np.rad2deg(joints) - position.axis_deg[1]
        np.testing.assert_allclose(apart, 360 * np.round(apart / 360), atol=0.01)
        np.testing.assert_allclose(skeleton(robot, tool, joints)[-1] * 1e3, position.target_mm, atol=1e-9)
    far = replace(POSITIONS[0].hole, target=np.array([9.0, 0.0, 0.0]))
    assert joints_at(Drilling(robot, tool, far), 0.0, 4) is None
