"""Outer sets of spins hold every leg: the slopes of a cell, and what random paths do in a random table of cells."""

from __future__ import annotations

import numpy as np

from oracles import holes
from zerorev.kernels import outer_cells, outer_sets
from zerorev.kernels.intervals import LANES
from zerorev.kernels.layout import Constraints
from zerorev.motion.drilling import Drilling, joint_rates
from zerorev.motion.joint_path import joints_along
from zerorev.search.bounds.cells import cell_formulas
from zerorev.search.bounds.free_legs import Grid
from zerorev.search.bounds.tree import model_limits

CAP = np.deg2rad(5e3)


def random_cells(rng, drilled, posture):
    """Cells of one grid: their slabs and columns, and what is known of them."""
    robot, tool, hole, _ = drilled.all
    columns, slabs = int(2.0 ** rng.integers(4, 14)), 4
    edges = np.sort(rng.uniform(0, 0.2, 1)) + np.arange(slabs + 1) * 10.0 ** rng.uniform(-5, -1.5)
    grid = Grid(-np.pi, 2 * np.pi / columns, columns, True, edges)
    lower, upper = model_limits(Drilling(robot, tool, hole))
    rules = Constraints(lower, upper, float(rng.choice([0.0, np.deg2rad(10.0)])), steepest=CAP)
    plane = Drilling(robot, tool, hole).plane
    formulas = cell_formulas(robot.arm, plane, posture, (True,) * 6)
    slab, column = rng.integers(0, slabs, LANES), rng.integers(0, columns, LANES)
    flips, raw = np.full(LANES, 3), np.empty((LANES, 6, outer_cells.RAW))
    bent, swing = np.empty(LANES), np.empty((LANES, 6, 2))
    outer_cells.tabulate(robot.arm, plane, posture, formulas, rules, grid, slab, column, flips, raw, bent, swing)
    return grid, rules, slab, column, flips, raw, bent, swing


def check_cells(rng, drilled):
    """Random points and slopes of random cells against what is known of the cells; how many were admissible."""
    robot, tool, hole, _ = drilled.all
    posture = int(rng.integers(4))
    branch = 2 * posture + (0 if robot.arm.sign[4] > 0 else 1)  # of sin q5 > 0
    grid, rules, slab, column, flips, raw, bent, swing = random_cells(rng, drilled, posture)
    sign, count = np.array(robot.arm.sign), 0
    low, high = np.empty(1), np.empty(1)
    for n in range(LANES):
        for _ in range(4):
            share = rng.choice([0.0, 1.0, rng.uniform()], 2)
            s = grid.edges[slab[n]] + share[0] * (grid.edges[slab[n] + 1] - grid.edges[slab[n]])
            psi = grid.left + (column[n] + share[1]) * grid.width
            theta_s, theta_psi = (each[branch] * sign for each in joint_rates(Drilling(robot, tool, hole), s, psi))
            if np.isnan(theta_s).any():
                continue
            slope = rng.choice([-1.0, 1.0]) * 10.0 ** rng.uniform(-2, np.log10(CAP))
            rate = theta_s + slope * theta_psi
            if np.abs(rate).min() >= rules.min_rate and np.abs(rate).min() > 1e-9:
                count += 1
                angles = joints_along(Drilling(robot, tool, hole), branch, np.array([s]), np.array([psi]))[0]
                model = angles * sign - np.array(robot.arm.offset)
                arm = robot.arm
                elbow = abs(arm.c2 * (arm.a2 * np.cos(model[2]) + arm.c3 * np.sin(model[2])))
                assert elbow <= bent[n] * (1 + 1e-9)
                middle, half = swing[n].mean(axis=1), 0.5 * (swing[n, :, 1] - swing[n, :, 0])
                known = np.isfinite(half)
                away = (model - middle)[known]
                assert (np.abs(away - 2 * np.pi * np.rint(away / (2 * np.pi))) <= half[known]).all()
                for flip in range(2):
                    there = model * np.array([1, 1, 1, 1, 1 - 2 * flip, 1]) + np.pi * flip * np.array(
                        [0, 0, 0, 1, 0, 1]
                    )
                    turns = np.ceil((rules.lower - there) / (2 * np.pi))
                    if (there + 2 * np.pi * turns <= rules.upper).all():
                        assert flips[n] >> flip & 1
                left = np.full(1, 3)
                outer_cells.slopes(rules, raw, np.array([n]), np.sign(rate), left, low, high)
                assert left[0] == 3
                assert low[0] <= slope <= high[0]
    return count


