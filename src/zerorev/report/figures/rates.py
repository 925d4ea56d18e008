"""The critical twist rates at the target, and how the two legs bracket them (theory §2)."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from zerorev.model._arrays import Array
from zerorev.model.plan import HolePlan, Plan
from zerorev.model.strokes import each_stroke
from zerorev.motion.drilling import Drilling
from zerorev.report.figures import style
from zerorev.report.scene.bracket import Bracket, bracket

__all__ = ["critical_rates"]

SPIN_STEP = np.deg2rad(0.1)
BRACKET, BRACKETED = "#dcdcdc", "#3f3f3f"


def critical_rates(plan: Plan, hole: HolePlan | str | None = None, *, ax: Axes | None = None) -> Figure:
    """The six critical twist rates [deg/mm] at the target against its spin [deg], on the chosen branch.

    The slopes of the two legs are the bracket; a joint whose critical rate lies outside it at the chosen spin reverses
    at the target. Of a hole of several strokes the last one is drawn, which gets to the target; others by their ids.

    Args:
        plan: whose robot and tool move.
        hole: of the plan, or its id, or that of a stroke; None: the first that has a motion.
        ax: to draw into; None: a figure with a heading.

    Raises:
        InputError: there is no such hole, or it has no motion.
    """
    hole = each_stroke(style.hole_of(plan, hole))[-1]
    motion = style.motion_of(hole)
    rates = bracket(
        Drilling.of(plan, hole.hole), motion.profile, motion.branch, SPIN_STEP, plan.settings.of(hole.hole).creep
    )
    chosen, slopes, here = rates.chosen, rates.slopes, rates.here

    heading = style.hole_heading(plan, hole)
    figure, axes = style.one_axes(ax, "Critical twist rates at the target", heading, 5.6)
    style.bare_axes(axes)
    axes.set_xlim(*np.rad2deg(rates.reached))
    axes.set_ylim(*rates.rates)
    axes.axhline(0.0, color=style.MUTED, linewidth=0.8, zorder=1)
    axes.axhspan(*sorted(slopes), color=BRACKET, zorder=0.5, linewidth=0)
    for i in range(6):
        axes.plot(*rates.curve(i), color=style.JOINT_COLOURS[i], linestyle=style.DASHES[i], linewidth=2.0, zorder=3,
                  label=plan.robot.joint_names[i])  # fmt: skip
    _mark_bracketed(axes, rates)
    axes.axvline(np.rad2deg(chosen), color="black", linewidth=1.4, zorder=4)
    axes.annotate(f"ψ at the target {style.signed(np.rad2deg(chosen), 2)}°", (np.rad2deg(chosen), 1.01),
                  xycoords=("data", "axes fraction"), ha="center", va="bottom", size=9.5)  # fmt: skip
    _name_crossings(axes, plan, float(np.rad2deg(chosen)), here)
    _name_slopes(axes, slopes)
    axes.xaxis.set_major_locator(MaxNLocator(10, steps=[1, 2, 3, 4.5, 6, 9, 10]))
    style.label(axes, x="spin at the target ψ [deg]", y="critical twist rate dψ/ds [deg/mm]")
    style.legend_below(figure, _handles(plan, rates), 4, ax)
    return figure


def _mark_bracketed(axes: Axes, rates: Bracket) -> None:
    """Mark along the foot the spins at which these slopes bracket all six."""
    axes.plot(np.rad2deg(rates.psi), np.where(rates.all_between, 0.012, np.nan), color=BRACKETED, linewidth=6,
              transform=axes.get_xaxis_transform(), solid_capstyle="butt", zorder=5)  # fmt: skip


def _name_crossings(axes: Axes, plan: Plan, chosen: float, here: Array) -> None:
    """Mark where each joint's critical rate lies at the chosen spin, and name it beside."""
    low, high = axes.get_ylim()
    named = [i for i in range(6) if np.isfinite(here[i])]
    gap = 0.068 * (high - low)
    places = style.spread_out([np.clip(here[i], low, high) for i in named], gap, low + 0.7 * gap, high - 0.7 * gap)
    left, right = axes.get_xlim()
    # beside the line, on the side that has more room
    side = 1 if right - chosen > chosen - left else -1
    aside = chosen + side * 0.045 * (right - left)
    for i, place in zip(named, places, strict=True):
        colour, seen = style.JOINT_COLOURS[i], float(np.clip(here[i], low, high))
        beyond = "" if seen == here[i] else " ↑" if here[i] > high else " ↓"
        axes.annotate(
            f"{plan.robot.joint_names[i]}  {style.signed(here[i], 3)}{beyond}", (chosen, seen), xytext=(aside, place),
            size=9, color=style.INK, va="center", ha="left" if side > 0 else "right", parse_math=False, zorder=6,
            bbox={"boxstyle": "round,pad=0.25", "facecolor": "white", "edgecolor": colour, "linewidth": 1.5},
            arrowprops={"arrowstyle": "-", "color": colour, "linewidth": 1.5, "shrinkA": 0, "shrinkB": 0},
        )  # fmt: skip
        if not beyond:
            axes.plot(chosen, seen, "o", color=colour, markeredgecolor="white", markeredgewidth=1.2, markersize=9,
                      zorder=7, label=f"crossing {i + 1}")  # fmt: skip


def _name_slopes(axes: Axes, slopes: Array) -> None:
    low, high = axes.get_ylim()
    places = style.spread_out(list(slopes), 0.1 * (high - low))
    for slope, place, name in zip(slopes, places, ("plunge leg", "retract leg"), strict=True):
        axes.axhline(slope, color="black", linewidth=1.4, linestyle=(0, (5, 2)), zorder=2, label=name)
        axes.annotate(f"{name}\n{style.signed(slope, 3)}", (1.008, place), xycoords=("axes fraction", "data"), size=9,
                      va="center", annotation_clip=False)  # fmt: skip


def _handles(plan: Plan, rates: Bracket) -> list[Any]:
    handles: list[Any] = [
        Line2D([], [], color=style.JOINT_COLOURS[i], linestyle=style.DASHES[i], linewidth=2.0,
               label=f"{name} stands still")
        for i, name in enumerate(plan.robot.joint_names)
        if i not in rates.stuck
    ]  # fmt: skip
    handles.append(Patch(facecolor=BRACKET, label="between the legs: no reversal"))
    if rates.all_between.any():
        handles.append(Line2D([], [], color=BRACKETED, linewidth=5, label="spins where all six lie between"))
    return handles + style.no_effect(plan, rates.stuck)
