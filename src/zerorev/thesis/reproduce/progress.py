"""How far a reproduction is: bars on a terminal, a line a section elsewhere."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable, Iterator

from zerorev.report.words import terminal
from zerorev.thesis.reproduce.chapters import Part
from zerorev.thesis.reproduce.runner import Teller

__all__ = ["progress_lines"]

SECONDS_BETWEEN_LINES = 20.0


@contextlib.contextmanager
def progress_lines() -> Iterator[Teller]:
    """Show the sections as they are made; an interruption says what is kept."""
    console = terminal.err()
    if not console.is_terminal:
        with _kept():
            yield _line
        return
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.percentage:>3.0f} %"),
        TimeElapsedColumn(),
    )
    with _kept(), Progress(*columns, console=console, transient=True) as bars:

        @contextlib.contextmanager
        def bar(part: Part, number: int, of: int) -> Iterator[Callable[[int, int], None]]:
            task = bars.add_task(f"{number}/{of} {part.title}", total=1)
            yield lambda done, total: bars.update(task, completed=done, total=total)
            bars.update(task, completed=1, total=1)

        yield bar


@contextlib.contextmanager
def _line(part: Part, number: int, of: int) -> Iterator[Callable[[int, int], None]]:
    terminal.note(f"section {number} of {of}: {part.title}")
    shown = time.monotonic()

    def tell(done: int, total: int) -> None:
        nonlocal shown
        if time.monotonic() - shown >= SECONDS_BETWEEN_LINES and done < total:
            shown = time.monotonic()
            terminal.note(f"{part.title}: {done} of {total}")

    yield tell


@contextlib.contextmanager
def _kept() -> Iterator[None]:
    try:
        yield
    except KeyboardInterrupt:
        raise KeyboardInterrupt("interrupted; finished sections are kept, and the same command resumes") from None
