"""What all charts of the page share: their look, in the colours of the page, and nothing that moves by itself."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import nicegui
import numpy as np
from nicegui.element import Element

from zerorev.model._arrays import Array
from zerorev.report.scene.palette import DASHES

__all__ = ["INK", "LINE", "MUTED", "SURFACE", "Chart", "axis", "dashes", "pairs", "small_place", "small_title", "tip"]

ECHARTS = Path(nicegui.__file__).parent / "elements" / "echart" / "dist"

# drawn as SVG, so that the colours follow the theme of the page without being drawn again
INK, MUTED, LINE, SURFACE = (f"var(--zr-{name})" for name in ("ink", "muted", "line", "surface"))
TEXT = {"color": MUTED, "fontSize": 11, "fontFamily": "inherit"}
LEFT, ACROSS, TOP, DOWN = (6.0, 39.5, 73.0), 26.0, (11.0, 59.0), 28.0  # [%] of six small pictures in one chart
HEADING = 9.0  # [%] of each


class Chart(
    Element,
    component=Path(__file__).parents[1] / "static" / "chart.js",
    esm={"nicegui-echart": str(ECHARTS)},
):
    """A chart that fills its panel; empty until it is shown something."""

    def __init__(self, words: str, name: str) -> None:
        """Draw it in the current slot.

        Args:
            words: what it shows, for those who cannot see it.
            name: for tests.
        """
        super().__init__()
        self.classes("zr-chart")
        self.props["aria-label"], self.props["data-testid"], self.props["role"] = words, name, "img"

    def show(self, options: dict[str, Any]) -> None:
        """Show something, or something else: of as many series as before.

        Args:
            options: of ECharts; axes as `axis` makes them, and what stands beside the pointer as `tip` does.
        """
        self.run_method("show", {"animation": False, "textStyle": TEXT, "backgroundColor": "transparent"} | options)

    def show_series(self, series: list[dict[str, Any]]) -> None:
        """Show some series differently, and the rest of the chart as it is.

        Args:
            series: each with its id, and with what is new of it.
        """
        self.run_method("show", {"series": series})


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
        "axisLabel": {**TEXT, "hideOverlap": True, "showMinLabel": False, "showMaxLabel": False},
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
        "said": {"across": across, "up": up, "digits": digits, "within": within},
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


def small_place(i: int) -> dict[str, Any]:
    """Where the picture of one joint (0..5) of six stands in its chart."""
    column, row = i % 3, i // 3
    return {"left": f"{LEFT[column]}%", "width": f"{ACROSS}%", "top": f"{TOP[row]}%", "height": f"{DOWN}%"}


def small_title(i: int, name: str, unit: str, more: str = "") -> dict[str, Any]:
    """What stands above the picture of one joint.

    Args:
        i: 0..5.
        name: of the joint; empty: nothing is drawn.
        unit: of what is drawn.
        more: that is said.
    """
    rich = {
        "n": {"color": INK, "fontWeight": 600, "fontSize": 12},
        "u": {"color": MUTED, "padding": [0, 8, 0, 4]},
        "c": {"color": INK},
    }
    plain = name.translate({ord(letter): None for letter in "{}|"})  # which would be the chart's own
    text = f"{{n|{plain}}}{{u|[{unit}]}}" + (f"{{c|{more}}}" if more else "") if name else ""
    place = {"left": f"{LEFT[i % 3]}%", "top": f"{TOP[i // 3] - HEADING}%", "padding": 0}
    return {"text": text, **place, "textStyle": {"fontSize": 11, "fontWeight": "normal", "rich": rich}}
