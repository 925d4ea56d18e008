"""How what is taken away is made apart, shown and handed out."""

from __future__ import annotations

import io
import re
import zipfile
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import nullcontext
from typing import Any

from nicegui import ui

from zerorev.errors import ZerorevError
from zerorev.model.finding import Finding
from zerorev.web.computing import Work
from zerorev.web.session import Session
from zerorev.web.state import State
from zerorev.web.views.notices import note

__all__ = ["findings_list", "handed_out", "make", "stem", "zipped"]


def make(
    session: Session,
    work: Work,
    title: str,
    total: int,
    run: Callable[[], Iterator[Any]],
    ready: Callable[[Any], None],
    each: str = "file",
) -> None:
    """Make something in a thread; its last result is handed to the page."""

    def take(state: State, found: Sequence[Any]) -> State:
        if found[-1] is not None:
            if session.page is nullcontext:
                raise ZerorevError(f"{title}: ready while the page was away; ask for it again")
            with session.page():
                ready(found[-1])
        return state

    if not work.start(title, total, run, take, each=each):
        note("Something else is under way; wait for it, or cancel it.")


def findings_list(findings: Sequence[Finding]) -> None:
    """Draw findings, one below the other."""
    with ui.element("ul").classes("zr-reasons"):
        for finding in findings:
            with ui.element("li").classes(f"zr-{finding.level}"):
                ui.icon(finding.level).props('aria-hidden="true"')
                where = "" if finding.hole is None else f"{finding.hole}: "
                ui.label(f"{finding.level}: {where}{finding.message}")


def handed_out(made: Mapping[str, str], media_type: str, name: str) -> None:
    """One text as it is, several in an archive."""
    if len(made) == 1:
        ((file, text),) = made.items()
        ui.download.content(text, file, media_type)
    else:
        ui.download.content(zipped((file, text.encode()) for file, text in made.items()), f"{stem(name)}.zip")


def zipped(named: Iterable[tuple[str, bytes]]) -> bytes:
    """An archive of files by their names."""
    held = io.BytesIO()
    with zipfile.ZipFile(held, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in named:
            archive.writestr(name, content)
    return held.getvalue()


def stem(name: str) -> str:
    """A file name's beginning, in letters that every file system takes."""
    return re.sub(r"[^A-Za-z0-9.-]+", "_", name).strip("._") or "zerorev"
