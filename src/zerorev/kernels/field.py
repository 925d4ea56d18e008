"""The two rate fields of the twist plane at many points at once (theory §1).

The loop over the points is free of branches, calls and inverse trigonometry, and all that it reads and writes lies in
one array at distances known when it is compiled, so that the compiler can work on several points at a time. A pose out
of reach, or at a singularity of shoulder, elbow or wrist, needs no branch either: it comes out as NaN.

Lengths in m, angles in rad.
"""

from __future__ import annotations

import numpy as np

from zerorev.kernels._jit import kernel, lean
from zerorev.kernels.arm import WRIST_SINGULAR

# A workspace is a flat array of ROOM numbers, in rows of BLOCK points: what goes in, theta_s and theta_psi of the six
# joints, and a few rows for those who make something of them.
BLOCK = 96
STANDOFF, PSI, THETA_S, THETA_PSI, SLOPE, WORST, MOTION, SIGNS = 0, 1, 2, 8, 14, 15, 16, 17
ROOM = 18 * BLOCK

_HALF_PI_HIGH = 1.5707963267341256  # the leading 33 bits, so that a few turns times it is exact
_HALF_PI_LOW = 6.077100506506192e-11


@lean
def cos_sin(x):  # type: ignore[no-untyped-def]
    """Cosine and sine of an angle of a few turns [rad], to the last two bits, without a branch.

    Minimax polynomials on [-pi/4, pi/4] (the coefficients are fdlibm's), the quarter turn taken off beforehand.
    """
    k = np.floor(x * (2.0 / np.pi) + 0.5)
    r = (x - k * _HALF_PI_HIGH) - k * _HALF_PI_LOW
    z = r * r
    sin = r + r * z * (
        -1.66666666666666324348e-01
        + z * (8.33333333332248946124e-03
        + z * (-1.98412698298579493134e-04
        + z * (2.75573137070700676789e-06
        + z * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10))))
    )  # fmt: skip
    cos = 1.0 - 0.5 * z + z * z * (
        4.16666666666666019037e-02
        + z * (-1.38888888888741095749e-03
        + z * (2.48015872894767294178e-05
        + z * (-2.75573143513906633035e-07
        + z * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11))))
    )  # fmt: skip
    quarter = k - 4.0 * np.floor(0.25 * k)
    odd = (quarter == 1.0) | (quarter == 3.0)
    c, s = (sin if odd else cos), (cos if odd else sin)
    return (-c if (quarter == 1.0) | (quarter == 2.0) else c), (-s if quarter >= 2.0 else s)


@lean
def spun(plane, v0, v1, v2):  # type: ignore[no-untyped-def]
    """A vector of the tcp frame seen from the base as the tool spins: its constant, its cosine and its sine part."""
    x0, y0, zx, x1, y1, zy, x2, y2, zz = plane.R_base_tcp0
    return (
        (zx * v2, zy * v2, zz * v2),
        (x0 * v0 + y0 * v1, x1 * v0 + y1 * v1, x2 * v0 + y2 * v1),
        (y0 * v0 - x0 * v1, y1 * v0 - x1 * v1, y2 * v0 - x2 * v1),
    )


