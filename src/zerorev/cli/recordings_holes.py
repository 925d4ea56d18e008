"""`zerorev recordings holes`: what a measuring machine says of drilled holes."""

from __future__ import annotations

from pathlib import Path

from zerorev.cli.common import FINE, recordings_app
from zerorev.report.words import terminal

__all__ = ["holes"]


@recordings_app.command(name="holes")
def holes(file: Path, /, *, json: bool = False) -> int:
    """Show measured holes: greatest position error, tilt, range of the diameter, roundness.

    Args:
        file: A table (CSV) with a row for each section: hole, depth_mm, diameter_mm, x_mm, y_mm, roundness_mm.
        json: Print the figures as JSON on standard output, and nothing else there.
    """
    from zerorev.cell.recordings.holes import read_holes
    from zerorev.report.words import measured_holes as shown

    found, unused = read_holes(file)
    if unused:
        terminal.note(f"columns that are not used: {', '.join(unused)}")
    if json:
        terminal.print_json(shown.holes_data(found))
    else:
        terminal.out().print(shown.holes_table(found))
    return FINE
