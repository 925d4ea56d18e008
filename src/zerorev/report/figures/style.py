"""How every figure looks: colours, sizes, heading, legend; and the few helpers that all of them share.

Only matplotlib's object interface is used, and every size is given to the artist itself, so that drawing neither reads
nor leaves behind any global state.

A figure with one axes may be drawn into axes of the caller's own: then it has no heading, and its legend lies below
those axes.
"""

from __future__ import annotations

import io
import warnings
from collections.abc import Sequence
from typing import Any, Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patheffects import AbstractPathEffect, withStroke

from zerorev.errors import InputError
from zerorev.model._arrays import Array
from zerorev.model.plan import HolePlan, Motion, Plan
from zerorev.model.strokes import each_stroke
from zerorev.report.scene.palette import (
    BASELINE_COLOUR,
    CANNOT_RUN,
    DASHES,
    INK,
    JOINT_COLOURS,
    JOINT_INKS,
    MUTED,
    REVERSAL_COLOURS,
    signed,
)
from zerorev.report.words.tables import branch_cell

__all__ = [
    "BASELINE_COLOUR",
    "CANNOT_RUN",
    "CASING",
    "DASHES",
    "INK",
    "JOINT_COLOURS",
    "JOINT_INKS",
    "MUTED",
    "REVERSAL_COLOURS",
    "bare_axes",
    "deg_per_mm",
    "headed_figure",
    "hole_heading",
    "hole_of",
    "hole_words",
    "label",
    "legend_below",
    "motion_of",
    "new_figure",
    "no_effect",
    "one_axes",
    "png",
    "signed",
    "spread_out",
]

CASING: list[AbstractPathEffect] = [withStroke(linewidth=2.6, foreground="white")]

WIDTH, DPI = 8.0, 150  # inches and dots per inch: 1200 px
HEADER = 0.62  # inches
BELOW_AXES = -0.16  # of their height: clear of the ticks and the label
TITLE_LENGTH = 48  # characters of a hole's id in a heading
IDS_NAMED = 8


class _Headed(Figure):
    """A figure that a notebook shows without pyplot."""

    def _repr_png_(self) -> bytes:
        return png(self)


def hole_of(plan: Plan, hole: HolePlan | str | None) -> HolePlan:
    """The hole that is meant, and that has a motion.

    Args:
        plan: with the hole.
        hole: one of its holes, or the id of one, or of a stroke; None: the first that has a motion.

    Raises:
        InputError: there is no such hole, or it has no motion to draw.
    """
    if isinstance(hole, str):
        strokes = (stroke for each in plan.holes for stroke in each_stroke(each))
        found = next((each for each in (*plan.holes, *strokes) if each.hole.id == hole), None)
    elif hole is None:
        found = next((each for each in plan.holes if each.motion is not None), None)
    else:
        found = hole
    if found is None:
        ids = ", ".join(each.hole.id for each in plan.holes[:IDS_NAMED] if each.motion is not None)
        what = "has no hole with a motion" if hole is None else f"has no hole '{hole}'"
        raise InputError(what, where=f"plan {plan.name}", accepted=ids or "a plan with a motion")
    motion_of(found)
    return found


def motion_of(hole: HolePlan) -> Motion:
    """The motion of a hole that has one.

    Raises:
        InputError: the hole is infeasible, so that there is nothing to draw.
    """
    if hole.motion is None:
        raise InputError("has no motion to draw", where=f"hole {hole.hole.id}", accepted="a planned or evaluated hole")
    return hole.motion


def new_figure(title: str, plan: Plan, hole: HolePlan, height: float) -> Figure:
    """An empty figure with its heading: what it shows, then robot, hole, branch and reversals.

    Args:
        title: what the figure shows.
        plan: whose robot is named.
        hole: which is named.
        height: of the figure [inches].
    """
    return headed_figure(title, hole_heading(plan, hole), height)


def headed_figure(title: str, subtitle: str, height: float) -> Figure:
    """An empty figure with two lines of heading.

    Args:
        title: what the figure shows.
        subtitle: of what.
        height: of the figure [inches].
    """
    figure = _Headed(figsize=(WIDTH, height), dpi=DPI, facecolor="white")
    FigureCanvasAgg(figure)
    below_heading = (0.005, 0.01, 0.99, 1 - HEADER / height - 0.01)
    figure.set_layout_engine("constrained", rect=below_heading, h_pad=0.05, w_pad=0.05)
    top, left = 1 - 0.1 / height, 0.13 / WIDTH
    figure.text(left, top, title, ha="left", va="top", size=12.5, weight="bold", color=INK)
    figure.text(left, top - 0.26 / height, subtitle, ha="left", va="top", size=9.5, color=MUTED,
                parse_math=False)  # fmt: skip
    return figure


