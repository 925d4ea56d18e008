"""A job of very many holes through the command line on two workers: time, memory; the state before beside it."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from benchmarks.panel import write_panel
from benchmarks.parts import Options
from benchmarks.states import NEW, OLD, ROOT, environment
from benchmarks.table import Goal, Section
from benchmarks.timing import duration
from benchmarks.watched import Cost, watched
from zerorev.files.schema import JobFile

__all__ = ["run"]

COMPARED = 10  # the state before plans one in so many of the holes
GOAL, MEMORY = "3 min on two cores", 1 << 30


def run(options: Options) -> Section:
    """Plan the panel, and a part of it by each state, one after the other."""
    rows, failures, figures = [], [], list[dict[str, object]]()
    few = max(60, options.panel // COMPARED)
    sizes = [(NEW, few), *([(OLD, few)] if options.old else []), (NEW, options.panel)]
    per_hole = {}
    with TemporaryDirectory() as name:
        for state, holes in sizes:
            folder = Path(name) / f"{state}-{holes}"
            folder.mkdir()
            cost, zero = _planned(folder, holes, options.old if state == OLD and options.old else ROOT)
            per_hole[state, holes] = cost.processor / holes
            figures.append({"state": state, "holes": holes, "zero": zero, "cost": vars(cost)})
            rows.append(
                (
                    f"{holes:,}, {state}", f"{cost.seconds:.1f} s", duration(cost.seconds / holes),
                    duration(cost.processor / holes), _mib(cost.most_of_one), _mib(cost.most_of_all),
                    f"{100 * zero / holes:.2f} %",
                )
            )  # fmt: skip
            if zero < 0.99 * holes:
                failures.append(f"{zero} of {holes} holes have no reversal, 99 % were to")
            if cost.most_of_one > MEMORY:
                failures.append(f"{holes} holes take {_mib(cost.most_of_one)} in one process")
    whole = figures[-1]["cost"]
    assert isinstance(whole, dict)
    ratio = f"; a hole takes {per_hole[NEW, few] / per_hole[OLD, few]:.2f} of the time before" if options.old else ""
    return Section(
        name="panel",
        title="A panel of very many holes",
        columns=("holes, state", "whole run", "a hole", "processor's time, a hole", "most memory of a process",
                 "of all at once", "zero reversals"),
        rows=rows,
        notes=[
            "`zerorev plan JOB -o PLAN --workers 2` on a gently curved panel, from the start of Python to the finished"
            " plan file, without the proof of optimality. Memory is read every half second; that of all processes at"
            " once counts in each of them what they share."
        ],
        goals=[
            Goal(
                f"a panel of {options.panel:,} holes through the command line, but for the proof", "", GOAL,
                f"{duration(float(whole['seconds']))}{ratio}",
            )
        ],
        failures=failures,
        figures={"runs": figures},
    )  # fmt: skip


def _planned(folder: Path, holes: int, checkout: Path) -> tuple[Cost, int]:
    """What planning so many holes costs, and how many of them have no reversal."""
    without_proof = {"proof_boxes": 0} if checkout == ROOT and "proof_boxes" in JobFile.model_fields else {}
    job, plan = write_panel(folder, holes, **without_proof), folder / "plan.json"
    command = [sys.executable, "-m", "zerorev.cli", "plan", str(job), "-o", str(plan), "--workers", "2"]
    cost = watched(command, folder / "cost.json", environment=environment(checkout), codes=(0, 1))
    answers = json.loads(plan.read_text(encoding="utf-8"))["holes"]
    if len(answers) != holes:
        raise RuntimeError(f"{len(answers)} of {holes} holes are in the plan")
    return cost, sum(answer["reversals"] == 0 for answer in answers)


def _mib(size: float) -> str:
    return f"{size / 2**20:.0f} MiB"
