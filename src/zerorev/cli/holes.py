"""`zerorev holes`: the holes of a CAD file, to be looked through before they are drilled."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

from zerorev.cli.common import FINE, Output, app, check_outputs
from zerorev.errors import InputError
from zerorev.report.words import terminal

__all__ = ["holes"]


@app.command
def holes(
    file: Path,
    /,
    *,
    select: str | None = None,
    unit: Literal["mm", "m", "in"] | None = None,
    surface: Path | None = None,
    output: Output = None,
    json: bool = False,
) -> int:
    """List the holes of a CAD file: kind, diameter, entry, direction, depth, and what was assumed (extra `cad`).

    Args:
        file: A STEP file (.step, .stp), a DXF file (.dxf), or a job whose holes are in one; with --surface a CSV file
            of points, where the drill enters.
        select: Which of them, as `select` of a job says it, e.g. "{kind: [through], diameter_mm: [4.9, 5.1]}".
        unit: Of the file's numbers, in place of the one that it states.
        surface: The part, as STL, OBJ, PLY (in mm) or STEP: the points are drilled against its normals.
        output: Write them as a CSV file, which a job takes under `holes`, e.g. after it was edited.
        json: Print JSON on standard output, and nothing else there.
    """
    from zerorev.files.cad.listed_csv import csv_of
    from zerorev.files.io import read_cad_holes, read_points
    from zerorev.files.output import write_text
    from zerorev.report.words import cad_holes as shown

    check_outputs([output], file, *([] if surface is None else [surface]))
    with terminal.busy("Reading ..."):
        if surface is None:
            listed = read_cad_holes(file, select=select, unit=unit)
        elif select is not None:
            raise InputError("stands beside --surface", where="--select", accepted="one of the two")
        else:
            listed = read_points(file, surface, unit=unit)
    if output is not None:
        write_text(output, csv_of(listed))
    if json:
        terminal.print_json(shown.cad_data(listed))
    else:
        terminal.out().print(shown.cad_table(listed))
        terminal.print_lines([*shown.cad_summary(listed), *shown.cad_findings(listed)])
        if output is not None:
            terminal.say(f"{len(listed.holes)} holes written to {output}")
    for note in listed.notes:
        terminal.note(note)
    return FINE
