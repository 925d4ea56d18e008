"""The slow twin of free legs: spins on a grid, reached by moves from node to node, by any way.

It knows no intervals of slopes and no ends that drift: a move from a node of one row to a node of the next is allowed
if every joint goes its wanted way at both of its ends. What it reaches is there, but for what happens between two rows;
slopes are those of the grid alone, so that it gets a little less far than legs can.

Units as in the kernels: m, rad, outward rates in rad/m, controller angles.
"""

from __future__ import annotations

import numpy as np

from zerorev.motion.drilling import Drilling, joint_rates


def rates_at(robot, tool, hole, branch, standoff, psi):
    """theta_s and theta_psi of one branch, each (..., 6)."""
    theta_s, theta_psi = joint_rates(Drilling(robot, tool, hole), np.full(np.shape(psi), standoff), psi)
    return theta_s[..., branch, :], theta_psi[..., branch, :]


def keeps(theta_s, theta_psi, slope, sigma, min_rate):
    """Whether a slope keeps every joint going its way: shape (...,); False where there is no pose."""
    with np.errstate(invalid="ignore"):
        return (sigma * (theta_s + slope * theta_psi) >= min_rate).all(axis=-1)


def among(nodes, rates, slope, sigma, min_rate):
    """Of some nodes of a row with all its rates those at which a slope keeps every joint going its way."""
    theta_s, theta_psi = rates
    return nodes[keeps(theta_s[nodes], theta_psi[nodes], slope, sigma, min_rate)]


def reach(robot, tool, hole, branch, psi_t, sigma, *, step, turn, steepest, min_rate, longest, widest=np.pi):
    """How far legs out of one spin at the target get [m], by rows of `step` [m] and nodes of `turn` [rad].

    Args:
        robot: the arm.
        tool: the drill.
        hole: its twist plane.
        branch: 0..7.
        psi_t: spin at the target.
        sigma: wanted signs of the outward rates, shape (6,).
        step: between two rows [m].
        turn: between two nodes [rad].
        steepest: twist rate [rad/m].
        min_rate: [rad/m].
        longest: where to stop [m].
        widest: how far spins are examined from psi_t [rad].
    """
    half = int(widest / turn)
    psi = psi_t + turn * np.arange(-half, half + 1)
    most = int(steepest * step / turn + 1e-9)
    here = rates_at(robot, tool, hole, branch, 0.0, psi)
    reached = np.arange(-half, half + 1) == 0
    for row in range(1, round(longest / step) + 1):
        there = rates_at(robot, tool, hole, branch, row * step, psi)
        arrived = np.zeros_like(reached)
        for move in range(-most, most + 1):
            slope = move * turn / step
            lands = among(np.flatnonzero(reached), here, slope, sigma, min_rate) + move
            lands = lands[(lands >= 0) & (lands < psi.size)]
            arrived[among(lands, there, slope, sigma, min_rate)] = True
        if not arrived.any():
            return (row - 1) * step
        reached, here = arrived, there
    return longest


def viable(robot, tool, hole, branch, sigma, psi, *, step, steepest, min_rate, depth):
    """From which nodes of the target line legs get to a depth, by moves from node to node, row by row inwards.

    Args:
        robot: the arm.
        tool: the drill.
        hole: its twist plane.
        branch: 0..7.
        sigma: wanted signs of the outward rates, shape (6,).
        psi: the nodes, evenly spaced [rad], shape (K,).
        step: between two rows [m].
        steepest: twist rate [rad/m].
        min_rate: [rad/m].
        depth: of the legs [m].

    Returns:
        bool, shape (K,).
    """
    turn = psi[1] - psi[0]
    most = int(steepest * step / turn + 1e-9)
    rows = round(depth / step)
    there = rates_at(robot, tool, hole, branch, rows * step, psi)
    good = np.any([keeps(*there, move * turn / step, sigma, min_rate) for move in range(-most, most + 1)], axis=0)
    for row in range(rows - 1, -1, -1):
        here = rates_at(robot, tool, hole, branch, row * step, psi)
        leads = np.zeros_like(good)
        for move in range(-most, most + 1):
            slope = move * turn / step
            source = among(np.flatnonzero(good), there, slope, sigma, min_rate) - move
            source = source[(source >= 0) & (source < psi.size)]
            leads[among(source, here, slope, sigma, min_rate)] = True
        good, there = leads, here
    return good
