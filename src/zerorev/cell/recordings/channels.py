"""What a channel of a file means: one vocabulary of names, `A1_cmd_deg` or `X_mm`, and the names of controllers.

A name says its unit by its end alone. A channel with any other name is kept aside and reported, never guessed; a
mapping file says what it means.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from zerorev.errors import InputError
from zerorev.files.text import read_text
from zerorev.files.yaml_text import yaml_document
from zerorev.model.recording import TIP_ARRAYS

__all__ = [
    "ACCEPTED", "KNOWN_OTHERS", "MEMBERS", "NO_MAPPING", "Mapping", "Meaning", "column_name", "drive_channel", "listed",
    "meaning_of", "read_mapping",
]  # fmt: skip

MEMBERS = {
    "joints": ("A{}_{}", "deg"),
    "joints_commanded": ("A{}_cmd_{}", "deg"),
    "torque": ("A{}_torque_{}", "nm"),
    "torque_commanded": ("A{}_torque_cmd_{}", "nm"),
    "tcp": ("{}_{}", "mm"),
    "tcp_commanded": ("{}_cmd_{}", "mm"),
}
"""The names of each member's channels, and the unit in which they are written."""

ACCEPTED = (
    "t_s, A1_deg to A6_deg, A1_cmd_deg, A1_torque_nm, A1_torque_cmd_nm, X_mm, Y_mm, Z_mm, X_cmd_mm (or _ms, _rad, _m)"
)
GEAR_RATIOS = "six numbers other than 0: angle of the motor over angle of the joint"

_NAME = re.compile(r"(?P<axis>t|A[1-6]|[XYZ])(?P<torque>_torque)?(?P<cmd>_cmd)?_(?P<unit>s|ms|deg|rad|mm|m|nm)")
_UNITS = {
    "s": ("time", 1.0),
    "ms": ("time", 1e-3),
    "deg": ("angle", math.pi / 180),
    "rad": ("angle", 1.0),
    "mm": ("length", 1e-3),
    "m": ("length", 1.0),
    "nm": ("torque", 1.0),
}
# of a drive's own channels: as met in public readers of these files
_DRIVE = {
    "sollposition": ("A{}_cmd_", "angle"),
    "istposition": ("A{}_", "angle"),
    "sollmoment": ("A{}_torque_cmd_", "torque"),
    "istmoment": ("A{}_torque_", "torque"),
}
_WRITTEN_UNITS = {"°": "deg", "deg": "deg", "grad": "deg", "rad": "rad", "nm": "nm", "mm": "mm", "m": "m",
                  "s": "s", "ms": "ms"}  # fmt: skip
# of a drive or of RSI: known, and of no use here
KNOWN_OTHERS = (
    "positionsschleppfehler", "sollgeschwindigkeit", "istgeschwindigkeit", "geschwindigkeitsdifferenz", "iststrom",
    "motortemperatur", "zeit",
)  # fmt: skip


@dataclass(frozen=True)
class Meaning:
    """What a channel holds.

    Attributes:
        member: of a recording, or `time`.
        index: joint or coordinate, from 0.
        factor: SI units in one of the channel's.
    """

    member: str
    index: int = 0
    factor: float = 1.0


@dataclass(frozen=True)
class Mapping:
    """What a user says of a file.

    Attributes:
        channels: names of the vocabulary by the names of channels, as they are in the file.
        gear_ratio: by which the positions of the drives of a trace are divided, one per joint.
    """

    channels: dict[str, str] = field(default_factory=dict)
    gear_ratio: tuple[float, ...] = (1.0,) * 6

    def __post_init__(self) -> None:
        """Check the numbers and the names.

        Raises:
            InputError: one that is not as it has to be.
        """
        ratio = self.gear_ratio
        if len(ratio) != 6 or not all(math.isfinite(each) and each != 0 for each in ratio):
            raise InputError("gear ratios that cannot be", where="gear_ratio", accepted=GEAR_RATIOS)
        for channel, name in self.channels.items():
            if meaning_of(name) is None:
                raise InputError(f"'{name}' is not a meaning", where=f"channel '{channel}'", accepted=ACCEPTED)

    def meaning(self, channel: str, *places: str) -> Meaning | None:
        """What a user says that a channel means.

        Args:
            channel: its name.
            places: where it is, by which it can be named as well, as in `NextGenDrive#1/Lage`.
        """
        names = (*(f"{place}/{channel}" for place in places), channel)
        found = next((self.channels[name] for name in names if name in self.channels), None)
        return None if found is None else meaning_of(found)


