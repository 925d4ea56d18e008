"""The critical rates at a point of the target line, and the bracket that two legs have to span (theory §2)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from zerorev.errors import InputError
from zerorev.model._arrays import Array
from zerorev.model.robot import NIL_RATE
from zerorev.motion.drilling import Drilling, joint_rates

__all__ = ["NO_LEVER", "CriticalRates", "bracket", "critical", "critical_at", "kappa_of", "spread_of"]

NO_LEVER = 1e-12  # of theta_psi: below it the spin does not move a joint


@dataclass(frozen=True)
class CriticalRates:
    """The critical rates at one point of the target line, and the bracket that two legs have to span (theory §2).

    Attributes:
        branch: 0..7.
        psi: spin at the target [rad].
        kappa: twist rate at which each joint stands still [rad/m], shape (6,); infinite where the spin does not move a
            joint, NaN where nothing does, and all NaN where the branch cannot reach the target or is singular there.
        below: slope that one leg has to lie below, for every joint to keep the threshold at the target [rad/m].
        above: slope that the other leg has to lie above [rad/m].
    """

    branch: int
    psi: float
    kappa: Array
    below: float
    above: float

    @property
    def spread(self) -> float:
        """The twist spread, max kappa - min kappa [rad/m]; NaN where the branch cannot reach."""
        return float(spread_of(self.kappa))

    @property
    def width(self) -> float:
        """Of the bracket, `above - below` [rad/m]: the spread, and what the threshold adds to it."""
        return self.above - self.below


def critical(
    drilling: Drilling, branch: int, psi: float, min_rate: float = 0.0, *, standoff: float = 0.0
) -> CriticalRates:
    """The critical rates of a hole at one spin on one branch.

    Args:
        drilling: robot, tool and hole: target, direction and reference of the spin.
        branch: 0..7.
        psi: spin there [rad].
        min_rate: motion threshold [rad/m] that widens the bracket.
        standoff: where along the drill axis [m], if not at the target.

    Raises:
        InputError: no such branch.
    """
    if branch not in range(8):
        raise InputError(f"branch {branch}", where="branch", accepted="0 to 7")
    theta_s, theta_psi = (rates[branch] for rates in joint_rates(drilling, standoff, psi))
    below, above = bracket(theta_s, theta_psi, min_rate)
    return CriticalRates(branch, psi, kappa_of(theta_s, theta_psi), float(below), float(above))


def critical_at(drilling: Drilling, psi: float, min_rate: float = 0.0) -> tuple[CriticalRates, ...]:
    """The critical rates of a hole at one spin [rad] on every branch that reaches it and is not singular there."""
    found = (critical(drilling, branch, psi, min_rate) for branch in range(8))
    return tuple(each for each in found if not np.isnan(each.spread))


def bracket(theta_s: Array, theta_psi: Array, min_rate: float) -> tuple[Array, Array]:
    """Below and above which slopes keep every joint above the threshold at the target, shapes (...,); NaN out of reach.

    For a joint's rate to be `min_rate`, the slope has to lie that much beyond its critical rate.
    """
    kappa = kappa_of(theta_s, theta_psi)
    with np.errstate(divide="ignore", invalid="ignore"):
        beyond = min_rate / np.abs(theta_psi)
    still = np.isnan(kappa) & ~np.isnan(theta_s)  # a joint that does not move at all does not reverse
    above = np.where(still, -np.inf, kappa + beyond).max(axis=-1)
    with np.errstate(invalid="ignore"):  # both infinite, where the spin does not move a joint
        less = np.where(np.isinf(kappa), -np.inf, kappa - beyond)
    below = np.where(still, np.inf, less).min(axis=-1)
    return below, above


def kappa_of(theta_s: Array, theta_psi: Array) -> Array:
    """Critical rates [rad/m] of theta_s [rad/m] and theta_psi [1], each (..., 6), as `CriticalRates` has them."""
    with np.errstate(divide="ignore", invalid="ignore"):
        kappa = np.where(np.abs(theta_psi) <= NO_LEVER, np.inf, -theta_s / theta_psi)
    return np.where((np.abs(theta_s) <= NIL_RATE) & (np.abs(theta_psi) <= NO_LEVER), np.nan, kappa)


def spread_of(kappa: Array) -> Array:
    """Twist spread [rad/m], shape (...,), of critical rates (..., 6): inf where one is, NaN where none is known."""
    with np.errstate(invalid="ignore"):
        spread = np.fmax.reduce(kappa, axis=-1) - np.fmin.reduce(kappa, axis=-1)
    return np.where(np.isinf(kappa).any(axis=-1), np.inf, spread)
