"""The check's own distances between solids, compiled: features against features, pruned by spheres.

Every solid is a heap of triangles and lines, with a thickness: of two triangles that do not cross each other the
nearest points lie on two edges, or on a corner and a face (Ericson 2005, section 5.1). Pieces that lie together are
grouped, and groups once more, each within a sphere. What is not a mesh is taken for its surface, too.

Nothing here comes from the kernels of the search but the decorator that compiles, and all is in this file, so that a
change to it compiles it again.
"""

from __future__ import annotations

import numpy as np

from zerorev.kernels._jit import kernel

__all__ = ["held", "least_of_samples", "nearest"]

POINTS = 8  # that span a body
DEEP = 128


@kernel
def _dot(a0, a1, a2, b0, b1, b2):  # type: ignore[no-untyped-def]
    return a0 * b0 + a1 * b1 + a2 * b2


@kernel
def _lines(P, i, j, Q, k, m):  # type: ignore[no-untyped-def]
    """Squared distance of the line from P[i] to P[j] and that from Q[k] to Q[m]."""
    u0, u1, u2 = P[j, 0] - P[i, 0], P[j, 1] - P[i, 1], P[j, 2] - P[i, 2]
    v0, v1, v2 = Q[m, 0] - Q[k, 0], Q[m, 1] - Q[k, 1], Q[m, 2] - Q[k, 2]
    w0, w1, w2 = P[i, 0] - Q[k, 0], P[i, 1] - Q[k, 1], P[i, 2] - Q[k, 2]
    uu, vv, uv = _dot(u0, u1, u2, u0, u1, u2), _dot(v0, v1, v2, v0, v1, v2), _dot(u0, u1, u2, v0, v1, v2)
    uw, vw = _dot(u0, u1, u2, w0, w1, w2), _dot(v0, v1, v2, w0, w1, w2)
    s = t = 0.0
    if uu > 0.0 and vv > 0.0:
        det = uu * vv - uv * uv
        s = min(max((uv * vw - uw * vv) / det, 0.0), 1.0) if det > 1e-14 * uu * vv else 0.0
        t = (uv * s + vw) / vv
        if t < 0.0:
            t, s = 0.0, min(max(-uw / uu, 0.0), 1.0)
        elif t > 1.0:
            t, s = 1.0, min(max((uv - uw) / uu, 0.0), 1.0)
    elif uu > 0.0:
        s = min(max(-uw / uu, 0.0), 1.0)
    elif vv > 0.0:
        t = min(max(vw / vv, 0.0), 1.0)
    x, y, z = w0 + s * u0 - t * v0, w1 + s * u1 - t * v1, w2 + s * u2 - t * v2
    return _dot(x, y, z, x, y, z)


@kernel
def _face(P, i, Q, crossed_by):  # type: ignore[no-untyped-def]
    """Squared distance of the corner P[i] from the face Q, inf where its foot lies beside it.

    It is 0 where the line from there to P[crossed_by] goes through the face.
    """
    u0, u1, u2 = Q[1, 0] - Q[0, 0], Q[1, 1] - Q[0, 1], Q[1, 2] - Q[0, 2]
    v0, v1, v2 = Q[2, 0] - Q[0, 0], Q[2, 1] - Q[0, 1], Q[2, 2] - Q[0, 2]
    n0, n1, n2 = u1 * v2 - u2 * v1, u2 * v0 - u0 * v2, u0 * v1 - u1 * v0
    nn = _dot(n0, n1, n2, n0, n1, n2)
    if nn == 0.0:
        return np.inf
    w0, w1, w2 = P[i, 0] - Q[0, 0], P[i, 1] - Q[0, 1], P[i, 2] - Q[0, 2]
    height = _dot(n0, n1, n2, w0, w1, w2)
    best = np.inf
    for look in range(2):
        x, y, z = w0, w1, w2
        if look == 1:
            e0, e1, e2 = P[crossed_by, 0] - P[i, 0], P[crossed_by, 1] - P[i, 1], P[crossed_by, 2] - P[i, 2]
            other = height + _dot(n0, n1, n2, e0, e1, e2)
            if height * other > 0.0 or height == other:
                break
            share = height / (height - other)
            x, y, z = w0 + share * e0, w1 + share * e1, w2 + share * e2
        a = _dot(u1 * z - u2 * y, u2 * x - u0 * z, u0 * y - u1 * x, n0, n1, n2)
        b = _dot(y * v2 - z * v1, z * v0 - x * v2, x * v1 - y * v0, n0, n1, n2)
        if a >= 0.0 and b >= 0.0 and a + b <= nn:
            best = min(best, 0.0 if look == 1 else height * height / nn)
    return best


