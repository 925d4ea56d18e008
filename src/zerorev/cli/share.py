"""`zerorev share`: which of two robots should drill which hole."""

from __future__ import annotations

from pathlib import Path

from zerorev.cli.common import FINE, FOUND, Output, app, check_outputs, job_of, machines
from zerorev.errors import InputError
from zerorev.report.words import terminal

__all__ = ["share"]


@app.command
def share(
    jobs: list[Path],
    /,
    *,
    balance: bool = False,
    output: Output = None,
    write_jobs: Path | None = None,
    workers: int | None = None,
    scheduler: str | None = None,
    json: bool = False,
) -> int:
    """Share the holes of a part among robots, each hole to the robot with the greatest margin on it.

    Each job names a robot, and by its part_frame where the part stands as seen from that robot. A hole of the same id
    is the same hole of the part.

    Args:
        jobs: Two job files (YAML) or more, one per robot.
        balance: No robot takes more than an even share of the holes, as far as they can be drilled so.
        output: Where to write the answer (JSON). Without it the answer is only shown.
        write_jobs: Folder for one job file per robot, with the holes that it takes; it is made if its parent exists.
        workers: Processes to run it on; by default all cores where there is much to do. The answer is the same.
        scheduler: Address of a dask.distributed scheduler to run it on instead, e.g. tcp://10.0.0.1:8786.
        json: Print the answer as JSON on standard output, and nothing else there.
    """
    from zerorev.files.moved_job import write_job
    from zerorev.files.output import check_file, check_folder, make_folder, write_text
    from zerorev.files.text import json_text

    check_outputs((output,), *jobs)
    targets = [] if write_jobs is None else [write_jobs / job.name for job in jobs]
    if write_jobs is not None:
        check_folder(write_jobs)
        if len(set(targets)) < len(targets):
            raise InputError("two jobs have the same file name", where="--write-jobs", accepted="names that differ")
        for target in targets:
            if target.exists():
                check_file(target, *jobs)
    where = machines(workers, scheduler)
    wanted = [job_of(job) for job in jobs]

    from zerorev.placement import sharing
    from zerorev.report.words import placement as shown

    strokes = sum(len(job.holes) for job in wanted)
    with terminal.progress("deepest strokes", strokes, "stroke") as progress:
        shares = sharing.share(wanted, balance=balance, machines=where, progress=progress)
    data = shown.share_data(wanted, shares)
    written = []
    if output is not None:
        write_text(output, json_text(data))
        written.append(f"answer written to {output}")
    if write_jobs is not None:
        make_folder(write_jobs)
        for r, (target, job) in enumerate(zip(targets, jobs, strict=True)):
            ids = {name for name, taker in zip(shares.ids, shares.taken_by, strict=True) if taker == r}
            if ids:
                write_job(target, job, ids=ids, note=f"{job.name}: the holes that zerorev share gives to this robot")
                written.append(f"job of {len(ids)} holes written to {target}")
    if json:
        terminal.print_json(data)
    else:
        terminal.out().print(shown.share_table(wanted, shares))
        terminal.print_lines(shown.share_lines(wanted, shares))
        for line in written:
            terminal.say(line)
    return FINE if (shares.taken_by >= 0).all() else FOUND
