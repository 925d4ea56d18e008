"""Loads of the joints in the pictures: where they change their sign, without a reversal (theory §9)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patheffects import withStroke

from zerorev.model._arrays import Array
from zerorev.model.plan import HolePlan, Motion, Plan
from zerorev.motion.drilling import Drilling
from zerorev.report.figures import style
from zerorev.report.scene.load_lines import load_lines, senses

__all__ = ["CROSSED", "draw_loads"]

THIN: dict[str, Any] = {"linewidth": 1.1, "linestyle": (0, (1.2, 1.6))}
CROSSED: dict[str, Any] = {
    "marker": "o", "markersize": 6.5, "markerfacecolor": "white", "markeredgewidth": 1.5, "linestyle": "none",
}  # fmt: skip
EDGE = 0.015  # of the spins that are shown: no name over the frame
OUT = (0.7, 0.4, 0.95, 0.15)  # of the way out: where a curve is named, in the first place with room
ROOM, ALIKE = (0.1, 0.028), 0.4  # of the picture: what a name takes; how far apart the same one stands along a curve


def draw_loads(
    axes: Axes, plan: Plan, hole: HolePlan, motions: Sequence[Motion], standoff: Array, psi: Array
) -> list[Any]:
    """Draw the curves on which a load changes its sign, each on the legs on which its joint turns that way.

    Args:
        axes: the twist plane: signed path distance from the corner [mm], spin [deg].
        plan: whose robot and tool move.
        hole: that is drilled.
        motions: of it, one per stroke, all on one branch, stand-offs counted from its target.
        standoff: that is shown [m], from the corner on.
        psi: spins that are shown [rad].

    Returns:
        what the legend says of them; nothing where there are none.
    """
    drilling, branch = Drilling.of(plan, hole.hole), motions[0].branch
    lines = load_lines(drilling, branch, standoff, psi, plan.settings.thrust)
    if not lines:
        return []
    turning = [senses(drilling, motion.profile, branch) for motion in motions]
    names: list[tuple[float, float, str]] = []
    for line in lines:
        away, spin = (line.points[:, 0] - standoff[0]) * 1e3, np.rad2deg(line.points[:, 1])
        for leg in line.legs:
            if not any(line.sense in of_one[leg][line.joint - 1] for of_one in turning):
                continue
            x = -away if leg == "plunge" else away
            axes.plot(x, spin, color=style.JOINT_COLOURS[line.joint - 1], zorder=4, label="load", **THIN)
            text = f"{plan.robot.joint_names[line.joint - 1]} {line.level:.0%}"
            for out in OUT:
                n = int(np.abs(away - out * (standoff[-1] - standoff[0]) * 1e3).argmin())
                if _named(axes, float(x[n]), float(spin[n]), text, style.JOINT_INKS[line.joint - 1], names):
                    break
    words = "load 0 with % of friction"
    return [Line2D([], [], color=style.INK, label=words, **THIN)] if names else []


def _named(axes: Axes, x: float, y: float, text: str, ink: str, taken: list[tuple[float, float, str]]) -> bool:
    """Put a name on its curve, unless another one lies there; whether the curve has its name now."""
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    across, up = (x - left) / (right - left), (y - low) / (high - low)
    if not EDGE < up < 1 - EDGE:
        return False
    for other, height, same in taken:
        if abs(up - height) < ROOM[1] and abs(across - other) < (ALIKE if text == same else ROOM[0]):
            return text == same
    taken.append((across, up, text))
    axes.annotate(text, (x, y), size=7.5, ha="center", va="center", color=ink, zorder=5, parse_math=False,
                  path_effects=[withStroke(linewidth=2.5, foreground="white")])  # fmt: skip
    return True
