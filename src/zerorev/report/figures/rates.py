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
from zerorev.report.figures import style
from zerorev.report.figures.field import critical, stuck_joints

__all__ = ["broken_at_poles", "critical_rates"]

SPIN_STEP = np.deg2rad(0.1)
BRACKET, BRACKETED = "#dcdcdc", "#3f3f3f"
FAR_OFF = 1e6  # [deg/mm] beyond every picture
BROADEST = 6.0  # brackets: critical rates farther out are named at the edge of the picture


def critical_rates(plan: Plan, hole: HolePlan) -> Figure:
    """The six critical twist rates [deg/mm] at the target against its spin [deg], on the chosen branch.

    The slopes of the two legs are the bracket; a joint whose critical rate lies outside it at the chosen spin reverses
    at the target.

    Args:
        plan: whose robot and tool move.
        hole: with a motion.

    Raises:
        InputError: the hole has no motion.
    """
    motion = style.motion_of(hole)
    profile, n = motion.profile, motion.profile.corner
    chosen = float(profile.psi[n])
    slopes = style.deg_per_mm(profile.twist_rate[[n - 1, n]])
    psi = chosen + np.arange(-np.pi, np.pi + SPIN_STEP / 2, SPIN_STEP)
    at = np.full_like(psi, profile.standoff[n])
    kappa, theta_psi = critical(plan, hole.hole, motion.branch, at, psi)
    here = critical(plan, hole.hole, motion.branch, at[:1], np.array([chosen]))[0][0]

    figure = style.new_figure("Critical twist rates at the target", plan, hole, height=5.6)
    axes = figure.subplots()
    style.bare_axes(axes)
    shown = _around(psi, ~np.isnan(kappa).all(axis=1), chosen)
    axes.set_xlim(*np.rad2deg(shown))
    low, high = _rate_range(slopes, here)
    axes.set_ylim(low, high)
    axes.axhline(0.0, color=style.MUTED, linewidth=0.8, zorder=1)
    axes.axhspan(*sorted(slopes), color=BRACKET, zorder=0.5, linewidth=0)
    for i in range(6):
        x, y = broken_at_poles(np.rad2deg(psi), kappa[:, i], theta_psi[:, i])
        axes.plot(x, y, color=style.JOINT_COLOURS[i], linestyle=style.DASHES[i], linewidth=2.0, zorder=3,
                  label=plan.robot.joint_names[i])  # fmt: skip
    bracketed = _bracketed(axes, psi, kappa, slopes)
    axes.axvline(np.rad2deg(chosen), color="black", linewidth=1.4, zorder=4)
    axes.annotate(f"ψ at the target {style.signed(np.rad2deg(chosen), 2)}°", (np.rad2deg(chosen), 1.01),
                  xycoords=("data", "axes fraction"), ha="center", va="bottom", size=9.5)  # fmt: skip
    _name_crossings(axes, plan, float(np.rad2deg(chosen)), here)
    _name_slopes(axes, slopes)
    axes.xaxis.set_major_locator(MaxNLocator(10, steps=[1, 2, 3, 4.5, 6, 9, 10]))
    style.label(axes, x="spin at the target ψ [deg]", y="critical twist rate dψ/ds [deg/mm]")
    style.legend_below(figure, _handles(plan, stuck_joints(theta_psi), bracketed), columns=4)
    return figure


def broken_at_poles(x: Array, kappa: Array, theta_psi: Array) -> tuple[Array, Array]:
    """The curve, broken where theta_psi changes sign: its ends run off along the asymptote, and no line joins them."""
    turns = np.flatnonzero((theta_psi[:-1] > 0) != (theta_psi[1:] > 0))
    turns = turns[np.isfinite(kappa[turns]) & np.isfinite(kappa[turns + 1])]
    share = theta_psi[turns] / (theta_psi[turns] - theta_psi[turns + 1])
    pole = x[turns] + share * (x[turns + 1] - x[turns])
    far = [np.where(np.abs(kappa[n]) > 0, np.sign(kappa[n]) * FAR_OFF, np.nan) for n in (turns, turns + 1)]
    y = np.where(np.isinf(kappa), np.nan, kappa)
    at = np.repeat(turns + 1, 3)
    gap = np.full_like(pole, np.nan)
    return (
        np.insert(x, at, np.column_stack([pole, pole, pole]).ravel()),
        np.insert(y, at, np.column_stack([far[0], gap, far[1]]).ravel()),
    )


def _around(psi: Array, reached: Any, chosen: float) -> tuple[float, float]:
    """The stretch of spins [rad] around the chosen one that the branch reaches, with a little margin."""
    at, lost = int(np.argmin(np.abs(psi - chosen))), np.flatnonzero(~reached)
    before, after = lost[lost < at], lost[lost > at]
    low = psi[before[-1]] if before.size else psi[0]
    high = psi[after[0]] if after.size else psi[-1]
    return float(low), float(high)


def _rate_range(slopes: Array, here: Array) -> tuple[float, float]:
    """Rates to show [deg/mm]: the bracket in the middle third or so, and the crossings that lie about it."""
    width = max(float(np.ptp(slopes)), 0.1)
    farthest = BROADEST * max(width, float(np.abs(slopes).max()))
    near = here[np.isfinite(here) & (np.abs(here - slopes.mean()) < farthest)]
    shown = np.concatenate([slopes, near])
    low, high = shown.min(), shown.max()
    pad = 0.55 * max(high - low, width)
    return float(low - pad), float(high + pad)


def _bracketed(axes: Axes, psi: Array, kappa: Array, slopes: Array) -> bool:
    """Mark along the foot the spins at which these slopes bracket all six; return whether there are any."""
    with np.errstate(invalid="ignore"):
        inside = ((kappa > slopes.min()) & (kappa < slopes.max())) | np.isnan(kappa)
    all_inside = inside.all(axis=1) & ~np.isnan(kappa).all(axis=1)
    axes.plot(np.rad2deg(psi), np.where(all_inside, 0.012, np.nan), color=BRACKETED, linewidth=6,
              transform=axes.get_xaxis_transform(), solid_capstyle="butt", zorder=5)  # fmt: skip
    return bool(all_inside.any())


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


def _handles(plan: Plan, stuck: tuple[int, ...], bracketed: bool) -> list[Any]:
    handles: list[Any] = [
        Line2D([], [], color=style.JOINT_COLOURS[i], linestyle=style.DASHES[i], linewidth=2.0,
               label=f"{name} stands still")
        for i, name in enumerate(plan.robot.joint_names)
        if i not in stuck
    ]  # fmt: skip
    handles.append(Patch(facecolor=BRACKET, label="between the legs: no reversal"))
    if bracketed:
        handles.append(Line2D([], [], color=BRACKETED, linewidth=5, label="spins where all six lie between"))
    return handles + style.no_effect(plan, stuck)
