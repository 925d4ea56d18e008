"""Tubes: the spins that can be reached at each stand-off while every joint keeps its direction (theory §4).

A free leg is any curve psi(s) whose slope u is admissible everywhere: with the direction signs sigma of the joints
fixed, sigma_i (theta_s,i + u theta_psi,i) >= m for all i, and |u| no more than the greatest twist rate. At a point of
the twist plane that leaves one interval of slopes [lo, hi], or none. So the spins that legs out of one point can reach
at a stand-off are a union of intervals, whose ends move outwards at lo and at hi, and which are cut where no slope is
admissible. Carried outwards step by step until nothing is left, it tells how deep any leg can go; no profile is
searched for.

A *set of spins* is an array of shape (KEPT, 2) and a count; a *tube* has a row for each stand-off, of shape (WIDTH,):
the stand-off, the count, and the set. The signs `side` are those of the outward rates on the unflipped wrist, which is
what the rate fields are of. Lengths in m, angles in rad, slopes outwards in rad/m. No kernel raises.
"""

from __future__ import annotations

import numpy as np

from zerorev.kernels._jit import kernel
from zerorev.kernels.field import BLOCK, PSI, ROOM, STANDOFF, THETA_PSI, THETA_S, fields
from zerorev.kernels.legs import NIL

KEPT = 4  # intervals of a set; more are hardly ever seen, and the others are then left out
WIDTH = 2 + 2 * KEPT
MAX_ROWS = 4096  # of a tube
LEAST_NODES = 5  # points examined on an interval, at least
# columns of what is left of a set after the dead spins are cut away: its ends, and the slopes at which these move
LEFT, RIGHT, LOW, HIGH = range(4)


@kernel
def workspace():  # type: ignore[no-untyped-def]
    """What `living` and all above it work in."""
    return np.empty(ROOM), np.empty(BLOCK), np.empty(BLOCK), np.empty((2, BLOCK))


@kernel
def admissible(work, count, side, constraints, lo, hi, spare):  # type: ignore[no-untyped-def]
    """The interval of admissible slopes at each of a few points; empty (lo > hi) where there is none.

    Args:
        work: as left by `kernels.field.fields`.
        count: how many points.
        side: wanted sign of each joint's outward rate, shape (6,).
        constraints: `Constraints`.
        lo: out, shape (BLOCK,) [rad/m].
        hi: out, shape (BLOCK,) [rad/m].
        spare: out, shape (2, BLOCK): by how much the joints that bound the interval outrun the threshold where their
            rates are equal [rad/m]; below 0 where the interval is empty. Unlike hi - lo it knows no poles.
    """
    spare, per_lo, per_hi = spare[0], spare[0], spare[1]
    for n in range(count):
        lo[n], hi[n], per_lo[n], per_hi[n] = -constraints.steepest, constraints.steepest, 0.0, 0.0
    for i in range(6):
        for n in range(count):
            still = side[i] * work[(THETA_S + i) * BLOCK + n]
            turning = side[i] * work[(THETA_PSI + i) * BLOCK + n] + 0.0  # no -0, so that its critical rate has a sign
            per_turning = 1.0 / turning
            critical = (constraints.min_rate - still) * per_turning
            # a joint that does not move at all does not reverse either
            moves = abs(still) + abs(turning) * constraints.steepest > NIL
            low = critical if (turning >= 0.0) & moves else -np.inf
            high = critical if (turning < 0.0) & moves else np.inf
            per_lo[n] = per_turning if low > lo[n] else per_lo[n]
            per_hi[n] = -per_turning if high < hi[n] else per_hi[n]
            lo[n] = low if low > lo[n] else lo[n]
            hi[n] = high if high < hi[n] else hi[n]
    for n in range(count):
        if np.isnan(work[THETA_PSI * BLOCK + n]):
            hi[n] = -np.inf
        spare[n] = (hi[n] - lo[n]) / (per_lo[n] + per_hi[n] + 1e-300)


@kernel
def living(arm, plane, posture, s, spins, count, side, constraints, grain, room, parts):  # type: ignore[no-untyped-def]
    """What is left of a set of spins where those without an admissible slope are cut away.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        posture: 0..3.
        s: stand-off [m].
        spins: set of spins, shape (KEPT, 2); intervals that overlap are joined.
        count: how many intervals it has.
        side: wanted sign of each joint's outward rate, shape (6,).
        constraints: `Constraints`.
        grain: `Grain`.
        room: what `workspace` returns.
        parts: out, shape (KEPT, 4): LEFT, RIGHT, LOW and HIGH of each interval.

    Returns:
        how many intervals are left.
    """
    work, lo, hi, spare = room
    found, k = 0, 0
    while k < count:
        left, right = spins[k]
        k += 1
        while k < count and spins[k, 0] <= right:
            right = max(right, spins[k, 1])
            k += 1
        nodes = 1
        if right > left:
            nodes = min(BLOCK, max(LEAST_NODES, int((right - left) / grain.between) + 2))
        for n in range(nodes):
            work[STANDOFF * BLOCK + n] = s
            work[PSI * BLOCK + n] = left + (right - left) * n / max(1, nodes - 1)
        fields(arm, plane, posture, nodes, work)
        admissible(work, nodes, side, constraints, lo, hi, spare)
        alive = False
        for n in range(nodes):
            if not alive and spare[0, n] >= 0.0:
                if found == KEPT:
                    return found
                alive = True
                if n > 0:
                    psi, low, high = _edge(work, lo, hi, spare[0], n, n - 1)
                else:
                    psi, low, high = left, lo[0], hi[0]
                parts[found, LEFT], parts[found, LOW] = psi, low
            if alive and (n == nodes - 1 or not spare[0, n + 1] >= 0.0):
                if n < nodes - 1:
                    psi, low, high = _edge(work, lo, hi, spare[0], n, n + 1)
                else:
                    psi, low, high = work[PSI * BLOCK + n], lo[n], hi[n]
                parts[found, RIGHT], parts[found, HIGH] = psi, high
                alive = False
                found += 1
    return found


