"""The check's loops over its samples, compiled: inverse kinematics, forward kinematics, and how far off the tool is.

The formulas are the check's own, down to sine, cosine and arctangent: of the kernels of the search nothing is used but
the decorator that compiles. All of the check's kernels are in this file: a change to it compiles them again, a change
to another file that they called would not.

The rows of a block of samples lie in one array at distances known when it is compiled, and the loops over them have no
branches, so that several samples are worked on at a time. What is out of reach or singular comes out as NaN.
"""

from __future__ import annotations

import numpy as np

from zerorev.kernels._jit import kernel

__all__ = ["forward", "inverse", "residual"]

# rows: stand-off, cosine and sine of spin and of model angles, axes x, y, z of the flange and wrist centre
BLOCK = 128
STANDOFF, C, S, COS, SIN, BODY = 0, 1, 2, 3, 9, 15
ROOM = 27 * BLOCK
# how far the square of a triangle's height may be below 0 by rounding alone [m^2]; the forward check judges the rest
ROUNDING = 1e-15

HALF_PI_HIGH, HALF_PI_LOW = 1.5707963267341256, 6.077100506506192e-11  # the first of 33 bits: exact, times a few turns


@kernel
def cos_sin(angle):  # type: ignore[no-untyped-def]
    """Cosine and sine of an angle of a few turns [rad]: less than 2.5e-16 off.

    Quarter turns are taken off; up to pi/4 the polynomials interpolate both at Chebyshev's points.
    """
    quarters = np.rint(angle * (2 / np.pi))
    x = (angle - quarters * HALF_PI_HIGH) - quarters * HALF_PI_LOW
    z = x * x
    sin = x + x * z * (
        -0.16666666666666666
        + z * (0.008333333333330948
        + z * (-0.00019841269836758557
        + z * (2.7557316102543096e-06
        + z * (-2.5051131843056034e-08 + z * 1.5918129154550544e-10))))
    )  # fmt: skip
    cos = 1.0 - 0.5 * z + z * z * (
        0.041666666666666664
        + z * (-0.0013888888888887398
        + z * (2.4801587298765676e-05
        + z * (-2.755731727172395e-07
        + z * (2.087614626718481e-09 + z * -1.1382632337741214e-11))))
    )  # fmt: skip
    odd = quarters - 2.0 * np.floor(0.5 * quarters) == 1.0
    half = quarters - 4.0 * np.floor(0.25 * quarters) >= 2.0
    c, s = (-sin if odd else cos), (cos if odd else sin)
    return (-c if half else c), (-s if half else s)


@kernel
def angle_of(y, x):  # type: ignore[no-untyped-def]
    """The angle of (x, y) from the x axis [rad], -pi to pi: less than 4.5e-16 off; NaN for the zero vector.

    Mirrored to below pi/4, turned back from above pi/8; there a polynomial interpolates at Chebyshev's points.
    """
    across, along = abs(y), abs(x)
    steep = across > along
    low, high = (along if steep else across), (across if steep else along)
    beyond = low > 0.4142135623730950 * high  # tan(pi / 8)
    t = (low - high if beyond else low) / (low + high if beyond else high)
    z = t * t
    angle = t + t * z * (
        -0.3333333333333333
        + z * (0.1999999999999552
        + z * (-0.14285714284666534
        + z * (0.11111111015255669
        + z * (-0.09090904578095735
        + z * (0.07692183190171728
        + z * (-0.06664511438164644
        + z * (0.05858148832731273
        + z * (-0.05085449318930035
        + z * (0.039231646190551486 + z * -0.019176872294336067)))))))))
    )  # fmt: skip
    angle = angle + np.pi / 4 if beyond else angle
    angle = np.pi / 2 - angle if steep else angle
    angle = np.pi - angle if x < 0 else angle
    return -angle if y < 0 else angle


