"""How alike several runs of one motion are, compared by path distance and never by time (thesis §5.2)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from zerorev.cell.recordings.metrics import POINTS
from zerorev.cell.recordings.run import DrillingRun
from zerorev.errors import InputError
from zerorev.model._arrays import Array

__all__ = ["Repeatability", "repeatability"]

RUNS_FOR_RADIUS = 5


@dataclass(frozen=True)
class Repeatability:
    """Differences between runs at equal path distance.

    Attributes:
        runs: how many.
        torque_max: greatest difference between any two, per joint [Nm], shape (6,); None without torque in each.
        torque_rms: root of the mean square of the differences of all pairs [Nm], shape (6,), or None.
        tip_max: greatest distance between the tips of any two [m].
        radius: greatest of mean distance from the common centre and three standard deviations, along the path, as ISO
            9283 has it for path repeatability [m]; None of fewer than five runs.
        path: distances at which they are compared [m], shape (801,).
    """

    runs: int
    torque_max: Array | None
    torque_rms: Array | None
    tip_max: float
    radius: float | None
    path: Array


def repeatability(runs: Sequence[DrillingRun]) -> Repeatability:
    """How alike runs of one motion are.

    Raises:
        InputError: fewer than two, or no path distance in common.
    """
    if len(runs) < 2:
        raise InputError(f"{len(runs)} recordings", where="repeatability", accepted="two or more of one motion")
    begin, end = max(run.path[0] for run in runs), min(run.path[-1] for run in runs)
    if end <= begin:
        raise InputError("no path in common", where="repeatability", accepted="recordings of one motion")
    path = np.linspace(begin, end, POINTS)
    tips = np.stack([_over(path, run.path, run.tip) for run in runs])
    pairs = [(a, b) for a in range(len(runs)) for b in range(a)]
    tip_max = max(float(np.linalg.norm(tips[a] - tips[b], axis=1).max()) for a, b in pairs)
    logged = [run.recording.torque[run.rows] for run in runs if run.recording.torque is not None]
    torque_max = torque_rms = None
    if len(logged) == len(runs):
        torque = np.stack([_over(path, run.path, each) for run, each in zip(runs, logged, strict=True)])
        torque_max = (torque.max(axis=0) - torque.min(axis=0)).max(axis=0)
        # the mean square difference of all pairs is twice the variance of the sample
        torque_rms = np.sqrt((2 * torque.var(axis=0, ddof=1)).mean(axis=0))
    return Repeatability(len(runs), torque_max, torque_rms, tip_max, _radius(tips), path)


def _radius(tips: Array) -> float | None:
    if len(tips) < RUNS_FOR_RADIUS:
        return None
    away = np.linalg.norm(tips - tips.mean(axis=0), axis=2)
    return float((away.mean(axis=0) + 3 * away.std(axis=0, ddof=1)).max())


def _over(path: Array, own: Array, values: Array) -> Array:
    return np.stack([np.interp(path, own, values[:, n]) for n in range(values.shape[1])], axis=1)
