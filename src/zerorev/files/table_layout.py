"""How a table of holes is laid out: what separates its cells, which line is the header, which column is what, in mm.

CAD systems put titles above the header and a row of units below it, name columns as they like, and add more of them.
What is needed is found by its name; a line that could be a hole is never taken for anything else.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from difflib import get_close_matches
from typing import Literal

from zerorev.errors import InputError
from zerorev.files.table_numbers import Decimal, is_number
from zerorev.files.table_units import MILLIMETRES, Unit, factor_of, unit_of_name, units_row

__all__ = [
    "COLUMNS", "DIRECTION", "ENTRY", "EXIT", "KNOWN", "OPTIONAL", "POINT", "Given", "Layout", "is_comment", "layout_of",
    "looks_like_hole", "split", "wrong_count",
]  # fmt: skip


Line = tuple[int, str]  # of the text, from 1

COLUMNS = ("id", "x_mm", "y_mm", "z_mm", "i", "j", "k", "depth_mm")
POINT, DIRECTION = COLUMNS[1:4], COLUMNS[4:7]
ENTRY = ("entry_x_mm", "entry_y_mm", "entry_z_mm")
EXIT = ("exit_x_mm", "exit_y_mm", "exit_z_mm")
OPTIONAL = ("depth_mm", "branch", "group")
KNOWN = (*COLUMNS, *ENTRY, *EXIT, "branch", "group")

DELIMITERS = {"\t": "tabs", ";": "semicolons", ",": "commas"}
MOST_NAMED = 12
MOST_TITLES = 200  # lines above the header
LEAST_NUMBERS = 6  # of a line that may be a hole: a point and a direction, or two points
ACCEPTED = f"the columns {','.join(COLUMNS)}, separated by commas, semicolons or tabs; or `columns: {{x_mm: NAME}}`"
_SEP = re.compile(r'"?sep=(.?)"?', re.IGNORECASE)
_BRACKETS = re.compile(r"[\s_]*[\[(]\s*([\w-]*)\s*[\])]$")


@dataclass(frozen=True)
class Given:
    """What a user says of a table.

    Attributes:
        columns: the table's name of a known column, by the latter.
        unit: of lengths, but for columns whose name says mm; None: mm.
        decimal: the sign; None: the one that is found.
        header: whether there has to be one.
    """

    columns: Mapping[str, str] = field(default_factory=dict)
    unit: Unit | None = None
    decimal: Decimal | None = None
    header: bool = True


@dataclass(frozen=True)
class Layout:
    """How a table is laid out.

    Attributes:
        delimiter: between cells.
        columns: of the columns that are used, by their name: the place of the cell, and millimetres in its unit.
        points: whether a hole is a point and a direction, the entry and a direction, or entry and exit.
        width: cells of a row up to the last column that has a name.
        header_width: cells of the header.
        ends_needed: whether the last column is used, and never empty: then more empty cells may follow it.
        rows: what stands below.
        notes: what is left out, in words.
    """

    delimiter: str
    columns: Mapping[str, tuple[int, float]]
    points: Literal["point", "entry", "both"]
    width: int
    header_width: int
    ends_needed: bool
    rows: list[Line]
    notes: tuple[str, ...] = ()


def split(line: str, delimiter: str) -> list[str]:
    """The cells of a line, without the blanks around them.

    Raises:
        csv.Error: a quote that does not end, or ends within a cell.
    """
    cells = line.split(delimiter) if '"' not in line else next(csv.reader([line], delimiter=delimiter, strict=True))
    return [cell.strip() for cell in cells]


def is_comment(line: str) -> bool:
    """Whether a line begins as comments do."""
    return line.lstrip().startswith(("#", "//", "%"))


def looks_like_hole(line: str) -> bool:
    """Whether a line has the numbers of a hole, regardless of what separates them and of a mark of a comment."""
    line = line.lstrip("#/% \t")
    for delimiter in DELIMITERS:
        try:
            numbers = sum(map(is_number, split(line, delimiter)))
        except csv.Error:
            numbers = 0
        if numbers >= LEAST_NUMBERS:
            return True
    return False


def layout_of(lines: list[Line], given: Given, *, depth_needed: bool, directions: bool = True) -> Layout:
    """How a table is laid out.

    Args:
        lines: that are not empty.
        given: what a user says of it.
        depth_needed: whether each hole needs a cell for its depth.
        directions: whether each needs those for its direction.

    Raises:
        InputError: no header where one is needed; a column that is missing, stands twice or contradicts another; units
            that contradict each other; a separator or a unit that is not read.
    """
    lines, stated = _stated_delimiter(lines)
    delimiters = [stated] if stated else list(DELIMITERS)
    meanings = _meanings(given.columns)
    at, delimiter, names = _header(lines, delimiters, meanings)
    if at is None:
        return _without_header(lines, delimiters, given, depth_needed=depth_needed)
    number, header = lines[at]
    cells, where = split(header, delimiter), f"line {number}, header"
    if given.columns:
        _check_mapped(given.columns, cells, where)
    if twice := next((name for n, name in enumerate(names) if name and name in names[:n]), None):
        raise InputError(f"a column appears twice: {twice}", where=where, accepted=ACCEPTED)
    places = {name: n for n, name in enumerate(names) if name is not None}
    points, used = _used(places, cells, where, depth_needed, directions)
    rows = lines[at + 1 :]
    units = units_row(*_first_cells(rows, delimiter), {name: places[name] for name in used})
    rows = rows[1:] if units else rows
    by_name = {name: unit_of_name(cells[places[name]]) for name in used if name.endswith("_mm")}
    if given.unit not in (None, "mm") and all(unit == "mm" for unit in by_name.values()):
        what = f"the names of its columns say mm, and the job says unit: {given.unit}"
        raise InputError(what, where=where, accepted="one of the two; or `columns: {x_mm: NAME}` with other names")
    columns = {name: (places[name], 1.0) for name in used}
    for name, unit in by_name.items():
        said = {"its name": unit, "the row of units": units.get(name), "the job": None if unit == "mm" else given.unit}
        columns[name] = places[name], factor_of(name, said, where)
    width = max(n for n, cell in enumerate(cells) if cell) + 1
    ends_needed = names[width - 1] in used and (names[width - 1] not in OPTIONAL or depth_needed)
    notes = _notes(at, [cell for n, cell in enumerate(cells) if cell and names[n] not in used])
    return Layout(delimiter, columns, points, width, len(cells), ends_needed, rows, notes)


def _stated_delimiter(lines: list[Line]) -> tuple[list[Line], str]:
    """The lines below `sep=;`, and its sign; an empty one where no line says so."""
    if not lines or (found := _SEP.fullmatch(lines[0][1].rstrip(" \r\n"))) is None:
        return lines, ""
    if found[1] not in DELIMITERS:
        where = f"line {lines[0][0]}"
        raise InputError(f"cells separated by {found[1]!r}", where=where, accepted="commas, semicolons or tabs")
    return lines[1:], found[1]


def _named(cell: str) -> str:
    return cell.casefold().strip()


def _literal(cell: str) -> str:
    """A name such as `X [mm]`, `i [-]` or `# id` as `x_mm`, `i` and `id`."""
    name = _BRACKETS.sub(r"_\1", _named(cell).lstrip("#%/ "))
    return re.sub(r"\s+", "_", name).rstrip("_-")


def _meanings(columns: Mapping[str, str]) -> dict[str, str]:
    """The known column of each name that a header may have.

    Raises:
        InputError: two columns have the same name.
    """
    found: dict[str, str] = {}
    for known, name in columns.items():
        if _named(name) in found:
            what = f"'{name}' stands for {found[_named(name)]} and {known}"
            raise InputError(what, where="columns", accepted="a name of its own for each column")
        found[_named(name)] = known
    return {name: name for name in KNOWN if name not in columns and name not in found} | found


def _header(
    lines: list[Line], delimiters: list[str], meanings: Mapping[str, str]
) -> tuple[int | None, str, list[str | None]]:
    """The line above the first row that names most columns: its place, what separates its cells, and what they are."""
    best: tuple[int, int | None, str, list[str | None]] = (0, None, delimiters[-1], [])
    for at, (_, line) in enumerate(lines[:MOST_TITLES]):
        for delimiter in delimiters:
            try:
                cells = split(line, delimiter)
            except csv.Error:
                continue
            names = [meanings.get(_named(cell), meanings.get(_literal(cell))) for cell in cells]
            known = len(set(names) - {None})
            if known > best[0]:
                best = known, at, delimiter, names
        if looks_like_hole(line):
            break
    return best[1:]


def _without_header(lines: list[Line], delimiters: list[str], given: Given, *, depth_needed: bool) -> Layout:
    """A table whose cells stand in the order of `COLUMNS`.

    Raises:
        InputError: it needs a header, or one stands below the first row.
    """
    first = next((line for line in lines if not is_comment(line[1])), lines[0] if lines else (1, ""))
    if given.header or given.columns or not looks_like_hole(first[1]):
        what = "no header" if looks_like_hole(first[1]) else f"no column {', '.join(COLUMNS)}"
        raise InputError(what, where=f"line {first[0]}", accepted=f"a header: {ACCEPTED}")
    if late := next((number for number, line in lines if "x_mm" in line.casefold()), None):
        raise InputError("a header below the first row", where=f"line {late}", accepted="a header above all rows")
    delimiter = next((each for each in delimiters if each in first[1]), delimiters[-1])
    factor = MILLIMETRES[given.unit or "mm"]
    columns = {name: (n, factor if name.endswith("_mm") else 1.0) for n, name in enumerate(COLUMNS)}
    return Layout(delimiter, columns, "point", len(COLUMNS), len(COLUMNS), depth_needed, lines)


def _check_mapped(columns: Mapping[str, str], cells: list[str], where: str) -> None:
    there = {_named(cell) for cell in cells}
    if absent := [f"'{name}' ({known})" for known, name in columns.items() if _named(name) not in there]:
        accepted = f"under `columns`, names of this table: {', '.join(cell for cell in cells if cell)}"
        raise InputError(f"no column {', '.join(absent)}", where=where, accepted=accepted)


def _used(
    places: Mapping[str, int], cells: list[str], where: str, depth_needed: bool, directions: bool
) -> tuple[Literal["point", "entry", "both"], list[str]]:
    """Which columns say where holes are, and those that are used."""
    points: Literal["point", "entry", "both"] = "point"
    needed: list[str] = ["id", *POINT, *(DIRECTION if directions else ())]
    if any(name in places for name in EXIT):
        points, needed = "both", ["id", *ENTRY, *EXIT]
    elif any(name in places for name in ENTRY):
        points, needed = "entry", ["id", *ENTRY, *(DIRECTION if directions else ())]
        if both := [name for name in POINT if name in places]:
            what = f"both {both[0]} and {next(name for name in ENTRY if name in places)}"
            raise InputError(what, where=where, accepted="one point and a direction, or entry and exit points")
    if depth_needed and points != "both":
        needed.append("depth_mm")
    if missing := [name for name in needed if name not in places]:
        others = [cell for n, cell in enumerate(cells) if cell and n not in places.values()]
        there = f"; there is {', '.join(map(repr, others[:12]))}" if others else ""
        raise InputError(f"no column {', '.join(missing)}{there}", where=where, accepted=ACCEPTED)
    used = [name for name in places if name in needed or (name in OPTIONAL and (name, points) != ("depth_mm", "both"))]
    absent = [name for name in OPTIONAL if name not in places and (name, points) != ("depth_mm", "both")]
    for n, cell in enumerate(cells):
        if n not in places.values() and (near := get_close_matches(_literal(cell), absent, n=1, cutoff=0.8)):
            what = f"the column '{cell}' is not known"
            raise InputError(what, where=where, accepted=f"did you mean '{near[0]}'? else another name")
    return points, used


def _first_cells(rows: list[Line], delimiter: str) -> tuple[int, list[str]]:
    """The line of the first row below the header, and its cells; none where a quote does not end."""
    if not rows:
        return 0, []
    try:
        return rows[0][0], split(rows[0][1], delimiter)
    except csv.Error:
        return 0, []


def wrong_count(cells: list[str], layout: Layout, where: str) -> InputError | None:
    """What is wrong with the number of cells of a row.

    Empty cells may follow a column that is never empty itself. Behind any other they may as well be what is left where
    a cell too many, as of a decimal comma, has moved all cells behind it.

    Args:
        cells: of the row.
        layout: of the table.
        where: how a message names the row.
    """
    filled = max((n for n, cell in enumerate(cells, 1) if cell), default=0)
    if layout.ends_needed:
        count, right = (max(filled, layout.width) if len(cells) > layout.width else len(cells)), layout.width
    else:
        count, right = len(cells), layout.header_width
    if count == right and filled <= layout.width:
        return None
    hint = "; a decimal comma needs another separator, or quotes" if count > right and layout.delimiter == "," else ""
    return InputError(f"{count if count != right else filled} cells", where=where, accepted=f"{right} cells{hint}")


def _notes(titles: int, left_out: list[str]) -> tuple[str, ...]:
    """What is left out of a table, in words."""
    notes = []
    if titles:
        notes.append(f"{titles} line{'s' * (titles > 1)} above the header left out")
    if left_out:
        more = f" and {len(left_out) - MOST_NAMED} more" if len(left_out) > MOST_NAMED else ""
        named = ", ".join(left_out[:MOST_NAMED])
        words = "columns left out, since they are" if len(left_out) > 1 else "column left out, since it is"
        notes.append(f"{words} not needed: {named}{more}")
    return tuple(notes)
