"""A whole plan of one hole: search, deepest stroke, baseline, check and findings; the state before beside it."""

from __future__ import annotations

from dataclasses import replace
from statistics import median
from typing import Any

import numpy as np

import zerorev as zr
from benchmarks.cases import Case, drilled, random_place
from benchmarks.parts import Options
from benchmarks.states import NEW, OLD, planners
from benchmarks.table import Goal, Section
from benchmarks.timing import duration

__all__ = ["run", "zero_holes"]

FIRST_SEED = 5_000
SHARE = 0.3, 0.99  # of the deepest stroke
DEEPEST = 0.06  # [m]
WORTH_DRILLING = 2e-3  # [m] a place whose deepest stroke is less is passed over
LEGS = {"straight": "15 ms", "free": "80 ms"}
WARM_UP = 3  # holes that are planned before the first is timed: kernels are loaded, or compiled


def run(options: Options) -> Section:
    """Plan each hole by each state, in turns."""
    cases = zero_holes(options.holes)
    rows, goals, failures, figures = [], [], [], {}
    with planners(options.old) as states:
        for legs, goal in LEGS.items():
            for case in cases[:WARM_UP]:
                for plan in states.values():
                    plan(_job(case, legs))
            found: dict[str, list[dict[str, Any]]] = {name: [] for name in states}
            for case in cases:
                for name, plan in states.items():
                    found[name].append(plan(_job(case, legs)))
            figures[legs] = found
            medians = {name: median(each["seconds"] for each in answers) for name, answers in found.items()}
            for name, answers in found.items():
                times = [each["seconds"] for each in answers]
                ratio = "" if OLD not in medians else f"{medians[name] / medians[OLD]:.2f}"
                zero = sum(each["reversals"] == 0 for each in answers)
                row = (
                    duration(medians[name]),
                    duration(float(np.quantile(times, 0.9))),
                    ratio,
                    f"{zero} of {len(cases)}",
                )
                rows.append((f"{legs} legs, {name}", *row))
            wrong = sum(not each["passed"] for each in found[NEW])
            failures += [f"{wrong} plans of {legs} legs fail their own check"] if wrong else []
            before = f"{duration(medians[OLD])} before" if OLD in medians else ""
            goals.append(
                Goal(f"a whole plan of one hole but for the proof, {legs} legs", before, goal, duration(medians[NEW]))
            )
    return Section(
        name="plan",
        title="A whole plan of one hole",
        columns=("legs and state", "median time", "nine of ten within", "ratio to before", "zero reversals"),
        rows=rows,
        notes=[
            f"{len(cases)} random holes of {SHARE[0]} to {SHARE[1]} of their deepest stroke and at most"
            f" {DEEPEST * 1e3:g} mm, with the default settings: search, deepest stroke, baseline, check and findings,"
            " without the proof of optimality. Each state of zerorev plans every hole once, in a process of its own,"
            " hole by hole in turns."
        ],
        goals=goals,
        failures=failures,
        figures=figures,
    )


def zero_holes(count: int) -> list[Case]:
    """Random holes in random directions that straight legs drill without a reversal, with any threshold."""
    found: list[Case] = []
    seed = FIRST_SEED
    while len(found) < count:
        place, rng = random_place(seed), np.random.default_rng(seed)
        seed += 1
        deepest = zr.deepest_stroke(place.robot, place.tool, place.hole, zr.Settings()).depth
        if deepest >= WORTH_DRILLING:
            found.append(drilled(place, min(deepest * rng.uniform(*SHARE), DEEPEST)))
    return found


def _job(case: Case, legs: str) -> dict[str, Any]:
    """The hole as a job without a proof."""
    hole = replace(case.hole, id="hole")
    return {
        "robot": case.robot.name,
        "tool": "thesis_drill",
        "legs": legs,
        "proof_boxes": 0,
        "holes": [
            {
                "id": hole.id,
                "target_mm": (hole.target * 1e3).tolist(),
                "direction": hole.direction.tolist(),
                "depth_mm": hole.depth * 1e3,
            }
        ],
    }
