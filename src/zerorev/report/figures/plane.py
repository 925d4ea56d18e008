"""The twist plane of the chosen branch, with the motion drawn in (theory §1)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap, LogNorm
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.patheffects import withStroke
from matplotlib.ticker import FuncFormatter, MaxNLocator, MultipleLocator

from zerorev.model._arrays import Array
from zerorev.model.plan import Event, HolePlan, Motion, Plan
from zerorev.model.strokes import each_stroke, shifted
from zerorev.motion.drilling import Drilling
from zerorev.report.figures import style
from zerorev.report.figures.loads import draw_loads
from zerorev.report.scene.field import Field, field

__all__ = ["twist_plane"]

STANDOFFS = 101
VISIBLE = 5e-4  # of the picture: what is smaller is not in the legend
NUMBERED = 6  # strokes in the legend
SAME_PLACE = 0.08  # of the path: reversals this close to each other are named together
SPIN_STEP = np.deg2rad(0.5)
LEAST_RANGE, MARGIN = 2 * np.pi, np.deg2rad(30)  # of spins that are shown
CAP = 10.0  # [deg/mm] twist spread from which on all is equally dear
FLOOR = 0.3  # [deg/mm]
TICKS = (0.3, 0.5, 0.7, 1.0, 1.5, 2.0, 3.0, 5.0, 7.0, 10.0)
# one quiet hue in even steps of lightness, so that the joints' colours stand out from it; dark is dear
SLATE = LinearSegmentedColormap.from_list("slate", ["#f4f6f9", "#d5dbe5", "#b7c1cf", "#9aa7ba", "#7e8ea5", "#647690"])
UNREACHED: dict[str, Any] = {"facecolor": "#fbfbfb", "edgecolor": "#b5b5b5", "hatch": "////", "linewidth": 0.0}
LIMITED: dict[str, Any] = {"facecolor": "#faf0d7", "edgecolor": "#c9a24a", "hatch": "..", "linewidth": 0.0}
SAME: dict[str, Any] = {"color": "black", "linewidth": 1.0, "linestyle": (0, (1, 2)), "zorder": 5}
LEG = {"color": "black", "linewidth": 2.8, "path_effects": [withStroke(linewidth=5.2, foreground="white")], "zorder": 6}


def twist_plane(plan: Plan, hole: HolePlan | str | None = None, *, ax: Axes | None = None) -> Figure:
    """Spin [deg] over the path from start to target and back out, the field on both sides the same.

    Behind the motion: the twist spread [deg/mm], which says where zero reversals are cheap; where the branch does not
    reach or a joint leaves its limits; the lines on which spin does not move a joint; and, where the robot's masses are
    known, thin lines on which the load of a joint changes its sign, as the joints turn on either leg.

    Of a hole of several strokes all of them, numbered where they turn round; those on another branch than the first one
    are only named, since the field is of one branch.

    Args:
        plan: whose robot and tool move.
        hole: of the plan, or its id, or that of a stroke; None: the first that has a motion.
        ax: to draw into; None: a figure with a heading.

    Raises:
        InputError: there is no such hole, or it has no motion.
    """
    hole = style.hole_of(plan, hole)
    strokes = _strokes(hole)
    drawn = [stroke for stroke in strokes if stroke.motion.branch == strokes[0].motion.branch]
    figure, axes = style.one_axes(ax, "Twist plane", style.hole_heading(plan, hole), 7.2)
    standoffs = np.concatenate([stroke.motion.profile.standoff for stroke in strokes])
    corner = standoffs.min()
    low, high = _spin_range(np.concatenate([stroke.motion.profile.psi for stroke in drawn]))
    patch = field(
        Drilling.of(plan, hole.hole), drawn[0].motion.branch,
        np.linspace(corner, standoffs.max(), STANDOFFS),
        np.linspace(low, high, int(np.ceil((high - low) / SPIN_STEP)) + 1),
    )  # fmt: skip
    # signed path distance from the corner [mm]: the plunge on the left, the retract on the right
    away = (patch.standoff - corner) * 1e3
    x, y = np.concatenate([-away[:0:-1], away]), np.rad2deg(patch.psi)
    image = _spread(axes, x, y, patch)
    limited = _regions(axes, x, y, patch)
    crossed = _sign_changes(axes, plan, x, y, patch)
    axes.axvline(0.0, color="black", linewidth=0.9, linestyle=":", zorder=5)
    for stroke in drawn:
        _legs(axes, plan, stroke, float(corner), numbered=len(strokes) > 1)
    _axes(axes, x, y, float(corner) * 1e3)
    loaded = draw_loads(axes, plan, hole, [stroke.motion for stroke in drawn], patch.standoff, patch.psi)
    bar = figure.colorbar(image, ax=axes, pad=0.02 if not crossed else 0.035, aspect=38, extend="max")
    bar.set_label("twist spread [deg/mm]: the least bracket for zero reversals", size=9.5, color=style.INK)
    bar.set_ticks([tick for tick in TICKS if image.norm.vmin <= tick <= CAP], minor=False)
    bar.set_ticks([], minor=True)
    bar.ax.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    bar.ax.tick_params(labelsize=8.5)
    bar.outline.set_visible(False)
    style.legend_below(figure, _handles(plan, strokes, patch, crossed, limited) + loaded, 4, ax)
    return figure


class _Stroke(NamedTuple):
    """A stroke of a hole, numbered from 1: its motion and reversals, stand-offs counted from the hole's own target."""

    number: int
    motion: Motion
    events: tuple[Event, ...]


