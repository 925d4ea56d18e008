"""RSI captures: the XML documents that a controller sends, one per cycle, one per line or back to back, also in gzip.

Cycles that are missing by the controller's own counter (IPOC, ms) are counted and reported; no sample is made up.
"""

from __future__ import annotations

import gzip
import math
import zlib
from array import array
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import fromstring as plain_parser

import numpy as np

from zerorev.cell.recordings.assembled import Channels, assembled
from zerorev.cell.recordings.channels import NO_MAPPING, Mapping, Meaning
from zerorev.errors import InputError
from zerorev.files.text import opened
from zerorev.model._arrays import Array
from zerorev.model.recording import Recording
from zerorev.visible import one_line

__all__ = ["END", "MAX_DOCUMENT", "MAX_DOCUMENTS", "MAX_UNPACKED", "documents", "lost_cycles", "read_rsi"]

MAX_DOCUMENT = 65_535  # bytes: what a datagram can hold
MAX_DOCUMENTS = 500_000  # half an hour of 4 ms
MAX_UNPACKED = 2**30  # bytes
MAX_NAMES = 400
MAX_VALUES = 20_000_000
PIECE = 2**18
END = b"</Rob>"
_AXES = tuple(f"A{n}" for n in range(1, 7))
_KNOWN: dict[str, tuple[str, tuple[str, ...], float]] = {
    "AIPos": ("joints", _AXES, np.pi / 180),
    "ASPos": ("joints_commanded", _AXES, np.pi / 180),
    "RIst": ("tcp", ("X", "Y", "Z"), 1e-3),
    "RSol": ("tcp_commanded", ("X", "Y", "Z"), 1e-3),
}
# what RSI sends by itself and is of no use here: orientation, motor currents, outer axes, late answers, digital values
_OTHERS = ("RIst.", "RSol.", "MACur.", "MECur.", "EIPos.", "ESPos.", "Delay.", "Digout.", "DiO", "DiL", "Tech.")


def read_rsi(path: str | Path, mapping: Mapping = NO_MAPPING) -> Recording:
    """A recording out of a capture; user elements are read as a mapping says, e.g. `GearTorque.A1: A1_torque_nm`.

    Raises:
        InputError: not a capture; the message names the document, from 1.
    """
    source = str(path)
    counters: list[int] = []
    names: dict[str, int] = {}
    known = _Names(mapping)
    rows: list[array[float]] = []
    repeated = 0
    for n, document in enumerate(documents(Path(path)), 1):
        where = f"{source}, document {n}"
        if n > MAX_DOCUMENTS:
            raise InputError(f"more than {MAX_DOCUMENTS:,} documents", where=where, accepted="a shorter capture")
        counter, values = _document(document, known, where)
        if counters and counter == counters[-1]:
            repeated += 1
            continue
        if counters and counter < counters[-1]:
            raise InputError(
                f"the IPOC {counter} does not rise after {counters[-1]}", where=where, accepted="counters that rise"
            )
        counters.append(counter)
        for name in values:
            names.setdefault(name, len(names))
        if len(rows) * len(names) > MAX_VALUES:
            raise InputError(f"more than {MAX_VALUES:,} numbers", where=where, accepted="a shorter capture")
        rows.append(array("d", [values.get(name, np.nan) for name in names]))
    if not rows:
        raise InputError("no document", where=source, accepted='an RSI capture: <Rob Type="KUKA">...</Rob>')
    table = np.full((len(rows), len(names)), np.nan)
    for n, row in enumerate(rows):
        table[n, : len(row)] = row
    return assembled(_channels(source, counters, names, table, mapping, repeated))


def _channels(
    source: str, counters: list[int], names: dict[str, int], table: Array, mapping: Mapping, repeated: int
) -> Channels:
    values: dict[tuple[str, int], Array] = {}
    unknown = []
    for name, at in names.items():
        meaning = mapping.meaning(name) or _meaning(name)
        if meaning is not None and meaning.member != "time":
            values.setdefault((meaning.member, meaning.index), table[:, at] * meaning.factor)
        elif not name.startswith(_OTHERS):
            unknown.append(name)
    channels = Channels(source, (np.array(counters, dtype=float) - counters[0]) * 1e-3, values, unknown)
    cycle, lost = lost_cycles(counters)
    if lost:
        channels.say("warning", "lost_cycles", f"{lost} cycles of {cycle:g} ms are missing by the IPOC")
    if repeated:
        channels.say("info", "lost_cycles", f"{repeated} documents repeat the IPOC of the one before; they are dropped")
    return channels


def lost_cycles(counters: Iterable[int]) -> tuple[float, int]:
    """The cycle [ms], which is the median of the counters' steps, and how many cycles are missing by it."""
    steps = np.diff(np.array(list(counters), dtype=float))
    if not steps.size:
        return 0.0, 0
    cycle = float(np.median(steps))
    return cycle, int(np.maximum(np.round(steps / cycle) - 1, 0).sum()) if cycle > 0 else 0