@kernel
def _pieces(P, p, Q, q):  # type: ignore[no-untyped-def]
    """Distance of two pieces of p and q corners, 2 or 3."""
    best = np.inf
    for i in range(p if p == 3 else 1):
        for k in range(q if q == 3 else 1):
            best = min(best, _lines(P, i, (i + 1) % p, Q, k, (k + 1) % q))
    if q == 3:
        for i in range(p):
            best = min(best, _face(P, i, Q, (i + 1) % p))
    if p == 3:
        for k in range(q):
            best = min(best, _face(Q, k, P, (k + 1) % q))
    return np.sqrt(best)


@kernel
def _to_line(S, line):  # type: ignore[no-untyped-def]
    """Distance of the middle of a sphere from a line, given by its two ends, shape (6,)."""
    d0, d1, d2 = line[3] - line[0], line[4] - line[1], line[5] - line[2]
    w0, w1, w2 = S[0] - line[0], S[1] - line[1], S[2] - line[2]
    square = _dot(d0, d1, d2, d0, d1, d2)
    t = min(max(_dot(w0, w1, w2, d0, d1, d2) / square, 0.0), 1.0) if square > 0.0 else 0.0
    x, y, z = w0 - t * d0, w1 - t * d1, w2 - t * d2
    return np.sqrt(_dot(x, y, z, x, y, z))


@kernel
def _moved(T, x, y, z, c):  # type: ignore[no-untyped-def]
    return T[3 * c] * x + T[3 * c + 1] * y + T[3 * c + 2] * z + T[9 + c]


@kernel
def nearest(heap, one, T, other, beyond):  # type: ignore[no-untyped-def]
    """Distance of two solids, or `beyond` where it is more.

    Args:
        heap: `verify.heaps.Heap`.
        one: number of the solid that is moved.
        T: by this, into the frame of the other: rotation row by row, then the place [m], shape (12,).
        other: number of the other.
        beyond: distances above it do not matter [m].
    """
    best, line, P, Q = beyond, np.empty(6), np.empty((3, 3)), np.empty((3, 3))
    thick = heap.thick[one] + heap.thick[other]
    for g in range(heap.groups[one], heap.groups[one + 1]):
        for end in range(2):
            x, y, z = heap.axes[g, 3 * end], heap.axes[g, 3 * end + 1], heap.axes[g, 3 * end + 2]
            for c in range(3):
                line[3 * end + c] = _moved(T, x, y, z, c)
        own = heap.wide[g] + thick
        for s in range(heap.supers[other], heap.supers[other + 1]):
            S = heap.balls[s]
            if _to_line(S, line) - S[3] - own >= best:
                continue
            for h in range(heap.members[s], heap.members[s + 1]):
                B = heap.spheres[h]
                if _to_line(B, line) - B[3] - own >= best:
                    continue
                for i in range(heap.starts[g], heap.starts[g + 1]):
                    for k in range(3):
                        for c in range(3):
                            P[k, c] = _moved(T, heap.corners[i, k, 0], heap.corners[i, k, 1], heap.corners[i, k, 2], c)
                    for j in range(heap.starts[h], heap.starts[h + 1]):
                        for k in range(3):
                            for c in range(3):
                                Q[k, c] = heap.corners[j, k, c]
                        best = min(best, _pieces(P, heap.sides[i], Q, heap.sides[j]) - thick)
    return best


