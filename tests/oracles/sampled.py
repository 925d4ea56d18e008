"""The slow twin of the sampled objective: one motion, one branch, angles point by point, in plain NumPy."""

from __future__ import annotations

import numpy as np

from zerorev.motion import kinematics

FULL = 2 * np.pi


def judge(robot, tool, hole, fractions, spins, *, first_point, least_rate=0.0, mean=False):
    """(eq. 4.7, reversals) of each branch with the thesis' weights; -1 reversals where the motion cannot be run."""
    paths = path(robot, tool, hole, fractions, spins)
    rules = {"first_point": first_point, "least_rate": least_rate, "mean": mean}
    return [_judged(robot, hole, fractions, paths[:, branch], **rules) for branch in range(8)]


def _judged(robot, hole, fractions, joints, *, first_point, least_rate, mean):
    if np.isnan(joints).any():
        return 1.0, -1
    steps, legs = np.diff(joints, axis=0), fractions.size - 1
    counts = np.array([turns_of(steps[:, i]) for i in range(6)])
    size = hole.depth * np.abs(np.diff(fractions))
    if mean:
        slow = [min(abs(steps[:legs, i].sum()), abs(steps[legs:, i].sum())) < least_rate * hole.depth for i in range(6)]
    else:
        asked = least_rate * np.concatenate([size[::-1], size])
        slow = [(np.abs(steps[:, i]) < asked).any() for i in range(6)]
    wrong = int(np.abs(steps).max() > 0.5) + int(any(s and n == 0 for s, n in zip(slow, counts, strict=True)))
    wrong += not all(fits(robot, joints[:, i], i, first_point) for i in range(6))
    cost = 6 / 7 * counts.sum() / 6 + 1 / 7 * np.abs(steps).sum() / (6 * FULL) + wrong
    return cost, -1 if wrong else int(counts.sum())


def path(robot, tool, hole, fractions, spins, branch=slice(None)):
    """Continuous joints of one branch or all, from the first point's within (-pi, pi]; NaN where it cannot reach."""
    start, target, end = spins
    x = np.concatenate([fractions[::-1], fractions[1:]])
    outer = np.where(np.arange(x.size) < fractions.size, start, end)
    T = kinematics.tcp_pose(hole, x * hole.depth, target + x * (outer - target))
    return np.unwrap(kinematics.inverse(robot, T @ np.linalg.inv(tool.T_flange_tcp))[:, branch], axis=0)


def turns_of(steps):
    direction, turns = 0.0, 0
    for step in steps:
        if abs(step) > 1e-12:
            turns += direction * step < 0
            direction = step
    return turns


def fits(robot, angles, i, first_point):
    lower, upper = robot.limits.lower[i], robot.limits.upper[i]
    turns = range(-4, 5)
    if first_point:  # within +-180 deg, the last joint within 0 to 360 deg
        least = 0.0 if i == 5 else -np.pi
        turns = [k for k in turns if least <= angles[0] + FULL * k < least + FULL]
    return any(lower <= (angles + FULL * k).min() and (angles + FULL * k).max() <= upper for k in turns)
