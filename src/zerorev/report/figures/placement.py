"""The map of a part's freedom: how much deeper than needed its worst hole goes, over two axes at a time."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.colors import TwoSlopeNorm
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from zerorev.model.job import Job
from zerorev.placement.freedom import AXES
from zerorev.placement.room import Slice
from zerorev.placement.search import Placement
from zerorev.report.figures import style
from zerorev.report.words.answer import how_deep
from zerorev.report.words.placement import in_unit, place_words

__all__ = ["placement_map"]

COLUMNS = 3
LABELS = {"x": "shift along X [mm]", "y": "shift along Y [mm]", "z": "shift along Z [mm]", "turn": "turn [deg]"}
BEST: dict[str, Any] = {"marker": "*", "linestyle": "none", "color": "#ffffff", "markeredgecolor": style.INK,
                        "markersize": 15, "zorder": 6}  # fmt: skip
NOW: dict[str, Any] = {"marker": "^", "linestyle": "none", "color": style.INK, "markeredgecolor": "white",
                       "markersize": 8, "zorder": 5}  # fmt: skip
ELSEWHERE: dict[str, Any] = NOW | {"markerfacecolor": "white", "markeredgecolor": style.INK}


def placement_map(job: Job, found: Placement) -> Figure:
    """The slices of a placement: least margin [mm] over shifts [mm] and turn [deg], the room outlined.

    Args:
        job: whose part is moved.
        found: with one slice or more.
    """
    shown = found.slices
    columns = min(COLUMNS, len(shown)) if len(shown) != 4 else 2
    rows = -(-len(shown) // columns)
    title = f"Room for the part: {job.name}, {len(job.holes)} holes"
    figure = style.headed_figure(title, how_deep(job.settings), 1.5 + rows * (3.9 if columns < 3 else 2.9))
    low, high = (float(end([end(each.margin) for each in shown])) * 1e3 for end in (np.min, np.max))
    low, high = min(low, -1e-3), max(high, 1e-3)
    norm = TwoSlopeNorm(0.0, low, high)
    places = figure.subplots(rows, columns, squeeze=False)
    mesh: QuadMesh | None = None
    for axes, each in zip(places.flat, shown, strict=False):
        if len(each.axes) == 1:
            _curve(axes, each, found)
        else:
            mesh = _map(axes, each, found, norm)
    for axes in places.flat[len(shown) :]:
        axes.set_visible(False)
    best = f"best: {place_words(found.place)}; margin {style.signed(found.least * 1e3, 1)} mm"
    handles = [Line2D([], [], label=best, **BEST)]
    past = [len(each.axes) == 2 and not _goes_through_zero(found, _axes(each)) for each in shown]
    if not all(past):
        handles.append(Line2D([], [], label="as it stands", **NOW))
    if any(past):
        handles.append(Line2D([], [], label="as it stands, in front of or behind this slice", **ELSEWHERE))
    if mesh is not None:
        bar = figure.colorbar(mesh, ax=places, shrink=0.85, pad=0.02)
        bar.ax.tick_params(labelsize=8)
        ticks = [value for end in (low, high) for value in MaxNLocator(4).tick_values(0, end)]
        bar.set_ticks(sorted({float(value) for value in ticks if low <= value <= high}))
        bar.set_label("deepest less needed, worst hole [mm]", size=9)
        handles.append(Line2D([], [], color=style.INK, linewidth=2.0, label="within: every hole without a reversal"))
    style.legend_below(figure, handles, columns=2)
    return figure


def _axes(each: Slice) -> tuple[int, int]:
    one, two = (AXES.index(axis) for axis in each.axes)
    return one, two


def _goes_through_zero(found: Placement, axes: tuple[int, int]) -> bool:
    """Whether a slice goes through where the part stands, not only past it."""
    return not np.delete(found.place, axes).any()


def _map(axes: Axes, each: Slice, found: Placement, norm: TwoSlopeNorm) -> QuadMesh:
    x, y = (in_unit(axis, values) for axis, values in zip(each.axes, each.values, strict=True))
    margin = each.margin.T * 1e3
    mesh = axes.pcolormesh(x, y, margin, cmap="PuOr", norm=norm, shading="nearest")
    if margin.min() < 0 <= margin.max():
        axes.contour(x, y, margin, levels=[0.0], colors=[style.INK], linewidths=2.0, zorder=4)
    style.label(axes, *(LABELS[axis] for axis in each.axes))
    axes.tick_params(labelsize=8.5, color=style.MUTED, labelcolor=style.INK)
    one, two = _axes(each)
    if all(low - 1e-9 <= 0 <= high + 1e-9 for low, high in ((x[0], x[-1]), (y[0], y[-1]))):
        axes.plot(0, 0, clip_on=False, **(NOW if _goes_through_zero(found, (one, two)) else ELSEWHERE))
    axes.plot(in_unit(each.axes[0], found.place[one]), in_unit(each.axes[1], found.place[two]), clip_on=False, **BEST)
    others = [k for k, values in enumerate(found.grid) if k not in (one, two) and values.size > 1]
    if others:
        text = ", ".join(f"{AXES[k]} {float(in_unit(AXES[k], found.place[k])):.4g}" for k in others)
        axes.set_title(f"at {text}", size=9, color=style.INK, loc="left")
    return mesh


def _curve(axes: Axes, each: Slice, found: Placement) -> None:
    (axis,), (values,) = each.axes, each.values
    x, margin = in_unit(axis, values), each.margin * 1e3
    style.bare_axes(axes)
    style.label(axes, LABELS[axis], "deepest less needed, worst hole [mm]")
    axes.axhline(0, color=style.INK, linewidth=0.8)
    axes.plot(x, margin, "o-", color=style.JOINT_COLOURS[0], markersize=3.5, linewidth=2)
    axes.plot(in_unit(axis, found.place[AXES.index(axis)]), found.least * 1e3, **BEST)
    if x[0] - 1e-9 <= 0 <= x[-1] + 1e-9:
        axes.plot(0, float(found.as_it_stands.min()) * 1e3, clip_on=False, **NOW)
