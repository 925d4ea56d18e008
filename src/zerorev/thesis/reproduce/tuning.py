"""The eight tuning trials (sec. 4.5, Tables 3 and 4, Figures 12 to 19), each with many seeds: what was luck?"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import islice

import numpy as np

from zerorev.model._arrays import Array
from zerorev.motion.drilling import Drilling
from zerorev.report.figures.style import png
from zerorev.search.exact import search
from zerorev.thesis.figures import swarm as figures
from zerorev.thesis.figures.reproduced import trial_shares
from zerorev.thesis.reproduce.context import Context
from zerorev.thesis.reproduce.published import POSITIONS, TRIAL_4_PARTICLES_IN_TEXT, TRIALS, Trial
from zerorev.thesis.reproduce.section import Cell, Column, Picture, Result, Section, Table
from zerorev.thesis.reproduce.statistics import mean_interval, pairwise, rate_interval
from zerorev.thesis.reproduce.swarm import run, standard_runs
from zerorev.thesis.swarm import TABLE_3, SwarmResult, SwarmSettings

__all__ = ["make"]

SIGNIFICANT, LEAST_PRINTED = 0.05, 1e-4
SEEDS_APART = 100_000  # between trials, so that no two of them share a random number
CHOSEN = "3"
EASY, HARD = 0, 1  # position 1, the thesis' own, and position 2, where a swarm often fails


@dataclass(frozen=True)
class _Tried:
    """A trial with its runs.

    Attributes:
        name: number, and of trial 4 which reading.
        trial: of the thesis.
        settings: of the swarm.
        ended: share of particles that end at zero reversals [1], shape (seeds,).
        kept: share whose own best has zero [1], shape (seeds,).
        found: whether a run found zero at position 1 (0 or 1), shape (seeds,).
        hard: the same at position 2, of half as many runs.
        cells: share of the cube's cells of 45 deg that a run visits [1], shape (seeds,).
    """

    name: str
    trial: Trial
    settings: SwarmSettings
    ended: Array
    kept: Array
    found: Array
    hard: Array
    cells: Array


def make(context: Context) -> Section:
    """All eight trials, trial 4 in both readings."""
    readings = [(str(each.number), each, TABLE_3[each.number]) for each in TRIALS]
    fewer = replace(TABLE_3[4], particles=TRIAL_4_PARTICLES_IN_TEXT)
    readings.insert(4, ("4, text", TRIALS[3], fewer))
    tried = _all_tried(context, readings)
    pictures = [_picture(context, each.trial, each.settings) for each in tried if each.name != "4, text"]
    shares = trial_shares(
        [each.name for each in tried],
        [100 * each.ended for each in tried],
        [100 * each.kept for each in tried],
        f"position 1, {context.few} seeds a trial; a box is the middle half of the runs",
    )
    pictures.insert(
        0,
        Picture(
            "table_3_shares",
            "Table 3 with many seeds: share of the particles at zero reversals, run by run.",
            png(shares),
        ),
    )
    ended, hard = pairwise([each.ended for each in tried]), pairwise([each.hard for each in tried])
    tables = (_table_3(tried), _table_4(), _differences(tried, ended, hard))
    text = (
        f"Each trial is run with {context.few} seeds at position 1, and half as many at position 2, where"
        " zero is hard to find. Rates have 95 % intervals (Wilson), means too (bootstrap); pairwise tests show which"
        " differences are real (Mann and Whitney on the share of particles at zero, Fisher on success), corrected"
        " after Holm for all pairs. Trial 4 is run with 50 particles as in Table 3 and with 25 as in the text.",
    )
    return Section(text, _results(tried, ended, hard, _exact(context)), tables, tuple(pictures))


_Reading = tuple[str, Trial, SwarmSettings]


def _all_tried(context: Context, readings: list[_Reading]) -> list[_Tried]:
    """Every trial with its own seeds at positions 1 and 2; those of trial 3 are the runs of the other sections."""
    easy, hard = context.few, max(2, context.few // 2)
    others = [(n, settings) for n, (name, _, settings) in enumerate(readings, 1) if name != CHOSEN]
    work = [
        (replace(settings, seed=SEEDS_APART * n + k, keep_history=position == EASY), position)
        for n, settings in others
        for position, runs in ((EASY, easy), (HARD, hard))
        for k in range(runs)
    ]
    rows = iter(context.each(lambda each: _measured(run(context, *each)), work))
    standard = {
        position: [_measured(result) for result in standard_runs(context, position)[:runs]]
        for position, runs in ((EASY, easy), (HARD, hard))
    }
    tried = []
    for name, trial, settings in readings:
        if name == CHOSEN:
            at_easy, at_hard = standard[EASY], standard[HARD]
        else:
            at_easy, at_hard = list(islice(rows, easy)), list(islice(rows, hard))
        found, ended, kept, cells = np.array(at_easy).T
        tried.append(_Tried(name, trial, settings, ended, kept, found, np.array(at_hard)[:, 0], cells))
    return tried


def _measured(result: SwarmResult) -> tuple[float, float, float, float]:
    """Of one run: whether it found zero, shares of particles there, and of cells visited where its history is kept."""
    visited = np.nan
    if result.history is not None:
        corners = np.floor((result.history.positions.reshape(-1, 3) + np.pi) / (np.pi / 4 + 1e-12))
        visited = len(np.unique(corners, axis=0)) / 8**3
    ended, kept = ((each.reversals == 0).mean() for each in (result.last, result.own))
    return float(result.reversals == 0), float(ended), float(kept), visited


def _picture(context: Context, trial: Trial, settings: SwarmSettings) -> Picture:
    result = run(context, replace(settings, keep_history=True, stop_when_settled=False))
    title = f"Trial {trial.number}: {settings.particles} particles, {settings.iterations} iterations"
    subtitle = (
        f"W_in = {trial.inertia}, W_PB = {settings.own_weight:g}, W_GB = {settings.swarm_weight:g}; position 1, seed 0"
    )
    caption = (
        f"Figure {trial.figure}, trial {trial.number}: the particles at the beginning, midway and at the end, and their"
        f" final scores. The thesis: {trial.verdict}."
    )
    return Picture(f"fig_{trial.figure}", caption, png(figures.trial(result, title, subtitle)))


def _table_3(tried: list[_Tried]) -> Table:
    columns = (
        Column("trial"),
        Column("particles"),
        Column("iterations"),
        Column("W_in"),
        Column("W_PB"),
        Column("W_GB"),
        Column("end at zero", "%"),
        Column("95 %", "%"),
        Column("own best at zero", "%"),
        Column("runs that find zero, position 1", "%", 0),
        Column("95 %", "%"),
        Column("position 2", "%", 0),
        Column("95 %", "%"),
        Column("cube visited", "%"),
    )
    rows: list[tuple[Cell, ...]] = []
    for each in tried:
        set_ = each.settings
        head = (each.name, set_.particles, set_.iterations, each.trial.inertia, set_.own_weight, set_.swarm_weight)
        rows.append(
            (
                *head,
                100 * float(each.ended.mean()),
                _span(*mean_interval(each.ended)),
                100 * float(each.kept.mean()),
                *_rate(each.found),
                *_rate(each.hard),
                100 * float(each.cells.mean()),
            )
        )
    caption = f"Table 3 with {len(tried[0].ended)} seeds a trial. “Cube visited”: share of the cube's cells of 45°."
    return Table("table_3", caption, columns, tuple(rows))


def _table_4() -> Table:
    chosen, trial = TABLE_3[int(CHOSEN)], TRIALS[int(CHOSEN) - 1]
    columns = tuple(Column(name) for name in ("trial", "particles", "iterations", "W_in", "W_PB", "W_GB"))
    row = (trial.number, chosen.particles, chosen.iterations, trial.inertia, chosen.own_weight, chosen.swarm_weight)
    return Table("table_4", "Table 4: the scheme of all later runs.", columns, (row,))


def _differences(tried: list[_Tried], ended: dict[tuple[int, int], float], hard: dict[tuple[int, int], float]) -> Table:
    columns = (
        Column("trials"),
        Column("end at zero, difference", "% points"),
        Column("p, Holm", "", 4),
        Column("success at position 2, difference", "% points", 0),
        Column("p, Holm", "", 4),
        Column("real"),
    )
    rows: list[tuple[Cell, ...]] = []
    for i, j in ended:
        one, other = tried[i], tried[j]
        real = [name for name, p in (("particles at zero", ended[i, j]), ("success", hard[i, j])) if p < SIGNIFICANT]
        rows.append(
            (
                f"{one.name} ↔ {other.name}",
                100 * float(other.ended.mean() - one.ended.mean()),
                ended[i, j],
                100 * float(other.hard.mean() - one.hard.mean()),
                hard[i, j],
                ", ".join(real) or "no",
            )
        )
    caption = f"Which differences are real: probabilities after Holm's correction, real below {SIGNIFICANT:g}."
    return Table("table_3_differences", caption, columns, tuple(rows))


def _results(
    tried: list[_Tried], ended: dict[tuple[int, int], float], hard: dict[tuple[int, int], float], exact: str
) -> tuple[Result, ...]:
    names = [each.name for each in tried]
    base = names.index(CHOSEN)
    results = []
    for k, each in enumerate(tried):
        at_zero = f"{100 * each.ended.mean():.0f} % end at zero ({_span(*mean_interval(each.ended))})"
        success = f"{_percent(each.found)} of runs find zero at position 1, {_percent(each.hard)} at position 2"
        remark = "The scheme that the thesis took (Table 4)."
        if k != base:
            pair = min(k, base), max(k, base)
            shares = _verdict("particles at zero", each.ended, tried[base].ended, ended[pair])
            runs = _verdict("success at position 2", each.hard, tried[base].hard, hard[pair])
            remark = f"Against trial {CHOSEN}: {shares} {runs[:-1]}."
        source = f"Table 3, Figure {each.trial.figure}"
        results.append(Result(f"trial {each.name}", each.trial.verdict, source, f"{at_zero}; {success}", exact, remark))
    return tuple(results)


def _exact(context: Context) -> str:
    """What the exact search finds at both positions, every time."""
    counts = []
    for position in (EASY, HARD):
        found = search(Drilling(context.robot, context.tool, POSITIONS[position].hole), context.thesis)
        counts.append("no motion" if found is None else f"{found.reversals} reversals")
    return f"{counts[0]} at position 1, {counts[1]} at position 2, every time"


def _verdict(what: str, one: Array, base: Array, p: float) -> str:
    if p >= SIGNIFICANT:
        return f"no real difference in {what} (p = {p:.2g});"
    less_than = f"p = {p:.1g}" if p >= LEAST_PRINTED else f"p < {LEAST_PRINTED:g}"
    return f"{'more' if one.mean() > base.mean() else 'less'} {what} ({less_than});"


def _rate(found: Array) -> tuple[float, str]:
    return 100 * float(found.mean()), _span(*rate_interval(int(found.sum()), len(found)))


def _span(low: float, high: float) -> str:
    return f"{100 * low:.0f} to {100 * high:.0f}"


def _percent(found: Array) -> str:
    return f"{100 * found.mean():.0f} %"
