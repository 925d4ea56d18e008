"""The certificate of one hole: of the plan's numbers, and of the rounded ones read back from the exported program."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path

import zerorev as zr
from benchmarks.parts import Options
from benchmarks.table import Goal, Section
from benchmarks.timing import duration, in_turns
from zerorev.model.plan import Certificate
from zerorev.program.as_exported import as_exported
from zerorev.program.krl.dialect import KRL
from zerorev.program.krl.read import read_krl
from zerorev.verify.certificate.certify import certify_hole
from zerorev.verify.certificate.program import certify_program_hole

__all__ = ["run"]

JOB = Path(__file__).parents[2] / "examples" / "jobs" / "thesis_positions.yaml"


def run(options: Options) -> Section:
    """Plan, export, read back, certify."""
    plan = zr.plan_job(zr.read_job(JOB))
    text = zr.export(plan, "krl").text
    work: dict[str, Callable[[int], Certificate]] = {}
    for hole in plan.holes:
        work[f"{hole.hole.id}, the plan"] = partial(_plan, plan, hole)
        work[f"{hole.hole.id}, the program"] = partial(_program, plan, hole, text)
    timed = in_turns(work, options.rounds)
    medians = [each.median for name, each in timed.items() if name.endswith("program")]
    return Section(
        name="certificate",
        title="The certificate of one hole",
        columns=("hole, and what is certified", "verdict", "pieces", "median time", "least time"),
        rows=[
            (name, each.values[0].verdict, f"{each.values[0].pieces}", duration(each.median), duration(each.least))
            for name, each in timed.items()
        ],
        notes=[
            f"The positions of the thesis with the default settings, {options.rounds} rounds. The time of a program is"
            " that of reading back all of its text, comparing it with the plan, and certifying the one hole."
        ],
        goals=[
            Goal(
                "certificate of one plan, on the rounded numbers read back from the exported program",
                "nobody",
                "0.15 s",
                " / ".join(duration(time) for time in medians) + " at positions 1 / 2 / 3",
            )
        ],
        failures=[
            f"{name}: {each.values[0].verdict}" for name, each in timed.items() if each.values[0].verdict != "certified"
        ],
        figures={name: each.seconds for name, each in timed.items()},
    )


def _plan(plan: zr.Plan, hole: zr.HolePlan, _: int) -> Certificate:
    return certify_hole(plan.robot, plan.tool, plan.settings, hole)


def _program(plan: zr.Plan, hole: zr.HolePlan, text: str, _: int) -> Certificate:
    program = read_krl(text)
    own = as_exported(plan, program, KRL)[plan.holes.index(hole)]
    assert own.hole is not None
    return certify_program_hole(plan, hole, program, own.hole, own.wrong)
