"""What the command `recordings holes` shows: plain data, and tables."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

from rich import box
from rich.table import Table
from rich.text import Text

from zerorev.cell.recordings.holes_predicted import Beside, Comparison, FigureName, Place
from zerorev.files.units import deg, mm, plain
from zerorev.model.measured_hole import MeasuredHole
from zerorev.report.words.study import band_data, range_text

__all__ = ["HEADS", "beside_cells", "beside_lines", "beside_table", "holes_data", "holes_table"]

HEADS: dict[FigureName, tuple[str, float, int]] = {
    "position": ("position [mm]", 1e3, 3),
    "tilt": ("tilt [deg]", math.degrees(1.0), 3),
    "roundness_entry": ("roundness at the entry [mm]", 1e3, 3),
    "roundness_exit": ("roundness at the exit [mm]", 1e3, 3),
}
"""Of each figure that is compared: its name, by what its SI value is multiplied, and digits behind the point."""
PLACES: dict[Place, str] = {"below": "below", "inside": "inside", "above": "ABOVE"}


def holes_data(holes: Sequence[MeasuredHole], compared: Comparison | None = None) -> dict[str, Any]:
    """Figures of measured holes as plain data; null where something was not measured.

    Args:
        holes: that were measured.
        compared: with their prediction, which is added to each of them.
    """
    data: dict[str, Any] = dict(plain({"holes": [_hole(hole) for hole in holes]}))
    if compared is None:
        return data
    for hole in data["holes"]:
        figures = compared.holes.get(hole["id"])
        hole["beside"] = None if figures is None else {name: _beside(name, each) for name, each in figures.items()}
    data["not_compared"] = [{"id": name, "why": why} for name, why in compared.left_out.items()]
    data["not_measured"] = list(compared.not_measured)
    data["places"] = {place: compared.count(place) for place in PLACES}
    basis = compared.basis
    data |= {"motion": basis.motion, "sets": basis.sets, "seed": basis.seed, "thrust_n": basis.thrust}
    return {**data, "cell": basis.cell, "study": basis.study}


def _beside(name: FigureName, figure: Beside) -> dict[str, Any]:
    _, scale, _ = HEADS[name]
    unit = "deg" if name == "tilt" else "mm"
    return {
        f"measured_{unit}": None if figure.measured is None else round(figure.measured * scale, 5),
        f"predicted_{unit}": band_data(figure.predicted, scale, 5),
        "place": figure.place,
    }


def beside_table(compared: Comparison) -> Table:
    """One row per figure of each hole: measured, predicted, and where the one lies in the other."""
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for name in ("hole", "figure", "measured", "predicted", "measured is"):
        table.add_column(Text(name), justify="right" if name in ("measured", "predicted") else "left")
    for hole, figures in compared.holes.items():
        for n, (name, figure) in enumerate(figures.items()):
            table.add_row(*map(Text, (hole if n == 0 else "", HEADS[name][0], *beside_cells(name, figure))))
    return table


def beside_cells(name: FigureName, figure: Beside) -> tuple[str, str, str]:
    """Measured, predicted, and where the one lies in the other, as text."""
    _, scale, digits = HEADS[name]
    measured = "–" if figure.measured is None else f"{figure.measured * scale:.{digits}f}"
    return measured, range_text(figure.predicted, scale, digits), "" if figure.place is None else PLACES[figure.place]


def beside_lines(compared: Comparison) -> Iterator[Text]:
    """What to know beside the table."""
    for hole, why in compared.left_out.items():
        yield Text(f"not compared: hole {hole}: {why}")
    if compared.not_measured:
        named = ", ".join(compared.not_measured[:8]) + (", ..." if len(compared.not_measured) > 8 else "")
        yield Text(f"holes of the plan that were not measured: {named}")
    basis = compared.basis
    thrust = f"with {basis.thrust:g} N of thrust" if basis.thrust > 0 else "without thrust"
    yield Text(
        f"predicted: median [5th, 95th percentile] of {basis.sets:,} sets, {thrust}, of a free tip: an upper bound; "
        "what lies above it is worse than the ranges of the parameters allow"
    )
    below, inside, above = (compared.count(place) for place in PLACES)
    yield Text(
        f"of {below + inside + above} measured figures {inside} lie inside the predicted range, {above} above it and "
        f"{below} below it"
    )


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
