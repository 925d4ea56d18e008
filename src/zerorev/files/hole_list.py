"""Lists of holes as tables, as CAD systems and spreadsheets write them: of each row the hole, or why it is none.

The command line and the app read them by the same code. A row is read rightly or refused with its line: what could be
two things is refused, and says so.
"""

from __future__ import annotations

import codecs
import csv
import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from typing import Any

from pydantic import ValidationError

from zerorev.errors import InputError
from zerorev.files.conversion import hole_from
from zerorev.files.hole_meaning import AS_IN_A_JOB, Meaning, as_in_a_job
from zerorev.files.schema import HoleForm, JobFile
from zerorev.files.table_layout import (
    DIRECTION,
    ENTRY,
    EXIT,
    OPTIONAL,
    POINT,
    Given,
    Layout,
    is_comment,
    layout_of,
    looks_like_hole,
    split,
    wrong_count,
)  # fmt: skip
from zerorev.files.table_numbers import Decimal, decimal_of, number_of
from zerorev.files.text import MAX_ROWS, Document, table_lines
from zerorev.files.validation import problems
from zerorev.model._arrays import Array
from zerorev.model.hole import Hole
from zerorev.model.tool import Tool

__all__ = [
    "MOST_PASTED", "HoleList", "ListedHole", "all_of", "given_of", "in_base_frame", "read_hole_list", "text_of_list",
]  # fmt: skip

MOST_PASTED = 20_000  # rows of a table that is pasted
ALONG_Z = tuple(zip(DIRECTION, (0.0, 0.0, 1.0), strict=True))
MOST_SHOWN = 20  # rows that a message names
MARKS = (
    (codecs.BOM_UTF8, "utf-8"), (codecs.BOM_UTF32_LE, "utf-32"), (codecs.BOM_UTF32_BE, "utf-32"),
    (codecs.BOM_UTF16_LE, "utf-16"), (codecs.BOM_UTF16_BE, "utf-16"),
)  # fmt: skip


@dataclass(frozen=True)
class ListedHole:
    """One row, and the hole that it is, or why it is none.

    Attributes:
        line: of the text, from 1.
        cells: as they stand there.
        form: of the hole as a job file has it, or None.
        hole: in the base frame, where it was made (`in_base_frame`), or None.
        problem: or None.
    """

    line: int
    cells: tuple[str, ...]
    form: HoleForm | None = None
    hole: Hole | None = None
    problem: InputError | None = None


@dataclass(frozen=True)
class HoleList:
    """The rows of a table.

    Attributes:
        rows: but for empty lines, comments and what stands above.
        notes: what was left out, in words.
    """

    rows: tuple[ListedHole, ...]
    notes: tuple[str, ...] = ()


def given_of(form: JobFile) -> Given:
    """What a job file says of the columns of its CSV.

    Args:
        form: the job.
    """
    columns = {} if form.columns is None else form.columns.model_dump(exclude_none=True)
    return Given(columns, form.unit, form.decimal)


def text_of_list(content: bytes) -> str:
    """The text of a table's file: UTF-8, or what its byte order mark says.

    Args:
        content: of the file.

    Raises:
        InputError: it is neither.
    """
    encoding = next((name for mark, name in MARKS if content.startswith(mark)), "utf-8")
    try:
        return content.decode(encoding).removeprefix("\ufeff")
    except UnicodeDecodeError as error:
        what = f"is not text (byte {error.start} is not {encoding.upper()})"
        accepted = "a CSV file in UTF-8, or in UTF-16 with a byte order mark"
        raise InputError(what, accepted=accepted) from None


def read_hole_list(
    text: str,
    given: Given,
    meaning: Meaning,
    *,
    depth_needed: bool = True,
    directions: bool = True,
    most: int = MAX_ROWS,
    taken: Collection[str] = (),
) -> HoleList:
    """The holes of a table, as a job file has them; a row that is none says why.

    Args:
        text: of the table.
        given: what a user says of its columns.
        meaning: what its points and directions are.
        depth_needed: whether each hole must have its depth.
        directions: whether its columns say where the drill points; else all point along Z, and points stay as they are.
        most: rows.
        taken: ids that other holes have.

    Raises:
        InputError: no row at all, too many; a header that cannot be used; numbers that can be read in two ways.
    """
    numbered = enumerate(table_lines(text.removeprefix("\ufeff"), ""), 1)
    lines = [(number, line) for number, line in numbered if line.strip("\t;, \xa0")]
    needed = depth_needed and meaning.depth_mm is None
    layout = layout_of(lines, given, depth_needed=needed, directions=directions)
    found, comments = _rows(layout)
    if not found:
        raise InputError("no holes", accepted="one row or more below the header")
    if len(found) > most:
        raise InputError(f"{len(found):,} rows", accepted=f"{most:,} at most")
    meaning = _as_pointed(meaning, layout) if directions else AS_IN_A_JOB
    decimal = given.decimal or _decimal(layout, found)
    rows, seen = [], set(taken)
    for row in found:
        if row.problem is None:
            row = _understood(row, layout, decimal, meaning, depth_needed)
        if row.form is not None and row.form.id in seen:
            twice = InputError(
                f"the id '{row.form.id}' is used twice", where=f"line {row.line}", accepted="ids that differ"
            )
            row = replace(row, form=None, problem=twice)
        elif row.form is not None:
            seen.add(row.form.id)
        rows.append(row)
    said = (f"{comments} comment{'s' * (comments > 1)} left out",) if comments else ()
    return HoleList(tuple(rows), (*layout.notes, *said))


