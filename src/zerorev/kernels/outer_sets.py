"""Outer sets of spins: from which spins free legs may get to a depth, rounded outwards (theory §4).

The twist plane is cut into slabs of stand-offs and columns of spins. A *table* lists the cells that legs may pass, slab
by slab, each with the slopes that legs keep in it. A path through a slab moves within a cell by no more than its slopes
allow, and comes into the next column neither before the fastest way across nor after the slowest; so what can leave a
slab, given what enters it, is one interval per cell. Carried outwards from the target these are reachable sets, carried
inwards from a depth viable ones. A cell that is not in both is passed by no leg of that depth.

A table is `start` (K + 1,), where each slab's cells start; `column` (N,), rising within a slab; slopes `lo` and `hi`
(N,) [rad/m]; and `flips` (N,), wrist flips as bits. A *face* between two slabs holds one interval of spins per cell,
from the left edge of its column [rad], as arrays `a` and `b` aligned with the cells of one of the slabs; a > b where it
is empty.
Lengths in m, angles in rad. No kernel raises.
"""

from __future__ import annotations

import numpy as np

from zerorev.kernels._jit import kernel
from zerorev.kernels.outer_cells import EDGE

IN_A, IN_B, OUT_A, OUT_B, LEFT_FIRST, LEFT_LAST, RIGHT_FIRST, RIGHT_LAST, FACES = range(9)
MOST_ROUNDS = 4  # round the circle, before a path is taken to come at any time
SAFE = 1e-12  # relative, kept for the rounding of times and of ways


@kernel
def cross(table, grid, flip, inwards, slab, faces, passed):  # type: ignore[no-untyped-def]
    """Carry sets of spins through a slab.

    Args:
        table: start, column, lo, hi, flips.
        grid: `Grid`.
        flip: 0 or 1: the wrist flip whose cells count.
        inwards: whether from the outer face to the inner one.
        slab: which.
        faces: in and out, shape (FACES, N): what enters in rows IN_A and IN_B; what leaves in OUT_A and OUT_B; the
            others are room.
        passed: out, shape (N,): whether a path may pass the cell.

    Returns:
        whether anything leaves.
    """
    start, lo, hi, flips = table[0], table[2], table[3], table[4]
    first, last, w = start[slab], start[slab + 1], grid.width
    h = (grid.edges[slab + 1] - grid.edges[slab]) * (1.0 + SAFE)
    _sideways(table, grid, flip, inwards, True, first, last, h, faces)
    _sideways(table, grid, flip, inwards, False, first, last, h, faces)
    some = False
    for n in range(first, last):
        passed[n] = False
        faces[OUT_A, n], faces[OUT_B, n] = 1.0, -1.0
        if not (flips[n] >> flip) & 1:
            continue
        least, most = (-hi[n], -lo[n]) if inwards else (lo[n], hi[n])
        a, b = np.inf, -np.inf
        if faces[IN_A, n] <= faces[IN_B, n]:
            passed[n] = True
            a, b = faces[IN_A, n] + h * least, faces[IN_B, n] + h * most
        if faces[LEFT_FIRST, n] <= h and most >= 0.0:
            passed[n] = True
            a = min(a, max(h - faces[LEFT_LAST, n], 0.0) * least if least > 0.0 else 0.0)
            b = max(b, (h - faces[LEFT_FIRST, n]) * most)
        if faces[RIGHT_FIRST, n] <= h and least <= 0.0:
            passed[n] = True
            a = min(a, w + (h - faces[RIGHT_FIRST, n]) * least)
            b = max(b, w + max(h - faces[RIGHT_LAST, n], 0.0) * most if most < 0.0 else w)
        if a <= w + EDGE and b >= -EDGE:
            a, b = a - SAFE * abs(h * least) - EDGE, b + SAFE * abs(h * most) + EDGE
            faces[OUT_A, n], faces[OUT_B, n] = max(min(a, w), 0.0), min(max(b, 0.0), w)
            some = True
    return some


