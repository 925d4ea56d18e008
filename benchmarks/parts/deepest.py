"""The deepest stroke of a hole without a reversal, straight legs and free ones."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np

import zerorev as zr
from benchmarks.cases import NO_THRESHOLD, Answer, Case, drilled, positions
from benchmarks.parts import Options
from benchmarks.scorer import SAMPLES, rescore
from benchmarks.table import Goal, Section
from benchmarks.timing import duration, in_turns
from zerorev.search.deepest import Deepest

__all__ = ["run"]

STRAIGHT, BOUNDED, FREE, FREER = "straight", "straight, psi within ±180°", "free, 5 deg/mm", "free, 12 deg/mm"
WAYS = {
    STRAIGHT: NO_THRESHOLD,
    BOUNDED: replace(NO_THRESHOLD, psi_bound=np.pi),
    FREE: replace(NO_THRESHOLD, legs="free"),
    FREER: replace(NO_THRESHOLD, legs="free", max_twist=float(np.deg2rad(12e3))),
}
SOUGHT_MM = {  # theory §7: to be met or beaten
    STRAIGHT: (104.6, 26.1, 36.4, 134.8),
    BOUNDED: (104.6, 22.7, 36.4, 134.8),
    FREER: (124.0, 36.0, 46.0, 175.0),
}


def run(options: Options) -> Section:
    """Time each way at each place, and rescore the motions that it gives."""
    rows, failures, figures, medians = [], [], {}, {}
    timed = [in_turns({way: partial(_deepest, case, settings) for way, settings in WAYS.items()}, options.rounds)
             for case in _places()]  # fmt: skip
    # a search that knows no free legs answers with straight ones
    free_known = any(_legs(each[way].values[0]) > 2 for each in timed for way in (FREE, FREER))
    for way in WAYS if free_known else (STRAIGHT, BOUNDED):
        found = [each[way].values[0] for each in timed]
        times = [each[way].median for each in timed]
        depths = [deepest.depth * 1e3 for deepest in found]
        wrong = [reason for case, deepest in zip(_places(), found, strict=True) if (reason := _wrong(case, deepest))]
        failures += [f"{way}: {reason}" for reason in wrong]
        short = [(d, s) for d, s in zip(depths, SOUGHT_MM.get(way, depths), strict=True) if d < s]
        failures += [f"{way}: {depth:.2f} mm deep, {sought:g} mm were to be reached" for depth, sought in short]
        medians[way] = times
        figures[way] = {"depth_mm": depths, "seconds": [each[way].seconds for each in timed]}
        rows.append((way, *(f"{depth:.2f}" for depth in depths), " / ".join(duration(time) for time in times)))
    goals = [_goal("straight", "thesis about 36 min", "15 ms", medians[STRAIGHT])]
    if free_known:
        goals.append(_goal("free", "nobody", "50 ms", medians[FREE]))
    return Section(
        name="deepest",
        title="The deepest stroke without a reversal",
        columns=("legs", "position 1 [mm]", "position 2 [mm]", "position 3 [mm]", "500, 300, 900 [mm]", "median times"),
        rows=rows,
        notes=[
            f"No motion threshold; psi periodic where nothing is said. {options.rounds} rounds. Each motion is rescored"
            f" at N = {SAMPLES:,}" + ("." if failures else ": none reverses a joint or passes a limit."),
            "" if free_known else "Free legs: not measured, the search answers with straight ones.",
        ],
        goals=goals,
        failures=failures,
        figures=figures,
    )


def _places() -> list[Case]:
    """Positions 1 to 3, and the place of the thesis' deepest hole."""
    found = positions()
    hole = replace(found[0].hole, id="500, 300, 900", target=np.array([0.5, 0.3, 0.9]))
    return [*found, replace(found[0], hole=hole)]


def _deepest(case: Case, settings: zr.Settings, _: int) -> Deepest:
    return zr.deepest_stroke(case.robot, case.tool, case.hole, settings)


def _legs(deepest: Deepest) -> int:
    """Segments of the motion."""
    return 0 if deepest.profile is None else deepest.profile.psi.size - 1


def _wrong(case: Case, deepest: Deepest) -> str:
    """What the scorer finds wrong with the motion; "" where nothing is."""
    if deepest.profile is None or deepest.branch is None:
        return f"no stroke at {case.hole.id}"
    score = rescore(drilled(case, deepest.depth), Answer(deepest.profile, deepest.branch))
    if score.wrong or score.reversals:
        return f"{case.hole.id}: {score.wrong or f'{score.reversals} reversals'} at {deepest.depth * 1e3:.3f} mm"
    return ""


def _goal(legs: str, reference: str, goal: str, medians: list[float]) -> Goal:
    times = " / ".join(duration(time) for time in medians)
    return Goal(f"deepest stroke of one hole, {legs} legs", reference, goal, f"{times} at four places")
