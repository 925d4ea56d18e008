"""How deep a stroke of free legs could be at most: what is proven, beside what is found, and how long it takes."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np

import zerorev as zr
from benchmarks.parts import Options
from benchmarks.problems import random_problem
from benchmarks.table import Goal, Section
from benchmarks.timing import duration, in_turns
from zerorev.model._arrays import Array
from zerorev.model.resized import resized
from zerorev.motion.drilling import Drilling
from zerorev.search.bounds.free_depth import FreeBound, bound_free_depth
from zerorev.search.free_deepest import CLOSEST, deepest_free
from zerorev.search.problem import Problem

__all__ = ["run"]

FIRST_SEED = 8_000
BUDGETS = (zr.Settings().proof_boxes, 1_000_000)
SHARES = (0.02, 0.1)


def run(options: Options) -> Section:
    """Random holes: the bound beside what legs of very many segments attain, and beside the motion that is found."""
    problems = [_free(random_problem(FIRST_SEED + n)) for n in range(options.holes)]
    motions = np.array([deepest_free(Drilling(p.robot, p.tool, p.hole), p.settings)[0] for p in problems])
    closest = np.array([deepest_free(Drilling(p.robot, p.tool, p.hole), p.settings, CLOSEST)[0] for p in problems])
    inner = np.maximum(motions, closest)
    rows, figures, failures, goal = [], {}, [], ""
    for boxes in BUDGETS:
        timed = in_turns(
            {p.hole.id: partial(_bound, p, depth, boxes) for p, depth in zip(problems, motions, strict=True)}, 1
        )
        bounds = [each.values[0] for each in timed.values()]
        seconds = [each.median for each in timed.values()]
        at_most = np.array([bound.at_most for bound in bounds])
        failures += [
            f"{p.hole.id}: the bound is below a motion that is known"
            for p, bound, depth in zip(problems, at_most, inner, strict=True)
            if bound < depth
        ]
        inside = [_within(at_most, inner, share) for share in SHARES]
        words = [f"{100 * _within(at_most, motions, share):.0f} %" for share in SHARES]
        times = duration(float(np.median(seconds))), duration(float(np.quantile(seconds, 0.9))), duration(max(seconds))
        rows.append((f"{boxes:,}", *(f"{100 * share:.0f} %" for share in inside), *words, " / ".join(times)))
        figures[f"{boxes}"] = {"at_most": at_most.tolist(), "seconds": seconds, "boxes": [b.boxes for b in bounds]}
        goal = f"{100 * inside[0]:.0f} % and {100 * inside[1]:.0f} % of {len(problems)} holes, at most {times[2]}"
    return Section(
        name="free_depth",
        title="How deep a stroke of free legs could be at most",
        columns=(
            "boxes",
            "within 2 % of the inner set",
            "within 10 %",
            "within 2 % of the motion",
            "within 10 %",
            "time: median / nine in ten / greatest",
        ),
        rows=rows,
        notes=[
            f"The random holes of the proof, {len(problems)} of them, with free legs and a cap of 5 deg/mm; those"
            " without a stroke are left out of the shares. The inner set is what legs of 512 segments attain, by"
            " motions that were evaluated. The motion of 64 segments is within 3 % of it on"
            f" {100 * _within(inner, motions, 0.03):.0f} % of the holes."
        ],
        goals=[
            Goal(
                "deepest stroke of free legs, bound within 2 % and 10 % of the inner set",
                "nobody",
                "70 % and 90 % of 200 holes, 10 s",
                goal,
            )
        ],
        failures=failures,
        figures=figures | {"inner": inner.tolist(), "motions": motions.tolist()},
    )


def _free(problem: Problem) -> Problem:
    """The same with free legs, on an arm of size 1."""
    settings = replace(
        problem.settings, legs="free", max_twist=problem.settings.max_twist / problem.drilling.robot.size
    )
    drilling = problem.drilling
    robot, tool, hole, settings = resized(
        drilling.robot, drilling.tool, drilling.hole, settings, 1 / drilling.robot.size
    )
    return Problem(Drilling(robot, tool, hole), settings)


def _bound(problem: Problem, depth: float, boxes: int, _: int) -> FreeBound:
    return bound_free_depth(problem, depth, boxes)


def _within(at_most: Array, depth: Array, share: float) -> float:
    """On what share of the holes that have a stroke the bound is no more than so much above it."""
    some = depth > 0
    return float((at_most[some] <= depth[some] * (1 + share)).mean())
