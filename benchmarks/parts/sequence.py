"""From hole to hole: each hole's own best motion against the planned sequence, and what choosing costs."""

from __future__ import annotations

import tempfile
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

import zerorev as zr
from benchmarks.panel import write_panel
from benchmarks.parts import Options
from benchmarks.table import Goal, Section
from benchmarks.timing import duration
from zerorev.planning.job import answers
from zerorev.planning.sequence import Sequenced, sequenced

__all__ = ["run"]

MOST = 1_000  # holes


def run(options: Options) -> Section:
    """A curved panel of holes at random places, listed at random: as bad an order as there is."""
    count = min(options.panel, MOST)
    with tempfile.TemporaryDirectory() as folder:
        job = zr.read_job(write_panel(Path(folder), count, proof_boxes=0))
    begun = time.perf_counter()
    alone = list(answers(job))
    planned = time.perf_counter() - begun
    rows, took, changes = [], {}, {}
    for name, order, freedom in (
        ("each hole's own best, as listed", "listed", 0.0),
        ("one sequence, as listed", "listed", 0.1),
        ("one sequence, best order found", "best", 0.1),
    ):
        asked = replace(job, settings=replace(job.settings, order=order, posture_freedom=freedom))
        begun = time.perf_counter()
        found = sequenced(asked, lambda: alone)
        took[name] = time.perf_counter() - begun
        moves = found.transitions
        changes[name] = sum(move.changes_posture for move in moves)
        turned = np.rad2deg(sum(np.abs(np.diff(move.joints, axis=0)).sum() for move in moves))
        rows.append((
            name, f"{changes[name]}", f"{sum(move.time for move in moves):.1f} s", f"{turned:,.0f} deg",
            f"{_travel(alone, found):,.0f} deg", duration(took[name]),
        ))  # fmt: skip
    best = took["one sequence, best order found"] - took["one sequence, as listed"]
    return Section(
        name="sequence",
        title="From hole to hole",
        columns=("what", "changes of posture", "moves between", "axes turn there", "travel in the holes", "time"),
        rows=rows,
        notes=[
            f"{count:,} holes of a curved panel at random places, in no order; planning each for itself "
            f"took {duration(planned)} on one core. The time is that of members, choice and the check of what changes.",
        ],
        goals=[
            Goal("members of all holes", "nobody", "twice the plans", duration(took["one sequence, as listed"])),
            Goal("the order of 1,000 holes", "nobody", "10 s", duration(best)),
        ],
        failures=[f"{name}: {n} changes of posture" for name, n in changes.items() if "sequence" in name and n > 2],
        figures={name: [seconds] for name, seconds in took.items()},
    )  # fmt: skip


def _travel(alone: list[zr.HolePlan], found: Sequenced) -> float:
    final = [found.changed.get(n, answer) for n, answer in enumerate(alone)]
    return float(np.rad2deg(sum(answer.score.travel for answer in final if answer.score is not None)))
