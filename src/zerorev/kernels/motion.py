"""A whole motion on one branch: where its joints turn round, and how far they go (theory §1, §5).

A motion is given by its breakpoints, between which the spin is linear in the stand-off: segments 0 to n - 2, those
before the corner are the plunge, on the way of which the tool may draw back a little. Places are a segment and the
fraction of it that is behind the tool.

Lengths in m, angles in rad, rates along the motion in rad/m; controller angles. No kernel raises.
"""

from __future__ import annotations

import numpy as np

from zerorev.kernels._jit import kernel, lean
from zerorev.kernels.arm import controller_angles, flip_sign, solve_at
from zerorev.kernels.field import BLOCK, PSI, ROOM, STANDOFF, THETA_PSI, THETA_S, fields

__all__ = ["FINER", "SAMPLES_PER_LEG", "SAMPLES_PER_SEGMENT", "follow", "turning_points"]

SAMPLES_PER_LEG, SAMPLES_PER_SEGMENT = 200, 32  # at least
FINER = 16  # into how many steps one is divided beside which a joint comes nearest to rest
TIMES_FINER = 3  # so often: a joint that turns round and back within 1/800,000 of a leg is seen
ROOT_POINTS, ROOT_TIMES = 33, 9  # each 32 times closer, from a sample's distance to the last bits
RISE = 1e-6  # relative: a joint of constant speed does not dip, regardless of its last digits