def _strokes(hole: HolePlan) -> list[_Stroke]:
    """All strokes of a hole; of one that has no others its own motion."""
    found = []
    for number, answer in enumerate(each_stroke(hole), 1):
        up = hole.hole.depth - answer.hole.depth
        events = answer.score.events if answer.score else ()
        events = tuple(replace(event, standoff=event.standoff + up) for event in events)
        found.append(_Stroke(number, shifted(style.motion_of(answer), up), events))
    return found


def _spin_range(psi: Array) -> tuple[float, float]:
    """Spins to show [rad]: around the motion, whole turns or more, wherever the motion lies."""
    span = max(LEAST_RANGE, float(np.ptp(psi)) + 2 * MARGIN)
    middle = float(psi.max() + psi.min()) / 2
    return middle - span / 2, middle + span / 2


def _mirrored(values: Array) -> Array:
    """The field (S, P, ...) on both sides of the target, spins first: (P, 2 S - 1, ...)."""
    return np.swapaxes(np.concatenate([values[:0:-1], values]), 0, 1)


def _spread(axes: Axes, x: Array, y: Array, patch: Field) -> Any:
    spread = np.clip(_mirrored(patch.spread), FLOOR, CAP)
    finite = spread[np.isfinite(spread)]
    least = float(np.quantile(finite, 0.005)) if finite.size else FLOOR
    norm = LogNorm(min(max(least, FLOOR), CAP / 4), CAP)
    return axes.pcolormesh(x, y, np.ma.masked_invalid(spread), cmap=SLATE, norm=norm, shading="nearest",
                           rasterized=True, zorder=0)  # fmt: skip


def _regions(axes: Axes, x: Array, y: Array, patch: Field) -> list[int]:
    """Hatch what cannot be reached and, otherwise, what lies over a joint limit; return the joints whose limits."""
    over = patch.over_limit.any(axis=-1) & patch.reached
    for mask, look, order in ((over, LIMITED, 1), (~patch.reached, UNREACHED, 2)):
        if not mask.any():
            continue
        values = _mirrored(mask.astype(float))
        area = axes.contourf(x, y, values, levels=[0.5, 1.5], colors=[look["facecolor"]], hatches=[look["hatch"]],
                             zorder=order)  # fmt: skip
        area.set_edgecolor(look["edgecolor"])
        area.set_linewidth(0.0)
        axes.contour(x, y, values, levels=[0.5], colors=[look["edgecolor"]], linewidths=1.2, zorder=order)
    return [i for i in range(6) if (patch.over_limit[..., i] & patch.reached).mean() > VISIBLE]


