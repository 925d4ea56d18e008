"""Figures of a sampled motion: rates, travel, and the places where a joint turns round."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from zerorev.model._arrays import Array
from zerorev.verify.path import Track

__all__ = ["Reversals", "mean_rates", "reversals", "reversals_through", "slowest_at", "travel"]

Reversals: TypeAlias = tuple[tuple[int, ...], ...]

NIL_STEP = 1e-12  # [rad]; some thousand times the rounding of an angle
WINDOW = 64  # steps among which one that moves is sought first


def reversals(track: Track) -> Reversals:
    """Where each joint turns round.

    A step that is numerically nil has no direction: a joint that pauses and goes on has not turned round.

    Returns:
        For each of the six joints the indices of the samples from which it moves the other way.
    """
    steady = _steady_ways(track)
    return tuple(() if steady[joint] else _turns(track, joint) for joint in range(6))


def _steady_ways(track: Track) -> list[int]:
    """The way of each joint that moves the same way at every step, 1 or -1; 0: not decided at these steps."""
    nil, moves = max(NIL_STEP, track.nil_rate * float(track.path_steps.max())), track.moves
    return [int(least > nil) - int(most < -nil) for least, most in zip(moves.least, moves.most, strict=True)]


def _turns(track: Track, joint: int) -> tuple[int, ...]:
    steps = np.diff(track.joints[:, joint])
    at = np.flatnonzero(_moving(steps, track.path_steps, track.nil_rate))
    forward = steps[at] > 0
    return tuple(at[1:][forward[1:] != forward[:-1]].tolist())


def reversals_through(track: Track, turned: Reversals, blend: Track, before: int, behind: int) -> list[list[str]]:
    """Where each joint turns round if a part of a motion is replaced by a blend.

    Only the blend is counted. On either side the legs turn round where they did before; what matters of them is which
    way a joint moves last before the blend, and first behind it.

    Args:
        track: the whole motion without the blend.
        turned: its reversals.
        blend: what replaces it, from its sample `before` to its sample `behind`, both included.
        before: index in `track` of the blend's first sample.
        behind: index in `track` of its last.

    Returns:
        For each joint the places, in words, in order of motion.
    """
    places, inside = list[list[str]](), reversals(blend)
    for joint, ways in enumerate(zip(_steady_ways(track), _steady_ways(blend), strict=True)):
        if ways in ((1, 1), (-1, -1)):
            places.append([])
            continue
        turns = turned[joint]
        last, first = _last_move(track, joint, before), _first_move(track, joint, behind)
        enters, leaves = _first_move(blend, joint, 0), _last_move(blend, joint, blend.path_steps.size)
        if enters is None:
            replaced = _seam(joint, track, last, track, first)
        else:
            replaced = [
                *_seam(joint, track, last, blend, enters),
                *(blend.path.place(i) for i in inside[joint]),
                *_seam(joint, blend, leaves, track, first),
            ]
        legs_before = [track.path.place(i) for i in turns if i < before]
        legs_behind = [track.path.place(i) for i in turns if first is not None and i > first]
        places.append([*legs_before, *replaced, *legs_behind])
    return places


def _seam(joint: int, one: Track, last: int | None, other: Track, first: int | None) -> list[str]:
    """Where a joint turns round between two steps at which it moves, in words; empty where it does not."""
    if last is None or first is None:
        return []
    before, after = np.diff(one.joints[last : last + 2, joint]), np.diff(other.joints[first : first + 2, joint])
    return [other.path.place(first)] if (before > 0) != (after > 0) else []


def _moving(steps: Array, path_steps: Array, nil_rate: float) -> npt.NDArray[np.bool_]:
    """Whether a joint moves at each of some steps; a NaN step is not moving."""
    return np.asarray(np.abs(steps) > np.maximum(NIL_STEP, nil_rate * path_steps))


def _moves_within(track: Track, joint: int, begin: int, end: int) -> npt.NDArray[np.int64]:
    """The steps from one to another at which a joint moves."""
    steps = np.diff(track.joints[begin : end + 1, joint])
    return begin + np.flatnonzero(_moving(steps, track.path_steps[begin:end], track.nil_rate))


def _last_move(track: Track, joint: int, end: int) -> int | None:
    """The last step before one at which a joint moves."""
    size = WINDOW
    while end > 0:
        begin = max(0, end - size)
        found = _moves_within(track, joint, begin, end)
        if found.size:
            return int(found[-1])
        end, size = begin, 4 * size
    return None


def _first_move(track: Track, joint: int, begin: int) -> int | None:
    """The first step from one on at which a joint moves."""
    size, count = WINDOW, track.path_steps.size
    while begin < count:
        end = min(begin + size, count)
        found = _moves_within(track, joint, begin, end)
        if found.size:
            return int(found[0])
        begin, size = end, 4 * size
    return None


def travel(track: Track) -> float:
    """Sum over the joints of the angle moved [rad]."""
    return float((track.moves.plunge + track.moves.retract).sum())


def slowest_at(track: Track, joint: int) -> int:
    """The sample from which a joint (0 to 5) moves least per path distance."""
    return int((np.abs(np.diff(track.joints[:, joint])) / track.path_steps).argmin())


def mean_rates(track: Track) -> Array:
    """The lesser of the two legs' average |d theta / d path| [rad/m], shape (6,)."""
    corner, end = track.distance[[track.path.corner, -1]]
    return np.asarray(np.fmin(track.moves.plunge / corner, track.moves.retract / (end - corner)))
