"""All motions of a grid of spins, joined from legs: thesis eq. 4.7 of K^3 motions for little more than K^2 (theory §3).

A leg is followed once, from the target outwards; the plunge runs it inwards, which turns every direction round and
changes neither reversals nor travel. So what a motion does is what its two legs do, and at the target those joints
reverse that set out the same way on both. Samples and steps are those of `kernels.sampled`, which judges motions one by
one and shares nothing with this but the limits.

Lengths in m, angles in rad.
"""

from __future__ import annotations

import numpy as np

from zerorev.kernels._jit import kernel
from zerorev.kernels.arm import solve_at
from zerorev.kernels.sampled import COS_JUMP, FULL, HIGH, LOW, ROWS, START, STILL, within

# what a leg does, a bit a joint: it sets out up, or down; it turns round; it is slow somewhere; it jumps
UP, DOWN, TURNS, SLOW, JUMPS = 0, 6, 12, 18, 24
SIX = 0b111111

# what is known of a leg: reversals inside it (-1: a pose is out of reach), word of the bits above, travel; and of each
# joint the angle at the outer end within (-pi, pi], the full turns that brought it there from the target's angle within
# (-pi, pi], and the least and greatest angle on the way
COUNT, WORD, TRAVEL, OUTER, WOUND, LEAST, MOST = 0, 1, 2, 3, 9, 15, 21
KNOWN = 27


@kernel
def cube(  # type: ignore[no-untyped-def]
    arm, plane, depth, fractions, least, lower, upper, first_point, weights, only, outer, target, score, reversals,
    branch, travel,
):  # fmt: skip
    """Thesis eq. 4.7 of all motions between outer spins and target spins, each on its best branch.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        depth: stroke [m].
        fractions: samples of a leg, from 0 at the target to 1 at its outer end, shape (L + 1,).
        least: see `sampled.judge`, shape (L + 1,).
        lower: least controller angles [rad], shape (6,).
        upper: greatest controller angles [rad], shape (6,).
        first_point: see `sampled.judge`.
        weights: cost of one reversal, and of one radian of travel.
        only: the one branch to examine, or -1 for all.
        outer: psi_s and psi_e [rad], shape (K,).
        target: psi_t [rad], shape (M,).
        score: out, shape (M, K, K): target, start, end.
        reversals: out, shape (M, K, K): of all joints; -1 where no branch can run the motion.
        branch: out, shape (M, K, K): the best, 0..7; -1 where none can run the motion.
        travel: out, shape (M, K, K): of all joints [rad]; NaN where no branch can run the motion.
    """
    legs = np.empty((outer.size, 4, KNOWN))
    cs, before, path = np.empty((6, 2)), np.empty((6, 2)), np.empty((ROWS, 6))
    for m in range(target.size):
        for k in range(outer.size):
            for posture in range(4):
                follow_leg(
                    arm, plane, depth, fractions, least, target[m], outer[k], posture, cs, before, legs[k, posture]
                )
        for s in range(outer.size):
            for e in range(outer.size):
                score[m, s, e], reversals[m, s, e], branch[m, s, e], travel[m, s, e] = best_pair(
                    arm, lower, upper, first_point, weights, only, legs[s], legs[e], path
                )


