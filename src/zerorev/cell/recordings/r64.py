"""The numbers of one module of a trace: float64, sample by sample or channel by channel, read piece by piece."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import BinaryIO

import numpy as np

from zerorev.cell.recordings.diadem import Channel, Header, read_header
from zerorev.errors import InputError
from zerorev.files.text import opened
from zerorev.model._arrays import Array

__all__ = ["Module", "open_module"]

NUMBER = 8  # bytes
PIECE = 4 * 2**20  # bytes that are in memory at once
CLOCK_UNITS = {"": 1.0, "s": 1.0, "sec": 1.0, "sek": 1.0, "ms": 1e-3}
CLOCKS = ("zeit", "time", "t_s", "t_ms")


@dataclass(eq=False)
class Module:
    """One module of a trace.

    Attributes:
        name: of the module, e.g. NextGenDrive#1.
        header: as read.
        file: with the numbers.
        clock: the channel of time.
        columns: numbers of one row; 1 where each channel stands by itself.
        rows: samples.
        torn: whether a part of a last row was there.
    """

    name: str
    header: Header
    file: Path
    clock: Channel
    columns: int
    rows: int
    torn: bool
    _explicit: Array | None = field(default=None, repr=False)

    @property
    def step(self) -> float:
        """Time between samples [s]; the median of a clock that is in the file."""
        if self.clock.implicit:
            return self.clock.factor * self._unit
        return float(np.median(np.diff(self._clock)))

    @property
    def begin(self) -> float:
        """Time of the first sample [s]."""
        return float(self.times(slice(0, 1, 1))[0])

    @property
    def end(self) -> float:
        """Time of the last sample [s]."""
        return float(self.times(slice(self.rows - 1, self.rows, 1))[0])

    @property
    def _unit(self) -> float:
        return CLOCK_UNITS[self.clock.unit.strip().lower()]

    @property
    def _clock(self) -> Array:
        if self._explicit is None:
            self._explicit = self.read([self.clock], slice(0, self.rows, 1))[:, 0] * self._unit
        return self._explicit

    def times(self, rows: slice) -> Array:
        """Times of samples [s]."""
        if not self.clock.implicit:
            return self._clock[rows]
        count = np.arange(rows.start, rows.stop, rows.step)
        return np.asarray((self.clock.offset + count * self.clock.factor) * self._unit)

    def index_at(self, time: float) -> int:
        """The sample at a time [s], the nearest one."""
        if not self.clock.implicit:
            return int(np.clip(np.searchsorted(self._clock, time - self.step / 2), 0, self.rows - 1))
        return int(np.clip(round((time - self.begin) / self.step), 0, self.rows - 1))

    def read(self, channels: Sequence[Channel], rows: slice) -> Array:
        """Values in the channels' units, shape (samples, channels); NaN where there is none.

        Raises:
            InputError: values outside the range that the header states for their channel.
        """
        count = len(range(rows.start, rows.stop, rows.step))
        raw = np.empty((count, len(channels)))
        with opened(self.file, "the numbers of a trace (.r64)") as stream:
            if self.columns > 1 or all(channel.block for channel in channels):
                stream.seek(rows.start * self.columns * NUMBER)
                self._fill(stream, raw, [channel.first - 1 for channel in channels], rows, self.columns)
            else:
                for n, channel in enumerate(channels):
                    stream.seek((channel.first - 1 + rows.start) * NUMBER)
                    self._fill(stream, raw[:, n : n + 1], [0], rows, 1)
        missing = ~np.isfinite(raw)
        if self.header.no_value is not None:
            missing |= raw == self.header.no_value
        found = raw * [channel.factor for channel in channels]
        for n, channel in enumerate(channels):
            if channel.offset:  # adding 0 would change the sign of -0
                found[:, n] += channel.offset
        found[missing] = np.nan
        raw[missing] = np.nan
        for n, channel in enumerate(channels):
            self._check_range(channel, raw[:, n], found[:, n])
        return np.asarray(found)

    def _fill(self, stream: BinaryIO, out: Array, columns: list[int], rows: slice, width: int) -> None:
        kind = ">f8" if self.header.big_endian else "<f8"
        # a whole number of steps at a time, so that each piece begins with a sample that is kept
        at_once = max(1, PIECE // (NUMBER * width * rows.step)) * rows.step
        done = 0
        for begin in range(rows.start, rows.stop, at_once):
            wanted = min(at_once, rows.stop - begin)
            data = stream.read(wanted * width * NUMBER)
            if len(data) < wanted * width * NUMBER:
                raise InputError("became shorter while it was read", where=str(self.file), accepted="a file at rest")
            table = np.frombuffer(data, kind).reshape(wanted, width)[:: rows.step]
            out[done : done + len(table)] = table[:, columns]
            done += len(table)

    def _check_range(self, channel: Channel, raw: Array, found: Array) -> None:
        """Refuse values beyond the header's 250 and 251, which it may give before or after factor and offset."""
        if channel.least is None or channel.most is None or np.isnan(raw).all():
            return
        room = 1e-6 * (abs(channel.least) + abs(channel.most)) + 1e-9
        for values in (raw, found):
            low, high = float(np.nanmin(values)), float(np.nanmax(values))
            if low >= channel.least - room and high <= channel.most + room:
                return
        raise InputError(
            f"{channel.name}: values from {low:g} to {high:g}, beyond the {channel.least:g} to {channel.most:g} of the "
            "header; the channels do not fit the file",
            where=str(self.file),
            accepted="the header and the numbers of one trace",
        )


