"""How much better a motion could be, and how deep a stroke: what branch and bound proves, and how long it takes."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

import zerorev as zr
from benchmarks.parts import Options
from benchmarks.problems import random_problem
from benchmarks.proof_study import BUDGETS, FIRST_SEED, bounded, proven
from benchmarks.table import Goal, Section
from benchmarks.timing import duration, in_turns
from zerorev.motion.drilling import Drilling
from zerorev.search.bounds.proof import Proof, prove
from zerorev.search.exact import search
from zerorev.search.problem import Problem
from zerorev.search.rank import Candidate

__all__ = ["run"]

JOB = Path(__file__).parents[2] / "examples" / "jobs" / "thesis_positions.yaml"


def run(options: Options) -> Section:
    """The positions of the thesis, with and without the motion threshold, and random holes."""
    job = zr.read_job(JOB)
    known = {}
    for rate, words in ((0.0, "threshold off"), (job.settings.min_rate, "0.01 deg/mm")):
        for hole in job.holes:
            problem = Problem(Drilling(job.robot, job.tool, hole), replace(job.settings, min_rate=rate))
            best = search(Drilling(job.robot, job.tool, hole), problem.settings)
            known[f"{hole.id}, {words}"] = partial(_prove, problem, best)
    positions = in_turns(known, options.rounds)
    rows = [
        (name, *_proven(each.values[0]), duration(each.median), duration(max(each.seconds)))
        for name, each in positions.items()
    ]
    seeds = range(FIRST_SEED, FIRST_SEED + options.holes)
    random = [proven(random_problem, seed) for seed in seeds]
    times = [one.seconds[0] for one in random]
    all_of_it, fewest = sum(one.proven[0] for one in random), sum(one.fewest[0] for one in random)
    rows.append(
        (f"{len(seeds)} random holes", f"proven on {all_of_it}, fewest reversals on {fewest}",
         f"a better motion on {sum(one.better for one in random)}", duration(float(np.median(times))),
         duration(max(times)))
    )  # fmt: skip
    depths = [bounded(seed) for seed in seeds]
    spans = [one.seconds for one in depths]
    close = [sum(one.none or (one.above or np.inf) <= share * (1 + 1e-6) for one in depths) for share in (1e-3, 1e-2)]
    rows.append(
        (f"{len(seeds)} random holes, deepest stroke", f"within 0.1 % on {close[0]}, within 1 % on {close[1]}",
         f"a deeper one on {sum(one.found for one in depths)}", duration(float(np.median(spans))), duration(max(spans)))
    )  # fmt: skip
    return Section(
        name="proof",
        title="What no motion of straight legs can beat",
        columns=("hole", "proven", "gap, boxes", "median time", "greatest time"),
        rows=rows,
        notes=[
            f"A budget of {BUDGETS[0]:,} boxes of legs. Random holes on all shipped robots, with the thesis' drill or a"
            f" random tool, seeds from {FIRST_SEED}: half at 0.9 to 0.995 of their deepest stroke, a quarter with each"
            " joint's range narrowed to 40 %. The first answer is not in the times."
        ],
        goals=[
            Goal(
                "proof that no motion of straight legs is better, to 0.1 % of the travel",
                "nobody",
                "0.3 s at the positions, 0.1 s in the median of random holes",
                " / ".join(duration(each.median) for each in positions.values())
                + f" at the positions; {duration(float(np.median(times)))} in the median of {len(seeds)} random holes",
            )
        ],
        failures=[f"{name}: not proven" for name, each in positions.items() if not each.values[0].optimality.proven],
        figures={"seconds": times, "boxes": [one.boxes for one in random], "gap": [one.gap[0] for one in random]},
    )


def _prove(problem: Problem, best: Candidate | None, _: int) -> Proof:
    return prove(problem, best, BUDGETS[0])


def _proven(proof: Proof) -> tuple[str, str]:
    optimality, best = proof.optimality, proof.best
    reversals = f"{optimality.reversals_at_least:g} reversals at least"
    if best is None or optimality.travel_at_least is None:
        return reversals, f"{proof.boxes:,}"
    travel = f"{np.rad2deg(optimality.travel_at_least):.3f} of {np.rad2deg(best.score.travel):.3f} deg"
    return f"{reversals}, {travel}", f"{100 * (optimality.gap or 0):.3f} %, {proof.boxes:,}"