@kernel
def _edge(work, lo, hi, spare, n, dead):  # type: ignore[no-untyped-def]
    """Where between a living point and a dead neighbour life ends, on a straight line: psi, lo and hi there."""
    share = spare[n] / (spare[n] - spare[dead])
    psi = work[PSI * BLOCK + n]
    if not share > 0.0:
        return psi, lo[n], hi[n]
    psi += share * (work[PSI * BLOCK + dead] - psi)
    # next to a pole of a critical rate a straight line may lead far away
    low = min(max(lo[n] + share * (lo[dead] - lo[n]), lo[n]), hi[n])
    high = max(min(hi[n] + share * (hi[dead] - hi[n]), hi[n]), lo[n])
    return psi, low, high


@kernel
def drift(arm, plane, posture, s, step, parts, count, side, constraints, room, spins):  # type: ignore[no-untyped-def]
    """Where the ends of a set's intervals are a step outwards (inwards, if it is below 0), by the midpoint rule."""
    work, lo, hi, spare = room
    for k in range(count):
        for end in range(2):
            slope = parts[k, LOW] if end == 0 else parts[k, HIGH]
            work[STANDOFF * BLOCK + 2 * k + end] = s + 0.5 * step
            work[PSI * BLOCK + 2 * k + end] = parts[k, end] + 0.5 * step * slope
    fields(arm, plane, posture, 2 * count, work)
    admissible(work, 2 * count, side, constraints, lo, hi, spare)
    for k in range(count):
        # inwards it is the steepest way that leads to the least spin
        low, high = (lo, hi) if step > 0.0 else (hi, lo)
        lives = lo[2 * k] <= hi[2 * k]
        spins[k, 0] = parts[k, LEFT] + step * (low[2 * k] if lives else parts[k, LOW])
        lives = lo[2 * k + 1] <= hi[2 * k + 1]
        spins[k, 1] = parts[k, RIGHT] + step * (high[2 * k + 1] if lives else parts[k, HIGH])


@kernel
def march(arm, plane, posture, side, constraints, grain, longest, room, tube, rows):  # type: ignore[no-untyped-def]
    """Carry a set of spins outwards until nothing is left of it.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        posture: 0..3.
        side: wanted sign of each joint's outward rate, shape (6,).
        constraints: `Constraints`.
        grain: `Grain`.
        longest: where to stop [m].
        room: as `living` takes it.
        tube: in and out, shape (MAX_ROWS, WIDTH).
        rows: how many rows the tube has already; the last of them is where it continues.

    Returns:
        how many rows the tube now has; the stand-off of the last of them is how far legs get. 0 where the first row
        is dead already.
    """
    spins, parts, last = np.empty((KEPT, 2)), np.empty((KEPT, 4)), np.empty((KEPT, 4))
    rows -= 1
    start, s, count, ds, step = rows, tube[rows, 0], int(tube[rows, 1]), 0.0, grain.step
    for k in range(count):
        spins[k, 0], spins[k, 1] = tube[rows, 2 + 2 * k], tube[rows, 3 + 2 * k]
    middle = 0.5 * (tube[0, 2] + tube[0, 3])
    low, high = middle - constraints.longest, middle + constraints.longest
    if constraints.psi_bound > 0.0:
        low, high = max(low, -constraints.psi_bound), min(high, constraints.psi_bound)
    while rows < MAX_ROWS:
        left = living(arm, plane, posture, s, spins, count, side, constraints, grain, room, parts)
        if left > 0:
            tube[rows, 0], tube[rows, 1] = s, left
            for k in range(left):
                tube[rows, 2 + 2 * k], tube[rows, 3 + 2 * k] = parts[k, LEFT], parts[k, RIGHT]
            last[:] = parts
            rows += 1
            if s >= longest:
                break
        elif rows == start or ds <= grain.finest:
            break
        else:
            step = 0.25 * ds
        s, count = tube[rows - 1, 0], int(tube[rows - 1, 1])
        swiftest = max(abs(last[0, LOW]), abs(last[count - 1, HIGH]))
        ds = min(step, longest - s)
        if ds * swiftest > grain.turn:
            ds = grain.turn / swiftest
        drift(arm, plane, posture, s, ds, last, count, side, constraints, room, spins)
        count = _within(spins, count, low, high)
        s = longest if longest - s - ds < 1e-9 else s + ds
    return rows


@kernel
def _within(spins, count, low, high):  # type: ignore[no-untyped-def]
    """Cut a set of spins to what lies between two; returns how many intervals are left."""
    within = 0
    for k in range(count):
        a, b = spins[k]
        if a > b:  # ends that have crossed in a step
            a = b = 0.5 * (a + b)
        if a <= high and b >= low:
            spins[within, 0], spins[within, 1] = max(a, low), min(b, high)
            within += 1
    return within
