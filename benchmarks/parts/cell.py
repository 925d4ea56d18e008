"""The virtual cell: one motion, its reference, a study, and the predicted lost motion of a plan."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import zerorev as zr
from benchmarks.parts import Options
from benchmarks.table import Goal, Section
from benchmarks.timing import duration, in_turns
from zerorev.cell.ensemble import study
from zerorev.cell.motions import compared
from zerorev.cell.parameters import drawn, nominal
from zerorev.cell.plant import run as follow
from zerorev.cell.reference import Manner
from zerorev.motion.drilling import Drilling
from zerorev.motion.loads import lost_motion
from zerorev.workers import Machines

__all__ = ["run"]

JOB = Path(__file__).parents[2] / "examples" / "jobs" / "thesis_published.yaml"
SLOW, FAST = (Manner(feed=feed, corner=10e-3) for feed in (0.02, 0.2))
MOTIONS = ("baseline", "plan", "twin", "compensated")
SETS = 300
CALLS = 1000


def run(options: Options) -> Section:
    """The published motions of the thesis, 20 and 200 mm/s."""
    job = zr.read_job(JOB)
    plan = zr.plan_job(replace(job, settings=replace(job.settings, proof_boxes=0)))
    first = plan.holes[0]
    slow, fast = (compared(plan, first, manner, ("plan",)).followed["plan"] for manner in (SLOW, FAST))
    work: dict[str, Callable[[int], Any]] = {
        "position 1 at 20 mm/s, one set": lambda _: follow(slow, nominal()),
        "position 1 at 200 mm/s, one set": lambda _: follow(fast, nominal()),
        "position 1 at 20 mm/s, set-up": lambda _: compared(plan, first, SLOW, ("plan",)).followed["plan"].loaded,
        f"predicted lost motion, {CALLS} times": partial(_lost_motion, plan),
    }
    timed = in_turns(work, options.rounds)
    begun = time.perf_counter()
    list(study(plan, drawn(SETS, 0), manner=SLOW, motions=("twin", "compensated"), machines=Machines()))
    whole = time.perf_counter() - begun
    medians = {name: each.median for name, each in timed.items()}
    return Section(
        name="cell",
        title="The virtual cell",
        columns=("what", "median time", "least time"),
        rows=[
            *((name, duration(each.median), duration(each.least)) for name, each in timed.items()),
            (f"study of {SETS} sets, {len(MOTIONS)} motions, 3 positions, 20 mm/s", duration(whole), ""),
        ],
        notes=[f"{options.rounds} rounds; the study once, on all cores."],
        goals=[
            Goal("one motion at 20 mm/s", "nobody", "25 ms", duration(medians["position 1 at 20 mm/s, one set"])),
            Goal("its set-up", "nobody", "30 ms", duration(medians["position 1 at 20 mm/s, set-up"])),
            Goal("study", "nobody", "60 s", duration(whole)),
            Goal(
                "predicted lost motion of a plan", "nobody", "20 us",
                duration(medians[f"predicted lost motion, {CALLS} times"] / CALLS),
            ),
        ],
        failures=[],
        figures={name: each.seconds for name, each in timed.items()},
    )  # fmt: skip


def _lost_motion(plan: zr.Plan, _: int) -> float:
    hole = plan.holes[0]
    assert hole.motion is not None
    drilling = Drilling(plan.robot, plan.tool, hole.hole)
    found = 0.0
    for _ in range(CALLS):
        found = lost_motion(drilling, hole.motion.profile, hole.motion.branch) or 0.0
    return found