def random_table(rng, grid, dead, joints):
    """Cells of a grid, some missing, each with slopes that may all be of one sign; half of them with joints' angles.

    Args:
        rng: of it.
        grid: of the cells.
        dead: share of the cells that are missing.
        joints: how the angle of each of six joints changes with stand-off and spin, shape (6, 2).
    """
    slabs = grid.edges.size - 1
    start, column = [0], []
    for _ in range(slabs):
        alive = np.flatnonzero(rng.uniform(size=grid.columns) > dead)
        column += alive.tolist()
        start.append(len(column))
    count = len(column)
    middle = rng.normal(size=count) * 3.0
    half = rng.exponential(size=count) * 2.0
    start, column = np.array(start), np.array(column)
    zone, slab = np.full(count, -1), np.repeat(np.arange(slabs), np.diff(start))
    near = np.flatnonzero(rng.uniform(size=count) < 0.5)
    zone[near] = np.arange(near.size)
    s = np.stack([grid.edges[slab[near]], grid.edges[slab[near] + 1]])[:, None]
    psi = (grid.left + np.stack([column[near], column[near] + 1]) * grid.width)[None]
    angles = joints[:, 0, None, None, None] * s + joints[:, 1, None, None, None] * psi
    swing = np.stack([angles.min(axis=(1, 2)), angles.max(axis=(1, 2))], axis=-1).swapaxes(0, 1)
    swing += 2 * np.pi * rng.integers(-2, 3, (near.size, 6, 1))
    behind = np.empty((near.size + 1, 6))
    return start, column, middle - half, middle + half, rng.integers(1, 4, count), zone, swing, behind


def random_path(rng, grid, table, flip, joints):
    """Columns and spins of a path at the faces from the target out, as far as it gets, and the cells that it passes.

    No joint turns back on it.
    """
    start, column, lo, hi, flips, *_ = table
    cells = [
        {int(column[n]): n for n in range(start[k], start[k + 1]) if flips[n] >> flip & 1}
        for k in range(grid.edges.size - 1)
    ]
    if not cells[0]:
        return [], []
    c = int(rng.choice(list(cells[0])))
    x = rng.choice([0.0, grid.width, rng.uniform(0, grid.width)])
    faces, passed = [(c, x)], []
    for k in range(grid.edges.size - 1):
        if c not in cells[k]:
            # a spin on an edge belongs to both columns
            beside = [(c + 1, 0.0)] if x >= grid.width else [(c - 1, grid.width)] if x <= 0.0 else []
            beside = [(each % grid.columns if grid.periodic else each, y) for each, y in beside]
            if not beside or beside[0][0] not in cells[k]:
                break
            c, x = beside[0]
        s, share = grid.edges[k], rng.beta(0.5, 0.5)
        for _ in range(200):
            n = cells[k][c]
            passed.append(n)
            edge = -joints[:, 0] / joints[:, 1]
            least = max(lo[n], edge[joints[:, 1] > 0].max(initial=-np.inf))
            most = min(hi[n], edge[joints[:, 1] < 0].min(initial=np.inf))
            if least > most:
                return faces, passed
            slope = least + share * (most - least)
            rest = min(grid.edges[k + 1] - s, (grid.edges[k + 1] - grid.edges[k]) * rng.choice([0.1, 1.0]))
            to_edge = (grid.width - x) / slope if slope > 0 else x / -slope if slope < 0 else np.inf
            if to_edge > rest:
                x, s = x + slope * rest, s + rest
                if s >= grid.edges[k + 1] - 1e-12:
                    break
                share = rng.beta(0.5, 0.5) if rng.uniform() < 0.3 else share
                continue
            s += to_edge
            beside = c + 1 if slope > 0 else c - 1
            if grid.periodic:
                beside %= grid.columns
            if beside not in cells[k]:
                return faces, passed
            c, x = beside, 0.0 if slope > 0 else grid.width
        else:
            return faces, passed
        faces.append((c, x))
    return faces, passed


