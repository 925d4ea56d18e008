"""The slow twin of counting reversals through a blend: the motion is put together whole and counted step by step.

Units as in `zerorev.verify`: m, rad.
"""

from __future__ import annotations

import math

import numpy as np

from zerorev.model.robot import NIL_RATE
from zerorev.verify.measure import NIL_STEP
from zerorev.verify.path import Path, Track

__all__ = ["reversals_of", "reversals_through"]


def reversals_of(track):
    """For each joint the samples from which it moves the other way, one step after the other."""
    standoff, turned = track.path.standoff, []
    for joint in range(6):
        way, found = 0, []
        for i in range(len(standoff) - 1):
            step = track.joints[i + 1, joint] - track.joints[i, joint]
            if math.isnan(step) or abs(step) <= max(NIL_STEP, NIL_RATE * abs(standoff[i + 1] - standoff[i])):
                continue
            if way * step < 0:
                found.append(i)
            way = math.copysign(1, step)
        turned.append(tuple(found))
    return tuple(turned)


def reversals_through(track, blend, before, behind):
    """For each joint the places at which it turns round where a blend replaces the samples `before` to `behind`."""

    def joined(legs, cut):
        return [*legs[:before], *cut, *legs[behind + 1 :]]

    corner, more = track.path.corner, blend.path.standoff.size - (behind - before + 1)
    if before < corner < behind:
        corner = before + blend.path.corner
    elif corner >= behind:
        corner += more
    standoff, psi = (
        np.array(joined(getattr(track.path, name), getattr(blend.path, name))) for name in ("standoff", "psi")
    )
    whole = Track(Path(standoff, psi, (), corner), np.array(joined(track.joints, blend.joints)))
    return [[whole.path.place(i) for i in turns] for turns in reversals_of(whole)]
