"""What the commands share: the app that they join, their exit codes, and looks at their arguments."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeVar

from cyclopts import App, Parameter, Token

from zerorev.errors import InputError, OutputError
from zerorev.report.words import terminal
from zerorev.workers import Machines

if TYPE_CHECKING:
    from zerorev.model.job import Job
    from zerorev.model.plan import Plan

__all__ = [
    "BAD_INPUT",
    "BUG",
    "FINE",
    "FOUND",
    "INTERRUPTED",
    "PIPE_CLOSED",
    "Output",
    "Whole",
    "app",
    "check_outputs",
    "first_tool",
    "job_of",
    "machines",
    "map_app",
    "need",
    "need_maps",
    "need_report",
    "numbers",
    "of_tool",
    "recordings_app",
    "robots_app",
]  # fmt: skip

FINE, FOUND, BAD_INPUT, BUG, INTERRUPTED, PIPE_CLOSED = 0, 1, 2, 70, 130, 141
MOST_NUMBERS = 10_000  # of one range on the command line

ENDING = """
Exit codes:

- 0: all is well.
- 1: there is an answer, but something in it is wrong: a hole without a motion, a finding of level error, a failed
  check, a plan that must not become a program.
- 2: an argument, an input or an output that cannot be used.
- 70: a fault in zerorev itself.
- 130: interrupted.

No file is ever left half-written.
"""


def _version() -> str:
    from importlib.metadata import version

    return version("zerorev")


app = App(
    name="zerorev",
    help="Robotic drilling without joint reversals: plan the spin of the tool, prove it, write the robot program.",
    help_epilogue=ENDING,
    version=_version,
    default_parameter=Parameter(negative=(), show_default=False),
    help_format="markdown",
    suppress_keyboard_interrupt=False,
    result_action="return_value",
)

map_app = App(name="map", default_parameter=Parameter(negative=(), show_default=False))
app.command(map_app)
robots_app = App(name="robots", default_parameter=Parameter(negative=(), show_default=False))
app.command(robots_app)
recordings_app = App(
    name="recordings",
    help="Recordings of runs on a real arm (KRC4 trace, RSI, CSV): read, align, measure and compare them.",
    default_parameter=Parameter(negative=(), show_default=False),
)
app.command(recordings_app)

Output = Annotated[Path | None, Parameter(name=["--output", "-o"])]


def _whole(kind: object, tokens: Sequence[Token]) -> int:
    """An integer; cyclopts itself would round."""
    try:
        return int(tokens[0].value)
    except ValueError:
        raise ValueError(f"'{tokens[0].value}' is not an integer") from None


Whole = Annotated[int, Parameter(converter=_whole)]


Several = TypeVar("Several", "Plan", "Job")


def of_tool(whole: Several, tool: int | None) -> Several:
    """What one of the tools of a plan or of a job does; where none is chosen, the first, with a note of the others.

    Args:
        whole: of all tools.
        tool: from 1; None: not chosen.

    Raises:
        InputError: there is no such tool.
    """
    count = len(whole.of_all_tools)
    if tool is not None and not 1 <= tool <= count:
        raise InputError(f"there is no tool {tool}", where="--tool", accepted=f"1 to {count}")
    if tool is None and count > 1:
        others = "--tool 2 shows the other" if count == 2 else f"--tool 2 to --tool {count} show the others"
        terminal.note(f"{whole.name}: this is tool 1 of {count}, {whole.tool.name}; {others}")
    return whole.of_all_tools[(tool or 1) - 1]


def first_tool(whole: Several) -> Several:
    """A plan or a job, of which the command deals with the first tool alone; where there are others, that is noted."""
    if whole.further:
        terminal.note(
            f"{whole.name}: of its {len(whole.of_all_tools)} tools only the first counts here, {whole.tool.name}"
        )
    return whole


def job_of(path: Path, *, every_tool: bool = False, **how: Any) -> Job:
    """The job of a file, as `files.io.read_job` has it; what was left out of its list of holes is noted beside.

    Args:
        path: of the file.
        every_tool: whether the command deals with all tools of the job, or with the one that `of_tool` chooses; else it
            is noted that only the first counts.
        how: as `read_job` takes it.
    """
    from zerorev.files.io import read_job

    job = read_job(path, **how)
    for note in job.notes:
        terminal.note(note)
    return job if every_tool else first_tool(job)


def check_outputs(outputs: Iterable[Path | None], *sources: Path) -> None:
    """Refuse, before any work is done, files that could not be written, and to write over a file that is read."""
    from zerorev.files.output import check_file, place_of

    taken: list[Path] = []
    for output in outputs:
        if output is None:
            continue
        check_file(output, *sources)
        place = place_of(output)
        if place in taken:
            raise OutputError(str(output), "two outputs would be one file")
        taken.append(place)


def numbers(text: str, where: str) -> list[float]:
    """Numbers of START:STOP:STEP, the stop among them where a step meets it, or of a list with commas."""
    accepted = "START:STOP:STEP with a step above 0, or numbers with commas between them"
    parts = text.split(":")
    try:
        numbers = [float(part) for part in (parts if len(parts) == 3 else text.split(","))]
    except ValueError:
        raise InputError(f"'{text}' is not numbers", where=where, accepted=accepted) from None
    if not all(map(math.isfinite, numbers)):
        raise InputError(f"'{text}' is not finite", where=where, accepted=accepted)
    if len(parts) != 3:
        return numbers
    start, stop, step = numbers
    if step <= 0 or stop < start or (stop - start) / step > MOST_NUMBERS:
        raise InputError(f"'{text}' is not a range", where=where, accepted=f"{accepted}, {MOST_NUMBERS} steps at most")
    return [start + n * step for n in range(int((stop - start) / step + 1e-9) + 1)]


def need(module: str, package: str, option: str, extra: str) -> None:
    """Refuse what needs a package that is not installed, and say which extra brings it."""
    from importlib.util import find_spec

    if find_spec(module) is None:
        raise InputError(
            f"needs {package}, which is not installed", where=option, accepted=f"pip install 'zerorev[{extra}]'"
        )


def machines(workers: int | None, scheduler: str | None) -> Machines:
    """Where to run a command: as --workers and --scheduler say, which stand beside no other."""
    if scheduler is not None:
        need("distributed", "dask.distributed", "--scheduler", "cluster")
    return Machines(workers, scheduler)


def need_report(report: Path | None) -> None:
    """Refuse a report where the packages for it are not installed."""
    for module in ("jinja2", "matplotlib") if report is not None else ():
        need(module, module, "--report", "report")


def need_maps(command: str) -> None:
    """Refuse a command that reads maps, where the packages for that are not installed."""
    for package in ("xarray", "zarr"):
        need(package, package, command, "maps")
