"""Viable sets: how deep free legs get, from any spin at the target (theory §4).

Carried back inwards from a depth, within the reachable sets (`kernels.reach`), sets of spins become *viable*: from
their spins, and from no others, a leg gets to that depth. So two legs of a depth, one for the signs sigma and one for
their opposites, exist if and only if their viable sets meet at the target. As made here the sets are estimates, see
`kernels.reach`.

Sets and tubes are those of `kernels.reach`. Lengths in m, angles in rad, slopes outwards in rad/m. No kernel raises.
"""

from __future__ import annotations

import numpy as np

from zerorev.kernels._jit import kernel
from zerorev.kernels.reach import KEPT, carry, cut, joined, reachable, within

MISSED = 0.5  # of the distance between two spins that are examined: by which the way in may miss the way out


@kernel
def common(one, count, other, other_count, missed, out):  # type: ignore[no-untyped-def]
    """What two sets of spins share, those that miss each other by a little included; returns how many intervals."""
    found, n, m = 0, 0, 0
    while n < count and m < other_count and found < KEPT:
        a, b = max(one[n, 0], other[m, 0]), min(one[n, 1], other[m, 1])
        if a <= b:
            out[found] = a, b
            found += 1
        elif a <= b + missed:
            # of thin sets, which rounding keeps apart: the nearest spin of the other
            out[found] = min(max(one[n, 0], other[m, 0]), other[m, 1])
            found += 1
        if one[n, 1] < other[m, 1]:
            n += 1
        else:
            m += 1
    return found


