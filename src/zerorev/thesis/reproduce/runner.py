"""reproduce(chapter, folder): section by section, each kept when it is done, and then the page."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from dataclasses import replace
from pathlib import Path
from typing import Protocol

from zerorev.files.output import write_text
from zerorev.thesis.reproduce.chapters import Part, parts_of
from zerorev.thesis.reproduce.context import Context
from zerorev.thesis.reproduce.page import page
from zerorev.thesis.reproduce.section import Section
from zerorev.thesis.reproduce.store import Store

__all__ = ["PAGE", "Teller", "reproduce"]

PAGE = "index.html"


class Teller(Protocol):
    """What is called with the progress."""

    def __call__(self, part: Part, number: int, of: int) -> AbstractContextManager[Callable[[int, int], None] | None]:
        """Around the making of one part: what is yielded is called with (done, total) on the way."""


def reproduce(chapter: str, folder: Path, context: Context | None = None, teller: Teller | None = None) -> Path:
    """Reproduce a chapter of the thesis as a page with figures and tables.

    What was finished before, by the same version with the same settings, is taken up again.

    Args:
        chapter: one of `CHAPTERS`, or `all`.
        folder: where to; made if its parent exists.
        context: how many seeds, and the robot; None for the thesis' robot and the usual number.
        teller: called for every part that has yet to be made.

    Returns:
        the page's file.

    Raises:
        InputError: no such chapter.
        OutputError: a file cannot be written.
    """
    parts, context = parts_of(chapter), context or Context()
    store = Store(folder, context)
    made: list[tuple[Part, Section]] = []
    for number, part in enumerate(parts, 1):
        section = store.read(part.key)
        if section is None:
            with teller(part, number, len(parts)) if teller else nullcontext() as tell:
                section = part.make(replace(context, tell=tell))
            store.write(part.key, section)
        made.append((part, section))
    path = folder / PAGE
    write_text(path, page(context, made))
    return path
