"""Numbers as people and spreadsheets write them: decimal point or comma, any minus, and never a separator of thousands.

Which sign is the decimal one is a question to the whole table: `1,200` alone may be 1.2 or 1200, and `0,5` beside it
says which. What cannot be decided is refused.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from typing import Literal

from zerorev.errors import InputError

__all__ = ["Decimal", "decimal_of", "is_number", "number_of"]

Decimal = Literal["point", "comma"]
SIGNS: dict[str, Decimal] = {".": "point", ",": "comma"}
# what programs write for a minus: true minus, hyphens, figure dash, en dash, small and full-width hyphen
_MINUS = str.maketrans(dict.fromkeys("\u2212\u2010\u2011\u2012\u2013\ufe63\uff0d", "-"))
_NUMBER = re.compile(r"[-+]?(?:[0-9]+(?:([.,])[0-9]*)?|([.,])[0-9]+)(?:[eE][-+]?[0-9]+)?")
# a sign before exactly three digits, which may as well group thousands: 1,200 but not 0,125 and not 12,50
_MAYBE_THOUSANDS = re.compile(r"[-+]?[1-9][0-9]{0,2}[.,][0-9]{3}")
# '1 200', "1'200", '1,200.5', '1.200.000'
_THOUSANDS = re.compile(r"[-+]?[0-9]{1,3}(?:[\s'\u2019`.,][0-9]{3})+(?:[.,][0-9]*)?")


def is_number(cell: str) -> bool:
    """Whether a cell is a number in some way of writing, perhaps with separators of thousands."""
    cell = cell.translate(_MINUS)
    return _NUMBER.fullmatch(cell) is not None or _THOUSANDS.fullmatch(cell) is not None


def decimal_of(cells: Iterable[tuple[int, str]], *, commas_separate: bool) -> Decimal:
    """The decimal sign of a table.

    Args:
        cells: of the columns of numbers, each with its line.
        commas_separate: whether cells are separated by commas: who does that writes a decimal point.

    Raises:
        InputError: both signs stand in the table, or the only one may as well separate thousands.
    """
    first: dict[str, tuple[int, str]] = {}
    certain: set[str] = set()
    for line, cell in cells:
        found = _NUMBER.fullmatch(plain := cell.translate(_MINUS))
        if found is None or (sign := found[1] or found[2]) is None:
            continue
        first.setdefault(sign, (line, cell))
        if not _MAYBE_THOUSANDS.fullmatch(plain):
            certain.add(sign)
    if len(first) == 2:
        (at, one), (there, other) = sorted(first.values(), key=lambda found: found[0])
        raise InputError(
            f"'{one}' and '{other}' (line {there}) have two decimal signs, or one of them separates thousands",
            where=f"line {at}",
            accepted="one decimal sign in the whole table, and no separator of thousands",
        )
    for sign, (line, cell) in first.items():
        if sign not in certain and not (sign == "." and commas_separate):
            whole, _, part = cell.partition(sign)
            raise InputError(
                f"'{cell}' may be {whole}.{part} or {whole}{part}: no other number says what the sign '{sign}' means",
                where=f"line {line}",
                accepted=f"no separator of thousands; or decimal: {SIGNS[sign]} for {whole}.{part}",
            )
    return SIGNS[next(iter(first), ".")]


def number_of(cell: str, decimal: Decimal, where: str) -> float:
    """The number of a cell.

    Raises:
        InputError: it is none, not a finite one, has another decimal sign, or separators of thousands.
    """
    plain = cell.translate(_MINUS)
    found = _NUMBER.fullmatch(plain)
    sign = None if found is None else found[1] or found[2]
    if found is not None and (sign is None or SIGNS[sign] == decimal):
        value = float(plain.replace(",", "."))
        if math.isfinite(value):
            return value
    example = "12.5" if decimal == "point" else "12,5"
    what, accepted = f"{cell!r} is not a finite number", f"a finite number, e.g. {example}"
    if _THOUSANDS.fullmatch(plain):
        what, accepted = f"{cell!r} has a separator of thousands", f"a number without one, e.g. {example}"
    elif sign is not None and SIGNS[sign] != decimal:
        what = f"{cell!r} is not a number with a decimal {decimal}, as this table has them"
    raise InputError(what, where=where, accepted=accepted)
