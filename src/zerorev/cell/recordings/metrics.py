"""What the thesis measures of a run (§5.3): deviation from the mean path about the turn, and the mean's offset.

One code for recordings and for the virtual cell, so that their figures can stand side by side.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from zerorev.cell.recordings.run import DrillingRun
from zerorev.errors import InputError
from zerorev.model._arrays import Array
from zerorev.model.finding import Finding

__all__ = ["POINTS", "Metrics", "metrics", "reversals"]

POINTS = 801  # of the mean path, evenly by path distance
FEW_IN_WINDOW = 40  # samples: below that, what happens at the turn may lie between two of them
COMMANDED_SWING, MEASURED_SWING = math.radians(0.002), math.radians(0.02)


@dataclass(frozen=True)
class Metrics:
    """Accuracy and precision of one run.

    Attributes:
        path_length: run along the axis, there and back [m].
        window: half its width [m]: the figures are of path distances up to it, on each side of the turn.
        deviation_max: greatest distance across the axis from the mean path, in the window [m].
        deviation_rms: root of the mean square of that distance [m].
        deviation_parts: greatest horizontal and vertical part [m], shape (2,).
        mean: of the whole motion, across the axis, horizontal and vertical [m], shape (2,).
        offset: distance of the mean from the commanded line [m]; None where that is not known.
        reversals_per_joint: direction changes of each joint; None where no joints are recorded.
        path: even path distances [m], shape (801,).
        lateral: across the axis at those [m], shape (801, 2).
        findings: of the rate.
    """

    path_length: float
    window: float
    deviation_max: float
    deviation_rms: float
    deviation_parts: Array
    mean: Array
    offset: float | None
    reversals_per_joint: tuple[int, ...] | None
    path: Array
    lateral: Array
    findings: tuple[Finding, ...] = ()

    @property
    def deviation(self) -> Array:
        """Distance from the mean path at the even path distances [m], shape (801,)."""
        return np.asarray(np.linalg.norm(self.lateral - self.mean, axis=1))


def metrics(run: DrillingRun, window: float | None = None) -> Metrics:
    """What the thesis measures of a run.

    Args:
        run: one drilling motion.
        window: half the width of the window about the turn [m]; None: half a stroke.

    Raises:
        InputError: a window that is not above 0, or without a point of the path.
    """
    window = run.axis.stroke / 2 if window is None else window
    path = np.linspace(run.path[0], run.path[-1], POINTS)
    inside = np.abs(path) <= window
    if not (math.isfinite(window) and window > 0 and inside.any()):
        raise InputError(f"a window of {window * 1e3:g} mm", where="window_mm", accepted="a length above 0 on the path")
    lateral = np.stack([np.interp(path, run.path, run.lateral[:, n]) for n in range(2)], axis=1)
    mean = lateral.mean(axis=0)
    apart = (lateral - mean)[inside]
    distance = np.linalg.norm(apart, axis=1)
    return Metrics(
        path_length=float(run.path[-1] - run.path[0]),
        window=window,
        deviation_max=float(distance.max()),
        deviation_rms=float(np.sqrt(np.mean(distance**2))),
        deviation_parts=np.abs(apart).max(axis=0),
        mean=mean,
        offset=float(np.linalg.norm(mean)) if run.axis.commanded else None,
        reversals_per_joint=_reversals(run),
        path=path,
        lateral=lateral,
        findings=_sampling(run, window),
    )


def _sampling(run: DrillingRun, window: float) -> tuple[Finding, ...]:
    count = int((np.abs(run.path) <= window).sum())
    if count >= FEW_IN_WINDOW:
        return ()
    step = run.feed * run.recording.interval
    return (
        Finding(
            "warning",
            "sampling",
            f"{count} samples in the window, one per {step * 1e3:.3g} mm at {run.feed * 1e3:.3g} mm/s: what happens at "
            "the turn may lie between two of them",
        ),
    )


def _reversals(run: DrillingRun) -> tuple[int, ...] | None:
    recording = run.recording
    joints, swing = recording.joints_commanded, COMMANDED_SWING
    if joints is None:
        joints, swing = recording.joints, MEASURED_SWING
    return None if joints is None else tuple(reversals(joints[run.rows, n], swing) for n in range(6))


def reversals(angle: Array, swing: float) -> int:
    """How often an angle changes its direction, where it turns back by `swing` [rad] or more.

    Args:
        angle: sample by sample [rad], shape (n,).
        swing: what goes less far back is noise [rad].
    """
    moves = np.flatnonzero(np.diff(angle))
    if not moves.size:
        return 0
    values = angle[np.append(moves, moves[-1] + 1)]
    # only where it turns, and the ends, can be the far point of a swing
    turns = np.flatnonzero(np.diff(np.sign(np.diff(values)))) + 1
    direction, count, low, high = 0, 0, values[0], values[0]
    for value in (*values[turns], values[-1]):
        low, high = min(low, value), max(high, value)
        rises = direction <= 0 and value - low >= swing
        if rises or (direction >= 0 and high - value >= swing):
            count += direction != 0
            direction = 1 if rises else -1
            low = high = value
    return count
