"""The least travel of two straight legs that keep clear of boxes, by brute force, on every branch that reaches a hole.

At each of many spins at the target the slopes of a grid on either side of the critical rates are tried, each leg
sampled. The pairs are then gone through from the least travel on, until the legs of one keep clear; around the best few
the grid is made finer, until it hardly matters. Nothing of the search, and none of its distances, is used.
"""

from __future__ import annotations

import numpy as np

from oracles.solids import least_at
from zerorev.model.arm_bodies import bodies_of
from zerorev.motion.drilling import joint_rates
from zerorev.motion.joint_path import outward_rates

__all__ = ["clear_of_all", "least_travel", "moving"]

NODES, SLOPES, SPINS = 25, 48, 360
LEAST_RATE = np.deg2rad(1e-5)  # [rad/m] a joint that goes slower stands still
STARTS, ROUNDS, BESIDE = 4, 14, 4  # of the finer grids; places on either side of the best one


def moving(drilling):
    """The bodies of the arm and its tool that move."""
    return [body for body in bodies_of(drilling.robot, drilling.tool) if body.link > 0]


def clear_of_all(drilling, settings, bodies, joints):
    """Whether some bodies keep the clearance from all boxes at joints (N, 6)."""
    return all(
        least_at(drilling.robot, bodies, joints, box, thirds=24).min() >= settings.clearance
        for box in settings.surroundings.obstacles
    )


class _Legs:
    """Straight legs out of spins at the target on one branch: shapes (spins, slopes) throughout."""

    def __init__(self, drilling, settings, bodies, branch, psi_t, slope):
        self.drilling, self.settings, self.bodies = drilling, settings, bodies
        standoff = np.linspace(0, drilling.hole.depth, NODES)
        psi = psi_t[:, None, None] + slope[..., None] * standoff
        at = np.broadcast_to(standoff, psi.shape)
        rates = outward_rates(drilling, branch, at.ravel(), psi.ravel(), np.repeat(slope.ravel(), NODES))
        rates = rates.reshape(*psi.shape, 6)
        slowest = max(settings.min_rate, LEAST_RATE)
        self.fits = ((rates * np.sign(rates[..., :1, :])).min(axis=2) > slowest).all(axis=-1)
        self.fits &= np.abs(slope) * drilling.hole.depth <= 2 * np.pi
        self.joints = np.full((*slope.shape, NODES, 6), np.nan)
        self.joints[self.fits] = np.unwrap(drilling.angles(at[self.fits], psi[self.fits])[..., branch, :], axis=1)
        self.travel = np.abs(self.joints[..., -1, :] - self.joints[..., 0, :]).sum(axis=-1)
        self.fits &= np.isfinite(self.travel)
        self.known = np.zeros(slope.shape, dtype=int)  # 1: keeps clear; -1: does not

    def clear(self, n, k):
        """Whether a leg keeps clear."""
        if self.known[n, k] == 0:
            keeps = clear_of_all(self.drilling, self.settings, self.bodies, self.joints[n, k])
            self.known[n, k] = 1 if keeps else -1
        return self.known[n, k] > 0


