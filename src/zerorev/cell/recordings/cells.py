"""Text and tables as other programs write them: code pages, semicolons, decimal commas."""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Iterator

from zerorev.errors import InputError
from zerorev.files.text import table_lines

__all__ = ["decoded", "number", "rows_of"]

_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")
_COMMA = re.compile(r"[-+]?(\d+,\d*|,\d+)([eE][-+]?\d+)?")


def decoded(data: bytes) -> str:
    """Text in UTF-8, or else in Windows' western code page, or else in ISO 8859-1, which takes any byte."""
    for encoding in ("utf-8-sig", "cp1252"):
        try:
            return data.decode(encoding)
        except UnicodeDecodeError:
            continue
    return data.decode("latin-1")


def rows_of(data: bytes, source: str) -> Iterator[tuple[int, list[str]]]:
    """The line and the cells of each row that is not empty; a tab, a semicolon or a comma stands between cells.

    Raises:
        InputError: not a table.
    """
    lines = table_lines(decoded(data).rstrip("\r\n"), source)
    first = next((line for line in lines if line.strip()), "")
    reader = csv.reader(lines, delimiter=next((each for each in "\t;" if each in first), ","), strict=True)
    try:
        for cells in reader:
            if any(cell.strip() for cell in cells):
                yield reader.line_num, [cell.strip() for cell in cells]
    except csv.Error as error:
        raise InputError(str(error), where=f"{source}, line {reader.line_num}", accepted="CSV") from None


def number(cell: str, where: str) -> float:
    """A cell as a number, with a decimal point or a decimal comma.

    Raises:
        InputError: it is not a finite number.
    """
    text = cell.replace(",", ".") if _COMMA.fullmatch(cell) else cell
    value = float(text) if _NUMBER.fullmatch(text) else math.nan
    if not math.isfinite(value):
        raise InputError(f"{cell[:40]!r} is not a finite number", where=where, accepted="a number, e.g. 12.5 or 12,5")
    return value
