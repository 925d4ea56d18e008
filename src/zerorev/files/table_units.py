"""The units of the lengths in a table: what its columns are called, a row of units, and what the user says."""

from __future__ import annotations

import re
import string
from collections.abc import Mapping
from typing import Literal

from zerorev.errors import InputError
from zerorev.files.table_numbers import is_number

__all__ = ["MILLIMETRES", "Unit", "factor_of", "unit_of_name", "units_row"]

Unit = Literal["mm", "m", "in"]

MILLIMETRES: dict[str, float] = {"mm": 1.0, "m": 1000.0, "in": 25.4}
UNITS: dict[str, Unit] = {
    **dict.fromkeys(("mm", "millimetre", "millimetres", "millimeter", "millimeters"), "mm"),
    **dict.fromkeys(("m", "metre", "metres", "meter", "meters"), "m"),
    **dict.fromkeys(("in", "inch", "inches"), "in"),
}  # fmt: skip
_BRACKETS = re.compile(r"[\[(]\s*(\w+)\s*[\])]$")


def units_row(line: int, cells: list[str], places: Mapping[str, int]) -> dict[str, Unit]:
    """The units of lengths, by their columns, where a row below the header has them; none where it is something else.

    Args:
        line: of the row.
        cells: of the row.
        places: of the columns that are used.

    Raises:
        InputError: a unit that is not read.
    """
    said = {
        name: cells[n].strip("[]() ").casefold()
        for name, n in places.items()
        if name.endswith("_mm") and n < len(cells)
    }
    if said.get("depth_mm", "").strip("-") == "":
        said.pop("depth_mm", None)
    points = [word for name, word in said.items() if name != "depth_mm"]
    if not any(word in UNITS for word in points) and (not all(points) or any(map(is_number, points))):
        return {}
    if unknown := [word for word in said.values() if word not in UNITS]:
        what = f"'{unknown[0]}' is neither a number nor a unit that is read"
        raise InputError(what, where=f"line {line}", accepted=f"{', '.join(MILLIMETRES)}; or a row of a hole")
    return {name: UNITS[word] for name, word in said.items()}


def unit_of_name(name: str) -> Unit | None:
    """The unit that the name of a column says, as `x_mm` and `LOCX [in]` do.

    Args:
        name: in a header.
    """
    name = name.strip().casefold()
    if found := _BRACKETS.search(name):
        return UNITS.get(found[1])
    return "mm" if name.endswith("mm") and not name[:-2].endswith(tuple(string.ascii_lowercase)) else None


def factor_of(name: str, said: Mapping[str, Unit | None], where: str) -> float:
    """Millimetres in the unit of a column.

    Args:
        name: of the column.
        said: its unit, by who says so; nobody: mm.
        where: how a message names the header.

    Raises:
        InputError: they contradict each other.
    """
    given = {who: unit for who, unit in said.items() if unit is not None}
    if len(set(given.values())) > 1:
        what = f"the unit of {name}: " + ", ".join(f"{who} says {unit}" for who, unit in given.items())
        raise InputError(what, where=where, accepted="one unit for each column")
    return MILLIMETRES[next(iter(given.values()), "mm")]
