"""The header of a DIAdem data set, as KRC4 traces have it: text, one block of `code,value` lines per channel."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

from zerorev.cell.recordings.cells import decoded
from zerorev.errors import InputError
from zerorev.files.text import read_bytes
from zerorev.visible import one_line

__all__ = ["FIRST_LINE", "MAX_CHANNELS", "Channel", "Header", "read_header"]

FIRST_LINE = "DIAEXTENDED"
MAX_HEADER = 2 * 2**20  # bytes
MAX_CHANNELS = 400
MAX_SAMPLES = 2**32
_TEXT = {"200": "name", "201": "comment", "202": "unit", "210": "kind", "211": "file", "213": "layout", "214": "type"}
_NUMBERS = {"220": "count", "221": "first", "240": "offset", "241": "factor", "250": "least", "251": "most"}
_IMPLICIT, _EXPLICIT = ("IMPLIZIT", "IMPLICIT"), ("EXPLIZIT", "EXPLICIT")


@dataclass(frozen=True)
class Channel:
    """One channel, as its block says.

    Attributes:
        name: as written.
        unit: as written, or empty.
        implicit: whether its n-th value is offset + n factor, n from 0; else the file has its values.
        file: name of the file with the values, without a folder.
        block: whether the values of several channels stand sample by sample; else each channel's stand together.
        count: how many values.
        first: in a block its column, else the place of its first value, both from 1.
        offset: added to what the file holds times `factor`.
        factor: see `offset`.
        least: smallest value by the header, or None.
        most: greatest value by the header, or None.
        line: of the header in which its block begins.
    """

    name: str
    unit: str
    implicit: bool
    file: str
    block: bool
    count: int
    first: int
    offset: float
    factor: float
    least: float | None
    most: float | None
    line: int


@dataclass(frozen=True)
class Header:
    """What a header says.

    Attributes:
        source: how messages name it.
        channels: in order.
        big_endian: whether the high byte of a number comes first.
        no_value: the number that stands where there is none, or None.
    """

    source: str
    channels: tuple[Channel, ...]
    big_endian: bool
    no_value: float | None


def read_header(path: Path) -> Header:
    """The header of a data set.

    Raises:
        InputError: not a header, or one that is wrong; the message names the line.
    """
    source = str(path)
    text = decoded(read_bytes(path, "the header of a trace (.dat)", MAX_HEADER))
    lines = [line.strip() for line in text.splitlines()]
    if not lines or not lines[0].upper().startswith(FIRST_LINE):
        raise InputError(
            "does not begin as the header of a trace does", where=f"{source}, line 1", accepted=f"{FIRST_LINE}..."
        )
    general: dict[str, str] = {}
    blocks: list[tuple[int, dict[str, str]]] = []
    within: dict[str, str] | None = None
    for n, line in enumerate(lines[1:], 2):
        if line == "#BEGINGLOBALHEADER":
            within = general
        elif line == "#BEGINCHANNELHEADER":
            within = {}
            blocks.append((n, within))
            if len(blocks) > MAX_CHANNELS:
                raise InputError(
                    f"more than {MAX_CHANNELS} channels",
                    where=f"{source}, line {n}",
                    accepted=f"{MAX_CHANNELS} or less",
                )
        elif line in ("#ENDGLOBALHEADER", "#ENDCHANNELHEADER"):
            within = None
        elif line and within is not None:
            code, comma, value = line.partition(",")
            if not comma or not code.strip().isdigit():
                if within is general:  # a comment of several lines
                    continue
                raise InputError(
                    "is not a code, a comma and a value", where=f"{source}, line {n}", accepted="e.g. 200,Istposition"
                )
            within.setdefault(code.strip(), value.strip())
    if not blocks:
        raise InputError("no channel", where=source, accepted="blocks #BEGINCHANNELHEADER to #ENDCHANNELHEADER")
    channels = tuple(_channel(block, source, n) for n, block in blocks)
    return Header(source, channels, general.get("112", "").lower().startswith("high"), _no_value(general, source))


def _no_value(general: dict[str, str], source: str) -> float | None:
    text = general.get("111", "")
    return _number(text, f"{source}, 111 (no value)") if text else None


def _channel(block: dict[str, str], source: str, line: int) -> Channel:
    name = one_line(block.get("200", ""))
    where = f"{source}, line {line}, channel {name[:60] or '(no name)'}"
    kind = block.get("210", "EXPLIZIT").upper()
    if kind not in (*_IMPLICIT, *_EXPLICIT):
        raise InputError(f"210 (kind) is {kind[:40]!r}", where=where, accepted=", ".join((*_IMPLICIT, *_EXPLICIT)))
    implicit = kind in _IMPLICIT
    layout, stored = block.get("213", "BLOCK").upper(), block.get("214", "REAL64").upper()
    if not implicit and stored != "REAL64":
        raise InputError(f"214 (type) is {stored[:40]!r}", where=where, accepted="REAL64")
    if not implicit and layout not in ("BLOCK", "CHANNEL"):
        raise InputError(f"213 (layout) is {layout[:40]!r}", where=where, accepted="BLOCK or CHANNEL")
    numbers = {key: _number(block[code], f"{where}, {code}") for code, key in _NUMBERS.items() if block.get(code)}
    if "count" not in numbers:
        raise InputError("220 (how many values) is missing", where=where, accepted="a whole number above 0")
    return Channel(
        name, one_line(block.get("202", "")), implicit, _file(block.get("211", ""), where), layout == "BLOCK",
        _whole(numbers["count"], f"{where}, 220"), _whole(numbers.get("first", 1.0), f"{where}, 221"),
        numbers.get("offset", 0.0), numbers.get("factor", 1.0), numbers.get("least"), numbers.get("most"), line,
    )  # fmt: skip


def _file(text: str, where: str) -> str:
    """The name of a file in the folder of its header."""
    if any(each in text for each in "/\\\x00") or text in (".", ".."):
        raise InputError("211 (file of the values) names a folder", where=where, accepted="a file beside the header")
    return text


def _number(text: str, where: str) -> float:
    try:
        value = float(text.replace(",", ".")) if "_" not in text else math.nan
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InputError(f"{text[:40]!r} is not a number", where=where, accepted="a finite number")
    return value


def _whole(value: float, where: str) -> int:
    if not 1 <= value <= MAX_SAMPLES or value != int(value):
        raise InputError(f"{value:g} is not a count", where=where, accepted=f"a whole number from 1 to {MAX_SAMPLES:,}")
    return int(value)
