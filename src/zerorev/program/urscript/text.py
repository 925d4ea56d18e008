"""The letters and numbers of URScript: comments, poses in metres with a rotation vector, joints in radians.

Numbers have 9 decimals: PolyScope itself writes more, and a joint that all but rests at the end of a leg, as in a plan
of least travel, keeps its direction in the rounded program.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from zerorev.model._arrays import Array
from zerorev.program.letters import Comments, fixed

__all__ = ["INDENT", "URSCRIPT_COMMENTS", "joint_list", "number_list", "pose", "rotation_vector"]

INDENT = "  "
DECIMALS = 9  # [m], [rad]
URSCRIPT_COMMENTS = Comments("#", width=98)

NEAR_HALF_A_TURN = 1e-6  # [rad] from it a rotation has two vectors that are printed almost alike but for their signs
ONE_SIDE = np.array([1.0, 0.6180, 0.3820])  # no axis that a drawing has is at right angles to it


def pose(T: Array) -> str:
    """A pose, shape (4, 4), translation [m]."""
    return f"p{number_list([*T[:3, 3], *rotation_vector(T[:3, :3])], DECIMALS)}"


def joint_list(joints: Array) -> str:
    """Six joint values [rad], shape (6,), turns included."""
    return number_list(joints, DECIMALS)


def number_list(values: Sequence[float] | Array, decimals: int) -> str:
    """Numbers in brackets."""
    return f"[{', '.join(fixed(value, decimals) for value in values)}]"


def rotation_vector(R: Array) -> Array:
    """The axis of a rotation, shape (3, 3), times its angle [rad]: shape (3,), as long as half a turn at most.

    Half a turn, which every tool that points straight down has, is the same about an axis and about its opposite: of
    these always the same one is taken, so that last bits do not decide.
    """
    w, vector = _quaternion(R)
    sine = float(np.linalg.norm(vector))
    if sine == 0:
        return np.zeros(3)
    angle = 2.0 * float(np.arctan2(sine, w))
    turn = vector * (angle / sine)
    if np.pi - angle < NEAR_HALF_A_TURN and turn @ ONE_SIDE < 0:
        turn = turn * (1.0 - 2.0 * np.pi / angle)
    return np.asarray(turn)


def _quaternion(R: Array) -> tuple[float, Array]:
    """Its scalar, 0 or more, and its vector, shape (3,), from the greatest of the four, which keeps the digits."""
    squares = np.array([1 + np.trace(R), *(1 + 2 * np.diag(R) - np.trace(R))])  # 4 q^2
    k = int(np.argmax(squares))
    across = np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])  # 4 w (x, y, z)
    if k == 0:
        products = np.array([squares[0], *across])
    else:
        axis = k - 1
        both = R[:, axis] + R[axis, :]  # 4 (x, y, z) of that axis, which is doubled too much at itself
        both[axis] = squares[k]
        products = np.array([across[axis], *both])
    q = products / np.linalg.norm(products)
    return (float(q[0]), q[1:]) if q[0] >= 0 else (-float(q[0]), -q[1:])
