"""A particle swarm in the cube of its spins, and what its particles are worth (thesis Figures 5, 7, 10 to 19)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from mpl_toolkits.mplot3d.axes3d import Axes3D

from zerorev.model._arrays import Array
from zerorev.report.figures import style
from zerorev.thesis.swarm import History, SwarmResult

__all__ = ["ascending_scores", "behaviour", "colours_of", "convergence", "paths", "trial"]

HALF_TURN = 180.0
FOOT = 0.05
BEST: dict[str, Any] = {
    "marker": "*",
    "linestyle": "none",
    "color": "none",
    "markeredgecolor": style.INK,
    "markeredgewidth": 1.3,
    "markersize": 17,
}
SPINS = ("ψs at start [deg]", "ψt at target [deg]", "ψe at end [deg]")


def colours_of(reversals: npt.NDArray[np.int64]) -> list[str]:
    """The colour of each count; -1 is a motion that cannot be run."""
    last = len(style.REVERSAL_COLOURS) - 1
    return [style.CANNOT_RUN if n < 0 else style.REVERSAL_COLOURS[min(n, last)] for n in reversals.tolist()]


def convergence(result: SwarmResult, iterations: Sequence[int], subtitle: str) -> Figure:
    """Where the particles are at some iterations (Fig. 10).

    Args:
        result: with its history.
        iterations: four of them.
        subtitle: of what run.
    """
    history = _history(result)
    figure = style.headed_figure("Particles of the swarm in the cube of spins", subtitle, 8.6)
    for k, iteration in enumerate(iterations):
        axes = figure.add_subplot(2, 2, k + 1, projection="3d")
        assert isinstance(axes, Axes3D)
        _cube(axes, history, min(iteration, len(history.scores) - 1))
    style.legend_below(figure, _legend(), columns=5)
    return figure


def ascending_scores(result: SwarmResult, subtitle: str) -> Figure:
    """The score of every particle where it ended, rising (Fig. 11)."""
    figure = style.headed_figure("Final scores of all particles", subtitle, 4.2)
    axes = figure.add_subplot()
    _scores(axes, result)
    style.legend_below(figure, _legend(best=False), columns=4)
    return figure


def trial(result: SwarmResult, title: str, subtitle: str) -> Figure:
    """The swarm at its beginning, midway and at its end, and its scores (Figs 12 to 19)."""
    history = _history(result)
    last = len(history.scores) - 1
    figure = style.headed_figure(title, subtitle, 7.6)
    for k, iteration in enumerate((0, last // 2, last)):
        axes = figure.add_subplot(2, 2, k + 1, projection="3d")
        assert isinstance(axes, Axes3D)
        _cube(axes, history, iteration)
    _scores(figure.add_subplot(2, 2, 4), result)
    style.legend_below(figure, _legend(), columns=5)
    return figure


def behaviour(result: SwarmResult, iterations: Sequence[int], names: Sequence[str], subtitle: str) -> Figure:
    """Particles with their next moves as arrows, seen along psi_e, at some iterations (Fig. 5).

    Args:
        result: with its history.
        iterations: which.
        names: what the swarm is doing there.
        subtitle: of what run.
    """
    history = _history(result)
    figure = style.headed_figure("From chaos to convergence", subtitle, 3.9)
    for k, (iteration, name) in enumerate(zip(iterations, names, strict=True)):
        axes = figure.add_subplot(1, len(iterations), k + 1)
        x, y, _ = np.rad2deg(history.positions[iteration]).T
        u, v, _ = np.rad2deg(history.positions[iteration + 1] - history.positions[iteration]).T
        axes.quiver(
            x, y, u, v, angles="xy", scale_units="xy", scale=1, width=0.004, color=style.MUTED, alpha=0.6, zorder=2
        )
        axes.scatter(
            x, y, s=20, c=colours_of(history.reversals[iteration]), edgecolors=style.INK, linewidths=0.4, zorder=3
        )
        _mark_best(axes, history, iteration)
        _square(axes, f"{name}: iteration {iteration}")
        style.label(axes, SPINS[0], SPINS[1] if k == 0 else "")
    style.legend_below(figure, _legend(), columns=5)
    return figure


def paths(runs: Sequence[tuple[str, SwarmResult]], particles: Sequence[int], subtitle: str) -> Figure:
    """The way of a few particles, and all of them at the end, for different weights (Fig. 7).

    Args:
        runs: a heading and a result with its history, each.
        particles: whose way is drawn.
        subtitle: of what runs.
    """
    figure = style.headed_figure("What the weights do to the particles", subtitle, 4.0)
    for k, (name, result) in enumerate(runs):
        history = _history(result)
        axes = figure.add_subplot(1, len(runs), k + 1)
        places = np.rad2deg(history.positions)
        axes.scatter(
            places[-1, :, 0],
            places[-1, :, 1],
            s=16,
            c=colours_of(history.reversals[-1]),
            edgecolors=style.INK,
            linewidths=0.3,
            zorder=2,
        )
        for n, particle in enumerate(particles):
            way = places[:, particle]
            colour = style.JOINT_INKS[n + 2]
            axes.plot(way[:, 0], way[:, 1], color=colour, linestyle=style.DASHES[n], linewidth=1.2, zorder=3)
            axes.plot(*way[0, :2], "o", color="white", markeredgecolor=colour, markersize=6, zorder=4)
            axes.plot(*way[-1, :2], "s", color=colour, markeredgecolor="white", markersize=6, zorder=4)
        _mark_best(axes, history, len(history.scores) - 1)
        _square(axes, name)
        style.label(axes, SPINS[0], SPINS[1] if k == 0 else "")
    ways = [
        Line2D(
            [],
            [],
            color=style.MUTED,
            marker="o",
            markerfacecolor="white",
            linewidth=1.2,
            label="a particle's way begins",
        ),
        Line2D([], [], color=style.MUTED, marker="s", linewidth=1.2, label="… and ends"),
    ]
    style.legend_below(figure, [*_legend(), *ways], columns=5)
    return figure


def _history(result: SwarmResult) -> History:
    assert result.history is not None, "a swarm is drawn from its history"
    return result.history


def _cube(axes: Axes3D, history: History, iteration: int) -> None:
    x, y, z = np.rad2deg(history.positions[iteration]).T
    # those without reversal drawn last, so that none of them is hidden
    order = np.argsort(-history.scores[iteration], kind="stable")
    colours = np.array(colours_of(history.reversals[iteration]))
    axes.scatter(
        x[order],
        y[order],
        z[order],
        s=22,
        c=colours[order].tolist(),
        edgecolors=style.INK,
        linewidths=0.35,
        depthshade=False,
    )
    best = np.rad2deg(_best_place(history, iteration))
    axes.plot(*best[:, None], **BEST, zorder=10)
    zero = int((history.reversals[iteration] == 0).sum())
    axes.set_title(f"iteration {iteration}: {zero} of {x.size} at zero", size=9.5, color=style.INK, y=0.98)
    for which, name in zip("xyz", SPINS, strict=True):
        getattr(axes, f"set_{which}lim")(-HALF_TURN, HALF_TURN)
        getattr(axes, f"set_{which}ticks")([-90, 0, 90])
        getattr(axes, f"set_{which}label")(name, size=8.5, color=style.INK, labelpad=2)
        getattr(axes, f"{which}axis").set_tick_params(labelsize=7, pad=-1)
        getattr(axes, f"{which}axis").pane.set_facecolor("#f7f7f7")
    axes.view_init(elev=22, azim=-52)
    axes.set_box_aspect(None, zoom=0.88)


def _scores(axes: Axes, result: SwarmResult) -> None:
    order = np.argsort(result.last.score, kind="stable")
    scores, colours = result.last.score[order], colours_of(result.last.reversals[order])
    # begun below 0, so that those at zero reversals, whose score is next to nothing, are seen
    axes.bar(
        np.arange(1, scores.size + 1),
        scores + FOOT,
        bottom=-FOOT,
        width=1.0,
        color=colours,
        edgecolor="white",
        linewidth=0.3,
    )
    style.bare_axes(axes)
    axes.set_xlim(0.5, scores.size + 0.5)
    axes.set_ylim(-FOOT, max(1.05, float(min(scores.max(), 3.0)) * 1.03))
    zero = int((result.last.reversals == 0).sum())
    axes.set_title(f"{zero} of {scores.size} particles end at zero reversals", size=9.5, color=style.INK, loc="left")
    style.label(axes, "particles by rising score [1]", "score, eq. 4.7 [1]")


def _best_place(history: History, iteration: int) -> Array:
    """Where the best motion up to an iteration was seen."""
    scores = history.scores[: iteration + 1]
    return np.asarray(history.positions[np.unravel_index(int(scores.argmin()), scores.shape)])


def _mark_best(axes: Axes, history: History, iteration: int) -> None:
    x, y, _ = np.rad2deg(_best_place(history, iteration))
    axes.plot(x, y, **BEST, zorder=6)


def _square(axes: Axes, title: str) -> None:
    style.bare_axes(axes)
    axes.set_title(title, size=9.5, color=style.INK, loc="left")
    for limits, ticks in ((axes.set_xlim, axes.set_xticks), (axes.set_ylim, axes.set_yticks)):
        limits(-HALF_TURN * 1.03, HALF_TURN * 1.03)
        ticks([-180, -90, 0, 90, 180])
    axes.set_aspect("equal")


def _legend(*, best: bool = True) -> list[Any]:
    last = len(style.REVERSAL_COLOURS) - 1
    names = [*(f"{n} reversal{'s' if n != 1 else ''}" for n in range(last)), f"{last} or more"]
    kinds: list[Any] = [
        Patch(facecolor=colour, edgecolor=style.INK, linewidth=0.4, label=name)
        for colour, name in zip((*style.REVERSAL_COLOURS, style.CANNOT_RUN), (*names, "cannot be run"), strict=True)
    ]
    return [*kinds, Line2D([], [], label="best seen so far", **{**BEST, "markersize": 10})] if best else kinds
