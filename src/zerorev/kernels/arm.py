"""The arm: forward kinematics, inverse kinematics in all branches, and the two rate fields of the twist plane.

Written from the cosines and sines of the joints, which come out of the inverse kinematics algebraically; joint angles
(atan2) are taken only where a caller asks for them. Lengths in m, angles in rad. No kernel raises: a pose out of reach
is False, or a row of NaN.

A *posture* is one of the four arm solutions, 2 * (wrist centre behind axis 1) + (elbow below the line shoulder-wrist);
a *branch* is 2 * posture + (A5 < 0), A5 counted from the straight wrist. "Below" is judged with the arm reaching
forward, and mirrored for the arm that reaches back, so that it is the sense in which the elbow bends and stays what it
is when the arm swings over its top.
"""

from __future__ import annotations

import numpy as np

from zerorev.kernels._jit import kernel, lean

# Below this sine of joint 5 the axes 4 and 6 coincide as far as double precision can tell.
WRIST_SINGULAR = 1e-10


@lean
def solve_posture(arm, R, wx, wy, wz, posture, cs):  # type: ignore[no-untyped-def]
    """Cosines and sines of the model angles of one posture, with sin(q5) >= 0.

    Args:
        arm: `ArmGeometry`.
        R: flange rotation, row by row, nine numbers.
        wx: wrist centre, x [m].
        wy: wrist centre, y [m].
        wz: wrist centre, z [m].
        posture: 0..3.
        cs: out, shape (6, 2): cosine and sine of each model angle.

    Returns:
        whether the pose can be reached in this posture.
    """
    squared = wx * wx + wy * wy
    ahead = squared - arm.b * arm.b
    if not (ahead >= 0.0 and squared > 0.0):
        return False
    # wrist centre in the frame turned with axis 1: (x1, b, wz)
    x1 = np.sqrt(ahead)
    back = posture >= 2
    if back:
        x1 = -x1
    cs[0, 0] = (wx * x1 + wy * arm.b) / squared
    cs[0, 1] = (wy * x1 - wx * arm.b) / squared

    # two links in the arm's plane: upper arm c2, forearm k = |(a2, c3)|, bent by phi at the elbow
    x, z = x1 - arm.a1, wz - arm.c1
    reach2 = x * x + z * z
    k2 = arm.a2 * arm.a2 + arm.c3 * arm.c3
    k = np.sqrt(k2)
    cos_phi = (reach2 - arm.c2 * arm.c2 - k2) / (2.0 * arm.c2 * k)
    bend2 = 1.0 - cos_phi * cos_phi
    if not (bend2 >= 0.0 and reach2 > 0.0):
        return False
    sin_phi = np.sqrt(bend2)
    below = posture % 2 == 1
    if below != back:
        sin_phi = -sin_phi
    along, across = arm.c2 + k * cos_phi, k * sin_phi
    cs[1, 0] = (along * z + across * x) / reach2
    cs[1, 1] = (along * x - across * z) / reach2
    cs[2, 0] = (cos_phi * arm.c3 + sin_phi * arm.a2) / k
    cs[2, 1] = (sin_phi * arm.c3 - cos_phi * arm.a2) / k

    # M = R03^T R = Rz(q4) Ry(q5) Rz(q6)
    r00, r01, r02, r10, r11, r12, r20, r21, r22 = R
    c1, s1 = cs[0, 0], cs[0, 1]
    c23 = cs[1, 0] * cs[2, 0] - cs[1, 1] * cs[2, 1]
    s23 = cs[1, 1] * cs[2, 0] + cs[1, 0] * cs[2, 1]
    f0 = c1 * r02 + s1 * r12
    m02 = c23 * f0 - s23 * r22
    m12 = c1 * r12 - s1 * r02
    m22 = s23 * f0 + c23 * r22
    sin5 = np.sqrt(m02 * m02 + m12 * m12)
    cs[4, 0], cs[4, 1] = m22, sin5
    if sin5 > WRIST_SINGULAR:
        c4, s4 = m02 / sin5, m12 / sin5
    else:  # axes 4 and 6 coincide: all of their common turn goes to joint 6
        c4, s4 = 1.0, 0.0
    cs[3, 0], cs[3, 1] = c4, s4
    # joint 6 from Rz(-q4) M, so that it makes good what q4 lacks in precision where sin(q5) is small
    g0 = c1 * r00 + s1 * r10
    g1 = c1 * r01 + s1 * r11
    cs[5, 0] = c4 * (c1 * r11 - s1 * r01) - s4 * (c23 * g1 - s23 * r21)
    cs[5, 1] = c4 * (c1 * r10 - s1 * r00) - s4 * (c23 * g0 - s23 * r20)
    return True


