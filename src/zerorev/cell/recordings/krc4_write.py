"""A recording written as a KRC4 trace: one module per drive, and one of the tip; what `krc4` reads."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Literal

import numpy as np

from zerorev.cell.recordings.channels import column_name
from zerorev.errors import InputError
from zerorev.files.output import write_bytes
from zerorev.model._arrays import Array
from zerorev.model.recording import TIP_ARRAYS, Recording

__all__ = ["NO_VALUE", "write_krc4"]

NO_VALUE = 9.9e34  # what DIAdem itself takes
_DRIVE = {
    "joints_commanded": ("Sollposition", {"deg": "°", "rad": "rad"}),
    "joints": ("Istposition", {"deg": "°", "rad": "rad"}),
    "torque_commanded": ("Sollmoment", {}),
    "torque": ("Istmoment", {}),
}
ANGLES = {"deg": np.pi / 180, "rad": 1.0}
EVEN = 1e-6  # of the step, by which a sample may be off


def write_krc4(
    recording: Recording,
    stem: str | Path,
    *,
    angle: Literal["deg", "rad"] = "deg",
    big_endian: bool = False,
    encoding: str = "cp1252",
) -> list[Path]:
    """Write a recording as the files `STEM_NextGenDrive#1.dat`, `.r64`, ... and `STEM_KRCIpo.dat`, `.r64`.

    Args:
        recording: at an even rate.
        stem: folder and beginning of the names.
        angle: unit of the angles, `deg` as a controller has it, or `rad`, with which no digit changes.
        big_endian: whether the high byte of a number comes first.
        encoding: of the headers.

    Returns:
        the headers.

    Raises:
        InputError: its time steps are not even.
        OutputError: a file cannot be written.
    """
    steps = np.diff(recording.time)
    step = float((recording.time[-1] - recording.time[0]) / steps.size)
    if np.abs(steps - step).max() > EVEN * step:
        raise InputError("its time steps are not even", where=recording.source, accepted="an even rate for a trace")
    kind = ">f8" if big_endian else "<f8"
    written = []
    for module, channels in _modules(recording, angle):
        file = Path(f"{stem}_{module}.r64")
        table = np.stack([values for _, _, values in channels], axis=1)
        write_bytes(file, table.astype(kind).tobytes())
        header = _header(file.name, float(recording.time[0]), step, channels, big_endian)
        written.append(file.with_suffix(".dat"))
        write_bytes(written[-1], header.encode(encoding))
    return written


_Column = tuple[str, str, Array]  # name, unit, values


def _modules(recording: Recording, angle: Literal["deg", "rad"]) -> list[tuple[str, list[_Column]]]:
    found: list[tuple[str, list[_Column]]] = []
    for drive in range(6):
        columns: list[_Column] = []
        for member, (name, units) in _DRIVE.items():
            array = getattr(recording, member)
            if array is None:
                continue
            values = array[:, drive]
            if member == "torque_commanded":
                values = _with_no_value(recording, values)
            unit = units.get(angle, "Nm")
            columns.append((name, unit, values / ANGLES[angle] if units else values))
        if columns:
            found.append((f"NextGenDrive#{drive + 1}", columns))
    tips = [
        (column_name(member, n, "m"), "m", getattr(recording, member)[:, n])
        for member in TIP_ARRAYS
        if getattr(recording, member) is not None
        for n in range(3)
    ]
    return [*found, ("KRCIpo", tips)] if tips else found


def _with_no_value(recording: Recording, values: Array) -> Array:
    """No value where none is commanded yet."""
    torque, begin = recording.torque_commanded, recording.commanded_from
    if torque is None or begin is None:
        return values
    unsaid = (recording.time < begin) & (torque == 0).all(axis=1)
    return np.where(unsaid, NO_VALUE, values)


def _header(file: str, begin: float, step: float, channels: Sequence[_Column], big_endian: bool) -> str:
    count = channels[0][2].size
    lines = [
        "DIAEXTENDED  {@:ENGLISH",
        "#BEGINGLOBALHEADER", "1,zerorev", f"111,{NO_VALUE!r}",
        f"112,{'High -> Low' if big_endian else 'Low -> High'}", "#ENDGLOBALHEADER",
        "#BEGINCHANNELHEADER", "200,Zeit", "202,s", "210,IMPLIZIT", f"220,{count}", f"240,{begin!r}", f"241,{step!r}",
        "#ENDCHANNELHEADER",
    ]  # fmt: skip
    for n, (name, unit, values) in enumerate(channels, 1):
        said = values[values != NO_VALUE]
        lines += [
            "#BEGINCHANNELHEADER", f"200,{name}", f"202,{unit}", "210,EXPLIZIT", f"211,{file}", "213,BLOCK",
            "214,REAL64", f"220,{count}", f"221,{n}", "240,0", "241,1",
            *([f"250,{float(said.min())!r}", f"251,{float(said.max())!r}"] if said.size else []),
            "#ENDCHANNELHEADER",
        ]  # fmt: skip
    return "\r\n".join(lines) + "\r\n"
