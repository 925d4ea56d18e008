"""Free legs drawn at random and followed in small steps: the slow twin of outer sets. It shares nothing with them.

Many walkers set out from spins at the target on one branch; each goes on at a slope between the least and the greatest
that the joints' directions leave at the point where it is, and stops where none is left, or where the slope is not
admissible any more at the end of its step, or a joint is beyond its limits.

Units as in the kernels: m, rad, outward rates in rad/m, controller angles.
"""

from __future__ import annotations

import numpy as np

from zerorev.motion.drilling import Drilling, joint_rates
from zerorev.motion.joint_path import joints_along

__all__ = ["deepest_of_walks", "walked"]


def _slopes(theta_s, theta_psi, sigma, min_rate, steepest):
    """Least and greatest admissible slope of each walker; the first above the second where there is none."""
    with np.errstate(divide="ignore", invalid="ignore"):
        edge = (min_rate - sigma * theta_s) / (sigma * theta_psi)
        least = np.where(sigma * theta_psi > 0, edge, -steepest).max(axis=1).clip(-steepest, None)
        most = np.where(sigma * theta_psi < 0, edge, steepest).min(axis=1).clip(None, steepest)
    unknown = np.isnan(theta_s).any(axis=1) | np.isnan(theta_psi).any(axis=1)
    return np.where(unknown, 1.0, least), np.where(unknown, -1.0, most)


def _rates(drilled, branch, s, psi):
    theta_s, theta_psi = joint_rates(Drilling(drilled.robot, drilled.tool, drilled.hole), s, psi)
    return theta_s[:, branch], theta_psi[:, branch]


def walked(rng, drilled, branch, psi_t, sigma, step, longest):
    """How far each walker gets [m], from spins psi_t (N,) with wanted signs sigma (N, 6)."""
    settings, limits, count = drilled.settings, drilled.robot.limits, psi_t.size
    psi, depth, alive = psi_t.copy(), np.zeros(count), np.ones(count, bool)
    share = rng.beta(0.4, 0.4, count)
    min_rate = max(settings.min_rate, 1e-9)
    bound = settings.psi_bound or np.inf
    s = 0.0
    while alive.any() and s < longest:
        at = np.flatnonzero(alive)
        s_at = np.full(at.size, s)
        least, most = _slopes(*_rates(drilled, branch, s_at, psi[at]), sigma[at], min_rate, settings.max_twist)
        slope = least + share[at] * (most - least)
        psi_end = psi[at] + step * slope
        theta_s, theta_psi = _rates(drilled, branch, s_at + step, psi_end)
        joints = joints_along(Drilling(drilled.robot, drilled.tool, drilled.hole), branch, s_at + step, psi_end)
        with np.errstate(invalid="ignore"):
            keeps = (sigma[at] * (theta_s + slope[:, None] * theta_psi) >= min_rate).all(axis=1)
            turns = np.ceil((limits.lower - joints) / (2 * np.pi))
            inside = (joints + 2 * np.pi * turns <= limits.upper).all(axis=1)
        good = (least <= most) & keeps & inside & (np.abs(psi_end) <= bound)
        psi[at[good]], depth[at[good]] = psi_end[good], s + step
        alive[at[~good]] = False
        share = np.where(rng.uniform(size=count) < 0.02, rng.beta(0.4, 0.4, count), share)
        s += step
    return depth


def deepest_of_walks(rng, drilled, branch, *, spins, tries, step, longest):
    """The deepest pair of legs out of one spin at the target that random walks find on a branch [m]."""
    bound = drilled.settings.psi_bound or np.pi
    psi_t = np.repeat(rng.uniform(-bound, bound, spins), tries)
    joints = joints_along(Drilling(drilled.robot, drilled.tool, drilled.hole), branch, np.zeros(psi_t.size), psi_t)
    limits = drilled.robot.limits
    with np.errstate(invalid="ignore"):
        turns = np.ceil((limits.lower - joints) / (2 * np.pi))
        psi_t = psi_t[(joints + 2 * np.pi * turns <= limits.upper).all(axis=1)]
    if psi_t.size == 0:
        return 0.0
    sigma = np.sign(_rates(drilled, branch, np.zeros(psi_t.size), psi_t)[1])
    legs = [walked(rng, drilled, branch, psi_t, way * sigma, step, longest) for way in (1, -1)]
    deepest = 0.0
    for psi in np.unique(psi_t):
        same = psi_t == psi
        deepest = max(deepest, min(leg[same].max() for leg in legs))
    return float(deepest)
