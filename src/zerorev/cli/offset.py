"""`zerorev offset`: how far the tool should stand off the wrist."""

from __future__ import annotations

import math
from pathlib import Path

from zerorev.cli.common import FINE, FOUND, Output, app, check_outputs, job_of, need, numbers
from zerorev.report.words import terminal

__all__ = ["offset"]


@app.command
def offset(
    job: Path,
    /,
    *,
    output: Output = None,
    offsets_mm: str = "0:200:10",
    angles_deg: str | None = None,
    figure: Path | None = None,
    json: bool = False,
) -> int:
    """Find how deep each hole goes as the tool is offset from the wrist, and the least offset that drills the job.

    Args:
        job: The job file (YAML): robot, tool, holes.
        output: Where to write the answer (JSON). Without it the answer is only shown.
        offsets_mm: Distances of the drill axis from the wrist centre, START:STOP:STEP or a list: 30,60,90.
        angles_deg: Where the axis lies as seen from the wrist centre, likewise; by default where it lies now.
        figure: Picture to draw (PNG).
        json: Print the answer as JSON on standard output, and nothing else there.
    """
    from zerorev.files.output import write_bytes, write_text

    check_outputs((output, figure), job)
    if figure is not None:
        need("matplotlib", "matplotlib", "--figure", "figures")
    offsets = [value / 1e3 for value in numbers(offsets_mm, "--offsets-mm")]
    angles = None if angles_deg is None else [math.radians(value) for value in numbers(angles_deg, "--angles-deg")]
    wanted = job_of(job)

    from zerorev.files.text import json_text
    from zerorev.placement.tool_offset import least_offset, offset_curve
    from zerorev.report.words import offset as shown

    strokes = len(wanted.holes) * len(offsets) * len(angles or [0])
    with terminal.progress("deepest strokes", strokes) as progress:
        curve = offset_curve(wanted.robot, wanted.tool, wanted.holes, wanted.settings, offsets, angles, progress)
    with terminal.busy("closing in on the least offset"):
        least = least_offset(wanted, curve)
    data = shown.offset_data(wanted, curve, least)
    if output is not None:
        write_text(output, json_text(data))
    if figure is not None:
        from zerorev.report.figures.offset import tool_offset
        from zerorev.report.figures.style import png

        write_bytes(figure, png(tool_offset(wanted, curve, least)))
    if json:
        terminal.print_json(data)
    else:
        terminal.out().print(shown.offset_table(wanted, curve, least))
        terminal.print_lines(shown.offset_lines(wanted, curve, least))
        for what, path in (("answer", output), ("figure", figure)):
            if path is not None:
                terminal.say(f"{what} written to {path}")
    return FOUND if least is None else FINE
