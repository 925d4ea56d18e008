"""Holes out of a spreadsheet: a piece of a table that was copied, or a CSV file, as other programs write them.

Reading it is kinder than reading a job's CSV file: cells may be separated by tabs, semicolons or commas, numbers may
have a decimal comma, the header may be missing; and each row is judged by itself, for a user to look at.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from typing import Any

from zerorev.errors import InputError
from zerorev.files.conversion import hole_from
from zerorev.files.schema import HoleForm
from zerorev.files.text import Document, row_of, table_lines
from zerorev.files.validation import problems
from zerorev.model._arrays import Array
from zerorev.model.hole import Hole
from zerorev.model.tool import Tool

__all__ = ["COLUMNS", "MAX_ROWS", "SheetRow", "sheet_rows"]

COLUMNS = ("id", "x_mm", "y_mm", "z_mm", "i", "j", "k", "depth_mm")
MAX_ROWS = 20_000
NUMBER = re.compile(r"[-+]?(\d+[.,]?\d*|[.,]\d+)([eE][-+]?\d+)?")


@dataclass(frozen=True)
class SheetRow:
    """One row, and the hole that it is, or why it is none.

    Attributes:
        line: of the text, from 1.
        cells: as they stand there.
        hole: or None.
        problem: or None.
    """

    line: int
    cells: tuple[str, ...]
    hole: Hole | None = None
    problem: InputError | None = None


def sheet_rows(
    text: str, reference: str | list[float], tool: Tool, T_base_part: Array, taken: Collection[str] = ()
) -> list[SheetRow]:
    """The rows of a table of holes; of empty lines and the header, none.

    Args:
        text: rows of the cells id, x_mm, y_mm, z_mm, i, j, k, depth_mm, in this order, or in that of a header.
        reference: what the spin is counted from, as in a job.
        tool: of the job.
        T_base_part: part frame, shape (4, 4), translation [m].
        taken: ids that other holes have.

    Raises:
        InputError: no row at all, too many, or a header with columns that are missing, unknown, or stand twice.
    """
    lines = list(_cells(text))
    header = _header(lines[0]) if lines else None
    rows = lines if header is None else lines[1:]
    if not rows:
        raise InputError("no rows", where="table", accepted=f"rows of the cells {', '.join(COLUMNS)}")
    if len(rows) > MAX_ROWS:
        raise InputError(f"{len(rows):,} rows", where="table", accepted=f"{MAX_ROWS:,} at most")
    found, seen = [], set(taken)
    for line, cells in rows:
        try:
            hole = _hole(header or list(COLUMNS), cells, reference, tool, T_base_part)
            if hole.id in seen:
                raise InputError(f"the id '{hole.id}' is used already", where="id", accepted="ids that differ")
            seen.add(hole.id)
            found.append(SheetRow(line, tuple(cells), hole))
        except InputError as error:
            found.append(SheetRow(line, tuple(cells), problem=error))
    return found


def _cells(text: str) -> Iterator[tuple[int, list[str]]]:
    """Of each line that is not empty, its number and its cells."""
    lines = table_lines(text, "table")
    first = next((line for line in lines if line.strip()), "")
    reader = csv.reader(lines, delimiter=next((each for each in "\t;" if each in first), ","))
    try:
        for cells in reader:
            stripped = [cell.strip() for cell in cells]
            while len(stripped) > len(COLUMNS) and not stripped[-1]:
                stripped.pop()  # empty columns to the right, as spreadsheets have them
            if any(stripped):
                yield reader.line_num, stripped
    except csv.Error as error:
        raise InputError(str(error), where=f"line {reader.line_num}", accepted="rows of cells") from None


def _header(first: tuple[int, list[str]]) -> list[str] | None:
    """The columns, if the first row names them: it has no number but perhaps in its id.

    Raises:
        InputError: they are not as they should be.
    """
    line, cells = first
    names = [cell.lower() for cell in cells]
    if not set(names) & set(COLUMNS) and any(NUMBER.fullmatch(cell) for cell in cells[1:]):
        return None
    where, accepted = f"line {line}, header", f"the columns {', '.join(COLUMNS)}, in any order, or no header"
    if unknown := [cell for cell, name in zip(cells, names, strict=True) if name not in COLUMNS]:
        raise InputError(f"unknown column {', '.join(map(repr, unknown))}", where=where, accepted=accepted)
    if missing := [name for name in COLUMNS if name not in names]:
        raise InputError(f"no column {', '.join(missing)}", where=where, accepted=accepted)
    if len(names) > len(set(names)):
        raise InputError("a column appears twice", where=where, accepted=accepted)
    return names


def _hole(header: list[str], cells: list[str], reference: str | list[float], tool: Tool, T_base_part: Array) -> Hole:
    row: dict[str, Any] = row_of(header, [*map(_with_point, header, cells), *cells[len(header) :]], "id", "")
    target, direction = ([row[name] for name in COLUMNS[n : n + 3]] for n in (1, 4))
    data = {"id": row["id"], "target_mm": target, "direction": direction, "depth_mm": row["depth_mm"]}
    for _, problem in problems(HoleForm, Document("", data)):
        raise problem
    return hole_from(HoleForm.model_validate(data), reference, tool, T_base_part)


def _with_point(name: str, cell: str) -> str:
    """A number with a decimal comma as one with a decimal point."""
    return cell.replace(",", ".") if name != "id" and NUMBER.fullmatch(cell) else cell