@kernel
def _frames(chain, q, F):  # type: ignore[no-untyped-def]
    """Frames of base and links at model angles: each joint's place, then its turn, one after the other.

    Args:
        chain: place of each joint [m], and whether it turns about y (1) or z (2), shape (6, 4).
        q: model angles [rad], shape (6,).
        F: out, shape (7, 12).
    """
    for i in range(12):
        F[0, i] = 1.0 if i in (0, 4, 8) else 0.0
    for n in range(6):
        A, B = F[n], F[n + 1]
        c, s = np.cos(q[n]), np.sin(q[n])
        about_y = chain[n, 3] == 1.0
        for i in range(3):
            x, y, z = A[3 * i], A[3 * i + 1], A[3 * i + 2]
            B[9 + i] = A[9 + i] + x * chain[n, 0] + y * chain[n, 1] + z * chain[n, 2]
            if about_y:
                B[3 * i], B[3 * i + 1], B[3 * i + 2] = c * x - s * z, y, s * x + c * z
            else:
                B[3 * i], B[3 * i + 1], B[3 * i + 2] = c * x + s * y, c * y - s * x, z


@kernel
def _between(F, solids, one, other, T):  # type: ignore[no-untyped-def]
    """The frame of one solid in that of another."""
    A, B = np.empty(12), np.empty(12)
    for which in range(2):
        k = one if which == 0 else other
        L, own, out = F[solids.link[k]], solids.frames[k], A if which == 0 else B
        for i in range(3):
            for j in range(3):
                out[3 * i + j] = L[3 * i] * own[j] + L[3 * i + 1] * own[3 + j] + L[3 * i + 2] * own[6 + j]
            out[9 + i] = L[9 + i] + L[3 * i] * own[9] + L[3 * i + 1] * own[10] + L[3 * i + 2] * own[11]
    for i in range(3):
        T[9 + i] = 0.0
        for j in range(3):
            T[3 * i + j] = B[i] * A[j] + B[3 + i] * A[3 + j] + B[6 + i] * A[6 + j]
            T[9 + i] += B[3 * j + i] * (A[9 + j] - B[9 + j])


@kernel
def _model(solids, joints, q):  # type: ignore[no-untyped-def]
    for i in range(6):
        q[i] = solids.sign[i] * joints[i] - solids.offset[i]


@kernel
def least_of_samples(solids, heap, joints, wanted, best):  # type: ignore[no-untyped-def]
    """The least distance of pairs at samples.

    Args:
        solids: `verify.scene.Solids`.
        heap: `verify.heaps.Heap`.
        joints: controller angles [rad], shape (N, 6).
        wanted: which pairs count, shape (K,).
        best: distances above it do not matter [m].

    Returns:
        the distance, the sample, the pair; the latter -1 where none is less than `best`.
    """
    F, q, T = np.empty((7, 12)), np.empty(6), np.empty(12)
    sample, pair = -1, -1
    for n in range(joints.shape[0]):
        _model(solids, joints[n], q)
        _frames(solids.chain, q, F)
        for k in range(solids.pairs.shape[0]):
            if wanted[k]:
                _between(F, solids, solids.pairs[k, 0], solids.pairs[k, 1], T)
                found = nearest(heap, solids.pairs[k, 0], T, solids.pairs[k, 1], best)
                if found < best:
                    best, sample, pair = found, n, k
    return best, sample, pair


