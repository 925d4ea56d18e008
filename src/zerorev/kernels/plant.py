"""A joint-controlled arm on elastic gears with friction and lost motion, along a reference: 0.1 ms steps.

The arm is followed as deviations from the reference: `rotor` is what the encoder sees less the reference, `link` what
the link does less it. The links' accelerations are exact on the reference and linear in the deviations, which are of
1e-3 rad; so are the weights. Angles are known at the steps and speeds between them (leapfrog). The controller takes the
speed at a step from the last two, and friction is trapezoidal, so that the error falls with the square of the step.
Gears and the wrist's links have fast modes: gears damp by the last speed, and friction behind a fast one is implicit,
which is stable. SI units, joint side. No kernel raises.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from zerorev.kernels._jit import kernel, lean

__all__ = ["Arm", "Reference", "follow"]

Array = npt.NDArray[np.float64]
STEPS = 10  # between two nodes of the reference
SOFT = 1e-3  # [rad/s] below which the sense of the reference fades, or the feed-forward would chatter at rest
SLOW = 0.03  # (frequency x step)^2 below which a mode is slow
GAP, HYSTERESIS = 0.0, 1.0  # kinds of lost motion


class Reference(NamedTuple):
    """What the controller is asked to do, at even nodes.

    Attributes:
        step: between two nodes [s].
        q: joints [rad], shape (N, 6).
        qd: speeds [rad/s].
        qdd: accelerations [rad/s^2].
        torque: that the links need [N m], shape (N, 6).
        outer: torques of the forces at the tip [N m], shape (N, 6).
        every: nodes from one inverse mass matrix to the next.
        inverse: mass matrices inverted, shape (K, 6, 6), linear between.
        stiffening: how the weights' torques change with the joints [N m/rad], shape (K, 6, 6), likewise.
        inertia: diagonals of the mass matrices [kg m^2], shape (6,): least on the way.
    """

    step: float
    q: Array
    qd: Array
    qdd: Array
    torque: Array
    outer: Array
    every: int
    inverse: Array
    stiffening: Array
    inertia: Array


class Arm(NamedTuple):
    """Drives and controller of one set of parameters; shape (6,) where it is of the joints.

    Attributes:
        coulomb: dry friction [N m].
        viscous: [N m s/rad].
        breakaway: static friction over dry friction.
        stribeck: speed at which it fades [rad/s].
        presliding: distance over which friction builds up [rad].
        behind: share of the friction behind the gear.
        drive: inertia of the rotors [kg m^2].
        stiffness: of the gears [N m/rad].
        gap: lost motion [rad].
        kind: `GAP` or `HYSTERESIS`.
        damping: ratio of the gears.
        bandwidth: of the speed loop [rad/s].
        position: gain of the position loop over the bandwidth.
        reset: integration time times the bandwidth.
        forward: share of the reference's torque that is fed forward.
        friction_forward: share of the friction that is fed forward.
        limit: greatest torque of the drives [N m].
    """

    coulomb: Array
    viscous: Array
    breakaway: float
    stribeck: float
    presliding: float
    behind: float
    drive: Array
    stiffness: Array
    gap: Array
    kind: float
    damping: float
    bandwidth: float
    position: float
    reset: float
    forward: float
    friction_forward: float
    limit: Array


@lean
def bristles(z, speed, arm, dt, ahead):  # type: ignore[no-untyped-def]
    """The state of friction one step on, between -1 and 1 at rest (LuGre); `ahead`: 1 implicit, 0.5 trapezoidal."""
    fast = speed / arm.stribeck
    peak = 1.0 + (arm.breakaway - 1.0) * np.exp(-fast * fast)
    bent = dt * abs(speed) / (arm.presliding * peak)
    return (z * (1.0 - (1.0 - ahead) * bent) + dt * speed / arm.presliding) / (1.0 + ahead * bent)


@lean
def transmitted(arm, i, twist, rate, damping, zh):  # type: ignore[no-untyped-def]
    """Torque of a gear [N m] at a twist between rotor and link [rad], and its rate [rad/s]."""
    k, half = arm.stiffness[i], 0.5 * arm.gap[i]
    if arm.kind == HYSTERESIS:
        return k * twist + k * half * zh + damping * rate
    if twist > half:
        return max(k * (twist - half) + damping * rate, 0.0)
    if twist < -half:
        return min(k * (twist + half) + damping * rate, 0.0)
    return 0.0


@kernel
def follow(reference, arm, rest, dt, rotor, link, drive):  # type: ignore[no-untyped-def]
    """Let an arm follow a reference.

    Args:
        reference: `Reference`.
        arm: `Arm`.
        rest: how long it stands at the first node before the motion begins [s].
        dt: step [s]; a node of the reference is `round(step / dt)` of them.
        rotor: out, shape (N, 6): encoder less reference at the nodes [rad].
        link: out, shape (N, 6): link less reference [rad].
        drive: out, shape (N, 6): torques of the drives [N m].
    """
    N = reference.q.shape[0]
    th, thd, ln, lnd = np.empty(6), np.zeros(6), np.empty(6), np.zeros(6)
    zm, zl, zh, integral = np.zeros(6), np.zeros(6), np.zeros(6), np.zeros(6)
    push, damping, ahead_of, u, thd_before = np.empty(6), np.empty(6), np.empty(6), np.zeros(6), np.zeros(6)
    for i in range(6):
        load = reference.torque[0, i] - reference.outer[0, i]
        th[i] = 0.0
        ln[i] = -load / arm.stiffness[i]
        if arm.kind == GAP:
            ln[i] -= np.sign(load) * 0.5 * arm.gap[i]
        # stuck, a link is held by its bristles and its gear: where that mode is fast, only the implicit rule is stable
        held = arm.behind * arm.coulomb[i] / arm.presliding + arm.stiffness[i]
        ahead_of[i] = 0.5 if held * dt * dt < SLOW * reference.inertia[i] else 1.0
        damping[i] = 2.0 * arm.damping * np.sqrt(arm.stiffness[i] * min(arm.drive[i], reference.inertia[i]))
    Ti = arm.reset / arm.bandwidth
    Kp = arm.position * arm.bandwidth
    inner = round(reference.step / dt)
    quiet = round(rest / reference.step)
    K = reference.inverse.shape[0]
    for n in range(-quiet, N - 1):
        node, ahead = max(n, 0), max(n + 1, 0)
        if n < 0:
            ahead = 0
        place = node / reference.every
        k = min(int(place), K - 2)
        share = min(place - k, 1.0)
        if n >= 0:
            for i in range(6):
                rotor[n, i], link[n, i], drive[n, i] = th[i], ln[i], u[i]
        for m in range(inner):
            w = m / inner
            for i in range(6):
                rd = (1.0 - w) * reference.qd[node, i] + w * reference.qd[ahead, i]
                rdd = (1.0 - w) * reference.qdd[node, i] + w * reference.qdd[ahead, i]
                if n < 0:
                    rd, rdd = 0.0, 0.0
                need = (1.0 - w) * reference.torque[node, i] + w * reference.torque[ahead, i]
                outer = (1.0 - w) * reference.outer[node, i] + w * reference.outer[ahead, i]
                rd_before = rd - 0.5 * dt * rdd
                th_rate = 1.5 * thd[i] - 0.5 * thd_before[i]
                # controller, on the rotor's side
                Kv = arm.bandwidth * arm.drive[i]
                e = -Kp * th[i] - th_rate
                sense = np.tanh(rd / SOFT)
                ask = (
                    Kv * (e + integral[i] + 0.5 * dt * e / Ti)
                    + arm.forward * (need + arm.drive[i] * rdd)
                    + arm.friction_forward * (arm.coulomb[i] * sense + arm.viscous[i] * rd)
                )
                if abs(ask) < arm.limit[i]:
                    integral[i] += dt * e / Ti
                    u[i] = ask
                else:
                    u[i] = np.sign(ask) * arm.limit[i]
                # friction on both sides of the gear, and what the gear transmits
                speed, follows = rd_before + thd[i], rd_before + lnd[i]
                zm[i] = bristles(zm[i], speed, arm, dt, 0.5)
                zl[i] = bristles(zl[i], follows, arm, dt, ahead_of[i])
                before = (1.0 - arm.behind) * (arm.coulomb[i] * zm[i] + arm.viscous[i] * (rd + th_rate))
                behind = arm.behind * (arm.coulomb[i] * zl[i] + arm.viscous[i] * follows)
                twist, rate = th[i] - ln[i], thd[i] - lnd[i]
                if arm.kind == HYSTERESIS:
                    zh[i] = (zh[i] + dt * rate / (0.25 * arm.gap[i])) / (1.0 + dt * abs(rate) / (0.25 * arm.gap[i]))
                gear = transmitted(arm, i, twist, rate, damping[i], zh[i])
                thd_before[i] = thd[i]
                thd[i] += dt * ((u[i] - before - gear) / arm.drive[i] - rdd)
                push[i] = gear - behind - need + outer
                for j in range(6):
                    push[i] -= ln[j] * (
                        (1.0 - share) * reference.stiffening[k, i, j] + share * reference.stiffening[k + 1, i, j]
                    )
            for i in range(6):
                gain = 0.0
                for j in range(6):
                    entry = (1.0 - share) * reference.inverse[k, i, j] + share * reference.inverse[k + 1, i, j]
                    gain += entry * push[j]
                lnd[i] += dt * gain
            for i in range(6):
                th[i] += dt * thd[i]
                ln[i] += dt * lnd[i]
    for i in range(6):
        rotor[N - 1, i], link[N - 1, i], drive[N - 1, i] = th[i], ln[i], u[i]
