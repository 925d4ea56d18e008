"""What a measuring machine says of one drilled hole, by depth."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from zerorev.errors import InputError
from zerorev.model._arrays import Array, finite

__all__ = ["MeasuredHole", "mean_centre", "tilt_of"]


@dataclass(frozen=True, eq=False)
class MeasuredHole:
    """One hole, measured in sections across its nominal axis; what was not measured is None.

    Attributes:
        id: as the plan calls it.
        depth: of the sections below the entry [m], strictly rising, shape (N,).
        diameter: of each section [m], shape (N,), or None.
        centre: of each section, from the nominal axis [m], shape (N, 2), or None.
        roundness: of each section [m], shape (N,), or None.
    """

    id: str
    depth: Array
    diameter: Array | None = None
    centre: Array | None = None
    roundness: Array | None = None

    def __post_init__(self) -> None:
        """Check shapes, finiteness, order and signs.

        Raises:
            InputError: one of these, or nothing was measured.
        """
        where, count = f"hole {self.id}", int(np.size(self.depth))
        for name, shape in (
            ("depth", (count,)),
            ("diameter", (count,)),
            ("centre", (count, 2)),
            ("roundness", (count,)),
        ):
            value = getattr(self, name)
            if value is not None:
                object.__setattr__(self, name, finite(value, shape, f"{where}, {name}"))
        if count == 0 or self.depth[0] < 0 or (np.diff(self.depth) <= 0).any():
            raise InputError("depths that do not rise from 0 or more", where=where, accepted="each depth once")
        if self.diameter is not None and (self.diameter <= 0).any():
            raise InputError("a diameter of 0 or less", where=where, accepted="diameters above 0")
        if self.roundness is not None and (self.roundness < 0).any():
            raise InputError("a negative roundness", where=where, accepted="0 or more")
        if self.diameter is None and self.centre is None and self.roundness is None:
            raise InputError("nothing measured but depths", where=where, accepted="diameter, position or roundness")

    @property
    def position_error(self) -> float | None:
        """Greatest distance of a section's centre from the nominal axis [m]."""
        return None if self.centre is None else float(np.hypot(self.centre[:, 0], self.centre[:, 1]).max())

    @property
    def position(self) -> float | None:
        """Distance of the mean of the sections' centres from the nominal axis [m]."""
        return None if self.centre is None else mean_centre(self.centre)

    @property
    def tilt(self) -> float | None:
        """Angle between the nominal axis and the line that fits the centres best by depth [rad]; None below two."""
        return None if self.centre is None or self.depth.size < 2 else tilt_of(self.depth, self.centre)


def mean_centre(centre: Array) -> float:
    """Distance of the mean of sections' centres from the axis [m].

    Args:
        centre: of the sections, from the axis and across it [m], shape (N, 2) or (N, 3).
    """
    return float(np.linalg.norm(centre.mean(axis=0)))


def tilt_of(depth: Array, centre: Array) -> float:
    """Angle between the axis and the line that fits sections' centres best by depth [rad].

    Args:
        depth: of two or more sections [m], shape (N,).
        centre: of them, from the axis and across it [m], shape (N, 2) or (N, 3).
    """
    along = depth - depth.mean()
    slope = along @ (centre - centre.mean(axis=0)) / (along @ along)
    return float(np.arctan(np.linalg.norm(slope)))
