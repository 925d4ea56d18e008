"""How deep free legs could get at most: outer sets of spins, refined where it matters (theory §4).

The twist plane is cut into cells, and a cell into four where legs that are deep enough may pass it. On each grid the
sets from which legs get to a depth are carried in to the target, for the signs of one leg and for their opposites;
where the two have no spin at the target in common, no motion is so deep.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from itertools import product
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from zerorev.kernels import outer_cells, outer_sets
from zerorev.kernels.legs import NIL
from zerorev.model._arrays import Array
from zerorev.search.bounds.cells import CellFormulas, cell_formulas
from zerorev.search.bounds.tree import model_limits
from zerorev.search.problem import Problem

__all__ = ["FreeBound", "bound_free_depth"]

Numbers = npt.NDArray[np.int64]

CELLS_PER_BOX = 2  # what a cell costs: half of a box of legs
COLUMNS, SLABS = 128, 16  # of the first grid: once round, and within the depth
TARGET_COLUMNS = 2048
EVEN, STRETCH = 2.0, 1.25  # depths up to which slabs are even; by how much each is higher beyond
FINER = 0.005  # share of the depth by which a deeper one is to be refuted
SHALLOWEST = 1e-4  # of the arm's reach: a stroke that is none
SHARE = 0.4  # of the cells left that the next grid may have
MOST_LEVELS = 14
EVEN_LEVELS = 3  # grids that are refined whatever the bound does
WORTH_REFINING = 1e-3  # relative: what the last grid must have gained
MOST_GAIN = 4.0  # times what the last grid has gained: what finer ones will gain, at most
SAME_RATE = 2e-6  # relative: a threshold missed by so little is kept
CLEAR = 1e-9  # [m^2]: a d theta / d psi, times its denominator, whose sign is certain


class Rules(NamedTuple):
    """What legs are held to; a NamedTuple, so that kernels take it whole. SI units, model angles.

    Attributes:
        min_rate: of every joint, its way [rad/m].
        steepest: twist rate [rad/m].
        lower: limits of the joints, shape (6,).
        upper: likewise.
    """

    min_rate: float
    steepest: float
    lower: Array
    upper: Array


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


@dataclass
class Leg:
    """Cells that one leg of a family may pass.

    Attributes:
        sense: signs of its outward rates, shape (6,).
        table: start, column, lo, hi, flips: see `kernels.outer_sets`.
    """

    sense: Array
    table: tuple[Numbers, Numbers, Array, Array, Numbers]
    viable: Array = field(default_factory=lambda: np.empty((outer_sets.FACES, 0)))
    faces: Array = field(default_factory=lambda: np.empty((outer_sets.FACES, 0)))
    passed: npt.NDArray[np.bool_] = field(default_factory=lambda: np.empty(0, dtype=np.bool_))

    def __post_init__(self) -> None:
        """Make room."""
        size = self.table[1].size
        self.viable, self.faces = (np.full((outer_sets.FACES, size), np.nan) for _ in range(2))
        self.passed = np.zeros(size, dtype=np.bool_)


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


@dataclass(frozen=True)
class FreeBound:
    """How deep a stroke of free legs without a reversal could be.

    Attributes:
        at_most: none is as deep [m].
        boxes: the work, in boxes of legs.
    """

    at_most: float
    boxes: int


def bound_free_depth(problem: Problem, depth: float, boxes: int) -> FreeBound:
    """Bound the strokes of free legs that have no reversal and keep the threshold at every point.

    Args:
        problem: one hole; its depth is left aside.
        depth: the deepest stroke known [m]; 0: none.
        boxes: budget; two cells count as a box of legs.
    """
    return _Bounder(problem, max(depth * (1 + FINER), SHALLOWEST * problem.robot.reach), boxes).run()


class _Bounder:
    """One hole."""

    def __init__(self, problem: Problem, wanted: float, boxes: int) -> None:
        self.problem, self.wanted, self.left = problem, wanted, boxes * CELLS_PER_BOX
        self.spent = 0
        settings, robot = problem.settings, problem.robot
        lower, upper = model_limits(robot)
        self.rules = Rules(settings.min_rate * (1 - SAME_RATE) - NIL, settings.max_twist * (1 + 1e-9), lower, upper)
        limited = tuple(bool(width < 2 * np.pi) for width in upper - lower)
        self.formulas: dict[int, CellFormulas] = {}
        self.flips = 0
        for branch in problem.branches:
            if branch // 2 not in self.formulas:
                self.formulas[branch // 2] = cell_formulas(robot.arm, problem.plane, branch // 2, limited)
            # the tapes have sin(q5) >= 0; where joint 5 is counted the other way, A5 < 0 is that one
            self.flips |= 1 << (branch % 2 if robot.arm.sign[4] > 0 else 1 - branch % 2)
        bound = settings.psi_bound
        half = np.pi if bound is None else bound * (1 + 1e-12)
        self.half, self.periodic = half, bound is None
        self.grid = self._grid(COLUMNS, self._edges())

    def _grid(self, per_turn: int, edges: Array) -> Grid:
        columns = per_turn if self.periodic else max(2, int(np.ceil(per_turn * self.half / np.pi)))
        return Grid(-self.half, 2 * self.half / columns, columns, self.periodic, edges)

    def _edges(self) -> Array:
        """Of the first slabs: even at first, then ever higher, to where no arm reaches."""
        high = self.wanted / SLABS
        edges = (high * np.arange(round(EVEN * SLABS) + 1)).tolist()
        while edges[-1] < 2 * self.problem.robot.reach:
            high *= STRETCH
            edges.append(edges[-1] + high)
        return np.array(edges)

    def run(self) -> FreeBound:
        families = self._families()
        before = np.inf
        at_least = SLABS  # slabs of the depths that are still in question
        for level in range(MOST_LEVELS):
            kept = []
            for family in families:
                family.deepest = self._deepest(family, at_least)
                if family.deepest > at_least:
                    kept.append(family)
            families = kept
            if not families or level == MOST_LEVELS - 1:
                break
            edges = self.grid.edges
            bound = float(edges[max(family.deepest for family in families)])
            gained, before = before - bound, bound
            if level >= EVEN_LEVELS:
                if gained < WORTH_REFINING * bound:
                    break
                # cells of depths to which the bound will hardly fall are not worth their cost
                at_least = max(at_least, int(np.searchsorted(edges, bound - MOST_GAIN * gained, "right")) - 1)
            room = (self.left - self.spent) * SHARE
            at_least, cells = self._affordable(families, at_least, room)
            families = [family for family in families if family.deepest > at_least]
            if not families or 4 * cells > room:
                break
            tubes = [self._tube(family, at_least) for family in families]
            self.grid = self.grid.finer()
            for family, tube in zip(families, tubes, strict=True):
                family.legs = (self._finer(family, 0, tube[0]), self._finer(family, 1, tube[1]))
                family.deepest *= 2
            at_least *= 2
        deepest = max([family.deepest for family in families], default=at_least)
        return FreeBound(float(self.grid.edges[deepest]), -(-self.spent // CELLS_PER_BOX))

    def _families(self) -> list[Family]:
        """The legs that may leave the target, with all cells of the first grid."""
        found = []
        grid = self.grid
        slabs = grid.edges.size - 1
        for posture, formulas in self.formulas.items():
            column, slab = np.tile(np.arange(grid.columns), slabs), np.repeat(np.arange(slabs), grid.columns)
            flips, raw = self._tabulated(posture, formulas, grid, slab, column, np.full(column.size, self.flips))
            for sense in self._senses(posture, formulas):
                legs = tuple(
                    self._leg(way * sense, np.arange(slabs + 1) * grid.columns, column, slab, flips.copy(), raw)
                    for way in (1.0, -1.0)
                )
                found.append(Family(posture, (legs[0], legs[1]), slabs))
        return found

    def _senses(self, posture: int, formulas: CellFormulas) -> Iterable[Array]:
        """Signs that the outward rates may have on the leg of the greater slope: those of d theta / d psi."""
        line = self._grid(TARGET_COLUMNS, np.zeros(2))
        column = np.arange(line.columns)
        flips, raw = self._tabulated(
            posture, formulas, line, np.zeros_like(column), column, np.full(column.size, self.flips)
        )
        alive = flips != 0
        least, most = raw[alive, :, outer_cells.LEAST], raw[alive, :, outer_cells.MOST]
        may = np.stack([most >= -CLEAR, least <= CLEAR], axis=-1)
        senses = set()
        for joints in np.unique(may, axis=0):
            senses |= set(product(*(np.array([1.0, -1.0])[joint].tolist() for joint in joints)))
        return [np.array(sense) for sense in sorted(senses)]

    def _tabulated(
        self, posture: int, formulas: CellFormulas, grid: Grid, slab: Numbers, column: Numbers, flips: Numbers
    ) -> tuple[Numbers, Array]:
        raw = np.empty((column.size, 6, outer_cells.RAW))
        outer_cells.tabulate(
            self.problem.robot.arm, self.problem.plane, posture, formulas, self.rules, grid, slab, column, flips, raw
        )
        self.spent += column.size
        return flips, raw

    def _leg(self, sense: Array, start: Numbers, column: Numbers, slab: Numbers, flips: Numbers, raw: Array) -> Leg:
        lo, hi, start, column = np.empty(column.size), np.empty(column.size), start.copy(), column.copy()
        outer_cells.slopes(self.rules, raw, sense, flips, lo, hi)
        left = outer_sets.compacted(start, column, lo, hi, flips, slab)
        return Leg(sense, (start, column[:left].copy(), lo[:left].copy(), hi[:left].copy(), flips[:left].copy()))

    def _finer(self, family: Family, which: int, left: Numbers) -> Leg:
        """One leg on the finer grid, where it may pass."""
        leg = family.legs[which]
        coarse = leg.table[0][: family.deepest + 1]
        size = 4 * int(np.count_nonzero(left[: coarse[-1]]))
        start, column, flips = (
            np.empty(2 * coarse.size - 1, np.int64),
            np.empty(size, np.int64),
            np.empty(size, np.int64),
        )
        outer_sets.children(coarse, leg.table[1], left, start, column, flips)
        slab = np.repeat(np.arange(start.size - 1), np.diff(start))
        posture = family.posture
        flips, raw = self._tabulated(posture, self.formulas[posture], self.grid, slab, column, flips)
        return self._leg(leg.sense, start, column, slab, flips, raw)

    def _deepest(self, family: Family, at_least: int) -> int:
        """The least number of slabs, from `at_least` on, that no motion gets through."""
        low, high = at_least - 1, family.deepest
        first = True
        while high - low > 1:
            trial = at_least if first else (low + high) // 2
            first = False
            if any(self._start(family, flip, trial) for flip in range(2)):
                low = trial
            else:
                high = trial
        return high

    def _start(self, family: Family, flip: int, slabs: int) -> bool:
        """Whether two legs may get to a depth; at the target the sets that they share are left in `faces`."""
        if not (self.flips >> flip) & 1:
            return False
        for leg in family.legs:
            if not outer_sets.inwards(leg.table, self.grid, flip, slabs, leg.viable, leg.passed):
                return False
        some = True
        for leg, other in (family.legs, family.legs[::-1]):
            (start, column, *_), (begin, columns, *_) = other.table, leg.table
            out, into = other.viable, leg.faces
            some = some and outer_sets.hand_over(
                column, start[0], start[1], out[outer_sets.OUT_A], out[outer_sets.OUT_B], columns, begin[0], begin[1],
                self.grid, into[outer_sets.IN_A], into[outer_sets.IN_B],
            )  # fmt: skip
            first = slice(begin[0], begin[1])
            into[outer_sets.IN_A, first] = np.maximum(into[outer_sets.IN_A, first], leg.viable[outer_sets.OUT_A, first])
            into[outer_sets.IN_B, first] = np.minimum(into[outer_sets.IN_B, first], leg.viable[outer_sets.OUT_B, first])
            some = some and bool((into[outer_sets.IN_A, first] <= into[outer_sets.IN_B, first]).any())
        return some

    def _tube(self, family: Family, slabs: int) -> tuple[Numbers, Numbers]:
        """Wrist flips on which legs of a depth may pass the cells of either leg; 0 where none does."""
        flips = tuple(np.zeros_like(leg.table[4]) for leg in family.legs)
        for flip in range(2):
            if self._start(family, flip, slabs):
                for leg, bits in zip(family.legs, flips, strict=True):
                    outer_sets.outwards(
                        leg.table, self.grid, flip, slabs, family.deepest, leg.viable, leg.faces, leg.passed
                    )
                    bits |= leg.passed.astype(np.int64) << flip
        return flips[0], flips[1]

    def _affordable(self, families: list[Family], at_least: int, room: float) -> tuple[int, int]:
        """The least depth, in slabs, whose cells may be refined at no more than a cost, and how many cells it has."""
        low, high, trial = at_least - 1, max(family.deepest for family in families), at_least
        cells = {high: 0}
        while high - low > 1:
            cells[trial] = sum(
                int(np.count_nonzero(bits))
                for family in families
                if family.deepest > trial
                for bits in self._tube(family, trial)
            )
            if 4 * cells[trial] <= room:
                high = trial
            else:
                low = trial
            trial = (low + high) // 2
        return high, cells[high]
