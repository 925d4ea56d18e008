"""`zerorev map`: one question, asked of many targets and directions."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from zerorev.cli.common import FINE, job_of, machines, map_app, need_maps
from zerorev.errors import InputError
from zerorev.report.words import terminal

if TYPE_CHECKING:
    from zerorev.model.map_task import MapTask

__all__ = ["run"]


@map_app.default
def run(
    map: Path | None = None,
    /,
    *,
    output: Annotated[Path, Parameter(name=["--output", "-o"])],
    around: Path | None = None,
    margin_mm: float | None = None,
    cell_mm: float | None = None,
    workers: int | None = None,
    scheduler: str | None = None,
) -> int:
    """Map where a robot can drill: the deepest stroke, or another quantity, over targets and directions.

    What is finished is kept in the folder of the map at any moment; after an interruption the same command resumes from
    there and ends with the same bytes. On a finished map it looks for damage, and mends it.

    Args:
        map: The map file (YAML): robot, tool, targets, directions, quantity (docs/howto/maps.md).
        output: Where to write the map: a folder of zarr.
        around: Instead of a map file, a job (YAML): a map of the deepest strokes in the plane of its holes, in the part
            frame, with its robot, tool and settings.
        margin_mm: With --around: how far the map goes beyond the holes [mm]; by default half of their extent, 50 mm at
            least.
        cell_mm: With --around: from target to target [mm]; by default so that the longer side has some 24.
        workers: Processes to run it on; by default all cores where it is worth it. The map is the same.
        scheduler: Address of a dask.distributed scheduler to run it on instead, e.g. tcp://10.0.0.1:8786.
    """
    need_maps("map")
    where = machines(workers, scheduler)
    from zerorev.files.output import check_folder

    task = _task(map, around, margin_mm, cell_mm)
    if task.cells_in_base:
        terminal.note(
            f"{task.cells_in_base:,} of {task.cells:,} cells lie inside the robot's base and get no answer (accepted:"
            f" {task.outside})"
        )
    from zerorev.maps.run import run_map
    from zerorev.report.words.map_run import summary_lines

    check_folder(output)
    begun = False
    try:
        with terminal.progress("mapping", task.cells, each="cell") as progress:

            def tell(done: int, of: int) -> None:
                nonlocal begun
                if not begun and 0 < done < of:
                    terminal.note(f"resuming after {done:,} of {of:,} cells in {output}")
                begun = True
                if progress:
                    progress(done, of)

            ran = run_map(task, output, where, tell)
    except KeyboardInterrupt:
        if not begun:
            raise
        raise KeyboardInterrupt(
            f"interrupted; what is finished is kept in {output}; the same command resumes"
        ) from None
    if ran.before == ran.chunks:
        terminal.note(f"the map in {output} was finished, and is whole")
    for line in summary_lines(output):
        terminal.say(line)
    terminal.say(f"map written to {output}")
    return FINE


def _task(map: Path | None, around: Path | None, margin_mm: float | None, cell_mm: float | None) -> MapTask:
    """The map that is asked for, by a map file or around a job."""
    if (map is None) == (around is None):
        what = "neither a map file nor --around" if map is None else "both a map file and --around"
        raise InputError(what, where="map", accepted="zerorev map MAP.yaml, or zerorev map --around JOB.yaml")
    if around is None:
        from zerorev.files.map_file import read_map_file

        for option, value in (("--margin-mm", margin_mm), ("--cell-mm", cell_mm)):
            if value is not None:
                raise InputError("a map file states its own targets", where=option, accepted="--around JOB beside it")
        assert map is not None
        return read_map_file(map)
    from zerorev.maps.around import task_around
    from zerorev.report.words.map_run import around_lines

    job = job_of(around, depth_needed=False)
    lengths = (None if value is None else value / 1e3 for value in (margin_mm, cell_mm))
    found = task_around(job, *lengths)
    for line in around_lines(found):
        terminal.note(line)
    return found.task
