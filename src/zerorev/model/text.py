"""Between the disk and plain data: YAML, JSON and CSV in, JSON out.

Whatever the bytes are, reading them ends in plain data or in an `InputError` that names the file and the line.
"""

from __future__ import annotations

import csv
import json
import math
import re
import reprlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NoReturn

import yaml

from zerorev.errors import InputError

__all__ = [
    "Document",
    "csv_rows",
    "json_document",
    "json_pieces",
    "json_text",
    "read_bytes",
    "read_text",
    "row_of",
    "yaml_document",
    "yaml_text",
]

MAX_BYTES = 64 * 2**20
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


def read_bytes(path: Path, accepted: str) -> bytes:
    """The content of a file.

    Args:
        path: which.
        accepted: what kind of file belongs here, for the message.

    Raises:
        InputError: no such file, a folder, too large, not readable.
    """
    try:
        if path.is_dir():
            raise InputError("is a folder", where=str(path), accepted=accepted)
        if path.exists() and not path.is_file():
            raise InputError("is not a regular file", where=str(path), accepted=accepted)
        if path.stat().st_size > MAX_BYTES:
            raise InputError(f"is larger than {MAX_BYTES // 2**20} MiB", where=str(path), accepted=accepted)
        return path.read_bytes()
    except FileNotFoundError:
        raise InputError("no such file", where=str(path), accepted=accepted) from None
    except (OSError, ValueError) as error:  # ValueError: a null byte in the path
        why = error.strerror if isinstance(error, OSError) else str(error)
        raise InputError(f"cannot be read: {why}", where=repr(str(path)), accepted=accepted) from None


# --- YAML -------------------------------------------------------------------------------------------------------------


class _Loader(yaml.SafeLoader):
    """Reads scalars as the core schema of YAML 1.2 does: 1e-3 is a number, `no` and a date are text."""

    yaml_implicit_resolvers = {}  # noqa: RUF012  PyYAML's own way

    def compose_node(self, parent: yaml.Node | None, index: int) -> yaml.Node | None:
        """Refuse aliases: a few of them can blow a small file up to any size."""
        if self.check_event(yaml.AliasEvent):
            mark = self.peek_event().start_mark  # type: ignore[no-untyped-call]
            raise yaml.MarkedYAMLError(problem="aliases (*name) are not read", problem_mark=mark)
        return super().compose_node(parent, index)


_TAG = "tag:yaml.org,2002:"
for _name, _pattern, _first in (
    ("null", r"(~|null|Null|NULL|)$", ["~", "n", "N", ""]),
    ("bool", r"(true|True|TRUE|false|False|FALSE)$", list("tTfF")),
    ("int", r"[-+]?[0-9]+$", list("-+0123456789")),
    ("float", r"([-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?|[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN))$",
     list("-+.0123456789")),
):  # fmt: skip
    _Loader.add_implicit_resolver(_TAG + _name, re.compile(_pattern), _first)

_SCALARS: dict[str, Callable[[str], Any]] = {
    "null": lambda text: None,
    "bool": lambda text: text.lower() == "true",
    "int": int,
    "float": lambda text: float(text.replace(".inf", "inf").replace(".nan", "nan")),
    "str": str,
}


def yaml_document(text: str, file: str) -> Document:
    """Plain data of a YAML text.

    Raises:
        InputError: a syntax error, a key used twice, an alias, an unknown tag, too deep a nesting.
    """
    lines: dict[FieldPath, int] = {}
    try:
        node = _Loader(text).get_single_node()
        return Document(file, None if node is None else _plain(node, (), lines), lines)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        line = f", line {mark.line + 1}" if mark else ""
        what = ", ".join(part for part in (error.context, error.problem) if part)
        raise InputError(what, where=file + line, accepted="YAML") from None
    except yaml.reader.ReaderError as error:
        line_number = text.count("\n", 0, error.position) + 1
        raise InputError("holds a control character", where=f"{file}, line {line_number}", accepted="YAML") from None
    except RecursionError:
        raise InputError("is nested too deep", where=file, accepted="YAML") from None


