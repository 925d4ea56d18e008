"""What all searches over straight legs share: how far they look, and how two legs become a motion."""

from __future__ import annotations

from typing import Any

import numpy as np

from zerorev.kernels.layout import LONGEST_TWIST, Constraints
from zerorev.model._arrays import Array
from zerorev.model.job import Settings
from zerorev.model.profile import Profile
from zerorev.motion.drilling import Drilling

__all__ = ["GRID", "LEAST_RATE", "LIMIT_SLACK", "constraints", "steepest_twist", "straight_motion", "target_spins"]

GRID = 240  # spins at the target in one turn
LIMIT_SLACK = 1e-6  # [rad] kept to the limits, so that rounding passes none
LEAST_RATE = float(np.deg2rad(1e-5))  # [rad/m] 1e-8 deg/mm: a joint that must not stop keeps at least so much


def constraints(
    drilling: Drilling, settings: Settings, min_rate: float, *, slack: float = LIMIT_SLACK, **more: Any
) -> Constraints:
    """What legs have to keep.

    Args:
        drilling: whose joint limits they keep.
        settings: for the bound on the spin.
        min_rate: of every joint [rad/m]; the least rate, at least.
        slack: kept to the limits besides [rad].
        more: as `Constraints` has it.
    """
    limits = drilling.limits
    return Constraints(
        lower=limits.lower + slack,
        upper=limits.upper - slack,
        min_rate=max(min_rate, LEAST_RATE),
        psi_bound=settings.psi_bound or 0.0,
        **more,
    )


def steepest_twist(settings: Settings, depth: float) -> float:
    """The steepest slope of a straight leg [rad/m]: one turn of the tool; where legs are free, the cap on the twist.

    Args:
        settings: `legs`, and `max_twist`, which holds for free legs and so for straight ones among them.
        depth: of the leg [m].
    """
    turn = LONGEST_TWIST / depth
    return min(turn, settings.max_twist) if settings.legs == "free" else turn


def target_spins(psi_bound: float | None, per_turn: int) -> Array:
    """Evenly spaced spins at the target [rad], shape (K,).

    Args:
        psi_bound: spins within +- this [rad], both ends among them; None: once round the circle.
        per_turn: how many a full turn would have.
    """
    if psi_bound is None:
        return np.linspace(-np.pi, np.pi, per_turn, endpoint=False)
    return np.linspace(-psi_bound, psi_bound, max(3, int(np.ceil(per_turn * psi_bound / np.pi))) + 1)


def straight_motion(depth: float, psi_t: float, slopes: tuple[float, float], *, periodic: bool) -> Profile:
    """The motion of two straight legs out of the target.

    Of the two twins it is the one that turns the tool less while it cuts (theory §2).

    Args:
        depth: length of the legs [m].
        psi_t: spin at the target [rad]; brought within (-pi, pi] where the spin is periodic.
        slopes: twist rates of the two legs, in any order [rad/m].
        periodic: whether full turns of the tool do not matter.
    """
    if periodic:
        psi_t -= 2 * np.pi * np.ceil((psi_t - np.pi) / (2 * np.pi))
    plunge, retract = sorted(slopes, key=abs)
    return Profile.straight(depth, psi_t + plunge * depth, psi_t, psi_t + retract * depth)
