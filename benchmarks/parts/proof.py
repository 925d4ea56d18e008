"""How much better a motion could be, and how deep a stroke: what branch and bound proves, and how long it takes."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

import zerorev as zr
from benchmarks.parts import Options
from benchmarks.problems import random_problem
from benchmarks.table import Goal, Section
from benchmarks.timing import duration, in_turns
from zerorev.search.bounds.proof import Proof, prove
from zerorev.search.bounds.straight_depth import DepthBound, bound_depth
from zerorev.search.exact import search
from zerorev.search.problem import Problem
from zerorev.search.rank import Candidate

__all__ = ["run"]

JOB = Path(__file__).parents[2] / "examples" / "jobs" / "thesis_positions.yaml"
FIRST_SEED = 8_000
BOXES = 500_000  # some seconds
MOST_GAP = 1e-3


def run(options: Options) -> Section:
    """The positions of the thesis, with and without the motion threshold, and random holes."""
    job = zr.read_job(JOB)
    known = {}
    for rate, words in ((0.0, "threshold off"), (job.settings.min_rate, "0.01 deg/mm")):
        for hole in job.holes:
            problem = Problem(job.robot, job.tool, hole, replace(job.settings, min_rate=rate))
            best = search(job.robot, job.tool, hole, problem.settings)
            known[f"{hole.id}, {words}"] = partial(_prove, problem, best)
    positions = in_turns(known, options.rounds)
    rows = [
        (name, *_proven(each.values[0]), duration(each.median), duration(max(each.seconds)))
        for name, each in positions.items()
    ]
    problems = [random_problem(FIRST_SEED + n) for n in range(options.holes)]
    first = [search(p.robot, p.tool, p.hole, p.settings) for p in problems]
    random = in_turns({p.hole.id: partial(_prove, p, best) for p, best in zip(problems, first, strict=True)}, 1)
    proofs: list[Proof] = [each.values[0] for each in random.values()]
    times = [each.median for each in random.values()]
    fewest = sum(p.optimality.proven or p.optimality.gap is not None for p in proofs)
    closed = sum(p.optimality.proven for p in proofs)
    better = sum(
        _is_better(problem, proof.best, one) for problem, proof, one in zip(problems, proofs, first, strict=True)
    )
    deep = {p.hole.id: zr.deepest_stroke(p.robot, p.tool, p.hole, p.settings).depth for p in problems}
    depths = in_turns({p.hole.id: partial(_bound_depth, p, deep[p.hole.id]) for p in problems}, 1)
    bounds: list[DepthBound] = [each.values[0] for each in depths.values()]
    tight = sum(b.at_most is not None and b.at_most <= deep[h] * 1.0011 for h, b in zip(deep, bounds, strict=True))
    within = sum(b.at_most is not None and b.at_most <= deep[h] * 1.0101 for h, b in zip(deep, bounds, strict=True))
    deeper = sum(b.deeper is not None for b in bounds)
    count = len(problems)
    rows.append(
        (f"{count} random holes", f"proven on {closed}, fewest reversals on {fewest}", f"a better motion on {better}",
         duration(float(np.median(times))), duration(max(times)))
    )  # fmt: skip
    spans = [each.median for each in depths.values()]
    rows.append(
        (f"{count} random holes, deepest stroke", f"within 0.1 % on {tight}, within 1 % on {within}",
         f"a deeper one on {deeper}", duration(float(np.median(spans))), duration(max(spans)))
    )  # fmt: skip
    return Section(
        name="proof",
        title="What no motion of straight legs can beat",
        columns=("hole", "proven", "gap, boxes", "median time", "greatest time"),
        rows=rows,
        notes=[
            f"A budget of {BOXES:,} boxes of legs. Random holes on all shipped robots, with the thesis' drill or a"
            f" random tool, seeds from {FIRST_SEED}: half at 0.9 to 0.995 of their deepest stroke, a quarter with each"
            " joint's range narrowed to 40 %. The first answer is not in the times."
        ],
        goals=[
            Goal(
                "proof that no motion of straight legs is better, to 0.1 % of the travel",
                "nobody",
                "0.3 s at the positions, 0.1 s in the median of random holes",
                " / ".join(duration(each.median) for each in positions.values())
                + f" at the positions; {duration(float(np.median(times)))} in the median of {count} random holes",
            )
        ],
        failures=[f"{name}: not proven" for name, each in positions.items() if not each.values[0].optimality.proven],
        figures={"seconds": times, "boxes": [p.boxes for p in proofs], "gap": [p.optimality.gap for p in proofs]},
    )


def _prove(problem: Problem, best: Candidate | None, _: int) -> Proof:
    return prove(problem, best, BOXES)


def _bound_depth(problem: Problem, depth: float, _: int) -> DepthBound:
    return bound_depth(problem, depth, BOXES)


def _proven(proof: Proof) -> tuple[str, str]:
    optimality, best = proof.optimality, proof.best
    reversals = f"{optimality.reversals_at_least:g} reversals at least"
    if best is None or optimality.travel_at_least is None:
        return reversals, f"{proof.boxes:,}"
    travel = f"{np.rad2deg(optimality.travel_at_least):.3f} of {np.rad2deg(best.score.travel):.3f} deg"
    return f"{reversals}, {travel}", f"{100 * (optimality.gap or 0):.3f} %, {proof.boxes:,}"


def _is_better(problem: Problem, proven: Candidate | None, first: Candidate | None) -> bool:
    """Whether the proof has found a motion that is better by more than 0.1 %, or by a reversal."""
    if proven is None or first is None:
        return proven is not first
    fewer = problem.order.reversals(proven) < problem.order.reversals(first)
    return fewer or proven.score.travel < first.score.travel * (1 - MOST_GAP)
