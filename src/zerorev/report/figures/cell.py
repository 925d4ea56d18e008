"""The robot and the targets in the cell (thesis Fig. 25), and what one target allows by direction: a rose."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d import Axes3D

from zerorev.maps.answers import Field
from zerorev.model._arrays import Array
from zerorev.report.figures import style
from zerorev.report.figures.workspace_map import ROBOT_COLOUR, capital, colours_of, dress_cell, grey_legend, value_bar

__all__ = ["direction_rose", "named_direction", "robot_in_cell"]

MOST_TARGETS = 4000
RINGS = (30, 60, 90, 120, 150)  # [deg] from the middle of a rose
PIXELS = 500  # of a rose, each way
MOST_NUMBERS = 30  # directions or targets that have something written beside them
NEAR = 0.9  # of the usual distance between two directions: so far does each speak for its surroundings


def robot_in_cell(
    cells: Field,
    subtitle: str,
    robots: Sequence[tuple[str, Array]],
    named: Sequence[str] = (),
    ax: Axes | None = None,
) -> Figure:
    """The targets of a map in the cell, coloured by their best direction, and the robot as a few lines.

    Args:
        cells: of a map.
        subtitle: of the map.
        robots: what each posture is called, and its places along the arm [mm], shape (P, 3); the first is at home.
        named: names of the targets, one per target, or none; where there are many they are left out.
        ax: to draw into, in 3D; None: a figure with a heading.
    """
    figure, axes = style.one_axes(ax, "Targets in the robot's cell", subtitle, 6.6, "3d")
    assert isinstance(axes, Axes3D)
    axes.computed_zorder = False
    every = -(-len(cells.target) // MOST_TARGETS)
    target, best = cells.target[::every], cells.best[::every]
    cmap, norm = colours_of(cells.quantity, best)
    size = float(np.clip(4000 / len(target), 4, 60))
    lost = np.isnan(best)
    axes.scatter(*target[lost].T, s=size / 2, color=style.CANNOT_RUN, depthshade=False, edgecolors="none", zorder=2)
    axes.scatter(*target[~lost].T, s=size, c=cmap(norm(best[~lost])), depthshade=False, edgecolors="none", zorder=3)
    for n, (name, places) in enumerate(robots):
        pale: dict[str, Any] = {"alpha": 0.45, "linestyle": "--"} if n == 0 and len(robots) > 1 else {}
        axes.plot(*places.T, color=ROBOT_COLOUR, linewidth=2.6, marker="o", markersize=4, zorder=4, label=name, **pale)
    for name, place in zip(named, target, strict=True) if len(named) == len(target) <= MOST_NUMBERS else ():
        axes.text(*place, f"  {name}", size=9, color=style.INK, zorder=5, parse_math=False, path_effects=style.CASING)
    dress_cell(axes, np.vstack([target, *(places for _, places in robots), np.zeros((1, 3))]))
    value_bar(figure, cells.quantity, cmap, norm, axes, shrink=0.6, pad=0.08)
    lines = [line for line in axes.get_lines() if not str(line.get_label()).startswith("_")]
    grey_legend(figure, cells.quantity, lines, ax)
    return figure


def direction_rose(cells: Field, row: int, subtitle: str, ax: Axes | None = None) -> Figure:
    """What a target allows by direction of the drill, on a disc that keeps areas.

    In the middle is the mean of the directions, or +X where they are all round; the distance from there is the angle to
    it. Each direction is a dot, and speaks for its surroundings.

    Args:
        cells: of a map with several directions.
        row: of the target.
        subtitle: of the map.
        ax: to draw into; None: a figure with a heading.
    """
    place = ", ".join(f"{value + 0.0:g}" for value in cells.target[row]).replace("-", "−")
    quantity, value = cells.quantity, cells.value[row]
    title = f"{capital(quantity.title)} at ({place}) mm, by direction"
    figure, axes = style.one_axes(ax, title, subtitle, 6.6)
    middle, right, up = _frame(cells.direction)
    cmap, norm = colours_of(quantity, cells.value)
    angles = np.degrees(np.arccos(np.clip(cells.direction @ middle, -1.0, 1.0)))
    reach = 180.0 if angles.max() > 100 else float(min(180.0, angles.max() + _spacing(cells.direction) / 2))
    radius = 2 * np.sin(np.radians(reach) / 2)
    axes.imshow(
        _surroundings(cells.direction, value, (middle, right, up), reach, cmap, norm), origin="lower",
        extent=(-radius, radius, -radius, radius), interpolation="nearest", zorder=1,
    )  # fmt: skip
    x, y = _on_disc(cells.direction, middle, right, up)
    lost = np.isnan(value)
    axes.plot(x[~lost], y[~lost], ".", color=style.INK, markersize=4, zorder=3)
    axes.plot(x[lost], y[lost], "x", color=style.INK, markersize=5, markeredgewidth=1.0, zorder=3)
    turn = np.linspace(0, 2 * np.pi, 200)
    inner = [ring for ring in RINGS if ring < reach - 5]
    for ring in (*inner, reach):
        r = 2 * np.sin(np.radians(ring) / 2)
        axes.plot(r * np.cos(turn), r * np.sin(turn), color=style.MUTED, linewidth=0.7, zorder=2)
        if ring in inner[:4]:  # further out the rings crowd
            free = np.hypot(r * np.cos(turn) - x[:, None], r * np.sin(turn) - y[:, None] - 0.03 * radius).min(axis=0)
            at = turn[free.argmax()]
            axes.annotate(f"{ring:.0f}°", (r * np.cos(at), r * np.sin(at)), size=8.5, color=style.INK, zorder=4,
                          ha="center", va="center", path_effects=style.CASING)  # fmt: skip
    for way, (dx, dy) in ((right, (1, 0)), (-right, (-1, 0)), (up, (0, 1)), (-up, (0, -1))):
        at = 1.16 * radius * dx, 1.1 * radius * dy
        axes.annotate(f"towards\n{named_direction(way)}", at, ha="center", va="center", size=9, color=style.INK)
    if len(cells.direction) <= MOST_NUMBERS:
        for u, v, number in zip(x[~lost], y[~lost], value[~lost], strict=True):
            axes.annotate(f"{number:.{quantity.digits}f}", (u, v), xytext=(0, 8), textcoords="offset points", size=8.5,
                          ha="center", color=style.INK, zorder=4, path_effects=style.CASING)  # fmt: skip
    axes.set(xlim=(-1.32 * radius, 1.32 * radius), ylim=(-1.2 * radius, 1.2 * radius), aspect="equal")
    axes.set_axis_off()
    axes.set_title(f"drill along {named_direction(middle)} in the middle", size=9.5, color=style.INK)
    value_bar(figure, quantity, cmap, norm, axes, shrink=0.7, pad=0.02)
    grey_legend(figure, quantity, ax=ax)
    return figure


def _frame(direction: Array) -> tuple[Array, Array, Array]:
    """Middle of a rose, and what is right and up for who looks along it."""
    mean = direction.mean(axis=0)
    middle = mean / np.linalg.norm(mean) if np.linalg.norm(mean) > 0.2 else np.array([1.0, 0.0, 0.0])
    nearly = np.abs(middle).argmax()
    if abs(middle[nearly]) > 1 - 1e-6:
        middle = np.eye(3)[nearly] * np.sign(middle[nearly])
    above = np.array([0.0, 0.0, 1.0]) if abs(middle[2]) < 0.9 else np.array([1.0, 0.0, 0.0])
    up = above - (above @ middle) * middle
    up /= np.linalg.norm(up)
    return middle, np.cross(middle, up), up


def _on_disc(direction: Array, middle: Array, right: Array, up: Array) -> tuple[Array, Array]:
    """Lambert's equal-area projection of unit vectors (..., 3)."""
    ahead, x, y = direction @ middle, direction @ right, direction @ up
    stretch = np.sqrt(2 / np.maximum(1 + ahead, 1e-9))
    far = ahead < -1 + 1e-9  # what lies right behind is the whole rim; it is drawn to the right
    return np.where(far, 2.0, stretch * x), np.where(far, 0.0, stretch * y)