@lean
def fields(arm, plane, posture, count, work):  # type: ignore[no-untyped-def]
    """Both rate fields of one posture at up to BLOCK points, for sin(q5) > 0.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        posture: 0..3.
        count: how many points, at most BLOCK.
        work: in and out, shape (ROOM,): stand-offs [m] and spins [rad] go in; d theta / d s [rad/m] and
            d theta / d psi [1] of the six controller angles come out, NaN where there are none.
    """
    zx, zy, zz = plane.R_base_tcp0[2], plane.R_base_tcp0[5], plane.R_base_tcp0[8]
    w0, w1, w2 = plane.wrist
    t0, t1, t2 = plane.target
    # flange axis and lever of the spin
    (fx, fy, fz), (fcx, fcy, fcz), (fsx, fsy, fsz) = spun(
        plane, plane.R_tcp_flange[2], plane.R_tcp_flange[5], plane.R_tcp_flange[8]
    )
    _, (rcx, rcy, rcz), (rsx, rsy, rsz) = spun(plane, w0, w1, 0.0)
    k2 = arm.a2 * arm.a2 + arm.c3 * arm.c3
    k = np.sqrt(k2)
    per_links = 1.0 / (2.0 * arm.c2 * k)
    links2 = arm.c2 * arm.c2 + k2
    cos3, sin3 = arm.c3 / k, arm.a2 / k
    ahead = -1.0 if posture >= 2 else 1.0
    bend = -1.0 if (posture % 2 == 1) != (posture >= 2) else 1.0
    g1, g2, g3, g4, g5, g6 = arm.sign
    for n in range(count):
        c, s = cos_sin(work[PSI * BLOCK + n])
        rx, ry, rz = c * rcx + s * rsx, c * rcy + s * rsy, c * rcz + s * rsz
        along = work[STANDOFF * BLOCK + n] + w2
        wx, wy, wz = t0 + along * zx + rx, t1 + along * zy + ry, t2 + along * zz + rz
        # joint 1: the wrist centre lies at (x1, b) in the frame turned with it
        squared = wx * wx + wy * wy
        per_squared = 1.0 / squared
        x_turned = ahead * np.sqrt(squared - arm.b * arm.b)
        c1, s1 = (wx * x_turned + wy * arm.b) * per_squared, (wy * x_turned - wx * arm.b) * per_squared
        # joints 2 and 3: two links in the arm's plane
        x, z = x_turned - arm.a1, wz - arm.c1
        reach2 = x * x + z * z
        cos_phi = (reach2 - links2) * per_links
        sin_phi = bend * np.sqrt(1.0 - cos_phi * cos_phi)
        per_reach = 1.0 / reach2
        past, across = arm.c2 + k * cos_phi, k * sin_phi
        c2, s2 = (past * z + across * x) * per_reach, (past * x - across * z) * per_reach
        c3, s3 = cos_phi * cos3 + sin_phi * sin3, sin_phi * cos3 - cos_phi * sin3
        c23, s23 = c2 * c3 - s2 * s3, s2 * c3 + c2 * s3
        ux, uz = arm.c2 * s2, arm.c2 * c2
        lx, lz = arm.a2 * c23 + arm.c3 * s23, arm.c3 * c23 - arm.a2 * s23
        # joints 4 and 5: where the flange axis points in frame 3
        ax, ay, az = fx + c * fcx + s * fsx, fy + c * fcy + s * fsy, fz + c * fcz + s * fsz
        forward = c1 * ax + s1 * ay
        m0, m1, c5 = c23 * forward - s23 * az, c1 * ay - s1 * ax, s23 * forward + c23 * az
        s5 = np.sqrt(m0 * m0 + m1 * m1)
        det = ux * lz - uz * lx
        clear = (s5 > WRIST_SINGULAR) & (abs(x_turned) > 1e-12) & (abs(det) > 1e-14)
        per_s5 = 1.0 / s5 if clear else np.nan
        c4, s4 = m0 * per_s5, m1 * per_s5
        per_x, per_det = 1.0 / x_turned, 1.0 / det

        # straight out: the wrist centre moves along z, nothing turns
        q1 = (c1 * zy - s1 * zx) * per_x
        dx = c1 * zx + s1 * zy + arm.b * q1
        q2, q23 = -(lx * dx + lz * zz) * per_det, (ux * dx + uz * zz) * per_det
        ox, oy, oz = s23 * q1, -q23, -c23 * q1
        q6 = (c4 * ox + s4 * oy) * per_s5
        # a joint that does not depend on the wrist is NaN with it, so that NaN in one shows NaN in all
        blank = 0.0 * per_s5
        work[(THETA_S + 0) * BLOCK + n] = g1 * q1 + blank
        work[(THETA_S + 1) * BLOCK + n] = g2 * q2 + blank
        work[(THETA_S + 2) * BLOCK + n] = g3 * (q23 - q2) + blank
        work[(THETA_S + 3) * BLOCK + n] = g4 * (oz - c5 * q6)
        work[(THETA_S + 4) * BLOCK + n] = g5 * (c4 * oy - s4 * ox)
        work[(THETA_S + 5) * BLOCK + n] = g6 * q6

        # spinning: the wrist centre moves at z x r, the tool turns about z
        vx, vy, vz = zy * rz - zz * ry, zz * rx - zx * rz, zx * ry - zy * rx
        q1 = (c1 * vy - s1 * vx) * per_x
        dx = c1 * vx + s1 * vy + arm.b * q1
        q2, q23 = -(lx * dx + lz * vz) * per_det, (ux * dx + uz * vz) * per_det
        turned = c1 * zx + s1 * zy
        ox, oy, oz = c23 * turned - s23 * (zz - q1), c1 * zy - s1 * zx - q23, s23 * turned + c23 * (zz - q1)
        q6 = (c4 * ox + s4 * oy) * per_s5
        work[(THETA_PSI + 0) * BLOCK + n] = g1 * q1 + blank
        work[(THETA_PSI + 1) * BLOCK + n] = g2 * q2 + blank
        work[(THETA_PSI + 2) * BLOCK + n] = g3 * (q23 - q2) + blank
        work[(THETA_PSI + 3) * BLOCK + n] = g4 * (oz - c5 * q6)
        work[(THETA_PSI + 4) * BLOCK + n] = g5 * (c4 * oy - s4 * ox)
        work[(THETA_PSI + 5) * BLOCK + n] = g6 * q6


@kernel
def rates(arm, plane, posture, standoff, psi, theta_s, theta_psi):  # type: ignore[no-untyped-def]
    """Both rate fields of one posture at many points, for sin(q5) > 0.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        posture: 0..3.
        standoff: s [m], shape (N,).
        psi: spin [rad], shape (N,).
        theta_s: out, shape (6, N) [rad/m]; NaN where the posture cannot reach or is singular.
        theta_psi: out, shape (6, N) [1].
    """
    work = np.empty(ROOM)
    for first in range(0, standoff.shape[0], BLOCK):
        count = min(BLOCK, standoff.shape[0] - first)
        for n in range(count):
            work[STANDOFF * BLOCK + n] = standoff[first + n]
            work[PSI * BLOCK + n] = psi[first + n]
        fields(arm, plane, posture, count, work)
        for i in range(6):
            for n in range(count):
                theta_s[i, first + n] = work[(THETA_S + i) * BLOCK + n]
                theta_psi[i, first + n] = work[(THETA_PSI + i) * BLOCK + n]
