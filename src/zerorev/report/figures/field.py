"""The field behind the twist plane: at every stand-off and spin, how cheap it is to have no reversal, and where not."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from zerorev.kinematics import inverse, joint_rates, tcp_pose
from zerorev.model._arrays import Array
from zerorev.model.hole import Hole
from zerorev.model.plan import Plan
from zerorev.report.figures.style import deg_per_mm

__all__ = ["Field", "critical", "field", "stuck_joints"]

NO_LEVER = 1e-9  # |theta_psi| below which spin does not move a joint
NIL = 1e-9  # [deg/mm] |theta_s| below which the stroke does not move a joint (conventions: signature)
FULL_TURN = 2 * np.pi


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


def critical(plan: Plan, hole: Hole, branch: int, standoff: Array, psi: Array) -> tuple[Array, Array]:
    """Critical rates kappa [deg/mm] and theta_psi [1], each (..., 6), at points (...,) of one branch (theory §2).

    kappa is infinite for a joint that spin does not move, and NaN for one that nothing moves: it needs no bracket.
    """
    theta_s, theta_psi = (rates[..., branch, :] for rates in joint_rates(plan.robot, plan.tool, hole, standoff, psi))
    stuck = np.abs(theta_psi) < NO_LEVER
    still = stuck & (np.abs(deg_per_mm(theta_s)) < NIL)
    with np.errstate(divide="ignore", invalid="ignore"):
        kappa = np.where(stuck, np.inf, deg_per_mm(-theta_s / theta_psi))
    return np.where(still, np.nan, kappa), theta_psi


def field(plan: Plan, hole: Hole, branch: int, standoff: Array, psi: Array) -> Field:
    """The field on the grid of stand-offs [m], shape (S,), and spins [rad], shape (P,)."""
    s, p = np.meshgrid(standoff, psi, indexing="ij")
    kappa, theta_psi = critical(plan, hole, branch, s, p)
    joints = inverse(plan.robot, tcp_pose(hole, s, p) @ np.linalg.inv(plan.tool.T_flange_tcp))[..., branch, :]
    reached = ~np.isnan(joints[..., 0])
    limits = plan.robot.limits
    with np.errstate(invalid="ignore"):
        first = np.ceil((limits.lower - joints) / FULL_TURN - 1e-12)
        last = np.floor((limits.upper - joints) / FULL_TURN + 1e-12)
        over = first > last
        spread = np.fmax.reduce(kappa, axis=-1) - np.fmin.reduce(kappa, axis=-1)
    spread = np.where(np.isinf(kappa).any(axis=-1), np.inf, spread)
    spread = np.where(reached, spread, np.nan)
    return Field(standoff, psi, spread, theta_psi, stuck_joints(theta_psi), reached, over)


def stuck_joints(theta_psi: Array) -> tuple[int, ...]:
    """Joints (0..5) that spin does not move at any of the points (..., 6): the finding of a tool without lever."""
    flat = np.abs(theta_psi.reshape(-1, 6))
    flat = flat[~np.isnan(flat[:, 0])]
    return tuple(i for i in range(6) if flat.size and (flat[:, i] < NO_LEVER).all())
