"""The distance of two convex hulls of a few points each, with a proof: Gilbert, Johnson, Keerthi (1988).

Every direction proves a bound: the hulls are at least as far apart as their extents along it. What comes back is the
best bound of all directions that were tried, so that an error in the search for the nearest points can make the answer
too small, and never too great.
"""

from __future__ import annotations

import numpy as np

from zerorev.kernels._jit import lean

CLOSE_ENOUGH = 1e-10  # [m] between the distance that is found and the one that is proven
MOST_STEPS = 60


@lean
def _of_two(W, i, j, share):  # type: ignore[no-untyped-def]
    """Shares of the point nearest to the origin on the line from i to j; returns its squared distance."""
    d0, d1, d2 = W[j, 0] - W[i, 0], W[j, 1] - W[i, 1], W[j, 2] - W[i, 2]
    square = d0 * d0 + d1 * d1 + d2 * d2
    t = -(W[i, 0] * d0 + W[i, 1] * d1 + W[i, 2] * d2)
    t = 0.0 if t <= 0.0 or square == 0.0 else 1.0 if t >= square else t / square
    share[i], share[j] = 1.0 - t, t
    x, y, z = W[i, 0] + t * d0, W[i, 1] + t * d1, W[i, 2] + t * d2
    return x * x + y * y + z * z


@lean
def _of_three(W, i, j, k, share):  # type: ignore[no-untyped-def]
    """The same of a triangle (Ericson 2005, section 5.1.5)."""
    ab0, ab1, ab2 = W[j, 0] - W[i, 0], W[j, 1] - W[i, 1], W[j, 2] - W[i, 2]
    ac0, ac1, ac2 = W[k, 0] - W[i, 0], W[k, 1] - W[i, 1], W[k, 2] - W[i, 2]
    d1 = -(ab0 * W[i, 0] + ab1 * W[i, 1] + ab2 * W[i, 2])
    d2 = -(ac0 * W[i, 0] + ac1 * W[i, 1] + ac2 * W[i, 2])
    d3 = -(ab0 * W[j, 0] + ab1 * W[j, 1] + ab2 * W[j, 2])
    d4 = -(ac0 * W[j, 0] + ac1 * W[j, 1] + ac2 * W[j, 2])
    d5 = -(ab0 * W[k, 0] + ab1 * W[k, 1] + ab2 * W[k, 2])
    d6 = -(ac0 * W[k, 0] + ac1 * W[k, 1] + ac2 * W[k, 2])
    a, b, c = d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2
    total = a + b + c
    if a > 0.0 and b > 0.0 and c > 0.0 and total > 0.0:
        share[i], share[j], share[k] = a / total, b / total, c / total
        x = share[i] * W[i, 0] + share[j] * W[j, 0] + share[k] * W[k, 0]
        y = share[i] * W[i, 1] + share[j] * W[j, 1] + share[k] * W[k, 1]
        z = share[i] * W[i, 2] + share[j] * W[j, 2] + share[k] * W[k, 2]
        return x * x + y * y + z * z
    best = np.inf
    si = sj = sk = 0.0
    for side in range(3):
        p, q = (i, j) if side == 0 else ((j, k) if side == 1 else (i, k))
        square = _of_two(W, p, q, share)
        if square < best:
            best = square
            si = share[i] if side != 1 else 0.0
            sj = share[j] if side != 2 else 0.0
            sk = share[k] if side != 0 else 0.0
    share[i], share[j], share[k] = si, sj, sk
    return best