@lean
def joint_velocity(arm, cs, vx, vy, vz, ox, oy, oz, out):  # type: ignore[no-untyped-def]
    """Controller joint rates that move the wrist centre at v and turn the flange at o, for sin(q5) > 0.

    The flipped wrist has the same rates but for joint 5, whose sign is the other (theory §1). At a singularity the
    rates are NaN.

    Args:
        arm: `ArmGeometry`.
        cs: cosines and sines of the model angles, shape (6, 2).
        vx: velocity of the wrist centre in the base frame, x.
        vy: the same, y.
        vz: the same, z.
        ox: angular velocity of the flange in the base frame, x.
        oy: the same, y.
        oz: the same, z.
        out: out, shape (6,): rates of the controller angles.
    """
    c1, s1, c2, s2 = cs[0, 0], cs[0, 1], cs[1, 0], cs[1, 1]
    c23 = c2 * cs[2, 0] - s2 * cs[2, 1]
    s23 = s2 * cs[2, 0] + c2 * cs[2, 1]
    ux, uz = arm.c2 * s2, arm.c2 * c2  # shoulder to elbow, in the arm's plane
    fx, fz = arm.a2 * c23 + arm.c3 * s23, arm.c3 * c23 - arm.a2 * s23  # elbow to wrist centre
    x1 = arm.a1 + ux + fx

    c4, s4, c5, s5 = cs[3, 0], cs[3, 1], cs[4, 0], cs[4, 1]
    det = ux * fz - uz * fx
    if not (s5 > WRIST_SINGULAR and abs(x1) > 1e-12 and abs(det) > 1e-14):
        for i in range(6):
            out[i] = np.nan
        return

    q1 = (c1 * vy - s1 * vx) / x1
    dx = c1 * vx + s1 * vy + arm.b * q1
    q2 = -(fx * dx + fz * vz) / det
    q23 = (ux * dx + uz * vz) / det

    # what is left of the turning, seen in frame 3, is the wrist's
    h0 = c1 * ox + s1 * oy
    wx = c23 * h0 - s23 * (oz - q1)
    wy = c1 * oy - s1 * ox - q23
    wz = s23 * h0 + c23 * (oz - q1)
    q6 = (c4 * wx + s4 * wy) / s5

    sign = arm.sign
    out[0] = sign[0] * q1
    out[1] = sign[1] * q2
    out[2] = sign[2] * (q23 - q2)
    out[3] = sign[3] * (wz - c5 * q6)
    out[4] = sign[4] * (c4 * wy - s4 * wx)
    out[5] = sign[5] * q6


