"""Search methods side by side: box plots of their scores, of the evaluations to the first zero, and of their time."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import FuncFormatter, MultipleLocator, NullFormatter

from zerorev.report.figures import style
from zerorev.thesis.compare import Comparison, Rescored, Summary
from zerorev.thesis.comparison import duration

__all__ = ["comparison_boxes"]

ROW = 0.27  # inches of a method
ABOVE_AND_BELOW = 0.75  # inches of a hole beside its methods
BOX = {
    "boxprops": {"facecolor": "#f3f3f3", "edgecolor": style.MUTED, "linewidth": 0.8},
    "medianprops": {"color": style.INK, "linewidth": 1.6},
    "whiskerprops": {"color": style.MUTED, "linewidth": 0.8},
    "capprops": {"color": style.MUTED, "linewidth": 0.8},
}


def comparison_boxes(comparison: Comparison) -> Figure:
    """One row of panels a hole: score by eq. 4.7 [1], evaluations to the first zero, time of a run [s].

    A box holds the middle half of the runs, its whiskers all of them; each run is a dot in the colour of its reversals.

    Args:
        comparison: with one run or more.
    """
    summaries = comparison.summaries()
    holes = [hole.id for hole in comparison.holes if any(each.hole == hole.id for each in summaries)]
    rows = [[each for each in summaries if each.hole == hole] for hole in holes]
    heights = [ABOVE_AND_BELOW + ROW * len(row) for row in rows]
    seeds = f"seeds: {len(comparison.seeds)}   |   a dot is a run, coloured by its reversals, evaluated exactly"
    robot = f"{comparison.job.robot.manufacturer} {comparison.job.robot.model}".strip() or comparison.job.robot.name
    figure = style.headed_figure(
        "Search methods on the same objective", f"{robot}   |   {seeds}", sum(heights) + style.HEADER + 0.45
    )
    grid = figure.add_gridspec(len(rows), 3, height_ratios=heights, width_ratios=(1.35, 1, 1))
    for k, (hole, row) in enumerate(zip(holes, rows, strict=True)):
        score, first, time = (figure.add_subplot(grid[k, j]) for j in range(3))
        _scores(score, row)
        _first_zeros(first, row, comparison.budget)
        _times(time, row, summaries)
        score.set_title(f"hole {hole}", size=10, weight="bold", color=style.INK, loc="left", parse_math=False)
        style.label(score, "score, eq. 4.7 [1]")
        style.label(first, "evaluations to first zero [1]")
        style.label(time, "time of a run [s]")
    style.legend_below(figure, _legend(comparison.runs), columns=8)
    return figure


def _scores(axes: Axes, row: Sequence[Summary]) -> None:
    _boxes(axes, row, [each.scores for each in row], names=True)
    worst = max(max(each.scores) for each in row)
    axes.set_xlim(-0.03, max(worst + 0.05, 2 / 7))
    for k in range(1, 8):  # the steps of eq. 4.7, from one count of reversals to the next
        if k / 7 < axes.get_xlim()[1]:
            axes.axvline(k / 7, color="#c9c9c9", linewidth=0.8, linestyle=(0, (2, 2)), zorder=1)
    axes.xaxis.set_major_locator(MultipleLocator(0.2))


def _first_zeros(axes: Axes, row: Sequence[Summary], budget: int) -> None:
    _boxes(axes, row, [each.first_zeros for each in row], names=False)
    axes.set_xscale("log")
    axes.set_xlim(0.8, budget * 1.3)
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:,.0f}"))
    for place, each in enumerate(row):
        missing = len(each.runs) - len(each.first_zeros)
        if all(run.outcome is not None and not run.outcome.evaluations for run in each.runs):
            text = "looks at legs, not at motions"
        elif missing == len(each.runs):
            text = "never"
        elif missing:
            text = f"{missing} never"
        else:
            continue
        axes.annotate(text, (0, place), xycoords=("axes fraction", "data"), xytext=(4, 0), textcoords="offset points",
                      va="center", size=7.5, color=style.MUTED, path_effects=style.CASING, zorder=5)  # fmt: skip


def _times(axes: Axes, row: Sequence[Summary], everywhere: Sequence[Summary]) -> None:
    _boxes(axes, row, [each.seconds for each in row], names=False)
    axes.set_xscale("log")
    times = [seconds for each in everywhere for seconds in each.seconds]
    axes.set_xlim(min(times) / 1.6, max(times) * 5)
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    for place, each in enumerate(row):
        axes.annotate(duration(float(np.median(each.seconds))), (max(each.seconds), place), xytext=(5, 0), size=7.5,
                      textcoords="offset points", va="center", color=style.MUTED)  # fmt: skip


def _boxes(axes: Axes, row: Sequence[Summary], values: Sequence[Sequence[float]], *, names: bool) -> None:
    """A box and its runs for each method, the first on top."""
    style.bare_axes(axes)
    for place, (summary, each) in enumerate(zip(row, values, strict=True)):
        if len(each) > 1:
            axes.boxplot([each], positions=[place], orientation="horizontal", widths=0.6, whis=(0, 100),
                         patch_artist=True, manage_ticks=False, **BOX)  # type: ignore[arg-type] # fmt: skip
        shown = [run for run in summary.runs if len(each) == len(summary.runs) or _first(run) is not None]
        # the same jitter every time
        height = place + (
            np.random.default_rng(0).uniform(-0.2, 0.2, len(each)) if len(each) > 1 else np.zeros(len(each))
        )
        axes.scatter(
            each, height, s=11, c=[_colour(run) for run in shown], edgecolors=style.INK, linewidths=0.3, zorder=4
        )
    axes.set_ylim(len(row) - 0.4, -0.6)
    axes.set_yticks(range(len(row)), [each.method for each in row] if names else [""] * len(row))
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.grid(visible=False, axis="y")


def _first(run: Rescored) -> int | None:
    return None if run.outcome is None else run.outcome.first_zero


def _colour(run: Rescored) -> str:
    if run.reversals is None:
        return style.CANNOT_RUN
    return style.REVERSAL_COLOURS[min(run.reversals, len(style.REVERSAL_COLOURS) - 1)]


def _legend(runs: Sequence[Rescored]) -> list[Patch | Line2D]:
    counts = sorted({min(run.reversals, 6) for run in runs if run.reversals is not None})
    labels = {0: "zero reversals", 6: "6 or more"}
    handles = [(style.REVERSAL_COLOURS[n], labels.get(n, str(n))) for n in counts]
    if any(run.reversals is None for run in runs):
        handles.append((style.CANNOT_RUN, "cannot be run"))
    marker = {"marker": "o", "linestyle": "none", "markeredgecolor": style.INK, "markeredgewidth": 0.3, "markersize": 5}
    return [Line2D([], [], color=colour, label=text, **marker) for colour, text in handles]  # type: ignore[arg-type]
