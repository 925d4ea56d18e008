"""The terminal: answers on standard output, everything else on standard error."""

from __future__ import annotations

import contextlib
import io
import logging
import shutil
import sys
import time
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.segment import Segment
from rich.text import Text

from zerorev.visible import visible

__all__ = [
    "busy",
    "complain",
    "duration",
    "err",
    "note",
    "notices",
    "out",
    "print_file",
    "print_json",
    "print_lines",
    "print_plain",
    "progress",
    "rate_text",
    "replace_what_cannot_be_shown",
    "say",
]

PIPED_WIDTH = 180  # columns of a table that goes to no terminal
SECONDS_BETWEEN_LINES = 10.0


class _Console(Console):
    """A console on which all text is text: no markup, no names of pictures, nothing that a terminal would obey.

    It leaves it to `main` to say with which code a closed pipe ends.
    """

    def __init__(self, width: int | None, *, stderr: bool = False) -> None:
        super().__init__(stderr=stderr, highlight=False, markup=False, emoji=False, width=width)

    def _render_buffer(self, buffer: Iterable[Segment]) -> str:
        """What is sent to the terminal of what is laid out; the styles are put around it here."""
        return super()._render_buffer(
            segment if segment.control else Segment(visible(segment.text), segment.style) for segment in buffer
        )

    def on_broken_pipe(self) -> None:
        """Tell the caller."""
        raise BrokenPipeError


def out() -> Console:
    """Standard output, as it is now."""
    return _Console(None if sys.stdout.isatty() else PIPED_WIDTH)


def err() -> Console:
    """Standard error, as it is now."""
    return _Console(None if sys.stderr.isatty() else PIPED_WIDTH, stderr=True)


def replace_what_cannot_be_shown() -> None:
    """From now on a terminal that lacks a character shows a `?` in its place."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")


def say(text: str) -> None:
    """One line of the answer."""
    out().print(Text(text), soft_wrap=True)


def note(text: str) -> None:
    """One line beside the answer."""
    err().print(Text(f"note: {text}"), soft_wrap=True)


def complain(text: str) -> None:
    """What went wrong, in one message."""
    err().print(Text.assemble(("error: ", "bold red"), text), soft_wrap=True)


def print_lines(lines: Iterable[Text]) -> None:
    """Lines of the answer, wrapped on a terminal and whole elsewhere."""
    console = out()
    for line in lines:
        console.print(line, soft_wrap=not console.is_terminal)


def print_json(data: Any) -> None:
    """Plain data, for machines."""
    from zerorev.files.text import json_text

    sys.stdout.write(json_text(data))


def print_plain(text: str) -> None:
    """A text file's text as it stands, for machines: it was made visible where it was written."""
    sys.stdout.write(text)


def print_file(path: Path) -> None:
    """A text file as it stands, for machines."""
    with path.open(encoding="utf-8") as stream:
        shutil.copyfileobj(stream, sys.stdout)


@contextlib.contextmanager
def progress(what: str, total: int, each: str = "hole") -> Iterator[Callable[[int, int], None] | None]:
    """How far it is, how fast, and how long it takes yet: a bar on a terminal, a line now and then elsewhere.

    What is called with (done, total) the first time counts as done before; `each` is what is counted.
    """
    console = err()
    if total < 2:
        yield None
        return
    if not console.is_terminal:
        yield _Lines(what, each)
        return
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, Task, TextColumn, TimeRemainingColumn

    class Rate(TextColumn):
        """How many a second."""

        def render(self, task: Task) -> Text:
            """Of the last half minute."""
            return Text("" if task.speed is None else f"{rate_text(task.speed, each)}, left:")

    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), Rate(""), TimeRemainingColumn())
    with Progress(*columns, console=console, transient=True) as bar:
        tasks: list[Any] = []

        def tell(done: int, of: int) -> None:
            if not tasks:
                tasks.append(bar.add_task(what, completed=done, total=of))
            bar.update(tasks[0], completed=done, total=of)

        yield tell


class _Lines:
    """Progress as lines of a log, for work that takes long."""

    def __init__(self, what: str, each: str) -> None:
        self.what, self.each = what, each
        self.began: tuple[float, int] | None = None
        self.shown = 0.0

    def __call__(self, done: int, of: int) -> None:
        now = time.monotonic()
        if self.began is None:
            self.began, self.shown = (now, done), now
        if now - self.shown < SECONDS_BETWEEN_LINES or done == of:
            return
        self.shown = now
        rate = (done - self.began[1]) / (now - self.began[0])
        left = f", {duration((of - done) / rate)} left" if rate > 0 else ""
        note(f"{self.what}: {done} of {of} {self.each}s, {rate_text(rate, self.each)}{left}")


def rate_text(per_second: float, each: str) -> str:
    """So many of something a second, or so long for each."""
    return f"{per_second:.1f} {each}s/s" if per_second >= 1 or per_second == 0 else f"{1 / per_second:.1f} s/{each}"


def duration(seconds: float) -> str:
    """Hours, minutes and seconds, as far as they matter."""
    minutes, seconds = divmod(round(seconds), 60)
    return f"{minutes // 60} h {minutes % 60} min" if minutes >= 60 else f"{minutes} min {seconds} s"


@contextlib.contextmanager
def busy(what: str) -> Iterator[None]:
    """A sign of life on a terminal."""
    console = err()
    with console.status(what) if console.is_terminal else contextlib.nullcontext():
        yield


class _Visible(logging.Formatter):
    """Says what is logged as text."""

    def format(self, record: logging.LogRecord) -> str:
        """On one line or several."""
        return visible(super().format(record))


@contextlib.contextmanager
def notices() -> Iterator[None]:
    """Show what the library logs, e.g. that its kernels compile, as notes on standard error."""
    handler = logging.StreamHandler(sys.stderr)
    handler.setFormatter(_Visible("note: %(message)s"))
    logger = logging.getLogger("zerorev")
    logger.addHandler(handler)
    level = logger.level
    logger.setLevel(logging.INFO)  # how far it is
    try:
        yield
    finally:
        logger.setLevel(level)
        logger.removeHandler(handler)