@kernel
def follow_leg(arm, plane, depth, fractions, least, psi_target, psi_outer, posture, cs, before, leg):  # type: ignore[no-untyped-def]
    """One leg of one posture from the target outwards, as model angles with sin(q5) >= 0.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        depth: stroke [m].
        fractions: see `cube`.
        least: see `cube`.
        psi_target: spin at the target [rad].
        psi_outer: spin at the outer end [rad].
        posture: 0..3.
        cs: room, shape (6, 2).
        before: room, shape (6, 2).
        leg: out, shape (KNOWN,); COUNT alone where a pose is out of reach.
    """
    steps = fractions.size - 1
    word, count = 0, 0
    went = np.zeros(6, dtype=np.int64)
    began, last = np.empty(6), np.empty(6)  # angle at the target, and where the joint last turned round
    leg[:] = 0.0
    leg[COUNT] = -1.0
    for n in range(steps + 1):
        x = fractions[n]
        if not solve_at(arm, plane, x * depth, psi_target + x * (psi_outer - psi_target), posture, cs)[0]:
            return
        for i in range(6):
            c, s = cs[i, 0], cs[i, 1] + 0.0  # no negative zero: the angle lies in (-pi, pi]
            if n == 0:
                began[i] = last[i] = leg[LEAST + i] = leg[MOST + i] = np.arctan2(s, c)
            else:
                c0, s0 = before[i, 0], before[i, 1]
                step = s * c0 - c * s0  # its sine
                if c * c0 + s * s0 < COS_JUMP:
                    word |= 1 << (JUMPS + i)
                if abs(step) < least[steps - n]:
                    word |= 1 << (SLOW + i)
                if abs(step) > STILL:
                    way = 1 if step > 0.0 else -1
                    if went[i] == 0:
                        word |= 1 << ((UP if way > 0 else DOWN) + i)
                    elif went[i] != way:
                        word |= 1 << (TURNS + i)
                        count += 1
                        _arrive(leg, last, i, c0, s0)
                    went[i] = way
                if step > 0.0 and s0 >= 0.0 and s < 0.0:
                    leg[WOUND + i] += FULL
                elif step < 0.0 and s0 < 0.0 and s >= 0.0:
                    leg[WOUND + i] -= FULL
            before[i, 0], before[i, 1] = c, s
    for i in range(6):
        _arrive(leg, last, i, before[i, 0], before[i, 1])
        leg[OUTER + i] = np.arctan2(before[i, 1], before[i, 0])
        if abs(last[i] - began[i]) < least[steps]:
            word |= 1 << (SLOW + i)
    leg[COUNT], leg[WORD] = count, word


@kernel
def _arrive(leg, last, i, c, s):  # type: ignore[no-untyped-def]
    """Joint i, having gone one way since the last such point, is now at the angle of this cosine and sine."""
    angle = np.arctan2(s, c) + leg[WOUND + i]
    leg[TRAVEL] += abs(angle - last[i])
    leg[LEAST + i], leg[MOST + i] = min(leg[LEAST + i], angle), max(leg[MOST + i], angle)
    last[i] = angle


@kernel
def best_pair(arm, lower, upper, first_point, weights, only, plunge, retract, path):  # type: ignore[no-untyped-def]
    """Two legs out of the same target joined to a motion, on the best branch (theory §3).

    Args:
        arm: `ArmGeometry`.
        lower: see `cube`.
        upper: see `cube`.
        first_point: see `cube`.
        weights: see `cube`.
        only: see `cube`.
        plunge: the legs of the four postures, shape (4, KNOWN).
        retract: the same.
        path: room, shape (ROWS, 6).

    Returns:
        score, reversals, branch and travel, see `cube`.
    """
    best, best_reversals, best_branch, best_travel = np.inf, -1, -1, np.nan
    for posture in range(4):
        a, b = plunge[posture], retract[posture]
        if only >= 0 and only // 2 != posture:
            continue
        if a[COUNT] < 0.0 or b[COUNT] < 0.0:
            if best > 1.0:
                best, best_reversals, best_branch, best_travel = 1.0, -1, -1, np.nan
            continue
        inward, outward = int(a[WORD]), int(b[WORD])
        both, either = inward & outward, inward | outward
        clash = (both >> UP | both >> DOWN) & SIX
        turned = either >> TURNS | clash
        slow, jumps = (either >> SLOW & ~turned & SIX) != 0, either >> JUMPS != 0
        count, travel = int(a[COUNT] + b[COUNT]) + _ones(clash), a[TRAVEL] + b[TRAVEL]
        cost = weights[0] * count + weights[1] * travel + slow + jumps
        if cost >= best:
            continue
        for i in range(6):  # as `sampled.follow` has it: counted from the first point
            wound = a[WOUND + i]
            path[START, i] = a[OUTER + i]
            path[LOW, i] = min(a[LEAST + i], b[LEAST + i]) - wound
            path[HIGH, i] = max(a[MOST + i], b[MOST + i]) - wound
        for branch in range(2 * posture, 2 * posture + 2):
            if only >= 0 and only != branch:
                continue
            fits = within(arm, path, branch, lower, upper, first_point)
            total = cost + (not fits)
            if total < best:
                best = total
                if fits and not slow and not jumps:
                    best_reversals, best_branch, best_travel = count, branch, travel
                else:
                    best_reversals, best_branch, best_travel = -1, -1, np.nan
    return best, best_reversals, best_branch, best_travel


@kernel
def _ones(bits):  # type: ignore[no-untyped-def]
    """How many of six bits are set."""
    count = 0
    for i in range(6):
        count += bits >> i & 1
    return count
