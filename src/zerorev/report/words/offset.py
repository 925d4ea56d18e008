"""What the command `offset` writes and shows: plain data, a table, and a few lines."""

from __future__ import annotations

from typing import Any

import numpy as np
from rich import box
from rich.table import Table
from rich.text import Text

from zerorev.files.conversion import robot_data, settings_data, tool_data
from zerorev.files.units import deg, mm, plain
from zerorev.model.job import Job
from zerorev.placement.tool_offset import LeastOffset, OffsetCurve, offset_of
from zerorev.report.words.answer import how_deep

__all__ = ["offset_data", "offset_lines", "offset_table"]

HOLES_SHOWN = 8


def offset_data(job: Job, curve: OffsetCurve, least: LeastOffset | None) -> dict[str, Any]:
    """The answer as plain data, in the form of an offset file (docs/howto/tool_offset.md)."""
    offset, angle = offset_of(job.robot, job.tool)
    data = {
        "format": "zerorev.offset/1",
        "name": job.name,
        "robot": robot_data(job.robot),
        "tool": tool_data(job.tool),
        "settings": settings_data(job.settings),
        "as_it_is": {"offset_mm": mm(offset), "angle_deg": deg(angle)},
        "offsets_mm": mm(curve.offsets),
        "angles_deg": deg(curve.angles),
        "margin_mm": mm(curve.margin),
        "holes": [
            {"id": hole.id, "depth_mm": mm(hole.depth), "deepest_mm": mm(curve.deepest[:, :, k])}
            for k, hole in enumerate(job.holes)
        ],
        "least": None if least is None else _least_data(job, least),
    }
    return dict(plain(data))


def _least_data(job: Job, least: LeastOffset) -> dict[str, Any]:
    return {
        "offset_mm": mm(least.offset),
        "angle_deg": deg(least.angle),
        "fails_at_mm": None if least.fails_at is None else mm(least.fails_at),
        "tool": tool_data(least.tool),
        "holes": [
            {"id": hole.id, "deepest_mm": deepest} for hole, deepest in zip(job.holes, mm(least.deepest), strict=True)
        ],
    }


def offset_table(job: Job, curve: OffsetCurve, least: LeastOffset | None) -> Table:
    """One row an offset: the least margin, and the deepest stroke of each hole, at the angle of the least offset."""
    j = int(np.argmax(curve.margin.max(axis=0)))
    if least is not None:
        j = int(np.argmin(np.abs(curve.angles - least.angle)))
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, title=f"angle {float(deg(curve.angles[j])) + 0.0:.4g} deg",
                  title_justify="left")  # fmt: skip
    few = list(job.holes)[:HOLES_SHOWN] if len(job.holes) <= HOLES_SHOWN else []
    table.add_column(Text("e\n[mm]"), justify="right")
    table.add_column(Text("least margin\n[mm]"), justify="right")
    for hole in few:
        table.add_column(Text(f"{hole.id}\n{float(mm(hole.depth)):.4g} mm needed"), justify="right")
    for i, offset in enumerate(mm(curve.offsets)):
        margin = float(mm(curve.margin[i, j]))
        cells = [Text(f"{mm(curve.deepest[i, j, k]):.1f}") for k in range(len(few))]
        table.add_row(Text(f"{offset:.6g}"), Text(f"{margin:+.1f}", style="green" if margin >= 0 else "red"), *cells)
    return table


def offset_lines(job: Job, curve: OffsetCurve, least: LeastOffset | None) -> list[Text]:
    """What it comes to, and what it is held to."""
    own = offset_of(job.robot, job.tool)
    lines = [Text(f"deepest strokes with {how_deep(job.settings)}", style="dim")]
    lines.append(Text(f"as it is the tool has {_place(*own)}"))
    if least is None:
        i, j = np.unravel_index(np.argmax(curve.margin), curve.margin.shape)
        place = _place(float(curve.offsets[i]), float(curve.angles[j]))
        text = f"no offset examined drills every hole; the nearest, {place}, is"
        return [*lines, Text(f"{text} {-mm(curve.margin[i, j]):.3g} mm too shallow", style="yellow")]
    tip = ", ".join(f"{value + 0.0:.6g}" for value in np.round(mm(least.tool.T_flange_tcp[:3, 3]), 3))
    text = f"least offset that drills every hole without a reversal: {_place(least.offset, least.angle)}"
    lines.append(Text(f"{text}; tcp_mm: [{tip}], rpy_deg as it is", style="green"))
    return [*lines, Text("it is the least that was examined")] if least.fails_at is None else lines


def _place(offset: float, angle: float) -> str:
    return f"e = {mm(offset):.2f} mm at {deg(angle) + 0.0:.4g} deg"
