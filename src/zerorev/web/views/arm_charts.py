"""Charts of a simulated motion: how far the tip strays along the path, and the torques of the six drives."""

from __future__ import annotations

from typing import Any

import numpy as np

from zerorev.cell.ensemble import SIDES
from zerorev.report.scene.study_curves import DRAWN, SIDE_WORDS, Banded, stray_curve, torque_curve
from zerorev.report.words.study import NAMES
from zerorev.web.real_arm import Simulated
from zerorev.web.views.chart import INK, MUTED, SURFACE, axis, pairs, small_place, small_title, tip

__all__ = ["MOTIONS", "stray_options", "torque_options"]

COLOURS = {"baseline": MUTED, "plan": "var(--zr-accent)"}
MOTIONS = {"baseline": NAMES["baseline"], "plan": "this motion"}
LEFT, ACROSS, ABOVE, BELOW = (7.0, 57.0), 41.0, 32, 46  # [%], [px] of the two pictures of the tip
EVERY = 2  # of the points of a torque
HIGHEST = 4.0  # times the greatest median: a band that is higher leaves the picture, so that the curves stay readable
WINDOW = 0.5  # of the stroke on either side of the turn
PATH = "path from the target [mm]"


def stray_options(found: Simulated | None) -> dict[str, Any]:
    """Distance of the tip from its mean path, by the encoders and at the tool, as ECharts takes it.

    Args:
        found: what is drawn, or None.
    """
    parts, reach = _empty(), _reach(found)
    drawn = [(side, motion) for side in SIDES for motion in DRAWN]
    curves = {} if found is None else {(side, motion): stray_curve(found.study, motion, side) for side, motion in drawn}
    top = _top(list(curves.values()))
    window = {"silent": True, "itemStyle": {"color": "var(--zr-raised)"}, "data": []}
    if found is not None:
        window |= {"data": [[{"xAxis": -WINDOW * reach}, {"xAxis": WINDOW * reach}]]}
    for i, side in enumerate(SIDES):
        parts["grid"].append({"left": f"{LEFT[i]}%", "width": f"{ACROSS}%", "top": ABOVE, "bottom": BELOW})
        title = {"left": f"{LEFT[i]}%", "top": 6, "padding": 0}
        title |= {"textStyle": {"fontSize": 12, "fontWeight": 600, "color": INK}}
        parts["title"].append(title | {"text": "" if found is None else f"{SIDE_WORDS[side]} [mm]"})
        parts["xAxis"].append(_path(i, reach, PATH))
        parts["yAxis"].append(axis(gridIndex=i, min=0, max=top, splitNumber=4))
        marks = {"markLine": _lines({"xAxis": 0}), "markArea": window}
        for motion in DRAWN:
            parts["series"] += _banded(i, side, motion, curves.get((side, motion)), reach, 4)
        parts["series"][-1] |= marks
    return parts | {"tooltip": tip("mm", "mm", (1, 3))}


def torque_options(found: Simulated | None, names: tuple[str, ...]) -> dict[str, Any]:
    """Torques of the six drives, on the side of the joint, and where their medians change sign.

    Args:
        found: what is drawn, or None.
        names: of the joints.
    """
    parts, reach = _empty(), _reach(found)
    for joint in range(6):
        parts["grid"].append(small_place(joint))
        parts["title"].append(small_title(joint, names[joint] if found is not None else "", "Nm"))
        parts["xAxis"].append(_path(joint, reach, PATH if joint == 4 else ""))
        parts["yAxis"].append(axis(gridIndex=joint, splitNumber=3, scale=True))
        for motion in DRAWN:
            curve = None if found is None else torque_curve(found.study, motion, joint)
            parts["series"].append(_changes(joint, motion, curve, reach))
            parts["series"] += _banded(joint, f"torque{joint}", motion, curve, reach, 2, EVERY)
        parts["series"][-1]["markLine"] = _lines({"xAxis": 0}, {"yAxis": 0})
    return parts | {"tooltip": tip("mm", "Nm", (1, 2))}


def _empty() -> dict[str, list[Any]]:
    return {"grid": [], "title": [], "xAxis": [], "yAxis": [], "series": []}


def _reach(found: Simulated | None) -> float:
    """Length of the stroke [mm]."""
    return 1.0 if found is None else found.hole.depth * 1e3


def _path(i: int, reach: float, name: str) -> dict[str, Any]:
    return axis(name, 22 if name else 0, gridIndex=i, min=-round(reach, 3), max=round(reach, 3), splitNumber=4)


def _banded(
    i: int, name: str, motion: str, curve: Banded | None, reach: float, digits: int, every: int = 1
) -> list[dict[str, Any]]:
    """A band, as one line that is not drawn with another stacked upon it, and the median."""
    on = {"xAxisIndex": i, "yAxisIndex": i, "type": "line", "silent": True, "showSymbol": False}
    empty = np.empty(0)
    path, low, median, high = (empty,) * 4
    if curve is not None:
        path, low, median, high = (each[::every] for each in (curve.path * reach, curve.low, curve.median, curve.high))
    none = {"lineStyle": {"opacity": 0}, "stack": f"{name}-{motion}", "stackStrategy": "all", "z": 2}
    colour = COLOURS[motion]
    return [
        {**on, **none, "id": f"{name}-{motion}-low", "data": pairs(path, low, digits)},
        {**on, **none, "id": f"{name}-{motion}-band", "data": pairs(path, high - low, digits),
         "areaStyle": {"color": colour, "opacity": 0.2}},
        {**on, "id": f"{name}-{motion}", "name": MOTIONS[motion], "data": pairs(path, median, digits), "z": 3,
         "lineStyle": {"color": colour, "width": 2}, "itemStyle": {"color": colour}},
    ]  # fmt: skip


def _lines(*places: dict[str, float]) -> dict[str, Any]:
    """Dotted lines: the turn; and where a torque is zero."""
    look = {"silent": True, "animation": False, "symbol": "none", "label": {"show": False}}
    return look | {"lineStyle": {"color": MUTED, "type": "dotted", "width": 1}, "data": list(places)}


def _changes(joint: int, motion: str, curve: Banded | None, reach: float) -> dict[str, Any]:
    """Rings where the median of a torque changes its sign."""
    at = [] if curve is None else [[round(float(place) * reach, 3), 0.0] for place in curve.changes]
    ring = {"color": SURFACE, "borderColor": COLOURS[motion], "borderWidth": 2}
    return {"xAxisIndex": joint, "yAxisIndex": joint, "type": "scatter", "silent": True, "z": 5, "symbolSize": 8,
            "id": f"torque{joint}-{motion}-changes", "data": at, "itemStyle": ring}  # fmt: skip


def _top(curves: list[Banded]) -> float | None:
    """How high the picture of the tip reaches [mm]."""
    if not curves:
        return None
    medians, highs = (max(float(values.max()) for values in each) for each in (
        [curve.median for curve in curves], [curve.high for curve in curves]
    ))  # fmt: skip
    return float(f"{1.1 * min(highs, HIGHEST * medians):.2g}")
