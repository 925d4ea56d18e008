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

Next to the elbow's singularity, at the edge of reach, the conditions on slopes leave a path along the edge that no arm
can follow. There, in the *zone*, the angles are enclosed as well: no joint turns back, so none may come below the least
angle that it had on the way. `zone` (N,) numbers the cells of the zone, -1 elsewhere; `swing` (Z, 6, 2) has the least
and the greatest angle of each joint, counted the way it turns as the leg is run outwards, up to whole turns; `behind`
(Z + 1, 6) is room for the angle that no path into a cell is behind.

Lengths in m, angles in rad. No kernel raises.
"""

from __future__ import annotations

import numpy as np

from zerorev.kernels._jit import kernel
from zerorev.kernels.bound_boxes import PAD
from zerorev.kernels.outer_cells import EDGE

IN_A, IN_B, OUT_A, OUT_B, LEFT_FIRST, LEFT_LAST, RIGHT_FIRST, RIGHT_LAST, FACES = range(9)
MOST_ROUNDS = 4  # round the circle, before a path is taken to come at any time
NARROW = 0.5 * np.pi  # [rad] of an angle in a cell that says something
TURN = 2.0 * np.pi
SAFE = 1e-12  # relative, kept for the rounding of times and of ways


@kernel
def _enter(table, inwards, source, target):  # type: ignore[no-untyped-def]
    """Note that a path comes from one cell into another, unless a joint would have to turn back for it.

    Args:
        table: see the module.
        inwards: whether paths are followed inwards, and joints backwards.
        source: number of the cell that it comes from; below 0: from where nothing is known.
        target: number of the cell that it comes into.

    Returns:
        0 where it cannot, 2 where it is further behind than all others before, else 1.
    """
    zone, swing, behind = table[5], table[6], table[7]
    z = zone[target]
    if z < 0:
        return 1
    y = zone[source] if source >= 0 else -1
    lowest = behind[behind.shape[0] - 1]
    for i in range(6):
        lowest[i] = -np.inf
        low, high = (-swing[z, i, 1], -swing[z, i, 0]) if inwards else (swing[z, i, 0], swing[z, i, 1])
        if y < 0 or not high - low < NARROW:
            continue
        least, most = (-swing[y, i, 1], -swing[y, i, 0]) if inwards else (swing[y, i, 0], swing[y, i, 1])
        if not most - least < NARROW:
            continue
        # where the two cells touch their angles agree, up to whole turns
        turns = np.rint(0.5 * (low + high - least - most) / TURN)
        lowest[i] = max(behind[y, i], least) + TURN * turns
        if lowest[i] > high + PAD:
            return 0
    lower = False
    for i in range(6):
        if lowest[i] < behind[z, i]:
            behind[z, i], lower = lowest[i], True
    return 2 if lower else 1


@kernel
def cross(table, grid, flip, inwards, slab, faces, passed):  # type: ignore[no-untyped-def]
    """Carry sets of spins through a slab.

    Args:
        table: see the module.
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
            entered = _enter(table, inwards, n if rounds <= MOST_ROUNDS else -1, m)
            if entered > 0 and (early < faces[earliest, m] or late > faces[latest, m] or entered == 2):
                faces[earliest, m] = min(early, faces[earliest, m])
                faces[latest, m] = h if rounds > MOST_ROUNDS else max(late, faces[latest, m])
                changed = grid.periodic


@kernel
def _follows(left, right, grid):  # type: ignore[no-untyped-def]
    """Whether a column is the next one to the right of another."""
    return right == left + 1 or (grid.periodic and right == 0 and left == grid.columns - 1)


@kernel
def meet(source, first, last, a, b, target, begin, end, grid, out_a, out_b):  # type: ignore[no-untyped-def]
    """Sets at the target, aligned with the cells of one leg, for those of another: also a spin on an edge of theirs.

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
    """
    for m in range(begin, end):
        out_a[m], out_b[m] = np.inf, -np.inf
    m, w = begin, grid.width
    for n in range(first, last):
        while m < end and target[m] < source[n]:
            m += 1
        if a[n] <= b[n]:
            left, here, right = _beside(source[n], target, m, begin, end, grid)
            if here >= 0:
                out_a[here], out_b[here] = min(out_a[here], a[n]), max(out_b[here], b[n])
            if left >= 0 and a[n] <= 0.0:
                out_a[left], out_b[left] = min(out_a[left], w), w
            if right >= 0 and b[n] >= w:
                out_a[right], out_b[right] = 0.0, max(out_b[right], 0.0)


