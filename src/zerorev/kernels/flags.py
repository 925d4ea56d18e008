"""Which way all joints go, and whether they are within their limits, at many points of the twist plane (theory §2).

What decides whether a joint reverses is the sign of its rate alone, and a limit is a matter of being inside an arc: so
nothing is computed that only scales a sign, there is no angle, and what the eight branches share is computed once. As
in `kernels.field`, the loops over the points are free of branches and calls, on rows of one workspace.

Lengths in m, angles in rad.
"""

from __future__ import annotations

import numpy as np

from zerorev.kernels._jit import kernel
from zerorev.kernels.arm import WRIST_SINGULAR
from zerorev.kernels.field import cos_sin, spun

# bits of a branch at a point: + joint (0..5) for the first three
RISES_WITH_S, RISES_WITH_PSI, OUTSIDE, NO_POSE = 0, 6, 12, 18

BLOCK = 128  # points at once: as many as stay in the fastest cache
# rows of the workspace: what all postures share of a point, and what those of one shoulder share
REACH, PER_REACH, PER_SQUARED, WX, WY, Z, VX, VY, VZ, AX, AY, AZ, BX, BY, BZ = range(15)
X, UX, UZ, UX_BENT, UZ_BENT, COS_PHI, SIN_PHI, PER_DET, Q1_S, Q1_PSI = range(15, 25)
DX_S, DX_PSI, LINE_S, LINE_PSI, Z_AHEAD, Z_ASIDE, A_AHEAD, A_ASIDE, B_AHEAD = range(25, 34)
ROOM = 34 * BLOCK


@kernel
def sign_flags(arm, plane, lower, upper, standoff, psi, out):  # type: ignore[no-untyped-def]
    """In which directions the joints go, and which of them are outside their limits, in all eight branches.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        lower: least controller angles [rad], shape (6,); a joint that can be brought within by full turns is within.
        upper: greatest controller angles [rad], shape (6,).
        standoff: s [m], shape (N,).
        psi: spin [rad], shape (N,).
        out: out, int32, shape (8, N): bits RISES_WITH_S + i where d theta_i / d s > 0, RISES_WITH_PSI + i where
            d theta_i / d psi > 0 (either where it is 0), OUTSIDE + i where joint i is outside its limits; NO_POSE, and
            nothing else, where the branch cannot reach or is singular.
    """
    work, shared = np.empty(ROOM), np.empty(BLOCK, dtype=np.int64)
    arcs = np.empty((6, 3))
    for i in range(6):
        _arc(arm, i, lower[i], upper[i], arcs)
    axis = (plane.R_base_tcp0[2], plane.R_base_tcp0[5], plane.R_base_tcp0[8])
    for first in range(0, standoff.shape[0], BLOCK):
        last = min(first + BLOCK, standoff.shape[0])
        _spin(arm, plane, standoff[first:last], psi[first:last], arcs, work)
        for shoulder in range(2):
            _turn(arm, axis, shoulder, arcs, last - first, work, shared)
            for elbow in range(2):
                plus = 4 * shoulder + 2 * elbow + (0 if arm.sign[4] > 0.0 else 1)
                _bend(
                    arm, axis, shoulder, elbow, arcs, last - first, work, shared, out[plus, first:last],
                    out[plus ^ 1, first:last],
                )  # fmt: skip


@kernel
def _arc(arm, i, low, high, arcs):  # type: ignore[no-untyped-def]
    """The arc of model angles within the limits: cosine and sine of its middle, cosine of half its width."""
    half = 0.5 * (high - low)
    if half >= np.pi:
        arcs[i] = 0.0, 0.0, -1.0
        return
    middle = arm.sign[i] * 0.5 * (low + high) - arm.offset[i]
    arcs[i] = np.cos(middle), np.sin(middle), np.cos(half)


