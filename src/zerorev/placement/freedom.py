"""How far a part may be moved, and a job whose part has been moved."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from zerorev.errors import InputError
from zerorev.model._arrays import Array, finite
from zerorev.model.hole import Hole, psi_zero_vector
from zerorev.model.job import Job
from zerorev.model.surroundings import NOTHING_AROUND

__all__ = ["AXES", "CLOSE", "Freedom", "frame_at", "job_at"]

AXES = ("x", "y", "z", "turn")
FINEST = np.array([1e-5, 1e-5, 1e-5, np.deg2rad(1e-3)])  # what a place is rounded to: 0.01 mm, 0.001 deg
CLOSE = 10 * FINEST  # no nearer is an end closed in on

Range = tuple[float, float]


@dataclass(frozen=True)
class Freedom:
    """How far a part may be moved from where its job has it; base frame.

    Attributes:
        x: least and greatest shift of the part frame's origin along X_base [m].
        y: along Y_base [m].
        z: along Z_base [m].
        turn: least and greatest turn of the part about the vertical through the part frame's origin [rad],
            counter-clockwise seen from above.
    """

    x: Range = (0.0, 0.0)
    y: Range = (0.0, 0.0)
    z: Range = (0.0, 0.0)
    turn: Range = (0.0, 0.0)

    def __post_init__(self) -> None:
        """Check the ranges."""
        for name in AXES:
            start, stop = finite(getattr(self, name), (2,), name)
            if start > stop:
                raise InputError(
                    f"runs from {start:g} down to {stop:g}", where=name, accepted="a start that is not above the stop"
                )
        if self.turn[1] - self.turn[0] > 2 * np.pi + 1e-9:
            raise InputError("is more than a full turn", where="turn", accepted="a full turn at most")

    @property
    def lower(self) -> Array:
        """Least shift [m] and turn [rad], shape (4,)."""
        return np.array([getattr(self, name)[0] for name in AXES], dtype=float)

    @property
    def upper(self) -> Array:
        """Greatest shift [m] and turn [rad], shape (4,)."""
        return np.array([getattr(self, name)[1] for name in AXES], dtype=float)

    @property
    def granted(self) -> list[int]:
        """The axes of `AXES` along which there is any freedom."""
        return np.flatnonzero(self.upper > self.lower).tolist()

    def ends_at(self, place: Array) -> list[tuple[int, int]]:
        """The granted axes at whose end a place lies, each with 0 (start) or 1 (stop); a full turn has no end."""
        full = self.turn[1] - self.turn[0] > 2 * np.pi - 1e-9
        return [
            (axis, side)
            for axis in self.granted
            for side, end in enumerate((self.lower[axis], self.upper[axis]))
            if abs(place[axis] - end) <= CLOSE[axis] and not (full and AXES[axis] == "turn")
        ]

    def widened(self, axis: int, side: int) -> Range:
        """The range of an axis, made as wide again at its start (0) or stop (1); a turn no more than a full one."""
        low, high = float(self.lower[axis]), float(self.upper[axis])
        more = min(high - low, 2 * np.pi - (high - low)) if AXES[axis] == "turn" else high - low
        return (low - more, high) if side == 0 else (low, high + more)

    def values(self, axis: int, count: int) -> Array:
        """Evenly spread over one axis [m or rad], ends included, rounded; a single one where there is no freedom."""
        low, high = self.lower[axis], self.upper[axis]
        even = np.linspace(low, high, count if axis in self.granted else 1)
        return np.asarray(np.clip(np.round(even / FINEST[axis]) * FINEST[axis], low, high))

    def rounded(self, place: Array) -> Array:
        """The nearest place, shape (4,), that a user would type: to 0.01 mm and 0.001 deg, and within the freedom."""
        return np.asarray(np.clip(np.round(place / FINEST) * FINEST, self.lower, self.upper))

    def grid(self, count: int) -> Array:
        """Places evenly spread over the freedom, `count` along each axis, shape (P, 4); the middle ones first."""
        axes = [self.values(axis, count) for axis in range(4)]
        places = np.array(list(product(*axes)))
        width = np.where(self.upper > self.lower, self.upper - self.lower, 1.0)
        away = np.round(np.abs((places - (self.lower + self.upper) / 2) / width).max(axis=1), 9)
        return places[np.argsort(away, kind="stable")]


def frame_at(T_base_part: Array, place: Array) -> Array:
    """The part frame, shape (4, 4), of a part that was moved.

    Args:
        T_base_part: before, shape (4, 4).
        place: shift [m] along X, Y, Z of the base frame, and turn [rad] about the vertical through its origin, shape
            (4,).
    """
    c, s = np.cos(place[3]), np.sin(place[3])
    T = T_base_part.copy()
    T[:3, :3] = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]) @ T_base_part[:3, :3]
    T[:3, 3] += place[:3]
    return T


def job_at(job: Job, place: Array) -> Job:
    """The job with its part moved.

    Args:
        job: whose holes are free of given motions.
        place: as `frame_at` has it.

    Raises:
        InputError: after the turn the reference of the spin is parallel to a drill axis.
    """
    T = frame_at(job.T_base_part, place)
    move = T @ np.linalg.inv(job.T_base_part)

    def moved(hole: Hole) -> Hole:
        target, direction = move[:3, :3] @ hole.target + move[:3, 3], move[:3, :3] @ hole.direction
        if job.psi_reference is None:
            zero = move[:3, :3] @ hole.psi_zero
        else:
            reference = job.psi_reference
            vector = reference if isinstance(reference, str) else np.array(reference)
            zero = psi_zero_vector(vector, target, direction, job.tool, T, f"hole {hole.id}")
        return replace(hole, target=target, direction=direction / np.linalg.norm(direction), psi_zero=zero)

    # what stands around is not asked of a place
    settings = replace(job.settings, surroundings=NOTHING_AROUND)
    return replace(job, holes=tuple(map(moved, job.holes)), T_base_part=T, settings=settings)
