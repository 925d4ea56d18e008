"""The arm once more, from its drawing alone: forwards link by link, backwards by triangles and crossed axes.

Nothing here follows the closed formulas of Brandstoetter et al. (2014) that the kernels use, so that an error in one is
not repeated in the other. Only the meaning of the seven lengths is shared (`zerorev.model.robot.ArmGeometry`).

Samples come last here, (3, N) and (3, 3, N). Joints have the shape (N, 6) all the same, but lie in memory joint by
joint. The loops over samples are in `verify.compiled`.
"""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numpy as np

from zerorev.model._arrays import Array
from zerorev.model.robot import ArmGeometry
from zerorev.verify.compiled import forward, inverse

__all__ = [
    "Posture",
    "Skeleton",
    "Sums",
    "branch_of",
    "hand",
    "posture_of",
    "skeleton",
    "solve",
    "with_turns",
]

Sums: TypeAlias = tuple[tuple[tuple[float, ...], ...], ...]
"""Three axes and a place [m], three coordinates each, as sums over 1, stand-off [m], cos psi, sin psi: 4 x 3 x 4."""

TURN = 2 * np.pi


class Skeleton(NamedTuple):
    """Where the parts of the arm are, base frame, places [m]; each of shape (3, N) but `R_base_flange`.

    Attributes:
        forward: unit vector ahead of the arm, turned with axis 1.
        shoulder: on axis 2, in the arm's middle plane.
        elbow: on axis 3, in the arm's middle plane.
        wrist: where axes 4 to 6 meet.
        flange: origin of the flange frame.
        R_base_flange: rotation of the flange, shape (3, 3, N).
    """

    forward: Array
    shoulder: Array
    elbow: Array
    wrist: Array
    flange: Array
    R_base_flange: Array


class Posture(NamedTuple):
    """Which way round the arm reaches a pose: three signs, +1.0 or -1.0.

    Attributes:
        reach: +1 with the wrist centre ahead of axis 1, -1 behind it.
        elbow: +1 where the upper arm leans further forward than the line from shoulder to wrist.
        flip: sign of the sine of model angle 5.
    """

    reach: float
    elbow: float
    flip: float


def _model_angles(arm: ArmGeometry, joints: Array) -> Array:
    """Model angles, shape (6, N), of controller angles (N, 6)."""
    q = np.array(arm.sign)[:, None] * joints.T
    if any(arm.offset):
        q -= np.array(arm.offset)[:, None]
    return q


def hand(arm: ArmGeometry, joints: Array) -> Array:
    """Forward kinematics as a product of elementary turns and shifts, up to the last shift along axis 6.

    Rz(q1) T(a1, 0, c1) Ry(q2) T(0, 0, c2) Ry(q3) T(a2, b, c3) Rz(q4) Ry(q5) Rz(q6) T(0, 0, c4).

    Args:
        arm: geometry.
        joints: controller angles [rad], shape (N, 6).

    Returns:
        Base frame, shape (4, 3, N): the axes x, y, z of the flange, and the place of the wrist centre [m].
    """
    body = np.empty((4, 3, len(joints)))
    forward(arm, np.ascontiguousarray(joints.T), body)
    return body


def skeleton(arm: ArmGeometry, joints: Array) -> Skeleton:
    """The whole arm: `hand`, shoulder and elbow.

    Args:
        arm: geometry.
        joints: controller angles [rad], shape (N, 6).

    Returns:
        Places and axes for each row.
    """
    q1, q2 = _model_angles(arm, joints)[:2]
    (c1, c2), (s1, s2) = np.cos([q1, q2]), np.sin([q1, q2])
    none, one = np.zeros_like(c1), np.ones_like(c1)
    forward, up = np.stack([c1, s1, none]), np.stack([none, none, one])
    shoulder = arm.a1 * forward + arm.c1 * up
    *axes, wrist = hand(arm, joints)
    R_base_flange = np.stack(axes, axis=1)
    elbow = shoulder + arm.c2 * (c2 * up + s2 * forward)
    return Skeleton(forward, shoulder, elbow, wrist, wrist + arm.c4 * axes[2], R_base_flange)


def posture_of(arm: ArmGeometry, joints: Array) -> Posture:
    """The signs of one joint vector, read off the forward kinematics.

    Args:
        arm: geometry.
        joints: controller angles [rad], shape (6,).

    Returns:
        Signs; +1 on the singular postures between two signs.
    """
    q1, q2, _, _, q5, _ = _model_angles(arm, joints[None])[:, 0]
    wx, wy, wz = hand(arm, joints[None])[3, :, 0]
    ahead = wx * np.cos(q1) + wy * np.sin(q1)
    # (up, ahead) of the upper arm and of the line from shoulder to wrist
    lean = np.sin(q2) * (wz - arm.c1) - np.cos(q2) * (ahead - arm.a1)
    return Posture(*(-1.0 if value < 0 else 1.0 for value in (ahead, lean, np.sin(q5))))


def branch_of(arm: ArmGeometry, joints: Array) -> int:
    """Branch 0..7 of one joint vector (conventions: branch).

    Args:
        arm: geometry.
        joints: controller angles [rad], shape (6,).

    Returns:
        4 with the wrist centre behind axis 1, + 2 with the elbow below the line from shoulder to wrist, + 1 with a
        wrist that is bent to the negative side of joint 5, as the controller counts it. Below means: the upper arm
        leans further to the side to which the arm reaches.
    """
    posture = posture_of(arm, joints)
    bend = arm.sign[4] * np.sin(arm.sign[4] * joints[4] - arm.offset[4])
    behind, below = posture.reach < 0, posture.elbow * posture.reach > 0
    return int(4 * behind + 2 * below + (bend < 0))


def solve(arm: ArmGeometry, asked: Sums, posture: Posture, standoff: Array, psi: Array) -> Array:
    """Joint angles that bring the hand to poses of the twist plane in a given posture.

    Args:
        arm: geometry.
        asked: base frame: the axes x, y, z of the flange, and the place of the wrist centre.
        posture: signs.
        standoff: [m], shape (N,).
        psi: [rad], shape (N,).

    Returns:
        Controller angles [rad], shape (N, 6), turns as they fall; NaN where the pose is out of reach or singular.
    """
    q = np.empty((6, psi.size))
    inverse(arm, asked, posture, standoff, psi, q)
    return q.T


def with_turns(joints: Array, start: Array) -> Array:
    """Add full turns so that a path is continuous and begins on the turns of `start`.

    Args:
        joints: [rad], shape (N, 6), changed in place; NaN rows keep the turns of the row before.
        start: [rad], shape (6,).

    Returns:
        The same array [rad].
    """
    for angles, begin in zip(joints.T, start, strict=True):
        if angles.max() - angles.min() < TURN / 2:  # not where any is NaN
            if first := round((angles[0] - begin) / TURN):
                angles -= TURN * first
            continue
        # whole numbers are summed, not angles: rounding must not pile up over the path
        turns = np.nan_to_num(np.rint(np.diff(angles, prepend=begin) / TURN))
        angles -= TURN * np.cumsum(turns, out=turns)
    return joints
