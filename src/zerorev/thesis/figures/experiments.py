"""Figures of chapter 5: deviation and torque over path distance, joints over it, gains over what is not known."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from zerorev.cell.ensemble import Band, HoleStudy
from zerorev.model._arrays import Array
from zerorev.report.figures import style

__all__ = ["gains_over", "joints_over_path", "stray_beside", "torques_over_path"]

BASELINE, OPTIMISED = style.BASELINE_COLOUR, style.JOINT_COLOURS[0]


def stray_beside(hole: HoleStudy, recorded_mm: Sequence[float], title: str) -> Figure:
    """Deviation from the mean path [mm] by the encoders, baseline and published motion, what was recorded beside it.

    Args:
        hole: of a study.
        recorded_mm: greatest deviation of the thesis' baseline and optimised motion [mm].
        title: of the figure.
    """
    count = hole.deviation.shape[-1]
    figure = style.headed_figure(title, f"by the encoders, median and 5 to 95 % of {count} possible arms", 4.2)
    axes = figure.add_subplot()
    style.bare_axes(axes)
    axes.axvspan(-0.5, 0.5, color="#f4f4f4", zorder=0, linewidth=0)
    for name, colour, recorded in zip(("baseline", "plan"), (BASELINE, OPTIMISED), recorded_mm, strict=True):
        low, median, high = hole.profile[hole.motions.index(name), 0] * 1e3
        axes.fill_between(hole.path, low, high, color=colour, alpha=0.2, linewidth=0, zorder=2)
        axes.plot(hole.path, median, color=colour, linewidth=2.0, zorder=3)
        axes.hlines(recorded, -0.5, 0.5, color=colour, linestyle=":", linewidth=1.8, zorder=4)
    axes.set_xticks([-1, -0.5, 0, 0.5, 1], ["start", "", "turn", "", "end"])
    axes.set_ylim(bottom=0)
    style.label(axes, "path", "deviation from the mean path [mm]")
    handles = [
        Line2D([], [], color=BASELINE, linewidth=2.0, label="constant spin"),
        Line2D([], [], color=OPTIMISED, linewidth=2.0, label="published motion"),
        Line2D([], [], color=style.INK, linestyle=":", linewidth=1.8, label="greatest that the thesis recorded"),
    ]
    style.legend_below(figure, handles, 3)
    return figure


def torques_over_path(path: Sequence[Array], torques: Sequence[Array], names: Sequence[str], subtitle: str) -> Figure:
    """Torques of the drives [N m] over path distance [mm]: six axes, baseline and optimised motion.

    Args:
        path: of both motions [m].
        torques: of both [N m], shape (N, 6).
        names: of the joints.
        subtitle: of the figure.
    """
    return _six("Torques of the drives, on the side of the joint", subtitle, path, torques, names, "torque [Nm]")


def joints_over_path(path: Sequence[Array], joints: Sequence[Array], names: Sequence[str], subtitle: str) -> Figure:
    """Joint angles less those at the turn [deg] over path distance [mm]: six axes, baseline and optimised motion.

    Args:
        path: of both motions [m].
        joints: of both [rad], shape (N, 6).
        names: of the joints.
        subtitle: of the figure.
    """
    turned = [np.rad2deg(each - each[np.argmin(np.abs(own))]) for each, own in zip(joints, path, strict=True)]
    return _six("Joint angles, from those at the turn on", subtitle, path, turned, names, "angle [deg]")


def _six(
    title: str, subtitle: str, path: Sequence[Array], values: Sequence[Array], names: Sequence[str], unit: str
) -> Figure:
    figure = style.headed_figure(title, subtitle, 5.2)
    grid = figure.add_gridspec(2, 3)
    for joint, name in enumerate(names):
        axes = figure.add_subplot(grid[joint // 3, joint % 3])
        style.bare_axes(axes)
        axes.set_title(name, size=9.5, color=style.INK, loc="left")
        for own, each, colour in zip(path, values, (BASELINE, OPTIMISED), strict=True):
            axes.plot(own * 1e3, each[:, joint], color=colour, linewidth=1.4)
        style.label(axes, "path distance [mm]" if joint > 2 else "", unit if joint % 3 == 0 else "")
    handles = [
        Line2D([], [], color=colour, linewidth=2.0, label=label)
        for colour, label in ((BASELINE, "constant spin"), (OPTIMISED, "published motion"))
    ]
    style.legend_below(figure, handles, 2)
    return figure


def gains_over(values: Sequence[str], gains: Mapping[str, Sequence[Band]], title: str, subtitle: str, x: str) -> Figure:
    """Gains at the tool [%] over something that is varied: median and 5 to 95 %.

    Args:
        values: of what is varied, as ticks.
        gains: by position, one band a value, as shares.
        title: of the figure.
        subtitle: of the figure.
        x: what is varied.
    """
    figure = style.headed_figure(title, subtitle, 4.0)
    axes = figure.add_subplot()
    style.bare_axes(axes)
    handles = []
    for n, (name, bands) in enumerate(gains.items()):
        place = np.arange(len(values)) + (n - (len(gains) - 1) / 2) * 0.12
        median, low, high = np.array(bands).T * 100
        axes.errorbar(
            place, median, [median - low, high - median], fmt="o-", color=style.JOINT_COLOURS[n], capsize=2.5,
            linewidth=1.2, markersize=5,
        )  # fmt: skip
        handles.append(Line2D([], [], color=style.JOINT_COLOURS[n], marker="o", label=name))
    axes.axhline(0, color=style.MUTED, linewidth=0.8)
    axes.set_xticks(range(len(values)), list(values))
    axes.set_ylim(max(axes.get_ylim()[0], -150), 105)
    style.label(axes, x, "gain at the tool [%]")
    style.legend_below(figure, handles, len(handles))
    return figure