@lean
def rates_at(arm, plane, branch, standoff, psi, k, x, first, count, work, out):  # type: ignore[no-untyped-def]
    """Rates along the motion at some of its places.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        branch: 0..7.
        standoff: of the breakpoints, shape (n,).
        psi: spins there, shape (n,).
        k: segments, shape (N,).
        x: fractions of them, shape (N,).
        first: of the places that are wanted.
        count: how many from there on.
        work: room for `fields`.
        out: out, shape (N, 6); NaN out of reach and where the arm is singular.
    """
    five = flip_sign(arm, branch)
    for start in range(first, first + count, BLOCK):
        size = min(BLOCK, first + count - start)
        for j in range(size):
            a, share = k[start + j], x[start + j]
            work[STANDOFF * BLOCK + j] = standoff[a] + share * (standoff[a + 1] - standoff[a])
            work[PSI * BLOCK + j] = psi[a] + share * (psi[a + 1] - psi[a])
        fields(arm, plane, branch // 2, size, work)
        for j in range(size):
            a = k[start + j]
            slope = (psi[a + 1] - psi[a]) / (standoff[a + 1] - standoff[a])
            along = -1.0 if standoff[a + 1] < standoff[a] else 1.0
            for i in range(6):
                rate = along * (work[(THETA_S + i) * BLOCK + j] + slope * work[(THETA_PSI + i) * BLOCK + j])
                out[start + j, i] = five * rate if i == 4 else rate


@kernel
def spread(standoff, corner, per_leg, least):  # type: ignore[no-untyped-def]
    """How many samples each segment gets: its share of those of its leg, or the least number; shape (n - 1,)."""
    counts = np.empty(standoff.shape[0] - 1, dtype=np.int64)
    for a in range(counts.shape[0]):
        leg = standoff[0] - standoff[corner] if a < corner else standoff[-1] - standoff[corner]
        counts[a] = max(np.int64(np.ceil(per_leg * abs(standoff[a + 1] - standoff[a]) / leg)), least)
    return counts


@lean
def dips(r, n, same_before, same_after, nil):  # type: ignore[no-untyped-def]
    """Whether any joint is slower at a sample than at both of its neighbours on the segment; NaN is not a neighbour."""
    for i in range(6):
        speed = abs(r[n, i])
        before = abs(r[n - 1, i]) if same_before else np.inf
        after = abs(r[n + 1, i]) if same_after else np.inf
        if speed > nil and speed <= before and speed <= after and max(before, after) - speed > RISE * speed:
            return True
    return False


@kernel
def turning_points(arm, plane, branch, standoff, psi, corner, nil, slowest, turns):  # type: ignore[no-untyped-def]
    """Where joints turn round, and how slow they get.

    Each segment is sampled. Where a joint comes nearest to rest at a sample, the steps on both sides of it are divided
    into finer ones, again and again, so that a joint that turns round and back between two samples is not missed; a
    change of sign is then closed in on.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        branch: 0..7.
        standoff: of the breakpoints, shape (n,).
        psi: spins there, shape (n,).
        corner: index of the breakpoint at which the plunge ends.
        nil: up to which a joint does not move [rad/m].
        slowest: out, shape (6,): least |rate|; inf for a joint that is NaN throughout.
        turns: out, shape (M, 3): joint 1 to 6, segment and fraction of each reversal, joint after joint; the fraction
            is 0 where the joint turns round at the breakpoint itself. What goes beyond M rows is left out.

    Returns:
        how many reversals there are.
    """
    work, counts = np.empty(ROOM), spread(standoff, corner, SAMPLES_PER_LEG, SAMPLES_PER_SEGMENT)
    size = 0
    for a in range(counts.shape[0]):
        size += counts[a]
    k, x, r = np.empty(size, dtype=np.int64), np.empty(size), np.empty((size, 6))
    n = 0
    for a in range(counts.shape[0]):
        for j in range(counts[a]):
            k[n], x[n] = a, j / (counts[a] - 1.0)
            n += 1
    rates_at(arm, plane, branch, standoff, psi, k, x, 0, size, work, r)
    for _ in range(TIMES_FINER):
        finer = np.zeros(size, dtype=np.bool_)  # whether the step behind a sample is to be divided
        marked = 0
        for n in range(size):
            same_before, same_after = n > 0 and k[n - 1] == k[n], n < size - 1 and k[n + 1] == k[n]
            if dips(r, n, same_before, same_after, nil):
                if same_before and not finer[n - 1]:
                    finer[n - 1] = True
                    marked += 1
                if same_after and not finer[n]:
                    finer[n] = True
                    marked += 1
        if marked == 0:
            break
        grown = size + marked * (FINER - 1)
        more_k, more_x, more_r = np.empty(grown, dtype=np.int64), np.empty(grown), np.empty((grown, 6))
        m = 0
        for n in range(size):
            more_k[m], more_x[m], more_r[m] = k[n], x[n], r[n]
            m += 1
            if finer[n]:
                for j in range(1, FINER):
                    more_k[m + j - 1], more_x[m + j - 1] = k[n], x[n] + j * (x[n + 1] - x[n]) / FINER
                rates_at(arm, plane, branch, standoff, psi, more_k, more_x, m, FINER - 1, work, more_r)
                m += FINER - 1
        size, k, x, r = grown, more_k, more_x, more_r

    found = 0
    near_k, near_x, near_r = np.empty(ROOT_POINTS, dtype=np.int64), np.empty(ROOT_POINTS), np.empty((ROOT_POINTS, 6))
    for i in range(6):
        slowest[i], last = np.inf, -1
        for n in range(size):
            rate = r[n, i]
            # NaN, a path that touches a singularity, tells no direction either
            if abs(rate) < slowest[i]:
                slowest[i] = abs(rate)
            if not abs(rate) > nil:
                continue
            if last >= 0 and rate * r[last, i] < 0.0:
                place = 0.0
                # a segment's first sample turns at the breakpoint itself, any other since the joint last moved
                if k[n - 1] == k[n]:
                    low, high = (x[last] if k[last] == k[n] else 0.0), x[n]
                    for _ in range(ROOT_TIMES):
                        for j in range(ROOT_POINTS):
                            near_k[j], near_x[j] = k[n], low + j * (high - low) / (ROOT_POINTS - 1)
                        near_x[ROOT_POINTS - 1] = high
                        rates_at(arm, plane, branch, standoff, psi, near_k, near_x, 0, ROOT_POINTS, work, near_r)
                        j = 1
                        while j < ROOT_POINTS - 1 and not near_r[j, i] * rate > 0.0:
                            j += 1
                        low, high = near_x[j - 1], near_x[j]
                    place = 0.5 * (low + high)
                if found < turns.shape[0]:
                    turns[found, 0], turns[found, 1], turns[found, 2] = i + 1.0, k[n], place
                found += 1
            last = n
    return found


@kernel
def follow(arm, plane, branch, standoff, psi, corner, samples, turns, jump, joints, low, high, moved):  # type: ignore[no-untyped-def]
    """Follow the joints along a motion, continuous from the first point on.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        branch: 0..7.
        standoff: of the breakpoints, shape (n,).
        psi: spins there, shape (n,).
        corner: index of the breakpoint at which the plunge ends.
        samples: how many steps, about.
        turns: segment and fraction of further points, in order of motion, shape (M, 2).
        jump: step of a joint between two points that no motion makes [rad].
        joints: out, shape (n, 6): angles at the breakpoints, those at the first within (-pi, pi].
        low: out, shape (6,): least angle.
        high: out, shape (6,): greatest angle.
        moved: out, shape (2, 6): angle moved on the plunge and on the retract.

    Returns:
        whether all points can be reached without a jump; if not, what is written means nothing.
    """
    length = standoff[0] + standoff[-1] - 2.0 * standoff[corner]
    cs, now, before, sample = np.empty((6, 2)), np.empty(6), np.empty(6), np.empty(6)
    low[:], high[:], moved[:] = np.inf, -np.inf, 0.0
    last, m, begun = standoff.shape[0] - 2, 0, False
    for a in range(last + 1):
        step_s, step_psi = standoff[a + 1] - standoff[a], psi[a + 1] - psi[a]
        count = max(np.int64(1), np.int64(np.ceil(samples * abs(step_s) / length)))
        points = count + 1 if a == last else count
        j = 0
        while True:
            x = j / count if j < points else 2.0
            further = False
            if m < turns.shape[0] and turns[m, 0] == a and turns[m, 1] < x:
                x, further = turns[m, 1], True
                m += 1
            elif j == points:
                break
            else:
                j += 1
            at = standoff[a] + x * step_s if x < 1.0 else standoff[a + 1]
            spin = psi[a] + x * step_psi if x < 1.0 else psi[a + 1]
            if not solve_at(arm, plane, at, spin, branch // 2, cs)[0]:
                return False
            controller_angles(arm, cs, branch % 2 == 1, now)
            # the step to a segment's first point is still of the segment before
            leg = 0 if (a if x > 0.0 else a - 1) < corner else 1
            for i in range(6):
                if begun:
                    now[i] -= 2.0 * np.pi * np.rint((now[i] - before[i]) / (2.0 * np.pi))
                    step = abs(now[i] - before[i])
                    # that there is a point more between two samples makes no jump less of one
                    if step > jump or (not further and abs(now[i] - sample[i]) > jump):
                        return False
                    moved[leg, i] += step
                before[i] = now[i]
                if not further:
                    sample[i] = now[i]
                low[i], high[i] = min(low[i], now[i]), max(high[i], now[i])
            begun = True
            if x == 0.0:
                joints[a] = now
            elif x == 1.0:
                joints[a + 1] = now
    return True
