"""The critical rates of the six joints at the target, and how the two legs bracket them: why there are reversals."""

from __future__ import annotations

from typing import Any

import numpy as np
from nicegui import ui

from zerorev.motion.drilling import Drilling
from zerorev.report.scene.bracket import Bracket
from zerorev.report.scene.bracket import bracket as bracket_of
from zerorev.report.scene.palette import JOINT_COLOURS, signed
from zerorev.web.session import Session
from zerorev.web.state import State, shown
from zerorev.web.throttle import throttled
from zerorev.web.views.chart import INK, SURFACE, Chart, axis, dashes, pairs, tip

__all__ = ["bracket", "options", "sentence"]

STEP = float(np.deg2rad(1.0))
KEYS = """<span class="zr-key-band"></span>between the legs
<span class="zr-key-good"></span>spins where all six are"""
THIN = {"width": 1.3}
CLOSE = 0.2  # share of the picture's height
LABEL = {"show": True, "color": INK, "fontSize": 11, "textBorderColor": SURFACE, "textBorderWidth": 3}


def bracket(session: Session) -> None:
    """Draw the bracket.

    Args:
        session: whose motion is shown.
    """
    ui.html(KEYS, sanitize=False).classes("zr-curve-keys").props('aria-hidden="true"')
    words = ui.label().classes("zr-bracket-words").props('role="status" data-testid="bracket-words"')
    drawn = Chart("critical twist rates of the six joints against the spin at the target", "bracket")
    none = ui.label("No motion to draw yet.").classes("zr-none")

    def draw() -> None:
        job, hole, motion = session.state.job, session.state.hole, shown(session.state)
        none.set_visibility(motion is None)
        if job is None or hole is None or motion is None:
            words.set_text("")
            drawn.show(options(None, ()))
            return
        rates = bracket_of(Drilling.of(job, hole), motion.profile, motion.branch, STEP, job.settings.of(hole).creep)
        words.set_text(sentence(rates, job.robot.joint_names))
        drawn.show(options(rates, job.robot.joint_names))

    soon = throttled(draw)

    def changed(before: State, after: State) -> None:
        if (
            before.steered is not after.steered
            or before.answer is not after.answer
            or before.stroke != after.stroke
            or before.selected != after.selected
        ):
            soon()

    draw()
    session.watch(changed)


def sentence(rates: Bracket, names: tuple[str, ...]) -> str:
    """What the picture says, in words.

    Args:
        rates: the critical rates and the slopes.
        names: of the joints.
    """
    out = [names[i] for i in range(6) if not rates.between[i]]
    if not out:
        return "All six critical rates lie between the slopes of the two legs: no joint reverses at the target."
    one = len(out) == 1
    listed = out[0] if one else f"{', '.join(out[:-1])} and {out[-1]}"
    stands = "stands" if one else "stand"
    where = f"{listed} {stands} still at {'a rate' if one else 'rates'} outside the slopes of the two legs"
    return f"{where}, so {'it reverses' if one else 'they reverse'} at the target."


def options(rates: Bracket | None, names: tuple[str, ...]) -> dict[str, Any]:
    """The chart, as ECharts takes it.

    Args:
        rates: what is drawn, or None where there is no motion.
        names: of the joints.
    """
    line = {"type": "line", "showSymbol": False, "silent": True, "clip": True}
    low, high = (-1.0, 1.0) if rates is None else rates.rates
    left, right = (-180.0, 180.0) if rates is None else np.rad2deg(rates.reached)
    series = [
        {**line, "id": f"joint{i}", "name": names[i] if names else str(i), "z": 3,
         "data": [] if rates is None else _curve(rates, i, low, high),
         "itemStyle": {"color": JOINT_COLOURS[i]},
         "lineStyle": {"color": JOINT_COLOURS[i], "width": 2, "type": dashes(i)}}
        for i in range(6)
    ]  # fmt: skip
    return {
        "grid": {"left": 52, "right": 92, "top": 12, "bottom": 38},
        "xAxis": axis("spin at the target [deg]", 22, min=round(left, 2), max=round(right, 2)),
        "yAxis": axis("critical rate [deg/mm]", 36, min=round(low, 4), max=round(high, 4)),
        "tooltip": tip("deg", "deg/mm", (1, 3), (round(low, 4), round(high, 4))),
        "series": [*series, _slopes(rates, line), _crossings(rates, names, low, high), _good(rates, low)],
    }


