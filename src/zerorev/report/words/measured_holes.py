"""What the command `recordings holes` shows: plain data, and a table."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from rich import box
from rich.table import Table
from rich.text import Text

from zerorev.files.units import deg, mm, plain
from zerorev.model.measured_hole import MeasuredHole

__all__ = ["holes_data", "holes_table"]


def holes_data(holes: Sequence[MeasuredHole]) -> dict[str, Any]:
    """Figures of measured holes as plain data; null where something was not measured."""
    return dict(plain({"holes": [_hole(hole) for hole in holes]}))


def _hole(hole: MeasuredHole) -> dict[str, Any]:
    diameter = hole.diameter
    return {
        "id": hole.id,
        "sections": int(hole.depth.size),
        "depth_mm": [mm(hole.depth[0]), mm(hole.depth[-1])],
        "position_error_mm": None if hole.position_error is None else mm(hole.position_error),
        "tilt_deg": None if hole.tilt is None else deg(hole.tilt),
        "diameter_mm": None if diameter is None else {"least": mm(diameter.min()), "greatest": mm(diameter.max())},
        "roundness_mm": None if hole.roundness is None else mm(hole.roundness.max()),
    }


def holes_table(holes: Sequence[MeasuredHole]) -> Table:
    """One row per hole."""
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for name in (
        "hole", "sections", "position error\n[mm]", "tilt\n[deg]", "diameter\n[mm]", "roundness\n[mm]",
    ):  # fmt: skip
        table.add_column(Text(name), justify="left" if name == "hole" else "right")
    for hole in holes:
        data = _hole(hole)
        diameter, tilt = data["diameter_mm"], data["tilt_deg"]
        cells = (
            _cell(data["position_error_mm"]), "–" if tilt is None else f"{tilt:.4f}",
            "–" if diameter is None else f"{diameter['least']:.3f} to {diameter['greatest']:.3f}",
            _cell(data["roundness_mm"]),
        )  # fmt: skip
        table.add_row(Text(hole.id), Text(str(data["sections"])), *map(Text, cells))
    return table


def _cell(value: Any) -> str:
    return "–" if value is None else f"{value:.3f}"