def _plain(node: yaml.Node, path: FieldPath, lines: dict[FieldPath, int]) -> Any:
    lines[path] = node.start_mark.line + 1
    if isinstance(node, yaml.MappingNode):
        mapping: dict[str, Any] = {}
        for key, value in node.value:
            if not isinstance(key, yaml.ScalarNode):
                _refuse("a key that is not text", key)
            if key.value in mapping:
                _refuse(f"the key '{key.value}' is used twice", key)
            mapping[key.value] = _plain(value, (*path, key.value), lines)
        return mapping
    if isinstance(node, yaml.SequenceNode):
        return [_plain(value, (*path, i), lines) for i, value in enumerate(node.value)]
    try:
        return _SCALARS[node.tag.removeprefix(_TAG)](node.value)
    except KeyError:
        _refuse(f"the tag {node.tag} is not read", node)
    except ValueError:  # e.g. !!int x, or thousands of digits
        _refuse("not a number that can be read", node)


def _refuse(problem: str, node: yaml.Node) -> NoReturn:
    raise yaml.MarkedYAMLError(problem=problem, problem_mark=node.start_mark)


class _Dumper(yaml.SafeDumper):
    """Puts into quotes whatever `_Loader` would not read as text again."""

    yaml_implicit_resolvers = _Loader.yaml_implicit_resolvers

    def ignore_aliases(self, data: Any) -> bool:
        """Write everything out."""
        return True


def yaml_text(data: Any) -> str:
    """Plain data as YAML that `yaml_document` reads as the same; short lists and mappings stand on one line."""
    return str(
        yaml.dump(data, Dumper=_Dumper, default_flow_style=None, sort_keys=False, allow_unicode=True, width=LINE_WIDTH)
    )


# --- JSON -------------------------------------------------------------------------------------------------------------


def json_document(text: str, file: str) -> Document:
    """Plain data of a JSON text.

    Raises:
        InputError: a syntax error, NaN or infinity, a key used twice, too deep a nesting.
    """

    def no_twins(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        mapping = dict(pairs)
        if len(mapping) < len(pairs):
            keys = [key for key, _ in pairs]
            twin = next(key for key in keys if keys.count(key) > 1)
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
    """Plain data as JSON that people can read: whatever fits on a line stands on one."""
    return _laid_out(data, 0, 0) + "\n"


def json_pieces(data: dict[str, Any]) -> Iterator[str]:
    """The `json_text` of a mapping piece by piece; an iterator among its values is a list of long entries."""
    before = "{"
    for key, value in data.items():
        name = f"\n  {json.dumps(key, ensure_ascii=False)}: "
        if isinstance(value, Iterator):
            yield before + name
            between = "["
            for entry in value:
                yield f"{between}\n    {_laid_out(entry, 4, 1)}"
                between = ","
            yield "\n  ]"
        else:
            yield before + name + _laid_out(value, 2, len(name) - 2)
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
        InputError: a missing, unknown or repeated column, a cell too many or too few, a cell that is not a number.
    """
    columns = (label, *numbers)
    accepted = f"the columns {','.join(columns)}, separated by commas"
    reader = csv.reader(text.splitlines(), strict=True)
    try:
        header = [cell.strip() for cell in next(reader, [])]
        where = f"{file}, line 1"
        if missing := [name for name in columns if name not in (*header, *optional)]:
            raise InputError(f"no column {', '.join(missing)}", where=where, accepted=accepted)
        if unknown := [name for name in header if name not in columns]:
            raise InputError(f"unknown column {', '.join(map(repr, unknown))}", where=where, accepted=accepted)
        if len(header) > len(set(header)):
            raise InputError("a column stands twice", where=where, accepted=accepted)
        for cells in reader:
            where = f"{file}, line {reader.line_num}"
            if not any(cell.strip() for cell in cells):
                continue
            yield reader.line_num, row_of(header, cells, label, where)
    except csv.Error as error:
        raise InputError(str(error), where=f"{file}, line {reader.line_num}", accepted="CSV") from None


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