def _curve(rates: Bracket, joint: int, low: float, high: float) -> list[list[float | None]]:
    x, y = rates.curve(joint)
    reach = high - low  # far beyond the picture is as good as at infinity
    return pairs(x, np.clip(y, low - reach, high + reach), 4)


def _slopes(rates: Bracket | None, line: dict[str, Any]) -> dict[str, Any]:
    """The two legs' slopes as a band, and the chosen spin."""
    lines: list[dict[str, Any]] = []
    band: list[Any] = []
    if rates is not None:
        for slope, name in zip(rates.slopes.tolist(), ("plunge", "retract"), strict=True):
            label = {"show": True, "position": "end", "color": INK, "fontSize": 11, "lineHeight": 13}
            label["formatter"] = f"{name}\n{signed(slope, 3)}"
            if np.ptp(rates.slopes) < CLOSE * np.ptp(rates.rates):  # the two labels out of each other's way
                label["offset"] = [0, -14 if slope == rates.slopes.max() else 14]
            lines.append(
                {"yAxis": round(slope, 5), "label": label, "lineStyle": {"color": INK, "type": [6, 3], **THIN}}
            )
        spin = {"xAxis": _spin(rates), "label": {"show": False}, "lineStyle": {"color": INK, "type": "solid", **THIN}}
        lines.append(spin)
        band = [[{"yAxis": round(float(edge), 5)} for edge in sorted(rates.slopes)]]
    return {
        **line,
        "id": "slopes",
        "data": [],
        "z": 2,
        "markLine": {"symbol": "none", "silent": True, "animation": False, "data": lines},
        "markArea": {"silent": True, "itemStyle": {"color": "var(--zr-band)"}, "data": band},
    }


def _spin(rates: Bracket) -> float:
    """The chosen one [deg]."""
    return round(float(np.rad2deg(rates.chosen)), 3)


def _crossings(rates: Bracket | None, names: tuple[str, ...], low: float, high: float) -> dict[str, Any]:
    """Where each critical rate lies at the chosen spin; hollow where it is out of the bracket."""
    points = []
    for i in range(6) if rates is not None else ():
        assert rates is not None
        rate, held = float(rates.here[i]), bool(rates.between[i])
        if not np.isfinite(rate):
            continue
        points.append(
            {
                "value": [_spin(rates), round(min(max(rate, low), high), 4)],
                "symbol": "circle" if low <= rate <= high else "triangle",
                "symbolRotate": 180 if rate < low else 0,
                "symbolSize": 10 if held else 11,
                "itemStyle": _point(JOINT_COLOURS[i], held),
                "label": LABEL | _named(names[i], held) | {"position": "right" if i % 2 else "left"},
            }
        )
    look = {"type": "scatter", "silent": True, "z": 6, "clip": False, "labelLayout": {"moveOverlap": "shiftY"}}
    return {"id": "crossings", "data": points, **look}


def _point(colour: str, held: bool) -> dict[str, Any]:
    edge = {"borderColor": SURFACE, "borderWidth": 1} if held else {"borderColor": colour, "borderWidth": 3}
    return {"color": colour if held else SURFACE} | edge


def _named(name: str, held: bool) -> dict[str, Any]:
    plain = name.translate({ord(letter): None for letter in "{}"})  # which would be the chart's own
    return {"formatter": plain if held else f"{plain} ✕", "fontWeight": 400 if held else 700}


def _good(rates: Bracket | None, low: float) -> dict[str, Any]:
    """Along the foot: the spins at which these slopes would bracket all six."""
    data = [] if rates is None else pairs(np.rad2deg(rates.psi), np.where(rates.all_between, low, np.nan), 4)
    return {"id": "good", "type": "line", "showSymbol": False, "silent": True, "z": 4, "data": data, "clip": False,
            "lineStyle": {"color": "var(--zr-good)", "width": 6, "cap": "butt"}}  # fmt: skip
