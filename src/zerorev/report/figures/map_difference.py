"""Two workspace maps side by side, plane by plane: the one, the other, and by how much they differ."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from zerorev.maps.answers import Difference, cells_of, difference
from zerorev.maps.planes import planes_of
from zerorev.report.figures import style
from zerorev.report.figures.cell import named_direction
from zerorev.report.figures.workspace_map import (
    NUMBERED,
    capital,
    colours_of,
    grey_legend,
    heat,
    value_bar,
    write_numbers,
)

if TYPE_CHECKING:
    from xarray import Dataset

__all__ = ["difference_figure", "map_difference"]

CHANGE_MAP = "PuOr"  # two hues that stay apart to the colour-blind, white where nothing changes


def map_difference(first: Dataset, second: Dataset, names: tuple[str, str] = ("first", "second")) -> Figure:
    """Two workspace maps on their common cells: the plane that changes most in both, and the second less the first.

    Args:
        first: a workspace map on a grid.
        second: another of the same quantity.
        names: what they are called.

    Raises:
        InputError: they hold different quantities, have no cell in common, or their common targets are not a grid.
    """
    return difference_figure(difference(cells_of(first), cells_of(second)), names)


def difference_figure(apart: Difference, names: tuple[str, str]) -> Figure:
    """The plane with the greatest change in two maps, in one scale, and the second less the first.

    Args:
        apart: of two maps on grids.
        names: what they are called.

    Raises:
        InputError: their common targets do not form a grid, so that there is no plane.
    """
    direction, known = 0, ~np.isnan(apart.change)
    if known.any():
        direction = int(np.nanargmax(np.abs(apart.change))) % len(apart.direction)
    sides = [planes_of(each, direction) for each in apart.fields]
    number = int(np.argmax([np.nan_to_num(np.abs(plane.value)).max() for plane in sides[2]]))
    first, second, change = (planes[number] for planes in sides)
    quantity = first.quantity
    drilled = f"drilled along {named_direction(apart.direction[direction])}"
    subtitle = f"{names[1]} less {names[0]}   |   {drilled}"
    if len(sides[2]) > 1:
        subtitle += f"   |   of {len(sides[2])} planes the one that changes most"
    figure = style.headed_figure(f"{capital(quantity.title)} at {first.name}", subtitle, 4.7)
    panels = figure.subplots(1, 3, sharey=True)
    cmap, norm = colours_of(quantity, np.concatenate([first.value.ravel(), second.value.ravel()]))
    for axes, plane, name in zip(panels, (first, second), names, strict=False):
        heat(axes, plane, cmap, norm)
        axes.set_title(name, size=9.5, color=style.INK, loc="left", parse_math=False)
    import matplotlib
    from matplotlib.colors import Normalize

    known = np.abs(change.value[~np.isnan(change.value)])
    most = float(known.max()) if known.size and known.max() > 0 else 1.0
    diverging, span = matplotlib.colormaps[CHANGE_MAP], Normalize(-most, most)
    heat(panels[2], change, diverging, span)
    if change.value.size <= NUMBERED // 2:
        scales = (cmap, norm), (cmap, norm), (diverging, span)
        for axes, plane, (colours, scale) in zip(panels, (first, second, change), scales, strict=True):
            write_numbers(axes, plane, colours, scale, size=6.5)
    panels[2].set_title("second less first", size=9.5, color=style.INK, loc="left")
    where = {"location": "bottom", "pad": 0.03, "shrink": 0.9, "aspect": 30}
    value_bar(figure, quantity, cmap, norm, list(panels[:2]), **where)
    value_bar(figure, replace(change.quantity, title="change"), diverging, span, panels[2], **where)
    for axes in panels:
        style.label(axes, x=f"{first.right.upper()} [mm]")
    style.label(panels[0], x=panels[0].get_xlabel(), y=f"{first.up.upper()} [mm]")
    grey_legend(figure, quantity)
    return figure
