"""What all charts of the page share: their look, in the colours of the page, and nothing that moves by itself."""

from __future__ import annotations

from typing import Any

import numpy as np
from nicegui import ui

from zerorev.model._arrays import Array
from zerorev.report.palette import DASHES

__all__ = ["INK", "LINE", "MUTED", "SURFACE", "axis", "chart", "dashes", "pairs", "redraw", "tip"]

# drawn as SVG, so that the colours follow the theme of the page without being drawn anew
INK, MUTED, LINE, SURFACE = (f"var(--zr-{name})" for name in ("ink", "muted", "line", "surface"))
MINUS = "value => String(value).replace('-', '\u2212')"
TEXT = {"color": MUTED, "fontSize": 11, "fontFamily": "inherit"}


def chart(options: dict[str, Any], words: str, name: str) -> ui.echart:
    """A chart that fills its panel.

    Args:
        options: of ECharts.
        words: what it shows, for those who cannot see it.
        name: for tests.
    """
    drawn = ui.echart(_still(options), renderer="svg").classes("zr-chart")
    drawn.props["aria-label"], drawn.props["data-testid"] = words, name
    drawn.props["role"] = "img"
    return drawn


def redraw(drawn: ui.echart, options: dict[str, Any]) -> None:
    """Show something else in a chart: of as many series as before."""
    drawn.props["options"] = _still(options)


def _still(options: dict[str, Any]) -> dict[str, Any]:
    return {"animation": False, "textStyle": TEXT, "backgroundColor": "transparent"} | options


def axis(name: str = "", gap: int = 0, **options: Any) -> dict[str, Any]:
    """A thin axis with a faint grid.

    Args:
        name: with the unit.
        gap: between it and the axis [px].
        options: of ECharts.
    """
    return {
        "name": name,
        "nameLocation": "middle",
        "nameGap": gap,
        "type": "value",
        "axisLine": {"show": True, "onZero": False, "lineStyle": {"color": MUTED, "width": 1}},
        "axisTick": {"show": True, "length": 3, "lineStyle": {"color": MUTED}},
        "axisLabel": {**TEXT, ":formatter": MINUS, "hideOverlap": True, "showMinLabel": False, "showMaxLabel": False},
        "splitLine": {"lineStyle": {"color": LINE, "width": 1}},
        "nameTextStyle": TEXT,
        **options,
    }


def tip(across: str, up: str, digits: tuple[int, int], within: tuple[float, float] | None = None) -> dict[str, Any]:
    """What stands beside the pointer: the values there of all curves of the chart that have a name.

    Args:
        across: unit of the place.
        up: unit of the values.
        digits: of the place and of the values.
        within: values that lie outside are drawn at no height of their own, and are said to be beyond.
    """
    low, high = ("-Infinity", "Infinity") if within is None else within
    words = f"""points => {{
        const plain = text => String(text).replace(/[&<>"']/g, letter => '&#' + letter.charCodeAt(0) + ';');
        const minus = text => text.replace('-', '\u2212');
        const said = value => value > {high} ? 'beyond {high}' : value < {low} ? minus('beyond {low}')
            : minus(value.toFixed({digits[1]}));
        const named = points.filter(p => p.seriesType === 'line' && p.value?.[1] != null && !/\0/.test(p.seriesName));
        if (!named.length) return '';
        const rows = named.map(p => `<tr><td><span class="zr-tip-key" style="background:${{p.color}}"></span>
            ${{plain(p.seriesName)}}</td><td>${{said(p.value[1])}}</td></tr>`).join('');
        return `<table class="zr-tip"><caption>at ${{minus(named[0].value[0].toFixed({digits[0]}))}} {across},
            in {up}</caption>${{rows}}</table>`;
    }}"""
    return {
        "trigger": "axis",
        "confine": True,
        "transitionDuration": 0,
        "backgroundColor": SURFACE,
        "borderColor": "var(--zr-edge)",
        "padding": [4, 8],
        "textStyle": {"color": INK, "fontSize": 11.5, "fontFamily": "inherit"},
        "extraCssText": "box-shadow: none; border-radius: 6px",
        "axisPointer": {"type": "line", "animation": False, "lineStyle": {"color": MUTED, "type": "solid", "width": 1},
                        "label": {"show": False}},
        ":formatter": words,
    }  # fmt: skip


def dashes(joint: int, width: float = 2.0) -> str | list[float]:
    """How the line of a joint (0..5) is broken, as in the figures; lengths in px."""
    dash = DASHES[joint]
    return "solid" if isinstance(dash, str) else [width * length for length in dash[1]]


def pairs(x: Array, y: Array, digits: int) -> list[list[float | None]]:
    """Points (N,) as a chart takes them; a gap where one is not known.

    Args:
        x: across, shape (N,).
        y: upwards, shape (N,).
        digits: that are drawn.
    """
    known = np.round(np.column_stack([x, y]), digits).tolist()
    return [[across, up if np.isfinite(up) else None] for across, up in known]
