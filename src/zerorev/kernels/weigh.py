"""What a leg costs and how much margin it has, from as few points of the rate fields as suffice.

`kernels.legs` follows a leg joint by joint; here the joints are not kept apart, only the worst of them and the sum of
their motion: that is all that tells one slope from another while nothing turns round inside the leg.

Lengths in m, angles in rad, rates outwards in rad/m. No kernel raises.
`constraints` is a `layout.Constraints` throughout.
"""

from __future__ import annotations

import numpy as np

from zerorev.kernels._jit import lean
from zerorev.kernels.arm import flip_sign
from zerorev.kernels.field import BLOCK, MOTION, PSI, SIGNS, SLOPE, STANDOFF, THETA_PSI, THETA_S, WORST, fields
from zerorev.kernels.legs import NIL, place

THETA_PSI_ON = (THETA_PSI - THETA_S) * BLOCK  # from a joint's theta_s to its theta_psi
SIEVE = 4  # points on a leg that is examined first
SIEVE_ERROR = 0.02  # of the travel estimated from those


@lean
def lay_leg(arm, plane, branch, psi_t, slope, length, demands, constraints, nodes, work):  # type: ignore[no-untyped-def]
    """The rates of a leg in the workspace: each joint's, and at each node the worst of all and the motion of all.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        branch: 0..7.
        psi_t: spin at the target [rad].
        slope: twist rate [rad/m].
        length: of the leg [m].
        demands: (sense, keep, at_target), see `judge_leg`.
        constraints: `Constraints`.
        nodes: points on the leg, at most BLOCK.
        work: room for `fields`; NaN in the row MOTION where a node is out of reach.
    """
    sense, keep, _ = demands
    place(psi_t, slope, length / (nodes - 1), 0, nodes, work)
    fields(arm, plane, branch // 2, nodes, work)
    for n in range(nodes):
        work[SLOPE * BLOCK + n] = slope
        work[WORST * BLOCK + n] = np.inf
        work[MOTION * BLOCK + n] = 0.0
    five = flip_sign(arm, branch)
    for i in range(6):
        sign, spare = sense[i], constraints.min_rate if constraints.mean_rule else 0.0
        if i == 4:
            sign *= five
        at, last = (THETA_S + i) * BLOCK, nodes - 1
        outset = work[at] + slope * work[at + THETA_PSI_ON]
        if not keep[i]:
            # it may turn at the target, so it goes the way in which it begins
            sign = 1.0 if outset > 0.0 else -1.0
            spare = np.inf if constraints.turn_inside else constraints.min_rate
        middle = work[at + last // 2] + slope * work[at + last // 2 + THETA_PSI_ON]
        end = work[at + last] + slope * work[at + last + THETA_PSI_ON]
        if max(abs(outset), abs(middle), abs(end)) <= NIL:
            spare = np.inf  # a joint that does not move does not reverse
        work[SIGNS * BLOCK + i], work[SIGNS * BLOCK + 6 + i] = sign, spare
        _fold(work, i, sign, spare, -1.0, nodes)


@lean
def weigh_leg(arm, plane, branch, psi_t, slope, demands, constraints, nodes, work):  # type: ignore[no-untyped-def]
    """Margin, slack and travel of a leg: what `judge_leg` says of `trace_leg`, at a tenth of the cost.

    The slack is that of the outer end, where a leg whose joints all keep their directions comes nearest to a limit.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        branch: 0..7.
        psi_t: spin at the target [rad].
        slope: twist rate [rad/m].
        demands: (sense, keep, at_target), see `judge_leg`.
        constraints: `Constraints`; limits that are infinite are not examined.
        nodes: points on the leg, at most BLOCK.
        work: room for `fields`.

    Returns:
        margin: see `judge_leg`; -inf where the leg cannot be run.
        slack: least distance to a limit [rad].
        travel: sum of the joints' angles moved [rad].
    """
    keep, at_target = demands[1], demands[2]
    step = constraints.depth / (nodes - 1)
    lay_leg(arm, plane, branch, psi_t, slope, constraints.depth, demands, constraints, nodes, work)
    five = flip_sign(arm, branch)
    worst, motion = np.inf, 0.0
    for n in range(nodes):
        motion += work[MOTION * BLOCK + n]
        worst = min(worst, work[WORST * BLOCK + n])
    if np.isnan(motion):
        return -np.inf, -np.inf, np.inf
    # the lowest point lies at the lowest node or next to it, but another joint may dip deeper elsewhere between two
    for n in range(1, nodes - 1):
        here = work[WORST * BLOCK + n]
        dips = here <= work[WORST * BLOCK + n - 1] and here <= work[WORST * BLOCK + n + 1]
        if dips or n == 1 or n == nodes - 2:
            worst = min(worst, between_nodes(work, n))
    slack = np.inf
    if constraints.mean_rule or constraints.lower[0] > -np.inf:
        for i in range(6):
            moved = _sum_ends(work, THETA_S + i, nodes)
            for n in range(nodes):
                moved += work[(THETA_S + i) * BLOCK + n]
            if constraints.mean_rule and keep[i] and work[SIGNS * BLOCK + 6 + i] < np.inf:
                worst = min(worst, work[SIGNS * BLOCK + i] * moved / (nodes - 1))
            end = at_target[i] + step * moved * (five if i == 4 else 1.0)
            slack = min(slack, end - constraints.lower[i], constraints.upper[i] - end)
    return worst, slack, step * (motion + _sum_ends(work, MOTION, nodes))


@lean
def _fold(work, i, sign, spare, nil, count):  # type: ignore[no-untyped-def]
    """Turn the fields of a joint into its rate, and take that into the worst and the motion of all at each point."""
    for n in range(count):
        rate = work[(THETA_S + i) * BLOCK + n] + work[SLOPE * BLOCK + n] * work[(THETA_PSI + i) * BLOCK + n]
        work[(THETA_S + i) * BLOCK + n] = rate
        worst, moved = work[WORST * BLOCK + n], abs(rate)
        signed = np.inf if moved <= nil else sign * rate + spare
        work[WORST * BLOCK + n] = signed if signed < worst else worst
        work[MOTION * BLOCK + n] += moved


@lean
def between_nodes(work, c):  # type: ignore[no-untyped-def]
    """The least of the parabolas through three nodes of each joint, the middle one of them numbered c."""
    least = np.inf
    for i in range(6):
        sign, spare = work[SIGNS * BLOCK + i], work[SIGNS * BLOCK + 6 + i]
        at = (THETA_S + i) * BLOCK + c
        before, here, after = sign * work[at - 1], sign * work[at], sign * work[at + 1]
        tilt, bend = after - before, after - 2.0 * here + before
        if bend > 0.0 and abs(tilt) < 2.0 * bend:
            least = min(least, here - tilt * tilt / (8.0 * bend) + spare)
    return least


@lean
def _sum_ends(work, row, nodes):  # type: ignore[no-untyped-def]
    """What the ends add to a plain sum over the nodes, so that it integrates to third order (Gregory)."""
    a, z = row * BLOCK, row * BLOCK + nodes - 1
    return (work[a + 1] + work[z - 1]) / 6.0 - (work[a] + work[z]) * 0.625 - (work[a + 2] + work[z - 2]) / 24.0


@lean
def sift(arm, plane, branch, psi_t, slopes, count, sense, keep, constraints, work, ceiling, travel, ends):  # type: ignore[no-untyped-def]
    """What the margin of each of many legs is at most, and about its travel, from a few points of each.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        branch: 0..7.
        psi_t: spin at the target [rad].
        slopes: twist rates [rad/m].
        count: how many slopes.
        sense: see `judge_leg`.
        keep: see `judge_leg`.
        constraints: `Constraints`.
        work: room for `fields`.
        ceiling: out: [rad/m], -inf where a leg cannot be run.
        travel: out: [rad], inf where a leg cannot be run.
        ends: out, shape (count, 6): about the angles at the outer end, relative to the target [rad].
    """
    at_once = BLOCK // SIEVE
    step, five = constraints.depth / (SIEVE - 1), flip_sign(arm, branch)
    for first in range(0, count, at_once):
        legs = min(at_once, count - first)
        # node by node, all legs in each; the target, where all of them set out, last and only once
        outset = (SIEVE - 1) * legs
        for k in range(1, SIEVE):
            s = k * step
            for j in range(legs):
                work[STANDOFF * BLOCK + (k - 1) * legs + j] = s
                work[PSI * BLOCK + (k - 1) * legs + j] = psi_t + slopes[first + j] * s
        work[STANDOFF * BLOCK + outset], work[PSI * BLOCK + outset] = 0.0, psi_t
        fields(arm, plane, branch // 2, outset + 1, work)
        for row in range(THETA_S, THETA_PSI + 6):
            there = work[row * BLOCK + outset]
            for j in range(1, legs):
                work[row * BLOCK + outset + j] = there
        for k in range(SIEVE):
            for j in range(legs):
                work[SLOPE * BLOCK + k * legs + j] = slopes[first + j]
        for n in range(SIEVE * legs):
            work[WORST * BLOCK + n] = np.inf
            work[MOTION * BLOCK + n] = 0.0
        for i in range(6):
            spare = constraints.min_rate if constraints.mean_rule else 0.0
            # what moves so little may be a joint that does not move, which does not reverse: a ceiling is a ceiling
            _fold(work, i, sense[i] * (five if i == 4 else 1.0), spare if keep[i] else np.inf, NIL, SIEVE * legs)
        for j in range(legs):
            worst = WORST * BLOCK + j
            moved = _mean_of_four(work, MOTION * BLOCK + j, legs)
            if np.isnan(moved):
                ceiling[first + j], travel[first + j] = -np.inf, np.inf
            else:
                ceiling[first + j] = min(
                    min(work[worst + outset], work[worst]), min(work[worst + legs], work[worst + 2 * legs])
                )
                travel[first + j] = constraints.depth * moved
            for i in range(6):
                end = constraints.depth * _mean_of_four(work, (THETA_S + i) * BLOCK + j, legs)
                ends[first + j, i] = end * five if i == 4 else end


@lean
def _mean_of_four(work, at, legs):  # type: ignore[no-untyped-def]
    """Mean over a leg of what four even points of it have, the one at the target last: Simpson's 3/8 rule."""
    return (work[at + 3 * legs] + 3.0 * (work[at] + work[at + legs]) + work[at + 2 * legs]) / 8.0
