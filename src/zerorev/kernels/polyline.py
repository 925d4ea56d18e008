"""Legs of straight segments between given stand-offs: from which spins they get to a depth (theory §4).

On a straight segment of the twist plane the slope is the same throughout, so it has to be admissible at every point of
the segment. From the outer end inwards, the least spin from which a segment leads to a spin psi lies at the end of the
steepest of those; it is found by a secant, as the slopes admissible along a segment depend but a little on where the
segment runs. So viable sets (`kernels.viable`) are made for legs of straight segments, one interval at each breakpoint,
within a corridor: the viable sets of all curves. The deepest pair of such legs takes a search along the depth, and no
programme over all breakpoints.

Lengths in m, angles in rad, slopes outwards in rad/m. `constraints` is a `layout.Constraints`. No kernel raises.
"""

from __future__ import annotations

import numpy as np

from zerorev.kernels._jit import kernel
from zerorev.kernels.field import BLOCK, PSI, STANDOFF, fields
from zerorev.kernels.reach import KEPT, carry
from zerorev.kernels.tube import admissible
from zerorev.kernels.viable import pair_meets

SAMPLES = 5  # points of a segment
TRIALS = 14  # slopes tried for each segment, at most
AGREES = 3e-4  # relative, of a slope
AWAY = 0.02  # from the last slope that is admissible, towards the middle of those that are
FEW = 64  # segments: of more of them each is that much less away
MISSED = 1e-3  # [rad] by which a corridor is widened between its rows, for the straight lines that join them
INNER = np.array([0.0, 0.03, 0.1, 0.3, 0.6])  # of an interval: how far from its end spins are tried


@kernel
def slopes_along(arm, plane, posture, side, constraints, s, length, psi, wants, low, high, shares, room, slopes):  # type: ignore[no-untyped-def]
    """The greatest or least slope that is admissible all along a segment.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        posture: 0..3.
        side: signs of the outward rates on the unflipped wrist, shape (6,).
        constraints: `Constraints`.
        s: where the segments begin [m].
        length: how far they lead outwards; inwards, if it is below 0 [m].
        psi: spins where they begin [rad], shape (M,), at most BLOCK / SAMPLES.
        wants: 1 for the greatest, -1 for the least, shape (M,).
        low: least slopes in question, shape (M,).
        high: greatest slopes in question, shape (M,).
        shares: where on a segment it is examined, 0 to 1, both among them, shape (SAMPLES,).
        room: what `kernels.tube.workspace` returns.
        slopes: out, shape (M,); NaN where there is none.
    """
    work, lo, hi, spare = room
    count = psi.shape[0]
    # all in terms of wants * slope, of which the greatest is sought: too little, too much, and the greatest admissible
    under, over, good = np.empty(count), np.empty(count), np.empty(count)
    over[:], good[:] = np.nan, np.nan
    tried, top, margin, excess = np.empty(count), np.empty(count), np.empty(count), np.empty(count)
    for m in range(count):
        work[STANDOFF * BLOCK + m], work[PSI * BLOCK + m] = s, psi[m]
    fields(arm, plane, posture, count, work)
    admissible(work, count, side, constraints, lo, hi, spare)
    left = 0
    for m in range(count):
        a, b = max(low[m], lo[m]), min(high[m], hi[m])
        under[m], top[m] = (a, b) if wants[m] > 0.0 else (-b, -a)
        tried[m] = top[m] if a <= b else np.nan
        left += 1 if a <= b else 0
    for n in range(TRIALS):
        if left == 0:
            break
        for m in range(count):
            slope = 0.0 if np.isnan(tried[m]) else wants[m] * tried[m]
            for q in range(SAMPLES):
                work[STANDOFF * BLOCK + m * SAMPLES + q] = s + shares[q] * length
                work[PSI * BLOCK + m * SAMPLES + q] = psi[m] + shares[q] * length * slope
        fields(arm, plane, posture, count * SAMPLES, work)
        admissible(work, count * SAMPLES, side, constraints, lo, hi, spare)
        for m in range(count):
            here = tried[m]
            if np.isnan(here):
                continue
            least, most = -np.inf, np.inf
            for q in range(m * SAMPLES, (m + 1) * SAMPLES):
                least, most = max(least, lo[q]), min(most, hi[q])
            if wants[m] < 0.0:
                least, most = -most, -least
            there = np.nan
            if here > most:
                there = most
                if here - most < excess[m] and not np.isnan(over[m]) and np.isnan(good[m]):
                    there = here - (here - most) * (over[m] - here) / (excess[m] - here + most)
                there -= 0.3 * AGREES * (abs(there) + 1.0)
                over[m], excess[m] = here, here - most
            elif here < least:
                under[m], there = max(under[m], here), least
            else:
                good[m], margin[m] = here, most - here
            if np.isnan(good[m]):
                ceiling = top[m] if np.isnan(over[m]) else over[m]
                if not under[m] < there < ceiling:
                    there = 0.5 * (under[m] + ceiling)
                gone = ceiling - under[m] < AGREES * (abs(ceiling) + 1.0)
            else:
                gone = np.isnan(over[m]) or over[m] - good[m] < AGREES * (abs(good[m]) + 1.0)
                share = 0.5
                if n % 3 < 2 and excess[m] < np.inf:
                    share = min(max(margin[m] / (margin[m] + excess[m]), 0.05), 0.95)
                there = good[m] + share * (over[m] - good[m])
            tried[m] = np.nan if gone else there
            left -= 1 if gone else 0
    for m in range(count):
        slopes[m] = wants[m] * good[m]


