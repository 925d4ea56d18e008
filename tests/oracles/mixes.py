"""Blends of two legs with any curve, by the kernels' inverse kinematics and finite differences: nothing of `verify`."""

from __future__ import annotations

import numpy as np

from zerorev.motion import kinematics

__all__ = ["any_curve", "joints_on", "one_way_curve", "outermost", "places", "velocities"]

STEP = 1e-6  # [m]


def places(points):
    """A triangle as shares (left, done) of the radius, shape (2, N): all of a square grid, on a + b <= 1."""
    k = np.arange(points)
    left, done = (each.ravel() for each in np.meshgrid(k, k))
    inside = left + done < points
    return np.stack([left[inside], done[inside]]) / (points - 1)


def joints_on(case, left, done):
    """Joints [rad], shape (N, 6), with `left` [m] of the plunge to go and `done` [m] of the retract behind.

    Args:
        case: robot, tool and a plan of straight legs.
        left: shape (N,).
        done: shape (N,).
    """
    robot, tool, plan = case
    motion, hole = plan.motion, plan.hole
    profile = motion.profile
    into, out = profile.twist_rate
    standoff = profile.standoff[1] + left + done
    psi = profile.psi[1] + into * left + out * done
    T = kinematics.tcp_pose(hole, standoff, psi) @ np.linalg.inv(tool.T_flange_tcp)
    joints = kinematics.inverse(robot, T)[:, motion.branch]
    return joints + 2 * np.pi * np.rint((motion.joints[1] - joints) / (2 * np.pi))


def velocities(case, left, done):
    """Rates d theta / d path [rad/m] as on the plunge and as on the retract, shape (2, N, 6)."""
    half = STEP / 2
    before = joints_on(case, left - half, done) - joints_on(case, left + half, done)
    behind = joints_on(case, left, done + half) - joints_on(case, left, done - half)
    return np.stack([before, behind]) / STEP


def outermost(mixes, radius, left, done):
    """Weights of the two velocities, with sum 1, between which those of all blends lie, shape (2, 2, N)."""
    if mixes == "any":
        one, none = np.ones_like(left), np.zeros_like(left)
        weights = np.array([[one, none], [none, one]])
    else:
        weights = np.array([[radius - left, done], [left, radius - done]])
    total = weights.sum(axis=1, keepdims=True)
    with np.errstate(invalid="ignore"):  # at the entry and the exit themselves every direction is one from there
        return weights / total


def any_curve(rng, steps):
    """A curve from entry to exit that runs as on one move, then on the other, and so on: shares (2, N)."""
    left, done, path = steps, 0, [(steps, 0)]
    while left or done < steps:
        forth = left > 0 and (left + done == steps or done == steps or rng.random() < 0.5)
        left, done = (left - 1, done) if forth else (left, done + 1)
        path.append((left, done))
    return np.array(path).T / steps


def one_way_curve(rng, steps):
    """A curve from entry to exit whose velocity turns from the first to the second alone: shares (2, N)."""
    into, out = rng.random(steps) ** rng.uniform(0.2, 6), rng.random(steps) ** rng.uniform(0.2, 6)
    order = np.argsort(out / into)
    left = 1 - np.cumsum(into[order]) / into.sum()
    done = np.cumsum(out[order]) / out.sum()
    return np.array([[1.0, *left[:-1], 0.0], [0.0, *done[:-1], 1.0]])