def in_base_frame(listed: HoleList, reference: str | list[float], tool: Tool, T_base_part: Array) -> HoleList:
    """The same with the holes in the base frame; one that cannot be made is a problem of its row.

    Args:
        listed: a table.
        reference: what the spin is counted from, as in a job.
        tool: of the job.
        T_base_part: part frame, shape (4, 4), translation [m].
    """
    rows = []
    for row in listed.rows:
        if row.form is not None:
            try:
                row = replace(row, hole=hole_from(row.form, reference, tool, T_base_part))
            except InputError as error:
                row = replace(row, form=None, problem=_at(row.line, error))
        rows.append(row)
    return replace(listed, rows=tuple(rows))


def all_of(listed: HoleList) -> Sequence[ListedHole]:
    """The rows of a table, all of which are holes.

    Raises:
        InputError: some are not; it names them, up to `MOST_SHOWN`.
    """
    wrong = [row.problem for row in listed.rows if row.problem is not None]
    if len(wrong) == 1:
        raise wrong[0]
    if wrong:
        more = [f"... and {len(wrong) - MOST_SHOWN} more"] if len(wrong) > MOST_SHOWN else []
        listing = "".join(f"\n  - {each}" for each in [*wrong[:MOST_SHOWN], *more])
        raise InputError(f"{len(wrong)} of {len(listed.rows)} rows cannot be read{listing}")
    return listed.rows


def _rows(layout: Layout) -> tuple[list[ListedHole], int]:
    """The rows of a table in cells, and how many comments stand among them."""
    found, comments = [], 0
    for number, line in layout.rows:
        where = f"line {number}"
        if is_comment(line):
            if not looks_like_hole(line):
                comments += 1
                continue
            what = "begins like a comment and reads like a hole"
            accepted = 'a row, its id in quotes ("#1"); or delete the line'
            found.append(ListedHole(number, (line,), problem=InputError(what, where=where, accepted=accepted)))
            continue
        try:
            cells = split(line, layout.delimiter)
        except csv.Error as error:
            problem = InputError(str(error), where=where, accepted="CSV, each row on a line of its own")
            found.append(ListedHole(number, (line,), problem=problem))
            continue
        if not any(cells):
            continue
        found.append(ListedHole(number, tuple(cells), problem=wrong_count(cells, layout, where)))
    return found, comments


def _decimal(layout: Layout, rows: list[ListedHole]) -> Decimal:
    places = [at for name, (at, _) in layout.columns.items() if name != "id"]
    cells = ((row.line, row.cells[at]) for row in rows if row.problem is None for at in places)
    return decimal_of(cells, commas_separate=layout.delimiter == ",")


def _as_pointed(meaning: Meaning, layout: Layout) -> Meaning:
    """What the columns of a table say of its points takes the place of what the job says."""
    if layout.points == "both":
        return replace(AS_IN_A_JOB, breakthrough_mm=meaning.breakthrough_mm, branch=meaning.branch)
    return replace(meaning, point="entry") if layout.points == "entry" else meaning


def _understood(row: ListedHole, layout: Layout, decimal: Decimal, meaning: Meaning, depth_needed: bool) -> ListedHole:
    """The row with its hole, or with what is wrong with it."""
    where = f"line {row.line}"
    try:
        data = _data(row, layout, decimal, meaning)
        form = _form(Document("", data, {(): row.line}))
        hole = as_in_a_job(form, meaning)
        if hole.depth_mm is None and depth_needed:
            accepted = HoleForm.model_fields["depth_mm"].description or ""
            raise InputError("is missing", where="depth_mm", accepted=accepted)
        return replace(row, form=hole)
    except InputError as error:
        return replace(row, problem=error if error.where.startswith(where) else _at(row.line, error))


def _at(line: int, error: InputError) -> InputError:
    where = f"line {line}, {error.where}" if error.where else f"line {line}"
    return InputError(error.what, where=where, accepted=error.accepted)


def _form(document: Document) -> HoleForm:
    try:
        return HoleForm.model_validate(document.data)
    except ValidationError:
        raise problems(HoleForm, document)[0][1] from None


def _data(row: ListedHole, layout: Layout, decimal: Decimal, meaning: Meaning) -> dict[str, Any]:
    """A row as a hole of a job file, in millimetres."""
    values: dict[str, Any] = {}
    for name, (at, factor) in layout.columns.items():
        cell = row.cells[at]
        if name in ("id", "group"):
            values[name] = cell
        elif cell or name not in OPTIONAL or (name == "depth_mm" and meaning.depth_mm is None):
            values[name] = factor * number_of(cell, decimal, f"line {row.line}, column {name}")
    data = {"id": values["id"]}
    if layout.points == "both":
        entry, bottom = ([values[name] for name in names] for names in (ENTRY, EXIT))
        along = [b - a for a, b in zip(entry, bottom, strict=True)]
        data |= {"target_mm": bottom, "direction": along, "depth_mm": math.hypot(*along)}
    else:
        names = ENTRY if layout.points == "entry" else POINT
        data |= {
            "target_mm": [values[name] for name in names],
            "direction": [values.get(name, z) for name, z in ALONG_Z],
        }
        data |= {"depth_mm": values["depth_mm"]} if "depth_mm" in values else {}
    if "branch" in values:
        branch = values["branch"]
        data["branch"] = int(branch) if branch.is_integer() else branch
    if values.get("group"):
        data["group"] = values["group"]
    return data
