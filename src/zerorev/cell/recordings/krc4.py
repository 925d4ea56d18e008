"""KRC4 traces: several modules of one trace, each a DIAdem header (.dat) and its numbers (.r64), put on one time.

The numbers are read piece by piece: of a trace too long for memory, every k-th sample is kept, and that is reported.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from zerorev.cell.recordings.assembled import Channels, assembled
from zerorev.cell.recordings.channels import KNOWN_OTHERS, NO_MAPPING, Mapping, Meaning, drive_channel, meaning_of
from zerorev.cell.recordings.diadem import Channel
from zerorev.cell.recordings.r64 import Module, open_module
from zerorev.errors import InputError
from zerorev.model._arrays import Array
from zerorev.model.recording import Recording

__all__ = ["MAX_SAMPLES", "is_trace", "modules_of", "read_krc4"]

MAX_SAMPLES = 500_000  # kept of one recording: 500 s at 1 ms, some 150 MB
MAX_FILES = 200_000  # of a folder
ENDINGS = (".dat", ".r64", ".trc")
_MODULE = re.compile(r"(?P<stem>.+)_(?P<module>KRCIpo|KRCIO|NextGenDrive#(?P<drive>[1-9]\d?))", re.IGNORECASE)


@dataclass(frozen=True)
class _Wanted:
    """A channel that is used, and where it is."""

    module: Module
    channel: Channel
    meaning: Meaning
    ratio: float


def is_trace(path: Path) -> bool:
    """Whether a path is a file of a trace, or the common stem of one."""
    return path.suffix.lower() in ENDINGS or (not path.exists() and bool(_beside(path.parent, path.name)))


def read_krc4(path: str | Path, mapping: Mapping = NO_MAPPING) -> Recording:
    """The recording of which a file is one module; the other modules lie beside it.

    Args:
        path: any .dat or .r64 of the trace, or their common stem.
        mapping: what the user says of the channels, and the gear ratios of the drives.

    Raises:
        InputError: not a trace; one that does not fit its header; the message names file and line or byte.
    """
    modules = [open_module(name, file) for name, file in modules_of(Path(path)).items()]
    unknown: list[str] = []
    channels = Channels(str(path), np.empty(0), {}, unknown)
    wanted = _wanted(modules, mapping, channels, unknown)
    if not wanted:
        return assembled(channels)  # which says what is missing
    for module in modules:
        if module.torn:
            channels.say("warning", "rows_dropped", f"{module.file.name}: the last row is incomplete and is dropped")
    used = [module for module in modules if any(each.module is module for each in wanted)]
    finest = min(used, key=lambda module: module.step)
    begin, end = max(module.begin for module in used), min(module.end for module in used)
    first, last = finest.index_at(begin), finest.index_at(end)
    if last - first < 1:
        raise InputError("the modules have no time in common", where=str(path), accepted="the modules of one trace")
    every = -(-(last - first + 1) // MAX_SAMPLES)
    _say_rates(channels, used, finest, every)
    picked = slice(first, last + 1, every)
    channels.time = finest.times(picked)
    channels.values = {
        (meaning.member, meaning.index): values for meaning, values in _values(wanted, finest, picked, channels.time)
    }
    return assembled(channels)


def modules_of(path: Path) -> dict[str, Path]:
    """The headers of the modules of a trace, by the modules' names.

    Args:
        path: any .dat or .r64 of the trace, or their common stem.

    Raises:
        InputError: no header is there.
    """
    name = path.stem if path.suffix.lower() in ENDINGS else path.name
    found = _MODULE.fullmatch(name)
    if found is None and path.suffix.lower() in ENDINGS:  # a data set by itself
        beside = {file.name.lower(): file for file in _listed(path.parent)}
        header = beside.get(f"{name}.dat".lower())
        modules = {} if header is None else {name: header}
    else:
        modules = _beside(path.parent, found["stem"] if found else name)
    if not modules:
        raise InputError("no header of a trace", where=str(path), accepted="NAME_KRCIpo.dat, NAME_NextGenDrive#1.dat")
    return modules


def _beside(folder: Path, stem: str) -> dict[str, Path]:
    found: dict[str, Path] = {}
    for file in _listed(folder):
        match = _MODULE.fullmatch(file.stem)
        if match and file.suffix.lower() == ".dat" and match["stem"].lower() == stem.lower():
            found[match["module"]] = file
    # the drives first: where two modules hold the same, the drive's is used
    return dict(sorted(found.items(), key=lambda item: (not item[0].lower().startswith("next"), item[0].lower())))


def _listed(folder: Path) -> Iterator[Path]:
    try:
        for n, file in enumerate(sorted(folder.iterdir())):
            if n == MAX_FILES:
                raise InputError(f"more than {MAX_FILES:,} files", where=str(folder), accepted="a smaller folder")
            yield file
    except (OSError, ValueError):
        return


def _wanted(modules: list[Module], mapping: Mapping, channels: Channels, unknown: list[str]) -> list[_Wanted]:
    """The channels that are used; the others are listed or reported."""
    found: dict[tuple[str, int], _Wanted] = {}
    for module in modules:
        match = re.fullmatch(r"nextgendrive#(\d+)", module.name.lower())
        drive = int(match[1]) if match and 1 <= int(match[1]) <= 6 else 0
        for channel in module.header.channels:
            if channel is module.clock:
                continue
            given = mapping.meaning(channel.name, module.name) or meaning_of(channel.name)
            meaning = given or (drive_channel(channel.name, channel.unit, drive) if drive else None)
            if meaning is None or meaning.member == "time" or channel.implicit:
                if channel.name.strip().lower() not in KNOWN_OTHERS:
                    unknown.append(f"{module.name}/{channel.name}")
                continue
            place = (meaning.member, meaning.index)
            if place in found:
                first = found[place]
                channels.say("info", "channels", f"{module.name}/{channel.name} is what {first.module.name}/"
                             f"{first.channel.name} is; the latter is used")  # fmt: skip
                continue
            of_drive = drive and meaning.member in ("joints", "joints_commanded")
            found[place] = _Wanted(module, channel, meaning, mapping.gear_ratio[drive - 1] if of_drive else 1.0)
    return list(found.values())


def _say_rates(channels: Channels, used: list[Module], finest: Module, every: int) -> None:
    coarse = sorted({round(module.step * 1e3, 6) for module in used} - {round(finest.step * 1e3, 6)})
    if coarse:
        steps = ", ".join(f"{step:g}" for step in coarse)
        channels.say(
            "info", "resampled", f"modules with a sample in {steps} ms are resampled to {finest.step * 1e3:g} ms"
        )
    if every > 1:
        channels.say("warning", "resampled", f"too long for memory: of every {every} samples one is kept")


def _values(wanted: list[_Wanted], finest: Module, picked: slice, time: Array) -> Iterator[tuple[Meaning, Array]]:
    """SI values on the common time, module by module; those of the finest are as the file has them."""
    for module in dict.fromkeys(each.module for each in wanted):
        mine = [each for each in wanted if each.module is module]
        every = 1 if module is finest else -(-module.rows // MAX_SAMPLES)
        rows = picked if module is finest else slice(0, module.rows, every)
        own = None if module is finest else module.times(rows)
        table = module.read([each.channel for each in mine], rows)
        for n, each in enumerate(mine):
            values = table[:, n] * (each.meaning.factor / each.ratio)
            yield each.meaning, values if own is None else _resampled(own, values, time)


def _resampled(own: Array, values: Array, time: Array) -> Array:
    """Linear between samples; no value where a neighbour has none."""
    missing = np.isnan(values)
    if not missing.any():
        return np.interp(time, own, values)
    found = np.interp(time, own, np.where(missing, 0.0, values))
    found[np.interp(time, own, missing.astype(float)) > 0] = np.nan
    return found
