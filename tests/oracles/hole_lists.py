"""Lists of holes as programs and people write them, and what happens to them on the way; written without the reader.

A list is made from holes that are known, in a random style, and may be damaged after that. What is read of it has to be
these holes, or a refusal that names a line.
"""

from __future__ import annotations

import random
from dataclasses import dataclass, field
from typing import Any

import numpy as np

__all__ = ["DAMAGES", "Written", "written"]

MM = {"mm": 1.0, "m": 1000.0, "in": 25.4}
CAD_NAMES = {
    "id": "NAME", "x": "LOCX", "y": "LOCY", "z": "LOCZ", "i": "WX", "j": "WY", "k": "WZ", "depth": "Thickness",
    "entry_x": "X1", "entry_y": "Y1", "entry_z": "Z1", "exit_x": "X2", "exit_y": "Y2", "exit_z": "Z2",
}  # fmt: skip
OWN_NAMES = {key: key if key in "idjk" else f"{key}_mm" for key in CAD_NAMES}
EXTRAS = ("DIA", "Part", "KFLAG", "remark", "n", "date")


@dataclass
class Written:
    """A list as a file, and what it is of.

    Attributes:
        content: of the file.
        keys: of the job beside it.
        ids: of the holes.
        bottom: of each hole [mm], shape (n, 3).
        into: unit direction into the material, shape (n, 3).
        depth: [mm], shape (n,).
        tolerance: of the digits that were written [mm].
        damage: what was done to it, or an empty text.
    """

    content: bytes
    keys: dict[str, Any]
    ids: list[str]
    bottom: Any
    into: Any
    depth: Any
    tolerance: float
    damage: str


@dataclass
class _Style:
    """How a list is written."""

    chance: random.Random
    delimiter: str = ","
    comma: bool = False
    decimals: int | None = None
    minus: str = "-"
    quote_all: bool = False
    groups: str = ""
    lines: list[list[str]] = field(default_factory=list)

    def number(self, value: float) -> str:
        text = f"{value:.{self.decimals}f}" if self.decimals is not None else repr(float(value))
        if self.decimals is None and text.endswith(".0") and self.chance.random() < 0.7:
            text = text[:-2]
        text = text.replace("-", self.minus, 1) if text.startswith("-") else text
        if self.groups:
            whole, dot, part = text.partition(".")
            sign, digits = (whole[0], whole[1:]) if whole[:1] == self.minus else ("", whole)
            whole = f"{int(digits):,}".replace(",", self.groups) if digits.isdigit() else digits
            text = f"{sign}{whole}{dot}{part}"
        return text.replace(".", "\x01").replace("\x01", ",") if self.comma and not self.groups else text

    def cell(self, text: str) -> str:
        if self.quote_all or self.delimiter in text or '"' in text or text.startswith("#"):
            return '"' + text.replace('"', '""') + '"'
        return text

    def line(self, cells: list[str]) -> str:
        return self.delimiter.join(map(self.cell, cells))


def written(seed: int, damage: str | None = None) -> Written:
    """A list of some holes in a random style.

    Args:
        seed: of holes, style and damage.
        damage: one of `DAMAGES`; None: half of the lists are damaged, by any.
    """
    chance = random.Random(seed)
    rng = np.random.default_rng(seed)
    harm = damage if damage is not None else chance.choice(("", chance.choice(list(DAMAGES))))
    whole = harm == "thousands alone"  # numbers without a decimal sign
    count = chance.randint(1, 7)
    ids = [chance.choice(("H", "R2C", "7-", "Ä ", "")) + str(n) for n in range(count)]
    into = rng.normal(size=(count, 3))
    if whole or chance.random() < 0.4:
        into = np.eye(3)[rng.integers(3, size=count)] * rng.choice([-1.0, 1.0], size=(count, 1))
    into /= np.linalg.norm(into, axis=1, keepdims=True)
    digits = 0 if whole else chance.choice((0, 1, 2, 3))
    entry = (rng.uniform(-2500, 2500, size=(count, 3))).round(digits)
    depth = rng.uniform(1, 60, size=count).round(digits) + (0.0 if whole else 0.5)
    kind = chance.choice(("bottom", "bottom", "entry", "entry column", "both"))
    style = _Style(chance, chance.choice("\t;,"), chance.random() < 0.4, chance.choice((None, None, 6)))
    style.minus = chance.choice("----\u2212\u2013")
    style.quote_all = chance.random() < 0.15
    unit = "mm" if whole else chance.choice(("mm", "mm", "m", "in"))
    named = unit != "mm" or chance.random() < 0.4
    out = kind != "both" and chance.random() < 0.3
    one_depth = kind != "both" and chance.random() < 0.25
    if one_depth:
        depth[:] = depth[0]
    bottom = entry + depth[:, None] * into
    keys, values = _columns(kind, entry, bottom, -into if out else into, depth, MM[unit], one_depth, ids, chance)
    if kind == "entry":
        keys["point"] = "entry"
    if out:
        keys["normals"] = "out"
    names = _names(list(values), named, keys, chance)
    if named and unit != "mm" and chance.random() < 0.8:
        keys["unit"] = unit
    units_row = "unit" not in keys and named
    content = _text(style, values, names, unit, units_row=units_row, harm=harm)
    tolerance = 1e-6 if style.decimals is None or whole else 2 * 10.0**-style.decimals * MM[unit]
    return Written(content, keys, ids, bottom, into, depth, tolerance, harm)


