"""A workspace map in pictures: a plane as a surface, the row of planes, their views (thesis Figures 20 to 24)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import Colormap, ListedColormap, Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from mpl_toolkits.mplot3d import Axes3D

from zerorev.maps.planes import AXES, Across, Plane, view_flips
from zerorev.model._arrays import Array
from zerorev.model.quantity import Quantity
from zerorev.report.figures import style

__all__ = [
    "NUMBERED", "ROBOT_COLOUR", "VALUE_MAP", "best_plane", "capital", "colours_of", "dress_cell", "grey_legend", "heat",
    "planes_figure", "relief", "surface_figure", "value_bar", "views_figure", "write_numbers",
]  # fmt: skip

VALUE_MAP = "viridis"  # in order to the colour-blind, too, and nowhere grey
NUMBERED = 200  # cells of a single plane that have their number written into them
LOW = 4.5  # [inches] a figure so low has no room for a long label in one line
MOST_PLANES = 12  # in one picture, evenly chosen
LEAST_SIZE_MM = 50.0  # of a picture in 3D, each way
RELIEF = 0.35  # of the plane's size, where a value is not a length
ROBOT_COLOUR, RING = "#D55E00", "#c00000"


def colours_of(quantity: Quantity, values: Array) -> tuple[Any, Normalize]:
    """Colour map and its norm for values of a quantity: reversals have the colours that they have everywhere.

    Args:
        quantity: what they are.
        values: of all that is shown together, any shape, NaN where there is no answer.
    """
    import matplotlib

    if quantity.variable == "reversals":
        return ListedColormap(list(style.REVERSAL_COLOURS)), Normalize(-0.5, len(style.REVERSAL_COLOURS) - 0.5)
    known = values[~np.isnan(values)]
    low = 0.0 if quantity.more_is_better or not known.size else float(known.min())
    high = float(known.max()) if known.size else 1.0
    return matplotlib.colormaps[VALUE_MAP], Normalize(low, high if high > low else low + 1.0)


def value_bar(figure: Figure, quantity: Quantity, cmap: Any, norm: Normalize, axes: Any, **where: Any) -> None:
    """The colour bar of a quantity."""
    from matplotlib.cm import ScalarMappable

    bar = figure.colorbar(ScalarMappable(norm, cmap), ax=axes, **where)
    bar.ax.tick_params(labelsize=8.5, color=style.MUTED, labelcolor=style.INK)
    low = figure.get_figheight() < LOW and where.get("location") != "bottom"
    label = quantity.label.replace(" with ", "\nwith ") if low else quantity.label
    bar.set_label(label, size=9.5, color=style.INK)
    if quantity.variable == "reversals":
        most = len(style.REVERSAL_COLOURS) - 1
        bar.set_ticks(range(most + 1), labels=[*map(str, range(most)), f"{most}+"])


def surface_figure(plane: Plane, subtitle: str, robot: Array, ax: Axes | None = None) -> Figure:
    """One plane as a surface, offset along the drill by the value, with the robot at home (thesis Fig. 20).

    Args:
        plane: of a map; it needs two cells or more each way.
        subtitle: of the map.
        robot: places along the arm [mm], shape (P, 3).
        ax: to draw into, in 3D; None: a figure with a heading.
    """
    title = f"{capital(plane.quantity.title)} at {plane.name}"
    figure, axes = style.one_axes(ax, title, subtitle, 6.4, "3d")
    assert isinstance(axes, Axes3D)
    axes.computed_zorder = False
    cmap, norm = colours_of(plane.quantity, plane.value)
    places = plane.surface(relief([plane]))
    axes.plot(*robot.T, color=ROBOT_COLOUR, linewidth=3.0, marker="o", markersize=5, zorder=1)
    axes.plot_surface(
        *places.transpose(2, 0, 1), facecolors=_faces(plane.value, cmap, norm), shade=False, edgecolor="#00000040",
        linewidth=0.4, rcount=200, ccount=200, zorder=2,
    )  # fmt: skip
    dress_cell(axes, np.vstack([places.reshape(-1, 3), robot]))
    value_bar(figure, plane.quantity, cmap, norm, axes, shrink=0.6, pad=0.08)
    grey_legend(figure, plane.quantity, ax=ax)
    return figure


def dress_cell(axes: Axes3D, everything: Array) -> None:
    """Equal scales, limits around what is shown, labels with units, and the usual view of the robot's cell.

    Args:
        axes: to dress.
        everything: places that are shown [mm], shape (P, 3).
    """
    low, high = everything.min(axis=0), everything.max(axis=0)
    middle, half = (low + high) / 2, np.maximum(high - low, LEAST_SIZE_MM) / 2
    axes.set(xlim=(middle[0] - half[0], middle[0] + half[0]), ylim=(middle[1] - half[1], middle[1] + half[1]))
    axes.set_zlim(middle[2] - half[2], middle[2] + half[2])
    axes.set_box_aspect(half, zoom=1.05)
    axes.view_init(elev=19, azim=-125)
    for axis, name in zip((axes.xaxis, axes.yaxis, axes.zaxis), "XYZ", strict=True):
        axis.set_label_text(f"{name} [mm]", size=9.5, color=style.INK)
        axis.set_pane_color((0.975, 0.975, 0.975, 1.0))
    axes.tick_params(labelsize=8, labelcolor=style.INK)
    axes.locator_params(nbins=5)


def planes_figure(planes: Sequence[Plane], subtitle: str, *, alike: bool = True) -> Figure:
    """The planes of a map side by side, each as it is seen along the drill (thesis Fig. 21).

    Args:
        planes: of one map.
        subtitle: of the map.
        alike: one colour means one value in all of them; else each has its own scale, as the thesis' have.
    """
    shown = _chosen(planes)
    columns = min(len(shown), 3 if len(shown) <= 9 else 4)
    rows = -(-len(shown) // columns)
    first = shown[0]
    span = np.ptp(first.height) / max(float(np.ptp(first.width)), 1.0) if first.height.size > 1 else 0.5
    each = style.WIDTH / columns * (0.74 if columns > 1 else 0.62)
    height = float(np.clip(rows * (each * np.clip(span, 0.3, 1.6) + 0.35) + 1.3, 3.2, 11.0))
    title = f"{capital(first.quantity.title)}" + (f" at {first.name}" if len(shown) == 1 else ", plane by plane")
    figure = style.headed_figure(title, subtitle, height)
    grid = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    everything = np.concatenate([plane.value.ravel() for plane in shown])
    for axes in grid.ravel()[len(shown) :]:
        axes.set_visible(False)
    for axes, plane in zip(grid.ravel(), shown, strict=False):
        cmap, norm = colours_of(plane.quantity, everything if alike else plane.value)
        heat(axes, plane, cmap, norm)
        if len(shown) > 1:
            axes.set_title(plane.name.replace("-", "−"), size=9, color=style.INK, loc="left")
            if columns < 4:
                axes.set_title(_best(plane), size=8.5, color=style.MUTED, loc="right")
        if len(shown) == 1 and plane.value.size <= NUMBERED:
            write_numbers(axes, plane, cmap, norm)
    for axes in grid[-1]:
        style.label(axes, x=f"{first.right.upper()} [mm]", y=axes.get_ylabel())
    for axes in grid[:, 0]:
        style.label(axes, x=axes.get_xlabel(), y=f"{first.up.upper()} [mm]")
    if alike:
        value_bar(figure, first.quantity, cmap, norm, list(grid.ravel()), pad=0.015, aspect=30, shrink=0.85)
    grey_legend(figure, first.quantity)
    return figure


def views_figure(planes: Sequence[Plane], subtitle: str, robot: Array) -> Figure:
    """All planes at once as surfaces seen from two sides, square on: from below and from the side (Figures 22 to 24).

    The best cell has a ring.

    Args:
        planes: of one map; each needs two cells or more each way.
        subtitle: of the map.
        robot: places along the arm [mm], shape (P, 3).
    """
    first = planes[0]
    cmap, norm = colours_of(first.quantity, np.concatenate([plane.value.ravel() for plane in planes]))
    figure = style.headed_figure(f"{capital(first.quantity.title)}: all planes, seen square on", subtitle, 5.2)
    scale, best = relief(planes), None
    plane = best_plane(planes)
    if not np.isnan(plane.value).all():
        best = plane.surface(scale)[plane.value == _best_value(plane)][0]
    panels = figure.subplots(1, 2)
    for axes, hidden, shown in zip(panels, (first.up, first.right), (first.right, first.up), strict=True):
        _view(axes, planes, scale, (cmap, norm), (first.across, shown, hidden), robot)
        if best is not None:
            axes.plot(*(best[AXES.index(axis)] for axis in (first.across, shown)), "o", markersize=11, zorder=5,
                      markerfacecolor="none", markeredgecolor=RING, markeredgewidth=1.6)  # fmt: skip
    value_bar(figure, first.quantity, cmap, norm, list(panels), pad=0.015, aspect=30, shrink=0.85)
    grey_legend(figure, first.quantity)
    return figure


def best_plane(planes: Sequence[Plane]) -> Plane:
    """The plane with the best cell, or the first where no plane has an answer."""
    known = [plane for plane in planes if not np.isnan(plane.value).all()]
    return (max if planes[0].quantity.more_is_better else min)(known, key=_best_value) if known else planes[0]


def relief(planes: Sequence[Plane]) -> float:
    """By what a value is multiplied to become an offset [mm]: 1 where it is a length in mm."""
    first = planes[0]
    if first.quantity.unit == "mm":
        return 1.0
    most = max((float(np.nanmax(plane.value)) for plane in planes if not np.isnan(plane.value).all()), default=1.0)
    size = max(float(np.ptp(first.width)), float(np.ptp(first.height)))
    return RELIEF * size / (most or 1.0)


def _view(
    axes: Axes, planes: Sequence[Plane], scale: float, colours: tuple[Colormap, Normalize],
    seen: tuple[Across, Across, Across], robot: Array,
) -> None:  # fmt: skip
    """Every face of every plane, projected along an axis, what is nearer to the viewer drawn later.

    Args:
        axes: to draw into.
        planes: of one map.
        scale: from value to offset.
        colours: map and norm.
        seen: axes to the right, up, and away from the viewer.
        robot: places along the arm [mm].
    """
    right, up, away = (AXES.index(axis) for axis in seen)
    corners, fills, depths = [], [], []
    for plane in planes:
        places = plane.surface(scale)
        four = np.stack([places[:-1, :-1], places[:-1, 1:], places[1:, 1:], places[1:, :-1]], axis=-2).reshape(-1, 4, 3)
        corners.append(four[..., [right, up]])
        depths.append(four[..., away].mean(axis=-1))
        fills.append(_faces(plane.value, *colours).reshape(-1, 4))
    order = np.argsort(-np.concatenate(depths), kind="stable")
    faces, colour = np.concatenate(corners)[order], np.concatenate(fills)[order]
    axes.plot(robot[:, right], robot[:, up], color=ROBOT_COLOUR, linewidth=2.5, marker="o", markersize=4, zorder=1.5)
    axes.add_collection(PolyCollection(list(faces), facecolors=colour, edgecolors=colour, linewidths=0.8, zorder=2))
    style.bare_axes(axes)
    axes.set_aspect("equal")
    axes.autoscale_view()
    if view_flips(seen[0], seen[1]):
        axes.invert_yaxis()
    names = {"z": "from below", "y": "from the side of −Y", "x": "from behind"}
    axes.set_title(names[seen[2]], size=9.5, color=style.INK, loc="left")
    style.label(axes, f"{seen[0].upper()} [mm]", f"{seen[1].upper()} [mm]")


def _faces(value: Array, cmap: Any, norm: Normalize) -> Any:
    """Colours of the faces between the cells, shape (V - 1, U - 1, 4): of the mean of what has an answer, or grey."""
    corners = np.stack([value[:-1, :-1], value[:-1, 1:], value[1:, 1:], value[1:, :-1]])
    given = (~np.isnan(corners)).sum(axis=0)
    mean = np.nansum(corners, axis=0) / np.maximum(given, 1)
    colours = np.asarray(cmap(norm(mean)))
    from matplotlib.colors import to_rgba

    colours[given == 0] = to_rgba(style.CANNOT_RUN)
    return colours


def heat(axes: Axes, plane: Plane, cmap: Any, norm: Normalize) -> None:
    """A plane as coloured cells, as it is seen along the drill."""
    axes.set_facecolor(style.CANNOT_RUN)
    shown = np.minimum(plane.value, norm.vmax or np.inf) if plane.quantity.variable == "reversals" else plane.value
    axes.pcolormesh(_edges(plane.width), _edges(plane.height), shown, cmap=cmap, norm=norm)
    axes.set_aspect("equal")
    axes.tick_params(labelsize=8.5, color=style.MUTED, labelcolor=style.INK)
    axes.spines[:].set_color(style.MUTED)
    if plane.flipped and not axes.xaxis_inverted():
        axes.invert_xaxis()


def write_numbers(axes: Axes, plane: Plane, cmap: Any, norm: Normalize, size: float = 8.0) -> None:
    """The value of each cell, written into it, with a digit after the point where there is room for it."""
    digits = plane.quantity.digits if plane.value.size <= NUMBERED // 2 and size >= 8.0 else 0
    for (row, column), value in np.ndenumerate(plane.value):
        if np.isnan(value):
            continue
        light = np.dot(cmap(norm(value))[:3], (0.299, 0.587, 0.114)) < 0.5
        text, at = f"{value + 0.0:.{digits}f}".replace("-", "−"), (plane.width[column], plane.height[row])
        axes.annotate(text, at, ha="center", va="center", size=size, color="white" if light else style.INK)


def _best(plane: Plane) -> str:
    """The best value of a plane, for its title."""
    if np.isnan(plane.value).all():
        return "none"
    return f"{'≤' if plane.quantity.more_is_better else '≥'} {plane.quantity.shown(_best_value(plane))}"


def _best_value(plane: Plane) -> float:
    return float(np.nanmax(plane.value) if plane.quantity.more_is_better else np.nanmin(plane.value))


def _edges(places: Array) -> Array:
    """Edges of cells around places, shape (N + 1,)."""
    if places.size == 1:
        return np.array([places[0] - 25.0, places[0] + 25.0])
    between = (places[1:] + places[:-1]) / 2
    return np.concatenate([[2 * places[0] - between[0]], between, [2 * places[-1] - between[-1]]])


def _chosen(planes: Sequence[Plane]) -> list[Plane]:
    """At most so many planes, evenly chosen, the first and the last among them."""
    if len(planes) <= MOST_PLANES:
        return list(planes)
    return [planes[n] for n in np.linspace(0, len(planes) - 1, MOST_PLANES).round().astype(int)]


def grey_legend(figure: Figure, quantity: Quantity, handles: Sequence[Any] = (), ax: Axes | None = None) -> None:
    """What grey means, after other entries of the legend.

    Args:
        figure: to be explained.
        quantity: that is shown.
        handles: of the other entries.
        ax: of the caller's own, where it is drawn into those.
    """
    nothing = "no stroke without reversals" if quantity.variable == "deepest_mm" else "no answer"
    grey = Patch(facecolor=style.CANNOT_RUN, edgecolor=style.MUTED, linewidth=0.4, label=nothing)
    style.legend_below(figure, [*handles, grey], len(handles) + 1, ax)


def capital(text: str) -> str:
    """With a capital letter."""
    return text[:1].upper() + text[1:]
