"""The arm as six rigid bodies: torques of a motion, and the mass matrix.

Each body has a frame in its joint that is parallel to the base frame where all model angles are 0, so that joints 1, 4
and 6 turn about Z of their frames, 2, 3 and 5 about Y. Torques are those of the controller's angles, with their signs.
SI units; gravity is along -Z of the base. No kernel raises.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from zerorev.kernels._jit import kernel, lean

__all__ = ["Bodies", "about_z", "cross", "into", "inverse_dynamics", "mass_matrix", "place"]

Array = npt.NDArray[np.float64]
ROOM = (8, 6)  # of `torques`
COS, SIN = 6, 7  # rows of it


class Bodies(NamedTuple):
    """Links and tool, each in the frame of its joint.

    Attributes:
        mass: [kg], shape (6,).
        com: centres of mass [m], shape (6, 3).
        inertia: about them [kg m^2], shape (6, 3, 3).
    """

    mass: Array
    com: Array
    inertia: Array


@lean
def place(arm, i):  # type: ignore[no-untyped-def]
    """Where joint i, 0..5, lies in the frame of the joint before it [m]: x, y, z."""
    if i == 1:
        return arm.a1, 0.0, arm.c1
    if i == 2:
        return 0.0, arm.b, arm.c2
    if i == 3:
        return arm.a2, 0.0, 0.0
    return 0.0, 0.0, arm.c3 if i == 4 else 0.0


@lean
def about_z(i):  # type: ignore[no-untyped-def]
    """Whether joint i, 0..5, turns about Z of its frame, or else about Y."""
    return i == 0 or i == 3 or i == 5


@lean
def into(i, c, s, x, y, z):  # type: ignore[no-untyped-def]
    """A vector of the frame before joint i, as its own frame sees it."""
    if about_z(i):
        return c * x + s * y, c * y - s * x, z
    return c * x - s * z, y, s * x + c * z


@lean
def out_of(i, c, s, x, y, z):  # type: ignore[no-untyped-def]
    """A vector of the frame of joint i, as the frame before it sees it."""
    if about_z(i):
        return c * x - s * y, s * x + c * y, z
    return c * x + s * z, y, c * z - s * x


@lean
def cross(ax, ay, az, bx, by, bz):  # type: ignore[no-untyped-def]
    """A x b."""
    return ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx


@lean
def torques(arm, bodies, q, qd, qdd, gravity, work, out):  # type: ignore[no-untyped-def]
    """Newton's and Euler's equations at one state, outwards and back.

    Args:
        arm: `ArmGeometry`.
        bodies: `Bodies`.
        q: controller angles [rad], shape (6,).
        qd: speeds [rad/s], shape (6,).
        qdd: accelerations [rad/s^2], shape (6,).
        gravity: [m/s^2].
        work: room, shape `ROOM`.
        out: out, shape (6,) [N m].
    """
    wx, wy, wz, ex, ey, ez = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0  # angular velocity and acceleration
    ax, ay, az = 0.0, 0.0, gravity
    for i in range(6):
        angle = q[i] * arm.sign[i] - arm.offset[i]
        c, s = np.cos(angle), np.sin(angle)
        work[COS, i], work[SIN, i] = c, s
        speed, gain = qd[i] * arm.sign[i], qdd[i] * arm.sign[i]
        rx, ry, rz = place(arm, i)
        ux, uy, uz = cross(wx, wy, wz, rx, ry, rz)
        vx, vy, vz = cross(wx, wy, wz, ux, uy, uz)
        ux, uy, uz = cross(ex, ey, ez, rx, ry, rz)
        ax, ay, az = into(i, c, s, ax + ux + vx, ay + uy + vy, az + uz + vz)
        wx, wy, wz = into(i, c, s, wx, wy, wz)
        ex, ey, ez = into(i, c, s, ex, ey, ez)
        if about_z(i):
            ex, ey, ez, wz = ex + wy * speed, ey - wx * speed, ez + gain, wz + speed
        else:
            ex, ey, ez, wy = ex - wz * speed, ey + gain, ez + wx * speed, wy + speed

        m, cx, cy, cz = bodies.mass[i], bodies.com[i, 0], bodies.com[i, 1], bodies.com[i, 2]
        ux, uy, uz = cross(wx, wy, wz, cx, cy, cz)
        vx, vy, vz = cross(wx, wy, wz, ux, uy, uz)
        ux, uy, uz = cross(ex, ey, ez, cx, cy, cz)
        fx, fy, fz = m * (ax + ux + vx), m * (ay + uy + vy), m * (az + uz + vz)
        t = bodies.inertia[i]
        hx = t[0, 0] * wx + t[0, 1] * wy + t[0, 2] * wz
        hy = t[1, 0] * wx + t[1, 1] * wy + t[1, 2] * wz
        hz = t[2, 0] * wx + t[2, 1] * wy + t[2, 2] * wz
        hx, hy, hz = cross(wx, wy, wz, hx, hy, hz)
        nx, ny, nz = cross(cx, cy, cz, fx, fy, fz)
        work[i, 0], work[i, 1], work[i, 2] = fx, fy, fz
        work[i, 3] = nx + hx + t[0, 0] * ex + t[0, 1] * ey + t[0, 2] * ez
        work[i, 4] = ny + hy + t[1, 0] * ex + t[1, 1] * ey + t[1, 2] * ez
        work[i, 5] = nz + hz + t[2, 0] * ex + t[2, 1] * ey + t[2, 2] * ez

    fx, fy, fz, nx, ny, nz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for i in range(5, -1, -1):
        fx, fy, fz = fx + work[i, 0], fy + work[i, 1], fz + work[i, 2]
        nx, ny, nz = nx + work[i, 3], ny + work[i, 4], nz + work[i, 5]
        out[i] = arm.sign[i] * (nz if about_z(i) else ny)
        c, s = work[COS, i], work[SIN, i]
        fx, fy, fz = out_of(i, c, s, fx, fy, fz)
        nx, ny, nz = out_of(i, c, s, nx, ny, nz)
        rx, ry, rz = place(arm, i)
        ux, uy, uz = cross(rx, ry, rz, fx, fy, fz)
        nx, ny, nz = nx + ux, ny + uy, nz + uz


@kernel
def inverse_dynamics(arm, bodies, q, qd, qdd, gravity, out):  # type: ignore[no-untyped-def]
    """Torques that a motion needs, at N states.

    Args:
        arm: `ArmGeometry`.
        bodies: `Bodies`.
        q: controller angles [rad], shape (N, 6).
        qd: speeds [rad/s], shape (N, 6).
        qdd: accelerations [rad/s^2], shape (N, 6).
        gravity: [m/s^2].
        out: out, shape (N, 6) [N m].
    """
    work = np.empty(ROOM)
    for n in range(q.shape[0]):
        torques(arm, bodies, q[n], qd[n], qdd[n], gravity, work, out[n])


@kernel
def mass_matrix(arm, bodies, q, out):  # type: ignore[no-untyped-def]
    """The mass matrix at N postures.

    Args:
        arm: `ArmGeometry`.
        bodies: `Bodies`.
        q: controller angles [rad], shape (N, 6).
        out: out, shape (N, 6, 6) [kg m^2].
    """
    work, still, one = np.empty(ROOM), np.zeros(6), np.zeros(6)
    for n in range(q.shape[0]):
        for i in range(6):
            one[i] = 1.0
            torques(arm, bodies, q[n], still, one, 0.0, work, out[n, i])
            one[i] = 0.0
