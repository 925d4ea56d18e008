"""Figures of the reproduction that belong to no other part of the library: rates, shares, strokes, rotations."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from zerorev.model._arrays import Array
from zerorev.report.figures import style

__all__ = ["rotation_split", "strokes_beside", "success_rates", "trial_shares"]

EXACT = style.REVERSAL_COLOURS[0]  # it has no reversal
SWARM = style.MUTED


def rotation_split(rows: Sequence[tuple[str, str, float, float, object]]) -> Figure:
    """Rotation [deg] in plunge and retract of several motions, in the colour of their reversals.

    Args:
        rows: position, motion, rotation in the plunge [deg], in the retract [deg], reversals or None.
    """
    figure = style.headed_figure(
        "Where the tool turns", "left of the line in the plunge, right of it in the retract", 0.33 * len(rows) + 1.3
    )
    axes = figure.add_subplot()
    style.bare_axes(axes)
    axes.axvline(0, color=style.INK, linewidth=1.0, zorder=4)
    places = []
    for n, (_, _, plunge, retract, reversals) in enumerate(rows):
        y = -n - 0.6 * sum(rows[k][0] != rows[k - 1][0] for k in range(1, n + 1))
        places.append(y)
        if not isinstance(reversals, int):
            axes.annotate(f"cannot be run ({plunge:.0f}° and {retract:.0f}°)", (0, y), xytext=(5, 0),
                          textcoords="offset points", va="center", size=8.5, color=style.MUTED)  # fmt: skip
            continue
        colour = style.REVERSAL_COLOURS[min(reversals, 6)]
        axes.barh(y, [-plunge, retract], color=colour, edgecolor=style.INK, linewidth=0.5, height=0.72, zorder=3)
        axes.annotate(f"{reversals}", (retract, y), xytext=(5, 0), textcoords="offset points", va="center", size=8.5,
                      color=style.INK)  # fmt: skip
    axes.set_yticks(places, [f"{row[0]}: {row[1]}" for row in rows], size=8.5)
    axes.grid(axis="y", visible=False)
    most = max(max(row[2], row[3]) for row in rows if row[4] is not None)
    axes.set_xlim(-1.08 * most, 1.08 * most)
    axes.xaxis.set_major_formatter(lambda value, _: f"{abs(value):g}")
    style.label(axes, "rotation of the tool [deg]")
    return figure


def success_rates(names: Sequence[str], rates: Array, low: Array, high: Array, subtitle: str) -> Figure:
    """Share of runs that found zero [%], swarm with its interval beside the exact search.

    Args:
        names: of the positions, K of them.
        rates: share of runs [%], shape (K,).
        low: lower end of the interval [%], shape (K,).
        high: upper end [%], shape (K,).
        subtitle: how many runs.
    """
    figure = style.headed_figure("How often zero reversals are found", subtitle, 3.4)
    axes = figure.add_subplot()
    style.bare_axes(axes)
    y = -np.arange(len(names))
    axes.errorbar(
        rates,
        y,
        xerr=[rates - low, high - rates],
        fmt="o",
        color=SWARM,
        markersize=7,
        capsize=5,
        linewidth=1.6,
        label="swarm, with 95 % interval",
        zorder=3,
    )
    axes.plot(
        np.full(len(names), 100.0),
        y + 0.22,
        "D",
        color=EXACT,
        markersize=8,
        label="exact search",
        zorder=4,
        clip_on=False,
    )
    for value, at in zip(rates, y, strict=True):
        axes.annotate(f"{value:.0f} %", (value, at), xytext=(0, -14), textcoords="offset points", ha="center", size=9)
    axes.set_yticks(y, list(names), size=9.5)
    axes.set_ylim(y[-1] - 0.6, 0.6)
    axes.set_xlim(0, 103)
    style.label(axes, "share of runs that found zero reversals [%]")
    style.legend_below(figure, axes.get_legend_handles_labels()[0], columns=2)
    return figure


def trial_shares(names: Sequence[str], shares: Sequence[Array], kept: Sequence[Array], subtitle: str) -> Figure:
    """Share of the particles at zero [%] run by run, a box a trial: where they ended, and their own best.

    Args:
        names: of the trials.
        shares: of particles that end at zero, one array of runs a trial [%].
        kept: of particles whose own best is at zero [%].
        subtitle: how many runs.
    """
    figure = style.headed_figure("Share of the particles with zero reversals", subtitle, 4.6)
    axes = figure.add_subplot()
    style.bare_axes(axes)
    x = np.arange(len(names))
    for offset, values, colour in ((-0.19, shares, style.REVERSAL_COLOURS[0]), (0.19, kept, style.JOINT_COLOURS[5])):
        boxes = axes.boxplot(
            [*values],
            positions=x + offset,
            widths=0.32,
            patch_artist=True,
            manage_ticks=False,
            zorder=3,
            medianprops={"color": style.INK, "linewidth": 1.6},
            boxprops={"linewidth": 0.8, "edgecolor": style.INK},
            whiskerprops={"linewidth": 0.8},
            capprops={"linewidth": 0.8},
            flierprops={"marker": ".", "markersize": 4, "markeredgecolor": style.MUTED},
        )
        for box in boxes["boxes"]:
            box.set_facecolor(colour)
    axes.set_xticks(x, list(names), size=9)
    axes.set_ylim(-2, 102)
    style.label(axes, "trial of Table 3", "particles at zero reversals [%]")
    style.legend_below(
        figure,
        [
            Patch(facecolor=style.REVERSAL_COLOURS[0], edgecolor=style.INK, label="where the particle ended"),
            Patch(facecolor=style.JOINT_COLOURS[5], edgecolor=style.INK, label="the particle's own best"),
        ],
        columns=2,
    )
    return figure


def strokes_beside(rows: Sequence[tuple[str, float, Array, float, float]], subtitle: str) -> Figure:
    """Deepest strokes [mm]: the thesis', a swarm's with bisection run by run, zerorev's with straight and free legs.

    Args:
        rows: target, as printed [mm], by bisection with a swarm [mm], shape (runs,), straight legs, free legs [mm].
        subtitle: of how many runs.
    """
    names, thesis, found, exact, free = zip(*rows, strict=True)
    figure = style.headed_figure("Deepest stroke with zero reversals", subtitle, 0.62 * len(names) + 1.7)
    axes = figure.add_subplot()
    style.bare_axes(axes)
    y = -np.arange(len(names)).astype(float)
    for at, runs in zip(y, found, strict=True):
        spread = np.linspace(-0.16, 0.16, len(runs)) if len(runs) > 1 else np.zeros(1)
        axes.plot(runs, at + spread, "o", color=SWARM, markersize=4.5, alpha=0.75, zorder=3)
    for values, marker, colour, size in (
        (thesis, "x", style.INK, 9),
        (exact, "D", EXACT, 8),
        (free, ">", style.JOINT_COLOURS[2], 9),
    ):
        axes.plot(
            values, y, marker, color=colour, markersize=size, markeredgewidth=2 if marker == "x" else 0.5, zorder=4
        )
    axes.set_yticks(y, list(names), size=9.5)
    axes.set_ylim(y[-1] - 0.5, 0.5)
    axes.set_xlim(0, 1.06 * max(*free, *thesis, *(float(runs.max()) for runs in found)))
    style.label(axes, "deepest stroke [mm]")
    handles = [
        Line2D(
            [],
            [],
            linestyle="none",
            marker=marker,
            color=colour,
            label=name,
            markeredgewidth=2 if marker == "x" else 0.5,
        )
        for name, marker, colour in (
            ("thesis, as printed", "x", style.INK),
            ("a swarm with bisection, run by run", "o", SWARM),
            ("exact, straight legs", "D", EXACT),
            ("free legs", ">", style.JOINT_COLOURS[2]),
        )
    ]
    style.legend_below(figure, handles, columns=4)
    return figure