def one_axes(
    ax: Axes | None, title: str, subtitle: str, height: float, projection: Literal["3d"] | None = None
) -> tuple[Figure, Axes]:
    """The given axes and their figure, or new axes in a figure with a heading.

    Args:
        ax: of the caller's own, or None.
        title: what a new figure shows.
        subtitle: of what.
        height: of a new figure [inches].
        projection: that the axes need; None: plane ones.

    Raises:
        InputError: the given axes have another projection.
    """
    if ax is None:
        figure = headed_figure(title, subtitle, height)
        return figure, figure.add_subplot(projection=projection)
    needed = projection or "rectilinear"
    if ax.name != needed:
        raise InputError(f"has the projection '{ax.name}'", where="ax", accepted=f"axes with projection='{needed}'")
    return ax.figure.figure, ax  # also where they lie in a part of a figure


def hole_heading(plan: Plan, hole: HolePlan) -> str:
    """Robot, hole, branch and reversals, in a line."""
    robot = f"{plan.robot.manufacturer} {plan.robot.model}".strip() or plan.robot.name
    return f"{robot}   |   {hole_words(hole)}"


def hole_words(hole: HolePlan) -> str:
    """Hole, its strokes if there are several, branch and reversals, in a line."""
    name = hole.hole.id if len(hole.hole.id) <= TITLE_LENGTH else f"{hole.hole.id[: TITLE_LENGTH - 1]}…"
    reversals = "?" if hole.score is None else str(hole.score.reversals)
    if hole.baseline is not None:
        reversals = f"{hole.baseline.reversals} at constant spin, {reversals} here"
    strokes = f"   |   {len(hole.strokes)} strokes" if hole.strokes else ""
    return f"hole {name}{strokes}   |   branch {branch_cell(hole)}   |   reversals: {reversals}"


def bare_axes(axes: Axes) -> None:
    """Thin left and bottom axes, small ticks, a faint grid behind everything."""
    axes.spines[["top", "right"]].set_visible(False)
    axes.spines[["left", "bottom"]].set_color(MUTED)
    axes.tick_params(labelsize=8.5, color=MUTED, labelcolor=INK, width=0.8)
    axes.grid(color="#e4e4e4", linewidth=0.6)
    axes.set_axisbelow(True)


def label(axes: Axes, x: str = "", y: str = "") -> None:
    """Axis labels, with their units."""
    axes.set_xlabel(x, size=9.5, color=INK)
    axes.set_ylabel(y, size=9.5, color=INK)


def legend_below(figure: Figure, handles: Sequence[Any], columns: int, ax: Axes | None = None) -> None:
    """One legend for the whole figure, under it; or under axes of the caller's own."""
    look: dict[str, Any] = {
        "handles": list(handles), "fontsize": 8.5, "frameon": False, "handlelength": 2.4, "columnspacing": 1.5,
        "labelcolor": INK,
    }  # fmt: skip
    if ax is None:
        legend = figure.legend(loc="outside lower center", ncols=columns, **look)
    else:
        legend = ax.legend(loc="upper center", bbox_to_anchor=(0.5, BELOW_AXES), ncols=min(columns, 2), **look)
    for text in legend.get_texts():
        text.set_parse_math(False)


def spread_out(places: Sequence[float], gap: float, low: float = -np.inf, high: float = np.inf) -> Array:
    """Places of labels, in the order given, moved as little apart as keeps them `gap` from each other.

    Args:
        places: where they belong.
        gap: least distance between two.
        low: no label below this.
        high: no label above this.
    """
    order = np.argsort(places, kind="stable")
    # neighbours that are too close become one block, centred on what its members wanted
    blocks: list[tuple[float, int]] = []  # centre, members
    for place in np.asarray(places, dtype=float)[order]:
        blocks.append((float(place), 1))
        while len(blocks) > 1:
            (below, m), (above, n) = blocks[-2:]
            if above - below >= gap * (m + n) / 2:
                break
            blocks[-2:] = [((below * m + above * n) / (m + n), m + n)]
    ranks = np.arange(len(order))
    spread = np.array([centre + gap * (k - (n - 1) / 2) for centre, n in blocks for k in range(n)])
    out = np.empty(len(order))
    out[order] = np.minimum(np.maximum(spread, low + gap * ranks), high - gap * ranks[::-1])
    return out


def no_effect(plan: Plan, joints: Sequence[int]) -> list[Any]:
    """What the legend says of joints (0..5) that spin does not move; nothing where there are none."""
    names = ", ".join(plan.robot.joint_names[i] for i in joints)
    return [Line2D([], [], linestyle="none", label=f"spin never moves {names}")] if joints else []


def deg_per_mm(rate: Array) -> Array:
    """[rad/m] -> [deg/mm]."""
    return np.asarray(np.rad2deg(rate) * 1e-3)


def png(figure: Figure) -> bytes:
    """The figure as the bytes of a PNG file."""
    buffer = io.BytesIO()
    with warnings.catch_warnings():
        # a hole may be called in letters that the font lacks; its picture is none the worse
        warnings.filterwarnings("ignore", message="Glyph .* missing from")
        figure.savefig(buffer, format="png", metadata={"Software": "zerorev"})
    return buffer.getvalue()