@kernel
def _spin(arm, plane, standoff, psi, arcs, work):  # type: ignore[no-untyped-def]
    """What all postures share, in the base frame.

    The wrist centre and its velocity under spin, the flange's axis (a), and the direction across it of which joint 6
    sees the part along its own zero: with the middle of its limits there (b).
    """
    _, _, zx, _, _, zy, _, _, zz = plane.R_base_tcp0
    f00, f01, f02, f10, f11, f12, f20, f21, f22 = plane.R_tcp_flange
    w0, w1, w2 = plane.wrist
    t0, t1, t2 = plane.target
    a, a_c, a_s = spun(plane, f02, f12, f22)
    cc6, cs6, _ = arcs[5]
    b, b_c, b_s = spun(plane, cs6 * f01 - cc6 * f00, cs6 * f11 - cc6 * f10, cs6 * f21 - cc6 * f20)
    _, r_c, r_s = spun(plane, w0, w1, 0.0)
    for n in range(standoff.shape[0]):
        c, s = cos_sin(psi[n])
        rx, ry, rz = c * r_c[0] + s * r_s[0], c * r_c[1] + s * r_s[1], c * r_c[2] + s * r_s[2]
        along = standoff[n] + w2
        wx, wy = t0 + along * zx + rx, t1 + along * zy + ry
        squared = wx * wx + wy * wy
        reach = np.sqrt(squared - arm.b * arm.b)
        per_both = 1.0 / (squared * reach)
        work[WX * BLOCK + n], work[WY * BLOCK + n] = wx, wy
        work[REACH * BLOCK + n] = reach
        work[PER_REACH * BLOCK + n], work[PER_SQUARED * BLOCK + n] = squared * per_both, reach * per_both
        work[Z * BLOCK + n] = t2 - arm.c1 + along * zz + rz
        work[VX * BLOCK + n] = zy * rz - zz * ry
        work[VY * BLOCK + n] = zz * rx - zx * rz
        work[VZ * BLOCK + n] = zx * ry - zy * rx
        work[AX * BLOCK + n] = a[0] + c * a_c[0] + s * a_s[0]
        work[AY * BLOCK + n] = a[1] + c * a_c[1] + s * a_s[1]
        work[AZ * BLOCK + n] = a[2] + c * a_c[2] + s * a_s[2]
        work[BX * BLOCK + n] = b[0] + c * b_c[0] + s * b_s[0]
        work[BY * BLOCK + n] = b[1] + c * b_c[1] + s * b_s[1]
        work[BZ * BLOCK + n] = b[2] + c * b_c[2] + s * b_s[2]


