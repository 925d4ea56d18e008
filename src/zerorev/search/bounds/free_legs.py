"""What the bound on free legs is made of: a grid of cells, the cells that a leg may pass, families (theory §4)."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from zerorev.kernels import outer_sets
from zerorev.model._arrays import Array

__all__ = ["Cells", "Family", "Grid", "Leg", "Numbers"]

Numbers = npt.NDArray[np.int64]


class Grid(NamedTuple):
    """Cells of the twist plane; a NamedTuple, so that kernels take it whole.

    Attributes:
        left: least spin [rad].
        width: of a column [rad].
        columns: how many.
        periodic: whether the last is followed by the first.
        edges: of the slabs, from the target on [m], shape (K + 1,).
    """

    left: float
    width: float
    columns: int
    periodic: bool
    edges: Array

    def finer(self) -> Grid:
        """With every cell cut into four."""
        edges = np.empty(2 * self.edges.size - 1)
        edges[::2], edges[1::2] = self.edges, 0.5 * (self.edges[1:] + self.edges[:-1])
        return self._replace(width=0.5 * self.width, columns=2 * self.columns, edges=edges)


class Cells(NamedTuple):
    """What is known of some cells.

    Attributes:
        column: shape (N,).
        flips: wrist flips on which a leg may pass, as bits, shape (N,).
        raw: see `kernels.outer_cells.tabulate`.
        zone: number among the cells next to the elbow's singularity, -1 elsewhere, shape (N,).
        swing: angles there, shape (Z, 6, 2) [rad].
    """

    column: Numbers
    flips: Numbers
    raw: Array
    zone: Numbers
    swing: Array


@dataclass
class Leg:
    """Cells that one leg of a family may pass.

    Attributes:
        sense: signs of its outward rates, shape (6,).
        table: start, column, lo, hi, flips, zone, swing, behind: see `kernels.outer_sets`.
    """

    sense: Array
    table: tuple[Numbers, Numbers, Array, Array, Numbers, Numbers, Array, Array]
    viable: Array = field(default_factory=lambda: np.empty((outer_sets.FACES, 0)))
    faces: Array = field(default_factory=lambda: np.empty((outer_sets.FACES, 0)))
    passed: npt.NDArray[np.bool_] = field(default_factory=lambda: np.empty(0, dtype=np.bool_))

    def __post_init__(self) -> None:
        """Make room."""
        size = self.table[1].size
        self.viable, self.faces = (np.full((outer_sets.FACES, size), np.nan) for _ in range(2))
        self.passed = np.zeros(size, dtype=np.bool_)

    def quarters(self, bits: Numbers, slabs: int) -> tuple[Numbers, Numbers, Numbers]:
        """Start, column and flips of the quarters of the cells that are left, of the first slabs."""
        coarse = self.table[0][: slabs + 1]
        size = 4 * int(np.count_nonzero(bits[: coarse[-1]]))
        start, column, flips = (np.empty(count, dtype=np.int64) for count in (2 * coarse.size - 1, size, size))
        outer_sets.children(coarse, self.table[1], bits, start, column, flips)
        return start, column, flips


@dataclass
class Family:
    """Two legs of opposite signs on one posture.

    Attributes:
        posture: 0..3.
        legs: the two.
        deepest: no motion gets through so many slabs.
    """

    posture: int
    legs: tuple[Leg, Leg]
    deepest: int = 0
