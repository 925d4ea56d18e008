"""Between the disk and plain data: text, JSON and CSV in, JSON out; YAML is in `zerorev.files.yaml_text`.

For any bytes, reading them ends in plain data or in an `InputError` that names the file and the line. Sizes
and counts are limited, so that it ends soon, and in a memory that is known beforehand (docs/security.md has figures).
"""

from __future__ import annotations

import csv
import io
import json
import math
import os
import re
import reprlib
import stat
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, BinaryIO, NoReturn

from zerorev.errors import InputError
from zerorev.visible import as_json, table_cell

__all__ = [
    "MAX_BYTES",
    "MAX_DEPTH",
    "MAX_KEYS",
    "MAX_ROWS",
    "MAX_VALUES",
    "Document",
    "csv_rows",
    "csv_text",
    "json_document",
    "json_pieces",
    "json_text",
    "opened",
    "read_bytes",
    "read_text",
    "row_of",
    "table_lines",
]

MAX_BYTES = 64 * 2**20  # of one file
MAX_VALUES = 4_000_000  # of one JSON file: those of some 20,000 holes of a plan
MAX_DEPTH = 40  # of lists and mappings within each other
MAX_KEYS = 1_000  # of one mapping
MAX_ROWS = 200_000  # of one table
LINE_WIDTH = 160

FieldPath = tuple[str | int, ...]


@dataclass(frozen=True)
class Document:
    """Plain data and where it stood.

    Attributes:
        file: how messages name the source.
        data: mappings, lists, text, numbers, booleans and None.
        lines: line of each field, by its path, where known.
    """

    file: str
    data: Any
    lines: dict[FieldPath, int] = field(default_factory=dict)

    def where(self, path: FieldPath = ()) -> str:
        """File, line and field as a message names them, e.g. `job.yaml, line 7, holes[2].depth_mm`."""
        return ", ".join(part for part in (self.file, self.place(path)) if part)

    def place(self, path: FieldPath) -> str:
        """Line and field as a message names them within the file, e.g. `line 7, holes[2].depth_mm`."""
        known = next((path[:n] for n in range(len(path), -1, -1) if path[:n] in self.lines), None)
        dotted = "".join(f"[{part}]" if isinstance(part, int) else f".{_key(part)}" for part in path).lstrip(".")
        line = "" if known is None else f"line {self.lines[known]}"
        return ", ".join(part for part in (line, dotted) if part)


def _key(key: str) -> str:
    """A key as a message can show it: in quotes where it is long or strange."""
    return key if key.isidentifier() and len(key) < 40 else reprlib.repr(key)


def read_text(path: Path, accepted: str) -> str:
    """The text of a file.

    Args:
        path: which.
        accepted: what kind of file belongs here, for the message.

    Raises:
        InputError: as `read_bytes`, or not UTF-8.
    """
    try:
        return read_bytes(path, accepted).decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(
            f"is not text (byte {error.start} is not UTF-8)", where=str(path), accepted=f"{accepted}, in UTF-8"
        ) from None


def read_bytes(path: Path, accepted: str, most: int = MAX_BYTES) -> bytes:
    """The content of a file.

    Args:
        path: which.
        accepted: what kind of file belongs here, for the message.
        most: bytes that it may have.

    Raises:
        InputError: no such file, a folder, too large, not readable.
    """
    with opened(path, accepted) as stream:
        content = stream.read(most + 1)
    if len(content) > most:
        raise InputError(f"is larger than {most // 2**20} MiB", where=str(path), accepted=accepted)
    return content


@contextmanager
def opened(path: Path, accepted: str) -> Iterator[BinaryIO]:
    """A file that is read piece by piece.

    Args:
        path: which.
        accepted: what kind of file belongs here, for the message.

    Raises:
        InputError: no such file, a folder, not a regular file, not readable, also while it is read.
    """
    try:
        stream = open(path, "rb", opener=_not_waiting)  # noqa: SIM115  closed below
    except _NotAFileError as error:
        raise InputError(str(error), where=str(path), accepted=accepted) from None
    except FileNotFoundError:
        raise InputError("no such file", where=str(path), accepted=accepted) from None
    except (OSError, ValueError) as error:  # ValueError: a null byte in the path
        raise _unreadable(path, accepted, error) from None
    with stream:
        try:
            yield stream
        except OSError as error:
            raise _unreadable(path, accepted, error) from None


