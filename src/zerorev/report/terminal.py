"""The terminal: answers on standard output, everything else on standard error."""

from __future__ import annotations

import contextlib
import io
import logging
import sys
from collections.abc import Callable, Iterable, Iterator
from typing import Any

from rich.console import Console
from rich.text import Text

__all__ = [
    "busy",
    "complain",
    "err",
    "note",
    "notices",
    "out",
    "print_json",
    "print_lines",
    "progress",
    "replace_what_cannot_be_shown",
    "say",
]

PIPED_WIDTH = 160  # columns of a table that goes to no terminal


class _Console(Console):
    """A console that leaves it to `main` to say with which code a closed pipe ends."""

    def on_broken_pipe(self) -> None:
        """Tell the caller."""
        raise BrokenPipeError


def out() -> Console:
    """Standard output, as it is now."""
    return _Console(highlight=False, width=None if sys.stdout.isatty() else PIPED_WIDTH)


def err() -> Console:
    """Standard error, as it is now."""
    return _Console(stderr=True, highlight=False, width=None if sys.stderr.isatty() else PIPED_WIDTH)


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
    from zerorev.model.text import json_text

    sys.stdout.write(json_text(data))


@contextlib.contextmanager
def progress(what: str, total: int) -> Iterator[Callable[[int, int], None] | None]:
    """A bar on a terminal where there is more than one hole; else nothing."""
    console = err()
    if total < 2 or not console.is_terminal:
        yield None
        return
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task(what, total=total)
        yield lambda done, of: bar.update(task, completed=done, total=of)


@contextlib.contextmanager
def busy(what: str) -> Iterator[None]:
    """A sign of life on a terminal."""
    console = err()
    with console.status(what) if console.is_terminal else contextlib.nullcontext():
        yield


@contextlib.contextmanager
def notices() -> Iterator[None]:
    """Show what the library logs, e.g. that its kernels compile, as notes on standard error."""
    handler = logging.StreamHandler(sys.stderr)
    handler.setFormatter(logging.Formatter("note: %(message)s"))
    logger = logging.getLogger("zerorev")
    logger.addHandler(handler)
    try:
        yield
    finally:
        logger.removeHandler(handler)
