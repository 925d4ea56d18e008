"""What a parameter map says: its best cell, how much of it has zero reversals, and how far it is from its mirror."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from zerorev.model._arrays import Array
from zerorev.thesis.parameter_map import AXES

if TYPE_CHECKING:
    from xarray import Dataset

__all__ = ["Best", "Mirrored", "ZeroReversals", "best_cell", "mirrored", "zero_reversals"]

SAME = 1e-9  # scores that differ by less are one


@dataclass(frozen=True)
class Mirrored:
    """How far a map is from the symmetry of eq. 4.12, f(psi_s, psi_t, psi_e) = f(psi_e, psi_t, psi_s).

    Attributes:
        differing: share of the cells whose score is another one in the mirror, by more than 1e-9.
        greatest: the greatest difference of the scores [1].
        lost: share of the cells that cannot be run, although their mirror can.
    """

    differing: float
    greatest: float
    lost: float


def mirrored(parts: Iterable[Dataset]) -> Mirrored:
    """Measure the symmetry (4.12) over a map.

    Args:
        parts: the map at some psi_target each, so that it need not all be in memory; `[found]` for a whole one.
    """
    cells, differing, lost, greatest = 0, 0, 0, 0.0
    for part in parts:
        for score, reversals in _slices(part):
            apart = np.abs(score - score.T)
            cells += apart.size
            differing += int((apart > SAME).sum())
            greatest = max(greatest, float(apart.max()))
            lost += int(((reversals < 0) & (reversals.T >= 0)).sum())
    return Mirrored(differing / cells, greatest, lost / cells)


@dataclass(frozen=True)
class ZeroReversals:
    """How much of a map has zero reversals.

    Attributes:
        cells: how many.
        share: of all cells.
        volume: share of the cube of spins, by the trapezoidal rule: cells at the wall of the range stand for half a
            step, so that a set that lies along the wall is not counted twice over.
    """

    cells: int
    share: float
    volume: float


def zero_reversals(found: Dataset) -> ZeroReversals:
    """Count the cells of a map without reversals."""
    weights = [_trapezoids(found.sizes[name]) for name in AXES]
    cells, volume = 0, 0.0
    for w, (_, reversals) in zip(weights[0], _slices(found), strict=True):
        zero = reversals == 0
        cells += int(zero.sum())
        volume += float(w * (weights[1] @ zero @ weights[2]))
    return ZeroReversals(cells, cells / found["score"].size, volume)


@dataclass(frozen=True)
class Best:
    """A cell of least score; the first of several.

    Attributes:
        psi_deg: spins at start, target and end [deg].
        score: eq. 4.7.
        reversals: of all joints; -1: no branch can run it.
        branch: 0..7, or -1.
        travel_deg: of all joints, or NaN.
    """

    psi_deg: tuple[float, float, float]
    score: float
    reversals: int
    branch: int
    travel_deg: float


def best_cell(found: Dataset) -> Best:
    """The cell of least score."""
    t, s, e = np.unravel_index(int(found["score"].values.argmin()), found["score"].shape)
    cell = found.isel(psi_target_deg=t, psi_start_deg=s, psi_end_deg=e)
    return Best(
        (float(cell["psi_start_deg"]), float(cell["psi_target_deg"]), float(cell["psi_end_deg"])),
        float(cell["score"]), int(cell["reversals"]), int(cell["branch"]), float(cell["travel_deg"]),
    )  # fmt: skip


def _slices(found: Dataset) -> Iterator[tuple[Array, npt.NDArray[np.int8]]]:
    """Score and reversals over psi_start and psi_end, target spin by target spin."""
    return zip(found["score"].values, found["reversals"].values, strict=True)


def _trapezoids(count: int) -> Array:
    """Weights of evenly spaced points, their sum 1."""
    weights = np.ones(count)
    if count > 1:
        weights[[0, -1]] = 0.5
    return np.asarray(weights / weights.sum())
