"""Recordings as CSV: read as other programs write it, with semicolons and decimal commas too, and written."""

from __future__ import annotations

import math
from array import array
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from zerorev.cell.recordings.assembled import Channels, assembled
from zerorev.cell.recordings.cells import number, rows_of
from zerorev.cell.recordings.channels import ACCEPTED, MEMBERS, NO_MAPPING, Mapping, Meaning, column_name, meaning_of
from zerorev.errors import InputError
from zerorev.files.output import write_pieces
from zerorev.files.text import read_bytes
from zerorev.model._arrays import Array
from zerorev.model.recording import TIP_ARRAYS, Recording
from zerorev.visible import one_line, table_cell

__all__ = ["MAX_COLUMNS", "MAX_ROWS", "read_csv", "write_csv"]

MAX_ROWS = 500_000
MAX_COLUMNS = 400


def read_csv(path: str | Path, mapping: Mapping = NO_MAPPING) -> Recording:
    """A recording out of a CSV file with a header: `t_s` and joints or a tip, in any order, with any other columns.

    A commanded torque may be empty: none is commanded then.

    Raises:
        InputError: not such a file; the message names the line.
    """
    source = str(path)
    rows = rows_of(read_bytes(Path(path), "a recording (CSV)"), source)
    line, header = next(rows, (1, []))
    meanings = _meanings(header, mapping, f"{source}, line {line}")
    table, count = array("d"), 0
    last = -math.inf
    time_at = next(n for n, meaning in enumerate(meanings) if meaning is not None and meaning.member == "time")
    for line, cells in rows:
        where = f"{source}, line {line}"
        if len(cells) != len(header):
            raise InputError(f"{len(cells)} cells", where=where, accepted=f"{len(header)} cells, as in the header")
        table.extend(_value(cell, meaning, where) for cell, meaning in zip(cells, meanings, strict=True) if meaning)
        count += 1
        time = _value(cells[time_at], meanings[time_at], where)
        if time <= last:
            raise InputError(
                f"the time {time:g} does not rise after {last:g}", where=where, accepted="times that rise row by row"
            )
        last = time
        if count > MAX_ROWS:
            raise InputError(f"more than {MAX_ROWS:,} rows", where=where, accepted=f"{MAX_ROWS:,} or less")
    if not table:
        raise InputError("no rows", where=source, accepted="a header and rows of numbers")
    known = [meaning for meaning in meanings if meaning is not None]
    columns = np.frombuffer(table).reshape(count, len(known))
    values = {(each.member, each.index): columns[:, n] * each.factor for n, each in enumerate(known)}
    unknown = [one_line(name) for name, meaning in zip(header, meanings, strict=True) if meaning is None]
    return assembled(Channels(source, values.pop(("time", 0)), values, unknown))


def _meanings(header: list[str], mapping: Mapping, where: str) -> list[Meaning | None]:
    """What each column means, None where that is not known."""
    if len(header) > MAX_COLUMNS:
        raise InputError(f"{len(header):,} columns", where=where, accepted=f"{MAX_COLUMNS} or less")
    meanings = [mapping.meaning(name) or meaning_of(name) for name in header]
    known = [(each.member, each.index) for each in meanings if each is not None]
    if ("time", 0) not in known:
        raise InputError("no column t_s", where=where, accepted=f"a header with the columns {ACCEPTED}")
    if len(known) > len(set(known)):
        twin = next(n for n, each in enumerate(meanings) if each and known.count((each.member, each.index)) > 1)
        raise InputError(f"the column {header[twin]} is there twice", where=where, accepted="each column once")
    return meanings


def _value(cell: str, meaning: Meaning | None, where: str) -> float:
    """The number in a cell; NaN for an empty one where none is commanded."""
    if meaning is not None and meaning.member == "torque_commanded" and not cell:
        return math.nan
    return number(cell, where)


def write_csv(recording: Recording, path: str | Path) -> None:
    """Write a recording as CSV; commanded torque stands empty where none is commanded yet.

    Raises:
        OutputError: it cannot be written.
    """
    columns: list[tuple[str, Array]] = [("t_s", recording.time)]
    for member in MEMBERS:
        array = getattr(recording, member)
        if array is None:
            continue
        for n in range(3 if member in TIP_ARRAYS else 6):
            name = column_name(member, n)
            meaning = meaning_of(name)
            assert meaning is not None
            columns.append((name, array[:, n] / meaning.factor))
    begun = recording.time >= (-math.inf if recording.commanded_from is None else recording.commanded_from)
    table = np.stack([array for _, array in columns], axis=1)
    unsaid = [name for name, _ in columns].index("A1_torque_cmd_nm") if recording.torque_commanded is not None else -1

    def lines() -> Iterator[str]:
        yield ",".join(table_cell(name) for name, _ in columns) + "\n"
        for row, said in zip(table.tolist(), begun.tolist(), strict=True):
            cells = [repr(value) for value in row]
            if unsaid >= 0 and not said and not any(row[unsaid : unsaid + 6]):
                cells[unsaid : unsaid + 6] = [""] * 6
            yield ",".join(cells) + "\n"

    write_pieces(path, lines())
