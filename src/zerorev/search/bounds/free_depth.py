"""How deep free legs could get at most: outer sets of spins, refined where it matters (theory §4).

The twist plane is cut into cells, and a cell into four where legs that are deep enough may pass it. On each grid the
sets from which legs get to a depth are carried in to the target, for the signs of one leg and for their opposites;
where the two have no spin at the target in common, no motion is so deep.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import product

import numpy as np

from zerorev.kernels import outer_cells, outer_sets
from zerorev.kernels.layout import Constraints
from zerorev.kernels.legs import NIL
from zerorev.model._arrays import Array
from zerorev.search.bounds.cells import CellFormulas, cell_formulas
from zerorev.search.bounds.free_legs import Cells, Family, Grid, Leg, Numbers
from zerorev.search.bounds.tree import model_limits
from zerorev.search.problem import Problem

__all__ = ["FreeBound", "bound_free_depth"]

CELLS_PER_BOX = 2  # what a cell costs: half of a box of legs
COLUMNS, SLABS = 128, 16  # of the first grid: once round, and within the depth
TARGET_COLUMNS = 2048
EVEN, STRETCH = 2.0, 1.25  # depths up to which slabs are even; by how much each is higher beyond
FINER = 0.005  # share of the depth by which a deeper one is to be refuted
SHALLOWEST = 1e-4  # of the arm's reach: a stroke that is none
SHARE = 0.6  # of the cells left that the next grid may have
MOST_LEVELS = 14
EVEN_LEVELS = 3  # grids that are refined in any case
WORTH_REFINING = 3e-4  # relative: what the last grid must have gained
MOST_GAIN = 4.0  # times what the last grid has gained: what finer ones will gain, at most
SAME_RATE = 2e-6  # relative: a threshold missed by so little is kept
NEAR_ELBOW = 0.4  # sine of the elbow's angle from straight or folded, up to which joints are kept from turning back
BOTH = 3  # wrist flips, as bits
CLOSE = 1e-3  # share of the depth to which a depth is found
CLEAR = 1e-9  # [m^2]: a d theta / d psi, times its denominator, whose sign is certain


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
        boxes: budget; two cells count as a box of legs. The first grid, some 20,000 boxes, is examined in any case.
    """
    return _Bounder(problem, max(depth * (1 + FINER), SHALLOWEST * problem.drilling.robot.reach), boxes).run()


