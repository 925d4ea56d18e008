"""Small linear programmes with bounds, by the dual simplex method.

    least cost . x   such that   spare + by . x >= 0 in every row   and   low <= x <= high

Every row knows but a few of the unknowns. The method begins at the corner of the box that is cheapest and takes in, one
after the other, the row that is most violated, so that rows which never matter cost no more than a check.
"""

from __future__ import annotations

import numpy as np

from zerorev.kernels._jit import kernel

WIDTH = 5  # unknowns in a row
VIOLATED = 1e-9  # of rows whose greatest coefficient is about 1
SLACK_RATIO = 1e-9  # by which a multiplier may go below nil, so that a larger pivot is available
LEAST_PIVOT = 1e-9

FOUND, CONTRADICTED, GIVEN_UP = range(3)


@kernel
def solve(cost, low, high, at, by, spare, rows, x):  # type: ignore[no-untyped-def]
    """The cheapest point that keeps all rows.

    Args:
        cost: shape (N,).
        low: least value of each unknown, finite, shape (N,).
        high: likewise greatest.
        at: which unknowns a row knows, shape (R, WIDTH); one may stand there twice, with the coefficient 0.
        by: their coefficients, shape (R, WIDTH), the greatest of each row about 1.
        spare: shape (R,).
        rows: how many of the R rows there are.
        x: out, shape (N,).

    Returns:
        whether there is such a point, and it was found.
    """
    size = cost.shape[0]
    return (
        weighed(cost, low, high, at, by, spare, rows, x, np.empty(size + 1, dtype=np.int64), np.empty(size + 1))
        == FOUND
    )


@kernel
def weighed(cost, low, high, at, by, spare, rows, x, held, worth):  # type: ignore[no-untyped-def]
    """The cheapest point that keeps all rows, and what each of the rows that meet there is worth.

    Args:
        cost: see `solve`, as all up to `x`.
        low: likewise.
        high: likewise.
        at: likewise.
        by: likewise.
        spare: likewise.
        rows: likewise.
        x: likewise.
        held: out, which rows meet, shape (N + 1,); numbers from `rows` on are bounds, `low` before `high`; -1: none.
        worth: out, their multipliers, none negative, shape (N + 1,): the sum of multiplier times row has the gradient
            of the cost; or, where there is no point, none at all, and is negative in the whole box.

    Returns:
        FOUND; CONTRADICTED: no point keeps all rows; GIVEN_UP.
    """
    size = cost.shape[0]
    # the columns of `edges` are the ways out of the present corner, one for each of the rows that meet there
    edges, part = np.zeros((size, size)), np.empty(size)
    held[size], worth[size] = -1, 0.0
    for i in range(size):
        held[i] = rows + i if cost[i] >= 0.0 else rows + size + i
        edges[i, i] = 1.0 if cost[i] >= 0.0 else -1.0
        x[i] = low[i] if cost[i] >= 0.0 else high[i]
        worth[i] = abs(cost[i])
    for _ in range(20 * size + 200):
        worst, row = -VIOLATED, -1
        for r in range(rows):
            value = spare[r]
            for j in range(WIDTH):
                value += by[r, j] * x[at[r, j]]
            if value < worst:
                worst, row = value, r
        for i in range(size):
            if x[i] - low[i] < worst:
                worst, row = x[i] - low[i], rows + i
            if high[i] - x[i] < worst:
                worst, row = high[i] - x[i], rows + size + i
        if row < 0:
            return FOUND
        if row < rows:
            part[:] = 0.0
            for j in range(WIDTH):
                for k in range(size):
                    part[k] += by[row, j] * edges[at[row, j], k]
        elif row < rows + size:
            part[:] = edges[row - rows]
        else:
            part[:] = -edges[row - rows - size]
        leaves = _leaving(worth, part)
        if leaves < 0:
            held[size], worth[size] = row, 1.0
            for k in range(size):
                worth[k] = max(-part[k], 0.0)
            return CONTRADICTED
        _turn(x, edges, worth, part, leaves, worst)
        held[leaves] = row
    return GIVEN_UP


@kernel
def _leaving(worth, part):  # type: ignore[no-untyped-def]
    """Which row makes way: no multiplier may become negative, and of those that tie the largest pivot is the safest."""
    ratio = np.inf
    for k in range(part.shape[0]):
        if part[k] > LEAST_PIVOT:
            ratio = min(ratio, (worth[k] + SLACK_RATIO) / part[k])
    leaves, pivot = -1, LEAST_PIVOT
    for k in range(part.shape[0]):
        if part[k] > pivot and worth[k] <= ratio * part[k]:
            leaves, pivot = k, part[k]
    return leaves


@kernel
def _turn(x, edges, worth, part, leaves, lacks):  # type: ignore[no-untyped-def]
    """Go along an edge to where the new row is kept, and turn the other edges into it."""
    size = part.shape[0]
    share = worth[leaves] / part[leaves]
    for k in range(size):
        worth[k] = max(worth[k] - share * part[k], 0.0)
    worth[leaves] = share
    for i in range(size):
        along = edges[i, leaves] / part[leaves]
        x[i] -= along * lacks
        if along != 0.0:
            for k in range(size):
                edges[i, k] -= along * part[k]
        edges[i, leaves] = along
