"""The parameter map: the thesis' objective in a million cells, all eight branches, from pairs of legs."""

from __future__ import annotations

import time
from functools import partial

import numpy as np

from benchmarks.cases import Case, positions
from benchmarks.parts import Options
from benchmarks.table import Goal, Section
from benchmarks.timing import duration, in_turns
from zerorev.motion.drilling import Drilling
from zerorev.thesis.parameter_map import parameter_map, spin_axis
from zerorev.thesis.sampled import SampledObjective, Weighing

__all__ = ["run"]

SIZE, CELLS = 100, 1_000  # an axis; cells that are evaluated directly
SAME = 1e-9
TWO, ONE = "two threads, by the clock", "one thread"
WAYS = {"turns after the extents": Weighing(), "turns at the first point": Weighing(turns="first_point")}


def run(options: Options) -> Section:
    """Time the map of position 1, on two threads and on one, beside direct evaluation of some of its cells."""
    case = positions()[0]
    timed = {
        clock: in_turns({name: partial(_map, case, way, threads) for name, way in WAYS.items()}, options.rounds, read)
        for clock, threads, read in ((TWO, 2, time.perf_counter), (ONE, 1, time.process_time))
    }
    directly = in_turns({"direct": partial(_directly, case)}, options.rounds)["direct"]
    each = directly.median / CELLS
    apart = {name: _apart(case, way) for name, way in WAYS.items()}
    rows = [
        (f"map, {name}, {clock}", duration(found.median), duration(found.least), f"{each * SIZE**3 / found.median:.0f}")
        for clock, both in timed.items() for name, found in both.items()
    ]  # fmt: skip
    rows.append((f"direct evaluation of {CELLS:,} cells, one thread", duration(directly.median),
                 duration(directly.least), "1"))  # fmt: skip
    wall = timed[TWO]["turns after the extents"]
    return Section(
        name="parameter_map",
        title=f"The parameter map: {SIZE}³ motions of 200 steps, each on its best of eight branches",
        columns=("work", "median", "least", "times as fast a cell as directly"),
        rows=rows,
        notes=[
            f"Position 1, stroke 50 mm; {options.rounds} rounds. Greatest difference from direct evaluation over"
            f" {CELLS:,} random cells: " + ", ".join(f"{value:.1e} ({name})" for name, value in apart.items()) + "."
        ],
        goals=[Goal("100³ parameter map", "thesis about 15 h", "1 s on two cores", duration(wall.median))],
        failures=[f"{name}: {value:.1e} from direct evaluation" for name, value in apart.items() if not value <= SAME],
        figures={"apart": apart, "seconds": {clock: {name: found.seconds for name, found in both.items()}
                                             for clock, both in timed.items()}},
    )  # fmt: skip


def _map(case: Case, way: Weighing, threads: int, _: int) -> float:
    found = parameter_map(case.robot, case.tool, case.hole, way, size=SIZE, threads=threads)
    return float(found["score"].min())


def _cells() -> np.ndarray:
    """Random cells: indices of start, target and end, shape (CELLS, 3)."""
    return np.random.default_rng(1).integers(0, SIZE, (CELLS, 3))


def _directly(case: Case, _: int) -> float:
    objective = SampledObjective(Drilling(case.robot, case.tool, case.hole), threads=1)
    return float(objective(spin_axis(SIZE)[_cells()]).min())


def _apart(case: Case, way: Weighing) -> float:
    """Greatest difference of the map's scores from direct evaluation."""
    s, t, e = _cells().T
    found = parameter_map(case.robot, case.tool, case.hole, way, size=SIZE)["score"].values[t, s, e]
    directly = SampledObjective(Drilling(case.robot, case.tool, case.hole), way)(spin_axis(SIZE)[_cells()])
    return float(np.abs(found - directly).max())