@kernel
def viable(arm, plane, branch, side, constraints, limited, grain, depth, room, tube, rows, out):  # type: ignore[no-untyped-def]
    """The viable sets of a depth, within a reachable tube.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        branch: 0..7.
        side: signs of the outward rates on the unflipped wrist, shape (6,).
        constraints: `Constraints`.
        limited: whether joint limits are heeded.
        grain: `Grain`.
        depth: [m], no more than the tube gets to.
        room: what `workspaces` returns.
        tube: stand-offs, counts and sets as left by `reachable`.
        rows: how many it has.
        out: out, stand-offs, counts and sets of the viable tube; the depth is its last row.

    Returns:
        how many rows it has; 0 where no leg sets out at the target.
    """
    standoff, counts, sets = tube
    spins = np.empty((KEPT, 2))
    last = rows - 1
    while last > 0 and standoff[last - 1] >= depth:
        last -= 1
    # out to the depth itself
    s, count = standoff[last - 1], counts[last - 1]
    spins[:count] = sets[last - 1, :count]
    carry(arm, plane, branch // 2, side, constraints, s, depth - s, grain.turn, spins, count, room)
    if constraints.psi_bound > 0.0:
        count = within(spins, count, -constraints.psi_bound, constraints.psi_bound)
    count = cut(arm, plane, branch, side, constraints, limited, depth, grain.between, spins, count, room)
    s = depth
    out[0][last], out[1][last] = depth, count
    out[2][last, :count] = spins[:count]
    for r in range(last - 1, -1, -1):
        if count == 0:
            return 0
        carry(arm, plane, branch // 2, side, constraints, s, standoff[r] - s, grain.turn, spins, count, room)
        s = standoff[r]
        count = common(spins, joined(spins, count), sets[r], counts[r], MISSED * grain.between, out[2][r])
        out[0][r], out[1][r] = s, count
        spins[:count] = out[2][r, :count]
    return last + 1 if count > 0 else 0


@kernel
def pair_bound(arm, plane, branch, sense, constraints, limited, grain, low, high, enough, longest, room, tubes, rows):  # type: ignore[no-untyped-def]
    """How deep any two legs out of an interval of spins at the target get, at most: where the first tube ends.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        branch: 0..7.
        sense: signs of the outward rates of the first leg on the unflipped wrist, shape (6,); the second leg has the
            opposite ones.
        constraints: `Constraints`.
        limited: whether joint limits are heeded.
        grain: `Grain`.
        low: least spin at the target [rad].
        high: greatest.
        enough: a depth that is known already: a pair that gets no deeper is followed no farther [m].
        longest: where to stop [m].
        room: what `workspaces` returns.
        tubes: out, both tubes: stand-offs (2, R), counts (2, R), sets (2, R, KEPT, 2).
        rows: out, shape (2,): of each.

    Returns:
        the depth [m].
    """
    standoff, counts, sets = tubes
    for k in range(2):
        standoff[k, 0], counts[k, 0], sets[k, 0, 0, 0], sets[k, 0, 0, 1] = 0.0, 1, low, high
    rows[:] = 1
    # a stretch at a time, so that no leg is followed much farther than the other gets
    stretch = min(longest, 4.0 * grain.step)
    while True:
        depth = stretch
        for k in range(2):
            rows[k] = reachable(
                arm, plane, branch, (1.0 - 2.0 * k) * sense, constraints, limited, grain, depth, room, standoff[k],
                counts[k], sets[k], rows[k],
            )  # fmt: skip
            if rows[k] == 0:
                return 0.0
            depth = min(depth, standoff[k, rows[k] - 1])
            if depth < min(stretch, enough):
                return depth
        if depth < stretch or stretch >= longest:
            return depth
        stretch = min(longest, 2.0 * stretch)


@kernel
def pair_meets(  # type: ignore[no-untyped-def]
    arm, plane, branch, sense, constraints, limited, grain, depth, room, tubes, rows, out, out_rows, overlap
):
    """Where two legs of a depth set out at the target.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        branch: 0..7.
        sense: see `pair_bound`.
        constraints: `Constraints`.
        limited: whether joint limits are heeded.
        grain: `Grain`.
        depth: [m], no more than `pair_bound` has found.
        room: what `workspaces` returns.
        tubes: as left by `pair_bound`.
        rows: of each, likewise.
        out: out, both viable tubes.
        out_rows: out, shape (2,): of each.
        overlap: out, shape (2,): the widest interval of spins at the target from which both legs set out [rad].

    Returns:
        whether there is one.
    """
    standoff, counts, sets = tubes
    for k in range(2):
        out_rows[k] = viable(
            arm, plane, branch, (1.0 - 2.0 * k) * sense, constraints, limited, grain, depth, room,
            (standoff[k], counts[k], sets[k]), rows[k], (out[0][k], out[1][k], out[2][k]),
        )  # fmt: skip
        if out_rows[k] == 0:
            return False
    shared = np.empty((KEPT, 2))
    count = common(out[2][0, 0], out[1][0, 0], out[2][1, 0], out[1][1, 0], 0.0, shared)
    widest = -1.0
    for n in range(count):
        if shared[n, 1] - shared[n, 0] > widest:
            widest = shared[n, 1] - shared[n, 0]
            overlap[0], overlap[1] = shared[n]
    return count > 0


@kernel
def pair_depth(  # type: ignore[no-untyped-def]
    arm,
    plane,
    branch,
    sense,
    constraints,
    limited,
    grain,
    least,
    most,
    close,
    room,
    tubes,
    rows,
    out,
    out_rows,
    overlap,
):
    """How deep two legs get, by bisection with `pair_meets`.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        branch: 0..7.
        sense: see `pair_bound`.
        constraints: `Constraints`.
        limited: whether joint limits are heeded.
        grain: `Grain`.
        least: a depth below which nothing is asked for [m].
        most: what `pair_bound` has found [m].
        close: relative, to which it is closed in on.
        room: what `workspaces` returns.
        tubes: as left by `pair_bound`.
        rows: of each, likewise.
        out: out, both viable tubes of that depth.
        out_rows: out, shape (2,).
        overlap: out, shape (2,), see `pair_meets`.

    Returns:
        the depth [m]; 0 where they do not get to `least`.
    """
    low, high, trial = 0.0, most, least
    while True:
        if pair_meets(
            arm, plane, branch, sense, constraints, limited, grain, trial, room, tubes, rows, out, out_rows, overlap
        ):
            low = trial
        else:
            high = trial
        if low == 0.0 or high - low <= close * high:
            break
        trial = most if trial == least else 0.5 * (low + high)
    if 0.0 < low < trial:
        pair_meets(
            arm, plane, branch, sense, constraints, limited, grain, low, room, tubes, rows, out, out_rows, overlap
        )
    return low
