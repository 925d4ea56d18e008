"""How near the bodies of an arm come to what stands around it, and to each other, on whole pieces of a motion.

A piece is judged from its middle. On a piece on which no joint turns round, each joint is farthest from where it is in
the middle at one of the two ends. So a point moves from there by at most the sum over the joints of that angle times
its greatest distance from the axis: one joint changed after the other, from the tip inwards. The wrist and what lies
beyond it are known from the twist plane itself. A hull moves no farther than the points that span it. So a piece keeps
a distance where its middle keeps that much more; else it is halved.
"""

from __future__ import annotations

import numpy as np

from zerorev.kernels._jit import kernel, lean
from zerorev.kernels.bodies import DEEP, apart_at, balls_apart, pose_of

__all__ = ["FREE", "HIT", "UNDECIDED", "keeps", "legs_keep", "nearest"]

FREE, HIT, UNDECIDED = 0, 1, 2
SHORTEST = 1e-9  # of a piece: what is not decided then stays so
ROUNDING = 1e-9  # [m] more than the arithmetic of a pose can be off
WIDE = 2.0  # [rad] half a piece may turn a joint by no more, so that a full turn is not taken for none
FIRST = 2  # pieces to begin with


@lean
def _moves(arms, plane_moves, standoff, psi, lever_w, chosen, desk):  # type: ignore[no-untyped-def]
    """How far pairs can move against each other on a piece, from its middle, at most [m].

    Args:
        arms: the bodies.
        plane_moves: whether the piece is one of the twist plane.
        standoff: half of what it moves along the drill axis [m].
        psi: half of its spin [rad].
        lever_w: distance of the wrist centre from the drill axis [m].
        chosen: which pairs, shape (K,).
        desk: with the turns of the joints; out: moved.
    """
    before = -1
    for k in range(arms.pairs.shape[0]):
        if not chosen[k]:
            continue
        one, inner = arms.pairs[k, 0], arms.link[arms.pairs[k, 1]]
        # of one body all pairs with what stands still follow each other, as `arm_bodies.pairs_of` has them
        same = before >= 0 and arms.pairs[before, 0] == one and arms.link[arms.pairs[before, 1]] == inner
        desk.moved[k] = desk.moved[before] if same else _moved(
            arms.reach[one], arms.around[one], arms.spanned[one], arms.lever[one], arms.link[one], inner, plane_moves,
            standoff, psi, lever_w, desk.turn,
        )  # fmt: skip
        before = k


@lean
def _moved(  # type: ignore[no-untyped-def]
    reach, around, spanned, lever, link, inner, plane_moves, standoff, psi, lever_w, turn
):
    """The same of one body, against an inner link."""
    if plane_moves and link == 6 and inner == 0:
        return standoff + lever * psi
    turns = 0.0
    for i in range(inner, link):
        turns += turn[i]
    wrist = standoff + lever_w * psi if plane_moves and inner == 0 and link >= 3 else np.inf
    most = 0.0
    for p in range(spanned):
        moved = 0.0
        for i in range(inner, link):
            moved += reach[p, i] * turn[i]
        if wrist < np.inf:
            moved = min(moved, wrist + around[p] * min(turns, 2.0))
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
        balls_apart(arms, wanted, desk)
        for k in range(pairs):
            least = arms.least[k]
            if wanted[k] and desk.away[k] < least:
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
        _moves(arms, branch >= 0, half * standoff, half * psi, lever_w, desk.open[top], desk)
        balls_apart(arms, desk.open[top], desk)
        for k in range(pairs):
            if not desk.open[top, k]:
                continue
            least = arms.least[k]
            need = least + desk.moved[k] + ROUNDING
            found = desk.away[k] if desk.away[k] >= need else apart_at(arms, k, need, desk)
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
def legs_keep(arm, plane, branch, depth, psi_t, slope, arms, wanted, most, lever_w, desk, out):  # type: ignore[no-untyped-def]
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
        most: pieces of a leg that are examined.
        lever_w: distance of the wrist centre from the drill axis [m].
        desk: `Desk`.
        out: out, shape (n,); inf where it is not decided, also out of reach.
    """
    path, where = np.zeros((2, 8)), np.empty(3)
    for n in range(psi_t.shape[0]):
        path[1, 0] = depth
        path[0, 1], path[1, 1] = psi_t[n], psi_t[n] + slope[n] * depth
        verdict = keeps(arm, plane, branch, path, arms, wanted, most, lever_w, desk, where)
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
        best: in and out, shape (3,): the least distance so far [m], the share of the path where it is, and the pair;
            the share is NaN where nothing nearer was found.

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
        balls_apart(arms, wanted, desk)
        for k in range(pairs):
            if wanted[k] and desk.away[k] < best[0]:
                _note(k, float(end), apart_at(arms, k, best[0], desk), best)
    top = FIRST
    while top > 0:
        top -= 1
        a, b = desk.ends[top, 0], desk.ends[top, 1]
        m = 0.5 * (a + b)
        if not pose_of(arm, plane, branch, path, m, desk):
            return UNDECIDED
        narrow = _turns(branch, top, desk) <= WIDE
        half, left = 0.5 * (b - a), False
        _moves(arms, branch >= 0, half * standoff, half * psi, lever_w, desk.open[top], desk)
        balls_apart(arms, desk.open[top], desk)
        for k in range(pairs):
            if not desk.open[top, k]:
                continue
            moved = desk.moved[k] + ROUNDING
            found = desk.away[k]
            if found < best[0] + moved:
                found = apart_at(arms, k, best[0] + moved, desk)
                _note(k, m, found, best)
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
def _note(k, share, found, best):  # type: ignore[no-untyped-def]
    """Keep a distance that is less than the least so far."""
    if found < best[0]:
        best[0], best[1], best[2] = found, share, k
