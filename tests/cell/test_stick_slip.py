"""Joints that stick and slip: the plant against MuJoCo's own LuGre friction and a stiff integrator of scipy."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from oracles.mujoco_stick_slip import pulled_by_mujoco
from zerorev.cell.followed import MASS_EVERY, STEP
from zerorev.cell.plant import TIME_STEP
from zerorev.kernels.plant import GAP, Arm, Reference, follow

INERTIA = np.array([1.0, 2.0, 0.5, 1.0, 0.3, 1.0])  # [kg m^2] of the links
SPEED = np.array([0.03, 0.04, 0.025, 0.03, 0.025, 0.04])  # [rad/s] at which the rotors pull
ARM = Arm(
    coulomb=np.array([10.0, 20.0, 5.0, 12.0, 4.0, 8.0]), viscous=np.array([2.0, 3.0, 1.0, 2.0, 0.5, 1.0]),
    breakaway=1.5, stribeck=0.02, presliding=2e-4, behind=1.0, drive=np.array([1.0, 2.0, 0.7, 1.0, 0.4, 1.0]),
    stiffness=np.array([2400.0, 4500.0, 1500.0, 3200.0, 1200.0, 3000.0]), gap=np.zeros(6), kind=GAP, damping=0.08,
    bandwidth=400.0, position=0.12, reset=5.0, forward=0.0, friction_forward=0.0, limit=np.full(6, 1e6),
)  # fmt: skip
UP, LASTING = 0.05, 1.0  # [s]


@pytest.fixture(scope="module")
def pull():
    """Reference of the rotors: from rest to an even speed; times, places, speeds, accelerations."""
    t = np.arange(0.0, LASTING + STEP / 2, STEP)
    share = np.clip(t / UP, 0.0, 1.0)[:, None]
    qd = (share - np.sin(2 * np.pi * share) / (2 * np.pi)) * SPEED
    qdd = np.where(share < 1, (1 - np.cos(2 * np.pi * share)) / UP, 0.0) * SPEED
    q = np.concatenate([np.zeros((1, 6)), np.cumsum((qd[1:] + qd[:-1]) / 2 * STEP, axis=0)])
    return t, q, qd, qdd


@pytest.fixture(scope="module")
def links(pull):
    """The links by the plant [rad], shape (N, 6)."""
    _, q, qd, qdd = pull
    count = len(q) // MASS_EVERY + 2
    inverse = np.repeat(np.diag(1 / INERTIA)[None], count, axis=0)
    asked = Reference(
        STEP, q, qd, qdd, INERTIA * qdd, np.zeros_like(q), MASS_EVERY, inverse, np.zeros_like(inverse), INERTIA
    )
    rotor, link, drive = np.empty((3, *q.shape))
    follow(asked, ARM, 0.0, TIME_STEP, rotor, link, drive)
    return q + link


def slips(pull, links):
    """Of each joint how often it slips, the time between slips, its top speed, most and least twist of the gear."""
    t, q, _, _ = pull
    speed, twist = np.gradient(links, STEP, axis=0), (q - links)[t > 0.2]
    begun = [t[1:][np.diff((speed[:, j] > 1.6 * SPEED[j]).astype(int)) == 1] for j in range(6)]
    return (
        np.array([len(each) for each in begun]), np.array([np.diff(each).mean() for each in begun]),
        speed.max(axis=0), twist.max(axis=0), twist.min(axis=0),
    )  # fmt: skip


@pytest.mark.long
def test_against_the_friction_of_mujoco(pull, links):
    """To 1 %: as many slips, as long apart, as fast, at the same torques."""
    _, q, qd, qdd = pull
    theirs, _ = pulled_by_mujoco(q, qd, qdd, STEP, ARM, INERTIA, 2e-5)
    (count, *own), (expected, *others) = slips(pull, links), slips(pull, theirs)
    np.testing.assert_array_equal(count, expected)
    assert (count >= 3).all()
    for mine, other in zip(own, others, strict=True):
        np.testing.assert_allclose(mine, other, rtol=0.01)


def test_against_a_stiff_integrator(pull, links):
    """One joint, with tight tolerances: the same slips, and the link where it should be to 2 % of a slip."""
    t, q, qd, _ = pull
    j = 0
    k, J, M, dry, viscous = (float(each[j]) for each in (ARM.stiffness, ARM.drive, INERTIA, ARM.coulomb, ARM.viscous))
    c = 2 * ARM.damping * np.sqrt(k * min(J, M))
    Kv, Kp, Ti = ARM.bandwidth * J, ARM.position * ARM.bandwidth, ARM.reset / ARM.bandwidth

    def rates(now, state):
        rotor, spin, link, w, z, integral = state
        e = Kp * (np.interp(now, t, q[:, j]) - rotor) + np.interp(now, t, qd[:, j]) - spin
        gear = k * (rotor - link) + c * (spin - w)
        g = 1 + (ARM.breakaway - 1) * np.exp(-((w / ARM.stribeck) ** 2))
        return [
            spin, (Kv * (e + integral) - gear) / J, w, (gear - dry * z - viscous * w) / M,
            (w - abs(w) * z / g) / ARM.presliding, e / Ti,
        ]  # fmt: skip

    found = solve_ivp(rates, (0, t[-1]), np.zeros(6), t_eval=t, method="LSODA", rtol=1e-8, atol=1e-11, max_step=1e-3)
    slip = np.ptp((q[:, j] - found.y[2])[t > 0.2])
    assert slip > 2e-3
    np.testing.assert_allclose(links[:, j], found.y[2], rtol=0, atol=0.02 * slip)
