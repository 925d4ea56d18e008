"""`zerorev map`: one question, asked of many targets and directions."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from zerorev.cli.common import FINE, machines, map_app, need_maps
from zerorev.report.words import terminal

__all__ = ["run"]


@map_app.default
def run(
    map: Path,
    /,
    *,
    output: Annotated[Path, Parameter(name=["--output", "-o"])],
    workers: int | None = None,
    scheduler: str | None = None,
) -> int:
    """Map where a robot can drill: the deepest stroke, or another quantity, over targets and directions.

    What is finished is kept in the folder of the map at any moment; after an interruption the same command resumes from
    there and ends with the same bytes. On a finished map it looks for damage, and mends it.

    Args:
        map: The map file (YAML): robot, tool, targets, directions, quantity (docs/howto/maps.md).
        output: Where to write the map: a folder of zarr.
        workers: Processes to run it on; by default all cores where it is worth it. The map is the same.
        scheduler: Address of a dask.distributed scheduler to run it on instead, e.g. tcp://10.0.0.1:8786.
    """
    need_maps("map")
    where = machines(workers, scheduler)
    from zerorev.files.map_file import read_map_file
    from zerorev.files.output import check_folder

    task = read_map_file(map)
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
