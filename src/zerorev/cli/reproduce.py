"""`zerorev reproduce`: the thesis, figure by figure."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from zerorev.cli.common import FINE, app, need
from zerorev.report.words import terminal

__all__ = ["reproduce"]


@app.command
def reproduce(
    chapter: str = "all",
    /,
    *,
    output: Annotated[Path, Parameter(name=["--output", "-o"])],
    seeds: int = 100,
    map_size: int = 100,
) -> int:
    """Reproduce the thesis as one page: its figures and tables, ours by its own method, ours by the exact method.

    DIR holds the page, index.html, and the figures (PNG) and tables (CSV) as files. Each section is kept when it is
    done; after an interruption the same command resumes.

    Args:
        chapter: chapter4 (planning), chapter5 (the experiments, in the virtual cell), or all.
        output: The folder; it is made if its parent exists.
        seeds: Runs of the swarm from which rates are estimated, and a third of the sets of the cell; fewer are quicker.
        map_size: Cells of the parameter map along each axis.
    """
    for package in ("matplotlib", "xarray", "jinja2"):
        need(package, package, "reproduce", "report")

    from zerorev.thesis.reproduce.context import Context
    from zerorev.thesis.reproduce.progress import progress_lines
    from zerorev.thesis.reproduce.runner import reproduce as make_page

    with progress_lines() as teller:
        page = make_page(chapter, output, Context(seeds, map_size), teller)
    terminal.say(f"page written to {page}, its figures and tables beside it")
    return FINE
