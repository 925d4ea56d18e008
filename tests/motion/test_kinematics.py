"""The typed face of the kernels: frames, shapes, and the twist plane's figures."""

from __future__ import annotations

import numpy as np
import pytest

from oracles import arm as twin
from zerorev.errors import InputError
from zerorev.model.hole import Hole
from zerorev.model.tool import Tool
from zerorev.motion import kinematics
from zerorev.motion.critical import kappa_of
from zerorev.motion.drilling import Drilling, joint_rates

TILTED = Hole("tilted", np.array([0.45, 0.1, 0.7]), np.array([1.0, 0.4, -0.3]), 0.03)


def test_z_points_against_the_plunge_and_the_standoff_backs_out_along_it():
    T = kinematics.tcp_pose(TILTED, [0.0, 0.02], 0.3)
    np.testing.assert_allclose(T[:, :3, 2], [-TILTED.direction] * 2, atol=1e-15)
    np.testing.assert_allclose(T[:, :3, 3], [TILTED.target, TILTED.target - 0.02 * TILTED.direction], atol=1e-15)


def test_psi_is_counted_right_handed_about_z_from_psi_zero():
    for psi in np.linspace(-np.pi, np.pi, 7):
        np.testing.assert_allclose(
            kinematics.tcp_pose(TILTED, 0.01, psi), twin.drill_pose(TILTED, 0.01, psi), atol=1e-15
        )
    np.testing.assert_allclose(kinematics.tcp_pose(TILTED, 0.0, 0.0)[:3, 1], TILTED.psi_zero, atol=1e-15)


def test_poses_take_the_broadcast_shape_of_standoff_and_psi():
    assert kinematics.tcp_pose(TILTED, np.zeros((5, 1)), np.zeros(3)).shape == (5, 3, 4, 4)


def test_forward_and_inverse_take_any_batch(robot):
    joints = np.tile([0.1, -1.2, 1.1, 0.3, 0.5, 0.7], (2, 3, 1))
    T = kinematics.forward(robot, joints)
    assert T.shape == (2, 3, 4, 4)
    assert kinematics.inverse(robot, T).shape == (2, 3, 8, 6)
    assert kinematics.inverse(robot, T[0, 0]).shape == (8, 6)


def test_what_is_not_a_joint_vector_or_no_pose_is_refused_with_its_shape(robot):
    with pytest.raises(InputError, match=r"\(2, 5\).*\(\.\.\., 6\)"):
        kinematics.forward(robot, np.zeros((2, 5)))
    with pytest.raises(InputError, match=r"\(2, 5\).*\(\.\.\., 6\)"):
        kinematics.jacobian(robot, Tool.from_mm_deg((0, 0, 0), (0, 0, 0)), np.zeros((2, 5)))
    with pytest.raises(InputError, match=r"\(3, 3\).*\(\.\.\., 4, 4\)"):
        kinematics.inverse(robot, np.eye(3))


def test_the_jacobian_is_how_the_tip_moves_by_differences_of_the_forward_kinematics(any_robot):
    bent = Tool.from_mm_deg((30, -40, 150), (10, -120, 25))
    joints, step = np.random.default_rng(7).uniform(-3, 3, (20, 6)), 1e-6
    J = kinematics.jacobian(any_robot, bent, joints)
    assert J.shape == (20, 6, 6)

    def tcp(joints):
        return kinematics.forward(any_robot, joints) @ bent.T_flange_tcp

    for i in range(6):
        ahead, behind = (tcp(joints + sign * step * np.eye(6)[i]) for sign in (1, -1))
        np.testing.assert_allclose(J[:, :3, i], (ahead - behind)[:, :3, 3] / (2 * step), atol=1e-8)
        turning = (ahead - behind)[:, :3, :3] / (2 * step) @ np.swapaxes(tcp(joints)[:, :3, :3], 1, 2)
        np.testing.assert_allclose(J[:, 3:, i], turning[:, [2, 0, 1], [1, 2, 0]], atol=1e-8)


def test_the_jacobian_undoes_the_two_rate_fields(robot, tool, position):
    theta_s, theta_psi = (field[position.branch] for field in joint_rates(
        Drilling(robot, tool, position.hole), 0.01, position.profile.psi[1]))  # fmt: skip
    pose = kinematics.tcp_pose(position.hole, 0.01, position.profile.psi[1]) @ np.linalg.inv(tool.T_flange_tcp)
    J = kinematics.jacobian(robot, tool, kinematics.inverse(robot, pose)[position.branch])
    np.testing.assert_allclose(J @ theta_s, [-1, 0, 0, 0, 0, 0], atol=1e-12)
    np.testing.assert_allclose(J @ theta_psi, [0, 0, 0, -1, 0, 0], atol=1e-12)


def test_the_thesis_tool_has_a_lever_of_155_mm(robot, tool):
    assert kinematics.wrist_offset(robot, tool) == pytest.approx(0.155, abs=1e-12)


def test_the_lever_is_the_distance_of_the_wrist_centre_from_the_drill_axis(any_robot):
    bent = Tool.from_mm_deg((30, -40, 150), (10, -120, 25))
    T = np.linalg.inv(twin.forward(any_robot, np.zeros(6)) @ bent.T_flange_tcp)
    frames, _ = twin.joint_frames(any_robot, np.zeros(6))
    wrist = T @ frames[4][0][:, 3]
    assert kinematics.wrist_offset(any_robot, bent) == pytest.approx(np.hypot(*wrist[:2]), abs=1e-12)


def test_critical_rates_of_position_1(robot, tool, positions):
    first = positions[0]
    kappa = kappa_of(*joint_rates(Drilling(robot, tool, first.hole), 0.0, first.profile.psi[1]))[first.branch]
    in_deg_per_mm = np.rad2deg(kappa) / 1e3
    np.testing.assert_allclose(in_deg_per_mm, [0.2936, -0.4797, -0.4367, -0.0049, 0.1663, 0.3877], atol=5e-5)
    outwards = np.rad2deg(first.profile.twist_rate) / 1e3
    np.testing.assert_allclose(outwards, [0.402, -0.490], atol=5e-4)
    assert outwards[0] > in_deg_per_mm.max() > in_deg_per_mm.min() > outwards[1]


def test_a_joint_stands_still_at_its_critical_rate(robot, tool, position):
    standoff, psi = np.meshgrid(np.linspace(0, position.depth_mm / 1e3, 4), np.linspace(-3, 3, 5))
    theta_s, theta_psi = joint_rates(Drilling(robot, tool, position.hole), standoff, psi)
    kappa = kappa_of(*joint_rates(Drilling(robot, tool, position.hole), standoff, psi))
    still = theta_s + kappa * theta_psi
    assert np.nanmax(np.abs(still) / (1 + np.abs(theta_s))) < 1e-12


def test_rates_out_of_reach_are_nan(robot, tool):
    far = Hole("far", np.array([3.0, 0.0, 0.5]), np.array([1.0, 0.0, 0.0]), 0.01)
    assert np.isnan(joint_rates(Drilling(robot, tool, far), 0.0, 0.0)).all()
    assert np.isnan(kappa_of(*joint_rates(Drilling(robot, tool, far), 0.0, 0.0))).all()
