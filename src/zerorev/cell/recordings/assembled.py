"""A recording out of the channels of any file: groups that are whole, rows that are whole, and what was left out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from zerorev.cell.recordings.channels import MEMBERS, column_name, listed
from zerorev.errors import InputError
from zerorev.model._arrays import Array
from zerorev.model.finding import Finding
from zerorev.model.recording import LEAST_SAMPLES, TIP_ARRAYS, Recording

__all__ = ["Channels", "assembled"]


@dataclass
class Channels:
    """What is read so far of a file; NaN where a sample has no value.

    Attributes:
        source: how messages name the file.
        time: [s], shape (N,).
        values: SI, shape (N,), by member and index.
        unknown: names of channels whose meaning is not known.
        findings: of the reading.
    """

    source: str
    time: Array
    values: Mapping[tuple[str, int], Array]
    unknown: Sequence[str] = ()
    findings: list[Finding] = field(default_factory=list)

    def say(self, level: str, kind: str, message: str) -> None:
        """Add a finding."""
        self.findings.append(Finding(level, kind, message))  # type: ignore[arg-type]


def assembled(channels: Channels) -> Recording:
    """The recording that the channels are.

    A sample without a position is dropped and counted; a commanded torque without a value means that none is commanded.

    Raises:
        InputError: neither six joints nor a tip, too few samples, a time that does not rise.
    """
    members = _whole_members(channels)
    if not set(members) & {"joints", "joints_commanded", *TIP_ARRAYS}:
        raise InputError(
            "neither six joint angles nor a tip" + _unknown_words(channels.unknown),
            where=channels.source,
            accepted="A1_deg to A6_deg, or X_mm, Y_mm and Z_mm, or a mapping that says which channels they are",
        )
    time = np.asarray(channels.time, dtype=float)
    commanded_from = _commanded_from(time, members.get("torque_commanded"))
    if (torque := members.get("torque_commanded")) is not None:
        members["torque_commanded"] = np.where(np.isfinite(torque), torque, 0.0)
    whole = np.isfinite(time)
    for array in members.values():
        whole &= np.isfinite(array).all(axis=1)
    if dropped := int((~whole).sum()):
        if whole.sum() < LEAST_SAMPLES:
            raise InputError(
                f"{int(whole.sum())} of {time.size} samples have all of their values",
                where=channels.source,
                accepted=f"{LEAST_SAMPLES} or more",
            )
        channels.say("warning", "rows_dropped", f"{dropped} of {time.size} samples have no value for some joint or "
                     "coordinate; they are dropped")  # fmt: skip
        time, members = time[whole], {name: array[whole] for name, array in members.items()}
    if channels.unknown:
        channels.say("info", "channels", f"not used, since their meaning is not known: {listed(channels.unknown)}")
    if "torque" not in members and "torque_commanded" not in members:
        channels.say("info", "no_torque", "no torque was recorded")
    return Recording(
        time, source=channels.source, findings=tuple(channels.findings), commanded_from=commanded_from,
        other_channels=tuple(channels.unknown), **members,
    )  # fmt: skip


def _whole_members(channels: Channels) -> dict[str, Array]:
    """The members of which every joint or coordinate is there; the others are reported."""
    found = {}
    for member in MEMBERS:
        width = 3 if member in TIP_ARRAYS else 6
        there = [n for n in range(width) if (member, n) in channels.values]
        if len(there) == width:
            found[member] = np.stack([channels.values[member, n] for n in range(width)], axis=1)
        elif there:
            names = listed(column_name(member, n) for n in range(width) if n not in there)
            channels.say("warning", "channels", f"{member.replace('_', ', ')}: not used, since {names} are missing")
    return found


def _commanded_from(time: Array, torque: Array | None) -> float | None:
    """Time [s] of the first commanded torque where the file has none before it; None: values from its first sample."""
    if torque is None or np.isfinite(torque[0]).any():
        return None
    first = np.flatnonzero(np.isfinite(torque).any(axis=1))
    return float(time[first[0]]) if first.size else None


def _unknown_words(names: Sequence[str]) -> str:
    return f"; of unknown meaning: {listed(names)}" if names else ""
