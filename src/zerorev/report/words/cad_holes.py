"""What the command `holes` shows: the holes of a CAD file as a table, and how many there are of each kind."""

from __future__ import annotations

from collections import Counter
from typing import Any

from rich import box
from rich.table import Table
from rich.text import Text

from zerorev.files.cad.as_listed import CadHoles
from zerorev.files.cad.listed_csv import rows_of
from zerorev.files.stated_forms import data_of
from zerorev.files.table_layout import DIRECTION, ENTRY

__all__ = ["MOST_SHOWN", "cad_data", "cad_findings", "cad_summary", "cad_table"]

MOST_SHOWN = 200  # rows on a terminal
COLUMNS = ("hole", "kind", "diameter\n[mm]", "entry\n[mm]", "direction", "depth\n[mm]", "solid or\nlayer", "assumed")


def cad_table(listed: CadHoles) -> Table:
    """One row per hole, in the part frame; the first `MOST_SHOWN`."""
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for name in COLUMNS:
        table.add_column(Text(name), justify="right" if "[mm]" in name else "left", no_wrap=name == "hole")
    for row, _ in zip(rows_of(listed), range(MOST_SHOWN), strict=False):
        entry = "  ".join(f"{row[name]:9.3f}" for name in ENTRY)
        direction = "  ".join(f"{row[name] + 0.0:7.4f}" for name in DIRECTION)
        about = "; ".join(each for each in (row["mouth"], row["assumed"]) if each)
        table.add_row(
            *map(Text, (row["id"], row["kind"], _number(row["diameter_mm"]), entry, direction)),
            *map(Text, (_number(row["depth_mm"]), row["of"] or "", about)),
        )
    return table


def cad_summary(listed: CadHoles) -> list[Text]:
    """How many holes there are of each kind and diameter, one line for each."""
    counts = Counter((row["kind"], row["diameter_mm"]) for row in rows_of(listed))
    wide = len(str(max(counts.values())))
    order = sorted(counts.items(), key=lambda each: (each[0][0], each[0][1] or 0.0))
    lines = [f"{count:{wide}} {kind}{'' if width is None else f', {width:.4g} mm'}" for (kind, width), count in order]
    if len(listed.holes) > MOST_SHOWN:
        lines.append(f"{len(listed.holes) - MOST_SHOWN:,} more than are shown; -o FILE.csv has all of them")
    return [Text(line) for line in lines]


def cad_findings(listed: CadHoles) -> list[Text]:
    """What was assumed, and what is probably wrong, one line for each."""
    styles = {"error": "bold red", "warning": "yellow", "info": "cyan"}
    return [Text.assemble((f"{each.level:<8}", styles[each.level]), each.message) for each in listed.said]


def cad_data(listed: CadHoles) -> dict[str, Any]:
    """The same as plain data, all of it."""
    return {
        "holes": list(rows_of(listed)),
        "findings": [data_of(finding) for finding in listed.said],
        "notes": list(listed.notes),
    }


def _number(value: float | None) -> str:
    return "?" if value is None else f"{value:.3f}"
