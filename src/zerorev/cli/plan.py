"""`zerorev plan`: the motion of each hole."""

from __future__ import annotations

from difflib import get_close_matches
from pathlib import Path
from typing import TYPE_CHECKING

from zerorev.cli.common import FINE, FOUND, Output, app, check_outputs, job_of, machines, need, need_report
from zerorev.cli.instead import Instead, given
from zerorev.errors import InputError

if TYPE_CHECKING:
    from zerorev.model.job import Job

__all__ = ["plan"]


@app.command
def plan(
    job: Path,
    /,
    *,
    output: Output = None,
    figures: Path | None = None,
    figures_of: str | None = None,
    report: Path | None = None,
    workers: int | None = None,
    scheduler: str | None = None,
    json: bool = False,
    instead: Instead = None,
) -> int:
    """Find the drilling motion of each hole of a job, and check it.

    With -o the finished holes are kept in PLAN.json.part on the way; after an interruption the same command
    resumes.

    Args:
        job: The job file (YAML): robot, tool, holes.
        output: Where to write the plan (JSON). Without it the answer is only shown.
        figures: Folder for three pictures of each hole and stroke, tool by tool; it is made if its parent exists.
        figures_of: Ids of the only holes to draw, with commas between them.
        report: Page with everything about the plan to write (HTML), to be printed or filed; it needs no network.
        workers: Processes to plan and draw on; by default all cores where the job is large enough. What comes out is
            the same.
        scheduler: Address of a dask.distributed scheduler to run it on instead, e.g. tcp://10.0.0.1:8786.
        json: Print the plan as JSON on standard output, and nothing else there.
        instead: Of the job's settings.
    """
    from zerorev.files.output import check_folder

    check_outputs((output, report), job)
    need_report(report)
    if figures is not None:
        need("matplotlib", "matplotlib", "--figures", "figures")
        check_folder(figures)
    if figures_of is not None and figures is None:
        raise InputError("draws nothing without a folder", where="--figures-of", accepted="--figures DIR beside it")
    wanted = job_of(job, every_tool=True, options=given(instead))

    from zerorev.cli.answering import Pictures, run

    pictures = Pictures(figures, None if figures_of is None else _chosen(figures_of, wanted), report, job.name)
    return FINE if run(wanted, "asked", output, machines(workers, scheduler), json=json, pictures=pictures) else FOUND


def _chosen(text: str, job: Job) -> tuple[str, ...]:
    """The ids of a list with commas; an id that has commas itself stands alone."""
    known = [hole.id for hole in job.holes]
    ids = (text,) if text in known else tuple(part.strip() for part in text.split(",") if part.strip())
    if unknown := [name for name in ids if name not in known]:
        near = get_close_matches(unknown[0], known, n=3, cutoff=0.4) or known[:3]
        raise InputError(f"no hole '{unknown[0]}'", where="--figures-of", accepted=f"ids of the job, e.g. {near[0]}")
    if not ids:
        raise InputError("no id", where="--figures-of", accepted=f"ids with commas between them, e.g. {known[0]}")
    return ids
