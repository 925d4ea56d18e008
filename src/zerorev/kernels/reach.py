"""Reachable sets: the spins that free legs can reach at each stand-off (theory §4).

A free leg is any curve psi(s) whose slope u is admissible everywhere: with the direction signs sigma of the joints
fixed, sigma_i (theta_s,i + u theta_psi,i) >= m for all i, and |u| no more than the greatest twist rate. At a point of
the twist plane that leaves one interval of slopes [lo, hi], or none. So the spins that legs out of a set of spins can
reach at a stand-off are a union of intervals, whose ends move outwards at lo and at hi, and which are cut where no
slope is admissible, or a joint is beyond its limits. These are the *reachable* sets. They are estimates: a set is cut
at the rows of its tube and at spins a little apart, so that it may jump a thin stretch that no leg can pass.

A *set of spins* is an array of shape (KEPT, 2) and a count, a *tube* the sets at a few stand-offs: `standoff` (R,),
`counts` (R,), `sets` (R, KEPT, 2). The signs `side` are those of the outward rates on the unflipped wrist, which is
what the rate fields are of. Lengths in m, angles in rad, slopes outwards in rad/m. No kernel raises.
"""

from __future__ import annotations

import numpy as np

from zerorev.kernels._jit import kernel
from zerorev.kernels.arm import controller_angles, flip_sign, solve_at
from zerorev.kernels.field import BLOCK, PSI, STANDOFF, fields
from zerorev.kernels.tube import admissible, workspace

KEPT = 8  # intervals of a set; more are hardly ever seen, and the others are then left out
MOST_PARTS = 64  # of a step
CLOSER = 8  # samples by which the edge of a set is located, at most
BACK = 1.0  # [rad] by which a joint may seem to have moved back, as spins at the target differ
JUST = 0.2  # by which two slopes differ that are nearly the same, relative
EDGE = 1e-3  # of the distance between two spins that are examined: to which it is
LARGE = 1e9  # [rad/m] of a margin that says nothing


@kernel
def workspaces():  # type: ignore[no-untyped-def]
    """What `cut` and all above it work in; the last is where joints stand at the target, see `limit_room`."""
    return workspace(), workspace(), np.empty((6, 2)), np.empty(6), np.nan * np.ones(6)


@kernel
def carry(arm, plane, posture, side, constraints, s, step, turn, spins, count, room):  # type: ignore[no-untyped-def]
    """Carry a set of spins along the twist plane: left ends as far down, right ends as far up as slopes admit.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        posture: 0..3.
        side: signs of the outward rates on the unflipped wrist, shape (6,).
        constraints: `Constraints`.
        s: where the step begins [m].
        step: how far it leads outwards; inwards, if it is below 0 [m].
        turn: by which an end moves at once, at most [rad]: steep slopes are followed in more and smaller parts.
        spins: in and out, shape (KEPT, 2).
        count: how many intervals there are.
        room: what `workspaces` returns.
    """
    slopes, ends = np.zeros(2 * KEPT), np.empty(2 * KEPT)
    ends[: 2 * count] = spins.ravel()[: 2 * count]
    outwards = step > 0.0
    _steepest(arm, plane, posture, side, constraints, s, outwards, ends, 2 * count, room, slopes)
    swiftest = 0.0
    for e in range(2 * count):
        swiftest = max(swiftest, abs(slopes[e]))
    parts = min(MOST_PARTS, int(swiftest * abs(step) / turn) + 1)
    part = step / parts
    middle = np.empty(2 * KEPT)
    for n in range(parts):
        if n > 0:
            _steepest(arm, plane, posture, side, constraints, s + n * part, outwards, ends, 2 * count, room, slopes)
        for e in range(2 * count):
            middle[e] = ends[e] + 0.5 * part * slopes[e]
        _steepest(
            arm, plane, posture, side, constraints, s + (n + 0.5) * part, outwards, middle, 2 * count, room, slopes
        )
        for e in range(2 * count):
            ends[e] += part * slopes[e]
    for k in range(count):
        a, b = ends[2 * k], ends[2 * k + 1]
        if a > b:  # ends that have crossed in a step
            a = b = 0.5 * (a + b)
        spins[k] = a, b


