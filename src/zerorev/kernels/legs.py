"""Legs out of a target, and the best one on a side of the critical rates (theory §2, §3).

A leg is a straight line in the twist plane, from the target outwards: psi(s) = psi_t + u s. Joint i keeps its direction
through the target if and only if its outward rates on the two legs have opposite signs, so at a given psi_t one leg has
to lie above the critical rates of all joints that must not reverse, the other below them, and each can be looked for on
its own: along the one line of slopes u on its side.

Lengths in m, angles in rad, rates outwards in rad/m; controller angles. No kernel raises.
`asked` is a `zerorev.search.problem.Asked` throughout.
"""

from __future__ import annotations

import numpy as np

from zerorev.kernels._jit import kernel
from zerorev.kernels.arm import controller_angles, flip_sign, twist_field
from zerorev.kernels.field import BLOCK, MOTION, PSI, SIGNS, SLOPE, STANDOFF, THETA_PSI, THETA_S, WORST, fields

# rows of a traced leg, one column a joint
LEAST_RATE, GREATEST_RATE, LEAST_ANGLE, GREATEST_ANGLE, END_ANGLE, MOVED, TURNS, TARGET_RATE = range(8)
ROWS = 8
# what makes one leg better than another
TRAVEL, GREATEST_MARGIN, PLUNGE_ROTATION = range(3)

NIL = np.deg2rad(1e-6)  # [rad/m] 1e-9 deg/mm: below it a joint does not move
GEOMETRIC_SLOPES = 12
SLOPES_BETWEEN = 4
THETA_PSI_ON = (THETA_PSI - THETA_S) * BLOCK  # from a joint's theta_s to its theta_psi
MAX_SLOPES = 1 + GEOMETRIC_SLOPES + 6 * SLOPES_BETWEEN
ROOT_STEPS = 24
ROOT_TOLERANCE = 1e-9
SIEVE = 4  # points on a leg that is first looked at
SIEVE_ERROR = 0.02  # of the travel told from those
GOLDEN_STEPS = 20
GOLDEN = (np.sqrt(5.0) - 1.0) / 2.0


