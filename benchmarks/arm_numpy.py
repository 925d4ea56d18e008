"""The arm's inverse kinematics once more, in NumPy, for the scorer and for the peer that is to be plain NumPy.

Written with angles, after Brandstoetter, Angerer, Hofbaur (2014); `zerorev.kernels.arm` is written without.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from zerorev.model._arrays import Array
from zerorev.model.robot import ArmGeometry

__all__ = ["inverse", "wrapped"]


def wrapped(angle: Array) -> Array:
    """Angles within [-pi, pi]."""
    return angle - 2 * np.pi * np.rint(angle / (2 * np.pi))


def inverse(arm: ArmGeometry, T: npt.ArrayLike, branches: tuple[int, ...] = tuple(range(8))) -> Array:
    """Controller angles [rad] of flange poses.

    Args:
        arm: seven lengths, signs and offsets.
        T: poses, shape (..., 4, 4).
        branches: 4 * (wrist centre behind axis 1) + 2 * (elbow below) + (A5 < 0), K of them.

    Returns:
        shape (..., K, 6), NaN where a branch cannot reach.
    """
    T = np.asarray(T, dtype=float)
    out = np.empty((*T.shape[:-2], len(branches), 6))
    with np.errstate(invalid="ignore"):
        for posture in {branch // 2 for branch in branches}:
            model = _posture(arm, T, behind=posture >= 2, below=posture % 2 == 1)
            for k, branch in enumerate(branches):
                if branch // 2 == posture:
                    out[..., k, :] = _shown(arm, model, negative=branch % 2 == 1)
    return out


def _posture(arm: ArmGeometry, T: Array, *, behind: bool, below: bool) -> list[Array]:
    """Model angles of one arm posture, with q5 >= 0."""
    R, side = T[..., :3, :3], -1.0 if behind else 1.0
    wx, wy, wz = np.moveaxis(T[..., :3, 3] - arm.c4 * R[..., 2], -1, 0)
    ahead = side * np.sqrt(wx**2 + wy**2 - arm.b**2)
    q1 = np.arctan2(wy, wx) - np.arctan2(arm.b, ahead)
    # two links in the arm's plane: upper arm c2, forearm k, bent by phi at the elbow
    x, z, k = ahead - arm.a1, wz - arm.c1, np.hypot(arm.a2, arm.c3)
    phi = np.arccos((x**2 + z**2 - arm.c2**2 - k**2) / (2 * arm.c2 * k))
    phi = -phi if below != behind else phi
    q2 = np.arctan2(x, z) - np.arctan2(k * np.sin(phi), arm.c2 + k * np.cos(phi))
    q3 = phi - np.arctan2(arm.a2, arm.c3)
    # what is left of the rotation: Rz(q4) Ry(q5) Rz(q6)
    c1, s1, c23, s23 = np.cos(q1), np.sin(q1), np.cos(q2 + q3), np.sin(q2 + q3)
    radial = c1[..., None] * R[..., 0, :] + s1[..., None] * R[..., 1, :]
    m0 = c23[..., None] * radial - s23[..., None] * R[..., 2, :]
    m1 = c1[..., None] * R[..., 1, :] - s1[..., None] * R[..., 0, :]
    m2 = s23[..., None] * radial + c23[..., None] * R[..., 2, :]
    q4 = np.arctan2(m1[..., 2], m0[..., 2])
    q5 = np.arctan2(np.hypot(m0[..., 2], m1[..., 2]), m2[..., 2])
    q6 = np.arctan2(m2[..., 1], -m2[..., 0])
    return [q1, q2, q3, q4, q5, q6]


def _shown(arm: ArmGeometry, model: list[Array], *, negative: bool) -> Array:
    """Controller angles of the wrist flip whose A5 has the sign asked for."""
    q = np.stack(model, axis=-1)
    if negative == (arm.sign[4] > 0):
        q = q * [1, 1, 1, 1, -1, 1] + [0, 0, 0, np.pi, 0, np.pi]
    joints = wrapped((q + np.array(arm.offset)) * np.array(arm.sign))
    joints[np.isnan(joints).any(axis=-1)] = np.nan
    return joints
