"""The slow twin of the legs: dense samples of the two rate fields and of the joints, extremes as they are seen.

Units as in the kernels: m, rad, outward rates in rad/m, controller angles.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np

from zerorev.kernels import legs as kernels
from zerorev.motion import kinematics
from zerorev.motion.drilling import Drilling, joint_rates

DENSE = 2001


@dataclass(frozen=True)
class Leg:
    """A leg as dense samples show it: rates and angles relative to the target, each (N, 6)."""

    standoff: np.ndarray
    rates: np.ndarray
    angles: np.ndarray

    @property
    def rows(self):
        """What `trace_leg` writes, shape (ROWS, 6)."""
        rows = np.empty((kernels.ROWS, 6))
        rows[kernels.LEAST_RATE], rows[kernels.GREATEST_RATE] = self.rates.min(axis=0), self.rates.max(axis=0)
        rows[kernels.LEAST_ANGLE], rows[kernels.GREATEST_ANGLE] = self.angles.min(axis=0), self.angles.max(axis=0)
        rows[kernels.END_ANGLE] = self.angles[-1]
        rows[kernels.MOVED] = np.abs(np.diff(self.angles, axis=0)).sum(axis=0)
        rows[kernels.TURNS] = self.turns
        rows[kernels.TARGET_RATE] = self.rates[0]
        return rows

    @property
    def turns(self):
        counts = []
        for rate in self.rates.T:
            signs = np.sign(rate[np.abs(rate) > kernels.NIL])
            counts.append(int((signs[1:] != signs[:-1]).sum()))
        return np.array(counts)

    def derivative(self, order):
        """Greatest absolute derivative of each joint's rate, shape (6,), from differences 20 samples wide."""
        coarse = self.rates[::20]
        width = self.standoff[20] - self.standoff[0]
        return np.abs(np.diff(coarse, n=order, axis=0)).max(axis=0) / width**order


def trace(robot, tool, hole, branch, psi_t, slope, samples=DENSE):
    """The leg, or None where it cannot be followed to its end."""
    standoff = np.linspace(0.0, hole.depth, samples)
    psi = psi_t + slope * standoff
    theta_s, theta_psi = joint_rates(Drilling(robot, tool, hole), standoff, psi)
    rates = (theta_s + slope * theta_psi)[:, branch]
    poses = kinematics.tcp_pose(hole, standoff, psi) @ np.linalg.inv(tool.T_flange_tcp)
    joints = kinematics.inverse(robot, poses)[:, branch]
    if not (np.isfinite(rates).all() and np.isfinite(joints).all()):
        return None
    joints = np.unwrap(joints, axis=0)
    return Leg(standoff, rates, joints - joints[0])


def judge(leg, sense, keep, at_target, asked):
    """(margin, slack, travel) of a leg, joint by joint, by the words of `judge_leg`."""
    margins = [np.inf]
    for i in range(6):
        wanted, rates = np.sign(sense[i]), leg.rates[:, i]
        moves = np.abs(rates).max() > kernels.NIL
        if moves and keep[i]:
            least = (wanted * rates).min()
            if asked.mean_rule:
                margins += [wanted * leg.angles[-1, i] / asked.depth, least + asked.min_rate]
            else:
                margins.append(least)
        elif moves and not asked.turn_inside:
            margins.append(max(rates.min(), (-rates).min()) + asked.min_rate)
    joints = at_target + leg.angles
    slack = min((joints - asked.lower).min(), (asked.upper - joints).min())
    return min(margins), slack, np.abs(np.diff(leg.angles, axis=0)).sum()


def choices_of_turns(principal, asked):
    """Every way to turn six joints within the limits."""
    turns = [
        [angle + 2 * np.pi * k for k in range(-5, 6) if low <= angle + 2 * np.pi * k <= high]
        for angle, low, high in zip(principal, asked.lower, asked.upper, strict=True)
    ]
    return list(product(*turns))


@dataclass(frozen=True)
class Judged:
    """Many slopes at once, each of shape (M,): what `judge` says of them."""

    slope: np.ndarray
    margin: np.ndarray
    slack: np.ndarray
    travel: np.ndarray

    def least_travel(self, margin, slack=0.0):
        """Over the slopes that keep so much; inf where none does."""
        return self.travel[(self.margin >= margin) & (self.slack >= slack)].min(initial=np.inf)


def judge_slopes(robot, tool, hole, branch, psi_t, slopes, sense, keep, at_target, asked, nodes=33):
    """`judge` of many slopes by the pointwise rule, out of reach where margin is -inf."""
    standoff = np.linspace(0.0, hole.depth, nodes)
    psi = psi_t + slopes[:, None] * standoff
    theta_s, theta_psi = joint_rates(Drilling(robot, tool, hole), np.broadcast_to(standoff, psi.shape), psi)
    rates = (theta_s + slopes[:, None, None, None] * theta_psi)[:, :, branch]
    poses = kinematics.tcp_pose(hole, standoff, psi) @ np.linalg.inv(tool.T_flange_tcp)
    joints = kinematics.inverse(robot, poses)[:, :, branch]
    runs = np.isfinite(rates).all(axis=(1, 2)) & np.isfinite(joints).all(axis=(1, 2))
    rates, joints = np.where(runs[:, None, None], rates, 0.0), np.where(runs[:, None, None], joints, 0.0)
    angles = np.unwrap(joints, axis=1)
    angles = at_target + angles - angles[:, :1]
    least, greatest = rates.min(axis=1), rates.max(axis=1)
    pointwise = np.where(np.asarray(sense) > 0, least, -greatest)
    either = np.inf if asked.turn_inside else np.maximum(least, -greatest) + asked.min_rate
    margin = np.where(keep, pointwise, either)
    margin = np.where((least >= -kernels.NIL) & (greatest <= kernels.NIL), np.inf, margin).min(axis=1)
    slack = np.minimum(angles - asked.lower, asked.upper - angles).min(axis=(1, 2))
    travel = np.abs(np.diff(angles, axis=1)).sum(axis=(1, 2))
    return Judged(slopes, np.where(runs, margin, -np.inf), np.where(runs, slack, -np.inf), travel)
