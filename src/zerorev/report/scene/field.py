"""The field behind the twist plane: at every stand-off and spin, how cheap it is to have no reversal, and where not."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from zerorev.files.units import deg_per_mm
from zerorev.model._arrays import Array
from zerorev.motion.critical import NO_LEVER, kappa_of, spread_of
from zerorev.motion.drilling import Drilling, joint_rates
from zerorev.motion.joint_path import turns_within

__all__ = ["Field", "critical", "field", "over_limits", "stuck_joints"]


@dataclass(frozen=True)
class Field:
    """One branch over a patch of the twist plane.

    Attributes:
        standoff: [m], shape (S,).
        psi: [rad], shape (P,).
        spread: twist spread [deg/mm], shape (S, P); inf where a joint's critical rate is, NaN out of reach.
        theta_psi: d theta / d psi [1], shape (S, P, 6).
        stuck: joints (0..5) that spin moves nowhere.
        reached: whether the branch exists, shape (S, P).
        over_limit: which joints no turn brings within their limits, shape (S, P, 6).
    """

    standoff: Array
    psi: Array
    spread: Array
    theta_psi: Array
    stuck: tuple[int, ...]
    reached: np.ndarray
    over_limit: np.ndarray


def critical(drilling: Drilling, branch: int, standoff: Array, psi: Array) -> tuple[Array, Array]:
    """Critical rates kappa [deg/mm] and theta_psi [1], each (..., 6), at points (...,) of one branch (theory §2).

    kappa is infinite for a joint that spin does not move, and NaN for one that nothing moves: it needs no bracket.

    Args:
        drilling: whose twist plane it is.
        branch: 0..7.
        standoff: [m], shape (...,).
        psi: spin [rad], shape (...,).
    """
    theta_s, theta_psi = (rates[..., branch, :] for rates in joint_rates(drilling, standoff, psi))
    return deg_per_mm(kappa_of(theta_s, theta_psi)), theta_psi


def over_limits(drilling: Drilling, joints: Array) -> np.ndarray:
    """Which joints no turn brings within their limits, shape (..., 6), of controller angles [rad], shape (..., 6)."""
    with np.errstate(invalid="ignore"):
        return np.asarray(~turns_within(joints, joints, drilling.limits)[1])


def field(drilling: Drilling, branch: int, standoff: Array, psi: Array) -> Field:
    """The field on the grid of stand-offs [m], shape (S,), and spins [rad], shape (P,), of one branch.

    Args:
        drilling: whose twist plane it is.
        branch: 0..7.
        standoff: [m], shape (S,).
        psi: spin [rad], shape (P,).
    """
    s, p = np.meshgrid(standoff, psi, indexing="ij")
    kappa, theta_psi = critical(drilling, branch, s, p)
    joints = drilling.angles(s, p)[..., branch, :]
    reached = ~np.isnan(joints[..., 0])
    spread = np.where(reached, spread_of(kappa), np.nan)
    return Field(standoff, psi, spread, theta_psi, stuck_joints(theta_psi), reached, over_limits(drilling, joints))


def stuck_joints(theta_psi: Array) -> tuple[int, ...]:
    """Joints (0..5) that spin does not move at any of the points (..., 6): the finding of a tool without lever."""
    flat = np.abs(theta_psi.reshape(-1, 6))
    flat = flat[~np.isnan(flat[:, 0])]
    return tuple(i for i in range(6) if flat.size and (flat[:, i] <= NO_LEVER).all())
