"""Curves of a study along the path, for figures and for the page: medians with their bands, in their units."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from zerorev.cell.ensemble import SIDES, HoleStudy
from zerorev.cell.motions import MotionName
from zerorev.model._arrays import Array

__all__ = ["DRAWN", "SIDE_WORDS", "Banded", "stray_curve", "torque_curve"]

DRAWN: tuple[MotionName, ...] = ("baseline", "plan")
"""The motions that are drawn, the one that is compared with first."""
SIDE_WORDS = {"encoder": "by the encoders", "tool": "at the tool"}


@dataclass(frozen=True)
class Banded:
    """A curve along the path, n points.

    Attributes:
        path: over the stroke, -1 at its start, 0 at the turn, 1 at its end, shape (n,).
        low: 5th percentile, shape (n,).
        median: shape (n,).
        high: 95th percentile, shape (n,).
    """

    path: Array
    low: Array
    median: Array
    high: Array

    @property
    def changes(self) -> Array:
        """Where the median changes its sign, over the stroke as `path`, shape (k,)."""
        known = np.flatnonzero(self.median)  # without zeros, at which a curve may also turn back
        path, value = self.path[known], self.median[known]
        at = np.flatnonzero(value[:-1] * value[1:] < 0)
        share = value[at] / (value[at] - value[at + 1])
        return np.asarray(path[at] + share * np.diff(path)[at])


def stray_curve(hole: HoleStudy, motion: MotionName, side: str) -> Banded:
    """Distance of the tip from its mean path [mm].

    Args:
        hole: of a study.
        motion: that could be run.
        side: one of `SIDES`.
    """
    return Banded(hole.path, *hole.profile[hole.of(motion), SIDES.index(side)] * 1e3)


def torque_curve(hole: HoleStudy, motion: MotionName, joint: int) -> Banded:
    """Torque of a drive, on the side of the joint [N m].

    Args:
        hole: of a study.
        motion: that could be run.
        joint: 0..5.
    """
    return Banded(hole.path, *hole.torque[hole.of(motion), joint])