@lean
def solve_at(arm, plane, standoff, psi, posture, cs):  # type: ignore[no-untyped-def]
    """`solve_posture` at one point of the twist plane.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        standoff: s [m].
        psi: spin [rad].
        posture: 0..3.
        cs: out, shape (6, 2): cosines and sines of the model angles.

    Returns:
        whether the pose can be reached in this posture, and the lever of the spin: from the drill axis to the wrist
        centre, base frame [m].
    """
    c, s = np.cos(psi), np.sin(psi)
    x0, y0, zx, x1, y1, zy, x2, y2, zz = plane.R_base_tcp0
    # the tcp frame turned by psi about its z axis: columns a, b, z
    a0, a1, a2 = c * x0 + s * y0, c * x1 + s * y1, c * x2 + s * y2
    b0, b1, b2 = c * y0 - s * x0, c * y1 - s * x1, c * y2 - s * x2
    f00, f01, f02, f10, f11, f12, f20, f21, f22 = plane.R_tcp_flange
    R = (
        a0 * f00 + b0 * f10 + zx * f20, a0 * f01 + b0 * f11 + zx * f21, a0 * f02 + b0 * f12 + zx * f22,
        a1 * f00 + b1 * f10 + zy * f20, a1 * f01 + b1 * f11 + zy * f21, a1 * f02 + b1 * f12 + zy * f22,
        a2 * f00 + b2 * f10 + zz * f20, a2 * f01 + b2 * f11 + zz * f21, a2 * f02 + b2 * f12 + zz * f22,
    )  # fmt: skip
    # wrist centre: the tip, and the lever of the spin turned with it
    w0, w1, w2 = plane.wrist
    rx, ry, rz = a0 * w0 + b0 * w1, a1 * w0 + b1 * w1, a2 * w0 + b2 * w1
    along = standoff + w2
    t0, t1, t2 = plane.target
    wx, wy, wz = t0 + along * zx + rx, t1 + along * zy + ry, t2 + along * zz + rz
    return solve_posture(arm, R, wx, wy, wz, posture, cs), rx, ry, rz


@lean
def twist_field(arm, plane, standoff, psi, posture, cs, theta_s, theta_psi):  # type: ignore[no-untyped-def]
    """The two rate fields at one point of the twist plane, for sin(q5) > 0 (theory §1); `field.rates` is for many.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        standoff: s [m].
        psi: spin [rad].
        posture: 0..3.
        cs: out, shape (6, 2): cosines and sines of the model angles.
        theta_s: out, shape (6,): d theta / d s [rad/m], controller angles.
        theta_psi: out, shape (6,): d theta / d psi [1], controller angles.

    Returns:
        whether the pose can be reached in this posture.
    """
    reached, rx, ry, rz = solve_at(arm, plane, standoff, psi, posture, cs)
    if not reached:
        return False
    _, _, zx, _, _, zy, _, _, zz = plane.R_base_tcp0
    joint_velocity(arm, cs, zx, zy, zz, 0.0, 0.0, 0.0, theta_s)
    joint_velocity(arm, cs, zy * rz - zz * ry, zz * rx - zx * rz, zx * ry - zy * rx, zx, zy, zz, theta_psi)
    return True


@lean
def controller_angles(arm, cs, negative, out):  # type: ignore[no-untyped-def]
    """Controller angles within (-pi, pi] of a solved posture.

    Args:
        arm: `ArmGeometry`.
        cs: cosines and sines of the model angles with sin(q5) >= 0, shape (6, 2).
        negative: whether A5 < 0 is wanted.
        out: out, shape (6,).
    """
    flip = negative == (arm.sign[4] > 0.0)
    for i in range(6):
        c, s = cs[i, 0], cs[i, 1]
        if flip and i == 4:
            s = -s
        elif flip and i > 2:
            c, s = -c, -s
        angle = (np.arctan2(s, c) + arm.offset[i]) * arm.sign[i]
        if angle > np.pi:
            angle -= 2.0 * np.pi
        elif angle <= -np.pi:
            angle += 2.0 * np.pi
        out[i] = angle


@lean
def other_flip(arm, angles, out):  # type: ignore[no-untyped-def]
    """The same pose with the wrist flipped: joints 4 and 6 turned by half a turn, joint 5 to the other side.

    Args:
        arm: `ArmGeometry`.
        angles: controller angles within (-pi, pi], shape (6,).
        out: out, shape (6,), likewise.
    """
    for i in range(6):
        out[i] = angles[i]
    out[4] = 2.0 * arm.sign[4] * arm.offset[4] - angles[4]
    if out[4] > np.pi:
        out[4] -= 2.0 * np.pi
    elif out[4] <= -np.pi:
        out[4] += 2.0 * np.pi
    for i in (3, 5):
        out[i] = angles[i] - np.pi if angles[i] > 0.0 else angles[i] + np.pi


@lean
def flip_sign(arm, branch):  # type: ignore[no-untyped-def]
    """What the rate of joint 5 is multiplied by on this branch: 1 where sin(q5) > 0, else -1."""
    return 1.0 if (branch % 2 == 0) == (arm.sign[4] > 0.0) else -1.0


