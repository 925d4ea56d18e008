"""Measured holes: a table of diameter, place and roundness by depth, as measuring machines write it."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from zerorev.cell.recordings.cells import number, rows_of
from zerorev.errors import InputError
from zerorev.files.text import read_bytes
from zerorev.model._arrays import Array
from zerorev.model.measured_hole import MeasuredHole
from zerorev.visible import one_line

__all__ = ["COLUMNS", "read_holes"]

COLUMNS = ("hole", "depth_mm", "diameter_mm", "x_mm", "y_mm", "roundness_mm")
MAX_ROWS = 200_000
_ACCEPTED = f"the columns {', '.join(COLUMNS)}; hole, depth_mm, and one or more of the others"


def read_holes(path: str | Path) -> tuple[tuple[MeasuredHole, ...], tuple[str, ...]]:
    """The holes of a table, in the order in which they come first, and the columns that are not used.

    Of a hole the sections may come in any order, and a column may be empty in all of them. `x_mm` and `y_mm` are the
    place of the section's centre from the nominal axis, across it.

    Raises:
        InputError: not such a table; the message names the line.
    """
    source = str(path)
    rows = rows_of(read_bytes(Path(path), "measured holes (CSV)"), source)
    line, header = next(rows, (1, []))
    names = [name.lower() for name in header]
    where = f"{source}, line {line}"
    if missing := [name for name in COLUMNS[:2] if name not in names]:
        raise InputError(f"no column {', '.join(missing)}", where=where, accepted=_ACCEPTED)
    if twice := [name for name in COLUMNS if names.count(name) > 1]:
        raise InputError(f"the column {twice[0]} is there twice", where=where, accepted="each column once")
    found: dict[str, list[tuple[int, dict[str, float]]]] = {}
    for n, (line, cells) in enumerate(rows):
        where = f"{source}, line {line}"
        if n == MAX_ROWS:
            raise InputError(f"more than {MAX_ROWS:,} rows", where=where, accepted=f"{MAX_ROWS:,} or less")
        if len(cells) != len(names):
            raise InputError(f"{len(cells)} cells", where=where, accepted=f"{len(names)} cells, as in the header")
        row = dict(zip(names, cells, strict=True))
        if not row["hole"]:
            raise InputError("no hole", where=where, accepted="the hole's id in each row")
        values = {
            name: number(row[name], f"{where}, column {name}")
            for name in COLUMNS[1:]
            if row.get(name) or name == "depth_mm"
        }
        found.setdefault(one_line(row["hole"]), []).append((line, values))
    if not found:
        raise InputError("no rows", where=source, accepted="a header and a row for each section")
    unused = tuple(one_line(name) for name in header if name.lower() not in COLUMNS)
    return tuple(_hole(name, sections, source) for name, sections in found.items()), unused


def _hole(name: str, sections: list[tuple[int, dict[str, float]]], source: str) -> MeasuredHole:
    lines = f"{source}, lines {sections[0][0]} to {sections[-1][0]}"
    ordered = sorted((values for _, values in sections), key=lambda values: values["depth_mm"])
    columns: dict[str, Array] = {}
    for column in COLUMNS[1:]:
        there = [values[column] for values in ordered if column in values]
        if len(there) == len(ordered):
            columns[column] = np.array(there) * 1e-3
        elif there:
            raise InputError(
                f"hole {name}: {column} is empty in {len(ordered) - len(there)} of {len(ordered)} rows", where=lines,
                accepted="a column that is full or empty for a hole",
            )  # fmt: skip
    if ("x_mm" in columns) != ("y_mm" in columns):
        raise InputError(f"hole {name}: x_mm or y_mm without the other", where=lines, accepted="both or neither")
    centre = np.stack([columns["x_mm"], columns["y_mm"]], axis=1) if "x_mm" in columns else None
    try:
        return MeasuredHole(
            name, columns["depth_mm"], columns.get("diameter_mm"), centre, columns.get("roundness_mm")
        )  # fmt: skip
    except InputError as error:
        raise InputError(error.what, where=f"{lines}, {error.where}", accepted=error.accepted) from None
