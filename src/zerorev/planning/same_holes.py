"""Holes that are drilled twice: on one axis, with strokes that overlap, from the same side or from both."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from zerorev.model._arrays import Array
from zerorev.model.hole import Hole
from zerorev.model.plan import named_holes

__all__ = ["CLOSE", "same_holes"]

CLOSE = 0.5e-3  # [m] between two axes: nearer than the radius of any drill
PARALLEL = np.cos(np.deg2rad(2.0))
MOST_SAID = 5
AT_ONCE = 2**18  # pairs that are compared at once
MOST_PAIRS = 10_000  # that are found before the rest is left
MOST_HOLES = 20_000  # beyond which only holes of which the middles meet are compared


def same_holes(holes: Sequence[Hole]) -> Iterator[str]:
    """What is to be said of holes that are one; those that are given to compare branches or motions are left out.

    Args:
        holes: of a job.
    """
    searched = [hole for hole in holes if hole.profile is None and hole.branch is None]
    if len(searched) < 2:
        return
    pairs = list(_pairs(searched))
    for one, other, apart in pairs[:MOST_SAID]:
        same = np.allclose(searched[one].target, searched[other].target, rtol=0, atol=1e-6)
        where = "at the same place" if same else "on one axis" if apart < 1e-6 else f"{apart * 1e3:.2g} mm apart"
        sides = " from opposite sides" if searched[one].direction @ searched[other].direction < 0 else ""
        yield f"{searched[one].id} and {searched[other].id} are drilled {where}{sides}: is one of them a duplicate?"
    if len(pairs) > MOST_SAID:
        rest = sorted({searched[n].id for pair in pairs[MOST_SAID:] for n in pair[:2]})
        count = f"{len(pairs) - MOST_SAID:,}{' or more' if len(pairs) >= MOST_PAIRS else ''}"
        yield f"other pairs of holes that overlap so: {count}; {named_holes(rest)}"


def _pairs(holes: Sequence[Hole]) -> Iterator[tuple[int, int, float]]:
    """Pairs of holes on one axis whose strokes overlap by half of the shorter, with the distance [m] of their axes."""
    bottom, along = np.array([hole.target for hole in holes]), np.array([hole.direction for hole in holes])
    depth = np.array([hole.depth for hole in holes])
    middle = bottom - 0.5 * depth[:, None] * along
    # strokes that overlap so far have middles no farther apart than half of the longer; sorted along one axis of the
    # base only holes within that are compared
    reach = CLOSE + (0.5 * float(depth.max()) if len(holes) <= MOST_HOLES else 0.0)
    axis = int(np.argmax(np.ptp(middle, axis=0)))
    order = np.argsort(middle[:, axis], kind="stable")
    ends = np.searchsorted(middle[order, axis], middle[order, axis] + reach, side="right")
    begin = 0
    found: list[tuple[int, int, float]] = []
    while begin < len(order) and len(found) < MOST_PAIRS:
        stop = begin + max(1, int(np.searchsorted(np.cumsum(ends[begin:] - np.arange(begin, len(order))), AT_ONCE)))
        rows = np.arange(begin, min(stop, len(order)))
        counts = ends[rows] - rows - 1
        first = np.repeat(rows, counts)
        second = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts) + first + 1
        a, b = order[first], order[second]
        found += _same(middle, along, depth, np.minimum(a, b), np.maximum(a, b))
        begin = int(rows[-1]) + 1
    yield from sorted(found)


def _same(middle: Array, along: Array, depth: Array, a: Array, b: Array) -> list[tuple[int, int, float]]:
    between = middle[b] - middle[a]
    shift = np.abs(np.einsum("ij,ij->i", between, along[a]))
    across = np.sqrt(np.maximum(np.einsum("ij,ij->i", between, between) - shift**2, 0.0))
    parallel = np.abs(np.einsum("ij,ij->i", along[a], along[b])) > PARALLEL
    overlap = 0.5 * (depth[a] + depth[b]) - shift
    same = parallel & (across < CLOSE) & (overlap > 0.5 * np.minimum(depth[a], depth[b]))
    return [(int(i), int(j), float(apart)) for i, j, apart in zip(a[same], b[same], across[same], strict=True)]