def _sign_changes(axes: Axes, plan: Plan, x: Array, y: Array, patch: Field) -> list[int]:
    """Draw where theta_psi of a joint changes sign, name the lines at the edge; return the joints that have any."""
    crossed, ends = [], []
    for i in range(6):
        values = _mirrored(patch.theta_psi[..., i])
        if i in patch.stuck or not (np.nanmin(values, initial=np.inf) < 0 < np.nanmax(values, initial=-np.inf)):
            continue
        axes.contour(x, y, np.ma.masked_invalid(values), levels=[0.0], colors=[style.JOINT_COLOURS[i]],
                     linewidths=2.0, linestyles=[style.DASHES[i]], zorder=4).set_path_effects(style.CASING)  # fmt: skip
        crossed.append(i)
        edge = patch.theta_psi[-1, :, i]
        changes = ((edge[:-1] > 0) != (edge[1:] > 0)) & np.isfinite(edge[:-1] + edge[1:])
        for n in np.flatnonzero(changes):
            ends.append((float(y[n]), i))
    places = style.spread_out([end for end, _ in ends], 0.024 * (y[-1] - y[0]), y[0], y[-1])
    for place, (_, i) in zip(places, ends, strict=True):
        axes.annotate(plan.robot.joint_names[i], (1.014, place), xycoords=("axes fraction", "data"), size=8,
                      weight="bold", va="center", color=style.JOINT_INKS[i], annotation_clip=False,
                      parse_math=False)  # fmt: skip
    return crossed


def _legs(axes: Axes, plan: Plan, stroke: _Stroke, deepest: float, *, numbered: bool) -> None:
    """Draw the two legs of a stroke, over the distance from the deepest corner of all [m], and what is said of them."""
    profile = stroke.motion.profile
    n = profile.corner
    away, y = (profile.standoff - deepest) * 1e3, np.rad2deg(profile.psi)
    plunge, retract = -away[: n + 1], away[n:]
    axes.plot(plunge, y[: n + 1], label="plunge leg", **LEG)  # type: ignore[arg-type]
    axes.plot(retract, y[n:], label="retract leg", **LEG)  # type: ignore[arg-type]
    if away[n] > 0:  # the same place on both sides
        axes.plot([plunge[-1], retract[0]], y[[n, n]], label="same place", **SAME)
    for x, spins in ((plunge[:2], y[:2]), (retract[-2:], y[-2:])):
        middle, towards = x @ [0.5, 0.5], x @ [1 / 3, 2 / 3]
        axes.annotate("", (towards, spins @ [1 / 3, 2 / 3]), xytext=(middle, spins @ [0.5, 0.5]), zorder=7,
                      arrowprops={"arrowstyle": "-|>,head_width=0.42,head_length=0.75", "color": "black",
                                  "shrinkA": 0, "shrinkB": 0, "linewidth": 2.0})  # fmt: skip
    for x, spins in ((plunge[1:-1], y[1:n]), (retract[1:-1], y[n + 1 : -1])):
        if x.size:
            axes.plot(x, spins, "o", color="white", markeredgecolor="black", markersize=6, zorder=7)
    for x, k, marker, size, name in (
        (plunge[0], 0, "o", 9, "start"), (plunge[-1], n, "D", 8, "target"), (retract[-1], y.size - 1, "s", 8.5, "end"),
    ):  # fmt: skip
        axes.plot(x, y[k], marker, color="white", markeredgecolor="black", markeredgewidth=2.0, markersize=size,
                  zorder=8, clip_on=False, label=name)  # fmt: skip
        if numbered:
            continue
        axes.annotate(
            f"{name} {style.signed(y[k], 2)}°", (x, y[k]), textcoords="offset points", size=9.5, zorder=9,
            xytext=(9 if name != "end" else -9, _clear_of_legs(y, k)), ha="left" if name != "end" else "right",
            va="center", color="black", path_effects=[withStroke(linewidth=3.5, foreground="white")],
        )  # fmt: skip
    if numbered:
        axes.annotate(f"{stroke.number}", (plunge[-1], y[n]), textcoords="offset points", size=9.5, xytext=(0, 14),
                      ha="center", va="center", weight="bold", zorder=9,
                      path_effects=[withStroke(linewidth=3.5, foreground="white")])  # fmt: skip
    places = [
        float(plunge[-1]) if e.leg == "target" else (e.standoff - deepest) * (-1e3 if e.leg == "plunge" else 1e3)
        for e in stroke.events
    ]
    x, spins = np.concatenate([plunge, retract]), np.concatenate([y[: n + 1], y[n:]])
    _reversals(axes, plan, stroke.events, places, x, spins)


