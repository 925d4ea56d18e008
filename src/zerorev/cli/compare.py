"""`zerorev compare`: two plans, or two jobs, hole by hole."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from zerorev.cli.common import FINE, FOUND, Whole, app, job_of, of_tool
from zerorev.errors import InputError
from zerorev.report.words import terminal

if TYPE_CHECKING:
    from zerorev.model.job import Job
    from zerorev.model.plan import Plan

__all__ = ["compare"]

ACCEPTED = "a plan file (JSON) or a job file (YAML)"


@app.command
def compare(
    first: Path,
    second: Path | None = None,
    /,
    *,
    tool: Whole | None = None,
    workers: int | None = None,
    json: bool = False,
) -> int:
    """Compare two plans hole by hole: reversals, travel, margin, deepest, lost motion, time; and say which is better.

    A hole of the same id is the same hole. A job is planned first, and its plan not kept: to keep it, plan it with -o
    and compare the plan file.

    Args:
        first: A plan file (JSON) or a job file (YAML).
        second: Another, to be set beside it.
        tool: Of plans and jobs of several tools: what this one does, from 1; by default the first.
        workers: Processes to plan a job on; by default all cores where it is large enough.
        json: Print the answer as JSON on standard output, and nothing else there.
    """
    if second is None:
        raise InputError(
            "one file alone", where=str(first),
            accepted=f"zerorev compare FIRST SECOND, each {ACCEPTED}; search methods at the holes of one job are set "
            "side by side by zerorev methods JOB.yaml",
        )  # fmt: skip
    paths = first, second
    read = [_read(path, tool) for path in paths]  # both, before either is planned
    plans = [_planned(found, path, workers) for found, path in zip(read, paths, strict=True)]

    from zerorev.planning.compared import compared
    from zerorev.report.words import plan_comparison as shown
    from zerorev.report.words.answer import Shown

    found, names = compared(*plans), _names(first, second)
    if json:
        terminal.print_json(shown.comparison_data(found, names))
    else:
        if found.pairs:
            terminal.out().print(shown.comparison_table(found, names))
        terminal.print_lines(shown.comparison_lines(found, names))
    return FINE if all(Shown(plan, plan.holes).sound for plan in plans) else FOUND


def _read(path: Path, tool: int | None) -> Plan | Job:
    """The plan or the job of a file, of one tool."""
    from zerorev.files.io import plan_from_text
    from zerorev.files.other_kinds import is_plan
    from zerorev.files.text import read_text

    text = read_text(path, ACCEPTED)
    if is_plan(text, path.name):
        return of_tool(plan_from_text(text, str(path)), tool)
    return replace(of_tool(job_of(path, every_tool=True), tool), further=())


def _planned(found: Plan | Job, path: Path, workers: int | None) -> Plan:
    """The plan itself, or that of a job."""
    from zerorev.model.plan import Plan
    from zerorev.planning.job import plan_job

    if isinstance(found, Plan):
        return found
    with terminal.progress(f"planning {path.name}", len(found.holes)) as progress:
        return plan_job(found, progress, workers=workers)


def _names(first: Path, second: Path) -> tuple[str, str]:
    """What two files are called: their names without the ending, with it, or their whole paths, as they differ."""
    for names in ((first.stem, second.stem), (first.name, second.name)):
        if names[0] != names[1]:
            return names
    return str(first), str(second)
