"""`zerorev plan`: the motion of each hole."""

from __future__ import annotations

from pathlib import Path

from zerorev.cli.common import FINE, FOUND, Output, app, check_outputs, job_of, machines, need
from zerorev.cli.instead import Instead, given

__all__ = ["plan"]


@app.command
def plan(
    job: Path,
    /,
    *,
    output: Output = None,
    figures: Path | None = None,
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
        figures: Folder for three pictures a hole; it is made if its parent exists.
        workers: Processes to run it on; by default all cores where the job is large enough. The plan is the same.
        scheduler: Address of a dask.distributed scheduler to run it on instead, e.g. tcp://10.0.0.1:8786.
        json: Print the plan as JSON on standard output, and nothing else there.
        instead: Of the job's settings.
    """
    from zerorev.files.output import check_folder

    check_outputs((output,), job)
    if figures is not None:
        need("matplotlib", "matplotlib", "--figures", "figures")
        check_folder(figures)
    wanted = job_of(job, options=given(instead))

    from zerorev.cli.answering import run

    return FINE if run(wanted, "asked", output, machines(workers, scheduler), json=json, figures=figures) else FOUND