@kernel
def held(solids, heap, joints, standoff, psi, bend, wanted, least):  # type: ignore[no-untyped-def]
    """Whether pairs of solids are proven to keep distances on the whole of a motion.

    A part of the motion is judged from the sample in its middle. No joint is farther from there than at a sample of the
    part, but for how much it bends between two samples; a point of a link moves by no more than the sum of these angles
    times its distances from the axes, and the wrist and what lies beyond it by what the tip moves along the drill axis
    and turns about it. Where that does not do, the part is halved.

    Args:
        solids: `verify.scene.Solids`.
        heap: `verify.heaps.Heap`.
        joints: controller angles [rad], shape (N, 6); of two samples the joints between are in proportion.
        standoff: [m], shape (N,); of no size: the motion is not one along a drill axis.
        psi: [rad], shape (N,), likewise.
        bend: how far joints may lie off the line between two samples [rad], shape (6,).
        wanted: which pairs are held apart, shape (K,).
        least: how far [m], shape (K,).

    Returns:
        the pair that is not proven to keep its distance, or -1; and the share of the motion where that is.
    """
    straight, drilled = joints.shape[0] == 2, standoff.shape[0] > 0
    last = 1.0 if straight else joints.shape[0] - 1.0
    F, q, T, turn, at = np.empty((7, 12)), np.empty(6), np.empty(12), np.empty(6), np.empty(6)
    pairs = solids.pairs.shape[0]
    ends, open_ = np.empty((DEEP, 2)), np.empty((DEEP, pairs), dtype=np.bool_)
    ends[0, 0], ends[0, 1] = 0.0, last
    for k in range(pairs):
        open_[0, k] = wanted[k]
    top = 1
    while top > 0:
        top -= 1
        a, b = ends[top, 0], ends[top, 1]
        m = 0.5 * (a + b) if straight else np.floor(0.5 * (a + b))
        moved = turned = 0.0
        if straight:
            for i in range(6):
                at[i] = joints[0, i] + m * (joints[1, i] - joints[0, i])
                turn[i] = 0.5 * (b - a) * abs(joints[1, i] - joints[0, i])
        else:
            middle = int(m)
            for i in range(6):
                at[i], turn[i] = joints[middle, i], 0.0
            for n in range(int(a), int(b) + 1):
                for i in range(6):
                    turn[i] = max(turn[i], abs(joints[n, i] - at[i]))
                if drilled:
                    moved = max(moved, abs(standoff[n] - standoff[middle]))
                    turned = max(turned, abs(psi[n] - psi[middle]))
            for i in range(6):
                turn[i] += bend[i]
        _model(solids, at, q)
        _frames(solids.chain, q, F)
        left = -1
        for k in range(pairs):
            if not open_[top, k]:
                continue
            one, other = solids.pairs[k, 0], solids.pairs[k, 1]
            need = least[k] + _displaced(solids, one, solids.link[other], turn, drilled, moved, turned) + 1e-9
            _between(F, solids, one, other, T)
            if nearest(heap, one, T, other, need) >= need:
                open_[top, k] = False
            else:
                left = k
        if left >= 0:
            if (straight and b - a < 1e-7) or (not straight and b - a <= 1.0) or top + 2 > DEEP:
                return left, m / last
            ends[top, 0], ends[top, 1] = m, b
            ends[top + 1, 0], ends[top + 1, 1] = a, m
            for k in range(pairs):
                open_[top + 1, k] = open_[top, k]
            top += 2
    return -1, 0.0


@kernel
def _displaced(solids, one, inner, turn, drilled, moved, turned):  # type: ignore[no-untyped-def]
    """How far a solid moves against one of an inner link at most [m]."""
    link = solids.link[one]
    by_plane = drilled and inner == 0
    if by_plane and link == 6:
        return moved + solids.lever[one] * turned
    turns = 0.0
    for i in range(inner, link):
        turns += turn[i]
    most = 0.0
    for p in range(POINTS):
        way = 0.0
        for i in range(inner, link):
            way += solids.arms[one, p, i] * turn[i]
        if by_plane and link >= 3:
            way = min(way, moved + solids.offset_w * turned + solids.from_wrist[one, p] * min(turns, 2.0))
        most = max(most, way)
    return most
