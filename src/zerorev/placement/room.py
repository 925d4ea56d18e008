"""How much room there is about a place: along each axis, and over two axes at a time."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from zerorev.model._arrays import Array
from zerorev.placement.freedom import AXES, CLOSE, Freedom
from zerorev.placement.margins import Margins, least

__all__ = ["Slice", "room", "slices"]

STRIDES = 16  # of the freedom along an axis, at which holes are examined on the way out
TOO_SHALLOW = float(np.nextafter(0.0, -1.0))  # the greatest margin that is none

Progress = Callable[[str, int, int], None]


@dataclass(frozen=True)
class Slice:
    """The least margin over one or two axes of the freedom, the others as at the place it goes through.

    Attributes:
        axes: names of the axes, one or two of `AXES`.
        values: along each of them [m or rad].
        margin: least margin [m], with as many dimensions as there are axes.
    """

    axes: tuple[str, ...]
    values: tuple[Array, ...]
    margin: Array


def room(margins: Margins, freedom: Freedom, place: Array, tell: Progress) -> Array:
    """How far the part may be moved along each axis before some hole is too shallow [m or rad], shape (4, 2).

    It is examined in strides of a sixteenth of the freedom, and the first stride that ends too shallow is halved down
    to 0.1 mm or 0.01 deg.

    Args:
        margins: asks about places.
        freedom: beyond which nothing is examined.
        place: where every hole is deep enough, shape (4,).
        tell: called with the progress.
    """
    ends = {(axis, side): (freedom.lower, freedom.upper)[side][axis] - place[axis]
            for axis in freedom.granted for side in (0, 1)}  # fmt: skip
    good, bad = dict.fromkeys(ends, 0.0), dict[tuple[int, int], float]()
    widest = max((abs(end) / STRIDES / CLOSE[axis] for (axis, _), end in ends.items()), default=2.0)
    rounds = 1 + int(np.ceil(np.log2(max(2.0, widest))))

    def deep_enough(asked: list[tuple[tuple[int, int], float]]) -> list[bool]:
        places = np.repeat(place[None], len(asked), axis=0)
        for row, ((axis, _), away) in zip(places, asked, strict=True):
            row[axis] += away
        return [least(seen, TOO_SHALLOW) >= 0 for seen in margins(places, TOO_SHALLOW)]

    tell("room", 0, rounds)
    strides = [(way, ends[way] * n / STRIDES) for way in ends for n in range(1, STRIDES + 1) if ends[way] != 0]
    for (way, away), fine in zip(strides, deep_enough(strides), strict=True):
        if way not in bad:
            if fine:
                good[way] = away
            else:
                bad[way] = away
    for n in range(1, rounds):
        tell("room", n, rounds)
        middles = [(way, (good[way] + bad[way]) / 2) for way in bad if abs(bad[way] - good[way]) > CLOSE[way[0]]]
        for (way, away), fine in zip(middles, deep_enough(middles), strict=True):
            (good if fine else bad)[way] = away
    tell("room", rounds, rounds)
    found = np.zeros((len(AXES), 2))
    for (axis, side), away in good.items():
        found[axis, side] = away
    return found


def slices(margins: Margins, freedom: Freedom, place: Array, cells: int, tell: Progress) -> Iterator[Slice]:
    """The least margin over the granted axes, two at a time, through a place; over one axis where there is only one.

    Args:
        margins: asks about places.
        freedom: whose axes.
        place: that they go through, shape (4,).
        cells: along each axis.
        tell: called with the progress.
    """
    axes = freedom.granted
    shown = list(combinations(axes, 2)) if len(axes) > 1 else [(axis,) for axis in axes]
    total, done = sum(cells ** len(pair) for pair in shown), 0
    for pair in shown:
        values = tuple(freedom.values(axis, cells) for axis in pair)
        margin = np.empty([value.size for value in values])
        places = np.repeat(place[None], margin.size, axis=0)
        for axis, value in zip(pair, np.meshgrid(*values, indexing="ij"), strict=True):
            places[:, axis] = value.ravel()
        for n, seen in enumerate(margins(places, margins.floor)):
            margin.flat[n] = np.nanmin(seen)
            tell("map", done + n, total)
        done += margin.size
        yield Slice(tuple(AXES[axis] for axis in pair), values, margin)
    tell("map", total, total)
