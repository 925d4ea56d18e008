"""The deepest stroke with zero reversals: by the thesis' bisection (eq. 4.9, 4.10) and steps of 5 mm, and exactly."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial

import numpy as np

from zerorev.model.hole import Hole
from zerorev.motion.drilling import Drilling
from zerorev.report.figures.style import png
from zerorev.search.deepest import deepest_stroke
from zerorev.thesis.figures.reproduced import strokes_beside
from zerorev.thesis.reproduce.context import Context
from zerorev.thesis.reproduce.published import (
    BISECTION_RANGE_MM,
    BISECTION_RESOLUTION_MM,
    BISECTION_STEPS,
    DECREMENT_MM,
    DEEPEST,
    hole_along_x,
)
from zerorev.thesis.reproduce.section import Cell, Column, Picture, Result, Section, Table
from zerorev.thesis.sampled import SampledObjective
from zerorev.thesis.stroke import bisect, step_down
from zerorev.thesis.swarm import TABLE_4, run_swarm

__all__ = ["bisect", "make", "step_down"]

SEEDS_A_STROKE = 20  # seeds of the context for one run of each search for a stroke


def make(context: Context) -> Section:
    """Four targets by both of the thesis' searches with a swarm inside, and by zerorev."""
    runs = max(2, context.seeds // SEEDS_A_STROKE)
    rows: list[tuple[Cell, ...]] = []
    results, drawn = [], []
    low, high = BISECTION_RANGE_MM
    holes = [hole_along_x("target", target, 50.0) for target, _, _ in DEEPEST]

    def search(work: tuple[Hole, int | None]) -> tuple[float, int]:
        """By bisection with a seed, or by steps of 5 mm with seed 0."""
        hole, seed = work
        if seed is None:
            return step_down(partial(_finds_zero, context, hole, 0), high, DECREMENT_MM)
        return bisect(partial(_finds_zero, context, hole, seed), low, high, BISECTION_RESOLUTION_MM)

    searched = context.each(search, [(hole, seed) for hole in holes for seed in (None, *range(runs))])
    for n, (hole, (target, thesis, source)) in enumerate(zip(holes, DEEPEST, strict=True)):
        (stepped, tried), *halved = searched[n * (runs + 1) : (n + 1) * (runs + 1)]
        bisected = [depth for depth, _ in halved]
        bounded, straight, free = (
            deepest_stroke(context.robot, context.tool, hole, settings).depth * 1e3
            for settings in (
                replace(context.thesis, psi_bound=np.pi),
                context.thesis,
                replace(context.thesis, legs="free"),
            )
        )
        where = ", ".join(f"{value:g}" for value in target)
        median = float(np.median(bisected))
        rows.append((where, thesis, median, min(bisected), max(bisected), stepped, tried, bounded, straight, free))
        drawn.append((where, thesis, np.array(bisected), straight, free))
        results.append(
            Result(
                f"deepest stroke at ({where}) mm [mm]",
                f"{thesis:g}",
                source,
                f"{median:.1f} by bisection ({min(bisected):.1f} to {max(bisected):.1f} over {runs} runs),"
                f" {stepped:.0f} by steps"
                f" of {DECREMENT_MM:g} mm",
                f"{bounded:.1f} with |ψ| ≤ 180°, {straight:.1f} with periodic spin, {free:.1f} with free legs",
                _remark(thesis, median, bounded),
            )
        )
    needed = math.log2((high - low) / BISECTION_RESOLUTION_MM)
    results.insert(
        0,
        Result(
            "bisection steps from 0 to 200 mm for 1 mm",
            f"n ≥ {BISECTION_STEPS}, so 8",
            "eq. 4.10",
            f"n ≥ {needed:.2f}, so {math.ceil(needed)}",
            "no bisection: the depth is one of the unknowns, 0.001 % of it kept back",
            "Agrees.",
        ),
    )
    columns = (
        Column("target", "mm"),
        Column("thesis", "mm"),
        Column("bisection, median", "mm"),
        Column("least", "mm"),
        Column("most", "mm"),
        Column("by steps of 5 mm", "mm", 0),
        Column("swarms run for that"),
        Column("exact, |ψ| ≤ 180°", "mm", 2),
        Column("exact, periodic", "mm", 2),
        Column("free legs", "mm", 2),
    )
    table = Table("deepest_strokes", "Deepest stroke with zero reversals, no motion threshold.", columns, tuple(rows))
    picture = Picture(
        "deepest_strokes",
        "Deepest stroke with zero reversals: the thesis, a swarm with bisection (each run a dot), and zerorev.",
        png(strokes_beside(drawn, f"{runs} runs of the swarm a target")),
    )
    text = (
        "A swarm that stops at the first zero is asked at one stroke after another. It may miss a zero"
        " that is there, and"
        " bisection then never looks deeper again; so what it finds is a lower bound that differs from seed to seed.",
    )
    return Section(text, tuple(results), (table,), (picture,))


def _finds_zero(context: Context, hole: Hole, seed: int, depth_mm: float) -> bool:
    objective = SampledObjective(Drilling(context.robot, context.tool, replace(hole, depth=depth_mm / 1e3)), threads=1)
    return run_swarm(objective, replace(TABLE_4, stop_at_zero=True, seed=seed)).reversals == 0


def _remark(thesis: float, swarm: float, exact: float) -> str:
    return (
        f"With |ψ| ≤ 180° the thesis stays {exact - thesis:.1f} mm below what is there, our swarm's median"
        f" {exact - swarm:.1f} mm."
    )
