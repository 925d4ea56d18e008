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
from benchmarks.peers.ortools_tour import tour
from benchmarks.table import Goal, Section
from benchmarks.timing import duration
from zerorev.model.job import Job
from zerorev.planning.job import answers
from zerorev.planning.sequence import Sequenced, sequenced
from zerorev.program.between import accelerations
from zerorev.program.ways import stop_of

__all__ = ["run"]

MOST = 1_000  # holes
PATIENCE = 20  # [s] that OR-Tools searches for


def run(options: Options) -> Section:
    """A curved panel of holes at random places, listed at random: as bad an order as there is."""
    count = min(options.panel, MOST)
    with tempfile.TemporaryDirectory() as folder:
        job = zr.read_job(write_panel(Path(folder), count, proof_boxes=0))
    begun = time.perf_counter()
    answered = list(answers(job))
    planned = time.perf_counter() - begun
    alone = [answer for answer in answered if answer.motion is not None]
    job = replace(job, holes=tuple(answer.hole for answer in alone))
    rows, took, changes, last = [], {}, {}, Sequenced({}, (), (), None)
    peer = f"OR-Tools' order of its motions ({PATIENCE} s), sequence as listed so"
    for name, order, freedom in (
        ("each hole's own best, as listed", "listed", 0.0),
        ("one sequence, as listed", "listed", 0.1),
        (peer, "listed", 0.1),
        ("one sequence, best order found", "best", 0.1),
    ):
        asked = replace(job, settings=replace(job.settings, order=order, posture_freedom=freedom))
        given = alone
        begun = time.perf_counter()
        if name == peer:
            after = tour(_times(job, alone, last), PATIENCE)
            asked, given = replace(asked, holes=tuple(job.holes[n] for n in after)), [alone[n] for n in after]
        last = sequenced(asked, lambda given=given: given)
        took[name] = time.perf_counter() - begun
        moves = last.transitions
        changes[name] = sum(move.changes_posture for move in moves)
        turned = np.rad2deg(sum(np.abs(np.diff(move.joints, axis=0)).sum() for move in moves))
        rows.append((
            name, f"{changes[name]}", f"{sum(move.time for move in moves):.1f} s", f"{turned:,.0f} deg",
            f"{_travel(given, last):,.0f} deg", duration(took[name]),
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


def _times(job: Job, alone: list[zr.HolePlan], found: Sequenced) -> np.ndarray:
    """Time from the end of each hole's motion to the begin of each other's [s], shape (H, H)."""
    final = [found.changed.get(n, answer) for n, answer in enumerate(alone)]
    stops = [
        stop_of(job.robot, job.tool, job.settings, hole.hole, hole.motion) for hole in final if hole.motion is not None
    ]
    start, end = (
        np.array([side(stop.way) for stop in stops]) for side in (lambda w: w.arrival[0], lambda w: w.departure[-1])
    )
    turn = np.abs(start[None] - end[:, None])
    speed, acceleration = job.robot.limits.speed, accelerations(job.robot.limits)
    long = turn > speed**2 / acceleration
    return np.asarray(np.where(long, turn / speed + speed / acceleration, 2 * np.sqrt(turn / acceleration)).max(axis=2))
