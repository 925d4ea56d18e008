"""Slices of a parameter map (thesis Fig. 26), and the set of spins with zero reversals in 3D."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from mpl_toolkits.mplot3d import Axes3D

from zerorev.model._arrays import Array
from zerorev.report.figures import style

if TYPE_CHECKING:
    from xarray import Dataset

__all__ = ["heading", "parameter_slices", "reversal_classes", "reversal_names", "zero_volume"]

MOST = len(style.REVERSAL_COLOURS) - 1  # so many reversals or more share a colour
SCORE_MAP = "cividis"  # the same to the colour-blind
TICKS = np.arange(-180, 181, 90)
SHADOW = "#c9c9c9"


def parameter_slices(slices: Mapping[str, Dataset]) -> Figure:
    """Objective (upper row) and reversals (lower row) over psi_start and psi_end [deg], as the thesis' Fig. 26.

    Args:
        slices: what each column is called, and its parameter map at one psi_target.
    """
    first = next(iter(slices.values()))
    psi_target = float(first["psi_target_deg"].values.ravel()[0])
    title = f"The objective over the spins at start and end, ψ at the target {style.signed(psi_target, 1)} deg"
    figure = style.headed_figure(title, heading(first), 7.9)
    grid = figure.subplots(2, len(slices), sharex=True, sharey=True, squeeze=False)
    classes = ListedColormap([style.CANNOT_RUN, *style.REVERSAL_COLOURS])
    image: Any = None
    for column, (name, found) in zip(grid.T, slices.items(), strict=True):
        column[0].set_title(name, size=9.5, color=style.INK, loc="left")
        image = _picture(column[0], found, _score(found), cmap=SCORE_MAP, vmin=0.0, vmax=1.0)
        _picture(column[1], found, _classes(found), cmap=classes, vmin=-1.5, vmax=MOST + 0.5)
        column[1].set_xlabel("ψ at the start [deg]", size=9.5, color=style.INK)
    for axes in grid[:, 0]:
        axes.set_ylabel("ψ at the end [deg]", size=9.5, color=style.INK)
    bar = figure.colorbar(
        image, ax=list(grid.ravel()), pad=0.015, shrink=0.44, anchor=(0.0, 0.97), aspect=24, extend="max"
    )
    bar.ax.tick_params(labelsize=8.5, color=style.MUTED, labelcolor=style.INK)
    bar.set_label("objective, eq. 4.7 [1]", size=9.5, color=style.INK)
    handles: list[Any] = [Line2D([], [], linestyle="none", label="reversals:")]
    handles += [Patch(facecolor=colour, edgecolor=style.MUTED, linewidth=0.4, label=name)
                for name, colour in reversal_names()]  # fmt: skip
    style.legend_below(figure, handles, columns=len(handles))
    return figure


def zero_volume(found: Dataset, *, ax: Axes | None = None) -> Figure:
    """The spins with zero reversals [deg] as points of the cube, coloured by travel [deg], with their shadows.

    Args:
        found: a whole parameter map.
        ax: to draw into, in 3D; None: a figure with a heading.

    Raises:
        InputError: the axes are not in 3D.
    """
    zero = np.argwhere(found["reversals"].values == 0)
    t, s, e = (found[name].values[column] for name, column in zip(found["score"].dims, zero.T, strict=True))
    title = f"Where no joint reverses: {len(zero):,} of {found['score'].size:,} motions"
    figure, axes = style.one_axes(ax, title, heading(found), 6.3, "3d")
    assert isinstance(axes, Axes3D)
    low, high = (float(found["psi_start_deg"].values[k]) for k in (0, -1))
    for place, at in ((0, low), (1, high), (2, low)):
        shadow = [s, e, t]
        shadow[place] = np.full(len(zero), at)
        axes.scatter(*shadow, s=3, c=SHADOW, depthshade=False, edgecolors="none")
    travel = found["travel_deg"].values[tuple(zero.T)]
    points = axes.scatter(s, e, t, c=travel, cmap=SCORE_MAP, s=7, depthshade=False, edgecolors="none")
    axes.set(xlim=(low, high), ylim=(low, high))
    axes.set_zlim(*(float(found["psi_target_deg"].values[k]) for k in (0, -1)))
    axes.set_box_aspect((1, 1, 1), zoom=1.02)
    axes.view_init(elev=22, azim=-52)
    for axis, what in ((axes.xaxis, "start"), (axes.yaxis, "end"), (axes.zaxis, "target")):
        axis.set_label_text(f"ψ at the {what} [deg]", size=9.5, color=style.INK)
        axis.set_pane_color((0.975, 0.975, 0.975, 1.0))
        if high - low > TICKS[1] - TICKS[0]:
            # where two axes meet their labels would lie on each other
            axis.set_ticks(TICKS[((low < TICKS) if what == "end" else (low <= TICKS)) & (high >= TICKS)])
    axes.tick_params(labelsize=8.5, labelcolor=style.INK)
    if len(zero):
        bar = figure.colorbar(points, ax=axes, shrink=0.6, pad=0.09)
        bar.ax.tick_params(labelsize=8.5, labelcolor=style.INK)
        bar.set_label("travel of all joints [deg]", size=9.5, color=style.INK)
    return figure


def heading(found: Dataset) -> str:
    """Robot, hole and grid of a map, in a line."""
    target = ", ".join(f"{value:g}" for value in found.attrs["target_mm"])
    grid = " × ".join(str(size) for size in found["score"].sizes.values() if size > 1)
    return (
        f"{found.attrs['robot']}, {found.attrs['tool']}   |   target {target} mm, stroke {found.attrs['depth_mm']:g} mm"
        f"   |   {grid} spins, N = {found.attrs['samples']}"
    )


def reversal_classes(reversals: Any) -> Any:
    """Which colour a number of reversals has: -1 (cannot be run), 0, 1, ..., `MOST` (so many or more)."""
    return np.minimum(reversals, MOST)


def reversal_names() -> list[tuple[str, str]]:
    """Name and colour of each class, from -1."""
    names = ["cannot be run", *(str(k) for k in range(MOST)), f"{MOST} or more"]
    return list(zip(names, (style.CANNOT_RUN, *style.REVERSAL_COLOURS), strict=True))


def _score(found: Dataset) -> Array:
    """Objective over end and start, NaN where no branch can run the motion."""
    score = found["score"].where(found["reversals"] >= 0)
    return np.asarray(score.squeeze("psi_target_deg").transpose("psi_end_deg", "psi_start_deg").values)


def _classes(found: Dataset) -> Any:
    """Class of reversals over end and start."""
    reversals = found["reversals"].squeeze("psi_target_deg").transpose("psi_end_deg", "psi_start_deg")
    return reversal_classes(reversals.values)


def _picture(axes: Axes, found: Dataset, values: Any, **colours: Any) -> Any:
    """One slice, its mirror line, and what cannot be run in grey."""
    s, e = found["psi_start_deg"].values, found["psi_end_deg"].values
    half = (s[1] - s[0]) / 2
    axes.set_facecolor(style.CANNOT_RUN)
    extent = (s[0] - half, s[-1] + half, e[0] - half, e[-1] + half)
    image = axes.imshow(values, origin="lower", extent=extent, interpolation="nearest", aspect="equal", **colours)
    axes.plot(s[[0, -1]], e[[0, -1]], color=style.INK, linewidth=0.8, linestyle=(0, (4, 3)))
    axes.tick_params(labelsize=8.5, color=style.MUTED, labelcolor=style.INK)
    axes.spines[:].set_color(style.MUTED)
    if extent[1] - extent[0] > TICKS[1] - TICKS[0]:
        axes.set(xticks=TICKS[(s[0] <= TICKS) & (s[-1] >= TICKS)], yticks=TICKS[(e[0] <= TICKS) & (e[-1] >= TICKS)])
    return image
