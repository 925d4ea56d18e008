"""What the joints carry along a motion of the twist plane, and where their gears let the tip go (theory §9).

Bodies and frames are those of `kernels.dynamics`. Torques are those of the controller's angles, with their signs. SI
units; gravity is along -Z of the base. No kernel raises.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from zerorev.kernels._jit import kernel, lean
from zerorev.kernels.arm import flip_sign, joint_velocity, solve_at
from zerorev.kernels.dynamics import about_z, cross, into, place

__all__ = ["WINDOW_STEPS", "Gears", "leg_gives", "loads_along", "pair_lost_motion", "tip_lost_motion"]

Array = npt.NDArray[np.float64]
WINDOW_STEPS = 12  # samples on either side of the turn


class Gears(NamedTuple):
    """What the gears give way to.

    Attributes:
        friction: behind them, one row for each level of it that is examined [N m], shape (L, 6).
        stiffness: [N m/rad], shape (6,).
        gap: between their flanks [rad], shape (6,).
    """

    friction: Array
    stiffness: Array
    gap: Array


@lean
def load_at(arm, bodies, plane, branch, standoff, psi, twist, outwards, gravity, cs, rate, axis, held, lever, sense):  # type: ignore[no-untyped-def]
    """What the joints carry at one point of a motion, and which way they move there.

    Args:
        arm: `ArmGeometry`.
        bodies: `Bodies`.
        plane: `TwistPlane`.
        branch: 0..7.
        standoff: s [m].
        psi: spin [rad].
        twist: d psi / d s of the leg [rad/m].
        outwards: whether s grows along the motion.
        gravity: [m/s^2].
        cs: room, shape (6, 2).
        rate: room, shape (2, 6).
        axis: room, shape (7, 6): axes and places of the joints, base frame.
        held: out, shape (6,): torque that holds links and tool [N m].
        lever: out, shape (6, 3): velocity of the tip per speed of the joint [m], base frame.
        sense: out, shape (6,): -1, 0 or 1, which way the joint turns.

    Returns:
        whether the branch reaches the point.
    """
    reached, lx, ly, lz = solve_at(arm, plane, standoff, psi, branch // 2, cs)
    if not reached:
        return False
    _, _, zx, _, _, zy, _, _, zz = plane.R_base_tcp0
    joint_velocity(arm, cs, zx, zy, zz, 0.0, 0.0, 0.0, rate[0])
    joint_velocity(arm, cs, zy * lz - zz * ly, zz * lx - zx * lz, zx * ly - zy * lx, zx, zy, zz, rate[1])
    five = flip_sign(arm, branch)
    flipped = five * arm.sign[4] < 0.0
    for i in range(6):
        speed = rate[0, i] + twist * rate[1, i]
        speed = speed if outwards else -speed
        sense[i] = np.sign(five * speed if i == 4 else speed)

    # frames of the joints, from the base outwards: rotation by rows, place
    a0, a1, a2, b0, b1, b2, c0, c1, c2 = 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0
    px, py, pz = 0.0, 0.0, 0.0
    for i in range(6):
        rx, ry, rz = place(arm, i)
        px, py, pz = (
            px + a0 * rx + a1 * ry + a2 * rz,
            py + b0 * rx + b1 * ry + b2 * rz,
            pz + c0 * rx + c1 * ry + c2 * rz,
        )
        c, s = cs[i, 0], cs[i, 1]
        if flipped and i == 4:
            s = -s
        elif flipped and i > 2:
            c, s = -c, -s
        a0, a1, a2 = into(i, c, s, a0, a1, a2)
        b0, b1, b2 = into(i, c, s, b0, b1, b2)
        c0, c1, c2 = into(i, c, s, c0, c1, c2)
        x, y, z = bodies.com[i, 0], bodies.com[i, 1], bodies.com[i, 2]
        m = bodies.mass[i]
        if about_z(i):
            axis[0, i], axis[1, i], axis[2, i] = a2, b2, c2
        else:
            axis[0, i], axis[1, i], axis[2, i] = a1, b1, c1
        axis[3, i], axis[4, i], axis[5, i] = px, py, pz
        axis[6, i] = m
        # the moments of the weights about Z of the base do not matter: x and y of the centres of mass are enough
        lever[i, 0], lever[i, 1] = m * (px + a0 * x + a1 * y + a2 * z), m * (py + b0 * x + b1 * y + b2 * z)

    t0, t1, t2 = plane.target
    tx, ty, tz = t0 + standoff * zx, t1 + standoff * zy, t2 + standoff * zz
    mass, mx, my = 0.0, 0.0, 0.0
    for i in range(5, -1, -1):
        mass, mx, my = mass + axis[6, i], mx + lever[i, 0], my + lever[i, 1]
        wx, wy, wz = arm.sign[i] * axis[0, i], arm.sign[i] * axis[1, i], arm.sign[i] * axis[2, i]
        px, py, pz = axis[3, i], axis[4, i], axis[5, i]
        # how fast the centre of all that the joint carries rises
        held[i] = gravity * (wx * (my - mass * py) - wy * (mx - mass * px))
        lever[i, 0], lever[i, 1], lever[i, 2] = cross(wx, wy, wz, tx - px, ty - py, tz - pz)
    return True


@kernel
def loads_along(arm, bodies, plane, branch, standoff, psi, twist, outwards, gravity, held, lever, sense):  # type: ignore[no-untyped-def]
    """`load_at` at N points of a motion.

    Args:
        arm: `ArmGeometry`.
        bodies: `Bodies`.
        plane: `TwistPlane`.
        branch: 0..7.
        standoff: s [m], shape (N,).
        psi: spin [rad], shape (N,).
        twist: d psi / d s of the leg [rad/m], shape (N,).
        outwards: whether s grows along the motion, shape (N,).
        gravity: [m/s^2].
        held: out, shape (N, 6): torques that hold links and tool [N m]; NaN rows out of reach.
        lever: out, shape (N, 6, 3): velocity of the tip per speed of each joint [m], base frame.
        sense: out, shape (N, 6): which way each joint turns; NaN where the arm is singular.
    """
    cs, rate, axis = np.empty((6, 2)), np.empty((2, 6)), np.empty((7, 6))
    for n in range(standoff.shape[0]):
        if not load_at(
            arm, bodies, plane, branch, standoff[n], psi[n], twist[n], outwards[n], gravity,
            cs, rate, axis, held[n], lever[n], sense[n],
        ):  # fmt: skip
            held[n], lever[n], sense[n] = np.nan, np.nan, np.nan


@lean
def give_way(arm, bodies, gears, plane, branch, standoff, psi, twist, outwards, thrust, gravity, room, out):  # type: ignore[no-untyped-def]
    """Where the gears let the tip go, across the drill axis, at one point of a motion.

    Args:
        arm: `ArmGeometry`.
        bodies: `Bodies`.
        gears: `Gears`.
        plane: `TwistPlane`.
        branch: 0..7.
        standoff: s [m].
        psi: spin [rad].
        twist: d psi / d s of the leg [rad/m].
        outwards: whether s grows along the motion.
        thrust: of the drill, if it plunges [N].
        gravity: [m/s^2].
        room: for `load_at`: (cs, rate, axis, held, lever, sense).
        out: out, shape (L, 3) [m], base frame, for each level of friction.

    Returns:
        whether the branch reaches the point.
    """
    cs, rate, axis, held, lever, sense = room
    if not load_at(
        arm, bodies, plane, branch, standoff, psi, twist, outwards, gravity, cs, rate, axis, held, lever, sense
    ):
        return False
    _, _, zx, _, _, zy, _, _, zz = plane.R_base_tcp0
    push = 0.0 if outwards else -thrust  # the drill axis is -Z of the tcp frame
    for level in range(gears.friction.shape[0]):
        x, y, z = 0.0, 0.0, 0.0
        for i in range(6):
            along = zx * lever[i, 0] + zy * lever[i, 1] + zz * lever[i, 2]
            load = held[i] + sense[i] * gears.friction[level, i] + push * along
            give = load / gears.stiffness[i] + 0.5 * gears.gap[i] * np.sign(load)
            x -= give * (lever[i, 0] - along * zx)
            y -= give * (lever[i, 1] - along * zy)
            z -= give * (lever[i, 2] - along * zz)
        out[level, 0], out[level, 1], out[level, 2] = x, y, z
    return True


@lean
def farthest(away, count):  # type: ignore[no-untyped-def]
    """Greatest distance of points from their mean [m], over the levels; away: shape (L, >= count, 3)."""
    greatest = 0.0
    for level in range(away.shape[0]):
        mx, my, mz = 0.0, 0.0, 0.0
        for n in range(count):
            mx, my, mz = mx + away[level, n, 0], my + away[level, n, 1], mz + away[level, n, 2]
        mx, my, mz = mx / count, my / count, mz / count
        for n in range(count):
            x, y, z = away[level, n, 0] - mx, away[level, n, 1] - my, away[level, n, 2] - mz
            apart = x * x + y * y + z * z
            if np.isnan(apart):
                return np.nan
            greatest = max(greatest, apart)
    return np.sqrt(greatest)


@kernel
def tip_lost_motion(arm, bodies, gears, plane, branch, standoff, psi, corner, window, thrust, gravity):  # type: ignore[no-untyped-def]
    """The lost motion at the tip that a motion is predicted to have: the greatest over the levels of friction.

    Under the load of a joint its gear lies on one flank and gives way by so much. What of that moves the tip across the
    drill axis, less its mean over the window, is what a hole sees of it.

    Args:
        arm: `ArmGeometry`.
        bodies: `Bodies`.
        gears: `Gears`.
        plane: `TwistPlane`.
        branch: 0..7.
        standoff: of the breakpoints [m], shape (n,).
        psi: spins there [rad], shape (n,).
        corner: index of the breakpoint at which the plunge ends.
        window: path on either side of the turn that counts [m].
        thrust: of the drill while it plunges [N].
        gravity: [m/s^2].

    Returns:
        [m]; NaN where the branch does not reach, or the arm is singular.
    """
    room = np.empty((6, 2)), np.empty((2, 6)), np.empty((7, 6)), np.empty(6), np.empty((6, 3)), np.empty(6)
    count = 2 * WINDOW_STEPS + 1
    away = np.empty((gears.friction.shape[0], count, 3))
    k = 0
    for n in range(count):
        path = window * (n - WINDOW_STEPS) / WINDOW_STEPS
        s = standoff[corner] + abs(path)
        if path <= 0.0:  # the segment of the plunge that s lies in
            while k < corner - 1 and standoff[k + 1] > s:
                k += 1
        else:
            k = max(k, corner)
            while k < standoff.shape[0] - 2 and standoff[k + 1] < s:
                k += 1
        twist = (psi[k + 1] - psi[k]) / (standoff[k + 1] - standoff[k])
        spin = psi[k] + twist * (s - standoff[k])
        if not give_way(
            arm, bodies, gears, plane, branch, s, spin, twist, path > 0.0, thrust, gravity, room, away[:, n]
        ):
            return np.nan
    return farthest(away, count)


@kernel
def leg_gives(arm, bodies, gears, plane, branch, psi_t, slope, window, thrust, gravity, out):  # type: ignore[no-untyped-def]
    """Where the gears let the tip go along straight legs out of the target, run inwards and outwards.

    Args:
        arm: `ArmGeometry`.
        bodies: `Bodies`.
        gears: `Gears`.
        plane: `TwistPlane`.
        branch: 0..7.
        psi_t: spins at the target [rad], shape (N,).
        slope: twist rates [rad/m], shape (N,).
        window: length of the leg that counts [m].
        thrust: of the drill while it plunges [N].
        gravity: [m/s^2].
        out: out, shape (N, 2, L, WINDOW_STEPS + 1, 3) [m]: as the plunge and as the retract, from the turn outwards;
            NaN out of reach.
    """
    room = np.empty((6, 2)), np.empty((2, 6)), np.empty((7, 6)), np.empty(6), np.empty((6, 3)), np.empty(6)
    for n in range(psi_t.shape[0]):
        for way in range(2):
            for k in range(WINDOW_STEPS + 1):
                s = window * k / WINDOW_STEPS
                if not give_way(
                    arm, bodies, gears, plane, branch, s, psi_t[n] + slope[n] * s, slope[n], way == 1, thrust, gravity,
                    room, out[n, way, :, k],
                ):  # fmt: skip
                    out[n, way, :, k] = np.nan


@kernel
def pair_lost_motion(one, other, out):  # type: ignore[no-untyped-def]
    """`tip_lost_motion` of all pairs of straight legs out of one spin, the legs in the better order.

    Args:
        one: of N legs, from `leg_gives`.
        other: of M legs, likewise.
        out: out, shape (N, M) [m].
    """
    levels, steps = one.shape[2], one.shape[3]
    away = np.empty((levels, 2 * steps - 1, 3))
    for n in range(one.shape[0]):
        for m in range(other.shape[0]):
            best = np.inf
            for order in range(2):
                plunge, retract = (one[n, 0], other[m, 1]) if order == 0 else (other[m, 0], one[n, 1])
                for level in range(levels):
                    for k in range(steps):
                        for x in range(3):
                            away[level, k, x] = plunge[level, k, x]
                            if k > 0:
                                away[level, steps + k - 1, x] = retract[level, k, x]
                best = min(best, farthest(away, 2 * steps - 1))
            out[n, m] = best
