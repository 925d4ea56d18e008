"""A whole run of the thesis' swarm, on one thread and on two: the same figures, with less waiting."""

from __future__ import annotations

import time
from dataclasses import replace
from functools import partial

import numpy as np

from benchmarks.cases import Case, positions
from benchmarks.parts import Options
from benchmarks.table import Goal, Section
from benchmarks.timing import duration, in_turns
from zerorev.motion.drilling import Drilling
from zerorev.thesis.sampled import SAMPLES, SampledObjective
from zerorev.thesis.swarm import TABLE_4, SwarmResult, run_swarm

__all__ = ["run"]

ONE, TWO = "one thread", "two threads"


def run(options: Options) -> Section:
    """Time runs by the wall clock, in turns, and compare what they find."""
    rows, failures, figures, on_two = [], [], {}, []
    for case in positions():
        work = {ONE: partial(_run, case, 1), TWO: partial(_run, case, 2)}
        timed = in_turns(work, options.rounds, time.perf_counter)
        failures += [
            f"{case.hole.id}, seed {seed}: two threads find other figures than one"
            for seed, (one, two) in enumerate(zip(timed[ONE].values, timed[TWO].values, strict=True))
            if not _same(one, two)
        ]
        for name, each in timed.items():
            zero = sum(found.reversals == 0 for found in each.values)
            rows.append(
                (f"{case.hole.id}: {name}", duration(each.median), duration(each.least), f"{zero} of {options.rounds}")
            )
            figures[f"{case.hole.id}, {name}"] = each.seconds
        on_two.append(duration(timed[TWO].median))
    return Section(
        name="swarm",
        title="A whole run of the thesis' swarm",
        columns=("hole, how", "median, by the wall clock", "least", "runs with zero reversals, as sampled"),
        rows=rows,
        notes=[
            f"{TABLE_4.particles} particles, {TABLE_4.iterations} iterations, {SAMPLES} steps a motion, 8 branches;"
            f" {options.rounds} seeds, the same for all. Here alone two cores are used."
            + ("" if failures else " One thread and two find the same to the last bit.")
        ],
        goals=[
            Goal(
                "a thesis-sized swarm run (100 × 50 × 200 × 8), two cores",
                "plain Numba objective 290 ms; thesis 280 s",
                "350 ms",
                " / ".join(on_two) + " at positions 1 / 2 / 3",
            )
        ],
        failures=failures,
        figures=figures,
    )


def _run(case: Case, threads: int, seed: int) -> SwarmResult:
    objective = SampledObjective(Drilling(case.robot, case.tool, case.hole), threads=threads)
    return run_swarm(objective, replace(TABLE_4, seed=seed))


def _same(one: SwarmResult, two: SwarmResult) -> bool:
    """Whether all particles end at the same places, with the same bests."""
    pairs = zip((one.last_spins, one.own_spins, *one.own), (two.last_spins, two.own_spins, *two.own), strict=True)
    return all(np.array_equal(a, b) for a, b in pairs)