def _unreadable(path: Path, accepted: str, error: OSError | ValueError) -> InputError:
    why = error.strerror if isinstance(error, OSError) else str(error)
    return InputError(f"cannot be read: {why}", where=repr(str(path)), accepted=accepted)


class _NotAFileError(Exception):
    """What is there instead."""


def _not_waiting(path: str, flags: int) -> int:
    """Open a regular file, and nothing else: a pipe would be waited for, a device may never end."""
    number = os.open(path, flags | getattr(os, "O_NONBLOCK", 0))
    kind = os.fstat(number).st_mode
    if stat.S_ISREG(kind):
        return number
    os.close(number)
    raise _NotAFileError("is a folder" if stat.S_ISDIR(kind) else "is not a regular file")


# --- JSON -------------------------------------------------------------------------------------------------------------


def json_document(text: str, file: str) -> Document:
    """Plain data of a JSON text.

    Raises:
        InputError: a syntax error, NaN or infinity, a key used twice, too deep a nesting, too many values.
    """
    if sum(map(text.count, ",[{")) > MAX_VALUES:  # of those within texts some too many
        raise InputError(f"more than {MAX_VALUES:,} values", where=file, accepted=f"{MAX_VALUES:,} or less")

    def no_twins(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        mapping = dict(pairs)
        if len(mapping) > MAX_KEYS:
            raise InputError(f"a mapping of {len(mapping):,} keys", where=file, accepted=f"{MAX_KEYS:,} or less")
        if len(mapping) < len(pairs):
            seen: set[str] = set()
            twin = next(key for key, _ in pairs if key in seen or seen.add(key))  # type: ignore[func-returns-value]
            raise InputError(f"the key {twin!r} is used twice", where=file, accepted="each key once")
        return mapping

    def no_constant(name: str) -> NoReturn:
        raise InputError(f"{name} is not a number", where=file, accepted="finite numbers")

    try:
        return Document(file, json.loads(text, object_pairs_hook=no_twins, parse_constant=no_constant))
    except json.JSONDecodeError as error:
        cut = " (is the file cut short?)" if error.pos >= len(text.rstrip()) else ""
        raise InputError(
            f"{error.msg[0].lower()}{error.msg[1:]}{cut}",
            where=f"{file}, line {error.lineno}, column {error.colno}",
            accepted="JSON",
        ) from None
    except RecursionError:
        raise InputError("is nested too deep", where=file, accepted="JSON") from None
    except ValueError:
        raise InputError("a number has too many digits", where=file, accepted="finite numbers") from None


def json_text(data: Any) -> str:
    """Plain data as JSON that people can read: what fits on one line stands on one."""
    return as_json(_laid_out(data, 0, 0)) + "\n"


def json_pieces(data: dict[str, Any]) -> Iterator[str]:
    """The `json_text` of a mapping piece by piece; an iterator among its values is a list of long entries."""
    before = "{"
    for key, value in data.items():
        name = f"\n  {json.dumps(key, ensure_ascii=False)}: "
        if isinstance(value, Iterator):
            yield before + name
            between = "["
            for entry in value:
                yield f"{between}\n    {as_json(_laid_out(entry, 4, 1))}"
                between = ","
            yield "\n  ]"
        else:
            yield before + name + as_json(_laid_out(value, 2, len(name) - 2))
        before = ","
    yield "\n}\n"


_on_a_line = json.JSONEncoder(ensure_ascii=False, allow_nan=False).encode  # made once: `json.dumps` does at each call


def _laid_out(data: Any, indent: int, used: int) -> str:
    line = _on_a_line(data)
    if not isinstance(data, (dict, list)) or not data or (indent > 0 and indent + used + len(line) <= LINE_WIDTH):
        return line
    inner, close = "\n" + " " * (indent + 2), "\n" + " " * indent
    if isinstance(data, dict):
        names = {key: _on_a_line(key) + ": " for key in data}
        entries = [names[key] + _laid_out(value, indent + 2, len(names[key]) + 1) for key, value in data.items()]
        return "{" + inner + ("," + inner).join(entries) + close + "}"
    return "[" + inner + ("," + inner).join(_laid_out(value, indent + 2, 1) for value in data) + close + "]"


# --- CSV --------------------------------------------------------------------------------------------------------------


# blanks and ends of lines to Python, too
CONTROL = re.compile(r"[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f\u2028\u2029]")


def table_lines(text: str, file: str) -> list[str]:
    """The lines of a table.

    Raises:
        InputError: a control character, which one program takes for a blank and another for the end of a line.
    """
    lines = re.split(r"\r\n|\n|\r", text.removesuffix("\n"))
    for number, line in enumerate(lines, 1):
        if CONTROL.search(line):
            where = f"{file}, line {number}" if file else f"line {number}"
            raise InputError("holds a control character", where=where, accepted="CSV")
    return lines


def csv_rows(
    text: str, file: str, label: str, numbers: tuple[str, ...], optional: tuple[str, ...] = ()
) -> Iterator[tuple[int, dict[str, Any]]]:
    """Rows of a CSV table with one column of text and several of finite numbers, in any order of columns.

    Args:
        text: of the file.
        file: how messages name it.
        label: name of the text column.
        numbers: names of the number columns.
        optional: those of them that may be missing.

    Yields:
        The row's line, and its cells by the names of their columns.

    Raises:
        InputError: a missing, unknown or repeated column, a cell too many or too few, a cell that is not a number,
            too many rows.
    """
    columns = (label, *numbers)
    accepted = f"the columns {','.join(columns)}, separated by commas"
    reader, rows = csv.reader(table_lines(text, file), strict=True), 0
    try:
        header = [cell.strip() for cell in next(reader, [])]
        where = f"{file}, line 1"
        if missing := [name for name in columns if name not in (*header, *optional)]:
            raise InputError(f"no column {', '.join(missing)}", where=where, accepted=accepted)
        if unknown := [name for name in header if name not in columns]:
            raise InputError(f"unknown column {', '.join(map(repr, unknown))}", where=where, accepted=accepted)
        if len(header) > len(set(header)):
            raise InputError("a column appears twice", where=where, accepted=accepted)
        for cells in reader:
            where = f"{file}, line {reader.line_num}"
            if not any(cell.strip() for cell in cells):
                continue
            if (rows := rows + 1) > MAX_ROWS:
                raise InputError(f"more than {MAX_ROWS:,} rows", where=where, accepted=f"{MAX_ROWS:,} or less")
            yield reader.line_num, row_of(header, cells, label, where)
    except csv.Error as error:
        raise InputError(str(error), where=f"{file}, line {reader.line_num}", accepted="CSV") from None


def csv_text(rows: Iterable[Iterable[object]]) -> str:
    """Rows as a CSV file with plain line feeds: None is an empty cell, and no text is a formula to a spreadsheet."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    for row in rows:
        writer.writerow(table_cell(cell) if isinstance(cell, str) else cell for cell in row)
    return stream.getvalue()


def row_of(header: list[str], cells: list[str], label: str, where: str) -> dict[str, Any]:
    """One row of a table by the names of its columns: one of text, the others of finite numbers.

    Args:
        header: names of the columns.
        cells: of the row.
        label: name of the text column.
        where: how a message names the row, or an empty text where that is plain.

    Raises:
        InputError: a cell too many or too few, a cell that is not a number.
    """
    if len(cells) != len(header):
        raise InputError(f"{len(cells)} cells", where=where, accepted=f"{len(header)} cells")
    row = {name: cell.strip() for name, cell in zip(header, cells, strict=True)}
    places = {name: f"{where}, column {name}" if where else f"column {name}" for name in row}
    values = {name: _number(cell, places[name]) for name, cell in row.items() if name != label}
    return {label: row[label]} | values


def _number(text: str, where: str) -> float:
    try:
        value = float(text) if "_" not in text else math.nan  # Python's own 1_000 is not a number to anybody else
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InputError(f"{text!r} is not a finite number", where=where, accepted="a finite number, e.g. 12.5")
    return value


# --- writing ----------------------------------------------------------------------------------------------------------
