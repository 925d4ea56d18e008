"""The deepest strokes of a job over the offset of its tool, and how much they leave over offset and angle."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import TwoSlopeNorm
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.projections.polar import PolarAxes
from matplotlib.ticker import MaxNLocator

from zerorev.model._arrays import Array
from zerorev.model.job import Job
from zerorev.placement.tool_offset import LeastOffset, OffsetCurve, offset_of
from zerorev.report.figures import style
from zerorev.report.words.answer import how_deep

__all__ = ["tool_offset"]

HOLES_NAMED = 6  # more are drawn alike, but for the worst
ANGLES_FOR_A_MAP = 3
ARC = 12  # chords of a cell
TOO_LITTLE = "#a84a00"
OWN: dict[str, Any] = {"marker": "^", "linestyle": "none", "color": style.INK, "markersize": 8, "zorder": 6}


def tool_offset(job: Job, curve: OffsetCurve, least: LeastOffset | None = None, *, ax: Axes | None = None) -> Figure:
    """Deepest stroke [mm] of each hole against e [mm] at one angle; with three angles or more, the margin over both.

    Args:
        job: whose robot, tool and holes they are.
        curve: what is drawn.
        least: whose angle is drawn and which is marked; None for the angle with the greatest margin.
        ax: to draw the strokes at one angle into; None: a figure with a heading.

    Raises:
        InputError: the axes are not plane ones.
    """
    robot = f"{job.robot.manufacturer} {job.robot.model}".strip() or job.robot.name
    whole_map = len(curve.angles) >= ANGLES_FOR_A_MAP and len(curve.offsets) > 1
    title = f"Deepest stroke over the tool's offset: {robot}, {job.tool.name}"
    if ax is not None or not whole_map:
        figure, curves = style.one_axes(ax, title, how_deep(job.settings), 4.6)
    else:
        figure = style.headed_figure(title, how_deep(job.settings), 4.6)
        grid = figure.add_gridspec(1, 2, width_ratios=(1.15, 1))
        curves, polar = figure.add_subplot(grid[0]), figure.add_subplot(grid[1], projection="polar")
        assert isinstance(polar, PolarAxes)
        _map(figure, polar, curve, least, offset_of(job.robot, job.tool))
    handles = _curves(curves, job, curve, least)
    style.legend_below(figure, handles, 5, ax)
    return figure


def _curves(axes: Axes, job: Job, curve: OffsetCurve, least: LeastOffset | None) -> list[Line2D]:
    """Draw one angle; what the legend explains."""
    best = int(np.argmax(curve.margin.max(axis=0)))
    j = best if least is None else int(np.argmin(np.abs(curve.angles - least.angle)))
    e, deepest, needed = curve.offsets * 1e3, curve.deepest[:, j] * 1e3, curve.needed * 1e3
    style.bare_axes(axes)
    style.label(axes, "offset e of the drill axis from the wrist centre [mm]", "deepest stroke [mm]")
    axes.set_title(f"angle {style.signed(np.rad2deg(curve.angles[j]), 0)} deg", size=9.5, color=style.INK, loc="left")
    named = len(job.holes) <= HOLES_NAMED
    handles: list[Line2D] = []
    for k, hole in enumerate(job.holes):
        colour = style.JOINT_COLOURS[k] if named else style.BASELINE_COLOUR
        dash = style.DASHES[k] if named else "-"
        (line,) = axes.plot(e, deepest[:, k], color=colour, linestyle=dash, linewidth=2.0 if named else 0.8, zorder=3)
        axes.axhline(needed[k], color=colour, linestyle=":", linewidth=1.3, zorder=2)
        if named:
            line.set_label(hole.id)
            handles.append(line)
    if not named:
        handles += _worst(axes, job, curve, j)
    handles.append(Line2D([], [], color=style.MUTED, linestyle=":", linewidth=1.3, label="depth needed"))
    if least is not None:
        axes.axvspan(e[0], least.offset * 1e3, color="#f6e3d6", zorder=0, linewidth=0)
        axes.axvline(least.offset * 1e3, color=TOO_LITTLE, linewidth=1.4, zorder=2)
        axes.annotate(f"least offset {least.offset * 1e3:.1f} mm", (least.offset * 1e3, 0.98), rotation=90, size=9,
                      xycoords=("data", "axes fraction"), xytext=(-4, 0), textcoords="offset points", ha="right",
                      va="top", color=TOO_LITTLE, path_effects=style.CASING, zorder=6)  # fmt: skip
    own, angle = offset_of(job.robot, job.tool)
    if curve.offsets[0] <= own <= curve.offsets[-1] and _same_angle(angle, float(curve.angles[j])):
        axes.plot(own * 1e3, 0, clip_on=False, **OWN)
    if curve.offsets[0] <= own <= curve.offsets[-1]:
        handles.append(Line2D([], [], label=f"the tool as it is: {own * 1e3:.4g} mm", **OWN))
    axes.set_xlim(e[0], e[-1] if len(e) > 1 else e[0] + 1)
    axes.set_ylim(0, 1.05 * max(deepest.max(), needed.max()))
    return handles


def _worst(axes: Axes, job: Job, curve: OffsetCurve, j: int) -> list[Line2D]:
    """The hole with the least margin at each offset, drawn over the others."""
    worst = (curve.deepest[:, j] - curve.needed).argmin(axis=1)
    there = curve.deepest[np.arange(len(worst)), j, worst] * 1e3
    (line,) = axes.plot(curve.offsets * 1e3, there, "o-", color=style.JOINT_COLOURS[3], markersize=3.5, zorder=4,
                        label="the hole with the least margin")  # fmt: skip
    return [line, Line2D([], [], color=style.BASELINE_COLOUR, linewidth=0.8, label=f"each of {len(job.holes)} holes")]


def _map(
    figure: Figure, axes: PolarAxes, curve: OffsetCurve, least: LeastOffset | None, own: tuple[float, float]
) -> None:
    """Least margin over all holes, radius e [mm]; the tool's own place besides."""
    margin = curve.margin * 1e3
    limit = max(1e-9, float(np.abs(margin).max()))
    edges_e, edges_a = _edges(curve.offsets * 1e3), _edges(curve.angles)
    edges_e[0] = max(0.0, edges_e[0])
    # the sides of a cell are chords: many narrow ones make an arc
    arcs = np.interp(np.arange(len(curve.angles) * ARC + 1) / ARC, np.arange(len(edges_a)), edges_a)
    norm = TwoSlopeNorm(0.0, -limit, limit)
    mesh = axes.pcolormesh(arcs, edges_e, np.repeat(margin, ARC, axis=1), cmap="PuOr", norm=norm)
    axes.grid(color="#bbbbbb", linewidth=0.4)
    axes.tick_params(labelsize=8, labelcolor=style.INK)
    if edges_a[-1] - edges_a[0] < 2 * np.pi - 1e-6:
        axes.set_thetamin(float(np.rad2deg(edges_a[0])))
        axes.set_thetamax(float(np.rad2deg(edges_a[-1])))
    axes.set_ylim(0, edges_e[-1])
    axes.yaxis.set_major_locator(MaxNLocator(4))
    axes.set_rlabel_position(float(np.rad2deg(edges_a[-1])))
    axes.set_title("margin of the worst hole over e and angle", size=9.5, color=style.INK)
    bar = figure.colorbar(mesh, ax=axes, shrink=0.75, pad=0.12)
    bar.ax.tick_params(labelsize=8)
    bar.set_label("deepest - needed [mm]", size=8.5)
    if least is not None:
        axes.plot(least.angle, least.offset * 1e3, "*", color=TOO_LITTLE, markeredgecolor="white", markersize=14)
    if own[0] * 1e3 <= edges_e[-1]:
        axes.plot(own[1], own[0] * 1e3, **OWN)


def _same_angle(one: float, other: float) -> bool:
    return bool(np.cos(one - other) > 1 - 1e-9)


def _edges(centres: Array) -> Array:
    """Bounds of the cells around rising places."""
    between = (centres[1:] + centres[:-1]) / 2
    first, last = centres[0] - (between[0] - centres[0]), centres[-1] + (centres[-1] - between[-1])
    return np.concatenate([[first], between, [last]])
