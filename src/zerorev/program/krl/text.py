"""The letters and numbers of KRL: comments, KUKA's angles A, B, C, and how the axes of the tool lie."""

from __future__ import annotations

import numpy as np

from zerorev.model._arrays import Array, transform
from zerorev.program.letters import Comments

__all__ = [
    "KRL_COMMENTS",
    "T_TCP_TOOL",
    "aggregate",
    "axis_angles",
    "frame_angles",
    "turn_about_x",
]

T_TCP_TOOL = transform(np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]), np.zeros(3))
"""The tool frame as written, in the tcp frame: X along the plunge (X = -Z_tcp), Y = Y_tcp and so Z = X_tcp.

The hole's axis is then the X direction of every pose of a hole, and the spin is a turn about X alone: of KUKA's angles
(A, B, C about Z, Y', X'') only C varies along a hole, for any direction of the hole. The tool as the thesis draws it
does not have this, and passes the singularity of those angles within the range of position 1.
"""

POLE = 1e-9  # below this length across Z an axis points straight up or down, for the angle A, which is then undefined

KRL_COMMENTS = Comments(";", instead=str.maketrans({"%": " percent", "{": "(", "}": ")"}))
"""`;%{...}` hides text from the operator."""


def aggregate(kind: str, names: str, values: list[str]) -> str:
    """`{KIND: A value,B value}`, or without a kind `{A value,B value}`."""
    fields = ",".join(f"{name} {value}" for name, value in zip(names.split(), values, strict=True))
    return f"{{{kind}: {fields}}}" if kind else f"{{{fields}}}"


def axis_angles(axis: Array) -> tuple[float, float]:
    """A and B [rad] of every frame whose X points along a unit axis, shape (3,): R = Rz(A) Ry(B) Rx(C).

    Straight up or down (B = -90 or +90 deg) A and C turn about the same line: A is then 0 by choice, C takes it all.
    """
    across = float(np.hypot(axis[0], axis[1]))
    A = float(np.arctan2(axis[1], axis[0])) if across > POLE else 0.0
    return A, float(np.arctan2(-axis[2], across))


def turn_about_x(R: Array, A: float, B: float) -> float:
    """C [rad] of a rotation, shape (3, 3), for given A and B [rad]; well conditioned for every direction of X."""
    y = np.array([-np.sin(A), np.cos(A), 0.0])
    z = np.array([np.cos(A) * np.sin(B), np.sin(A) * np.sin(B), np.cos(B)])
    return float(np.arctan2(R[:, 1] @ z, R[:, 1] @ y))


def frame_angles(R: Array) -> tuple[float, float, float]:
    """A, B, C [rad] of a rotation, shape (3, 3)."""
    A, B = axis_angles(R[:, 0])
    return A, B, turn_about_x(R, A, B)