def _columns(kind, entry, bottom, direction, depth, factor, one_depth, ids, chance):
    """The job's keys so far, and the columns: of text or of numbers, by short names, in random order."""
    keys: dict[str, Any] = {"depth_mm": float(depth[0])} if one_depth else {}
    values: dict[str, Any] = {"id": ids}
    point = bottom if kind == "bottom" else entry
    prefix = "entry_" if kind in ("entry column", "both") else ""
    for n, axis in enumerate("xyz"):
        values[prefix + axis] = point[:, n] / factor
        if kind == "both":
            values[f"exit_{axis}"] = bottom[:, n] / factor
        else:
            values["ijk"[n]] = direction[:, n]
    if kind != "both" and not one_depth:
        values["depth"] = depth / factor
    for name in chance.sample(EXTRAS, chance.choice((0, 0, 1, 3))):
        values[f"+{name}"] = [chance.choice(("", "x", "4,8", "4.8", "a;b", 'say "so"', "12", "#3")) for _ in ids]
    order = list(values)
    if chance.random() < 0.5:
        chance.shuffle(order)
    return keys, {name: values[name] for name in order}


def _names(columns, named, keys, chance):
    """The names of columns in the header; other names than the reader's own go into the job's keys."""
    used = CAD_NAMES if named else OWN_NAMES
    if named:
        keys["columns"] = {OWN_NAMES[name]: used[name] for name in columns if name in used}
    change = chance.choice((str, str, str.upper, str.lower, str.title))
    return [name[1:] if name.startswith("+") else change(used[name]) for name in columns]


def _text(style, values, names, unit, *, units_row, harm):
    """The bytes of the list, damaged or not."""
    chance = style.chance
    if harm == "thousands":
        style.groups, style.comma = chance.choice(",' \u00a0\u202f"), False
    if harm == "thousands alone":
        # where cells are separated by commas, points are decimal
        style.groups, style.comma, style.decimals = chance.choice(",." if style.delimiter != "," else ","), False, 0
    columns = [
        column if isinstance(column, list) else [style.number(value) for value in column] for column in values.values()
    ]
    rows = [list(row) for row in zip(*columns, strict=True)]
    lines = [style.line(row) for row in rows]
    top = [style.line(names)]
    if units_row or (chance.random() < 0.15 and unit == "mm"):
        lengths = [name.endswith(("x", "y", "z", "depth")) and not name.startswith("+") for name in values]
        top.append(style.line([chance.choice((unit, f"[{unit}]", unit.upper())) if each else "" for each in lengths]))
    for _ in range(chance.choice((0, 0, 0, 1, 2))):
        top.insert(0, chance.choice(("# made by CAD", "Flat report", "// 3 May", "Panel" + 2 * style.delimiter, "")))
    if chance.random() < 0.15:
        lines.insert(chance.randrange(len(lines) + 1), chance.choice(("# next station", "", 3 * style.delimiter)))
    if chance.random() < 0.15 and not list(values)[-1].startswith("+"):
        lines = [line + style.delimiter * 2 for line in lines]
    if chance.random() < 0.1:
        top.insert(0, f"sep={style.delimiter}")
    if harm:
        top, lines = DAMAGES[harm](style, top, lines, rows)
    text = chance.choice(("\n", "\r\n", "\r")).join([*top, *lines, *chance.choice(([], [""]))])
    return text.encode(chance.choice(("utf-8", "utf-8", "utf-8-sig", "utf-16", "utf-16")))


