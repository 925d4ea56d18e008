"""Six joint curves along the path: as it is shown, against the same hole with constant spin."""

from __future__ import annotations

from typing import Any

import numpy as np
from nicegui import ui

from zerorev.motion.drilling import Drilling
from zerorev.report.scene.joint_range import joint_range
from zerorev.report.scene.motion_look import Curves, Look, held, look
from zerorev.report.scene.motion_look import curves as joint_curves
from zerorev.report.scene.palette import JOINT_COLOURS
from zerorev.web.session import Session
from zerorev.web.state import State, shown
from zerorev.web.throttle import throttled
from zerorev.web.views.chart import INK, MUTED, Chart, axis, pairs, small_place, small_title, tip

__all__ = ["curves", "options"]

SAMPLES = 120
KEYS = (
    ("zr-key-line", "as shown"),
    ("zr-key-baseline", "constant spin"),
    ("zr-key-mark", "reversal"),
    ("zr-key-limit", "beyond a limit"),
)


def curves(session: Session) -> None:
    """Draw the six curves.

    Args:
        session: whose motion is drawn.
    """
    keys = "".join(f'<span class="{key}"></span>{words} ' for key, words in KEYS)
    ui.html(keys, sanitize=False).classes("zr-curve-keys").props('aria-hidden="true"')
    drawn = Chart("six joint angles along the path, as shown and with constant spin", "curves")
    none = ui.label("No motion to draw yet.").classes("zr-none")

    def draw() -> None:
        none.set_visibility(shown(session.state) is None)
        drawn.show(_options(session.state))

    def cursor(distance_mm: float | None) -> None:
        at = [] if distance_mm is None else [{"xAxis": round(distance_mm, 2)}]
        drawn.show_series([{"id": f"cursor{i}", "markLine": {"data": at}} for i in range(6)])

    soon = throttled(draw)

    def changed(before: State, after: State) -> None:
        of = ("steered", "answer", "hole", "stroke")
        if any(getattr(before, name) is not getattr(after, name) for name in of):
            soon()

    draw()
    session.watch(changed)
    session.hear("seek", cursor)


def _options(state: State) -> dict[str, Any]:
    job, hole, motion = state.job, state.hole, shown(state)
    if job is None or hole is None or motion is None:
        return options(None, None, None)
    drilling = Drilling.of(job, hole)
    found = joint_curves(drilling, motion.profile, motion.branch, job.settings, SAMPLES)
    here = look(drilling, motion.profile, motion.branch, job.settings)
    constant = look(drilling, held(motion.profile), motion.branch, job.settings)
    return options(found, here, constant)


def options(found: Curves | None, here: Look | None, constant: Look | None) -> dict[str, Any]:
    """The chart of six joint curves, as ECharts takes it.

    Args:
        found: the curves, or None where there is no motion.
        here: where the motion reverses.
        constant: where it would with constant spin.
    """
    charts = [_one(i, found, here, constant) for i in range(6)]
    parts = {name: [part for each in charts for part in each[name]] for name in charts[0]}
    return parts | {"tooltip": tip("mm", "deg", (1, 2))}


def _one(i: int, found: Curves | None, here: Look | None, constant: Look | None) -> dict[str, list[Any]]:
    """One joint (0..5)."""
    on = {"xAxisIndex": i, "yAxisIndex": i, "type": "line", "silent": True, "showSymbol": False}
    shape = {"symbol": "none", "label": {"show": False}, "data": []}
    x, planned, baseline = (np.empty(0),) * 3
    low, high, limits, reach = 0.0, 1.0, [], [-1.0, 1.0]
    if found is not None:
        x, planned = found.distance * 1e3, np.rad2deg(found.joints[:, i])
        baseline = np.full_like(x, np.nan) if found.baseline is None else np.rad2deg(found.baseline[:, i])
        lower, upper = np.rad2deg([found.limits.lower[i], found.limits.upper[i]]).tolist()
        low, high, below, above = joint_range(np.concatenate([planned, baseline]), lower, upper)
        limits = [[{"yAxis": low - 1}, {"yAxis": below}]] if below is not None else []
        limits += [[{"yAxis": above}, {"yAxis": high + 1}]] if above is not None else []
        reach = [float(x[0]), float(x[-1])]
    name = "" if found is None else found.names[i]
    across: dict[str, Any] = {"min": round(reach[0], 3), "max": round(reach[1], 3), "splitNumber": 4}
    across |= {"name": "path from the target [mm]", "gap": 20} if i == 4 else {}
    at_target = {"silent": True, "animation": False, "symbol": "none", "label": {"show": False},
                 "lineStyle": {"color": MUTED, "type": "dotted", "width": 1}, "data": [{"xAxis": 0}]}  # fmt: skip
    beyond = {"silent": True, "itemStyle": {"color": "url(#zr-hatch)"}, "data": limits}
    return {
        "grid": [small_place(i)],
        "title": [small_title(i, name, "deg", _counts(i, here, constant))],
        "xAxis": [axis(gridIndex=i, **across)],
        "yAxis": [axis(gridIndex=i, min=round(low, 3), max=round(high, 3), splitNumber=3)],
        "series": [
            {**on, "id": f"baseline{i}", "name": "constant spin", "data": pairs(x, baseline, 3), "z": 2,
             "lineStyle": {"color": MUTED, "width": 1.5, "type": [5, 3]}, "itemStyle": {"color": MUTED},
             "markLine": at_target, "markArea": beyond},
            {**on, "id": f"planned{i}", "name": name or "joint", "data": pairs(x, planned, 3), "z": 3,
             "lineStyle": {"color": JOINT_COLOURS[i], "width": 2.2}, "itemStyle": {"color": JOINT_COLOURS[i]}},
            {**on, "id": f"turns{i}", "type": "scatter", "z": 5, "symbol": CROSS, "symbolSize": 9,
             "data": [*_marks(i, constant, x, baseline, MUTED), *_marks(i, here, x, planned, INK)]},
            {**on, "id": f"cursor{i}", "data": [], "z": 4,
             "markLine": shape | {"animation": False, "lineStyle": {"color": INK, "type": "solid", "width": 1}}},
        ],
    }  # fmt: skip


CROSS = "path://M1 0 L5 4 L9 0 L10 1 L6 5 L10 9 L9 10 L5 6 L1 10 L0 9 L4 5 L0 1 Z"


def _marks(i: int, seen: Look | None, x: np.ndarray, angles: np.ndarray, colour: str) -> list[dict[str, Any]]:
    """Crosses where a joint (0..5) turns back."""
    at = [mark.distance * 1e3 for mark in (seen.marks if seen else ()) if mark.joint == i + 1]
    if not at or not np.isfinite(angles).all():
        return []
    return [
        {"value": [round(place, 3), round(float(np.interp(place, x, angles)), 3)], "itemStyle": {"color": colour}}
        for place in at
    ]


def _counts(i: int, here: Look | None, constant: Look | None) -> str:
    before, after = ("?" if each is None or each.score is None else str(each.score.reversals_per_joint[i])
                     for each in (constant, here))  # fmt: skip
    return "" if here is None else f"{before} → {after}"