def _pairs(drilling, one, other, most):
    """Pairs of legs that fit together, from the least travel on, none above the most: travel, spin and slopes."""
    fits = one.fits[:, :, None] & other.fits[:, None, :]
    total = np.where(fits, one.travel[:, :, None] + other.travel[:, None], np.inf)
    n, j, k = np.nonzero(total < most)
    order = np.argsort(total[n, j, k], kind="stable")
    limits, turn = drilling.limits, 2 * np.pi
    for at in np.array_split(order, max(len(order) // 512, 1)):
        at = at[(one.known[n[at], j[at]] >= 0) & (other.known[n[at], k[at]] >= 0)]
        if not at.size:
            continue
        # no joint turns round on a leg
        ends = np.concatenate([one.joints[n[at], j[at]][:, [0, -1]], other.joints[n[at], k[at]][:, [0, -1]]], axis=1)
        low, high = ends.min(axis=1), ends.max(axis=1)
        within = (np.ceil((limits.lower - low) / turn) <= np.floor((limits.upper - high) / turn)).all(axis=1)
        for m in at[within].tolist():
            yield float(total[n[m], j[m], k[m]]), int(n[m]), int(j[m]), int(k[m])


def _best(drilling, one, other, most, count=1):
    """The first pairs that keep clear, of spins that are apart: travel, spin, slopes by their numbers."""
    found = []
    for travel, n, j, k in _pairs(drilling, one, other, most):
        if any(abs(n - each[1]) <= 3 for each in found):
            continue
        if one.clear(n, j) and other.clear(n, k):
            found.append((travel, n, j, k))
            if len(found) == count:
                break
    return found


def _slopes(drilling, branch, psi_t):
    """Slopes on either side of the critical rates, close together near them: above and below, shape (n, SLOPES)."""
    theta_s, theta_psi = joint_rates(drilling, np.zeros(psi_t.size), psi_t)
    with np.errstate(all="ignore"):
        critical = (-theta_s / theta_psi)[:, branch]
    steepest, share = 2 * np.pi / drilling.hole.depth, np.geomspace(1e-4, 1, SLOPES)
    above, below = critical.max(axis=1)[:, None], critical.min(axis=1)[:, None]
    return above + np.maximum(steepest - above, 0.0) * share, below - np.maximum(steepest + below, 0.0) * share


def _finer(drilling, settings, bodies, branch, start, psi_t, slopes, steps):
    """The best pair around one: grids that follow it and shrink."""
    best, places = start, np.linspace(-1, 1, 2 * BESIDE + 1)
    width, wide = steps[0], list(steps[1:])
    for _ in range(ROUNDS):
        spins = psi_t + width * places[1::2]
        one, other = (
            _Legs(drilling, settings, bodies, branch, spins, np.tile(slope + w * places, (spins.size, 1)))
            for slope, w in zip(slopes, wide, strict=True)
        )
        found = _first(drilling, one, other, best)
        if found is not None:
            best, n, j, k = found
            psi_t, slopes = spins[n], (slopes[0] + wide[0] * places[j], slopes[1] + wide[1] * places[k])
        width, wide = width * 0.6, [0.6 * w for w in wide]
    return best


def _first(drilling, one, other, most):
    found = _best(drilling, one, other, most)
    return found[0] if found else None


def least_travel(drilling, settings, most=np.inf):
    """The least travel found [rad], inf where no pair of legs keeps clear.

    Args:
        drilling: robot, tool and hole.
        settings: with the boxes.
        most: pairs that travel more are left out [rad].
    """
    spins = np.linspace(-np.pi, np.pi, SPINS, endpoint=False)
    bodies, seen = moving(drilling), []
    for branch in range(8):
        reached = np.isfinite(drilling.angles(np.zeros(SPINS), spins)[:, branch]).all(axis=1)
        if not reached.any():
            continue
        psi_t = spins[reached]
        above, below = _slopes(drilling, branch, psi_t)
        one, other = (_Legs(drilling, settings, bodies, branch, psi_t, slope) for slope in (above, below))
        bound = min([most, *(1.1 * travel for travel, *_ in seen)])
        for travel, n, j, k in _best(drilling, one, other, bound, STARTS):
            # as far as to the next places of the grid
            beside = [np.abs(np.gradient(row))[m] for row, m in ((above[n], j), (below[n], k))]
            seen.append((travel, branch, psi_t[n], (above[n, j], below[n, k]), (2 * np.pi / SPINS, *beside)))
    best = np.inf
    for travel, branch, psi, slopes, steps in sorted(seen)[:STARTS]:
        best = min(best, _finer(drilling, settings, bodies, branch, travel, psi, slopes, steps))
    return best