@kernel
def inverse(arm, T, out):  # type: ignore[no-untyped-def]
    """All eight branches of many poses.

    Args:
        arm: `ArmGeometry`.
        T: flange poses, shape (N, 4, 4).
        out: out, shape (N, 8, 6): controller angles within (-pi, pi]; NaN rows where a branch cannot reach.
    """
    cs = np.empty((6, 2))
    for n in range(T.shape[0]):
        R = (
            T[n, 0, 0], T[n, 0, 1], T[n, 0, 2], T[n, 1, 0], T[n, 1, 1], T[n, 1, 2], T[n, 2, 0], T[n, 2, 1], T[n, 2, 2],
        )  # fmt: skip
        wx, wy, wz = T[n, 0, 3] - arm.c4 * R[2], T[n, 1, 3] - arm.c4 * R[5], T[n, 2, 3] - arm.c4 * R[8]
        for posture in range(4):
            if solve_posture(arm, R, wx, wy, wz, posture, cs):
                controller_angles(arm, cs, False, out[n, 2 * posture])
                controller_angles(arm, cs, True, out[n, 2 * posture + 1])
            else:
                out[n, 2 * posture : 2 * posture + 2] = np.nan


@kernel
def forward(arm, joints, out):  # type: ignore[no-untyped-def]
    """Flange poses of controller angles.

    Args:
        arm: `ArmGeometry`.
        joints: controller angles, shape (N, 6).
        out: out, shape (N, 4, 4).
    """
    q = np.empty(6)
    for n in range(joints.shape[0]):
        for i in range(6):
            q[i] = joints[n, i] * arm.sign[i] - arm.offset[i]
        c1, s1, c2, s2, c23, s23 = (
            np.cos(q[0]), np.sin(q[0]), np.cos(q[1]), np.sin(q[1]), np.cos(q[1] + q[2]), np.sin(q[1] + q[2]),
        )  # fmt: skip
        c4, s4, c5, s5, c6, s6 = np.cos(q[3]), np.sin(q[3]), np.cos(q[4]), np.sin(q[4]), np.cos(q[5]), np.sin(q[5])
        x1 = arm.a1 + arm.c2 * s2 + arm.a2 * c23 + arm.c3 * s23
        z1 = arm.c1 + arm.c2 * c2 + arm.c3 * c23 - arm.a2 * s23
        for j in range(3):
            # columns of Rz(q4) Ry(q5) Rz(q6), then turned by R03 = Rz(q1) Ry(q2 + q3)
            if j == 0:
                mx, my, mz = c4 * c5 * c6 - s4 * s6, s4 * c5 * c6 + c4 * s6, -s5 * c6
            elif j == 1:
                mx, my, mz = -c4 * c5 * s6 - s4 * c6, c4 * c6 - s4 * c5 * s6, s5 * s6
            else:
                mx, my, mz = c4 * s5, s4 * s5, c5
            px = c23 * mx + s23 * mz
            out[n, 0, j] = c1 * px - s1 * my
            out[n, 1, j] = s1 * px + c1 * my
            out[n, 2, j] = c23 * mz - s23 * mx
            out[n, 3, j] = 0.0
        out[n, 0, 3] = c1 * x1 - s1 * arm.b + arm.c4 * out[n, 0, 2]
        out[n, 1, 3] = s1 * x1 + c1 * arm.b + arm.c4 * out[n, 1, 2]
        out[n, 2, 3] = z1 + arm.c4 * out[n, 2, 2]
        out[n, 3, 3] = 1.0


@kernel
def angles_along(arm, plane, standoff, psi, branch, out):  # type: ignore[no-untyped-def]
    """Controller angles of one branch within (-pi, pi] at many points of the twist plane.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        standoff: s [m], shape (N,).
        psi: spin [rad], shape (N,).
        branch: 0..7.
        out: out, shape (N, 6); NaN rows where the branch cannot reach.
    """
    cs = np.empty((6, 2))
    for n in range(standoff.shape[0]):
        if solve_at(arm, plane, standoff[n], psi[n], branch // 2, cs)[0]:
            controller_angles(arm, cs, branch % 2 == 1, out[n])
        else:
            out[n] = np.nan
