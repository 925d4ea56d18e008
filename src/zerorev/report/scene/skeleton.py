"""The robot as a few lines: base, shoulder, elbow, wrist, flange, tip of the tool."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from zerorev.model._arrays import Array
from zerorev.model.robot import Robot
from zerorev.model.tool import Tool
from zerorev.motion.drilling import Drilling
from zerorev.motion.kinematics import forward

__all__ = ["home", "joints_at", "skeleton"]


def home(robot: Robot) -> Array:
    """Joints [rad], shape (6,), of the arm with its upper arm upright and its forearm ahead."""
    upright_and_ahead = np.deg2rad([0.0, 0.0, 90.0, 0.0, 0.0, 0.0])
    return np.asarray((upright_and_ahead + np.array(robot.arm.offset)) * np.array(robot.arm.sign))


def joints_at(drilling: Drilling, psi: float, branch: int) -> Array | None:
    """Joints [rad], shape (6,), with the drill at the bottom of a hole, or None where the branch cannot reach.

    Args:
        drilling: robot, tool and hole: target, direction and reference of the spin.
        psi: spin [rad].
        branch: 0..7.
    """
    joints = drilling.angles(0.0, psi)[branch]
    return None if np.isnan(joints).any() else np.asarray(joints)


def skeleton(robot: Robot, tool: Tool, joints: npt.ArrayLike) -> Array:
    """Places [m] along the arm in the base frame, shape (8, 3).

    Foot, height of the shoulder, shoulder, elbow, where the forearm begins beyond the elbow's offset, wrist centre,
    flange, tip of the tool.

    Args:
        robot: the arm.
        tool: the drill.
        joints: as the controller shows them [rad], shape (6,).
    """
    arm = robot.arm
    q = np.asarray(joints, dtype=float) * np.array(arm.sign) - np.array(arm.offset)
    T = forward(robot, joints)
    up, ahead = np.array([0.0, 0.0, 1.0]), np.array([np.cos(q[0]), np.sin(q[0]), 0.0])
    aside = np.cross(up, ahead)
    bend = q[1] + q[2]
    below = np.cos(bend) * ahead - np.sin(bend) * up
    shoulder = arm.a1 * ahead + arm.c1 * up
    # where the arm stands aside of its first axis, the upper arm is drawn there
    elbow = shoulder + arm.c2 * (np.cos(q[1]) * up + np.sin(q[1]) * ahead) + arm.b * aside
    flange = T[:3, 3]
    tip = T[:3, :3] @ tool.T_flange_tcp[:3, 3] + flange
    places = (
        np.zeros(3), arm.c1 * up, shoulder, elbow, elbow + arm.a2 * below, flange - arm.c4 * T[:3, 2], flange, tip,
    )  # fmt: skip
    return np.array(places)