@lean
def _of_four(W, share):  # type: ignore[no-untyped-def]
    """The same of a tetrahedron; 0 where the origin is inside."""
    best = np.inf
    s0 = s1 = s2 = s3 = 0.0
    inside = True
    for face in range(4):
        i, j, k, apex = (0, 1, 2, 3) if face == 0 else (
            (0, 1, 3, 2) if face == 1 else ((0, 2, 3, 1) if face == 2 else (1, 2, 3, 0))
        )  # fmt: skip
        u0, u1, u2 = W[j, 0] - W[i, 0], W[j, 1] - W[i, 1], W[j, 2] - W[i, 2]
        v0, v1, v2 = W[k, 0] - W[i, 0], W[k, 1] - W[i, 1], W[k, 2] - W[i, 2]
        n0, n1, n2 = u1 * v2 - u2 * v1, u2 * v0 - u0 * v2, u0 * v1 - u1 * v0
        side = -(n0 * W[i, 0] + n1 * W[i, 1] + n2 * W[i, 2])
        other = n0 * (W[apex, 0] - W[i, 0]) + n1 * (W[apex, 1] - W[i, 1]) + n2 * (W[apex, 2] - W[i, 2])
        if side * other > 0.0:  # the origin lies on the side of the apex
            continue
        inside = False
        square = _of_three(W, i, j, k, share)
        if square < best:
            best = square
            share[apex] = 0.0
            s0, s1, s2, s3 = share[0], share[1], share[2], share[3]
    if inside:
        return 0.0
    share[0], share[1], share[2], share[3] = s0, s1, s2, s3
    return best


@lean
def apart(P, p0, np_, Q, q0, nq, enough, W, A, share):  # type: ignore[no-untyped-def]
    """A proven lower bound of the distance of two hulls [m], up to rounding the distance itself; 0 where they meet.

    Args:
        P: points, shape (N, 3) [m].
        p0: the first point of one hull.
        np_: how many it has.
        Q: points, shape (M, 3), of the same frame.
        q0: the first point of the other.
        nq: how many it has.
        enough: as soon as the hulls are proven to be so far apart the search ends, with any bound above it [m].
        W: room, shape (4, 3).
        A: room, shape (6, 3): after the call the last two rows are the nearest points of the two, where the search
            was not ended before.
        share: room, shape (4,).
    """
    v0, v1, v2 = P[p0, 0] - Q[q0, 0], P[p0, 1] - Q[q0, 1], P[p0, 2] - Q[q0, 2]
    W[0, 0], W[0, 1], W[0, 2] = v0, v1, v2
    for c in range(3):
        A[0, c] = A[4, c] = P[p0, c]
        A[5, c] = Q[q0, c]
    share[0] = 1.0
    n = 1
    proven = 0.0
    for _ in range(MOST_STEPS):
        length = np.sqrt(v0 * v0 + v1 * v1 + v2 * v2)
        if length <= CLOSE_ENOUGH:
            break
        # the point of one hull least far along v, and of the other farthest
        least, i = np.inf, p0
        for k in range(p0, p0 + np_):
            along = P[k, 0] * v0 + P[k, 1] * v1 + P[k, 2] * v2
            if along < least:
                least, i = along, k
        most, j = -np.inf, q0
        for k in range(q0, q0 + nq):
            along = Q[k, 0] * v0 + Q[k, 1] * v1 + Q[k, 2] * v2
            if along > most:
                most, j = along, k
        bound = (least - most) / length
        if bound > proven:
            proven = bound
        if proven >= enough or length - proven <= CLOSE_ENOUGH:
            break
        w0, w1, w2 = P[i, 0] - Q[j, 0], P[i, 1] - Q[j, 1], P[i, 2] - Q[j, 2]
        known = False
        for k in range(n):
            known = known or (W[k, 0] == w0 and W[k, 1] == w1 and W[k, 2] == w2)
        if known:
            break
        W[n, 0], W[n, 1], W[n, 2] = w0, w1, w2
        for c in range(3):
            A[n, c] = P[i, c]
        n += 1
        if n == 2:
            _of_two(W, 0, 1, share)
        elif n == 3:
            _of_three(W, 0, 1, 2, share)
        elif _of_four(W, share) == 0.0:
            return 0.0
        kept = 0
        v0 = v1 = v2 = 0.0
        for c in range(3):
            A[4, c] = 0.0
        for k in range(n):
            if share[k] > 0.0:
                for c in range(3):
                    W[kept, c], A[kept, c] = W[k, c], A[k, c]
                    A[4, c] += share[k] * A[kept, c]
                v0, v1, v2 = v0 + share[k] * W[kept, 0], v1 + share[k] * W[kept, 1], v2 + share[k] * W[kept, 2]
                share[kept] = share[k]
                kept += 1
        n = kept
        A[5, 0], A[5, 1], A[5, 2] = A[4, 0] - v0, A[4, 1] - v1, A[4, 2] - v2
        if n == 4:  # the origin is inside, as far as rounding can tell
            return 0.0
    return proven
