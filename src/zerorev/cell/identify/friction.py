"""Friction of each joint and the mass of the tool from sweeps: least squares with the Stribeck term.

At an even speed v of a joint, the others at rest, its drive gives

    u = G0 + m (Ga + x Gb) + Fc g(v) sgn v + Fv v ,    g = 1 + (Fs/Fc - 1) exp(-(v/vs)^2) ,

G0 what holds the bare arm, Ga and Gb what holds a kilogram at the flange and carries it to the tip, x the share of the
way to the tip at which the tool's mass m lies. For a given vs and Fs/Fc that is linear in m, m x, Fc and Fv.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import minimize

from zerorev.cell.identify.segments import Segment
from zerorev.errors import InputError
from zerorev.model._arrays import Array
from zerorev.model.ranges import RANGES
from zerorev.model.robot import Robot

__all__ = ["Fitted", "fitted"]

FEWEST_SPEEDS = 3
APART = 1.3  # two speeds
FADES = np.geomspace(4e-3, 0.12, 24)  # [rad/s] vs
PEAKS = np.linspace(1.0, 2.0, 21)  # Fs/Fc
CHI2 = 5.99  # 95 % of two unknowns
SIGMAS = 2.0
LEAST_SHARE = 1e-3  # of the torque, to which it is trusted
LEVER = RANGES["tool_lever"]
LEVER_SPREAD = (LEVER.high - LEVER.low) / np.sqrt(12.0)
STICKS = 0.15  # of the speed, by which it is unsteady: the joint sticks and slips, which is another friction
UNLIKE = 0.25  # of the torque, as a residual: then it is not this arm's


@dataclass(frozen=True)
class Fitted:
    """What sweeps say; each with its least and greatest value of some 95 %.

    Attributes:
        mass: of the tool [kg], shape (3,): value, least, greatest.
        lever: share of the way to the tip at which it lies, likewise.
        coulomb: dry friction [N m], shape (3, 6).
        viscous: [N m s/rad], shape (3, 6).
        stribeck: speed at which static friction fades [rad/s], shape (3,).
        breakaway: static over dry friction, shape (3,).
        residual: root of the mean square of what is left [N m], shape (6,).
        rows: segments of each joint, shape (6,).
        sticking: joints and speeds [rad/s] that were left out, since the joint sticks and slips there.
    """

    mass: Array
    lever: Array
    coulomb: Array
    viscous: Array
    stribeck: Array
    breakaway: Array
    residual: Array
    rows: Array
    sticking: tuple[tuple[int, float], ...] = ()


class _Rows:
    """The equations, weighted by what each is trusted."""

    def __init__(self, found: Sequence[Segment]) -> None:
        self.joint = np.array([each.joint for each in found])
        self.speed = np.array([each.speed for each in found])
        self.left = np.array([each.torque - each.bare for each in found])
        self.torque = np.abs(np.array([each.torque for each in found]))
        self.load = np.array([(each.mass, each.moment) for each in found])
        count = np.array([each.count for each in found])
        spread = np.array([each.spread for each in found])
        own = np.array([np.sqrt(np.mean(spread[self.joint == j] ** 2)) for j in range(6)])
        self.sigma = np.hypot(own[self.joint] / np.sqrt(count), LEAST_SHARE * self.torque.max())

    def solved(self, fade: float, peak: float, mass: float) -> tuple[Array, Array, float]:
        """Unknowns, their covariance, and the sum of squares, for one Stribeck curve and a guess of the mass."""
        own = np.zeros((len(self.joint), 6))
        own[np.arange(len(self.joint)), self.joint] = 1.0
        curve = np.sign(self.speed) * (1 + (peak - 1) * np.exp(-((self.speed / fade) ** 2)))
        A = np.hstack([self.load, own * curve[:, None], own * self.speed[:, None]])
        # where the mass lies is hardly seen: its prior is one more equation, x m = nominal x times m
        prior = np.zeros((1, A.shape[1]))
        prior[0, :2] = -LEVER.nominal, 1.0
        weights = np.append(1 / self.sigma, 1 / (LEVER_SPREAD * max(mass, 0.05)))
        A = np.vstack([A, prior]) * weights[:, None]
        b = np.append(self.left, 0.0) * weights
        unknown = np.linalg.lstsq(A, b, rcond=None)[0]
        return unknown, np.linalg.pinv(A.T @ A), float(np.sum((A @ unknown - b) ** 2))

    def residual(self, fade: float, peak: float, unknown: Array) -> Array:
        curve = np.sign(self.speed) * (1 + (peak - 1) * np.exp(-((self.speed / fade) ** 2)))
        friction = unknown[2 + self.joint] * curve + unknown[8 + self.joint] * self.speed
        return np.asarray(self.left - self.load @ unknown[:2] - friction)


def fitted(found: Sequence[Segment], robot: Robot, where: str) -> Fitted:
    """Friction and tool mass of segments of all joints.

    Args:
        found: of one or more recordings.
        robot: whose names are used.
        where: for messages.

    Raises:
        InputError: a joint without three speeds both ways; torques that are not those of this arm.
    """
    sticking = [each for each in found if each.unsteady > STICKS]
    found = [each for each in found if each.unsteady <= STICKS]
    _check_speeds(found, robot, where)
    rows = _Rows(found)
    mass = RANGES["tool_mass"].nominal
    for _ in range(3):
        unknown, _, _ = rows.solved(RANGES["stribeck"].nominal, RANGES["breakaway"].nominal, mass)
        mass = float(unknown[0])
    costs = np.array([[rows.solved(fade, peak, mass)[2] for peak in PEAKS] for fade in FADES])
    at = np.unravel_index(np.argmin(costs), costs.shape)
    best = minimize(
        lambda x: rows.solved(float(np.exp(x[0])), float(1 + x[1] ** 2), mass)[2],
        (np.log(FADES[at[0]]), np.sqrt(PEAKS[at[1]] - 1 + 1e-3)), method="Nelder-Mead",
        options={"xatol": 1e-4, "fatol": 1e-6, "maxiter": 400},
    )  # fmt: skip
    fade = float(np.clip(np.exp(best.x[0]), FADES[0], FADES[-1]))
    peak = float(np.clip(1 + best.x[1] ** 2, PEAKS[0], PEAKS[-1]))
    unknown, _, least = rows.solved(fade, peak, mass)
    left = rows.residual(fade, peak, unknown)
    _check(unknown, left, rows, robot, where)
    spare = max(len(found) - 16, 1)
    scale = max(least / spare, 1.0)
    result = _with_ranges(
        rows, (fade, peak, unknown, mass), costs <= min(least, costs.min()) + CHI2 * scale, scale, left
    )
    return replace(result, sticking=tuple(sorted({(each.joint, round(abs(each.speed), 3)) for each in sticking})))


def _with_ranges(
    rows: _Rows, best: tuple[float, float, Array, float], accepted: Array, scale: float, left: Array
) -> Fitted:
    """All Stribeck curves that fit about as well as the best one, and twice the standard deviation of each."""
    fade, peak, unknown, mass = best
    curves = [(fade, peak), *((FADES[i], PEAKS[k]) for i, k in np.argwhere(accepted))]
    low, high = np.full(15, np.inf), np.full(15, -np.inf)
    for curve in curves:
        each, covariance, _ = rows.solved(*curve, mass)
        sigma = SIGMAS * np.sqrt(scale * np.diag(covariance))
        # the share of the way is m x over m, whose own error is small beside it
        values = np.append(each, each[1] / each[0])
        sigma = np.append(sigma, sigma[1] / each[0])
        low, high = np.minimum(low, values - sigma), np.maximum(high, values + sigma)
    values = np.append(unknown, unknown[1] / unknown[0])
    table = np.stack([values, low, high])
    seen = np.array(curves)
    # what lies between two curves that were tried is not excluded
    half_fade, half_peak = np.sqrt(FADES[1] / FADES[0]), (PEAKS[1] - PEAKS[0]) / 2
    stribeck = np.array([fade, seen[:, 0].min() / half_fade, seen[:, 0].max() * half_fade])
    breakaway = np.array([peak, max(seen[:, 1].min() - half_peak, 1.0), seen[:, 1].max() + half_peak])
    residual = np.array([np.sqrt(np.mean(left[rows.joint == j] ** 2)) for j in range(6)])
    counts = np.bincount(rows.joint, minlength=6).astype(float)
    return Fitted(table[:, 0], table[:, 14], table[:, 2:8], table[:, 8:14], stribeck, breakaway, residual, counts)


def _check_speeds(found: Sequence[Segment], robot: Robot, where: str) -> None:
    for joint in range(6):
        for sense, words in ((1, "upwards"), (-1, "downwards")):
            speeds = sorted(abs(each.speed) for each in found if each.joint == joint and each.speed * sense > 0)
            count = sum(1 for k, speed in enumerate(speeds) if k == 0 or speed > APART * speeds[k - 1])
            if count < FEWEST_SPEEDS:
                raise InputError(
                    f"{robot.joint_names[joint]} moves alone {words} at {count} even speeds", where=where,
                    accepted=f"{FEWEST_SPEEDS} or more speeds of each joint, both ways: all of the sweeps",
                )  # fmt: skip


def _check(unknown: Array, left: Array, rows: _Rows, robot: Robot, where: str) -> None:
    """Refuse torques that this arm with any tool could not have."""
    accepted = f"torques of the joints of {robot.name}: --torque-ratio where those of the motors are logged"
    share = float(np.sqrt(np.mean(left**2)) / np.sqrt(np.mean(rows.torque**2)))
    if share > UNLIKE:
        raise InputError(
            f"the torques do not fit the weight of the arm: {100 * share:.0f} % of them is left over", where=where,
            accepted=accepted,
        )  # fmt: skip
    if unknown[0] <= 0:
        raise InputError(f"the mass of the tool comes out at {unknown[0]:.2f} kg", where=where, accepted=accepted)
    if (unknown[2:8] <= 0).any():
        joint = int(np.argmin(unknown[2:8]))
        raise InputError(
            f"the friction of {robot.joint_names[joint]} comes out at {unknown[2 + joint]:.2f} N m", where=where,
            accepted=accepted,
        )  # fmt: skip