class _Bounder:
    """One hole."""

    def __init__(self, problem: Problem, wanted: float, boxes: int) -> None:
        self.problem, self.wanted, self.left = problem, wanted, boxes * CELLS_PER_BOX
        self.spent = 0
        settings, robot = problem.settings, problem.drilling.robot
        lower, upper = model_limits(problem.drilling)
        least = settings.min_rate * (1 - SAME_RATE) - NIL
        self.rules = Constraints(lower, upper, least, steepest=settings.max_twist * (1 + 1e-9))
        limited = tuple(bool(width < 2 * np.pi) for width in upper - lower)
        # of cells anywhere, and of those next to the elbow's singularity, where all angles are wanted
        self.formulas: dict[int, tuple[CellFormulas, CellFormulas]] = {}
        self.flips = 0
        self.near = NEAR_ELBOW * robot.arm.c2 * float(np.hypot(robot.arm.a2, robot.arm.c3))
        for branch in problem.branches:
            if branch // 2 not in self.formulas:
                self.formulas[branch // 2] = (
                    cell_formulas(robot.arm, problem.plane, branch // 2, limited),
                    cell_formulas(robot.arm, problem.plane, branch // 2, (True,) * 6),
                )
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
        while edges[-1] < 2 * self.problem.drilling.robot.reach:
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
            self._refine(families, at_least)
            at_least *= 2
        deepest = max([family.deepest for family in families], default=at_least)
        return FreeBound(float(self.grid.edges[deepest]), -(-self.spent // CELLS_PER_BOX))

    def _families(self) -> list[Family]:
        """The legs that may leave the target, with all cells of the first grid."""
        found = []
        grid = self.grid
        slabs = grid.edges.size - 1
        column, slab = np.tile(np.arange(grid.columns), slabs), np.repeat(np.arange(slabs), grid.columns)
        start, which = np.arange(slabs + 1) * grid.columns, np.arange(column.size)
        for posture in self.formulas:
            cells = self._tabulated(posture, grid, slab, column, np.full(column.size, self.flips))
            for sense in self._senses(posture):
                legs = [self._leg(way * sense, start, cells, which, cells.flips) for way in (1.0, -1.0)]
                found.append(Family(posture, (legs[0], legs[1]), slabs))
        return found

    def _senses(self, posture: int) -> Iterable[Array]:
        """Signs that the outward rates may have on the leg of the greater slope: those of d theta / d psi."""
        line = self._grid(TARGET_COLUMNS, np.zeros(2))
        column = np.arange(line.columns)
        cells = self._tabulated(posture, line, np.zeros_like(column), column, np.full(column.size, self.flips))
        raw = cells.raw[cells.flips != 0]
        may = np.stack([raw[..., outer_cells.MOST] >= -CLEAR, raw[..., outer_cells.LEAST] <= CLEAR], axis=-1)
        senses = set()
        for joints in np.unique(may, axis=0):
            senses |= set(product(*(np.array([1.0, -1.0])[joint].tolist() for joint in joints)))
        return [np.array(sense) for sense in sorted(senses)]

    def _tabulated(self, posture: int, grid: Grid, slab: Numbers, column: Numbers, flips: Numbers) -> Cells:
        """What is known of some cells; `flips` is filled in."""
        arm, plane, count = self.problem.drilling.robot.arm, self.problem.plane, column.size
        anywhere, near_elbow = self.formulas[posture]
        raw, bent, none = np.empty((count, 6, outer_cells.RAW)), np.empty(count), np.empty((0, 6, 2))
        outer_cells.tabulate(
            arm, plane, posture, anywhere, self.rules, grid, slab, column, flips, raw, bent, none
        )  # fmt: skip
        near = np.flatnonzero((flips != 0) & (bent < self.near))
        if self.spent + count + near.size > self.left:
            near = near[:0]  # without the angles the bound is as true, only less close
        zone, swing = np.full(count, -1), np.empty((near.size, 6, 2))
        zone[near] = np.arange(near.size)
        if near.size:
            outer_cells.tabulate(
                arm, plane, posture, near_elbow, self.rules, grid, slab[near], column[near], flips[near],
                np.empty((near.size, 6, outer_cells.RAW)), np.empty(near.size), swing,
            )  # fmt: skip
        self.spent += count + near.size
        return Cells(column, flips, raw, zone, swing)

    def _leg(self, sense: Array, start: Numbers, cells: Cells, which: Numbers, flips: Numbers) -> Leg:
        """The cells that a leg may pass whose joints go given ways, of those named."""
        flips, lo, hi = flips & cells.flips[which], np.empty(which.size), np.empty(which.size)
        outer_cells.slopes(self.rules, cells.raw, which, sense, flips, lo, hi)
        left = flips != 0
        start, which = np.append(0, np.cumsum(left))[start], which[left]
        zone = cells.zone[which]
        near = np.flatnonzero(zone >= 0)
        swing = cells.swing[zone[near]]
        swing = np.where(sense[:, None] > 0, swing, -swing[..., ::-1])
        zone[near] = np.arange(near.size)
        behind = np.empty((near.size + 1, 6))
        return Leg(sense, (start, cells.column[which], lo[left], hi[left], flips[left], zone, swing, behind))

    def _refine(self, families: list[Family], at_least: int) -> None:
        """Cut the cells that legs of a depth may pass into four; those that several legs share are examined once."""
        quarters = [
            [
                leg.quarters(bits, family.deepest)
                for leg, bits in zip(family.legs, self._tube(family, at_least), strict=True)
            ]
            for family in families
        ]
        self.grid = grid = self.grid.finer()
        for posture in self.formulas:
            of_posture = [n for n, family in enumerate(families) if family.posture == posture]
            if not of_posture:
                continue
            parts = [part for n in of_posture for part in quarters[n]]
            places = [
                np.repeat(np.arange(start.size - 1), np.diff(start)) * grid.columns + column
                for start, column, _ in parts
            ]
            unique, which = np.unique(np.concatenate(places), return_inverse=True)
            flips = np.zeros(unique.size, dtype=np.int64)
            np.bitwise_or.at(flips, which, np.concatenate([part[2] for part in parts]))
            cells = self._tabulated(posture, grid, unique // grid.columns, unique % grid.columns, flips)
            ends = np.cumsum([0, *(place.size for place in places)])
            made = [(part, which[first:last]) for part, first, last in zip(parts, ends[:-1], ends[1:], strict=True)]
            for n in of_posture:
                legs = []
                for leg in families[n].legs:
                    (start, _, bits), own = made.pop(0)
                    legs.append(self._leg(leg.sense, start, cells, own, bits))
                families[n].legs = (legs[0], legs[1])
                families[n].deepest *= 2

    def _deepest(self, family: Family, at_least: int) -> int:
        """The least number of slabs, from `at_least` on, that no motion gets through."""
        low, high = at_least - 1, family.deepest
        first = True
        while high - low > max(1, int(CLOSE * high)):
            trial = at_least if first else (low + high) // 2
            first = False
            if any(self._start(family, flip, trial) for flip, _ in self._flips(family)):
                low = trial
            else:
                high = trial
        return high

    def _flips(self, family: Family) -> list[tuple[int, int]]:
        """Wrist flips that differ for a family, and as bits those that each stands for."""
        if self.flips == BOTH and all(np.isin(leg.table[4], (0, BOTH)).all() for leg in family.legs):
            return [(0, BOTH)]
        return [(flip, 1 << flip) for flip in range(2) if (self.flips >> flip) & 1]

    def _start(self, family: Family, flip: int, slabs: int) -> bool:
        """Whether two legs may get to a depth; at the target the sets that they share are left in `faces`."""
        for leg in family.legs:
            if not outer_sets.inwards(leg.table, self.grid, flip, slabs, leg.viable, leg.passed):
                return False
        a, b = outer_sets.OUT_A, outer_sets.OUT_B
        for leg, other in (family.legs, family.legs[::-1]):
            (start, column, *_), (begin, columns, *_) = other.table, leg.table
            into = leg.faces[[outer_sets.IN_A, outer_sets.IN_B]]
            outer_sets.meet(
                column, start[0], start[1], other.viable[a], other.viable[b], columns, begin[0], begin[1], self.grid,
                into[0], into[1],
            )  # fmt: skip
            first = slice(begin[0], begin[1])
            leg.faces[outer_sets.IN_A, first] = np.maximum(into[0, first], leg.viable[a, first])
            leg.faces[outer_sets.IN_B, first] = np.minimum(into[1, first], leg.viable[b, first])
            if not (leg.faces[outer_sets.IN_A, first] <= leg.faces[outer_sets.IN_B, first]).any():
                return False
        return True

    def _tube(self, family: Family, slabs: int) -> tuple[Numbers, Numbers]:
        """Wrist flips on which legs of a depth may pass the cells of either leg; 0 where none does."""
        flips = tuple(np.zeros_like(leg.table[4]) for leg in family.legs)
        for flip, alike in self._flips(family):
            if self._start(family, flip, slabs):
                for leg, bits in zip(family.legs, flips, strict=True):
                    outer_sets.outwards(
                        leg.table, self.grid, flip, slabs, family.deepest, leg.viable, leg.faces, leg.passed
                    )
                    bits |= leg.passed * alike
        return flips[0], flips[1]

    def _affordable(self, families: list[Family], at_least: int, room: float) -> tuple[int, int]:
        """The least depth, in slabs, whose cells may be refined at no more than a cost, and how many cells it has."""
        low, high, trial = at_least - 1, max(family.deepest for family in families), at_least
        cells = {high: 0}
        while high - low > max(1, int(CLOSE * high)):
            cells[trial] = self._count(families, trial, room / 4)
            if 4 * cells[trial] <= room:
                high = trial
            else:
                low = trial
            trial = (low + high) // 2
        return high, cells[high]

    def _count(self, families: list[Family], slabs: int, enough: float) -> int:
        """How many cells legs of a depth may pass; where they are more than enough, one of several legs counts once."""
        places: dict[int, list[Numbers]] = {}
        for family in families:
            if family.deepest > slabs:
                for leg, bits in zip(family.legs, self._tube(family, slabs), strict=True):
                    left = np.flatnonzero(bits)
                    slab = np.searchsorted(leg.table[0], left, "right") - 1
                    places.setdefault(family.posture, []).append(slab * self.grid.columns + leg.table[1][left])
        whole = sum(each.size for legs in places.values() for each in legs)
        least = sum(max(each.size for each in legs) for legs in places.values())
        if whole <= enough or least > enough:
            return whole
        return sum(np.unique(np.concatenate(legs)).size for legs in places.values())