@kernel
def _sideways(table, grid, flip, inwards, rightwards, first, last, h, faces):  # type: ignore[no-untyped-def]
    """When paths come into each cell of a slab from the column beside it: first and last time, as a way along it [m].

    A path that is in a cell in which it must go on the same way never comes back to it; where it need not, it may come
    at any later time.
    """
    column, lo, hi, flips = table[1], table[2], table[3], table[4]
    earliest, latest = (LEFT_FIRST, LEFT_LAST) if rightwards else (RIGHT_FIRST, RIGHT_LAST)
    w, count = grid.width, last - first
    for n in range(first, last):
        faces[earliest, n], faces[latest, n] = np.inf, -np.inf
    changed, rounds = True, 0
    while changed:
        changed = False
        rounds += 1
        for k in range(count):
            n = first + k if rightwards else last - 1 - k
            m = n + 1 if rightwards else n - 1
            if m == last:
                m = first
            elif m < first:
                m = last - 1
            near = _follows(column[n], column[m], grid) if rightwards else _follows(column[m], column[n], grid)
            slow, fast = (lo[n], hi[n]) if rightwards != inwards else (-hi[n], -lo[n])
            if not near or fast <= 0.0 or not (flips[n] >> flip) & 1:
                continue
            early, late = faces[earliest, n] + w / fast, faces[latest, n] + w / slow if slow > 0.0 else np.inf
            if faces[IN_A, n] <= faces[IN_B, n]:
                short, far = w - faces[IN_B, n], w - faces[IN_A, n]
                if not rightwards:
                    short, far = faces[IN_A, n], faces[IN_B, n]
                early, late = min(early, short / fast), max(late, far / slow if slow > 0.0 else np.inf)
            early, late = early * (1.0 - SAFE), min(late * (1.0 + SAFE), h)
            if early > h:
                continue
            if early < faces[earliest, m] or late > faces[latest, m]:
                faces[earliest, m] = min(early, faces[earliest, m])
                faces[latest, m] = h if rounds > MOST_ROUNDS else max(late, faces[latest, m])
                changed = grid.periodic


@kernel
def _follows(left, right, grid):  # type: ignore[no-untyped-def]
    """Whether a column is the next one to the right of another."""
    return right == left + 1 or (grid.periodic and right == 0 and left == grid.columns - 1)


@kernel
def hand_over(source, first, last, a, b, target, begin, end, grid, out_a, out_b):  # type: ignore[no-untyped-def]
    """Sets at a face, aligned with the cells of one slab, for the cells of another: also a spin on an edge of theirs.

    Args:
        source: columns of cells, shape (N,).
        first: of the cells of the face.
        last: the one after them.
        a: shape (N,) [rad].
        b: shape (N,) [rad].
        target: columns of cells, shape (M,).
        begin: of the cells to which it is handed over.
        end: the one after them.
        grid: `Grid`.
        out_a: out, shape (M,) [rad].
        out_b: out, shape (M,) [rad].

    Returns:
        whether there is any.
    """
    for m in range(begin, end):
        out_a[m], out_b[m] = np.inf, -np.inf
    m, some, w = begin, False, grid.width
    for n in range(first, last):
        if a[n] > b[n]:
            continue
        c = source[n]
        while m < end and target[m] < c:
            m += 1
        if m < end and target[m] == c:
            out_a[m], out_b[m] = min(out_a[m], a[n]), max(out_b[m], b[n])
            some = True
        if a[n] <= 0.0:
            k = m - 1 if m > begin else end - 1
            if end > begin and _follows(target[k], c, grid):
                out_a[k], out_b[k] = min(out_a[k], w), w
                some = True
        if b[n] >= w:
            k = m + 1 if m < end and target[m] == c else m
            k = k if k < end else begin
            if end > begin and _follows(c, target[k], grid):
                out_a[k], out_b[k] = 0.0, max(out_b[k], 0.0)
                some = True
    return some