@kernel
def trace_leg(arm, plane, branch, psi_t, slope, depth, nodes, work, leg):  # type: ignore[no-untyped-def]
    """Follow a leg from the target outwards.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        branch: 0..7.
        psi_t: spin at the target [rad].
        slope: twist rate u [rad/m].
        depth: length of the leg [m].
        nodes: how many points are looked at, both ends among them.
        work: room for `fields`.
        leg: out, shape (ROWS, 6): least and greatest outward rate; least and greatest angle, and the one at the outer
            end, relative to the target; angle moved; how often the joint turns round; outward rate at the target.

    Returns:
        whether all of the leg can be reached.
    """
    earlier, before, direction = np.zeros(6), np.zeros(6), np.zeros(6)
    five = flip_sign(arm, branch)
    step = depth / (nodes - 1)
    for start in range(0, nodes, BLOCK):
        count = min(BLOCK, nodes - start)
        _place(psi_t, slope, step, start, count, work)
        fields(arm, plane, branch // 2, count, work)
        for k in range(count):
            n = start + k
            for i in range(6):
                rate = work[(THETA_S + i) * BLOCK + k] + slope * work[(THETA_PSI + i) * BLOCK + k]
                if i == 4:
                    rate *= five
                if np.isnan(rate):
                    return False
                _extend(leg, i, n, n == nodes - 1, step, rate, earlier[i], before[i])
                earlier[i], before[i] = before[i], rate
                if abs(rate) > NIL:
                    if rate * direction[i] < 0.0:
                        leg[TURNS, i] += 1.0
                    direction[i] = 1.0 if rate > 0.0 else -1.0
    # the outer end is known exactly up to whole turns, and the sum over the nodes knows those
    cs = np.empty((6, 2))
    theta_s, theta_psi, first, last = np.empty(6), np.empty(6), np.empty(6), np.empty(6)
    twist_field(arm, plane, 0.0, psi_t, branch // 2, cs, theta_s, theta_psi)
    controller_angles(arm, cs, branch % 2 == 1, first)
    if not twist_field(arm, plane, depth, psi_t + slope * depth, branch // 2, cs, theta_s, theta_psi):
        return False
    controller_angles(arm, cs, branch % 2 == 1, last)
    for i in range(6):
        exact = last[i] - first[i]
        exact += 2.0 * np.pi * np.rint((leg[END_ANGLE, i] - exact) / (2.0 * np.pi))
        leg[END_ANGLE, i] = exact
        leg[LEAST_ANGLE, i] = min(leg[LEAST_ANGLE, i], exact)
        leg[GREATEST_ANGLE, i] = max(leg[GREATEST_ANGLE, i], exact)
    return True


@kernel
def _place(psi_t, slope, step, start, count, work):  # type: ignore[no-untyped-def]
    """Points of a leg, from the one numbered `start` on, into the workspace."""
    for k in range(count):
        s = (start + k) * step
        work[STANDOFF * BLOCK + k] = s
        work[PSI * BLOCK + k] = psi_t + slope * s


@kernel
def _extend(leg, i, n, is_last, step, rate, earlier, before):  # type: ignore[no-untyped-def]
    """Take the n-th point of a joint into a traced leg; the two points before it are known."""
    if n == 0:
        leg[LEAST_RATE, i] = leg[GREATEST_RATE, i] = rate
        leg[LEAST_ANGLE:, i] = 0.0
        leg[TARGET_RATE, i] = rate
        return
    leg[LEAST_RATE, i] = min(leg[LEAST_RATE, i], rate)
    leg[GREATEST_RATE, i] = max(leg[GREATEST_RATE, i], rate)
    tilt, bend = rate - earlier, rate - 2.0 * before + earlier
    reach = abs(bend)
    if (n == 2 and tilt * bend > 0.0) or (is_last and tilt * bend < 0.0):
        reach *= 2.0  # an end of the leg has no nodes on its other side
    if n > 1 and abs(tilt) < reach:
        # an extreme lies between the nodes: take it from the parabola through three of them
        extreme = before - tilt * tilt / (8.0 * bend)
        leg[LEAST_RATE, i] = min(leg[LEAST_RATE, i], extreme)
        leg[GREATEST_RATE, i] = max(leg[GREATEST_RATE, i], extreme)
        if extreme * before < 0.0 and rate * before > 0.0 and earlier * before > 0.0:
            leg[TURNS, i] += 2.0
    moved = 0.5 * step * (before + rate)
    leg[MOVED, i] += abs(moved)
    leg[END_ANGLE, i] += moved
    leg[LEAST_ANGLE, i] = min(leg[LEAST_ANGLE, i], leg[END_ANGLE, i])
    leg[GREATEST_ANGLE, i] = max(leg[GREATEST_ANGLE, i], leg[END_ANGLE, i])


@kernel
def joint_travel(leg, i):  # type: ignore[no-untyped-def]
    """Angle moved by a joint on a traced leg [rad]: exact where it does not turn round, from its extremes if once."""
    if leg[TURNS, i] == 0.0:
        return abs(leg[END_ANGLE, i])
    if leg[TURNS, i] == 1.0:
        return 2.0 * (leg[GREATEST_ANGLE, i] - leg[LEAST_ANGLE, i]) - abs(leg[END_ANGLE, i])
    return leg[MOVED, i]


@kernel
def judge_leg(leg, sense, keep, at_target, depth, asked):  # type: ignore[no-untyped-def]
    """Margin, slack to the limits, and travel of a traced leg.

    Args:
        leg: from `trace_leg`, shape (ROWS, 6).
        sense: wanted sign of each joint's outward rate, shape (6,).
        keep: whether a joint must keep its direction, shape (6,); the others may turn at the target, but not within a
            leg unless `asked.turn_inside`.
        at_target: joint angles at the target with their turns, shape (6,).
        depth: length of the leg [m].
        asked: `Asked`.

    Returns:
        margin: least rate in the wanted sense over the joints to keep [rad/m], by the rule asked for.
        slack: least distance to a limit [rad].
        travel: sum of the joints' angles moved [rad].
    """
    margin, slack, travel = np.inf, np.inf, 0.0
    for i in range(6):
        least, greatest = leg[LEAST_RATE, i], leg[GREATEST_RATE, i]
        end = leg[END_ANGLE, i]
        travel += joint_travel(leg, i)
        slack = min(slack, at_target[i] + leg[LEAST_ANGLE, i] - asked.lower[i])
        slack = min(slack, asked.upper[i] - at_target[i] - leg[GREATEST_ANGLE, i])
        if least >= -NIL and greatest <= NIL:
            continue  # a joint that does not move does not reverse
        if keep[i]:
            pointwise = least if sense[i] > 0.0 else -greatest
            if asked.mean_rule:
                # the mean has to reach the threshold, and no point may turn round
                margin = min(margin, sense[i] * end / depth, pointwise + asked.min_rate)
            else:
                margin = min(margin, pointwise)
        elif not asked.turn_inside:
            margin = min(margin, max(least, -greatest) + asked.min_rate)
    return margin, slack, travel


@kernel
def slope_candidates(kappa, keep, side, psi_t, asked, out):  # type: ignore[no-untyped-def]
    """Slopes worth a look on one side of the critical rates of the joints to keep.

    Args:
        kappa: critical rates at the target [rad/m], shape (6,).
        keep: whether a joint must keep its direction, shape (6,).
        side: 1 above, -1 below.
        psi_t: spin at the target [rad].
        asked: `Asked`, for the steepest slope and the bound on the spin.
        out: out, shape (MAX_SLOPES,): slopes in order away from the critical rates, the outermost of which, or the
            bound, is the first.

    Returns:
        how many slopes were written.
    """
    # slopes are measured along the side: side * slope, from `nearest` to `farthest`
    nearest, farthest = -asked.steepest, asked.steepest
    if asked.psi_bound > 0.0:
        nearest = max(nearest, (-asked.psi_bound - side * psi_t) / asked.depth)
        farthest = min(farthest, (asked.psi_bound - side * psi_t) / asked.depth)
    bracketed = False
    for i in range(6):
        if keep[i] and np.isfinite(kappa[i]):
            nearest = max(nearest, side * kappa[i])
            bracketed = True
    if not bracketed:
        nearest = max(nearest, 0.0)
    if nearest >= farthest:
        return 0
    # the critical rates of the joints that may turn cut the side into pieces
    anchors = np.empty(7)
    anchors[0] = nearest
    pieces = 1
    for i in range(6):
        if not keep[i] and nearest < side * kappa[i] < farthest:
            anchors[pieces] = side * kappa[i]
            pieces += 1
    anchors = np.sort(anchors[:pieces])
    out[0] = side * nearest
    count = 1
    for p in range(pieces - 1):
        for j in range(SLOPES_BETWEEN):
            out[count] = side * (anchors[p] + (anchors[p + 1] - anchors[p]) * (j + 0.5) / SLOPES_BETWEEN)
            count += 1
    span = farthest - anchors[pieces - 1]
    for j in range(GEOMETRIC_SLOPES):
        out[count] = side * (anchors[pieces - 1] + span * 1e-4 ** (1.0 - j / (GEOMETRIC_SLOPES - 1.0)))
        count += 1
    return count


@kernel
def lay_leg(arm, plane, branch, psi_t, slope, length, held, asked, nodes, work):  # type: ignore[no-untyped-def]
    """The rates of a leg in the workspace: each joint's, and at each node the worst of all and the motion of all.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        branch: 0..7.
        psi_t: spin at the target [rad].
        slope: twist rate [rad/m].
        length: of the leg [m].
        held: (sense, keep, at_target), see `judge_leg`.
        asked: `Asked`.
        nodes: points on the leg, at most BLOCK.
        work: room for `fields`; NaN in the row MOTION where a node is out of reach.
    """
    sense, keep, _ = held
    _place(psi_t, slope, length / (nodes - 1), 0, nodes, work)
    fields(arm, plane, branch // 2, nodes, work)
    for n in range(nodes):
        work[SLOPE * BLOCK + n] = slope
        work[WORST * BLOCK + n] = np.inf
        work[MOTION * BLOCK + n] = 0.0
    five = flip_sign(arm, branch)
    for i in range(6):
        sign, spare = sense[i], asked.min_rate if asked.mean_rule else 0.0
        if i == 4:
            sign *= five
        at, last = (THETA_S + i) * BLOCK, nodes - 1
        outset = work[at] + slope * work[at + THETA_PSI_ON]
        if not keep[i]:
            # it may turn at the target, so it goes whichever way it sets out
            sign = 1.0 if outset > 0.0 else -1.0
            spare = np.inf if asked.turn_inside else asked.min_rate
        middle = work[at + last // 2] + slope * work[at + last // 2 + THETA_PSI_ON]
        end = work[at + last] + slope * work[at + last + THETA_PSI_ON]
        if max(abs(outset), abs(middle), abs(end)) <= NIL:
            spare = np.inf  # a joint that does not move does not reverse
        work[SIGNS * BLOCK + i], work[SIGNS * BLOCK + 6 + i] = sign, spare
        _fold(work, i, sign, spare, -1.0, nodes)


@kernel
def weigh_leg(arm, plane, branch, psi_t, slope, held, asked, nodes, work):  # type: ignore[no-untyped-def]
    """Margin, slack and travel of a leg: what `judge_leg` says of `trace_leg`, at a tenth of the cost.

    The slack is that of the outer end, where a leg whose joints all keep their directions comes nearest to a limit.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        branch: 0..7.
        psi_t: spin at the target [rad].
        slope: twist rate [rad/m].
        held: (sense, keep, at_target), see `judge_leg`.
        asked: `Asked`; limits that are infinite are not looked at.
        nodes: points on the leg, at most BLOCK.
        work: room for `fields`.

    Returns:
        margin: see `judge_leg`; -inf where the leg cannot be run.
        slack: least distance to a limit [rad].
        travel: sum of the joints' angles moved [rad].
    """
    keep, at_target = held[1], held[2]
    step = asked.depth / (nodes - 1)
    lay_leg(arm, plane, branch, psi_t, slope, asked.depth, held, asked, nodes, work)
    five = flip_sign(arm, branch)
    worst, at, motion = np.inf, 0, 0.0
    for n in range(nodes):
        motion += work[MOTION * BLOCK + n]
        if work[WORST * BLOCK + n] < worst:
            worst, at = work[WORST * BLOCK + n], n
    if np.isnan(motion):
        return -np.inf, -np.inf, np.inf
    worst = min(worst, between_nodes(work, min(max(at, 1), nodes - 2)))
    slack = np.inf
    if asked.mean_rule or asked.lower[0] > -np.inf:
        for i in range(6):
            moved = _sum_ends(work, THETA_S + i, nodes)
            for n in range(nodes):
                moved += work[(THETA_S + i) * BLOCK + n]
            if asked.mean_rule and keep[i] and work[SIGNS * BLOCK + 6 + i] < np.inf:
                worst = min(worst, work[SIGNS * BLOCK + i] * moved / (nodes - 1))
            end = at_target[i] + step * moved * (five if i == 4 else 1.0)
            slack = min(slack, end - asked.lower[i], asked.upper[i] - end)
    return worst, slack, step * (motion + _sum_ends(work, MOTION, nodes))


@kernel
def _fold(work, i, sign, spare, nil, count):  # type: ignore[no-untyped-def]
    """Turn the fields of a joint into its rate, and take that into the worst and the motion of all at each point."""
    for n in range(count):
        rate = work[(THETA_S + i) * BLOCK + n] + work[SLOPE * BLOCK + n] * work[(THETA_PSI + i) * BLOCK + n]
        work[(THETA_S + i) * BLOCK + n] = rate
        worst, moved = work[WORST * BLOCK + n], abs(rate)
        signed = np.inf if moved <= nil else sign * rate + spare
        work[WORST * BLOCK + n] = signed if signed < worst else worst
        work[MOTION * BLOCK + n] += moved


@kernel
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


@kernel
def _sum_ends(work, row, nodes):  # type: ignore[no-untyped-def]
    """What the ends add to a plain sum over the nodes, so that it integrates to third order (Gregory)."""
    a, z = row * BLOCK, row * BLOCK + nodes - 1
    return (work[a + 1] + work[z - 1]) / 6.0 - (work[a] + work[z]) * 0.625 - (work[a + 2] + work[z - 2]) / 24.0


@kernel
def sift(arm, plane, branch, psi_t, slopes, count, sense, keep, asked, work, ceiling, travel, ends):  # type: ignore[no-untyped-def]
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
        asked: `Asked`.
        work: room for `fields`.
        ceiling: out: [rad/m], -inf where a leg cannot be run.
        travel: out: [rad], inf where a leg cannot be run.
        ends: out, shape (count, 6): about the angles at the outer end, relative to the target [rad].
    """
    at_once = BLOCK // SIEVE
    for first in range(0, count, at_once):
        legs = min(at_once, count - first)
        for j in range(legs):
            _place(psi_t, slopes[first + j], asked.depth / (SIEVE - 1), 0, SIEVE, work[j * SIEVE :])
        points = legs * SIEVE
        fields(arm, plane, branch // 2, points, work)
        for n in range(points):
            work[SLOPE * BLOCK + n] = slopes[first + n // SIEVE]
            work[WORST * BLOCK + n] = np.inf
            work[MOTION * BLOCK + n] = 0.0
        five = flip_sign(arm, branch)
        for i in range(6):
            spare = asked.min_rate if asked.mean_rule else 0.0
            # what moves so little may be a joint that does not move, which does not reverse: a ceiling is a ceiling
            _fold(work, i, sense[i] * (five if i == 4 else 1.0), spare if keep[i] else np.inf, NIL, points)
        for j in range(legs):
            worst = WORST * BLOCK + j * SIEVE
            moved = _mean_of_four(work, MOTION * BLOCK + j * SIEVE)
            if np.isnan(moved):
                ceiling[first + j], travel[first + j] = -np.inf, np.inf
            else:
                ceiling[first + j] = min(work[worst], work[worst + 1], work[worst + 2], work[worst + 3])
                travel[first + j] = asked.depth * moved
            for i in range(6):
                end = asked.depth * _mean_of_four(work, (THETA_S + i) * BLOCK + j * SIEVE)
                ends[first + j, i] = end * five if i == 4 else end


@kernel
def _mean_of_four(work, at):  # type: ignore[no-untyped-def]
    """Mean over a leg of what four even points of it have: Simpson's 3/8 rule."""
    return (work[at] + 3.0 * (work[at + 1] + work[at + 2]) + work[at + 3]) / 8.0


@kernel
def try_slope(arm, plane, branch, psi_t, slope, held, asked, mode, nodes, work, best):  # type: ignore[no-untyped-def]
    """Follow one slope and remember it where it is the best so far.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        branch: 0..7.
        psi_t: spin at the target [rad].
        slope: twist rate [rad/m].
        held: what the leg is held to at this target: (sense, keep, at_target), see `judge_leg`.
        asked: `Asked`; limits that are infinite are not looked at.
        mode: TRAVEL, GREATEST_MARGIN or PLUNGE_ROTATION.
        nodes: points on a leg.
        work: room for `fields`.
        best: in and out, shape (3,): least cost, its slope, and the greatest margin seen.

    Returns:
        cost: inf where the slope will not do.
        excess: by how much it does [rad/m]; negative where it does not, -inf out of reach.
        margin: see `judge_leg`; beyond a limit, less than asked; -inf out of reach.
    """
    if asked.turn_inside and asked.lower[0] > -np.inf:
        # a joint that turns round may come nearest to a limit anywhere
        leg = np.empty((ROWS, 6))
        if not trace_leg(arm, plane, branch, psi_t, slope, asked.depth, nodes, work, leg):
            return np.inf, -np.inf, -np.inf
        margin, slack, travel = judge_leg(leg, held[0], held[1], held[2], asked.depth, asked)
    else:
        margin, slack, travel = weigh_leg(arm, plane, branch, psi_t, slope, held, asked, nodes, work)
    if margin == -np.inf:
        return np.inf, -np.inf, -np.inf
    if slack < 0.0:
        # as if it lacked margin: so there is a way to climb back within the limits
        margin = min(margin, asked.min_rate + slack / asked.depth)
    best[2] = max(best[2], margin)
    if margin < asked.min_rate:
        return np.inf, margin - asked.min_rate, margin
    cost = travel
    if mode == GREATEST_MARGIN:
        cost = -margin
    elif mode == PLUNGE_ROTATION:
        cost = abs(slope)
    if cost < best[0]:
        best[0], best[1] = cost, slope
    return cost, min(margin - asked.min_rate, slack / asked.depth), margin


@kernel
def best_leg(arm, plane, branch, psi_t, side, kappa, held, asked, mode, nodes, work, best):  # type: ignore[no-untyped-def]
    """The best slope on one side of the critical rates (theory §3).

    The slopes that keep margin and limits form a few bounded intervals; every interval's ends are located by a root
    search and its inner dips by golden section. Where no candidate keeps the margin, the greatest margin is climbed
    to, so that a thin interval between two candidates is not missed.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        branch: 0..7.
        psi_t: spin at the target [rad].
        side: 1 above the critical rates, -1 below.
        kappa: critical rates at the target, shape (6,).
        held: see `try_slope`.
        asked: `Asked`.
        mode: TRAVEL, GREATEST_MARGIN or PLUNGE_ROTATION.
        nodes: points on a leg.
        work: room for `fields`.
        best: out, shape (3,): least cost (inf where no slope will do), its slope, and the greatest margin seen (-inf
            where none can be run).
    """
    slopes, ceiling, estimate = np.empty(MAX_SLOPES), np.empty(MAX_SLOPES), np.empty(MAX_SLOPES)
    count = slope_candidates(kappa, held[1], side, psi_t, asked, slopes)
    best[:] = np.inf, np.nan, -np.inf
    ends = np.empty((MAX_SLOPES, 6))
    sift(arm, plane, branch, psi_t, slopes, count, held[0], held[1], asked, work, ceiling, estimate, ends)
    if mode == GREATEST_MARGIN:
        estimate[:count] = -ceiling[:count]
    elif mode == PLUNGE_ROTATION:
        estimate[:count] = np.abs(slopes[:count])

    # runs of candidates that may do: from the most promising of each on, until one does
    first = 0
    while mode != GREATEST_MARGIN and first < count:
        end = first
        while end < count and ceiling[end] >= asked.min_rate:
            end += 1
        if end > first:
            least = np.inf
            for j in range(max(first - 1, 0), min(end + 1, count)):
                least = np.minimum(least, estimate[j])
            if least * (1.0 - SIEVE_ERROR) < best[0]:
                for j in first + np.argsort(estimate[first:end]):
                    cost, excess, _ = try_slope(
                        arm, plane, branch, psi_t, slopes[j], held, asked, mode, nodes, work, best
                    )
                    if cost < np.inf:
                        _settle(
                            arm, plane, branch, psi_t, slopes[:count], estimate, j, cost, excess, held, asked, mode,
                            nodes, work, best,
                        )  # fmt: skip
                        break
        first = end + 1
    if best[0] < np.inf:
        return

    # none does: climb to the greatest margin, beginning with the candidate that has it
    peak, peak_margin = -1, -np.inf
    for j in np.argsort(-ceiling[:count]):
        if ceiling[j] <= peak_margin:
            break
        margin = try_slope(arm, plane, branch, psi_t, slopes[j], held, asked, mode, nodes, work, best)[2]
        if margin > peak_margin:
            peak, peak_margin = j, margin
    if peak < 0:
        return
    a, b = slopes[max(peak - 1, 0)], slopes[min(peak + 1, count - 1)]
    _golden(arm, plane, branch, psi_t, a, b, True, held, asked, mode, nodes, work, best)
    if mode == GREATEST_MARGIN or best[0] == np.inf:
        return
    # a thin interval was found: its ends lie on either side of it, before the next candidates
    found = best[1]
    excess = try_slope(arm, plane, branch, psi_t, found, held, asked, mode, nodes, work, best)[1]
    for end in (a, b):
        _interval_end(arm, plane, branch, psi_t, found, excess, end, -np.inf, held, asked, mode, nodes, work, best)


@kernel
def _settle(arm, plane, branch, psi_t, slopes, estimate, j, cost, excess, held, asked, mode, nodes, work, best):  # type: ignore[no-untyped-def]
    """From a candidate that will do, go to where the cost is least: the end of its interval, or a dip inside."""
    low, high = slopes[j], slopes[j]
    for k in (-1, 1):
        while 0 <= j + k < slopes.shape[0]:
            at_other, lacks, _ = try_slope(
                arm, plane, branch, psi_t, slopes[j + k], held, asked, mode, nodes, work, best
            )
            if not at_other < cost:
                break
            # the rough look was mistaken about which is the cheaper
            low, j, cost, excess = slopes[j], j + k, at_other, lacks
        if not 0 <= j + k < slopes.shape[0]:
            end = slopes[j]
        elif at_other < np.inf:
            end = slopes[j + k]
        else:
            # the cost may fall towards the end of the interval, or dip on the way there
            onward = slopes[j] + 0.1 * (slopes[j + k] - slopes[j])
            falls = try_slope(arm, plane, branch, psi_t, onward, held, asked, mode, nodes, work, best)[0] < cost
            if not (falls or estimate[j + k] < estimate[j]):
                end = onward
            else:
                end, at_end = _interval_end(
                    arm, plane, branch, psi_t, slopes[j], excess, slopes[j + k], lacks, held, asked, mode, nodes, work,
                    best,
                )  # fmt: skip
                # from the end inwards the cost may still fall
                probe = end + 0.1 * (slopes[j] - end)
                at_probe, _, _ = try_slope(arm, plane, branch, psi_t, probe, held, asked, mode, nodes, work, best)
                if at_end < cost and at_end <= at_probe:
                    return
        if k < 0:
            low = end
        else:
            high = end
    _golden(arm, plane, branch, psi_t, low, high, False, held, asked, mode, nodes, work, best)


@kernel
def _golden(arm, plane, branch, psi_t, a, b, climb, held, asked, mode, nodes, work, best):  # type: ignore[no-untyped-def]
    """Golden section between two slopes, up to the greatest margin or down to the least cost."""
    x, y = b - GOLDEN * (b - a), a + GOLDEN * (b - a)
    at_x = try_slope(arm, plane, branch, psi_t, x, held, asked, mode, nodes, work, best)
    at_y = try_slope(arm, plane, branch, psi_t, y, held, asked, mode, nodes, work, best)
    at_a, at_b = np.nan, np.nan
    for _ in range(GOLDEN_STEPS):
        if abs(b - a) < ROOT_TOLERANCE:
            break
        if climb and mode != GREATEST_MARGIN:
            # enough is enough, and where too little can be gained it will not be
            if best[2] >= asked.min_rate:
                break
            if best[2] + most_gained(a, x, y, b, at_a, at_x[2], at_y[2], at_b) < asked.min_rate:
                break
        if at_x[2] >= at_y[2] if climb else at_x[0] <= at_y[0]:
            b, at_b = y, at_y[2]
            y, at_y = x, at_x
            x = b - GOLDEN * (b - a)
            at_x = try_slope(arm, plane, branch, psi_t, x, held, asked, mode, nodes, work, best)
        else:
            a, at_a = x, at_x[2]
            x, at_x = y, at_y
            y = a + GOLDEN * (b - a)
            at_y = try_slope(arm, plane, branch, psi_t, y, held, asked, mode, nodes, work, best)


@kernel
def most_gained(a, x, y, b, at_a, at_x, at_y, at_b):  # type: ignore[no-untyped-def]
    """How far a function between a and b can lie beyond all that is known of it, if it has one peak and is concave.

    The margin, the least of many rates that are nearly linear, is nearly so. What is not known of the ends is NaN.
    """
    if not (np.isfinite(at_x + at_y) and (np.isfinite(at_a) or np.isfinite(at_b))):
        return np.inf
    steepest = abs(at_y - at_x) / abs(y - x)
    if np.isfinite(at_a):
        steepest = max(steepest, abs(at_x - at_a) / abs(x - a))
    if np.isfinite(at_b):
        steepest = max(steepest, abs(at_b - at_y) / abs(b - y))
    return steepest * abs(b - a)


@kernel
def _interval_end(arm, plane, branch, psi_t, inside, f_in, outside, f_out, held, asked, mode, nodes, work, best):  # type: ignore[no-untyped-def]
    """Locate where a slope just stops doing: regula falsi (Illinois), bisection where one side cannot be run.

    Returns:
        the last slope that will do, and its cost; inf where that is `inside` itself.
    """
    kept = 0
    at_end, at_excess = np.inf, f_in
    for _ in range(ROOT_STEPS):
        if abs(outside - inside) < ROOT_TOLERANCE * (1.0 + abs(inside)) or at_excess < ROOT_TOLERANCE:
            break
        share = 0.5
        if f_out > -np.inf and f_in > 0.0:
            share = min(max(f_in / (f_in - f_out), 1e-3), 1.0 - 1e-3)
        middle = inside + share * (outside - inside)
        cost, excess, _margin = try_slope(arm, plane, branch, psi_t, middle, held, asked, mode, nodes, work, best)
        if cost < np.inf:
            inside, f_in, at_end, at_excess = middle, excess, cost, excess
            if kept > 0:
                f_out *= 0.5
            kept = 1
        else:
            outside, f_out = middle, excess
            if kept < 0:
                f_in *= 0.5
            kept = -1
    return inside, at_end