@kernel
def leg_back(arm, plane, posture, side, constraints, standoff, shares, room, spins):  # type: ignore[no-untyped-def]
    """The spins at the breakpoints from which a leg of straight segments gets to its outer end.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        posture: 0..3.
        side: signs of the outward rates on the unflipped wrist, shape (6,).
        constraints: `Constraints`.
        standoff: of the breakpoints, outwards [m], shape (N + 1,).
        shares: see `slopes_along`.
        room: what `kernels.tube.workspace` returns.
        spins: in and out, shape (N + 1, 2): the corridor; what is left of it.

    Returns:
        whether the target can be traced back to.
    """
    tries = INNER.shape[0]
    psi, low, high, slopes = np.empty(2 * tries), np.empty(2 * tries), np.empty(2 * tries), np.empty(2 * tries)
    wants = np.empty(2 * tries)
    ends, apart = np.empty(2), np.empty(2)
    for n in range(standoff.shape[0] - 2, -1, -1):
        s, length = standoff[n + 1], standoff[n] - standoff[n + 1]
        ends[:] = spins[n + 1]
        apart[0], apart[1] = ends[1] - ends[0], ends[0] - ends[1]
        a, b = np.inf, -np.inf
        for _ in range(2):
            # next to where slopes end a segment from a little further in may begin farther out
            for t in range(tries):
                for e in range(2):
                    k = 2 * t + e
                    wants[k], psi[k] = 1.0 - 2.0 * e, ends[e] + INNER[t] * apart[e]
                    low[k], high[k] = (spins[n, 1] - psi[k]) / length, (spins[n, 0] - psi[k]) / length
            slopes_along(arm, plane, posture, side, constraints, s, length, psi, wants, low, high, shares, room, slopes)
            least, most = 0, 0
            for t in range(tries):
                there = psi[2 * t] + length * slopes[2 * t]
                if there < a:
                    a, least = there, t
                there = psi[2 * t + 1] + length * slopes[2 * t + 1]
                if there > b:
                    b, most = there, t
            if least == 0 and most == 0:
                break
            for e in range(2):
                t = least if e == 0 else most
                if t > 0:
                    ends[e] += INNER[t - 1] * apart[e]
                    apart[e] *= (INNER[t + 1] if t + 1 < tries else 1.0) - INNER[t - 1]
                else:
                    apart[e] *= INNER[1]
        if a == np.inf or b == -np.inf:
            return False
        spins[n, 0], spins[n, 1] = min(a, b), max(a, b)
    return True


@kernel
def leg_out(arm, plane, posture, side, constraints, standoff, shares, room, spins, psi):  # type: ignore[no-untyped-def]
    """A leg of straight segments through viable spins, as far from their ends as can be.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        posture: 0..3.
        side: signs of the outward rates on the unflipped wrist, shape (6,).
        constraints: `Constraints`.
        standoff: of the breakpoints, outwards [m], shape (N + 1,).
        shares: see `slopes_along`.
        room: what `kernels.tube.workspace` returns.
        spins: as left by `leg_back`, shape (N + 1, 2).
        psi: in and out, shape (N + 1,): the first is the spin at the target [rad].

    Returns:
        whether there is one.
    """
    wants, here, slopes, low, high = np.array([1.0, -1.0]), np.empty(2), np.empty(2), np.empty(2), np.empty(2)
    # next to an end of what is viable each segment comes nearer to it by such a share, so the more there are the less
    away = AWAY * FEW / max(FEW, standoff.shape[0] - 1)
    for n in range(standoff.shape[0] - 1):
        length = standoff[n + 1] - standoff[n]
        slack = AGREES * (abs(spins[n + 1, 0] - psi[n]) + abs(spins[n + 1, 1] - psi[n]) + length)
        here[:] = psi[n]
        a, b = spins[n + 1, 0] - slack, spins[n + 1, 1] + slack
        if constraints.psi_bound > 0.0:
            a, b = max(a, -constraints.psi_bound), min(b, constraints.psi_bound)
        low[:], high[:] = (a - psi[n]) / length, (b - psi[n]) / length
        slopes_along(
            arm, plane, posture, side, constraints, standoff[n], length, here, wants, low, high, shares, room, slopes
        )  # fmt: skip
        most = slopes[0] if not np.isnan(slopes[0]) else slopes[1]
        least = slopes[1] if not np.isnan(slopes[1]) else most
        if np.isnan(least):
            return False
        # towards the middle of the viable spins: the middle of the slopes would come nearer to an end step by step
        slope = min(max((0.5 * (spins[n + 1, 0] + spins[n + 1, 1]) - psi[n]) / length, least), most)
        psi[n + 1] = psi[n] + length * (slope + away * (0.5 * (least + most) - slope))
    return True


