"""Figures of a sampled motion: steps, rates, travel, and the places where a joint turns round."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np

from zerorev.model._arrays import Array
from zerorev.verify.path import Track

__all__ = ["Reversals", "mean_rates", "path_steps", "rates", "reversals", "travel"]

Reversals: TypeAlias = tuple[tuple[int, ...], ...]

NIL_STEP = 1e-12  # [rad]; some thousand times the rounding of an angle
NIL_RATE = float(np.deg2rad(1e-9) * 1e3)  # [rad/m] (conventions: signature)


def path_steps(track: Track) -> Array:
    """Path distance between neighbouring samples [m], shape (N - 1,)."""
    return np.abs(np.diff(track.path.standoff))


def reversals(track: Track) -> Reversals:
    """Where each joint turns round.

    A step that is numerically nil has no direction: a joint that pauses and goes on has not turned round.

    Returns:
        For each of the six joints the indices of the samples from which it moves the other way.
    """
    steps = np.diff(np.ascontiguousarray(track.joints.T))
    moving = np.abs(steps) > np.maximum(NIL_STEP, NIL_RATE * path_steps(track))  # a NaN step is not moving
    turned = []
    for step, moves in zip(steps, moving, strict=True):
        at = np.flatnonzero(moves)
        forward = step[at] > 0
        turned.append(tuple(int(i) for i in at[1:][forward[1:] != forward[:-1]]))
    return tuple(turned)


def travel(track: Track) -> float:
    """Sum over the joints of the angle moved [rad]."""
    return float(np.abs(np.diff(track.joints, axis=0)).sum())


def rates(track: Track) -> Array:
    """Joint rates |d theta / d path| between neighbouring samples [rad/m], shape (N - 1, 6)."""
    return np.abs(np.diff(track.joints, axis=0)) / path_steps(track)[:, None]


def mean_rates(track: Track) -> Array:
    """The lesser of the two legs' average |d theta / d path| [rad/m], shape (6,)."""
    moved, steps, corner = np.abs(np.diff(track.joints, axis=0)), path_steps(track), track.path.corner
    legs = slice(None, corner), slice(corner, None)
    return np.asarray(np.fmin(*(moved[leg].sum(axis=0) / steps[leg].sum() for leg in legs)))