def holds(table, slab, rows, faces, c, x):
    """Whether a set at a face holds a spin, in its own column or in the one that it is on the edge of."""
    n = [k for k in range(table[0][slab], table[0][slab + 1]) if table[1][k] == c]
    return bool(n) and faces[rows[0], n[0]] - 1e-9 <= x <= faces[rows[1], n[0]] + 1e-9


class TestCells:
    def test_hold_every_admissible_slope(self):
        rng = np.random.default_rng(0)
        assert sum(check_cells(rng, holes.random_hole(seed, narrowed=seed % 2 == 0)) for seed in range(8)) > 100

    def test_a_small_cell_is_enclosed_closely(self):
        """Above the greatest critical rate of its centre, but for little."""
        rng, known, close = np.random.default_rng(1), 0, 0
        for seed in range(4):
            robot, tool, hole, _ = holes.random_hole(seed).all
            branch, sign = 0 if robot.arm.sign[4] > 0 else 1, np.array(robot.arm.sign)
            plane = Drilling(robot, tool, hole).plane
            grid = Grid(-np.pi, 2 * np.pi / 8192, 8192, True, np.array([1e-3, 1.1e-3]))
            rules = Constraints(*model_limits(Drilling(robot, tool, hole)), 0.0, steepest=CAP)
            column = rng.integers(0, 8192, LANES)
            flips, raw = np.full(LANES, 3), np.empty((LANES, 6, outer_cells.RAW))
            formulas = cell_formulas(robot.arm, plane, 0, (False,) * 6)
            outer_cells.tabulate(
                robot.arm, plane, 0, formulas, rules, grid, np.zeros(LANES, int), column, flips, raw, np.empty(LANES),
                np.empty((0, 6, 2)),
            )  # fmt: skip
            psi = grid.left + (column + 0.5) * grid.width
            fields = joint_rates(Drilling(robot, tool, hole), np.full(LANES, 1.05e-3), psi)
            theta_s, theta_psi = (each[:, branch] * sign for each in fields)
            with np.errstate(invalid="ignore"):
                critical = (-theta_s / theta_psi).max(axis=1)
            for n in np.flatnonzero(critical < CAP / 2):
                low, high, left = np.empty(1), np.empty(1), np.full(1, 3)
                outer_cells.slopes(rules, raw, np.array([n]), np.sign(theta_psi[n]), left, low, high)
                known += 1
                close += critical[n] - 0.02 * CAP <= low[0] <= critical[n]
        assert known > 20
        assert close >= 0.9 * known