@kernel
def follow(arm, plane, branch, side, constraints, grain, tube, rows, psi_t, room, path, corridor):  # type: ignore[no-untyped-def]
    """A leg through the middle of viable sets, and the intervals of these in which it runs.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        branch: 0..7.
        side: signs of the outward rates on the unflipped wrist, shape (6,).
        constraints: `Constraints`.
        grain: `Grain`.
        tube: stand-offs, counts and sets as left by `kernels.viable.viable`.
        rows: how many it has.
        psi_t: spin at the target [rad].
        room: what `kernels.reach.workspaces` returns.
        path: out, shape (rows,): spins [rad].
        corridor: out, shape (rows, 2) [rad].
    """
    standoff, counts, sets = tube
    reached = np.empty((KEPT, 2))
    for r in range(rows):
        reached[0] = path[r - 1] if r > 0 else psi_t
        if r > 0:
            s = standoff[r - 1]
            carry(arm, plane, branch // 2, side, constraints, s, standoff[r] - s, grain.turn, reached, 1, room)
        widest = -np.inf
        for k in range(counts[r]):
            a, b = max(reached[0, 0], sets[r, k, 0]), min(reached[0, 1], sets[r, k, 1])
            if b - a > widest:
                widest = b - a
                # where the two miss each other, by rounding, the one that can be reached
                path[r] = min(max(0.5 * (a + b), reached[0, 0]), reached[0, 1])
                corridor[r] = sets[r, k]


@kernel
def _between(standoff, known, rows, corridor, psi_bound, spins):  # type: ignore[no-untyped-def]
    """A corridor at the breakpoints, on straight lines between its rows; a little wider but at its outer end."""
    r = 1
    for n in range(standoff.shape[0]):
        while r < rows - 1 and known[r] < standoff[n]:
            r += 1
        share = min(max((standoff[n] - known[r - 1]) / (known[r] - known[r - 1]), 0.0), 1.0)
        wider = MISSED if n < standoff.shape[0] - 1 else 0.0
        spins[n, 0] = corridor[r - 1, 0] + share * (corridor[r, 0] - corridor[r - 1, 0]) - wider
        spins[n, 1] = corridor[r - 1, 1] + share * (corridor[r, 1] - corridor[r - 1, 1]) + wider
        if psi_bound > 0.0:
            spins[n, 0], spins[n, 1] = max(spins[n, 0], -psi_bound), min(spins[n, 1], psi_bound)


@kernel
def pair_width(  # type: ignore[no-untyped-def]
    arm, plane, branch, sense, constraints, guarded, limited, grain, depth, part, shares, room, tubes, rows,
    viable_tubes, viable_rows, spins, overlap,
):  # fmt: skip
    """From how wide an interval of the target line two legs of straight segments get to a depth.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        branch: 0..7.
        sense: signs of the outward rates of the first leg on the unflipped wrist, shape (6,); the second leg has the
            opposite ones.
        constraints: `Constraints`.
        guarded: the same with a little more asked of the joints, to which the segments are held.
        limited: whether joint limits are heeded.
        grain: `Grain`.
        depth: [m].
        part: of the depth, where segments meet, 0 to 1, shape (2, N + 1).
        shares: see `slopes_along`.
        room: what `kernels.reach.workspaces` returns.
        tubes: as left by `kernels.viable.pair_bound`.
        rows: of each, likewise.
        viable_tubes: out: see `kernels.viable.pair_meets`.
        viable_rows: out, likewise.
        spins: out, shape (2, N + 1, 2): viable spins at the breakpoints [rad].
        overlap: out, shape (2,): the interval [rad].

    Returns:
        its width [rad], below 0 where the two sides miss each other by that much; -inf where a leg has no way.
    """
    if not pair_meets(
        arm,
        plane,
        branch,
        sense,
        constraints,
        limited,
        grain,
        depth,
        room,
        tubes,
        rows,
        viable_tubes,
        viable_rows,
        overlap,
    ):
        return -np.inf
    psi_t = 0.5 * (overlap[0] + overlap[1])
    path, corridor = np.empty(viable_tubes[0].shape[1]), np.empty((viable_tubes[0].shape[1], 2))
    for k in range(2):
        side, last = (1.0 - 2.0 * k) * sense, viable_rows[k]
        tube = viable_tubes[0][k], viable_tubes[1][k], viable_tubes[2][k]
        follow(arm, plane, branch, side, constraints, grain, tube, last, psi_t, room, path, corridor)
        _between(part[k] * depth, tube[0], last, corridor, constraints.psi_bound, spins[k])
        if not leg_back(arm, plane, branch // 2, side, guarded, part[k] * depth, shares, room[0], spins[k]):
            return -np.inf
    overlap[0], overlap[1] = max(spins[0, 0, 0], spins[1, 0, 0]), min(spins[0, 0, 1], spins[1, 0, 1])
    return overlap[1] - overlap[0]
