"""Where a program begins in a recording, by the first torque that is commanded (thesis §5.3)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from zerorev.errors import InputError
from zerorev.model.recording import Recording

__all__ = ["AlignedBy", "Alignment", "aligned"]

AlignedBy = Literal["commanded_torque", "commanded_position", "measured_position"]


@dataclass(frozen=True)
class Alignment:
    """Where a program begins.

    Attributes:
        by: what said so.
        sample: of the recording, from 0.
        time: of that sample [s].
    """

    by: AlignedBy
    sample: int
    time: float


def aligned(recording: Recording) -> Alignment:
    """The first commanded torque, or where none is recorded the first change of the commanded position.

    Where nothing commanded is recorded it is the first sample: what rests before the motion is cut off later.

    Raises:
        InputError: what is commanded never changes.
    """
    if recording.commanded_from is not None:
        return _at(recording, "commanded_torque", int(np.searchsorted(recording.time, recording.commanded_from)))
    for commanded in (recording.joints_commanded, recording.tcp_commanded):
        if commanded is not None:
            moved = np.flatnonzero((commanded != commanded[0]).any(axis=1))
            if not moved.size:
                raise InputError(
                    "the commanded position never changes", where=recording.source, accepted="the recording of a motion"
                )
            return _at(recording, "commanded_position", int(moved[0]))
    return _at(recording, "measured_position", 0)


def _at(recording: Recording, by: AlignedBy, sample: int) -> Alignment:
    return Alignment(by, sample, float(recording.time[sample]))