@kernel
def inverse(arm, asked, posture, standoff, psi, joints):  # type: ignore[no-untyped-def]
    """Joints that bring the hand to poses of the twist plane, in one posture; turns as they fall.

    Args:
        arm: `ArmGeometry`.
        asked: axes x, y, z of the flange and wrist centre [m], three coordinates each, as sums over 1, stand-off,
            cos psi, sin psi: 4 x 3 x 4 numbers in tuples.
        posture: `verify.arm.Posture`.
        standoff: [m], shape (N,).
        psi: [rad], shape (N,).
        joints: out, controller angles [rad], shape (6, N); NaN where the pose is out of reach or singular.
    """
    work = np.empty(ROOM)
    for first in range(0, standoff.shape[0], BLOCK):
        count = min(BLOCK, standoff.shape[0] - first)
        _along(standoff, psi, first, count, work)
        _bend(arm, asked, posture, count, work)
        for j in range(6):
            sign, offset = arm.sign[j], arm.offset[j]
            for n in range(count):
                angle = angle_of(work[(SIN + j) * BLOCK + n], work[(COS + j) * BLOCK + n])
                work[BODY * BLOCK + n] = sign * (angle + offset)
            for n in range(count):
                joints[j, first + n] = work[BODY * BLOCK + n]


@kernel
def forward(arm, joints, body):  # type: ignore[no-untyped-def]
    """Axes of the flange and wrist centre at joints, base frame.

    Args:
        arm: `ArmGeometry`.
        joints: controller angles [rad], shape (6, N).
        body: out, axes x, y, z and wrist centre [m], shape (4, 3, N).
    """
    work = np.empty(ROOM)
    for first in range(0, joints.shape[1], BLOCK):
        count = min(BLOCK, joints.shape[1] - first)
        _stand(arm, joints, first, count, work)
        for k in range(12):
            for n in range(count):
                body[k // 3, k % 3, first + n] = work[(BODY + k) * BLOCK + n]


@kernel
def residual(arm, reached, asked, standoff, psi, joints, off2, chord2):  # type: ignore[no-untyped-def]
    """How far the tool at joints is from where it is asked to be.

    Args:
        arm: `ArmGeometry`.
        reached: axes x, y, z of the tool and its tip [m] as sums over those of the flange and the wrist centre, 4 x 4.
        asked: axes and tip as they are asked to be, as `inverse` has those of the flange.
        standoff: [m], shape (N,).
        psi: [rad], shape (N,).
        joints: controller angles [rad], shape (6, N).
        off2: out, square of the distance of the tips [m^2], shape (N,).
        chord2: out, square of the Frobenius norm of the rotations' difference, shape (N,).
    """
    work = np.empty(ROOM)
    for first in range(0, standoff.shape[0], BLOCK):
        count = min(BLOCK, standoff.shape[0] - first)
        _along(standoff, psi, first, count, work)
        _stand(arm, joints, first, count, work)
        for n in range(count):
            h, c, s = work[STANDOFF * BLOCK + n], work[C * BLOCK + n], work[S * BLOCK + n]
            xx, xy, xz = work[(BODY + 0) * BLOCK + n], work[(BODY + 1) * BLOCK + n], work[(BODY + 2) * BLOCK + n]
            yx, yy, yz = work[(BODY + 3) * BLOCK + n], work[(BODY + 4) * BLOCK + n], work[(BODY + 5) * BLOCK + n]
            zx, zy, zz = work[(BODY + 6) * BLOCK + n], work[(BODY + 7) * BLOCK + n], work[(BODY + 8) * BLOCK + n]
            wx, wy, wz = work[(BODY + 9) * BLOCK + n], work[(BODY + 10) * BLOCK + n], work[(BODY + 11) * BLOCK + n]
            work[COS * BLOCK + n] = (
                _off2(reached[3], xx, yx, zx, wx, asked[3][0], h, c, s)
                + _off2(reached[3], xy, yy, zy, wy, asked[3][1], h, c, s)
                + _off2(reached[3], xz, yz, zz, wz, asked[3][2], h, c, s)
            )
            work[SIN * BLOCK + n] = (
                _off2(reached[0], xx, yx, zx, wx, asked[0][0], h, c, s)
                + _off2(reached[0], xy, yy, zy, wy, asked[0][1], h, c, s)
                + _off2(reached[0], xz, yz, zz, wz, asked[0][2], h, c, s)
                + _off2(reached[1], xx, yx, zx, wx, asked[1][0], h, c, s)
                + _off2(reached[1], xy, yy, zy, wy, asked[1][1], h, c, s)
                + _off2(reached[1], xz, yz, zz, wz, asked[1][2], h, c, s)
                + _off2(reached[2], xx, yx, zx, wx, asked[2][0], h, c, s)
                + _off2(reached[2], xy, yy, zy, wy, asked[2][1], h, c, s)
                + _off2(reached[2], xz, yz, zz, wz, asked[2][2], h, c, s)
            )
        for n in range(count):
            off2[first + n], chord2[first + n] = work[COS * BLOCK + n], work[SIN * BLOCK + n]


@kernel
def _along(standoff, psi, first, count, work):  # type: ignore[no-untyped-def]
    """The rows of stand-off and spin of a block."""
    for n in range(count):
        work[STANDOFF * BLOCK + n] = standoff[first + n]
        work[C * BLOCK + n] = psi[first + n]
    for n in range(count):
        work[C * BLOCK + n], work[S * BLOCK + n] = cos_sin(work[C * BLOCK + n])


@kernel
def _sum(parts, h, c, s):  # type: ignore[no-untyped-def]
    """A coordinate at a stand-off and a spin."""
    return parts[0] + h * parts[1] + c * parts[2] + s * parts[3]


@kernel
def _off2(reached, x, y, z, wrist, asked, h, c, s):  # type: ignore[no-untyped-def]
    """The square of what a coordinate is off."""
    off = reached[0] * x + reached[1] * y + reached[2] * z + reached[3] * wrist - _sum(asked, h, c, s)
    return off * off


@kernel
def _root(square, scale):  # type: ignore[no-untyped-def]
    """Square root, NaN below 0 but for rounding, which goes by a scale."""
    return np.sqrt(0.0 if (square < 0) & (square > -ROUNDING * scale) else square)


@kernel
def _turned(x, y, c, s):  # type: ignore[no-untyped-def]
    """Coordinates of a vector turned about the third axis, x towards y."""
    return c * x - s * y, s * x + c * y


@kernel
def _bend(arm, asked, posture, count, work):  # type: ignore[no-untyped-def]
    """The rows of the model angles' cosines and sines, each pair times a number above 0, at the poses of a block.

    The wrist centre, seen from above, is turned to the reach along x1 and b across it; shoulder, elbow and wrist
    centre are a triangle with known sides; axis 5 stands across axes 4 and 6.
    """
    forearm2 = arm.a2 * arm.a2 + arm.c3 * arm.c3
    for n in range(count):
        h, c, s = work[STANDOFF * BLOCK + n], work[C * BLOCK + n], work[S * BLOCK + n]
        wx, wy, wz = _sum(asked[3][0], h, c, s), _sum(asked[3][1], h, c, s), _sum(asked[3][2], h, c, s)
        # plan view: joint 1 turns (x1, b) to the wrist centre
        radius2 = wx * wx + wy * wy
        x1 = posture.reach * _root(radius2 - arm.b * arm.b, 1.0)
        c1, s1 = (wx * x1 + wy * arm.b) / radius2, (wy * x1 - wx * arm.b) / radius2
        # side view, (up, ahead), so that an angle is the lean from the vertical: the triangle of both links
        up, ahead = wz - arm.c1, x1 - arm.a1
        span2 = up * up + ahead * ahead
        along = 0.5 * (span2 + (arm.c2 * arm.c2 - forearm2))  # of the upper arm, times the span
        height = posture.elbow * _root(arm.c2 * arm.c2 * span2 - along * along, span2)
        upper_up, upper_ahead = up * along - ahead * height, ahead * along + up * height
        # axis 4 lies atan2(a2, c3) short of the line from elbow to wrist
        scale = 1.0 / (forearm2 * span2)
        lower_up, lower_ahead = (up * span2 - upper_up) * scale, (ahead * span2 - upper_ahead) * scale
        tilt_up, tilt_ahead = arm.c3 * lower_up + arm.a2 * lower_ahead, arm.c3 * lower_ahead - arm.a2 * lower_up
        # axis 5 stands across axes 4 and 6; seen along it from either side, the turns of joints 4 and 6
        xx, xy, xz = _sum(asked[0][0], h, c, s), _sum(asked[0][1], h, c, s), _sum(asked[0][2], h, c, s)
        yx, yy, yz = _sum(asked[1][0], h, c, s), _sum(asked[1][1], h, c, s), _sum(asked[1][2], h, c, s)
        zx, zy, zz = _sum(asked[2][0], h, c, s), _sum(asked[2][1], h, c, s), _sum(asked[2][2], h, c, s)
        level = c1 * zx + s1 * zy
        on_x = tilt_ahead * (c1 * xx + s1 * xy) + tilt_up * xz  # of axis 4
        on_y = tilt_ahead * (c1 * yx + s1 * yy) + tilt_up * yz
        on_6 = tilt_ahead * level + tilt_up * zz
        sine = np.sqrt(on_x * on_x + on_y * on_y)
        # with axes 4 and 6 in one line only the sum of their angles is known
        sign = posture.flip if sine > 0 else np.nan
        work[(COS + 0) * BLOCK + n], work[(SIN + 0) * BLOCK + n] = c1, s1
        work[(COS + 1) * BLOCK + n], work[(SIN + 1) * BLOCK + n] = upper_up, upper_ahead
        work[(COS + 2) * BLOCK + n] = tilt_up * upper_up + tilt_ahead * upper_ahead
        work[(SIN + 2) * BLOCK + n] = tilt_ahead * upper_up - tilt_up * upper_ahead
        work[(COS + 3) * BLOCK + n] = sign * (tilt_up * level - tilt_ahead * zz)
        work[(SIN + 3) * BLOCK + n] = sign * (c1 * zy - s1 * zx)
        work[(COS + 4) * BLOCK + n], work[(SIN + 4) * BLOCK + n] = on_6, sign * sine
        work[(COS + 5) * BLOCK + n], work[(SIN + 5) * BLOCK + n] = -sign * on_x, sign * on_y


@kernel
def _stand(arm, joints, first, count, work):  # type: ignore[no-untyped-def]
    """The rows of axes and wrist centre at the joints of a block, as a product of elementary turns and shifts.

    Rz(q1) T(a1, 0, c1) Ry(q2) T(0, 0, c2) Ry(q3) T(a2, b, c3) Rz(q4) Ry(q5) Rz(q6).
    """
    for j in range(6):
        sign, offset = arm.sign[j], arm.offset[j]
        for n in range(count):
            work[(COS + j) * BLOCK + n] = sign * joints[j, first + n] - offset
        for n in range(count):
            work[(COS + j) * BLOCK + n], work[(SIN + j) * BLOCK + n] = cos_sin(work[(COS + j) * BLOCK + n])
    for n in range(count):
        c1, c2, c3 = work[(COS + 0) * BLOCK + n], work[(COS + 1) * BLOCK + n], work[(COS + 2) * BLOCK + n]
        s1, s2, s3 = work[(SIN + 0) * BLOCK + n], work[(SIN + 1) * BLOCK + n], work[(SIN + 2) * BLOCK + n]
        c4, c5, c6 = work[(COS + 3) * BLOCK + n], work[(COS + 4) * BLOCK + n], work[(COS + 5) * BLOCK + n]
        s4, s5, s6 = work[(SIN + 3) * BLOCK + n], work[(SIN + 4) * BLOCK + n], work[(SIN + 5) * BLOCK + n]
        # axes x, y, z of the flange and the wrist centre, as joint after joint turns them
        xx, xy, xz = c5 * c6, s6, -s5 * c6
        yx, yy, yz = -c5 * s6, c6, s5 * s6
        xx, xy = _turned(xx, xy, c4, s4)
        yx, yy = _turned(yx, yy, c4, s4)
        zx, zy, zz = c4 * s5, s4 * s5, c5
        wx, wy, wz = arm.a2, arm.b, arm.c3
        xz, xx = _turned(xz, xx, c3, s3)
        yz, yx = _turned(yz, yx, c3, s3)
        zz, zx = _turned(zz, zx, c3, s3)
        wz, wx = _turned(wz, wx, c3, s3)
        wz += arm.c2
        xz, xx = _turned(xz, xx, c2, s2)
        yz, yx = _turned(yz, yx, c2, s2)
        zz, zx = _turned(zz, zx, c2, s2)
        wz, wx = _turned(wz, wx, c2, s2)
        wz, wx = wz + arm.c1, wx + arm.a1
        xx, xy = _turned(xx, xy, c1, s1)
        yx, yy = _turned(yx, yy, c1, s1)
        zx, zy = _turned(zx, zy, c1, s1)
        wx, wy = _turned(wx, wy, c1, s1)
        work[(BODY + 0) * BLOCK + n], work[(BODY + 1) * BLOCK + n], work[(BODY + 2) * BLOCK + n] = xx, xy, xz
        work[(BODY + 3) * BLOCK + n], work[(BODY + 4) * BLOCK + n], work[(BODY + 5) * BLOCK + n] = yx, yy, yz
        work[(BODY + 6) * BLOCK + n], work[(BODY + 7) * BLOCK + n], work[(BODY + 8) * BLOCK + n] = zx, zy, zz
        work[(BODY + 9) * BLOCK + n], work[(BODY + 10) * BLOCK + n], work[(BODY + 11) * BLOCK + n] = wx, wy, wz