def _reversals(axes: Axes, plan: Plan, events: Sequence[Event], places: Sequence[float], x: Array, y: Array) -> None:
    """Mark the reversals on the legs, and name their joints; those that lie close together share one line of names."""
    clusters: list[list[int]] = []
    for k in np.argsort(places, kind="stable"):
        if clusters and places[k] - places[clusters[-1][-1]] < SAME_PLACE * (x[-1] - x[0]):
            clusters[-1].append(int(k))
        else:
            clusters.append([int(k)])
    for cluster in clusters:
        at = np.array([places[k] for k in cluster])
        axes.plot(at, np.interp(at, x, y), "X", markersize=9, color="black", markeredgecolor="white",
                  markeredgewidth=0.9, zorder=9, linestyle="none", label="reversals")  # fmt: skip
        names = dict.fromkeys(plan.robot.joint_names[events[k].joint - 1] for k in cluster)
        middle = float(at.mean())
        # to the left of the marker, and clear of the leg that comes from there
        here, before = np.interp([middle, middle - 0.05 * (x[-1] - x[0])], x, y)
        axes.annotate(
            " ".join(names), (middle, float(here)), textcoords="offset points", size=9, zorder=9,
            xytext=(-7, -15 if before >= here else 15), ha="right", va="center", color="black",
            weight="bold", path_effects=[withStroke(linewidth=3.5, foreground="white")], parse_math=False,
        )  # fmt: skip


def _clear_of_legs(y: Array, k: int) -> float:
    """How far above or below its marker a label goes [points], so that it does not lie on a leg."""
    neighbour = y[1] if k == 0 else y[k + 1] if k < y.size - 1 else y[-2]
    return 15.0 if neighbour <= y[k] else -15.0


def _axes(axes: Axes, x: Array, y: Array, corner: float) -> None:
    axes.set_xlim(x[0], x[-1])
    axes.set_ylim(y[0], y[-1])
    axes.tick_params(labelsize=8.5, color=style.MUTED, labelcolor=style.INK)
    axes.spines[:].set_color(style.MUTED)
    axes.spines[:].set_linewidth(0.8)
    axes.yaxis.set_major_locator(MultipleLocator(45))
    standoffs = [
        s
        for s in MaxNLocator(5, steps=[1, 2, 2.5, 5, 10]).tick_values(0, x[-1] + corner)
        if corner <= s <= x[-1] + corner + 1e-9
    ]
    ticks = {side * (s - corner): s for s in standoffs for side in (-1, 1) if s - corner > 0.04 * x[-1]}
    ticks[0.0] = corner
    axes.set_xticks(list(ticks), [f"{s:g}".replace("-", "−") for s in ticks.values()])
    style.label(axes, x="stand-off from the target [mm]", y="spin ψ [deg]")
    for place, text in ((0.25, "plunge →"), (0.5, "target"), (0.75, "retract →")):
        axes.annotate(text, (place, 1.008), xycoords="axes fraction", ha="center", va="bottom", size=9.5,
                      color=style.INK)  # fmt: skip


def _handles(plan: Plan, strokes: Sequence[_Stroke], patch: Field, crossed: list[int], limited: list[int]) -> list[Any]:
    names = plan.robot.joint_names
    handles: list[Any] = [
        Line2D([], [], color=style.JOINT_COLOURS[i], linewidth=2.0, linestyle=style.DASHES[i],
               label=f"spin does not move {names[i]}")
        for i in crossed
    ]  # fmt: skip
    words = "the planned motion" if len(strokes) == 1 else "the planned strokes"
    handles.append(Line2D([], [], color="black", linewidth=2.8, label=words))
    if others := [each for each in strokes if each.motion.branch != strokes[0].motion.branch]:
        numbers = ", ".join(str(each.number) for each in others[:NUMBERED]) + (", …" if others[NUMBERED:] else "")
        handles.append(Line2D([], [], linestyle="none", label=f"on another branch: {numbers}"))
    if any(stroke.events for stroke in strokes if stroke not in others):
        handles.append(Line2D([], [], color="black", marker="X", markersize=9, markeredgecolor="white",
                              linestyle="none", label="reversal"))  # fmt: skip
    if limited:
        handles.append(Patch(**LIMITED, label=f"over a joint limit ({', '.join(names[i] for i in limited)})"))
    if 1 - patch.reached.mean() > VISIBLE:
        handles.append(Patch(**UNREACHED, label="out of reach"))
    return handles + style.no_effect(plan, patch.stuck)
