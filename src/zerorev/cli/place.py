"""`zerorev place`: where a part should stand."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from zerorev.cli.common import FINE, FOUND, Output, Whole, app, check_outputs, job_of, machines, need
from zerorev.errors import InputError
from zerorev.report.words import terminal
from zerorev.workers import Machines

if TYPE_CHECKING:
    from zerorev.model._arrays import Array
    from zerorev.model.job import Job
    from zerorev.placement.freedom import Freedom
    from zerorev.placement.search import Placement

__all__ = ["place"]

EACH = {"coarse grid": "place", "refining": "step", "room": "round", "enough": "place", "nearest": "start",
        "most room": "round", "map": "place"}  # fmt: skip


@app.command
def place(
    job: Path,
    /,
    *,
    x_mm: str = "0",
    y_mm: str = "0",
    z_mm: str = "0",
    turn_deg: str = "0",
    enough_mm: float | None = None,
    grid: Whole = 7,
    cells: Whole = 13,
    output: Output = None,
    write_job: Path | None = None,
    figures: Path | None = None,
    workers: int | None = None,
    scheduler: str | None = None,
    json: bool = False,
) -> int:
    """Find where the part of a job should stand, so that every hole is drilled without a reversal and with a margin.

    The part is moved from where the job has it, in the robot's base frame, as far as the ranges allow. What a place is
    worth is its least margin: the deepest stroke of the worst hole less the depth that it needs. After Ctrl-C the best
    place so far is shown and written.

    Args:
        job: The job file (YAML): robot, tool, holes, part_frame.
        x_mm: Shift along X of the base frame, START:STOP, e.g. --x-mm=-100:100.
        y_mm: Likewise along Y.
        z_mm: Likewise along Z.
        turn_deg: Turn about the vertical through the part frame's origin, START:STOP, counter-clockwise from above.
        enough_mm: Find besides, of all places whose least margin is so much or more [mm], the nearest to where the part
            stands, and the one with most room around it; the job is then written with the nearest.
        grid: Places of the coarse grid along each axis that has any freedom.
        cells: Of the map along each axis; 0 for none. It is made where it is written or drawn.
        output: Where to write the answer (JSON). Without it the answer is only shown.
        write_job: Where to write the job with its part at the best place (YAML), if every hole is drilled there; with
            --enough-mm at the nearest place that has enough.
        figures: Folder for the picture of the map (PNG); it is made if its parent exists.
        workers: Processes to run it on; by default all cores where there is much to do. The answer is the same.
        scheduler: Address of a dask.distributed scheduler to run it on instead, e.g. tcp://10.0.0.1:8786.
        json: Print the answer as JSON on standard output, and nothing else there.
    """
    from zerorev.files.output import check_folder, write_text
    from zerorev.files.text import json_text

    check_outputs((output, write_job), job)
    if figures is not None:
        need("matplotlib", "matplotlib", "--figures", "figures")
        check_folder(figures)
    ranges = {"--x-mm": x_mm, "--y-mm": y_mm, "--z-mm": z_mm, "--turn-deg": turn_deg}
    ends = [_range(text, option) for option, text in ranges.items()]
    wanted = job_of(job)

    from zerorev.placement.freedom import Freedom
    from zerorev.report.words import placement as shown

    x, y, z = ((low / 1e3, high / 1e3) for low, high in ends[:3])
    freedom = Freedom(x, y, z, (math.radians(ends[3][0]), math.radians(ends[3][1])))
    where = machines(workers, scheduler)
    enough = None if enough_mm is None else enough_mm / 1e3
    shapes = Shapes(grid, cells if output or figures or json else 0, enough)
    found, stopped = _searched(wanted, freedom, shapes, where)
    to_write = _to_write(found, enough)
    data = shown.placement_data(wanted, freedom, found)
    written = []
    if output is not None:
        write_text(output, json_text(data))
        written.append(f"answer written to {output}")
    if figures is not None and found.slices:
        written.append(_drawn(wanted, found, figures))
    if write_job is not None and to_write is not None:
        written.append(_job_written(wanted, to_write, write_job, job))
    if json:
        terminal.print_json(data)
    else:
        terminal.out().print(shown.placement_table(wanted, found))
        terminal.print_lines(shown.placement_lines(wanted, freedom, found))
        for line in written:
            terminal.say(line)
    if write_job is not None and to_write is None:
        why = "drills every hole" if enough_mm is None else f"has a margin of {enough_mm:g} mm"
        terminal.note(f"no job written: no place that was examined {why}")
    if stopped:
        raise KeyboardInterrupt(f"interrupted; the best place so far is {'written' if output else 'shown'}")
    return FINE if to_write is not None else FOUND


class Shapes(NamedTuple):
    """How fine the search is, and what it looks for besides the best place."""

    grid: int
    cells: int
    enough: float | None


def _to_write(found: Placement, enough: float | None) -> Array | None:
    """Where the part of a job that is written stands; None: no place is good enough."""
    if enough is not None:
        return None if found.nearest is None else found.nearest.place
    return found.place if found.least >= 0 else None


def _searched(job: Job, freedom: Freedom, shapes: Shapes, machines: Machines) -> tuple[Placement, bool]:
    """The best place, and whether Ctrl-C stopped the search for a better one."""
    from zerorev.placement.search import placements

    known: Placement | None = None
    try:
        with _phases() as progress:
            for better in placements(job, freedom, machines=machines, progress=progress, **shapes._asdict()):
                known = better
    except KeyboardInterrupt:
        if known is None:
            raise
        return known, True
    assert known is not None
    return known, False


def _drawn(job: Job, found: Placement, folder: Path) -> str:
    from zerorev.files.output import make_folder, write_bytes
    from zerorev.report.figures.placement import placement_map
    from zerorev.report.figures.style import png

    make_folder(folder)
    write_bytes(folder / "placement.png", png(placement_map(job, found)))
    return f"figure written to {folder}"


def _job_written(job: Job, place: Array, target: Path, source: Path) -> str:
    from zerorev.files.moved_job import write_job
    from zerorev.placement.freedom import frame_at
    from zerorev.report.words.placement import place_words

    note = f"{source.name} with its part moved by zerorev place: {place_words(place)}"
    write_job(target, source, T_base_part=frame_at(job.T_base_part, place), note=note)
    return f"job written to {target}"


def _range(text: str, option: str) -> tuple[float, float]:
    """START:STOP, or one number for no freedom."""
    accepted = "START:STOP, two numbers of which the first is not above the second; e.g. -100:100"
    try:
        ends = [float(part) for part in text.split(":")]
    except ValueError:
        ends = []
    if len(ends) not in (1, 2) or not all(map(math.isfinite, ends)):
        raise InputError(f"'{text}' is not a range", where=option, accepted=accepted)
    if ends[0] > ends[-1]:
        raise InputError(f"'{text}' is empty: it starts above its stop", where=option, accepted=accepted)
    if option == "--turn-deg" and ends[-1] - ends[0] > 360:
        raise InputError(f"'{text}' is more than a full turn", where=option, accepted="360 degrees at most")
    return ends[0], ends[-1]


@contextmanager
def _phases() -> Iterator[Callable[[str, int, int], None]]:
    """Progress of one phase after the other, each with its own bar."""
    with ExitStack() as bars:
        now, bar = "", None

        def tell(phase: str, done: int, total: int) -> None:
            nonlocal now, bar
            if phase != now:
                bars.pop_all().close()
                now, bar = phase, bars.enter_context(terminal.progress(phase, total, EACH[phase]))
            if bar:
                bar(done, total)

        yield tell
