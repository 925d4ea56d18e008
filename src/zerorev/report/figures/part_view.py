"""The holes of a plan on their part, as they are drilled one after the other."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from zerorev.model._arrays import Array
from zerorev.model.plan import Plan, Transition
from zerorev.report.figures import style
from zerorev.report.words.hole_rows import Standing, standing
from zerorev.report.words.outcome import STANDINGS

__all__ = ["part_view"]

NAMED = 60  # holes whose ids can still be read
LONGEST = 14  # letters of an id in the picture
TITLE_LENGTH = 40
ALONE = 5.0  # [mm] around a hole that is the only one
AXES = "XYZ"
LOOKS: dict[Standing, dict[str, Any]] = {
    "zero": {"marker": "o", "color": "#0072b2", "markersize": 6},
    "reversals": {"marker": "D", "color": "#e69f00", "markersize": 7},
    "infeasible": {"marker": "X", "color": "#b2182b", "markersize": 9},
    "failed": {"marker": "s", "color": "#b2182b", "markersize": 7},
}
WAY: dict[str, Any] = {"color": style.MUTED, "linewidth": 0.9, "zorder": 1}
CHANGE: dict[str, Any] = {"color": "#d55e00", "linewidth": 1.6, "linestyle": (0, (4, 2)), "zorder": 2}


def part_view(plan: Plan) -> Figure:
    """The targets in the plane of the part frame in which they are spread most [mm], and the way from one to the next.

    Args:
        plan: whose holes are shown.
    """
    targets = np.array([hole.hole.target for hole in plan.holes])
    places = (targets - plan.T_base_part[:3, 3]) @ plan.T_base_part[:3, :3] * 1e3
    right, up = sorted(np.argsort(-np.ptp(places, axis=0), kind="stable")[:2].tolist())
    flat = places[:, [right, up]]
    low, high = _view(plan, flat)
    wide, tall = high - low
    alone = wide == tall == 2 * ALONE
    title = plan.name if len(plan.name) <= TITLE_LENGTH else f"{plan.name[: TITLE_LENGTH - 1]}…"
    height = 1.6 if alone else float(np.clip(6.4 * tall / wide, 1.6, 6.4))
    figure = style.headed_figure(f"Holes on the part: {title}", _heading(plan), 1.6 + height)
    for text in figure.texts:
        text.set_parse_math(False)
    axes = figure.add_subplot()
    style.bare_axes(axes)
    axes.set_aspect("equal", adjustable="box")
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))
    where = {hole.hole.id: place for hole, place in zip(plan.holes, flat, strict=True)}
    handles = _way(axes, plan, where)
    stands = [standing(hole) for hole in plan.holes]
    for kind, look in LOOKS.items():
        of_kind = flat[[stand == kind for stand in stands]]
        if len(of_kind):
            axes.plot(*of_kind.T, linestyle="none", zorder=3, markeredgecolor="white", **look)
            label = f"{len(of_kind)} {STANDINGS[kind]}"
            outside = int(((of_kind < low) | (of_kind > high)).any(axis=1).sum())
            label += f", {outside} outside the picture" if outside else ""
            handles.append(Line2D([], [], linestyle="none", markeredgecolor="white", label=label, **look))
    if len(plan.holes) <= NAMED:
        for name, place in where.items():
            shown = name if len(name) <= LONGEST else f"{name[: LONGEST - 1]}…"
            axes.annotate(shown, place, xytext=(5, 4), textcoords="offset points", size=7, color=style.INK,
                          parse_math=False, zorder=4, annotation_clip=True)  # fmt: skip
    style.label(axes, f"{AXES[right]} of the part frame [mm]", f"{AXES[up]} of the part frame [mm]")
    style.legend_below(figure, handles, columns=4)
    return figure


def _view(plan: Plan, flat: Array) -> tuple[Array, Array]:
    """Least and greatest coordinates of the picture, shape (2,) each; holes out of reach do not widen it."""
    shown = flat[[hole.motion is not None for hole in plan.holes]]
    shown = shown if len(shown) else flat
    low, high = shown.min(axis=0), shown.max(axis=0)
    edge = max(ALONE, 0.12 * float((high - low).max()))
    return low - edge, high + edge


def _heading(plan: Plan) -> str:
    robot = f"{plan.robot.manufacturer} {plan.robot.model}".strip() or plan.robot.name
    return f"{robot}   |   {plan.tool.name}   |   {len(plan.holes)} hole{'' if len(plan.holes) == 1 else 's'}"


def _way(axes: Any, plan: Plan, where: dict[str, Array]) -> list[Line2D]:
    """The moves between holes, those that change the posture apart; and what the legend says of them."""
    between = [move for move in plan.transitions if move.start in where and move.to in where]
    handles = []
    for changes, look, words in ((False, WAY, "move between holes"), (True, CHANGE, "with a change of posture")):
        moves = [move for move in between if move.changes_posture == changes]
        for move in moves:
            axes.plot(*_ends(move, where).T, **look)
        if moves:
            handles.append(Line2D([], [], label=words, **{key: look[key] for key in look if key != "zorder"}))
    if between and between[0].start is not None:
        axes.plot(*where[between[0].start], marker="o", markersize=13, markerfacecolor="none", zorder=2,
                  markeredgecolor=style.INK, linestyle="none")  # fmt: skip
        handles.append(Line2D([], [], marker="o", markersize=10, markerfacecolor="none", linestyle="none",
                              markeredgecolor=style.INK, label="first hole"))  # fmt: skip
    return handles


def _ends(move: Transition, where: dict[str, Array]) -> Array:
    assert move.start is not None
    assert move.to is not None
    return np.array([where[move.start], where[move.to]])
