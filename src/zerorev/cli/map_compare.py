"""`zerorev map compare`: two workspace maps side by side."""

from __future__ import annotations

from pathlib import Path

from zerorev.cli.common import FINE, Output, map_app, need, need_maps
from zerorev.report.words import terminal

__all__ = ["compare_maps"]


@map_app.command(name="compare")
def compare_maps(first: Path, second: Path, /, *, output: Output = None, figure: Path | None = None) -> int:
    """Compare two workspace maps of one quantity: two robots, tools, leg kinds or methods, on their common cells.

    Args:
        first: A map, a folder of zarr.
        second: Another.
        output: Where to write the cells side by side (CSV).
        figure: Picture of the plane with the greatest change (PNG).
    """
    from zerorev.files.output import check_file, write_bytes, write_text

    need_maps("map compare")
    if figure is not None:
        need("matplotlib", "matplotlib", "--figure", "figures")
    for path in (output, figure):
        if path is not None:
            check_file(path)

    from zerorev.maps.answers import cells_of, difference
    from zerorev.maps.workspace import read_workspace_map
    from zerorev.report.words.workspace_map import difference_csv, difference_lines, heading, names_of

    maps = [read_workspace_map(path) for path in (first, second)]
    names = names_of(first, second)
    apart = difference(*(cells_of(found) for found in maps))
    for name, found in zip(names, maps, strict=True):
        terminal.say(f"{name}: {heading(found)}")
    for line in difference_lines(apart, names):
        terminal.say(line)
    if output is not None:
        write_text(output, difference_csv(apart, names))
        terminal.say(f"cells written to {output}")
    if figure is not None:
        from zerorev.report.figures.map_difference import map_difference
        from zerorev.report.figures.style import png

        write_bytes(figure, png(map_difference(maps[0], maps[1], names)))
        terminal.say(f"figure written to {figure}")
    return FINE
