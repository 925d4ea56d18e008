"""How near the bodies of an arm come to what stands around it, and to each other, on whole pieces of a motion.

A piece is judged from its middle. On a piece on which no joint turns round, each joint is farthest from where it is in
the middle at one of the two ends. So a point moves from there by at most the sum over the joints of that angle times
its greatest distance from the axis: one joint changed after the other, from the tip inwards. The wrist and what lies
beyond it are known from the twist plane itself. A hull moves no farther than the points that span it. So a piece keeps
a distance where its middle keeps that much more; else it is halved.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from zerorev.kernels._jit import kernel, lean
from zerorev.kernels.arm import solve_at
from zerorev.kernels.solids import Room, Solids, between

__all__ = [
    "FREE",
    "HIT",
    "SPANNED",
    "UNDECIDED",
    "Arms",
    "Desk",
    "apart_at",
    "desk",
    "keeps",
    "legs_keep",
    "nearest",
    "pose_of",
    "poses_apart",
    "poses_keep",
]

Array = npt.NDArray[np.float64]
Whole = npt.NDArray[np.int64]

FREE, HIT, UNDECIDED = 0, 1, 2
SPANNED = 8  # points that span a body, at most
DEEP = 48  # pieces that wait, at most
SHORTEST = 1e-9  # of a piece: what is not decided then stays so
ROUNDING = 1e-9  # [m] more than the arithmetic of a pose can be off
WIDE = 2.0  # [rad] half a piece may turn a joint by no more, so that a full turn is not taken for none
FIRST = 2  # pieces to begin with
MOST_OF_A_LEG = 1_000  # pieces, while legs are searched for: some 10 um are then kept to an obstacle along 10 mm


class Arms(NamedTuple):
    """The bodies of an arm with a tool, what stands around, and which of them are held apart.

    Attributes:
        solids: of bodies and obstacles.
        link: with which each moves, 0 to 6, shape (S,).
        frames: of each in that of its link: rotation row by row, then the place [m], shape (S, 12).
        pairs: numbers of solids, the one of the lower link behind the other, shape (K, 2).
        least: what each pair keeps [m], shape (K,).
        reach: greatest distance of the points that span a body from each axis [m], shape (S, SPANNED, 6).
        around: their distance from the wrist centre [m], shape (S, SPANNED).
        lever: greatest distance of a body of link 6 from the drill axis, and of the wrist centre [m], shape (S,).
    """

    solids: Solids
    link: Whole
    frames: Array
    pairs: Whole
    least: Array
    reach: Array
    around: Array
    lever: Array


class Desk(NamedTuple):
    """Where pieces wait and poses are computed.

    Attributes:
        room: of a distance.
        ends: of the pieces that wait: two shares, shape (DEEP, 2).
        turned: the joints at both, shape (DEEP, 2, 6).
        open: which pairs are not decided yet on each, shape (DEEP, K).
        hints: pieces of solids that were nearest, shape (K, 2).
        links: frames of the links, shape (7, 12).
        placed: frames of the solids, shape (S, 12).
        known: whether they are computed for this pose, shape (S,).
        T: one in the frame of another, shape (12,).
        cs: cosines and sines of the joints, shape (6, 2).
        q: joints in the middle [rad], shape (6,).
        turn: how far the joints may be from there [rad], shape (6,).
    """

    room: Room
    ends: Array
    turned: Array
    open: npt.NDArray[np.bool_]
    hints: Whole
    links: Array
    placed: Array
    known: npt.NDArray[np.bool_]
    T: Array
    cs: Array
    q: Array
    turn: Array


def desk(arms: Arms, room: Room) -> Desk:
    """Room for the motions of some bodies, one at a time.

    Args:
        arms: the bodies.
        room: of a distance.
    """
    pairs, count = len(arms.pairs), len(arms.link)
    return Desk(
        room, np.empty((DEEP, 2)), np.empty((DEEP, 2, 6)), np.empty((DEEP, pairs), dtype=np.bool_),
        np.full((pairs, 2), -1), np.zeros((7, 12)), np.empty((count, 12)), np.empty(count, dtype=np.bool_),
        np.empty(12), np.empty((6, 2)), np.empty(6), np.empty(6),
    )  # fmt: skip


@lean
def _turned_z(A, c, s, out):  # type: ignore[no-untyped-def]
    """Columns of a rotation A, shape (12,), turned by a further angle about its z axis."""
    for i in range(3):
        x, y = A[3 * i], A[3 * i + 1]
        out[3 * i], out[3 * i + 1], out[3 * i + 2] = c * x + s * y, c * y - s * x, A[3 * i + 2]


@lean
def _turned_y(A, c, s, out):  # type: ignore[no-untyped-def]
    """The same about its y axis."""
    for i in range(3):
        x, z = A[3 * i], A[3 * i + 2]
        out[3 * i], out[3 * i + 1], out[3 * i + 2] = c * x - s * z, A[3 * i + 1], c * z + s * x


@lean
def _shifted(A, x, y, z, out):  # type: ignore[no-untyped-def]
    """The place of a frame out at (x, y, z) of a frame A."""
    for i in range(3):
        out[9 + i] = A[9 + i] + A[3 * i] * x + A[3 * i + 1] * y + A[3 * i + 2] * z


@lean
def link_frames(arm, cs, F):  # type: ignore[no-untyped-def]
    """Frames of base and links, shape (7, 12), as `motion.links` has them, of cosines and sines of the model angles."""
    for i in range(12):
        F[0, i] = 0.0
    F[0, 0] = F[0, 4] = F[0, 8] = 1.0
    _turned_z(F[0], cs[0, 0], cs[0, 1], F[1])
    F[1, 9] = F[1, 10] = F[1, 11] = 0.0
    _shifted(F[1], arm.a1, arm.b, arm.c1, F[2])
    _turned_y(F[1], cs[1, 0], cs[1, 1], F[2])
    _shifted(F[2], 0.0, 0.0, arm.c2, F[3])
    _turned_y(F[2], cs[2, 0], cs[2, 1], F[3])
    _shifted(F[3], arm.a2, 0.0, arm.c3, F[4])
    _turned_z(F[3], cs[3, 0], cs[3, 1], F[4])
    F[5, 9], F[5, 10], F[5, 11] = F[4, 9], F[4, 10], F[4, 11]
    _turned_y(F[4], cs[4, 0], cs[4, 1], F[5])
    _shifted(F[5], 0.0, 0.0, arm.c4, F[6])
    _turned_z(F[5], cs[5, 0], cs[5, 1], F[6])


@lean
def pose_of(arm, plane, branch, path, share, desk):  # type: ignore[no-untyped-def]
    """Joints and frames at a share of a path.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        branch: 0..7 of a path through the twist plane; -1: all axes move in proportion.
        path: its two ends, shape (2, 8): stand-off [m], spin [rad], controller angles [rad].
        share: 0 to 1.
        desk: `Desk`; out: q, links.

    Returns:
        whether it is in reach.
    """
    cs, q = desk.cs, desk.q
    for i in range(desk.known.shape[0]):
        desk.known[i] = False
    if branch < 0:
        for i in range(6):
            q[i] = path[0, 2 + i] + share * (path[1, 2 + i] - path[0, 2 + i])
            model = q[i] * arm.sign[i] - arm.offset[i]
            cs[i, 0], cs[i, 1] = np.cos(model), np.sin(model)
    else:
        standoff = path[0, 0] + share * (path[1, 0] - path[0, 0])
        psi = path[0, 1] + share * (path[1, 1] - path[0, 1])
        if not solve_at(arm, plane, standoff, psi, branch // 2, cs)[0]:
            return False
        if (branch % 2 == 1) == (arm.sign[4] > 0.0):  # the other wrist flip
            cs[3, 0], cs[3, 1], cs[4, 1] = -cs[3, 0], -cs[3, 1], -cs[4, 1]
            cs[5, 0], cs[5, 1] = -cs[5, 0], -cs[5, 1]
        for i in range(6):
            q[i] = np.arctan2(cs[i, 1], cs[i, 0])
    link_frames(arm, cs, desk.links)
    return True


@lean
def _place(arms, k, desk):  # type: ignore[no-untyped-def]
    """The frame of a solid in the base frame."""
    if desk.known[k]:
        return
    L, F, out = desk.links[arms.link[k]], arms.frames[k], desk.placed[k]
    for i in range(3):
        for j in range(3):
            out[3 * i + j] = L[3 * i] * F[j] + L[3 * i + 1] * F[3 + j] + L[3 * i + 2] * F[6 + j]
        out[9 + i] = L[9 + i] + L[3 * i] * F[9] + L[3 * i + 1] * F[10] + L[3 * i + 2] * F[11]
    desk.known[k] = True


@lean
def apart_at(arms, pair, beyond, desk):  # type: ignore[no-untyped-def]
    """How far a pair is apart at the pose on the desk [m], or `beyond`."""
    one, other = arms.pairs[pair, 0], arms.pairs[pair, 1]
    _place(arms, one, desk)
    _place(arms, other, desk)
    A, B, T = desk.placed[one], desk.placed[other], desk.T
    x, y, z = A[9] - B[9], A[10] - B[10], A[11] - B[11]
    for i in range(3):
        for j in range(3):
            T[3 * i + j] = B[i] * A[j] + B[3 + i] * A[3 + j] + B[6 + i] * A[6 + j]
        T[9 + i] = B[i] * x + B[3 + i] * y + B[6 + i] * z
    return between(arms.solids, one, T, arms.solids, other, beyond, desk.room, desk.hints[pair])


@lean
def _moves(arms, pair, plane_moves, standoff, psi, lever_w, desk):  # type: ignore[no-untyped-def]
    """How far a pair can move against each other on a piece, from its middle, at most [m].

    Args:
        arms: the bodies.
        pair: which two.
        plane_moves: whether the piece is one of the twist plane.
        standoff: half of what it moves along the drill axis [m].
        psi: half of its spin [rad].
        lever_w: distance of the wrist centre from the drill axis [m].
        desk: with the turns of the joints.
    """
    one, other = arms.pairs[pair, 0], arms.pairs[pair, 1]
    link, inner = arms.link[one], arms.link[other]
    if plane_moves and link == 6 and inner == 0:
        return standoff + arms.lever[one] * psi
    turns = 0.0
    for i in range(inner, link):
        turns += desk.turn[i]
    wrist = standoff + lever_w * psi if plane_moves and inner == 0 and link >= 3 else np.inf
    most = 0.0
    for p in range(SPANNED):
        moved = 0.0
        for i in range(inner, link):
            moved += arms.reach[one, p, i] * desk.turn[i]
        if wrist < np.inf:
            moved = min(moved, wrist + arms.around[one, p] * min(turns, 2.0))
        most = max(most, moved)
    return most


@lean
def _halve(desk, top, a, m, b):  # type: ignore[no-untyped-def]
    """Put both halves of the piece that was at `top` there; its own joints at m are on the desk."""
    pairs = desk.open.shape[1]
    for half in range(2):
        k = top + 1 - half  # the first half is judged next
        desk.ends[k, 0], desk.ends[k, 1] = (a, m) if half == 0 else (m, b)
    for i in range(6):
        begin, end = desk.turned[top, 0, i], desk.turned[top, 1, i]
        desk.turned[top + 1, 0, i], desk.turned[top + 1, 1, i] = begin, desk.q[i]
        desk.turned[top, 0, i], desk.turned[top, 1, i] = desk.q[i], end
    for k in range(pairs):
        desk.open[top + 1, k] = desk.open[top, k]


@lean
def _first(arm, plane, branch, path, desk, wanted):  # type: ignore[no-untyped-def]
    """Put the whole path on the desk in a few pieces; whether all of their ends are in reach."""
    for k in range(FIRST):
        if k == 0 and not pose_of(arm, plane, branch, path, 0.0, desk):
            return False
        row = FIRST - 1 - k
        for i in range(6):
            desk.turned[row, 0, i] = desk.q[i]
        if not pose_of(arm, plane, branch, path, (k + 1.0) / FIRST, desk):
            return False
        desk.ends[row, 0], desk.ends[row, 1] = k / FIRST, (k + 1.0) / FIRST
        for i in range(6):
            desk.turned[row, 1, i] = desk.q[i]
        for p in range(desk.open.shape[1]):
            desk.open[row, p] = wanted[p]
    return True


@lean
def _turns(branch, top, desk):  # type: ignore[no-untyped-def]
    """How far each joint may be from where it is in the middle of a piece; the greatest of them."""
    most = 0.0
    for i in range(6):
        turn = 0.0
        for end in range(2):
            one = abs(desk.turned[top, end, i] - desk.q[i])
            if branch >= 0 and one > np.pi:
                one = 2.0 * np.pi - one
            turn = max(turn, one)
        desk.turn[i] = turn
        most = max(most, turn)
    return most


@kernel
def keeps(arm, plane, branch, path, arms, wanted, most, lever_w, desk, out):  # type: ignore[no-untyped-def]
    """Whether pairs of solids keep their distances on a path on which no joint turns round.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        branch: see `pose_of`.
        path: likewise.
        arms: `Arms`.
        wanted: which pairs, shape (K,).
        most: pieces that are examined: where a body moves along an obstacle, all but as near as it may be, any number
            may be needed.
        lever_w: distance of the wrist centre from the drill axis [m].
        desk: `Desk`.
        out: out, shape (3,): where a pair does not keep its distance: the share of the path, the pair, and how much it
            lacks [m].

    Returns:
        FREE: proven; HIT: at one pose it does not; UNDECIDED, also out of reach.
    """
    pairs = arms.pairs.shape[0]
    out[0], out[1], out[2] = np.nan, -1.0, 0.0
    if not _first(arm, plane, branch, path, desk, wanted):
        return UNDECIDED
    standoff, psi = abs(path[1, 0] - path[0, 0]), abs(path[1, 1] - path[0, 1])
    # at both ends of the path first: most that hit anything do so there
    for end in range(2):
        pose_of(arm, plane, branch, path, float(end), desk)
        for k in range(pairs):
            if wanted[k]:
                least = arms.least[k]
                lack = apart_at(arms, k, least, desk) - least
                if lack < 0.0:
                    out[0], out[1], out[2] = float(end), k, -lack
                    return HIT
    top, examined = FIRST, 0
    while top > 0:
        top -= 1
        examined += 1
        a, b = desk.ends[top, 0], desk.ends[top, 1]
        m = 0.5 * (a + b)
        if not pose_of(arm, plane, branch, path, m, desk):
            return UNDECIDED
        narrow = _turns(branch, top, desk) <= WIDE
        half, left = 0.5 * (b - a), False
        for k in range(pairs):
            if not desk.open[top, k]:
                continue
            least = arms.least[k]
            need = least + _moves(arms, k, branch >= 0, half * standoff, half * psi, lever_w, desk) + ROUNDING
            found = apart_at(arms, k, need, desk)
            if found < least:
                out[0], out[1], out[2] = m, k, least - found
                return HIT
            if found >= need and narrow:
                desk.open[top, k] = False
            else:
                left = True
        if left:
            if half < SHORTEST or top + 2 > DEEP or examined > most:
                return UNDECIDED
            _halve(desk, top, a, m, b)
            top += 2
    return FREE


@kernel
def legs_keep(arm, plane, branch, depth, psi_t, slope, arms, wanted, lever_w, desk, out):  # type: ignore[no-untyped-def]
    """By how much straight legs out of the target lack what is asked of them [m], 0 where they keep it.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        branch: 0..7.
        depth: of the legs [m].
        psi_t: spins at the target [rad], shape (n,).
        slope: twist rates [rad/m], shape (n,).
        arms: `Arms`.
        wanted: which pairs are held apart, shape (K,).
        lever_w: distance of the wrist centre from the drill axis [m].
        desk: `Desk`.
        out: out, shape (n,); inf where it is not decided, also out of reach.
    """
    path, where = np.zeros((2, 8)), np.empty(3)
    for n in range(psi_t.shape[0]):
        path[1, 0] = depth
        path[0, 1], path[1, 1] = psi_t[n], psi_t[n] + slope[n] * depth
        verdict = keeps(arm, plane, branch, path, arms, wanted, MOST_OF_A_LEG, lever_w, desk, where)
        out[n] = 0.0 if verdict == FREE else (where[2] if verdict == HIT else np.inf)


@kernel
def nearest(arm, plane, branch, path, arms, wanted, lever_w, within, desk, best):  # type: ignore[no-untyped-def]
    """The least distance of all pairs on a path on which no joint turns round.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        branch: see `pose_of`.
        path: likewise.
        arms: `Arms`.
        wanted: which pairs count, shape (K,).
        lever_w: distance of the wrist centre from the drill axis [m].
        within: to which it is found [m].
        desk: `Desk`.
        best: in and out, shape (9,): the least distance so far [m], the share of the path where it is, the pair, and
            the nearest points of its lines or hulls in the frame of the second solid [m]; the share is NaN where
            nothing nearer was found.

    Returns:
        FREE; or UNDECIDED, where it is not found, also out of reach.
    """
    pairs = arms.pairs.shape[0]
    best[1] = np.nan
    if not _first(arm, plane, branch, path, desk, wanted):
        return UNDECIDED
    standoff, psi = abs(path[1, 0] - path[0, 0]), abs(path[1, 1] - path[0, 1])
    for end in range(2):
        pose_of(arm, plane, branch, path, float(end), desk)
        for k in range(pairs):
            if wanted[k]:
                _note(arms, k, float(end), apart_at(arms, k, best[0], desk), desk, best)
    top = FIRST
    while top > 0:
        top -= 1
        a, b = desk.ends[top, 0], desk.ends[top, 1]
        m = 0.5 * (a + b)
        if not pose_of(arm, plane, branch, path, m, desk):
            return UNDECIDED
        narrow = _turns(branch, top, desk) <= WIDE
        half, left = 0.5 * (b - a), False
        for k in range(pairs):
            if not desk.open[top, k]:
                continue
            moved = _moves(arms, k, branch >= 0, half * standoff, half * psi, lever_w, desk) + ROUNDING
            found = apart_at(arms, k, best[0] + moved, desk)
            _note(arms, k, m, found, desk, best)
            if found >= best[0] - within + moved and narrow:
                desk.open[top, k] = False
            else:
                left = True
        if left:
            if half < SHORTEST or top + 2 > DEEP:
                return UNDECIDED
            _halve(desk, top, a, m, b)
            top += 2
    return FREE


@lean
def _note(arms, k, share, found, desk, best):  # type: ignore[no-untyped-def]
    """Keep a distance that is less than the least so far."""
    if found < best[0]:
        best[0], best[1], best[2] = found, share, k
        for c in range(3):
            best[3 + c], best[6 + c] = desk.room.A[4, c], desk.room.A[5, c]


@kernel
def poses_keep(arm, plane, branch, standoff, psi, arms, wanted, desk, out):  # type: ignore[no-untyped-def]
    """Whether pairs of solids keep their distances at poses.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        branch: 0..7.
        standoff: [m], shape (n,).
        psi: [rad], shape (n,).
        arms: `Arms`.
        wanted: which pairs, shape (K,).
        desk: `Desk`.
        out: out, shape (n,); False out of reach, too.
    """
    path = np.zeros((2, 8))
    for n in range(standoff.shape[0]):
        path[0, 0], path[0, 1], path[1, 0], path[1, 1] = standoff[n], psi[n], standoff[n], psi[n]
        out[n] = pose_of(arm, plane, branch, path, 0.0, desk)
        for k in range(arms.pairs.shape[0]):
            if out[n] and wanted[k] and apart_at(arms, k, arms.least[k], desk) < arms.least[k]:
                out[n] = False


@kernel
def poses_apart(arm, plane, branch, standoff, psi, arms, wanted, desk, out):  # type: ignore[no-untyped-def]
    """How much farther pairs of solids are apart at poses than they have to be, the least of them [m].

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        branch: 0..7.
        standoff: [m], shape (n,).
        psi: [rad], shape (n,).
        arms: `Arms`.
        wanted: which pairs, shape (K,).
        desk: `Desk`.
        out: out, shape (n,); NaN out of reach.
    """
    path = np.zeros((2, 8))
    for n in range(standoff.shape[0]):
        path[0, 0], path[0, 1], path[1, 0], path[1, 1] = standoff[n], psi[n], standoff[n], psi[n]
        if not pose_of(arm, plane, branch, path, 0.0, desk):
            out[n] = np.nan
            continue
        out[n] = np.inf
        for k in range(arms.pairs.shape[0]):
            if wanted[k]:
                out[n] = min(out[n], apart_at(arms, k, arms.least[k] + out[n], desk) - arms.least[k])
