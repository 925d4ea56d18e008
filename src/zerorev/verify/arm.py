"""The arm once more, from its drawing alone: forwards link by link, backwards by triangles and crossed axes.

Nothing here follows the closed formulas of Brandstoetter et al. (2014) that the kernels use, so that a slip in one is
no slip in the other. Only the meaning of the seven lengths is shared (`zerorev.model.robot.ArmGeometry`).

Samples come last here, (3, N) and (3, 3, N): 40,000 of them are checked, and NumPy is fast along the last axis. Joints
have the shape (N, 6) all the same, but lie in memory joint by joint. Long paths are worked on in blocks that stay in
the processor's cache (`blocks`).
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from zerorev.model._arrays import Array
from zerorev.model.robot import ArmGeometry

__all__ = [
    "Posture",
    "Skeleton",
    "blocks",
    "branch_of",
    "hand",
    "posture_of",
    "skeleton",
    "solve",
    "with_turns",
]

TURN = 2 * np.pi
BLOCK = 4096  # samples: some thirty arrays of so many fit into a cache of 1 MiB
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


def blocks(count: int) -> Iterator[slice]:
    """Slices of at most BLOCK samples that make up so many."""
    return (slice(first, first + BLOCK) for first in range(0, count, BLOCK))


def _model_angles(arm: ArmGeometry, joints: Array) -> Array:
    """Model angles, shape (6, N), of controller angles (N, 6)."""
    q = np.array(arm.sign)[:, None] * joints.T
    if any(arm.offset):
        q -= np.array(arm.offset)[:, None]
    return q


def _controller_angles(arm: ArmGeometry, q: Array) -> Array:
    """Controller angles, shape (N, 6), of model angles (6, N), which are changed in place."""
    if any(arm.offset):
        q += np.array(arm.offset)[:, None]
    q *= np.array(arm.sign)[:, None]
    return q.T


def cos_sin(angle: Array) -> tuple[Array, Array]:
    """Cosines and sines of angles [rad] by the tangent of half of each: of the three, NumPy computes it fastest."""
    t = np.tan(0.5 * angle)
    share = t * t
    share += 1.0
    np.divide(2.0, share, out=share)
    t *= share
    share -= 1.0
    return share, t


def hand(arm: ArmGeometry, joints: Array) -> Array:
    """Forward kinematics as a product of elementary turns and shifts, up to the last shift along axis 6.

    Rz(q1) T(a1, 0, c1) Ry(q2) T(0, 0, c2) Ry(q3) T(a2, b, c3) Rz(q4) Ry(q5) Rz(q6) T(0, 0, c4).

    Args:
        arm: geometry.
        joints: controller angles [rad], shape (N, 6).

    Returns:
        Base frame, shape (4, 3, N): the axes x, y, z of the flange, and the place of the wrist centre [m].
    """
    q = _model_angles(arm, joints)
    q[2] += q[1]  # axes 2 and 3 are parallel
    (c1, c2, c23, c4, c5, c6), (s1, s2, s23, s4, s5, s6) = cos_sin(q)
    found = np.empty((4, 3, q.shape[1]))
    # coordinates of x, y, z and the wrist centre, a row each, as joint after joint turns them
    x, y, z = np.empty((3, 4, q.shape[1]))
    np.multiply(c5, c6, out=x[0])
    np.multiply(-c5, s6, out=x[1])
    np.multiply(-s5, c6, out=z[0])
    np.multiply(s5, s6, out=z[1])
    x[2], y[0], y[1], y[2], z[2] = s5, s6, c6, 0.0, c5
    x[:3], y[:3] = _turned(x[:3], y[:3], c4, s4)
    x[3], y[3], z[3] = arm.a2, arm.b, arm.c3
    z, x = _turned(z, x, c23, s23)
    x[3] += arm.a1 + arm.c2 * s2
    z[3] += arm.c1 + arm.c2 * c2
    found[:, 0], found[:, 1] = _turned(x, y, c1, s1)
    found[:, 2] = z
    return found


def _turned(x: Array, y: Array, c: Array, s: Array) -> tuple[Array, Array]:
    """Coordinates of vectors turned about the third axis, x towards y, by angles of which cosine and sine are given."""
    turned_x, turned_y = c * x, s * x
    turned_x -= s * y
    turned_y += c * y
    return turned_x, turned_y


def skeleton(arm: ArmGeometry, joints: Array) -> Skeleton:
    """The whole arm: `hand`, shoulder and elbow.

    Args:
        arm: geometry.
        joints: controller angles [rad], shape (N, 6).

    Returns:
        Places and axes for each row.
    """
    (c1, c2), (s1, s2) = cos_sin(_model_angles(arm, joints)[:2])
    none, one = np.zeros_like(c1), np.ones_like(c1)
    forward, up = np.stack([c1, s1, none]), np.stack([none, none, one])
    shoulder = arm.a1 * forward + arm.c1 * up
    *axes, wrist = hand(arm, joints)
    R_base_flange = np.stack(axes, axis=1)
    elbow = shoulder + arm.c2 * (c2 * up + s2 * forward)
    return Skeleton(forward, shoulder, elbow, wrist, wrist + arm.c4 * axes[2], R_base_flange)


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
    return Posture(_sign(ahead), _sign(lean), _sign(np.sin(_model_angles(arm, joints)[4])))


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


def solve(arm: ArmGeometry, asked: Array, posture: Posture) -> Array:
    """Joint angles that bring the hand to places and rotations in a given posture.

    The wrist centre, seen from above, is turned to the reach along x1 and b across it; shoulder, elbow and wrist
    centre are a triangle with known sides; axis 5 stands across axes 4 and 6.

    Args:
        arm: geometry.
        asked: base frame, shape (4, 3, N): the axes x, y, z of the flange, and the place of the wrist centre [m].
        posture: signs.

    Returns:
        Controller angles [rad], shape (N, 6), turns as they fall; NaN where the pose is out of reach or singular.
    """
    wx, wy, wz = asked[3]
    sines, cosines = np.empty((2, 6, wz.size))
    with np.errstate(invalid="ignore", divide="ignore"):
        # plan view: joint 1 turns (x1, b) to the wrist centre
        radius2 = wx * wx + wy * wy
        x1 = posture.reach * _root(radius2 - arm.b**2)
        c1, s1 = cosines[0], sines[0]
        np.divide(wx * x1 + wy * arm.b, radius2, out=c1)
        np.divide(wy * x1 - wx * arm.b, radius2, out=s1)
        # side view, (up, ahead), so that an angle is the lean from the vertical: the triangle of both links
        up, ahead = wz - arm.c1, x1 - arm.a1
        span2, forearm2 = up * up + ahead * ahead, arm.a2**2 + arm.c3**2
        along = 0.5 * (span2 + (arm.c2**2 - forearm2))  # of the upper arm, times the span
        height = posture.elbow * _root(arm.c2**2 * span2 - along * along, span2)
        upper_up, upper_ahead = cosines[1], sines[1]
        np.subtract(up * along, ahead * height, out=upper_up)
        np.add(ahead * along, up * height, out=upper_ahead)
        # axis 4 lies atan2(a2, c3) short of the line from elbow to wrist
        scale = 1.0 / (forearm2 * span2)
        lower_up, lower_ahead = (up * span2 - upper_up) * scale, (ahead * span2 - upper_ahead) * scale
        tilt_up, tilt_ahead = arm.c3 * lower_up, arm.c3 * lower_ahead
        if arm.a2:
            tilt_up += arm.a2 * lower_ahead
            tilt_ahead -= arm.a2 * lower_up
        np.subtract(tilt_ahead * upper_up, tilt_up * upper_ahead, out=sines[2])
        np.add(tilt_up * upper_up, tilt_ahead * upper_ahead, out=cosines[2])
        # axis 5 stands across axes 4 and 6; seen along it from either side, the turns of joints 4 and 6
        level = c1 * asked[:3, 0] + s1 * asked[:3, 1]
        np.subtract(c1 * asked[2, 1], s1 * asked[2, 0], out=sines[3])
        np.subtract(tilt_up * level[2], tilt_ahead * asked[2, 2], out=cosines[3])
        level *= tilt_ahead
        level += tilt_up * asked[:3, 2]
        on_x, on_y, on_6 = level  # of axis 4
        sine = np.sqrt(on_x * on_x + on_y * on_y)
        sines[4], cosines[4] = sine, on_6
        sines[5] = on_y
        np.negative(on_x, out=cosines[5])
        if (posture.flip < 0).any():
            sines[3:] *= posture.flip
            cosines[[3, 5]] *= posture.flip
        q = np.arctan2(sines, cosines)
    if not sine.all():
        q[3:, sine == 0] = np.nan  # axes 4 and 6 in one line: only the sum of their angles is known
    return _controller_angles(arm, q)


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


def _in_plane(vector: Array, body: Skeleton) -> Array:
    """A vector in the arm's vertical plane as up + i ahead."""
    return np.asarray(vector[2] + 1j * _dot(vector, body.forward))


def _root(square: Array, scale: Array | float = 1.0) -> Array:
    """Square root, NaN below 0 but for rounding, which goes by a scale."""
    if (square < 0).any():
        square = np.where((square < 0) & (square > -ROUNDING * scale), 0.0, square)
    return np.sqrt(square)


def _sign(value: Array) -> Array:
    return np.where(value < 0, -1.0, 1.0)


def _dot(a: tuple[Array, Array, Array] | Array, b: Array) -> Array:
    return np.asarray(a[0] * b[0] + a[1] * b[1] + a[2] * b[2])
