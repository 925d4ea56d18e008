"""Which range of angles a joint's curve is drawn in, and which of its limits come into view."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from zerorev.model._arrays import Array

__all__ = ["JointRange", "joint_range"]

LEAST_SPAN = 1.0  # [deg] a joint that hardly moves is drawn as one that hardly moves
NEAR, NEAR_DEG = 0.5, 3.0  # of the span, [deg]: a limit no farther off comes into view
PAD = 0.1  # of the range, on either side


class JointRange(NamedTuple):
    """A range of angles [deg], and the limits in it [deg], None where one is out of view."""

    low: float
    high: float
    lower: float | None
    upper: float | None


def joint_range(angles: Array, lower: float, upper: float) -> JointRange:
    """The range for a joint's curves.

    Args:
        angles: of all curves that are drawn together [deg], shape (N,); NaN where there is none.
        lower: limit [deg].
        upper: limit [deg].
    """
    known = angles[np.isfinite(angles)]
    low, high = (float(known.min()), float(known.max())) if known.size else (lower, upper)
    span, middle = max(high - low, LEAST_SPAN), (low + high) / 2
    low, high = min(low, middle - span / 2), max(high, middle + span / 2)
    near = max(NEAR * span, NEAR_DEG)
    below, above = low - lower <= near, upper - high <= near
    low, high = min(low, lower) if below else low, max(high, upper) if above else high
    pad = PAD * (high - low)
    return JointRange(low - pad, high + pad, lower if below else None, upper if above else None)