@kernel
def _steepest(arm, plane, posture, side, constraints, s, outwards, psi, count, room, slopes):  # type: ignore[no-untyped-def]
    """The slopes at which ends leave a set fastest; kept as they are where there is no pose."""
    work, lo, hi, spare = room[0]
    for e in range(count):
        work[STANDOFF * BLOCK + e], work[PSI * BLOCK + e] = s, psi[e]
    fields(arm, plane, posture, count, work)
    admissible(work, count, side, constraints, lo, hi, spare)
    for e in range(count):
        if hi[e] > -np.inf:
            # inwards it is the steepest way that leads to the least spin
            slope = lo[e] if (e % 2 == 0) == outwards else hi[e]
            if lo[e] > hi[e]:
                # just beyond where slopes end: along that edge; farther out, wait for the cut
                just = lo[e] - hi[e] < JUST * max(abs(lo[e]), abs(hi[e]))
                slope = 0.5 * (lo[e] + hi[e]) if just else 0.0
            slopes[e] = min(max(slope, -constraints.steepest), constraints.steepest)


@kernel
def cut(arm, plane, branch, side, constraints, limited, s, between, spins, count, room):  # type: ignore[no-untyped-def]
    """Cut a set to the spins with an admissible slope, and within the limits; what overlaps is joined.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        branch: 0..7.
        side: signs of the outward rates on the unflipped wrist, shape (6,).
        constraints: `Constraints`.
        limited: whether joint limits are heeded.
        s: stand-off [m].
        between: two spins that are examined, at most [rad].
        spins: in and out, shape (KEPT, 2).
        count: how many intervals there are.
        room: what `workspaces` returns.

    Returns:
        how many are left.
    """
    (work, lo, hi, spare), spot = room[0], room[1:]
    parts, found = np.empty((KEPT, 2)), 0
    count = joined(spins, count)
    for k in range(count):
        left, right = spins[k]
        nodes = int((right - left) / between) + 2 if right > left else 1
        apart = (right - left) / max(1, nodes - 1)
        here = value = begin = 0.0
        inside = False
        for first in range(0, nodes, BLOCK):
            block = min(BLOCK, nodes - first)
            for n in range(block):
                work[STANDOFF * BLOCK + n], work[PSI * BLOCK + n] = s, left + (first + n) * apart
            fields(arm, plane, branch // 2, block, work)
            admissible(work, block, side, constraints, lo, hi, spare)
            for n in range(block):
                psi, after = work[PSI * BLOCK + n], spare[0, n]
                if limited and after >= 0.0:
                    after = min(after, limit_room(arm, plane, branch, side, s, psi, constraints, spot))
                if first + n == 0:
                    inside, begin = after >= 0.0, psi
                elif (after >= 0.0) != inside:
                    known = (psi, after, here, value) if after >= 0.0 else (here, value, psi, after)
                    edge = _edge(arm, plane, branch, side, constraints, limited, s, known, EDGE * between, spot)
                    if not inside:
                        begin = edge
                    elif found < KEPT:
                        parts[found] = begin, edge
                        found += 1
                    inside = not inside
                here, value = psi, after
        if inside and found < KEPT:
            parts[found] = begin, right
            found += 1
    spins[:found] = parts[:found]
    return found


@kernel
def _edge(arm, plane, branch, side, constraints, limited, s, known, close, spot):  # type: ignore[no-untyped-def]
    """The last living spin between a living one and a dead one, by false positions, and bisection where they fail."""
    work, lo, hi, spares = spot[0]
    alive, spare, dead, lacking = known
    for n in range(CLOSER):
        if abs(dead - alive) < close:
            break
        share = 0.5
        if n % 3 < 2 and lacking > -np.inf and spare < LARGE:
            share = min(max(spare / (spare - lacking), 0.05), 0.95)
        psi = alive + share * (dead - alive)
        work[STANDOFF * BLOCK], work[PSI * BLOCK] = s, psi
        fields(arm, plane, branch // 2, 1, work)
        admissible(work, 1, side, constraints, lo, hi, spares)
        there = spares[0, 0]
        if limited and there >= 0.0:
            there = min(there, limit_room(arm, plane, branch, side, s, psi, constraints, spot))
        if there >= 0.0:
            alive, spare = psi, there
        else:
            dead, lacking = psi, there
    return alive


@kernel
def limit_room(arm, plane, branch, side, s, psi, constraints, spot):  # type: ignore[no-untyped-def]
    """How far a point is from the joint limits, with any turns of the joints.

    A joint that turns more than once round within its limits counts only where it is known how it stands at the target.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        branch: 0..7.
        side: signs of the outward rates on the unflipped wrist, shape (6,).
        s: stand-off [m].
        psi: spin [rad].
        constraints: `Constraints`.
        spot: of what `workspaces` returns all but the first; of joints known at the target the last has the angles
            there, their turns included [rad].

    Returns:
        the least room over the joints, each with the turn that leaves most [rad]; below 0 beyond a limit, -inf where
        there is no pose.
    """
    cs, angles, at_target = spot[1], spot[2], spot[3]
    if not solve_at(arm, plane, s, psi, branch // 2, cs)[0]:
        return -np.inf
    controller_angles(arm, cs, branch % 2 == 1, angles)
    least, full = np.inf, 2.0 * np.pi
    for i in range(6):
        half = 0.5 * (constraints.upper[i] - constraints.lower[i])
        away = angles[i] - 0.5 * (constraints.lower[i] + constraints.upper[i])
        if half < np.pi:
            least = min(least, half - abs(away - full * np.rint(away / full)))
        elif not np.isnan(at_target[i]):
            # it only ever moves away from there
            way = side[i] * flip_sign(arm, branch) if i == 4 else side[i]
            moved = way * (angles[i] - at_target[i])
            moved -= full * np.floor((moved + BACK) / full)
            least = min(least, half - abs(away + at_target[i] + way * moved - angles[i]))
    return least


@kernel
def reachable(arm, plane, branch, side, constraints, limited, grain, longest, room, standoff, counts, sets, rows):  # type: ignore[no-untyped-def]
    """Carry a set of spins outwards until nothing is left of it.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        branch: 0..7.
        side: signs of the outward rates on the unflipped wrist, shape (6,).
        constraints: `Constraints`.
        limited: whether joint limits are heeded.
        grain: `Grain`.
        longest: where to stop [m].
        room: what `workspaces` returns.
        standoff: in and out, shape (R,): of the rows of the tube.
        counts: in and out, shape (R,).
        sets: in and out, shape (R, KEPT, 2).
        rows: how many rows the tube has already; the last of them is where it continues.

    Returns:
        how many rows the tube now has; the stand-off of the last of them is how far legs get. 0 where the first row
        is dead.
    """
    start, most = rows, standoff.shape[0]
    if rows == 1:
        counts[0] = cut(
            arm, plane, branch, side, constraints, limited, standoff[0], grain.between, sets[0], counts[0], room
        )
        if counts[0] == 0:
            return 0
    low, high = sets[0, 0, 0] - constraints.longest, sets[0, counts[0] - 1, 1] + constraints.longest
    if constraints.psi_bound > 0.0:
        low, high = max(low, -constraints.psi_bound), min(high, constraints.psi_bound)
    step = grain.step
    while rows < most and standoff[rows - 1] < longest:
        s, count = standoff[rows - 1], counts[rows - 1]
        ds = min(step, longest - s)
        here = sets[rows]
        here[:count] = sets[rows - 1, :count]
        carry(arm, plane, branch // 2, side, constraints, s, ds, grain.turn, here, count, room)
        count = within(here, joined(here, count), low, high)
        s = longest if longest - s - ds < 1e-9 else s + ds
        count = cut(arm, plane, branch, side, constraints, limited, s, grain.between, here, count, room)
        if count > 0:
            standoff[rows], counts[rows] = s, count
            rows += 1
        elif ds <= grain.finest:
            break
        else:
            step = 0.25 * ds
    return max(rows, start)


@kernel
def within(spins, count, low, high):  # type: ignore[no-untyped-def]
    """Cut a set of spins to what lies between two; returns how many intervals are left."""
    left = 0
    for k in range(count):
        a, b = spins[k]
        if a <= high and b >= low:
            spins[left] = max(a, low), min(b, high)
            left += 1
    return left


@kernel
def joined(spins, count):  # type: ignore[no-untyped-def]
    """Bring the intervals of a set in order, and join what overlaps; returns how many are left."""
    for k in range(1, count):
        a, b = spins[k]
        n = k - 1
        while n >= 0 and spins[n, 0] > a:
            spins[n + 1] = spins[n]
            n -= 1
        spins[n + 1] = a, b
    left = 0
    for k in range(count):
        if left > 0 and spins[k, 0] <= spins[left - 1, 1]:
            spins[left - 1, 1] = max(spins[left - 1, 1], spins[k, 1])
        else:
            spins[left] = spins[k]
            left += 1
    return left
