"""Solids made of convex pieces (capsules, boxes, triangles), each in a tree of boxes, and how far two are apart.

A piece is the hull of up to eight points, made thicker by a radius: a capsule has two points, a box eight, a triangle
three. Distances are of surfaces where a solid is a mesh: nothing is asked of what is inside, so that a mesh need not be
closed.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from zerorev.kernels._jit import kernel, lean
from zerorev.kernels.hulls import apart

__all__ = ["LEAF", "Room", "Solids", "between", "build", "room"]

Array = npt.NDArray[np.float64]
Whole = npt.NDArray[np.int64]

LEAF = 2  # pieces in a leaf of the tree, at most
DEEP = 256  # pairs of nodes that wait, at most
MOST_POINTS = 8  # of a piece


class Solids(NamedTuple):
    """Some solids, each with a tree of its own; a NamedTuple, so that kernels take it whole.

    Attributes:
        boxes: least and greatest coordinates of each node of the trees, without the radii [m], shape (M, 6).
        links: of each node the first child and 0 (the other one follows it), or the first piece and how many, (M, 2).
        root: node of each solid, shape (S,).
        first: first point of each piece, and behind the last one, shape (P + 1,).
        radius: of each piece [m], shape (P,).
        points: [m], shape (N, 3).
        thick: the greatest radius of each solid [m], shape (S,).
    """

    boxes: Array
    links: Whole
    root: Whole
    first: Whole
    radius: Array
    points: Array
    thick: Array


class Room(NamedTuple):
    """Where a distance is computed.

    Attributes:
        pairs: nodes that wait, shape (DEEP, 2).
        bounds: how far these are apart at least [m], shape (DEEP,).
        moved: points of pieces that were moved, shape (MOST_POINTS * LEAF, 3).
        W: as `hulls.apart` has it.
        A: likewise; its last two rows are the nearest points.
        share: likewise.
    """

    pairs: Whole
    bounds: Array
    moved: Array
    W: Array
    A: Array
    share: Array


def room() -> Room:
    """Room for one distance at a time."""
    return Room(
        np.empty((DEEP, 2), dtype=np.int64), np.empty(DEEP), np.empty((MOST_POINTS * LEAF, 3)), np.empty((4, 3)),
        np.empty((6, 3)), np.empty(4),
    )  # fmt: skip


@kernel
def build(middles, lows, highs, order, boxes, links):  # type: ignore[no-untyped-def]
    """The tree of a solid's pieces: halved along the longest extent of their middles until few are left.

    Args:
        middles: of the pieces [m], shape (P, 3).
        lows: their least coordinates, shape (P, 3).
        highs: their greatest, likewise.
        order: in, 0 to P - 1; out, the pieces as the leaves have them.
        boxes: out, shape (2 P, 6).
        links: out, shape (2 P, 2).

    Returns:
        how many nodes there are.
    """
    todo = np.empty((128, 3), dtype=np.int64)
    todo[0, 0], todo[0, 1], todo[0, 2] = 0, 0, order.shape[0]
    top, used = 1, 1
    while top > 0:
        top -= 1
        node, a, b = todo[top, 0], todo[top, 1], todo[top, 2]
        for c in range(3):
            low, high = np.inf, -np.inf
            for k in range(a, b):
                low, high = min(low, lows[order[k], c]), max(high, highs[order[k], c])
            boxes[node, c], boxes[node, 3 + c] = low, high
        if b - a <= LEAF:
            links[node, 0], links[node, 1] = a, b - a
            continue
        axis, widest = 0, -1.0
        for c in range(3):
            low, high = np.inf, -np.inf
            for k in range(a, b):
                low, high = min(low, middles[order[k], c]), max(high, middles[order[k], c])
            if high - low > widest:
                axis, widest = c, high - low
        half = (a + b) // 2
        _halve(middles, order, a, b, half, axis)
        links[node, 0], links[node, 1] = used, 0
        todo[top, 0], todo[top, 1], todo[top, 2] = used, a, half
        todo[top + 1, 0], todo[top + 1, 1], todo[top + 1, 2] = used + 1, half, b
        top += 2
        used += 2
    return used


@lean
def _halve(middles, order, a, b, half, axis):  # type: ignore[no-untyped-def]
    """Quickselect: order a piece's numbers so that those before `half` are not beyond those behind it."""
    low, high = a, b - 1
    while low < high:
        pivot = middles[order[(low + high) // 2], axis]
        i, j = low, high
        while i <= j:
            while middles[order[i], axis] < pivot:
                i += 1
            while middles[order[j], axis] > pivot:
                j -= 1
            if i <= j:
                order[i], order[j] = order[j], order[i]
                i += 1
                j -= 1
        if half <= j:
            high = j
        elif half >= i:
            low = i
        else:
            return


@lean
def _between_boxes(one, n, T, other, m):  # type: ignore[no-untyped-def]
    """How far a box moved by T, shape (12,), is from another at least [m]: as seen along the edges of either."""
    squared = squared_back = 0.0
    for c in range(3):
        # the middle of the other from the middle of the one, and half of what both fill, along axis c of either frame
        away = 0.5 * (other[m, c] + other[m, 3 + c]) - T[9 + c]
        back = -0.5 * (one[n, c] + one[n, 3 + c])
        fill, fill_back = 0.5 * (other[m, 3 + c] - other[m, c]), 0.5 * (one[n, 3 + c] - one[n, c])
        for k in range(3):
            r, q = T[3 * c + k], T[3 * k + c]
            away -= r * 0.5 * (one[n, k] + one[n, 3 + k])
            fill += abs(r) * 0.5 * (one[n, 3 + k] - one[n, k])
            back += q * (0.5 * (other[m, k] + other[m, 3 + k]) - T[9 + k])
            fill_back += abs(q) * 0.5 * (other[m, 3 + k] - other[m, k])
        gap, gap_back = abs(away) - fill, abs(back) - fill_back
        if gap > 0.0:
            squared += gap * gap
        if gap_back > 0.0:
            squared_back += gap_back * gap_back
    return np.sqrt(max(squared, squared_back))


@lean
def between(one, solid, T, other, obstacle, beyond, room, hint):  # type: ignore[no-untyped-def]
    """How far two solids are apart [m], below 0 by their radii at most where they meet; no more than `beyond`.

    Args:
        one: `Solids`.
        solid: which of them moves.
        T: that moves it into the frame of the other: rotation row by row, then the translation [m], shape (12,).
        other: `Solids`.
        obstacle: which of them stands still.
        beyond: distances above it do not matter [m].
        room: `Room`; where the distance is less than `beyond`, the last rows of `A` are the nearest points of the lines
            or hulls without their radii.
        hint: in and out, shape (2,): pieces that may be the nearest; -1: not known.

    Returns:
        the distance, up to 1e-10 m proven from below, or `beyond` where it is more than that.
    """
    best = beyond
    a0 = a1 = a2 = b0 = b1 = b2 = 0.0
    pairs, bounds = room.pairs, room.bounds
    pairs[0, 0], pairs[0, 1] = one.root[solid], other.root[obstacle]
    # boxes are those of lines and hulls: about a thick line a box would reach out at its edges
    thick = one.thick[solid] + other.thick[obstacle]
    bounds[0] = _between_boxes(one.boxes, pairs[0, 0], T, other.boxes, pairs[0, 1]) - thick
    if bounds[0] >= beyond:
        return beyond
    if hint[0] >= 0:
        found = _pieces(one, hint[0], T, other, hint[1], best, room)
        if found < best:
            best = found
            a0, a1, a2, b0, b1, b2 = (
                room.A[4, 0], room.A[4, 1], room.A[4, 2], room.A[5, 0], room.A[5, 1], room.A[5, 2],
            )  # fmt: skip
    top = 1
    while top > 0:
        top -= 1
        if bounds[top] >= best:
            continue
        n, m = pairs[top, 0], pairs[top, 1]
        leaf, still = one.links[n, 1] > 0, other.links[m, 1] > 0
        if leaf and still:
            for i in range(one.links[n, 0], one.links[n, 0] + one.links[n, 1]):
                for j in range(other.links[m, 0], other.links[m, 0] + other.links[m, 1]):
                    found = _pieces(one, i, T, other, j, best, room)
                    if found < best:
                        best = found
                        hint[0], hint[1] = i, j
                        a0, a1, a2, b0, b1, b2 = (
                            room.A[4, 0], room.A[4, 1], room.A[4, 2], room.A[5, 0], room.A[5, 1], room.A[5, 2],
                        )  # fmt: skip
            continue
        # the larger of the two is opened
        open_one = still or (not leaf and _size(one.boxes, n) > _size(other.boxes, m))
        child = one.links[n, 0] if open_one else other.links[m, 0]
        n1, m1 = (child, m) if open_one else (n, child)
        n2, m2 = (child + 1, m) if open_one else (n, child + 1)
        first = _between_boxes(one.boxes, n1, T, other.boxes, m1) - thick
        second = _between_boxes(one.boxes, n2, T, other.boxes, m2) - thick
        if first < second:  # the nearer one is opened next
            n1, n2, m1, m2, first, second = n2, n1, m2, m1, second, first
        if first < best:
            pairs[top, 0], pairs[top, 1], bounds[top] = n1, m1, first
            top += 1
        if second < best:
            pairs[top, 0], pairs[top, 1], bounds[top] = n2, m2, second
            top += 1
    room.A[4, 0], room.A[4, 1], room.A[4, 2], room.A[5, 0], room.A[5, 1], room.A[5, 2] = a0, a1, a2, b0, b1, b2
    return best


@lean
def _pieces(one, i, T, other, j, beyond, room):  # type: ignore[no-untyped-def]
    """How far two pieces are apart [m]; any bound that is no less than `beyond` where they are farther."""
    moved, start = room.moved, one.first[i]
    count = one.first[i + 1] - start
    for k in range(count):
        x, y, z = one.points[start + k, 0], one.points[start + k, 1], one.points[start + k, 2]
        for c in range(3):
            moved[k, c] = T[3 * c] * x + T[3 * c + 1] * y + T[3 * c + 2] * z + T[9 + c]
    thick = one.radius[i] + other.radius[j]
    start = other.first[j]
    return (
        apart(
            moved, 0, count, other.points, start, other.first[j + 1] - start, beyond + thick, room.W, room.A, room.share
        )
        - thick
    )


@lean
def _size(boxes, n):  # type: ignore[no-untyped-def]
    return max(boxes[n, 3] - boxes[n, 0], boxes[n, 4] - boxes[n, 1], boxes[n, 5] - boxes[n, 2])