NO_MAPPING = Mapping()


def meaning_of(name: str) -> Meaning | None:
    """What a name of the vocabulary means; None for any other."""
    found = _NAME.fullmatch(name.strip())
    if found is None:
        return None
    axis, commanded = found["axis"], found["cmd"] is not None
    kind, factor = _UNITS[found["unit"]]
    if axis == "t":
        return Meaning("time", 0, factor) if kind == "time" and not commanded and not found["torque"] else None
    if axis in "XYZ":
        if kind != "length" or found["torque"]:
            return None
        return Meaning(TIP_ARRAYS[commanded], "XYZ".index(axis), factor)
    if kind != ("torque" if found["torque"] else "angle"):
        return None
    member = "torque" if found["torque"] else "joints"
    return Meaning(f"{member}_commanded" if commanded else member, int(axis[1]) - 1, factor)


def drive_channel(name: str, unit: str, drive: int) -> Meaning | None:
    """What a channel of a drive's module of a KRC4 trace means; None where its name or its unit does not say it.

    Args:
        name: as the controller writes it, in German.
        unit: as the controller writes it.
        drive: 1 to 6.
    """
    stem, kind = _DRIVE.get(name.strip().lower(), ("", ""))
    suffix = _WRITTEN_UNITS.get(unit.strip().lower(), "")
    if not stem or not suffix or _UNITS[suffix][0] != kind:
        return None
    return meaning_of(stem.format(drive) + suffix)


def column_name(member: str, index: int, unit: str | None = None) -> str:
    """The name in the vocabulary of one column of a member, in the unit in which it is written or another."""
    form, written = MEMBERS[member]
    return form.format("XYZ"[index] if member in TIP_ARRAYS else index + 1, unit or written)


def read_mapping(path: str | Path) -> Mapping:
    """What a user says of a file, from YAML: `channels`, a mapping of names, and `gear_ratio`, six numbers.

    Raises:
        InputError: not such a file.
    """
    accepted = "channels: {a channel's name: A1_deg}, gear_ratio: six numbers"
    document = yaml_document(read_text(Path(path), "a mapping of channels (YAML)"), str(path))
    data = document.data
    if not isinstance(data, dict) or not set(data) <= {"channels", "gear_ratio"}:
        raise InputError("is not a mapping of channels", where=str(path), accepted=accepted)
    channels, ratio = data.get("channels") or {}, data.get("gear_ratio") or NO_MAPPING.gear_ratio
    if not isinstance(channels, dict) or not all(isinstance(name, str) for name in channels.values()):
        raise InputError("not names", where=document.where(("channels",)), accepted=accepted)
    if not isinstance(ratio, (list, tuple)) or not all(_is_number(each) for each in ratio):
        raise InputError("not numbers", where=document.where(("gear_ratio",)), accepted=GEAR_RATIOS)
    try:
        return Mapping(dict(channels), tuple(map(float, ratio)))
    except (InputError, OverflowError) as error:
        problem = error if isinstance(error, InputError) else InputError("a number that is too large")
        raise InputError(problem.what, where=f"{path}, {problem.where}", accepted=problem.accepted) from None


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def listed(names: Iterable[str], most: int = 8) -> str:
    """Names for a message; many are cut short."""
    names = list(names)
    more = f" and {len(names) - most} more" if len(names) > most else ""
    return ", ".join(names[:most]) + more
