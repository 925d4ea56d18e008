"""What is measured of one simulated run: how far its tip strays, how its drives work, and the hole that it leaves."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from zerorev.cell.hole_estimate import hole_estimate
from zerorev.cell.plant import Run
from zerorev.model._arrays import Array

__all__ = ["KEPT", "POINTS", "RunFigures", "deviations", "run_figures"]

POINTS = 801  # of the mean path, evenly by path distance
KEPT = np.linspace(-1.0, 1.0, 201)  # places along the stroke of what is kept, as shares of it; 0 is the turn


class RunFigures(NamedTuple):
    """Figures of one run, the first three of both sides: encoder and tool.

    Attributes:
        deviation: greatest distance from the mean path in the window, half a stroke about the turn [m], shape (2,).
        vertical: greatest part of it along Z of the base [m], shape (2,).
        offset: distance of the mean path from the commanded one [m], shape (2,).
        swing: greatest less least torque of the drives in the window [N m], shape (6,).
        position: how far the hole is off [m], shape ().
        tilt: of the hole [rad], shape ().
        ovality: of the hole at its entry and exit [m], shape (2,).
        profile: distance from the mean path along the stroke [m], shape (2, 201).
        torque: of the drives along the stroke [N m], shape (6, 201).
    """

    deviation: Array
    vertical: Array
    offset: Array
    swing: Array
    position: Array
    tilt: Array
    ovality: Array
    profile: Array
    torque: Array


def run_figures(done: Run, axis: Array) -> RunFigures:
    """The figures of a run.

    Args:
        done: a run.
        axis: calibrated axis of the hole less the nominal one [m], base frame, shape (3,).
    """
    own, depth = done.reference.path, done.reference.drilling.hole.depth
    window = 0.5 * float(depth - done.reference.standoff.min())
    path, sides = deviations(done)
    inside = np.abs(path) <= window
    greatest, vertical, offset, kept = [], [], [], []
    for lateral in sides:
        mean = lateral.mean(axis=0)
        apart = lateral - mean
        distance = np.linalg.norm(apart, axis=1)
        greatest.append(distance[inside].max())
        vertical.append(np.abs(apart[inside, 2]).max())
        offset.append(np.linalg.norm(mean))
        kept.append(np.interp(KEPT * depth, path, distance))
    swing = np.ptp(done.drive[np.abs(own) <= window], axis=0)
    torque = np.array([np.interp(KEPT * depth, own, done.drive[:, joint]) for joint in range(6)])
    hole = hole_estimate(done, axis)
    return RunFigures(
        np.array(greatest), np.array(vertical), np.array(offset), swing,
        np.array(hole.position), np.array(hole.tilt), hole.ovality, np.array(kept), torque,
    )  # fmt: skip


def deviations(done: Run) -> tuple[Array, tuple[Array, Array]]:
    """Deviation across the axis along a run, resampled evenly by path distance.

    Args:
        done: a run.

    Returns:
        path distance [m], 0 at the turn, shape (801,); the deviation by the encoders and of the tool [m], base frame,
        each (801, 3).
    """
    own = done.reference.path
    grid = np.linspace(own[0], own[-1], POINTS)
    d = done.reference.drilling.hole.direction
    found = []
    for deviation in (done.encoder, done.tool):
        lateral = deviation - np.outer(deviation @ d, d)
        found.append(np.stack([np.interp(grid, own, lateral[:, k]) for k in range(3)], axis=1))
    return grid, (found[0], found[1])
