"""The typed, shape-checked face of `kernels.arm`: poses and joints."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from zerorev.errors import InputError
from zerorev.kernels import arm as kernels
from zerorev.model._arrays import Array
from zerorev.model.hole import Hole
from zerorev.model.robot import Robot
from zerorev.model.tool import Tool

__all__ = [
    "forward",
    "inverse",
    "jacobian",
    "tcp_pose",
    "wrist_in_tcp",
    "wrist_offset",
]


def wrist_in_tcp(robot: Robot, tool: Tool) -> Array:
    """The wrist centre in the tcp frame [m], shape (3,) (theory §1)."""
    R, tip = tool.T_flange_tcp[:3, :3], tool.T_flange_tcp[:3, 3]
    return np.asarray(R.T @ (np.array([0.0, 0.0, -robot.arm.c4]) - tip))


def wrist_offset(robot: Robot, tool: Tool) -> float:
    """Distance e [m] of the wrist centre from the drill axis, the lever of the spin (theory §1)."""
    wrist = wrist_in_tcp(robot, tool)
    return float(np.hypot(wrist[0], wrist[1]))


def tcp_pose(hole: Hole, standoff: npt.ArrayLike, psi: npt.ArrayLike) -> Array:
    """T_base_tcp at stand-offs [m] and spins [rad] of one broadcast shape (...,); returns (..., 4, 4)."""
    standoff, psi = np.broadcast_arrays(np.asarray(standoff, dtype=float), np.asarray(psi, dtype=float))
    z, y0 = -hole.direction, hole.psi_zero
    x0 = np.cross(y0, z)
    c, s = np.cos(psi)[..., None], np.sin(psi)[..., None]
    T = np.zeros((*psi.shape, 4, 4))
    T[..., :3, 0] = c * x0 + s * y0
    T[..., :3, 1] = c * y0 - s * x0
    T[..., :3, 2] = z
    T[..., :3, 3] = hole.target + standoff[..., None] * z
    T[..., 3, 3] = 1.0
    return T


def forward(robot: Robot, joints: npt.ArrayLike) -> Array:
    """Flange poses T_base_flange, shape (..., 4, 4), of controller angles [rad], shape (..., 6).

    Raises:
        InputError: the last axis is not of six joints.
    """
    joints = np.asarray(joints, dtype=float)
    if joints.shape[-1:] != (6,):
        raise InputError(f"joints of shape {joints.shape}", accepted="(..., 6)")
    flat = np.ascontiguousarray(joints.reshape(-1, 6))
    out = np.empty((len(flat), 4, 4))
    kernels.forward(robot.arm, flat, out)
    return out.reshape(*joints.shape[:-1], 4, 4)


def inverse(robot: Robot, T_base_flange: npt.ArrayLike) -> Array:
    """Controller angles within (-pi, pi], shape (..., 8, 6), of flange poses (..., 4, 4).

    All eight branches in their fixed order (conventions: branch), a row of NaN where one cannot reach. Joint limits are
    not examined.

    Raises:
        InputError: the last axes are not a pose.
    """
    T = np.asarray(T_base_flange, dtype=float)
    if T.shape[-2:] != (4, 4):
        raise InputError(f"poses of shape {T.shape}", accepted="(..., 4, 4)")
    flat = np.ascontiguousarray(T.reshape(-1, 4, 4))
    out = np.empty((len(flat), 8, 6))
    kernels.inverse(robot.arm, flat, out)
    return out.reshape(*T.shape[:-2], 8, 6)


def jacobian(robot: Robot, tool: Tool, joints: npt.ArrayLike) -> Array:
    """Geometric Jacobian at the TCP, base frame, shape (..., 6, 6), of controller angles [rad], shape (..., 6).

    Rows: velocity of the TCP [m/rad], then angular velocity of the tool [1]; columns: the joints as the controller
    counts them.

    Raises:
        InputError: the last axis is not of six joints.
    """
    T = forward(robot, joints)
    arm, sign = robot.arm, np.array(robot.arm.sign)
    q = np.asarray(joints, dtype=float) * sign - np.array(arm.offset)
    c, s = np.cos(q), np.sin(q)
    zero, one = np.zeros(q.shape[:-1]), np.ones(q.shape[:-1])

    def vector(x: Array, y: Array, z: Array) -> Array:
        return np.stack([x, y, z], axis=-1)

    up, ahead = vector(zero, zero, one), vector(c[..., 0], s[..., 0], zero)
    aside = np.cross(up, ahead)  # axes 2 and 3
    upper_arm = c[..., 1, None] * up + s[..., 1, None] * ahead
    bend = q[..., 1] + q[..., 2]
    forearm, below = (
        np.cos(bend)[..., None] * up + np.sin(bend)[..., None] * ahead,
        np.cos(bend)[..., None] * ahead - np.sin(bend)[..., None] * up,
    )
    shoulder = arm.a1 * ahead + arm.c1 * up
    elbow = shoulder + arm.c2 * upper_arm
    wrist = T[..., :3, 3] - arm.c4 * T[..., :3, 2]
    across = c[..., 3, None] * aside - s[..., 3, None] * below  # axis 5
    axes = np.stack([up, aside, aside, forearm, across, T[..., :3, 2]], axis=-2)
    places = np.stack([np.zeros_like(up), shoulder, elbow, wrist, wrist, wrist], axis=-2)
    tcp = T[..., :3, :3] @ tool.T_flange_tcp[:3, 3] + T[..., :3, 3]
    columns = np.concatenate([np.cross(axes, tcp[..., None, :] - places), axes], axis=-1) * sign[:, None]
    return np.asarray(np.swapaxes(columns, -1, -2))
