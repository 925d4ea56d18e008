"""Rates, compliance and manipulability from the arm's own axes: a Jacobian for the check alone.

The axes are read off the forward kinematics of `verify.arm`, and the six equations are solved as two times three:
joints 1 to 3 move the wrist centre, joints 4 to 6 make up for the rotation that is left. Nothing here follows the
closed rates of the kernels (theory §2).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from zerorev.model._arrays import Array
from zerorev.model.hole import Hole
from zerorev.model.robot import Robot
from zerorev.model.tool import Tool
from zerorev.verify.arm import skeleton

__all__ = ["Lever", "compliance", "lever", "line_rates", "manipulability"]


class Lever(NamedTuple):
    """What each joint does to the tool, N postures; model angles.

    Attributes:
        axes: unit vectors of the six axes, base frame, shape (6, 3, N).
        wrist: where axes 4 to 6 meet [m], shape (3, N).
        tip: of the tool [m], shape (3, N).
        columns: velocity of the wrist centre by joints 1 to 3 [m/rad], shape (3, 3, N): joint, direction, posture.
    """

    axes: Array
    wrist: Array
    tip: Array
    columns: Array


def lever(robot: Robot, tool: Tool, joints: Array) -> Lever:
    """The axes of the arm.

    Args:
        robot: the arm.
        tool: the drill.
        joints: controller angles [rad], shape (N, 6).
    """
    arm, body = robot.arm, skeleton(robot.arm, joints)
    R, axes, columns = body.R_base_flange, np.zeros((6, 3, len(joints))), np.empty((3, 3, len(joints)))
    axes[0, 2] = 1.0
    axes[1, 0], axes[1, 1] = -body.forward[1], body.forward[0]
    axes[2] = side = axes[1]
    # the forearm runs along axis 4 and beside it; its part in the arm's plane tells which way axis 4 points
    forearm = body.wrist - body.elbow - arm.b * side
    axes[3] = (arm.c3 * forearm - arm.a2 * _cross(side, forearm)) / (arm.a2**2 + arm.c3**2)
    q6 = arm.sign[5] * joints[:, 5] - arm.offset[5]
    axes[4] = np.sin(q6) * R[:, 0] + np.cos(q6) * R[:, 1]
    axes[5] = R[:, 2]
    columns[0, 0], columns[0, 1], columns[0, 2] = -body.wrist[1], body.wrist[0], 0.0
    columns[1], columns[2] = _cross(side, body.wrist - body.shoulder), _cross(side, body.wrist - body.elbow)
    tip = body.flange + np.einsum("ikn,k->in", R, tool.T_flange_tcp[:3, 3])
    return Lever(axes, body.wrist, tip, columns)


def line_rates(
    robot: Robot, tool: Tool, hole: Hole, joints: Array, by_standoff: Array | float, by_spin: Array | float
) -> Array:
    """How the joints move with the tool at points of the drill axis, shape (N, 6); not finite where it is singular.

    Args:
        robot: the arm.
        tool: the drill.
        hole: the drill axis.
        joints: controller angles [rad], shape (N, 6).
        by_standoff: by how much the stand-off changes, shape (N,).
        by_spin: and the spin; (1, u) gives the rates [rad/m] of an outward leg of slope u [rad/m], (1, 0) and (0, 1)
            its two parts.
    """
    parts = lever(robot, tool, joints)
    axis = -hole.direction[:, None]  # of the tool, out of the material
    # a spin about the drill axis leaves the tip, not the wrist centre, where it is
    velocity = by_standoff * axis + by_spin * _cross(axis, parts.wrist - parts.tip)
    rates = np.empty((6, len(joints)))
    rates[:3] = _solved(parts.columns, velocity)
    left = by_spin * axis - np.einsum("jn,jan->an", rates[:3], parts.axes[:3])
    rates[3:] = _solved(parts.axes[3:], left)
    return np.asarray(rates.T * np.array(robot.arm.sign))


def compliance(robot: Robot, tool: Tool, joints: Array, stiffness: tuple[float, ...], direction: Array) -> Array:
    """Give of the tip along the drill axis, and the greatest across it [m/N], shape (2, N).

    Args:
        robot: the arm.
        tool: the drill.
        joints: controller angles [rad], shape (N, 6).
        stiffness: of the joints [N m/rad], shape (6,).
        direction: unit vector along the drill axis, shape (3,).
    """
    parts = lever(robot, tool, joints)
    # to the tip it is as far again as from the wrist centre, which axes 4 to 6 leave where it is
    moves = np.stack([_cross(axis, parts.tip - parts.wrist) for axis in parts.axes])
    moves[:3] += parts.columns
    C = np.einsum("jan,j,jbn->nab", moves, 1 / np.array(stiffness), moves)
    along = np.einsum("a,nab,b->n", direction, C, direction)
    flat = np.eye(3) - np.outer(direction, direction)
    # the greatest eigenvalue of what is left across the axis; along the axis it has the eigenvalue 0
    return np.stack([along, np.linalg.eigvalsh(flat @ C @ flat)[:, -1]])


def manipulability(robot: Robot, tool: Tool, joints: Array) -> Array:
    """|det J| over the product of both links and the greatest reach of the wrist centre from axis 1 [1], shape (N,)."""
    arm, parts = robot.arm, lever(robot, tool, joints)
    forearm = np.hypot(arm.a2, arm.c3)
    greatest = arm.c2 * forearm * (abs(arm.a1) + arm.c2 + forearm)
    (a, b, c), (d, e, f) = parts.columns, parts.axes[3:]
    return np.asarray(np.abs(_dot(a, _cross(b, c)) * _dot(d, _cross(e, f))) / greatest)


def _solved(columns: Array, right: Array) -> Array:
    """Three unknowns, shape (3, N), of N systems with columns (3, 3, N) and right sides (3, N)."""
    a, b, c = columns
    first = _cross(b, c)
    with np.errstate(divide="ignore", invalid="ignore"):
        found = np.stack([_dot(right, each) for each in (first, _cross(c, a), _cross(a, b))]) / _dot(a, first)
    return np.asarray(found)


def _dot(a: Array, b: Array) -> Array:
    return np.asarray(a[0] * b[0] + a[1] * b[1] + a[2] * b[2])


def _cross(a: Array, b: Array) -> Array:
    found = np.empty(np.broadcast_shapes(a.shape, b.shape))
    np.subtract(a[1] * b[2], a[2] * b[1], out=found[0])
    np.subtract(a[2] * b[0], a[0] * b[2], out=found[1])
    np.subtract(a[0] * b[1], a[1] * b[0], out=found[2])
    return found