@kernel
def inwards(table, grid, flip, slabs, faces, passed):  # type: ignore[no-untyped-def]
    """Viable sets: carry all spins at a depth in to the target.

    Args:
        table: start, column, lo, hi, flips.
        grid: `Grid`.
        flip: which wrist flip.
        slabs: how many slabs lie within the depth.
        faces: out, shape (FACES, N): of every cell, OUT_A and OUT_B of its inner face, IN_A and IN_B of its outer one.
        passed: out, shape (N,).

    Returns:
        whether a leg may get to the depth.
    """
    start, column = table[0], table[1]
    for k in range(slabs - 1, -1, -1):
        first, last = start[k], start[k + 1]
        if k == slabs - 1:
            for n in range(first, last):
                faces[IN_A, n], faces[IN_B, n] = 0.0, grid.width
        elif not hand_over(
            column, start[k + 1], start[k + 2], faces[OUT_A], faces[OUT_B], column, first, last, grid, faces[IN_A],
            faces[IN_B],
        ):  # fmt: skip
            return False
        if not cross(table, grid, flip, True, k, faces, passed):
            return False
    return slabs > 0


@kernel
def outwards(table, grid, flip, slabs, most_slabs, viable, faces, passed):  # type: ignore[no-untyped-def]
    """Reachable sets: carry spins at the target out, to a depth within its viable sets, then freely.

    Args:
        table: start, column, lo, hi, flips.
        grid: `Grid`.
        flip: which wrist flip.
        slabs: how many slabs lie within the depth.
        most_slabs: where to stop.
        viable: what `inwards` has left for the depth, shape (FACES, N).
        faces: in and out, shape (FACES, N); IN_A and IN_B of the cells of the first slab: where to begin.
        passed: in and out, shape (N,): in, what `inwards` has found; out, whether a leg of the depth may pass a cell.

    Returns:
        how many slabs legs get through, at most.
    """
    start, column = table[0], table[1]
    reached = np.zeros(column.shape[0], dtype=np.bool_)
    through = 0
    for k in range(most_slabs):
        first, last = start[k], start[k + 1]
        if k > 0 and not hand_over(
            column, start[k - 1], first, faces[OUT_A], faces[OUT_B], column, first, last, grid, faces[IN_A], faces[IN_B]
        ):
            break
        if k < slabs:
            for n in range(first, last):
                faces[IN_A, n] = max(faces[IN_A, n], viable[OUT_A, n])
                faces[IN_B, n] = min(faces[IN_B, n], viable[OUT_B, n])
        if not cross(table, grid, flip, False, k, faces, reached):
            break
        if k < slabs:
            for n in range(first, last):
                faces[OUT_A, n] = max(faces[OUT_A, n], viable[IN_A, n])
                faces[OUT_B, n] = min(faces[OUT_B, n], viable[IN_B, n])
                reached[n] = reached[n] and passed[n]
        through = k + 1
    passed[:] = reached
    return through


@kernel
def children(start, column, flips, finer_start, finer_column, finer_flips):  # type: ignore[no-untyped-def]
    """The four quarters of the cells that are left, slab by slab.

    Args:
        start: shape (K + 1,).
        column: shape (N,).
        flips: shape (N,); 0: not left.
        finer_start: out, shape (2 K + 1,).
        finer_column: out, shape (M,), M four times as many as cells are left.
        finer_flips: out, shape (M,).
    """
    m = 0
    for k in range(start.shape[0] - 1):
        for half in range(2):
            finer_start[2 * k + half] = m
            for n in range(start[k], start[k + 1]):
                if flips[n] != 0:
                    for side in range(2):
                        finer_column[m], finer_flips[m] = 2 * column[n] + side, flips[n]
                        m += 1
    finer_start[2 * (start.shape[0] - 1)] = m


@kernel
def compacted(start, column, lo, hi, flips, slab):  # type: ignore[no-untyped-def]
    """Drop the cells that are dead, in place; `slab` is each cell's.

    Returns:
        how many are left.
    """
    left, k = 0, 0
    for n in range(column.shape[0]):
        while k < slab[n]:
            k += 1
            start[k] = left
        if flips[n] != 0:
            column[left], lo[left], hi[left], flips[left] = column[n], lo[n], hi[n], flips[n]
            left += 1
    while k < start.shape[0] - 1:
        k += 1
        start[k] = left
    return left
