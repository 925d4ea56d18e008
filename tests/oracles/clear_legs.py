"""The least travel of two straight legs that keep clear of a box, by brute force.

At each of many spins at the target the slopes of a grid on either side of the critical rates are tried, each leg
sampled; then more spins around the best ones.
"""

from __future__ import annotations

import numpy as np

from oracles.solids import least_at
from zerorev.model.arm_bodies import bodies_of
from zerorev.motion.drilling import joint_rates
from zerorev.motion.joint_path import outward_rates
from zerorev.search.straight import LEAST_RATE

__all__ = ["least_travel"]

NODES, SLOPES, SPINS = 25, 70, 480
HALVINGS = 16


class _Legs:
    def __init__(self, drilling, settings, box, branch):
        self.drilling, self.settings, self.box, self.branch = drilling, settings, box, branch
        self.moving = [body for body in bodies_of(drilling.robot, drilling.tool) if body.link > 0]
        self.standoff = np.linspace(0, drilling.hole.depth, NODES)

    def look(self, psi_t, slope):
        """Which legs turn no joint round and keep the threshold, their joints, and what they travel."""
        standoff = np.tile(self.standoff, (slope.size, 1))
        psi = psi_t + slope[:, None] * standoff
        rates = outward_rates(self.drilling, self.branch, standoff.ravel(), psi.ravel(), np.repeat(slope, NODES))
        rates = rates.reshape(slope.size, NODES, 6)
        fits = ((rates * np.sign(rates[:, :1])).min(axis=1) > max(self.settings.min_rate, LEAST_RATE)).all(axis=1)
        joints = self.drilling.angles(standoff, psi)[..., self.branch, :]
        joints = np.unwrap(joints, axis=1)
        travel = np.abs(joints[:, -1] - joints[:, 0]).sum(axis=1)
        return fits & np.isfinite(travel), joints, travel

    def clear(self, joints):
        robot = self.drilling.robot
        return least_at(robot, self.moving, joints, self.box, thirds=24).min() >= self.settings.clearance

    def side(self, psi_t, nearest, way, most):
        """The leg on one side of the critical rates that travels least: travel and joints, or None."""
        steepest = 2 * np.pi / self.drilling.hole.depth
        slope = nearest + way * max(steepest - way * nearest, 0.0) * np.geomspace(1e-4, 1, SLOPES)
        fits, joints, travel = self.look(psi_t, slope)
        for k in np.argsort(np.where(fits, travel, np.inf)):
            if not fits[k] or travel[k] > most:
                return None
            if self.clear(joints[k]):
                break
        else:
            return None
        best = travel[k], joints[k]
        for beside in (k - 1, k + 1):
            good, bad = slope[k], slope[min(max(beside, 0), SLOPES - 1)]
            for _ in range(HALVINGS):
                middle = (good + bad) / 2
                (fit,), (along,), (moved,) = self.look(psi_t, np.array([middle]))
                if fit and moved < best[0] + 1e-12 and self.clear(along):
                    good, best = middle, (moved, along)
                else:
                    bad = middle
        return best

    def at(self, spins, most):
        """The best pairs at spins: travel and spin, best first."""
        theta_s, theta_psi = joint_rates(self.drilling, np.zeros(spins.size), spins)
        with np.errstate(all="ignore"):
            critical = (-theta_s / theta_psi)[:, self.branch]
        found = []
        for psi_t, kappa in zip(spins, critical, strict=True):
            if not np.isfinite(kappa).all():
                continue
            pair = [self.side(psi_t, kappa.max(), 1, most), None]
            if pair[0] is not None:
                pair[1] = self.side(psi_t, kappa.min(), -1, most)
            if pair[1] is not None and self.within(*pair):
                found.append((pair[0][0] + pair[1][0], psi_t))
                most = min(most, found[-1][0] * 1.15)
        return sorted(found)

    def within(self, one, other):
        """Whether full turns bring both within the limits."""
        limits = self.drilling.limits
        both = np.concatenate([one[1], other[1]])
        turn = 2 * np.pi
        first = np.ceil((limits.lower - both.min(axis=0)) / turn)
        return (first <= np.floor((limits.upper - both.max(axis=0)) / turn)).all()


def least_travel(drilling, settings, box, branch, most):
    """The least travel found [rad], inf where none is below `most`."""
    legs = _Legs(drilling, settings, box, branch)
    found = legs.at(np.linspace(-np.pi, np.pi, SPINS, endpoint=False), most)
    if not found:
        return np.inf
    best, step, around = found[0][0], 2 * np.pi / SPINS, []
    for _, psi_t in found:
        if all(abs(psi_t - other) > 3 * step for other in around):
            around.append(psi_t)
    for psi_t in around[:2]:
        width = step
        for _ in range(3):
            closer = legs.at(np.linspace(psi_t - width, psi_t + width, 9), best * 1.05)
            if closer:
                best, psi_t = min(best, closer[0][0]), closer[0][1]
            width /= 4
    return best
