"""The arm of the check one pose at a time: elementary turns and shifts forward, triangles and crossed axes backward."""

from __future__ import annotations

import numpy as np

__all__ = ["backward", "forward", "pose"]

ROUNDING = 1e-15  # [m^2]


def forward(arm, joints):
    """Pose of the flange at controller angles (6,) [rad], shape (4, 4): one 4x4 matrix after the other."""
    q = [s * angle - o for s, angle, o in zip(arm.sign, joints, arm.offset, strict=True)]
    T = _elementary("z", q[0]) @ _shift(arm.a1, 0, arm.c1) @ _elementary("y", q[1]) @ _shift(0, 0, arm.c2)
    T = T @ _elementary("y", q[2]) @ _shift(arm.a2, arm.b, arm.c3)
    return T @ _elementary("z", q[3]) @ _elementary("y", q[4]) @ _elementary("z", q[5]) @ _shift(0, 0, arm.c4)


def backward(arm, T, posture):
    """Controller angles [rad], shape (6,), that bring the flange to a pose (4, 4) in a posture of three signs.

    NaN where that is out of reach or singular.
    """
    R, wrist = T[:3, :3], T[:3, 3] - arm.c4 * T[:3, 2]
    radius2 = wrist[0] ** 2 + wrist[1] ** 2
    ahead = posture.reach * _root(radius2 - arm.b**2, 1.0)
    q1 = np.arctan2(wrist[1], wrist[0]) - np.arctan2(arm.b, ahead)
    up, ahead = wrist[2] - arm.c1, ahead - arm.a1
    span2, forearm2 = up**2 + ahead**2, arm.a2**2 + arm.c3**2
    along = (span2 + arm.c2**2 - forearm2) / 2
    lean = np.arctan2(posture.elbow * _root(arm.c2**2 * span2 - along**2, span2), along)
    q2 = np.arctan2(ahead, up) + lean
    # from elbow to wrist, and from there to axis 4
    lower = np.arctan2(ahead - arm.c2 * np.sin(q2), up - arm.c2 * np.cos(q2))
    q3 = lower - np.arctan2(arm.a2, arm.c3) - q2
    M = _elementary("y", -(q2 + q3))[:3, :3] @ _elementary("z", -q1)[:3, :3] @ R
    sine = posture.flip * np.hypot(M[0, 2], M[1, 2])
    q4 = np.arctan2(M[1, 2] * posture.flip, M[0, 2] * posture.flip) if sine else np.nan
    q6 = np.arctan2(M[2, 1] * posture.flip, -M[2, 0] * posture.flip) if sine else np.nan
    q5 = np.arctan2(sine, M[2, 2]) if sine else np.nan
    return (np.array([q1, q2, q3, q4, q5, q6]) + arm.offset) * arm.sign


def pose(tool, hole, standoff, psi):
    """Pose of the flange, shape (4, 4), with the tip at a stand-off [m] and the tool spun by psi [rad]."""
    z = -hole.direction
    y = np.cos(psi) * hole.psi_zero + np.sin(psi) * np.cross(z, hole.psi_zero)
    T = np.eye(4)
    T[:3, :3] = np.stack([np.cross(y, z), y, z], axis=-1)
    T[:3, 3] = hole.target + standoff * z
    return T @ np.linalg.inv(tool.T_flange_tcp)


def _elementary(axis, angle):
    c, s = np.cos(angle), np.sin(angle)
    i, j = {"y": (2, 0), "z": (0, 1)}[axis]
    T = np.eye(4)
    T[i, i], T[i, j], T[j, i], T[j, j] = c, -s, s, c
    return T


def _shift(x, y, z):
    T = np.eye(4)
    T[:3, 3] = x, y, z
    return T


def _root(square, scale):
    return np.sqrt(0.0 if -ROUNDING * scale < square < 0 else square)
