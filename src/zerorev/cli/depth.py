"""`zerorev depth`: the deepest stroke of each hole."""

from __future__ import annotations

from pathlib import Path

from zerorev.cli.common import FINE, FOUND, Output, app, check_outputs, job_of, machines
from zerorev.cli.instead import Instead, given

__all__ = ["depth"]


@app.command
def depth(
    job: Path,
    /,
    *,
    output: Output = None,
    workers: int | None = None,
    scheduler: str | None = None,
    json: bool = False,
    instead: Instead = None,
) -> int:
    """Find the deepest stroke of each hole that has no reversal, and the motion that reaches it, and check that.

    The holes need no depth_mm. What DEPTHS.json holds is checked and exported as a plan is. The finished holes are kept
    in DEPTHS.json.part on the way; after an interruption the same command resumes. The motion threshold
    holds at every point, regardless of min_rate_rule.

    Args:
        job: The job file (YAML): robot, tool, holes.
        output: Where to write depths and plans (JSON). Without it the answer is only shown.
        workers: Processes to run it on; by default all cores where the job is large enough. The answer is the same.
        scheduler: Address of a dask.distributed scheduler to run it on instead, e.g. tcp://10.0.0.1:8786.
        json: Print what the file holds as JSON on standard output, and nothing else there.
        instead: Of the job's settings.
    """
    check_outputs((output,), job)
    wanted = job_of(job, every_tool=True, depth_needed=False, options=given(instead))

    from zerorev.cli.answering import run

    return FINE if run(wanted, "deepest", output, machines(workers, scheduler), json=json) else FOUND
