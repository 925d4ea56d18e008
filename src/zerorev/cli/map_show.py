"""`zerorev map show`: a workspace map in pictures and words."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

from zerorev.cli.common import FINE, Whole, map_app, need, need_maps, numbers
from zerorev.errors import InputError
from zerorev.report.words import terminal

__all__ = ["show"]


@map_app.command(name="show")
def show(
    map: Path,
    /,
    *,
    figures: Path | None = None,
    page: Path | None = None,
    direction: Whole = 0,
    across: Literal["x", "y", "z"] | None = None,
    at: str | None = None,
) -> int:
    """Show a workspace map: its range, its best cells, its symmetry in Y, and pictures of it.

    Args:
        map: The map, a folder of zarr.
        figures: Folder for pictures (PNG): planes, a plane as a surface, all planes from below and from the side, the
            targets around the robot, and where the map has several directions a rose of them.
        page: File for a page with a slice to be moved (HTML); it needs no network.
        direction: Which of the map's directions the planes are drawn for, from 0.
        across: The axis that the planes stand across, x, y or z; by default the one that the drill is nearest to.
        at: Target of the rose, X,Y,Z in mm; by default that of the best cell.
    """
    from zerorev.files.output import check_file, check_folder

    need_maps("map show")
    if figures is not None:
        need("matplotlib", "matplotlib", "--figures", "figures")
        check_folder(figures)
    if page is not None:
        need("matplotlib", "matplotlib", "--page", "figures")
        need("plotly", "plotly", "--page", "maps")
        check_file(page)
    target = None if at is None else numbers(at, "--at")
    if target is not None and len(target) != 3:
        raise InputError(f"{len(target)} numbers", where="--at", accepted="three: X,Y,Z in mm")

    from zerorev.maps.workspace import read_workspace_map
    from zerorev.report.words.workspace_map import show_lines

    found = read_workspace_map(map)
    if not 0 <= direction < found.sizes["direction"]:
        raise InputError(f"{direction}", where="--direction", accepted=f"0 to {found.sizes['direction'] - 1}")
    written = []
    if figures is not None:
        from zerorev.report.figures.workspace import write_map_figures

        with terminal.busy("drawing"):
            written = write_map_figures(found, figures, direction=direction, across=across, at=target)
    for line in show_lines(found):
        terminal.say(line)
    for path in written:
        terminal.say(f"figure written to {path}")
    if page is not None:
        from zerorev.files.output import write_text
        from zerorev.report.figures.workspace import robot_at_home
        from zerorev.report.figures.workspace_page import workspace_page

        write_text(page, workspace_page(found, robot_at_home(found)))
        terminal.say(f"page written to {page}")
    return FINE