@kernel
def _turn(arm, axis, shoulder, arcs, count, work, shared):  # type: ignore[no-untyped-def]
    """What both elbows of a shoulder (0 ahead, 1 behind) share: all seen in the plane that joint 1 turns."""
    zx, zy, zz = axis
    ahead = -1.0 if shoulder == 1 else 1.0
    k2 = arm.a2 * arm.a2 + arm.c3 * arm.c3
    k = np.sqrt(k2)
    per_links, links2, per_det = 1.0 / (2.0 * arm.c2 * k), arm.c2 * arm.c2 + k2, -1.0 / (arm.c2 * k)
    cc, cs, least = arcs[0]
    for n in range(count):
        wx, wy, z = work[WX * BLOCK + n], work[WY * BLOCK + n], work[Z * BLOCK + n]
        x_turned, per_x = ahead * work[REACH * BLOCK + n], ahead * work[PER_REACH * BLOCK + n]
        per_squared = work[PER_SQUARED * BLOCK + n]
        c1, s1 = (wx * x_turned + wy * arm.b) * per_squared, (wy * x_turned - wx * arm.b) * per_squared
        # the upper arm, bent either way from the line to the wrist centre
        x = x_turned - arm.a1
        reach2 = x * x + z * z
        cos_phi = (reach2 - links2) * per_links
        sin_phi = np.sqrt(1.0 - cos_phi * cos_phi)
        clear = (abs(x_turned) > 1e-12) & (arm.c2 * k * sin_phi > 1e-14)
        x = x if clear else np.nan
        per_both = 1.0 / (reach2 * sin_phi)
        upper_arm = arm.c2 * sin_phi * per_both
        past, across = (arm.c2 + k * cos_phi) * upper_arm, k * sin_phi * upper_arm
        # the drill axis, the flange's axes and both motions of the wrist centre
        z_ahead, z_aside = c1 * zx + s1 * zy, c1 * zy - s1 * zx
        vx, vy, vz = work[VX * BLOCK + n], work[VY * BLOCK + n], work[VZ * BLOCK + n]
        q1_s, q1_psi = z_aside * per_x, (c1 * vy - s1 * vx) * per_x
        dx_s, dx_psi = z_ahead + arm.b * q1_s, c1 * vx + s1 * vy + arm.b * q1_psi
        # how fast the line to the wrist centre grows: both links then turn together, whichever way the elbow is bent
        line_s, line_psi = x * dx_s + z * zz, x * dx_psi + z * vz
        ax, ay = work[AX * BLOCK + n], work[AY * BLOCK + n]
        work[X * BLOCK + n] = x
        work[UX * BLOCK + n], work[UX_BENT * BLOCK + n] = past * x, -across * z
        work[UZ * BLOCK + n], work[UZ_BENT * BLOCK + n] = past * z, across * x
        work[COS_PHI * BLOCK + n], work[SIN_PHI * BLOCK + n] = cos_phi, sin_phi
        work[PER_DET * BLOCK + n] = per_det * reach2 * per_both
        work[DX_S * BLOCK + n], work[DX_PSI * BLOCK + n] = dx_s, dx_psi
        work[LINE_S * BLOCK + n], work[LINE_PSI * BLOCK + n] = line_s, line_psi
        work[Q1_S * BLOCK + n], work[Q1_PSI * BLOCK + n] = q1_s, q1_psi
        work[Z_AHEAD * BLOCK + n], work[Z_ASIDE * BLOCK + n] = z_ahead, z_aside
        work[A_AHEAD * BLOCK + n], work[A_ASIDE * BLOCK + n] = c1 * ax + s1 * ay, c1 * ay - s1 * ax
        work[B_AHEAD * BLOCK + n] = c1 * work[BX * BLOCK + n] + s1 * work[BY * BLOCK + n]
        shared[n] = (
            (q1_s > 0.0)
            | ((q1_psi > 0.0) << RISES_WITH_PSI)
            | ((line_s < 0.0) << (RISES_WITH_S + 2))
            | ((line_psi < 0.0) << (RISES_WITH_PSI + 2))
            | ((cc * c1 + cs * s1 < least) << OUTSIDE)
        )


