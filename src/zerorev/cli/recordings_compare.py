"""`zerorev recordings compare`: two recordings of one hole side by side, as a page."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from zerorev.cli.common import FINE, check_outputs, need, recordings_app
from zerorev.cli.recordings import GearRatio, planned, runs
from zerorev.report.words import terminal

__all__ = ["compare_recordings"]


@recordings_app.command(name="compare")
def compare_recordings(
    baseline: Path,
    optimised: Path,
    /,
    *,
    output: Annotated[Path, Parameter(name=["--output", "-o"])],
    plan: Path | None = None,
    hole: str | None = None,
    channels: Path | None = None,
    gear_ratio: GearRatio = None,
    window_mm: float | None = None,
) -> int:
    """Draw two recordings of one hole side by side: the kinds of the thesis' Figures 28 to 44, as one page.

    Args:
        baseline: A recording with constant spin, as `recordings show` reads it.
        optimised: A recording of the planned motion.
        output: The page (HTML); it needs no network.
        plan: The plan file (JSON) that was run: its robot and tool take recorded joints to the tip.
        hole: Which of its holes; by default the only one.
        channels: What the channels of the files mean (YAML), where their names do not say it.
        gear_ratio: By what the positions of a trace's drives are divided: six numbers with commas between them.
        window_mm: Path distance on each side of the turn that is measured; by default half a stroke.
    """
    from zerorev.files.output import write_text

    need("matplotlib", "matplotlib", "recordings compare", "figures")
    check_outputs((output,), *(path for path in (baseline, optimised, plan, channels) if path is not None))
    meant = planned(plan, hole)
    first, second = runs((baseline, optimised), meant, channels, gear_ratio, window_mm)

    from zerorev.report.figures.recordings import Compared
    from zerorev.report.figures.recordings_page import recordings_page
    from zerorev.report.words import recordings as shown

    with terminal.busy("drawing"):
        page = recordings_page(Compared(first, second, meant))
    write_text(output, page)
    terminal.out().print(shown.runs_table((first, second)))
    terminal.print_lines(shown.runs_lines((first, second)))
    terminal.say(f"page written to {output}")
    return FINE
