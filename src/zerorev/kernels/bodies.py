"""Where the bodies of an arm are at one pose, and how far pairs of them, and of what stands around, are apart there."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from zerorev.kernels._jit import kernel, lean
from zerorev.kernels.arm import solve_at
from zerorev.kernels.solids import Room, Solids, between

__all__ = [
    "DEEP",
    "SPANNED",
    "Arms",
    "Desk",
    "apart_at",
    "balls_apart",
    "desk",
    "pose_of",
    "poses_keep",
    "poses_nearest",
]

Array = npt.NDArray[np.float64]
Whole = npt.NDArray[np.int64]

SPANNED = 8  # points that span a body, at most
DEEP = 48  # pieces that wait, at most


class Arms(NamedTuple):
    """The bodies of an arm with a tool, what stands around, and which of them are held apart.

    Attributes:
        solids: of bodies and obstacles.
        link: with which each moves, 0 to 6, shape (S,).
        frames: of each in that of its link: rotation row by row, then the place [m], shape (S, 12).
        pairs: numbers of solids, the one of the lower link behind the other, shape (K, 2).
        least: what each pair keeps [m], shape (K,).
        balls: about each solid in its own frame: centre and radius [m], shape (S, 4).
        spanned: how many points span each, the first of those below, shape (S,).
        reach: greatest distance of the points that span a body from each axis [m], shape (S, SPANNED, 6).
        around: their distance from the wrist centre [m], shape (S, SPANNED).
        lever: greatest distance of a body of link 6 from the drill axis, and of the wrist centre [m], shape (S,).
    """

    solids: Solids
    link: Whole
    frames: Array
    pairs: Whole
    least: Array
    balls: Array
    spanned: Whole
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
        still: whether they are the same in all poses, shape (S,).
        T: one in the frame of another, shape (12,).
        cs: cosines and sines of the joints, shape (6, 2).
        q: joints in the middle [rad], shape (6,).
        turn: how far the joints may be from there [rad], shape (6,).
        moved: how far each pair may have moved against each other since [m], shape (K,).
        away: how far each pair is apart at least [m], shape (K,).
    """

    room: Room
    ends: Array
    turned: Array
    open: npt.NDArray[np.bool_]
    hints: Whole
    links: Array
    placed: Array
    known: npt.NDArray[np.bool_]
    still: npt.NDArray[np.bool_]
    T: Array
    cs: Array
    q: Array
    turn: Array
    moved: Array
    away: Array


def desk(arms: Arms, room: Room) -> Desk:
    """Room for the motions of some bodies, one at a time.

    Args:
        arms: the bodies.
        room: of a distance.
    """
    pairs, still = len(arms.pairs), arms.link == 0
    return Desk(
        room, np.empty((DEEP, 2)), np.empty((DEEP, 2, 6)), np.empty((DEEP, pairs), dtype=np.bool_),
        np.full((pairs, 2), -1), np.zeros((7, 12)), np.where(still[:, None], arms.frames, np.nan), still.copy(), still,
        np.empty(12), np.empty((6, 2)), np.empty(6), np.empty(6), np.empty(pairs), np.empty(pairs),
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
        desk.known[i] = desk.still[i]
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
def balls_apart(arms, chosen, desk):  # type: ignore[no-untyped-def]
    """How far pairs are apart at the pose on the desk, at least [m]: the ball about one from the box about the other.

    One call for many pairs: what is asked of a pair alone costs a call that hands over all that is known.

    Args:
        arms: `Arms`.
        chosen: which pairs, shape (K,).
        desk: `Desk`; out: placed, away.
    """
    balls, boxes, root, thick, pairs = arms.balls, arms.solids.boxes, arms.solids.root, arms.solids.thick, arms.pairs
    for k in range(pairs.shape[0]):
        if not chosen[k]:
            continue
        one, other = pairs[k, 0], pairs[k, 1]
        if not desk.known[one]:
            _place(arms, one, desk)
        if not desk.known[other]:
            _place(arms, other, desk)
        A, B, box = desk.placed[one], desk.placed[other], root[other]
        a, b, c = balls[one, 0], balls[one, 1], balls[one, 2]
        x = A[9] + A[0] * a + A[1] * b + A[2] * c - B[9]
        y = A[10] + A[3] * a + A[4] * b + A[5] * c - B[10]
        z = A[11] + A[6] * a + A[7] * b + A[8] * c - B[11]
        squared = 0.0
        for i in range(3):
            at = B[i] * x + B[3 + i] * y + B[6 + i] * z
            beside = max(boxes[box, i] - at, at - boxes[box, 3 + i])
            if beside > 0.0:
                squared += beside * beside
        desk.away[k] = np.sqrt(squared) - balls[one, 3] - thick[other]


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
        if not out[n]:
            continue
        balls_apart(arms, wanted, desk)
        for k in range(arms.pairs.shape[0]):
            least = arms.least[k]
            if wanted[k] and desk.away[k] < least and apart_at(arms, k, least, desk) < least:
                out[n] = False
                break


@kernel
def poses_nearest(arm, plane, branch, standoff, psi, arms, wanted, desk, out):  # type: ignore[no-untyped-def]
    """What is nearest to what at poses.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        branch: 0..7.
        standoff: [m], shape (n,).
        psi: [rad], shape (n,).
        arms: `Arms`.
        wanted: which pairs count, shape (K,).
        desk: `Desk`.
        out: out, shape (n, 8): the distance [m], the pair, and the nearest points of its lines or hulls, base frame
            [m]; NaN out of reach.
    """
    path, pairs, last = np.zeros((2, 8)), arms.pairs.shape[0], 0
    for n in range(standoff.shape[0]):
        path[0, 0], path[0, 1], path[1, 0], path[1, 1] = standoff[n], psi[n], standoff[n], psi[n]
        for c in range(8):
            out[n, c] = np.nan
        if not pose_of(arm, plane, branch, path, 0.0, desk):
            continue
        balls_apart(arms, wanted, desk)
        least, first = np.inf, last
        for turn in range(pairs):
            k = (first + turn) % pairs  # what was nearest before comes first: the others are soon known to be farther
            if not wanted[k] or desk.away[k] >= least:
                continue
            found = apart_at(arms, k, least, desk)
            if found >= least:
                continue
            least = found
            out[n, 0], out[n, 1] = found, k
            last = k
            T, A = desk.placed[arms.pairs[k, 1]], desk.room.A
            for point in range(2):
                x, y, z = A[4 + point, 0], A[4 + point, 1], A[4 + point, 2]
                for i in range(3):
                    out[n, 2 + 3 * point + i] = T[9 + i] + T[3 * i] * x + T[3 * i + 1] * y + T[3 * i + 2] * z