@kernel
def _bend(arm, axis, shoulder, elbow, arcs, count, work, shared, plus, minus):  # type: ignore[no-untyped-def]
    """The bits of one posture's two branches, sin(q5) > 0 first; `elbow` is 1 where it is below."""
    zz = axis[2]
    bent = -1.0 if elbow != shoulder else 1.0
    k2 = arm.a2 * arm.a2 + arm.c3 * arm.c3
    a2, c3 = arm.a2 / k2, arm.c3 / k2
    cos3, sin3 = arm.c3 / np.sqrt(k2), arm.a2 / np.sqrt(k2)
    cc2, cs2, least2 = arcs[1, 0], arcs[1, 1], arcs[1, 2] * arm.c2
    cc3, cs3 = arcs[2, 0] * cos3 - arcs[2, 1] * sin3, bent * (arcs[2, 0] * sin3 + arcs[2, 1] * cos3)
    least3 = arcs[2, 2]
    # joints 4 to 6 are known up to the sine of joint 5, whose square is at hand: t < u v is t |t| < u |u| v^2, v > 0
    cc4, cs4, least4 = arcs[3, 0], arcs[3, 1], arcs[3, 2] * abs(arcs[3, 2])
    cc5, cs5, least5 = arcs[4, 0], arcs[4, 1] * abs(arcs[4, 1]), arcs[4, 2]
    least6 = arcs[5, 2] * abs(arcs[5, 2])
    # joints that the controller counts the other way round, and that the elbow turns the other way
    turned = 0
    for i in range(6):
        if (arm.sign[i] < 0.0) != (bent < 0.0 and 0 < i < 3):
            turned |= (1 << (RISES_WITH_S + i)) | (1 << (RISES_WITH_PSI + i))
    flip = (1 << (RISES_WITH_S + 4)) | (1 << (RISES_WITH_PSI + 4))
    for n in range(count):
        x, z = work[X * BLOCK + n], work[Z * BLOCK + n]
        ux = work[UX * BLOCK + n] + bent * work[UX_BENT * BLOCK + n]
        uz = work[UZ * BLOCK + n] + bent * work[UZ_BENT * BLOCK + n]
        lx, lz = x - ux, z - uz
        c23, s23 = a2 * lx + c3 * lz, c3 * lx - a2 * lz
        a_ahead, m1, az = work[A_AHEAD * BLOCK + n], work[A_ASIDE * BLOCK + n], work[AZ * BLOCK + n]
        m0, c5 = c23 * a_ahead - s23 * az, s23 * a_ahead + c23 * az
        s55 = m0 * m0 + m1 * m1
        per_det = bent * work[PER_DET * BLOCK + n]

        # straight out: the wrist has to undo what joints 1 to 3 turn
        dx, q1 = work[DX_S * BLOCK + n], work[Q1_S * BLOCK + n]
        upper = ux * dx + uz * zz
        q2_s, q23 = upper < work[LINE_S * BLOCK + n], upper * per_det
        o = s23 * q1
        q6_s, minus_q5_s = m0 * o - m1 * q23, m0 * q23 + m1 * o
        minus_q4_s = c23 * q1 * s55 + c5 * q6_s

        # spinning: and to turn about the drill axis
        dx, q1, vz = work[DX_PSI * BLOCK + n], work[Q1_PSI * BLOCK + n], work[VZ * BLOCK + n]
        upper = ux * dx + uz * vz
        q2_psi, q23 = upper < work[LINE_PSI * BLOCK + n], upper * per_det
        ahead, up = work[Z_AHEAD * BLOCK + n], zz - q1
        ox, oy, oz = c23 * ahead - s23 * up, work[Z_ASIDE * BLOCK + n] - q23, s23 * ahead + c23 * up
        q6_psi, q5_psi = m0 * ox + m1 * oy, m0 * oy - m1 * ox
        q4_psi = oz * s55 - c5 * q6_psi

        # limits of joints 4 to 6, on either wrist flip
        t4 = cc4 * m0 + cs4 * m1
        t5 = least5 - cc5 * c5
        t6 = s23 * work[B_AHEAD * BLOCK + n] + c23 * work[BZ * BLOCK + n]
        t4, t5, t6 = t4 * abs(t4), t5 * abs(t5), t6 * abs(t6)
        bound4, bound5, bound6 = least4 * s55, cs5 * s55, least6 * s55

        both = (
            shared[n]
            | (q2_s << (RISES_WITH_S + 1))
            | ((minus_q4_s < 0.0) << (RISES_WITH_S + 3))
            | ((minus_q5_s < 0.0) << (RISES_WITH_S + 4))
            | ((q6_s > 0.0) << (RISES_WITH_S + 5))
            | (q2_psi << (RISES_WITH_PSI + 1))
            | ((q4_psi > 0.0) << (RISES_WITH_PSI + 3))
            | ((q5_psi > 0.0) << (RISES_WITH_PSI + 4))
            | ((q6_psi > 0.0) << (RISES_WITH_PSI + 5))
            | ((cc2 * uz + cs2 * ux < least2) << (OUTSIDE + 1))
            | ((cc3 * work[COS_PHI * BLOCK + n] + cs3 * work[SIN_PHI * BLOCK + n] < least3) << (OUTSIDE + 2))
        ) ^ turned
        # no choice between two values: the compiler would skip the work for one of them, point by point
        none = np.int64(not s55 > WRIST_SINGULAR * WRIST_SINGULAR)
        pose, none = none - 1, none << NO_POSE
        a = (
            both
            | ((t4 < bound4) << (OUTSIDE + 3))
            | ((bound5 < t5) << (OUTSIDE + 4))
            | ((t6 < bound6) << (OUTSIDE + 5))
        )
        b = (both ^ flip) | (
            ((-t4 < bound4) << (OUTSIDE + 3)) | ((-bound5 < t5) << (OUTSIDE + 4)) | ((-t6 < bound6) << (OUTSIDE + 5))
        )
        plus[n] = (a & pose) | none
        minus[n] = (b & pose) | none
