"""What the commands of recordings show: plain data, tables and lines."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from rich import box
from rich.table import Table
from rich.text import Text

from zerorev.cell.recordings.alignment import AlignedBy
from zerorev.cell.recordings.metrics import Metrics
from zerorev.cell.recordings.repeatability import Repeatability
from zerorev.cell.recordings.run import DrillingRun
from zerorev.cell.recordings.tip import PlannedHole
from zerorev.files.units import mm, plain
from zerorev.model._arrays import Array
from zerorev.model.finding import Finding
from zerorev.visible import one_line

__all__ = [
    "findings_of", "repeatability_data", "repeatability_lines", "run_data", "runs_lines", "runs_table",
]  # fmt: skip

ALIGNED: dict[AlignedBy, str] = {
    "commanded_torque": "first commanded torque",
    "commanded_position": "first change of the command",
    "measured_position": "first motion",
}
STYLES = {"error": "red", "warning": "yellow", "info": "dim"}


def findings_of(run: DrillingRun, found: Metrics) -> tuple[Finding, ...]:
    """Of the reading, of the tip and of the rate."""
    return run.recording.findings + run.findings + found.findings


def run_data(run: DrillingRun, found: Metrics, meant: PlannedHole | None) -> dict[str, Any]:
    """One recording's figures as plain data (docs/howto/recordings.md)."""
    horizontal, vertical = mm(found.deviation_parts)
    data = {
        "source": run.recording.source,
        "hole": None if meant is None else meant.drilling.hole.id,
        "alignment": {
            "by": run.alignment.by, "time_s": run.alignment.time, "sample": run.alignment.sample,
        },
        "path_mm": mm(found.path_length),
        "window_mm": mm(found.window),
        "deviation_mm": {
            "max": mm(found.deviation_max), "rms": mm(found.deviation_rms), "horizontal": horizontal,
            "vertical": vertical,
        },
        "offset_mm": None if found.offset is None else mm(found.offset),
        "reversals_per_joint": found.reversals_per_joint,
        "feed_mm_s": mm(run.feed),
        "samples": int(run.recording.time.size),
        "interval_ms": run.recording.interval * 1e3,
        "other_channels": list(run.recording.other_channels),
        "findings": [
            {"level": each.level, "kind": each.kind, "message": each.message} for each in findings_of(run, found)
        ],
    }  # fmt: skip
    return dict(plain(data))


def runs_table(found: Sequence[tuple[DrillingRun, Metrics]]) -> Table:
    """One row per recording."""
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for name in (
        "recording", "begins at", "feed\n[mm/s]", "path\n[mm]", "window\n[±mm]", "deviation max\n[mm]", "rms\n[mm]",
        "horizontal, vertical\n[mm]", "offset of mean\n[mm]", "reversals\nA1..A6",
    ):  # fmt: skip
        table.add_column(Text(name), justify="left" if name in ("recording", "begins at") else "right")
    for run, each in found:
        horizontal, vertical = mm(each.deviation_parts)
        offset = "?" if each.offset is None else f"{mm(each.offset):.3f}"
        reversals = "?" if each.reversals_per_joint is None else " ".join(map(str, each.reversals_per_joint))
        table.add_row(
            Text(one_line(run.recording.source)), Text(f"{run.alignment.time:.3f} s"), Text(f"{mm(run.feed):.1f}"),
            Text(f"{mm(each.path_length):.1f}"), Text(f"{mm(each.window):.4g}"),
            Text(f"{mm(each.deviation_max):.3f}"), Text(f"{mm(each.deviation_rms):.3f}"),
            Text(f"{horizontal:.3f}, {vertical:.3f}"), Text(offset), Text(reversals),
        )  # fmt: skip
    return table


def runs_lines(found: Sequence[tuple[DrillingRun, Metrics]]) -> list[Text]:
    """By what each recording is aligned, and its findings."""
    lines = []
    for run, each in found:
        source = one_line(run.recording.source)
        lines.append(Text(f"{source}: aligned at its {ALIGNED[run.alignment.by]}", style="dim"))
        lines += [
            Text(f"{source}: {finding.level}: {one_line(finding.message)}", style=STYLES[finding.level])
            for finding in findings_of(run, each)
        ]
    return lines


def repeatability_data(found: Repeatability) -> dict[str, Any]:
    """Figures of several recordings of one motion as plain data."""
    data = {
        "recordings": found.runs,
        "torque_nm": None
        if found.torque_max is None or found.torque_rms is None
        else {"max": found.torque_max, "rms": found.torque_rms},
        "tip_mm": {"max": mm(found.tip_max), "radius": None if found.radius is None else mm(found.radius)},
        "path_mm": mm(found.path[-1] - found.path[0]),
    }
    return dict(plain(data))


def repeatability_lines(found: Repeatability) -> list[Text]:
    """How alike recordings of one motion are."""
    lines = [Text(f"tip: {mm(found.tip_max):.4f} mm apart at most, of {found.runs} recordings")]
    if found.radius is not None:
        lines.append(Text(f"tip: {mm(found.radius):.4f} mm, mean + 3 sigma (as ISO 9283's path repeatability)"))
    if found.torque_max is None or found.torque_rms is None:
        return [*lines, Text("torque: not recorded in each of them", style="dim")]
    return [*lines, _joints("torque, greatest difference", found.torque_max), _joints("torque, rms", found.torque_rms)]


def _joints(what: str, values: Array) -> Text:
    words = ", ".join(f"A{n} {round(value, 9) + 0.0:.4g}" for n, value in enumerate(values.tolist(), 1))
    return Text(f"{what} [Nm]: {words}")