def _surroundings(
    direction: Array, value: Array, frame: tuple[Array, Array, Array], reach: float, cmap: Any, norm: Any
) -> Any:
    """A picture of the disc, shape (PIXELS, PIXELS, 4), each pixel in the colour of the direction nearest to it."""
    middle, right, up = frame
    radius = 2 * np.sin(np.radians(reach) / 2)
    x, y = np.meshgrid(*(np.linspace(-radius, radius, PIXELS),) * 2)
    r = np.hypot(x, y)
    inside = r <= radius
    ahead = 1 - r**2 / 2
    across = np.sqrt(np.maximum(1 - r**2 / 4, 0.0))
    ways = ahead[..., None] * middle + (across * x)[..., None] * right + (across * y)[..., None] * up
    likeness = ways @ direction.T
    nearest = likeness.argmax(axis=-1)
    apart = np.degrees(np.arccos(np.clip(likeness.max(axis=-1), -1.0, 1.0)))
    shown = value[nearest]
    picture = np.asarray(cmap(norm(np.nan_to_num(shown))))
    from matplotlib.colors import to_rgba

    picture[np.isnan(shown)] = to_rgba(style.CANNOT_RUN)
    picture[~inside | (apart > NEAR * _spacing(direction))] = (1.0, 1.0, 1.0, 0.0)
    return picture


def _spacing(direction: Array) -> float:
    """The usual angle [deg] from a direction to the one next to it."""
    likeness = direction @ direction.T
    np.fill_diagonal(likeness, -1.0)
    return float(np.median(np.degrees(np.arccos(np.clip(likeness.max(axis=1), -1.0, 1.0)))))


def named_direction(way: Array) -> str:
    """+X and the like, or the vector in numbers."""
    most = int(np.abs(way).argmax())
    if abs(way[most]) > 1 - 1e-6:
        return f"{'+' if way[most] > 0 else '−'}{'XYZ'[most]}"
    return "(" + ", ".join(f"{value + 0.0:.2f}" for value in way) + ")"