class TestSets:
    def test_hold_every_path(self):
        """A path's spins at the faces are reachable, and viable for the depth that it gets to; its cells are passed."""
        rng, through = np.random.default_rng(2), 0
        for trial in range(30):
            columns, slabs = int(rng.integers(3, 12)), int(rng.integers(1, 6))
            edges = np.append(0.0, np.cumsum(rng.uniform(0.05, 0.6, slabs)))
            grid = Grid(-1.0, float(rng.uniform(0.1, 1.0)), columns, bool(trial % 2), edges)
            # angles that do not depend on the spin where that comes round
            joints = np.stack([rng.uniform(0, 2, 6), rng.normal(size=6) * (1e-9 if grid.periodic else 0.5)], axis=1)
            table, flip = random_table(rng, grid, rng.choice([0.0, 0.2]), joints), int(rng.integers(2))
            size = table[1].size
            for _ in range(20):
                faces, passed = random_path(rng, grid, table, flip, joints)
                depth = len(faces) - 1
                if depth < 1:
                    continue
                through += depth
                viable, kept = np.full((outer_sets.FACES, size), np.nan), np.zeros(size, bool)
                assert outer_sets.inwards(table, grid, flip, depth, viable, kept)
                for k, (c, x) in enumerate(faces[:-1]):
                    assert on_face(grid, table, k, (outer_sets.OUT_A, outer_sets.OUT_B), viable, c, x)
                first = slice(table[0][0], table[0][1])
                out = np.full((outer_sets.FACES, size), np.nan)
                out[outer_sets.IN_A, first] = viable[outer_sets.OUT_A, first]
                out[outer_sets.IN_B, first] = viable[outer_sets.OUT_B, first]
                assert outer_sets.outwards(table, grid, flip, depth, slabs, viable, out, kept) >= depth
                for k, (c, x) in enumerate(faces[1:]):
                    assert on_face(grid, table, k, (outer_sets.OUT_A, outer_sets.OUT_B), out, c, x)
                ends = [n for n in passed if n < table[0][depth]]
                assert kept[ends].all()
        assert through > 100

    def test_end_where_every_slope_leads_out(self):
        """Slopes of at least 2 on columns of 3 x 0.5: no path is there after 0.75."""
        edges = np.linspace(0, 1, 11)
        grid = Grid(0.0, 0.5, 3, False, edges)
        table = steady_table(grid, 2.0, 3.0)
        viable, passed = np.full((outer_sets.FACES, 30), np.nan), np.zeros(30, bool)
        assert outer_sets.inwards(table, grid, 0, 7, viable, passed)
        assert not outer_sets.inwards(table, grid, 0, 8, viable, passed)
        assert not outer_sets.inwards(table, grid, 1, 1, viable, passed)

    def test_end_where_a_joint_would_turn_back(self):
        """A joint whose angle falls with the stand-off, at spins that a path can keep, however the others turn."""
        grid = Grid(0.0, 0.1, 3, False, np.linspace(0, 1, 11))
        table = steady_table(grid, -0.05, 0.05)
        swing, viable, passed = table[6], np.full((outer_sets.FACES, 30), np.nan), np.zeros(30, bool)
        slab = np.repeat(np.arange(10), 3)
        swing[:, :, 0], swing[:, :, 1] = 0.1 * slab[:, None], 0.1 * slab[:, None] + 0.15
        assert outer_sets.inwards(table, grid, 0, 10, viable, passed)
        swing[:, 3] = -swing[:, 3, ::-1]
        assert outer_sets.inwards(table, grid, 0, 2, viable, passed)
        assert not outer_sets.inwards(table, grid, 0, 3, viable, passed)


def steady_table(grid, lo, hi):
    """Every cell of a grid, with the same slopes, and of no angle is anything known."""
    columns, slabs = grid.columns, grid.edges.size - 1
    count = columns * slabs
    start, column, ones = np.arange(slabs + 1) * columns, np.tile(np.arange(columns), slabs), np.ones(count)
    swing = np.full((count, 6, 2), [-np.inf, np.inf])
    return start, column, lo * ones, hi * ones, np.full(count, 1), np.arange(count), swing, np.empty((count + 1, 6))


def on_face(grid, table, slab, rows, faces, c, x):
    """Whether a set at a face of a slab holds a spin, which may lie on the edge of the column beside."""
    places = [(c, x)]
    if x >= grid.width - 1e-9:
        places.append((c + 1, 0.0))
    if x <= 1e-9:
        places.append((c - 1, grid.width))
    if grid.periodic:
        places = [(column % grid.columns, y) for column, y in places]
    return any(holds(table, slab, rows, faces, *place) for place in places)
