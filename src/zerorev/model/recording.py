"""What a controller recorded of one run of a program, whichever file it came in."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from zerorev.errors import InputError
from zerorev.model._arrays import Array, finite
from zerorev.model.finding import Finding

__all__ = ["JOINT_ARRAYS", "LEAST_SAMPLES", "TIP_ARRAYS", "Recording"]

LEAST_SAMPLES = 8  # below that nothing can be aligned or measured
JOINT_ARRAYS = ("joints", "joints_commanded", "torque", "torque_commanded")
TIP_ARRAYS = ("tcp", "tcp_commanded")


@dataclass(frozen=True, eq=False)
class Recording:
    """One run, sampled over time; every member but the time may be missing.

    The arrays are finite and of one length N.

    Attributes:
        time: [s], strictly rising, shape (N,).
        joints: measured controller angles [rad], shape (N, 6), or None.
        joints_commanded: commanded controller angles [rad], shape (N, 6), or None.
        torque: measured torque as logged [Nm], of the motor or of the joint, shape (N, 6), or None.
        tcp: measured place of the tip in the base frame by the controller's own tool [m], shape (N, 3), or None.
        tcp_commanded: commanded place of the tip [m], shape (N, 3), or None.
        source: where it comes from, for messages.
        findings: what a user should know of how it was read.
        torque_commanded: commanded torque as logged [Nm], shape (N, 6), 0 where none was commanded yet, or None.
        commanded_from: time [s] of the first commanded torque; None: of the first sample of `torque_commanded` that
            differs from its first one, and None where there is none.
        other_channels: names of channels that are in the file and whose meaning is not known.
    """

    time: Array
    joints: Array | None = None
    joints_commanded: Array | None = None
    torque: Array | None = None
    tcp: Array | None = None
    tcp_commanded: Array | None = None
    source: str = "recording"
    findings: tuple[Finding, ...] = ()
    torque_commanded: Array | None = None
    commanded_from: float | None = None
    other_channels: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Check shapes, finiteness and the order of time.

        Raises:
            InputError: one of these, too few samples, or neither joints nor a tip.
        """
        count = int(np.size(self.time))
        for name, width in (("time", 0), *((n, 6) for n in JOINT_ARRAYS), *((n, 3) for n in TIP_ARRAYS)):
            value = getattr(self, name)
            if value is not None:
                shape = (count, width) if width else (count,)
                object.__setattr__(self, name, finite(value, shape, f"{self.source}, {name}"))
        if count < LEAST_SAMPLES:
            raise InputError(f"{count} samples", where=self.source, accepted=f"{LEAST_SAMPLES} or more")
        back = np.flatnonzero(np.diff(self.time) <= 0)
        if back.size:
            at = int(back[0]) + 1
            raise InputError(
                f"the time does not rise from {self.time[at - 1]:g} to {self.time[at]:g} s",
                where=f"{self.source}, sample {at + 1}",
                accepted="times that rise from sample to sample",
            )
        if all(getattr(self, name) is None for name in ("joints", "joints_commanded", *TIP_ARRAYS)):
            raise InputError(
                "neither joint angles nor a tip", where=self.source, accepted="A1 to A6, or X, Y and Z of the tip"
            )
        if self.commanded_from is None and self.torque_commanded is not None:
            differs = np.flatnonzero((self.torque_commanded != self.torque_commanded[0]).any(axis=1))
            if differs.size:
                object.__setattr__(self, "commanded_from", float(self.time[differs[0]]))

    @property
    def interval(self) -> float:
        """Median time between samples [s]."""
        return float(np.median(np.diff(self.time)))
