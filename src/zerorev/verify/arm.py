"""The arm once more, from its drawing alone: forwards link by link, backwards by triangles and crossed axes.

Nothing here follows the closed formulas of Brandstoetter et al. (2014) that the kernels use, so that a slip in one is
no slip in the other. Only the meaning of the seven lengths is shared (`zerorev.model.robot.ArmGeometry`).

Samples come last here, (3, N) and (3, 3, N): 40,000 of them are looked at, and NumPy is fast along the last axis.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from zerorev.model._arrays import Array
from zerorev.model.robot import ArmGeometry

__all__ = ["Posture", "Skeleton", "branch_of", "posture_of", "skeleton", "solve", "with_turns"]

TURN = 2 * np.pi
# how far the square of a triangle's height may fall below 0 by rounding alone [m^2]; the forward check judges the rest
ROUNDING = 1e-15


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
    """Which way round the arm reaches a pose: three signs +-1, each a scalar or of shape (N,).

    Attributes:
        reach: +1 with the wrist centre ahead of axis 1, -1 behind it.
        elbow: +1 where the upper arm leans further forward than the line from shoulder to wrist.
        flip: sign of the sine of model angle 5.
    """

    reach: Array
    elbow: Array
    flip: Array


def _model_angles(arm: ArmGeometry, joints: Array) -> Array:
    return np.asarray(np.array(arm.sign) * joints - np.array(arm.offset))


def _controller_angles(arm: ArmGeometry, q: Array) -> Array:
    return np.asarray((q + np.array(arm.offset)) * np.array(arm.sign))


def _turn(first: Array, second: Array, angle: Array) -> tuple[Array, Array]:
    """Turn two axes of a frame, each (3, N), by angle (N,) about the third: the first towards the second."""
    c, s = np.cos(angle), np.sin(angle)
    return c * first + s * second, c * second - s * first


def skeleton(arm: ArmGeometry, joints: Array) -> Skeleton:
    """Forward kinematics as a product of elementary turns and shifts.

    Rz(q1) T(a1, 0, c1) Ry(q2) T(0, 0, c2) Ry(q3) T(a2, b, c3) Rz(q4) Ry(q5) Rz(q6) T(0, 0, c4).

    Args:
        arm: geometry.
        joints: controller angles [rad], shape (N, 6).

    Returns:
        Places and axes for each row.
    """
    q = _model_angles(arm, joints).T
    x, y, z = (np.repeat(axis[:, None], q.shape[1], axis=1) for axis in np.eye(3))
    x, y = _turn(x, y, q[0])
    forward = x
    shoulder = arm.a1 * x + arm.c1 * z
    z, x = _turn(z, x, q[1])
    elbow = shoulder + arm.c2 * z
    z, x = _turn(z, x, q[2])
    wrist = elbow + arm.a2 * x + arm.b * y + arm.c3 * z
    x, y = _turn(x, y, q[3])
    z, x = _turn(z, x, q[4])
    x, y = _turn(x, y, q[5])
    return Skeleton(forward, shoulder, elbow, wrist, wrist + arm.c4 * z, np.stack([x, y, z], axis=1))


def posture_of(arm: ArmGeometry, joints: Array) -> Posture:
    """The signs of postures, read off the forward kinematics.

    Args:
        arm: geometry.
        joints: controller angles [rad], shape (N, 6).

    Returns:
        Signs of shape (N,); +1 on the singular postures between two signs.
    """
    body = skeleton(arm, joints)
    ahead = _dot(body.wrist, body.forward)
    upper, line = _in_plane(body.elbow - body.shoulder, body), _in_plane(body.wrist - body.shoulder, body)
    lean = (upper * line.conj()).imag
    return Posture(_sign(ahead), _sign(lean), _sign(np.sin(_model_angles(arm, joints)[:, 4])))


def branch_of(arm: ArmGeometry, joints: Array) -> int:
    """Branch 0..7 of one joint vector (conventions: branch).

    Args:
        arm: geometry.
        joints: controller angles [rad], shape (6,).

    Returns:
        4 with the wrist centre behind axis 1, + 2 with the elbow below the line from shoulder to wrist, + 1 with a
        negative controller angle 5. Below means: the upper arm leans further to the side to which the arm reaches.
    """
    posture = posture_of(arm, joints[None])
    angle_5 = np.angle(np.exp(1j * joints[4]))
    behind, below = posture.reach[0] < 0, posture.elbow[0] * posture.reach[0] > 0
    return int(4 * behind + 2 * below + (angle_5 < 0))


def solve(arm: ArmGeometry, flange: Array, R_base_flange: Array, posture: Posture) -> Array:
    """Joint angles that bring the flange to poses in a given posture.

    The wrist centre, seen from above, is turned to the reach along x1 and b across it; shoulder, elbow and wrist
    centre are a triangle with known sides; axis 5 stands across axes 4 and 6.

    Args:
        arm: geometry.
        flange: origin of the flange [m], shape (3, N).
        R_base_flange: rotation of the flange, shape (3, 3, N).
        posture: signs.

    Returns:
        Controller angles [rad], shape (N, 6), turns as they fall; NaN where the pose is out of reach or singular.
    """
    flange_x, flange_y, axis_6 = (R_base_flange[:, k] for k in range(3))
    wrist = flange - arm.c4 * axis_6
    with np.errstate(invalid="ignore", divide="ignore"):
        # plan view: e^(i q1) (x1 + i b) = wrist centre
        seen = wrist[0] + 1j * wrist[1]
        x1 = posture.reach * _root(np.abs(seen) ** 2 - arm.b**2)
        heading = seen / (x1 + 1j * arm.b)
        # side view, complex numbers up + i ahead, so that their angle is the lean from the vertical
        line = (wrist[2] - arm.c1) + 1j * (x1 - arm.a1)
        span, forearm = np.abs(line), np.hypot(arm.a2, arm.c3)
        along = (span**2 + arm.c2**2 - forearm**2) / (2 * span)
        upper = line / span * (along + 1j * posture.elbow * _root(arm.c2**2 - along**2))
        # axis 4 lies atan2(a2, c3) short of the line from elbow to wrist
        tilt = (line - upper) / (arm.c3 + 1j * arm.a2)
        tilt /= np.abs(tilt)
        c1, s1 = heading.real / np.abs(heading), heading.imag / np.abs(heading)
        side = np.stack([-s1, c1, np.zeros_like(c1)])
        axis_4 = np.stack([tilt.imag * c1, tilt.imag * s1, tilt.real])
        front = _cross(side, axis_4)
        across = _cross(axis_4, axis_6)
        sine = np.sqrt(_dot(across, across))
        axis_5 = across * (posture.flip / sine)
        q = np.stack(
            [
                np.angle(heading),
                np.angle(upper),
                np.angle(tilt / upper),
                np.arctan2(-_dot(front, axis_5), _dot(side, axis_5)),
                np.arctan2(posture.flip * sine, _dot(axis_4, axis_6)),
                np.arctan2(_dot(flange_x, axis_5), _dot(flange_y, axis_5)),
            ],
            axis=-1,
        )
    return _controller_angles(arm, q)


def with_turns(joints: Array, start: Array) -> Array:
    """Add full turns so that a path is continuous and begins on the turns of `start`.

    Args:
        joints: [rad], shape (N, 6); NaN rows keep the turns of the row before.
        start: [rad], shape (6,).

    Returns:
        Joints [rad], shape (N, 6).
    """
    steps = np.diff(joints, axis=0, prepend=start[None])
    # whole numbers are summed, not angles: rounding must not pile up over the path
    return np.asarray(joints - TURN * np.cumsum(np.nan_to_num(np.rint(steps / TURN)), axis=0))


def _in_plane(vector: Array, body: Skeleton) -> Array:
    """A vector in the arm's vertical plane as up + i ahead."""
    return np.asarray(vector[2] + 1j * _dot(vector, body.forward))


def _root(square: Array) -> Array:
    """Square root, NaN below 0 but for rounding."""
    return np.sqrt(np.where((square < 0) & (square > -ROUNDING), 0.0, square))


def _sign(value: Array) -> Array:
    return np.where(value < 0, -1.0, 1.0)


def _dot(a: Array, b: Array) -> Array:
    return np.asarray(np.einsum("ij,ij->j", a, b))


def _cross(a: Array, b: Array) -> Array:
    return np.stack([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])