@kernel
def _beside(c, target, m, begin, end, grid):  # type: ignore[no-untyped-def]
    """Cells of a slab left of a column, in it, right of it, or -1; `m` is the first that is not left of it."""
    here = m if m < end and target[m] == c else -1
    if begin == end:
        return -1, -1, -1
    left = m - 1 if m > begin else end - 1
    right = m + 1 if here >= 0 else m
    right = right if right < end else begin
    return (
        left if _follows(target[left], c, grid) else -1,
        here,
        right if _follows(c, target[right], grid) else -1,
    )


@kernel
def _hand_over(table, grid, inwards, slab, into, faces):  # type: ignore[no-untyped-def]
    """What leaves one slab enters the next, also on an edge of its cells; whether anything does."""
    start, column = table[0], table[1]
    begin, end, w = start[into], start[into + 1], grid.width
    for m in range(begin, end):
        faces[IN_A, m], faces[IN_B, m] = np.inf, -np.inf
    m, some = begin, False
    for n in range(start[slab], start[slab + 1]):
        while m < end and column[m] < column[n]:
            m += 1
        a, b = faces[OUT_A, n], faces[OUT_B, n]
        if a > b:
            continue
        left, here, right = _beside(column[n], column, m, begin, end, grid)
        if here >= 0 and _enter(table, inwards, n, here) > 0:
            faces[IN_A, here], faces[IN_B, here] = min(faces[IN_A, here], a), max(faces[IN_B, here], b)
            some = True
        if left >= 0 and a <= 0.0 and _enter(table, inwards, n, left) > 0:
            faces[IN_A, left], faces[IN_B, left] = min(faces[IN_A, left], w), w
            some = True
        if right >= 0 and b >= w and _enter(table, inwards, n, right) > 0:
            faces[IN_A, right], faces[IN_B, right] = 0.0, max(faces[IN_B, right], 0.0)
            some = True
    return some


@kernel
def _begin(table, first, last):  # type: ignore[no-untyped-def]
    """Before paths set out from some cells: of none is it known what it is behind."""
    zone, behind = table[5], table[7]
    behind[:] = np.inf
    for n in range(first, last):
        if zone[n] >= 0:
            behind[zone[n]] = -np.inf


@kernel
def inwards(table, grid, flip, slabs, faces, passed):  # type: ignore[no-untyped-def]
    """Viable sets: carry all spins at a depth in to the target.

    Args:
        table: see the module.
        grid: `Grid`.
        flip: which wrist flip.
        slabs: how many slabs lie within the depth.
        faces: out, shape (FACES, N): of every cell, OUT_A and OUT_B of its inner face, IN_A and IN_B of its outer one.
        passed: out, shape (N,).

    Returns:
        whether a leg may get to the depth.
    """
    start = table[0]
    _begin(table, start[slabs - 1], start[slabs])
    for n in range(start[slabs - 1], start[slabs]):
        faces[IN_A, n], faces[IN_B, n] = 0.0, grid.width
    for k in range(slabs - 1, -1, -1):
        if k < slabs - 1 and not _hand_over(table, grid, True, k + 1, k, faces):
            return False
        if not cross(table, grid, flip, True, k, faces, passed):
            return False
    return slabs > 0


@kernel
def outwards(table, grid, flip, slabs, most_slabs, viable, faces, passed):  # type: ignore[no-untyped-def]
    """Reachable sets: carry spins at the target out, to a depth within its viable sets, then freely.

    Args:
        table: see the module.
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
    start = table[0]
    reached = np.zeros(passed.shape[0], dtype=np.bool_)
    through = 0
    _begin(table, start[0], start[1])
    for k in range(most_slabs):
        first, last = start[k], start[k + 1]
        if k > 0 and not _hand_over(table, grid, False, k - 1, k, faces):
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
