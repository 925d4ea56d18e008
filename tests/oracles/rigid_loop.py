"""An arm with rigid gears and no friction in its control loop: a linear system, advanced by matrix exponentials."""

from __future__ import annotations

import numpy as np
from scipy.linalg import expm

__all__ = ["rigid_loop"]

FROZEN = 10  # nodes over which the mass matrix is held


def rigid_loop(torque, qdd, masses, stiffening, every, arm, step, rest):
    """Joints less reference at its nodes [rad], shape (N, 6).

    (Jm + M) x'' + S x = Kv (I - Kp x - x') - (1 - kdyn) (tau + Jm r''),  I' = -(Kp x + x') / Ti.

    Args:
        torque: that the links need on the reference [N m], shape (N, 6).
        qdd: of the reference [rad/s^2], shape (N, 6).
        masses: mass matrices [kg m^2], shape (K, 6, 6), linear between.
        stiffening: S [N m/rad], shape (K, 6, 6), likewise.
        every: nodes from one mass matrix to the next.
        arm: `kernels.plant.Arm`: its drives and controller.
        step: between nodes [s].
        rest: time at the first node [s].
    """
    Kv, Kp, Ti = np.diag(arm.bandwidth * arm.drive), arm.position * arm.bandwidth, arm.reset / arm.bandwidth
    missing = -(1 - arm.forward) * (torque + arm.drive * qdd)
    one, none = np.eye(6), np.zeros((6, 6))
    state, found = np.zeros(18), np.empty_like(torque)

    def system(place):
        k = min(int(place), len(masses) - 2)
        share = min(place - k, 1.0)
        M = (1 - share) * masses[k] + share * masses[k + 1]
        S = (1 - share) * stiffening[k] + share * stiffening[k + 1]
        inverse = np.linalg.inv(M + np.diag(arm.drive))
        A = np.block([
            [none, one, none],
            [-inverse @ (Kp * Kv + S), -inverse @ Kv, inverse @ Kv],
            [-Kp / Ti * one, -one / Ti, none],
        ])  # fmt: skip
        return A, np.concatenate([none, inverse, none])

    def stepper(place):
        """What takes state, input and its growth over a step to the state after it, shape (18, 30)."""
        A, B = system(place)
        whole = np.zeros((30, 30))
        whole[:18, :18], whole[:18, 18:24], whole[18:24, 24:] = A * step, B * step, one
        return expm(whole)[:18]

    steps = {n: stepper((n + 0.5) * FROZEN / every) for n in range(-(-len(torque) // FROZEN))}
    at_rest = stepper(0.0)
    for _ in range(round(rest / step)):
        state = at_rest @ np.concatenate([state, missing[0], np.zeros(6)])
    for n in range(len(torque) - 1):
        found[n] = state[:6]
        state = steps[n // FROZEN] @ np.concatenate([state, missing[n], missing[n + 1] - missing[n]])
    found[-1] = state[:6]
    return found