def documents(path: Path) -> Iterator[bytes]:
    """The documents of a capture one by one; of gzip no more is unpacked than is read.

    Raises:
        InputError: a document that is too long, one that does not end, damaged gzip, too much in it.
    """
    accepted = "an RSI capture (XML, or XML in gzip)"
    with opened(path, accepted) as stream:
        packed = stream.read(2) == b"\x1f\x8b"
        stream.seek(0)
        source = gzip.GzipFile(fileobj=stream) if packed else stream
        rest, total = b"", 0
        while True:
            try:
                piece = source.read(PIECE)
            except (gzip.BadGzipFile, EOFError, zlib.error) as error:
                raise InputError(f"is damaged: {error}", where=str(path), accepted=accepted) from None
            if not piece:
                break
            total += len(piece)
            if total > MAX_UNPACKED:
                raise InputError(f"more than {MAX_UNPACKED // 2**20} MiB", where=str(path), accepted="less")
            *whole, rest = (rest + piece).split(END)
            for each in (*whole, rest):
                if len(each) > MAX_DOCUMENT:
                    raise InputError(
                        f"a document of more than {MAX_DOCUMENT:,} bytes", where=str(path), accepted=accepted
                    )
            yield from (each.strip() + END for each in whole)
        if rest.strip(b" \t\r\n\x00"):
            raise InputError("the last document does not end", where=str(path), accepted="documents that end in </Rob>")


class _Names:
    """The names of numbers, `AIPos.A1`; what is decided about a name is decided once."""

    def __init__(self, mapping: Mapping) -> None:
        self.mapping = mapping
        self._decided: dict[tuple[str, str], tuple[str, bool] | None] = {}

    def kept(self, tag: str, key: str, where: str) -> tuple[str, bool] | None:
        """The name of an attribute, or of an element's text for the key "", and whether it must be a number.

        None where it is of no use.

        Raises:
            InputError: too many names.
        """
        place = (tag, key)
        if place not in self._decided:
            if len(self._decided) == MAX_NAMES:
                raise InputError(f"more than {MAX_NAMES} names", where=where, accepted=f"{MAX_NAMES} or less")
            name = ".".join(one_line(part)[:80] for part in place if part)
            needed = bool(_meaning(name)) or name in self.mapping.channels
            self._decided[place] = (name, needed) if needed or not f"{name}.".startswith(_OTHERS) else None
        return self._decided[place]


def _document(text: bytes, names: _Names, where: str) -> tuple[int, dict[str, float]]:
    """The counter of a document, and its numbers by element and attribute, `AIPos.A1`."""
    counter, values = None, {}
    for element in _parsed(text, where):
        tag, said = str(element.tag), (element.text or "").strip()
        if tag == "IPOC":
            counter = _counter(said, where)
            continue
        for key, value in (*element.attrib.items(), *((("", said),) if said else ())):
            kept = names.kept(tag, key, where)
            if kept is not None:
                values[kept[0]] = _number(value)
                if kept[1] and values[kept[0]] != values[kept[0]]:
                    raise InputError(
                        f"{value[:40]!r} is not a number", where=f"{where}, {kept[0]}", accepted="a finite number"
                    )
    if counter is None:
        raise InputError("no IPOC", where=where, accepted="<IPOC>4208163634</IPOC> in every document")
    return counter, values


def _parsed(text: bytes, where: str) -> Any:
    """The element of a document; a document type or entities are refused."""
    from xml.etree.ElementTree import ParseError

    from defusedxml.common import DefusedXmlException
    from defusedxml.ElementTree import fromstring

    try:
        # in UTF-8, which it is without a declaration, no document type begins but with <!: then the plain parser,
        # which is eight times as fast, is as safe
        if text.startswith(b"<Rob") and b"<!" not in text and b"<?" not in text:
            return plain_parser(text)
        return fromstring(text, forbid_dtd=True)
    except DefusedXmlException:
        raise InputError(
            "holds a document type or entities, which are not read", where=where, accepted="plain XML"
        ) from None
    except (ParseError, ValueError, LookupError) as error:
        raise InputError(f"is not XML: {error}", where=where, accepted="an RSI document") from None


def _meaning(name: str) -> Meaning | None:
    tag, _, key = name.partition(".")
    member, keys, factor = _KNOWN.get(tag, ("", (), 0.0))
    return Meaning(member, keys.index(key), factor) if key in keys else None


def _counter(text: str, where: str) -> int:
    text = text.strip()
    if not (text.isascii() and text.isdigit() and len(text) <= 15):
        raise InputError(f"the IPOC {text[:20]!r}", where=where, accepted="a whole number of milliseconds")
    return int(text)


def _number(text: str) -> float:
    """A finite number, or NaN: a text of the user's own."""
    try:
        value = float(text) if "_" not in text else math.nan
    except ValueError:
        return math.nan
    return value if math.isfinite(value) else math.nan