# --- damages: from the lines of the top and of the rows to those of the damaged list ----------------------------------


def _in_a_row(change):
    """A damage to the cells of one row."""

    def damaged(style, top, lines, rows):
        row = style.chance.choice(rows)
        at = next((n for n, line in enumerate(lines) if line.startswith(style.line(row))), None)
        if at is None:
            return top, lines
        cells = change(style, list(row))
        return top, [*lines[:at], cells if isinstance(cells, str) else style.line(cells), *lines[at + 1 :]]

    return damaged


def _without_a_cell(style, cells):
    del cells[style.chance.randrange(len(cells))]
    return cells


def _with_a_cell(style, cells):
    at = style.chance.randrange(len(cells))
    cells.insert(at, style.chance.choice(("", cells[at], "0")))
    return cells


def _other_delimiter(style, cells):
    return style.chance.choice([each for each in "\t;,|" if each != style.delimiter]).join(map(style.cell, cells))


def _open_quote(style, cells):
    line, at = style.line(cells), style.chance.randrange(len(cells))
    place = [n for n, sign in enumerate(f"{style.delimiter}{line}") if sign == style.delimiter][: at + 1][-1]
    return f'{line[:place]}"{line[place:]}'


def _decimal_commas(style, cells):
    """Decimal commas, not in quotes, for any separator of cells."""
    return style.delimiter.join(cell.replace(".", ",") for cell in cells)


def _of_lines(change):
    return lambda style, top, lines, rows: (top, change(style.chance, list(lines)))


def _merged(chance, lines):
    at = chance.randrange(len(lines))
    return [*lines[:at], "".join(lines[at : at + 2]), *lines[at + 2 :]] if len(lines) > 1 else [*lines, lines[0]]


def _broken(chance, lines):
    at = chance.randrange(len(lines))
    place = chance.randrange(1, max(2, len(lines[at]) - 1))
    return [*lines[:at], lines[at][:place], lines[at][place:], *lines[at + 1 :]]


def _one_more(text):
    return lambda chance, lines: [*lines, text]


def _commented(chance, lines):
    at = chance.randrange(len(lines))
    return [*lines[:at], chance.choice(("#", "# ", "//", "%")) + lines[at], *lines[at + 1 :]]


def _doubled(chance, lines):
    return [*lines, lines[chance.randrange(len(lines))]]


def _header(change):
    def damaged(style, top, lines, rows):
        at = max(n for n, line in enumerate(top) if style.delimiter in line or n == 0)
        return change(style, top, lines, at)

    return damaged


def _header_lost(style, top, lines, at):
    return [line for line in top if line.startswith(("#", "//"))], lines


def _header_below(style, top, lines, at):
    return [], [lines[0], *top, *lines[1:]]


def _header_again(style, top, lines, at):
    return top, [*lines, *top]


def _name_changed(style, top, lines, at):
    names = top[-1] if len(top) == 1 else top[at]
    letters = [n for n, letter in enumerate(names) if letter.isalpha()]
    if not letters:
        return top, lines
    n = style.chance.choice(letters)
    return [line.replace(names, names[:n] + "q" + names[n:]) if line == names else line for line in top], lines


def _text_in_a_cell(style, cells):
    n = style.chance.randrange(len(cells))
    cells[n] = style.chance.choice((f"{cells[n]}x", "#REF!", "n/a", "NaN", "1e999", "12 mm"))
    return cells


DAMAGES: dict[str, Any] = {
    "a cell less": _in_a_row(_without_a_cell),
    "a cell more": _in_a_row(_with_a_cell),
    "another separator in a row": _in_a_row(_other_delimiter),
    "a quote": _in_a_row(_open_quote),
    "decimal commas in a row": _in_a_row(_decimal_commas),
    "text in a cell": _in_a_row(_text_in_a_cell),
    "two rows in one": _of_lines(_merged),
    "a row in two": _of_lines(_broken),
    "a row as comment": _of_lines(_commented),
    "a row twice": _of_lines(_doubled),
    "a line of text": _of_lines(_one_more("Sum: 7 holes")),
    "a control character": _of_lines(_one_more("H1\x00")),
    "no header": _header(_header_lost),
    "a header below": _header(_header_below),
    "a header again": _header(_header_again),
    "a name changed": _header(_name_changed),
    "thousands": lambda style, top, lines, rows: (top, lines),
    "thousands alone": lambda style, top, lines, rows: (top, lines),
}
