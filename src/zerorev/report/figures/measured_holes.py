"""Measured holes beside the prediction of their plan: a picture, and a page that needs no network."""

from __future__ import annotations

import html

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from zerorev.cell.recordings.holes_predicted import FIGURES, Comparison
from zerorev.report.figures import style
from zerorev.report.figures.page import html_page, picture
from zerorev.report.figures.study import bars, name_holes
from zerorev.report.words.measured_holes import HEADS, beside_cells, beside_lines

__all__ = ["beside", "holes_page"]

PREDICTED, MEASURED = style.JOINT_COLOURS[0], style.INK


def beside(compared: Comparison) -> Figure:
    """Predicted range and measured value of each figure, hole by hole.

    Args:
        compared: with one hole or more.
    """
    subtitle = f"{len(compared.holes)} holes   |   predicted for a free tip: upper bounds, median and 5 to 95 %"
    figure = style.headed_figure("Measured holes beside their prediction", subtitle, 6.4)
    grid = figure.add_gridspec(2, 2)
    x = np.arange(float(len(compared.holes)))
    for n, name in enumerate(FIGURES):
        words, scale, _ = HEADS[name]
        axes = figure.add_subplot(grid[n // 2, n % 2])
        style.bare_axes(axes)
        style.label(axes, "hole" if n > 1 else "", words)
        rows = [figures[name] for figures in compared.holes.values()]
        bars(axes, x, np.array([row.predicted for row in rows]) * scale, PREDICTED, "s")
        measured = np.array([np.nan if row.measured is None else row.measured for row in rows]) * scale
        axes.plot(x, measured, "D", color=MEASURED, markersize=5.5, markerfacecolor="white", zorder=4, clip_on=False)
        axes.set_ylim(bottom=0)
        axes.set_xlim(-0.6, len(x) - 0.4)
        name_holes(axes, list(compared.holes))
    handles = [
        Line2D([], [], color=PREDICTED, marker="s", linestyle="none", label="predicted"),
        Line2D([], [], color=MEASURED, marker="D", markerfacecolor="white", linestyle="none", label="measured"),
    ]
    style.legend_below(figure, handles, 2)
    return figure


def holes_page(compared: Comparison, source: str, plan: str) -> str:
    """The page as HTML; the same holes make the same bytes.

    Args:
        compared: measured and predicted.
        source: of the measured holes.
        plan: that was drilled.
    """
    drawn = (
        picture(style.png(beside(compared)), "measured and predicted figures of each hole") if compared.holes else ""
    )
    said = "".join(f"<li>{html.escape(line.plain)}</li>\n" for line in beside_lines(compared))
    sections = [
        ("Figures", "Predicted: median [5th, 95th percentile]. Roundness: half the ovality.", _table(compared)),
        ("Picture", "", drawn or "Nothing to compare."),
        ("Notes", "", f"<ul>{said}</ul>"),
    ]
    return html_page("Measured holes", f"{source}, drilled as {plan}", sections, moving=False)


def _table(compared: Comparison) -> str:
    rows = [
        f"<tr><th>{html.escape(hole) if n == 0 else ''}</th><th>{html.escape(HEADS[name][0])}</th>"
        + "".join(f"<td>{html.escape(cell)}</td>" for cell in beside_cells(name, figure))
        + "</tr>\n"
        for hole, figures in compared.holes.items()
        for n, (name, figure) in enumerate(figures.items())
    ]
    head = "".join(f"<th>{name}</th>" for name in ("hole", "figure", "measured", "predicted", "measured is"))
    return f"<table><thead><tr>{head}</tr></thead><tbody>\n{''.join(rows)}</tbody></table>"
