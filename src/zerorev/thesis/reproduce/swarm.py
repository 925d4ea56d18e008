"""How a swarm behaves, and what its weights do (sec. 4.1, Figures 5 and 7), drawn from real runs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from zerorev.model._arrays import Array
from zerorev.motion.drilling import Drilling
from zerorev.report.figures.style import png
from zerorev.thesis.figures import swarm as figures
from zerorev.thesis.reproduce.context import Context
from zerorev.thesis.reproduce.published import POSITIONS
from zerorev.thesis.reproduce.section import Column, Picture, Result, Section, Table
from zerorev.thesis.sampled import SampledObjective
from zerorev.thesis.swarm import TABLE_4, SwarmResult, SwarmSettings, run_swarm

__all__ = ["make", "run", "standard_runs"]

STAGES = ((0, "initial, chaotic"), (12, "searching"), (45, "converging"))
WEIGHTS = (
    ("high W_PB: own best only", 0.4, 0.0),
    ("as in Table 4", 0.2, 0.1),
    ("high W_GB: swarm's best only", 0.0, 0.4),
)
DRAWN = (3, 17, 60)  # particles whose way is drawn


def run(context: Context, settings: SwarmSettings, position: int = 0) -> SwarmResult:
    """One run of the swarm at a published position (0..2), on one thread: several run side by side."""
    return run_swarm(
        SampledObjective(Drilling(context.robot, context.tool, POSITIONS[position].hole), threads=1), settings
    )


def standard_runs(context: Context, position: int) -> list[SwarmResult]:
    """The swarm of Table 4 at a position (0..2) with seeds 0, 1, ...; several sections report these same runs."""
    key = ("standard runs", position)
    if key not in context.kept:
        settings = [replace(TABLE_4, seed=seed, keep_history=True) for seed in range(context.seeds)]
        context.kept[key] = context.each(lambda each: run(context, each, position), settings)
    runs: list[SwarmResult] = context.kept[key]
    return runs


def make(context: Context) -> Section:
    """Both figures, and how far the particles move and lie apart, as numbers."""
    names = [name for _, name in STAGES]
    result = run(context, replace(TABLE_4, keep_history=True, stop_when_settled=False))
    stages = [stage for stage, _ in STAGES]
    subtitle = "position 1, weights of Table 4, seed 0; arrows: each particle's next move"
    behaviour = Picture(
        "fig_05",
        "Figure 5 from a real run: seen along ψe, the particles at their beginning, while they search, and as"
        " they converge. Arrows are their next moves, colours their reversals.",
        png(figures.behaviour(result, stages, names, subtitle)),
    )
    runs = [
        (name, run(context, replace(TABLE_4, own_weight=own, swarm_weight=swarm, keep_history=True)))
        for name, own, swarm in WEIGHTS
    ]
    weights = Picture(
        "fig_07",
        "Figure 7 from real runs: the way of three particles, and where all of them end, as the weight of their"
        " own best or of the swarm's best is raised.",
        png(figures.paths(runs, DRAWN, "position 1, seed 0: the same beginning three times")),
    )
    table = _table(runs)
    moves = [float(np.rad2deg(np.median(_moves(result)[stage]))) for stage in stages]
    own, both, social = (float(row[4] or 0) for row in table.rows)
    results = (
        Result(
            "median move of a particle, initial → searching → converging [deg per iteration]",
            "chaotic motion, then searching, then convergence near the minimum",
            "Figure 5",
            " → ".join(f"{move:.1f}" for move in moves),
            "",
            "The exact method has no swarm: it looks over one dimension, ψt, and solves for the slopes of the legs.",
        ),
        Result(
            "median distance of the particles from the swarm's best at the end [deg]",
            "a high W_PB keeps a particle near its own best, a high W_GB sends it to the swarm's",
            "Figure 7",
            f"{own:.1f} with W_PB alone, {both:.1f} with both, {social:.1f} with W_GB alone",
            "",
            "As the thesis draws it." if own > social else "Not as the thesis draws it, for this seed.",
        ),
    )
    text = (
        "The thesis' Figures 5 and 7 are sketches. Here they are drawn from runs of the swarm on its own"
        " problem, position"
        " 1, with the same first particles each time.",
    )
    return Section(text, results, (table,), (behaviour, weights))


def _moves(result: SwarmResult) -> Array:
    """Distance that each particle moves [rad], shape (T, P)."""
    assert result.history is not None
    return np.asarray(np.linalg.norm(np.diff(result.history.positions, axis=0), axis=-1))


def _table(runs: list[tuple[str, SwarmResult]]) -> Table:
    columns = (
        Column("weights"),
        Column("W_PB"),
        Column("W_GB"),
        Column("at zero in the end", "of 100"),
        Column("median distance from the best", "deg"),
        Column("median distance from its own best", "deg"),
        Column("cells of 45° visited", "of 512"),
    )
    rows = []
    for (name, own, swarm), (_, result) in zip(WEIGHTS, runs, strict=True):
        assert result.history is not None
        cells = np.unique(np.floor((result.history.positions.reshape(-1, 3) + np.pi) / (np.pi / 4 + 1e-12)), axis=0)
        rows.append(
            (
                name,
                own,
                swarm,
                int((result.last.reversals == 0).sum()),
                _median(result.last_spins - result.spins),
                _median(result.last_spins - result.own_spins),
                len(cells),
            )
        )
    return Table("weights", "The three runs of Figure 7 in numbers.", columns, tuple(rows))


def _median(apart: Array) -> float:
    return float(np.rad2deg(np.median(np.linalg.norm(apart, axis=-1))))
