"""`zerorev recordings show`: what recordings of runs on a real arm hold, and what the thesis measures of them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from zerorev.cli.common import FINE, first_tool, numbers, recordings_app
from zerorev.errors import InputError
from zerorev.report.words import terminal

if TYPE_CHECKING:
    from zerorev.cell.recordings.metrics import Metrics
    from zerorev.cell.recordings.run import DrillingRun
    from zerorev.cell.recordings.tip import PlannedHole

__all__ = ["planned", "runs", "show"]

GearRatio = Annotated[str | None, Parameter(allow_leading_hyphen=True)]


@recordings_app.command(name="show")
def show(
    *files: Path,
    plan: Path | None = None,
    hole: str | None = None,
    channels: Path | None = None,
    gear_ratio: GearRatio = None,
    window_mm: float | None = None,
    json: bool = False,
) -> int:
    """Measure recordings the thesis' way: deviation from the mean path about the turn, its offset, reversals.

    Args:
        files: Recordings: a .dat or .r64 of a KRC4 trace, an RSI capture (.xml, .xml.gz), or a table (.csv).
        plan: The plan file (JSON) that was run: its robot and tool take recorded joints to the tip.
        hole: Which of its holes; by default the only one.
        channels: What the channels of the files mean (YAML), where their names do not say it.
        gear_ratio: By what the positions of a trace's drives are divided: six numbers with commas between them.
        window_mm: Path distance on each side of the turn that is measured; by default half a stroke.
        json: Print the figures as JSON on standard output, and nothing else there.
    """
    if not files:
        raise InputError("no recording", where="recordings show", accepted="one or more files")
    from zerorev.report.words import recordings as shown

    meant = planned(plan, hole)
    found = runs(files, meant, channels, gear_ratio, window_mm)
    if json:
        data = [shown.run_data(run, measured, meant) for run, measured in found]
        terminal.print_json(data[0] if len(data) == 1 else data)
        return FINE
    terminal.out().print(shown.runs_table(found))
    terminal.print_lines(shown.runs_lines(found))
    return FINE


def planned(plan: Path | None, hole: str | None) -> PlannedHole | None:
    """The hole of a plan that was run, or None where no plan is given."""
    if plan is None:
        if hole is not None:
            raise InputError("is of no plan", where="--hole", accepted="--plan beside it")
        return None
    from zerorev.cell.recordings.tip import planned_hole
    from zerorev.files.io import read_plan

    return planned_hole(first_tool(read_plan(plan)), hole)


def runs(
    files: Sequence[Path],
    meant: PlannedHole | None,
    channels: Path | None,
    gear_ratio: str | None,
    window_mm: float | None,
) -> list[tuple[DrillingRun, Metrics]]:
    """The drilling motion of each recording, and what is measured of it."""
    from dataclasses import replace

    from zerorev.cell.recordings.channels import NO_MAPPING, read_mapping
    from zerorev.cell.recordings.metrics import metrics
    from zerorev.cell.recordings.read import read_recording
    from zerorev.cell.recordings.run import drilling_run

    mapping = NO_MAPPING if channels is None else read_mapping(channels)
    if gear_ratio is not None:
        mapping = replace(mapping, gear_ratio=tuple(numbers(gear_ratio, "--gear-ratio")))
    window = None if window_mm is None else window_mm / 1e3
    found = []
    for file in files:
        with terminal.busy(f"reading {file.name}"):
            run = drilling_run(read_recording(file, mapping), meant)
            found.append((run, metrics(run, window)))
    return found
