"""Pictures of a study: deviation and torques along the path, what each hole gains, and the holes left."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from zerorev.cell.ensemble import ENDS, SIDES, HoleStudy, band
from zerorev.files.output import make_folder, write_bytes
from zerorev.model._arrays import Array
from zerorev.report.figures import style
from zerorev.report.scene.study_curves import DRAWN, SIDE_WORDS, Banded, stray_curve, torque_curve
from zerorev.report.words.study import NAMES

__all__ = ["bars", "drilled_holes", "drive_torques", "name_holes", "study_gains", "tip_deviation", "write_figures"]

COLOURS = {"baseline": style.BASELINE_COLOUR, "plan": style.JOINT_COLOURS[0]}
MOST_NAMED = 12  # holes that are named below an axis


def tip_deviation(hole: HoleStudy) -> Figure:
    """Distance of the tip from its mean path [mm] over the path, of plan and constant spin: median and 5 to 95 %.

    Args:
        hole: of a study.
    """
    subtitle = f"hole {hole.id[: style.TITLE_LENGTH]}   |   median and 5 to 95 % of {hole.sets} possible arms"
    figure = style.headed_figure("How far the tip strays from its mean path", subtitle, 4.4)
    grid = figure.add_gridspec(1, 2)
    axes = [figure.add_subplot(grid[0, 0])]
    axes.append(figure.add_subplot(grid[0, 1], sharey=axes[0]))
    for k, (ax, side) in enumerate(zip(axes, SIDES, strict=True)):
        style.bare_axes(ax)
        ax.set_title(SIDE_WORDS[side], size=9.5, color=style.INK, loc="left")
        style.label(ax, "path, from the start over the turn to the end", "deviation [mm]" if k == 0 else "")
        ax.axvspan(-0.5, 0.5, color="#f4f4f4", zorder=0, linewidth=0)
        for motion in DRAWN:
            _draw(ax, stray_curve(hole, motion, side), COLOURS[motion])
        ax.set_ylim(bottom=0)
    style.legend_below(figure, _handles(), 2)
    return figure


def drive_torques(hole: HoleStudy, names: Sequence[str]) -> Figure:
    """Torques of the drives [N m] over the path, of plan and constant spin: median and 5 to 95 %; six axes.

    Args:
        hole: of a study.
        names: of the joints.
    """
    subtitle = f"hole {hole.id[: style.TITLE_LENGTH]}   |   median and 5 to 95 % of {hole.sets} possible arms"
    figure = style.headed_figure("Torques of the drives, on the side of the joint", subtitle, 5.6)
    grid = figure.add_gridspec(2, 3)
    for joint, name in enumerate(names):
        ax = figure.add_subplot(grid[joint // 3, joint % 3])
        style.bare_axes(ax)
        ax.set_title(name, size=9.5, color=style.INK, loc="left").set_parse_math(False)
        ax.axhline(0, color=style.MUTED, linewidth=0.8, zorder=1)
        for motion in DRAWN:
            curve = torque_curve(hole, motion, joint)
            _draw(ax, curve, COLOURS[motion])
            ax.plot(curve.changes, np.zeros_like(curve.changes), "o", color=COLOURS[motion], markersize=6,
                    markerfacecolor="white", markeredgewidth=1.6, zorder=4)  # fmt: skip
        style.label(ax, "", "torque [Nm]" if joint % 3 == 0 else "")
    changes = Line2D(
        [], [], color=style.INK, marker="o", linestyle="none", markerfacecolor="white", label="changes sign"
    )
    style.legend_below(figure, [*_handles(), changes], 3)
    return figure


def _draw(ax: Axes, curve: Banded, colour: str) -> None:
    ax.fill_between(curve.path, curve.low, curve.high, color=colour, alpha=0.2, linewidth=0, zorder=2)
    ax.plot(curve.path, curve.median, color=colour, linewidth=2.0, zorder=3)
    ax.set_xticks([-1, 0, 1], ["start", "turn", "end"])


def _handles() -> list[Line2D]:
    return [Line2D([], [], color=COLOURS[motion], linewidth=2.0, label=NAMES[motion]) for motion in DRAWN]


def study_gains(studied: Sequence[HoleStudy], *, ax: Axes | None = None) -> Figure:
    """What the plan gains at each hole [%], by the encoders and at the tool: median and 5 to 95 %.

    Args:
        studied: holes, one or more.
        ax: to draw into; None: a figure with a heading.

    Raises:
        InputError: the axes are not plane ones.
    """
    subtitle = f"{len(studied)} holes   |   less deviation than at constant spin, median and 5 to 95 %"
    figure, axes = style.one_axes(ax, "What the plan gains", subtitle, 4.4)
    style.bare_axes(axes)
    style.label(axes, "hole", "gain [%]")
    colours = style.JOINT_COLOURS[0], style.JOINT_COLOURS[1]
    for k in range(len(SIDES)):
        bands = np.array([band(hole.gain()[k]) for hole in studied]) * 100
        x = np.arange(len(studied)) + (k - 0.5) * 0.24
        bars(axes, x, bands, colours[k], "os"[k])
    axes.axhline(0, color=style.MUTED, linewidth=0.8)
    axes.set_ylim(max(axes.get_ylim()[0], -120), 105)
    name_holes(axes, [hole.id for hole in studied])
    handles = [
        Line2D([], [], color=colours[k], marker="os"[k], linestyle="none", label=SIDE_WORDS[side])
        for k, side in enumerate(SIDES)
    ]
    style.legend_below(figure, handles, 2, ax)
    return figure


def drilled_holes(studied: Sequence[HoleStudy]) -> Figure:
    """Position, tilt and ovality of the holes that a free tip leaves, of plan and constant spin: median and 5 to 95 %.

    Args:
        studied: holes, one or more.
    """
    subtitle = f"{len(studied)} holes   |   a free tip, which no hole guides: upper bounds, median and 5 to 95 %"
    figure = style.headed_figure("The holes that are left", subtitle, 6.4)
    grid = figure.add_gridspec(2, 2)
    panels: tuple[tuple[str, Callable[[HoleStudy, int], Array], float], ...] = (
        ("position [mm]", lambda hole, row: hole.position[row], 1e3),
        ("tilt [deg]", lambda hole, row: hole.tilt[row], float(np.rad2deg(1.0))),
        *(
            (f"ovality at the {end} [mm]", lambda hole, row, k=k: hole.ovality[row, k], 1e3)
            for k, end in enumerate(ENDS)
        ),
    )
    for n, (words, figure_of, scale) in enumerate(panels):
        axes = figure.add_subplot(grid[n // 2, n % 2])
        style.bare_axes(axes)
        style.label(axes, "hole" if n > 1 else "", words)
        for k, motion in enumerate(DRAWN):
            bands = np.array([band(figure_of(hole, hole.of(motion))) for hole in studied]) * scale
            x = np.arange(len(studied)) + (k - 0.5) * 0.24
            bars(axes, x, bands, COLOURS[motion], "os"[k])
        axes.set_ylim(bottom=0)
        name_holes(axes, [hole.id for hole in studied])
    handles = [
        Line2D([], [], color=COLOURS[motion], marker="os"[k], linestyle="none", label=NAMES[motion])
        for k, motion in enumerate(DRAWN)
    ]
    style.legend_below(figure, handles, 2)
    return figure


def bars(axes: Axes, x: npt.NDArray[np.floating], bands: npt.NDArray[np.floating], colour: str, marker: str) -> None:
    """Medians with bars from the 5th to the 95th percentile; bands of shape (n, 3)."""
    away = np.abs(bands[:, [1, 2]] - bands[:, [0]]).T
    axes.errorbar(x, bands[:, 0], away, fmt=marker, color=colour, capsize=2.5, linewidth=1.2, markersize=5)


def name_holes(axes: Axes, ids: Sequence[str]) -> None:
    """Ids below the axes, where they are few."""
    if len(ids) <= MOST_NAMED:
        axes.set_xticks(range(len(ids)), [each[:16] for each in ids])
        for tick in axes.get_xticklabels():
            tick.set_parse_math(False)


def write_figures(studied: Sequence[HoleStudy], names: Sequence[str], folder: Path) -> list[Path]:
    """Write the pictures of a study; what is there of the same name is replaced.

    Args:
        studied: holes, one or more.
        names: of the joints.
        folder: made, if its parent exists.

    Returns:
        the files.
    """
    make_folder(folder)
    files = [folder / "gains.png", folder / "holes.png"]
    write_bytes(files[0], style.png(study_gains(studied)))
    write_bytes(files[1], style.png(drilled_holes(studied)))
    for number, hole in enumerate(studied, start=1):
        stem = re.sub(r"[^A-Za-z0-9.-]+", "_", hole.id).strip("._")[:40]
        for name, figure in (("stray", tip_deviation(hole)), ("torques", drive_torques(hole, names))):
            files.append(folder / f"{name}_{number:03d}_{stem}.png")
            write_bytes(files[-1], style.png(figure))
    return files
