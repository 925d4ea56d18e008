"""The spin of one hole along its path: what is known of a motion without its robot."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from zerorev.model.plan import HolePlan
from zerorev.report.figures import style
from zerorev.report.figures.joints import REVERSAL, in_a_row

__all__ = ["spin_profile"]


def spin_profile(hole: HolePlan) -> Figure:
    """Spin [deg] against path distance [mm], with the reversals and the constant spin of the baseline.

    Of a hole of several strokes all of them one after the other.

    Args:
        hole: with a motion.

    Raises:
        InputError: the hole has no motion.
    """
    strokes = in_a_row(hole)
    figure = style.headed_figure("Spin along the drilling motion", style.hole_words(hole), 3.4)
    axes = figure.add_subplot()
    style.bare_axes(axes)
    for stroke in strokes:
        profile = stroke.motion.profile
        x, y = stroke.begins + profile.distance * 1e3, np.rad2deg(profile.psi)
        axes.axvline(stroke.target, color=style.MUTED, linewidth=0.9, linestyle=":", zorder=1)
        axes.plot(x[[0, -1]], y[[0, 0]], color=style.BASELINE_COLOUR, linewidth=1.5, linestyle=(0, (4, 2)), zorder=2)
        axes.plot(x, y, color=style.INK, linewidth=2.2, marker="o", markersize=4, zorder=3, label="planned")
        at = [stroke.place(event) for event in (stroke.answer.score.events if stroke.answer.score else ())]
        if at:
            axes.plot(at, np.interp(at, x, y), color=style.INK, zorder=4, label="reversals", **REVERSAL)  # type: ignore[arg-type]
    axes.set_xlim(0, x[-1])
    style.label(axes, "path distance [mm]", "spin ψ [deg]")
    handles = [
        Line2D([], [], color=style.INK, linewidth=2.2, label="planned"),
        Line2D([], [], color=style.BASELINE_COLOUR, linewidth=1.5, linestyle=(0, (4, 2)), label="baseline"),
        Line2D(
            [],
            [],
            color=style.MUTED,
            linewidth=0.9,
            linestyle=":",
            label="target" if len(strokes) == 1 else "deepest point of a stroke",
        ),
    ]
    if events := hole.score.events if hole.score else ():
        joints = ", ".join(str(joint) for joint in sorted({event.joint for event in events}))
        handles.append(Line2D([], [], color=style.INK, label=f"reversal of joint {joints}", **REVERSAL))  # type: ignore[arg-type]
    style.legend_below(figure, handles, columns=4)
    return figure
