"""`zerorev recordings repeat`: how alike several recordings of one motion are."""

from __future__ import annotations

from pathlib import Path

from zerorev.cli.common import FINE, recordings_app
from zerorev.cli.recordings import GearRatio, planned, runs
from zerorev.report.words import terminal

__all__ = ["repeat"]


@recordings_app.command(name="repeat")
def repeat(
    *files: Path,
    plan: Path | None = None,
    hole: str | None = None,
    channels: Path | None = None,
    gear_ratio: GearRatio = None,
    json: bool = False,
) -> int:
    """Compare recordings of the same motion at equal path distance: torque of each joint, and the tip (thesis §5.2).

    Args:
        files: Two or more recordings, as `recordings show` reads them.
        plan: The plan file (JSON) that was run: its robot and tool take recorded joints to the tip.
        hole: Which of its holes; by default the only one.
        channels: What the channels of the files mean (YAML), where their names do not say it.
        gear_ratio: By what the positions of a trace's drives are divided: six numbers with commas between them.
        json: Print the figures as JSON on standard output, and nothing else there.
    """
    from zerorev.cell.recordings.repeatability import repeatability
    from zerorev.report.words import recordings as shown

    found = repeatability([run for run, _ in runs(files, planned(plan, hole), channels, gear_ratio, None)])
    if json:
        terminal.print_json(shown.repeatability_data(found))
    else:
        terminal.print_lines(shown.repeatability_lines(found))
    return FINE