def open_module(name: str, path: Path) -> Module:
    """A module whose header is read, and whose numbers are there.

    Raises:
        InputError: the header is wrong, the numbers are missing or do not fit it.
    """
    header = read_header(path)
    clock = _clock(header)
    stored = [channel for channel in header.channels if not channel.implicit]
    if not stored:
        raise InputError("no channel has values", where=str(path), accepted="channels besides the time")
    files = {channel.file.lower() for channel in stored}
    if len(files) > 1 or len({channel.block for channel in stored}) > 1:
        raise InputError(
            "its channels lie in several files or layouts", where=str(path), accepted="one .r64 file of one layout"
        )
    file = _numbers(path, stored[0].file)
    with opened(file, "the numbers of a trace (.r64)") as stream:
        size = stream.seek(0, 2)
    if stored[0].block:
        return _in_rows(Module(name, header, file, clock, max(each.first for each in stored), 0, False), stored, size)
    return _by_channel(Module(name, header, file, clock, 1, 0, False), stored, size)


def _in_rows(module: Module, stored: list[Channel], size: int) -> Module:
    columns = sorted(channel.first for channel in stored)
    if columns != list(range(1, len(columns) + 1)):
        raise InputError(
            "the columns of its channels (221) are not 1, 2, 3 ...", where=module.header.source,
            accepted="each column once",
        )  # fmt: skip
    count, row = max(channel.count for channel in stored), module.columns * NUMBER
    module.rows = size // row
    module.torn = module.rows == count - 1
    if size > count * row or module.rows < count - 1:
        raise InputError(
            f"{size:,} bytes, where {count:,} samples of {module.columns} channels take {count * row:,}; the "
            "channels do not fit the file",
            where=str(module.file),
            accepted="the header and the numbers of one trace; only of the last row a part may be missing",
        )
    return _with_samples(module)


def _by_channel(module: Module, stored: list[Channel], size: int) -> Module:
    module.rows = min(channel.count for channel in stored)
    last = max(channel.first - 1 + channel.count for channel in stored) * NUMBER
    if size != last:
        raise InputError(
            f"{size:,} bytes, where the channels take {last:,}", where=str(module.file),
            accepted="the header and the numbers of one trace",
        )  # fmt: skip
    return _with_samples(module)


def _with_samples(module: Module) -> Module:
    if module.rows < 2:
        raise InputError(f"{module.rows} samples", where=str(module.file), accepted="two or more")
    clock = module.clock
    if clock.implicit and not (clock.factor > 0 and math.isfinite(clock.offset + clock.factor * module.rows)):
        raise InputError(
            f"a time step (241) of {clock.factor:g}", where=f"{module.header.source}, line {clock.line}",
            accepted="a step above 0",
        )  # fmt: skip
    if not clock.implicit:
        times = module.times(slice(0, module.rows, 1))
        back = np.flatnonzero(~(np.diff(times) > 0))
        if back.size:
            byte = int(back[0] + 1) * module.columns * NUMBER
            raise InputError(
                "the time does not rise", where=f"{module.file}, byte {byte:,}", accepted="times that rise row by row"
            )
    return module


def _clock(header: Header) -> Channel:
    named = [channel for channel in header.channels if channel.name.strip().lower() in CLOCKS]
    found = next(iter(named or [channel for channel in header.channels if channel.implicit]), None)
    if found is None:
        raise InputError("no channel of time", where=header.source, accepted="a channel Zeit")
    if found.unit.strip().lower() not in CLOCK_UNITS:
        raise InputError(
            f"the time is in {found.unit[:40]!r}", where=f"{header.source}, line {found.line}", accepted="s or ms"
        )
    return found


def _numbers(path: Path, name: str) -> Path:
    """The file of numbers that a header names, in any case of letters, or the one that is called as the header is."""
    try:
        beside = {file.name.lower(): file for file in path.parent.iterdir()}
    except OSError:
        beside = {}
    for each in (name, f"{path.stem}.r64"):
        if each and each.lower() in beside:
            return beside[each.lower()]
    raise InputError("no file of numbers", where=str(path), accepted=f"{name or path.stem + '.r64'} beside it")
