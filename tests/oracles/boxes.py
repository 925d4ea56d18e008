"""What legs of a box really do, followed closely, to hold a bound against; it shares nothing with the bounding code."""

from __future__ import annotations

import numpy as np

from zerorev.motion.drilling import Drilling
from zerorev.motion.joint_path import joints_along, outward_rates

__all__ = ["POINTS", "leg"]

POINTS = 801
NIL = np.deg2rad(1e-6)  # [rad/m]


def leg(drilled, posture, psi_t, slope):
    """Rates, turns, travel and model angles of one leg on the unflipped wrist; None where it cannot be run."""
    robot, tool, hole, _ = drilled.all
    branch = 2 * posture + (0 if robot.arm.sign[4] > 0 else 1)
    s = np.linspace(0, hole.depth, POINTS)
    psi = psi_t + slope * s
    joints = joints_along(Drilling(robot, tool, hole), branch, s, psi)
    if np.isnan(joints).any() or np.abs(np.diff(joints, axis=0)).max() > 0.3:
        return None
    sign = np.array(robot.arm.sign)
    rates = outward_rates(Drilling(robot, tool, hole), branch, s, psi, np.full(POINTS, slope)) * sign
    moving = np.where(np.abs(rates) > NIL, np.sign(rates), 0.0)
    turns, first = np.zeros(6, int), np.zeros(6)
    for i in range(6):
        signs = moving[moving[:, i] != 0, i]
        turns[i] = int((signs[1:] != signs[:-1]).sum())
        first[i] = signs[0] if signs.size else 0.0
    return {
        "s": s,
        "rates": rates,
        "turns": turns,
        "first": first,
        "travel": float(np.abs(np.diff(joints, axis=0)).sum()),
        "angles": joints * sign - np.array(robot.arm.offset),
    }
