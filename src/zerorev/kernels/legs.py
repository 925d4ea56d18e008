"""Legs out of a target, and the best one on a side of the critical rates (theory §2, §3).

A leg is a straight line in the twist plane, from the target outwards: psi(s) = psi_t + u s. Joint i keeps its direction
through the target if and only if its outward rates on the two legs have opposite signs, so at a given psi_t one leg has
to lie above the critical rates of all joints that must not reverse, the other below them, and each can be looked for on
its own: along the one line of slopes u on its side.

Lengths in m, angles in rad, rates outwards in rad/m; controller angles. No kernel raises.
"""

from __future__ import annotations

import numpy as np

from zerorev.kernels._jit import kernel
from zerorev.kernels.arm import controller_angles, flip_sign, twist_field

# rows of a traced leg, one column a joint
LEAST_RATE, GREATEST_RATE, LEAST_ANGLE, GREATEST_ANGLE, END_ANGLE, MOVED, TURNS, TARGET_RATE = range(8)
ROWS = 8
# what makes one leg better than another
TRAVEL, GREATEST_MARGIN, PLUNGE_ROTATION = range(3)

NIL = np.deg2rad(1e-6)  # [rad/m] 1e-9 deg/mm: below it a joint does not move
GEOMETRIC_SLOPES = 16
SLOPES_BETWEEN = 4
MAX_SLOPES = 1 + GEOMETRIC_SLOPES + 6 * SLOPES_BETWEEN
ROOT_STEPS = 24
GOLDEN_STEPS = 20
GOLDEN = (np.sqrt(5.0) - 1.0) / 2.0


@kernel
def trace_leg(arm, plane, branch, psi_t, slope, depth, nodes, leg):  # type: ignore[no-untyped-def]
    """Follow a leg from the target outwards.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        branch: 0..7.
        psi_t: spin at the target [rad].
        slope: twist rate u [rad/m].
        depth: length of the leg [m].
        nodes: how many points are looked at, both ends among them.
        leg: out, shape (ROWS, 6): least and greatest outward rate; least and greatest angle, and the one at the outer
            end, relative to the target; angle moved; how often the joint turns round; outward rate at the target.

    Returns:
        whether all of the leg can be reached.
    """
    cs = np.empty((6, 2))
    theta_s, theta_psi = np.empty(6), np.empty(6)
    earlier, before, first, last = np.zeros(6), np.zeros(6), np.empty(6), np.empty(6)
    direction = np.zeros(6)
    five = flip_sign(arm, branch)
    step = depth / (nodes - 1)
    for n in range(nodes):
        s = n * step
        if not twist_field(arm, plane, s, psi_t + slope * s, branch // 2, cs, theta_s, theta_psi):
            return False
        for i in range(6):
            rate = theta_s[i] + slope * theta_psi[i]
            if i == 4:
                rate *= five
            if np.isnan(rate):
                return False
            if n == 0:
                leg[LEAST_RATE, i] = leg[GREATEST_RATE, i] = rate
                leg[LEAST_ANGLE:, i] = 0.0
                leg[TARGET_RATE, i] = rate
            else:
                leg[LEAST_RATE, i] = min(leg[LEAST_RATE, i], rate)
                leg[GREATEST_RATE, i] = max(leg[GREATEST_RATE, i], rate)
                tilt, bend = rate - earlier[i], rate - 2.0 * before[i] + earlier[i]
                reach = abs(bend)
                if (n == 2 and tilt * bend > 0.0) or (n == nodes - 1 and tilt * bend < 0.0):
                    reach *= 2.0  # an end of the leg has no nodes on its other side
                if n > 1 and abs(tilt) < reach:
                    # an extreme lies between the nodes: take it from the parabola through three of them
                    extreme = before[i] - tilt * tilt / (8.0 * bend)
                    leg[LEAST_RATE, i] = min(leg[LEAST_RATE, i], extreme)
                    leg[GREATEST_RATE, i] = max(leg[GREATEST_RATE, i], extreme)
                    if extreme * before[i] < 0.0 and rate * before[i] > 0.0 and earlier[i] * before[i] > 0.0:
                        leg[TURNS, i] += 2.0
                moved = 0.5 * step * (before[i] + rate)
                leg[MOVED, i] += abs(moved)
                leg[END_ANGLE, i] += moved
                leg[LEAST_ANGLE, i] = min(leg[LEAST_ANGLE, i], leg[END_ANGLE, i])
                leg[GREATEST_ANGLE, i] = max(leg[GREATEST_ANGLE, i], leg[END_ANGLE, i])
            earlier[i], before[i] = before[i], rate
            if abs(rate) > NIL:
                if rate * direction[i] < 0.0:
                    leg[TURNS, i] += 1.0
                direction[i] = 1.0 if rate > 0.0 else -1.0
        if n == 0:
            controller_angles(arm, cs, branch % 2 == 1, first)
    # the outer end is known exactly up to whole turns, and the sum over the nodes knows those
    controller_angles(arm, cs, branch % 2 == 1, last)
    for i in range(6):
        exact = last[i] - first[i]
        exact += 2.0 * np.pi * np.round((leg[END_ANGLE, i] - exact) / (2.0 * np.pi))
        leg[END_ANGLE, i] = exact
        leg[LEAST_ANGLE, i] = min(leg[LEAST_ANGLE, i], exact)
        leg[GREATEST_ANGLE, i] = max(leg[GREATEST_ANGLE, i], exact)
    return True


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
def try_slope(arm, plane, branch, psi_t, slope, held, asked, mode, nodes, best):  # type: ignore[no-untyped-def]
    """Follow one slope and remember it where it is the best so far.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        branch: 0..7.
        psi_t: spin at the target [rad].
        slope: twist rate [rad/m].
        held: what the leg is held to at this target: (sense, keep, at_target), see `judge_leg`.
        asked: `Asked`.
        mode: TRAVEL, GREATEST_MARGIN or PLUNGE_ROTATION.
        nodes: points on a leg.
        best: in and out, shape (3,): least cost, its slope, and the greatest margin seen.

    Returns:
        cost: inf where the slope will not do.
        excess: by how much it does [rad/m, or rad at a limit]; negative where it does not, -inf out of reach.
        margin: see `judge_leg`; -inf where the leg cannot be run.
    """
    leg = np.empty((ROWS, 6))
    if not trace_leg(arm, plane, branch, psi_t, slope, asked.depth, nodes, leg):
        return np.inf, -np.inf, -np.inf
    sense, keep, at_target = held
    margin, slack, travel = judge_leg(leg, sense, keep, at_target, asked.depth, asked)
    if slack < 0.0:
        return np.inf, slack, -np.inf
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
    return cost, min(margin - asked.min_rate, slack), margin


@kernel
def best_leg(arm, plane, branch, psi_t, side, kappa, held, asked, mode, nodes, best):  # type: ignore[no-untyped-def]
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
        best: out, shape (3,): least cost (inf where no slope will do), its slope, and the greatest margin seen (-inf
            where none can be run).
    """
    slopes, costs, excesses = np.empty(MAX_SLOPES), np.empty(MAX_SLOPES), np.empty(MAX_SLOPES)
    count = slope_candidates(kappa, held[1], side, psi_t, asked, slopes)
    best[:] = np.inf, np.nan, -np.inf
    peak, peak_margin = -1, -np.inf
    for j in range(count):
        costs[j], excesses[j], margin = try_slope(arm, plane, branch, psi_t, slopes[j], held, asked, mode, nodes, best)
        if margin > peak_margin:
            peak, peak_margin = j, margin
    if peak < 0:
        return

    if mode == GREATEST_MARGIN or best[0] == np.inf:
        a, b = slopes[max(peak - 1, 0)], slopes[min(peak + 1, count - 1)]
        _golden(arm, plane, branch, psi_t, a, b, True, held, asked, mode, nodes, best)
        if mode == GREATEST_MARGIN or best[0] == np.inf:
            return
        # a thin interval was found: its ends lie on either side of it, before the next candidates
        found = best[1]
        excess = try_slope(arm, plane, branch, psi_t, found, held, asked, mode, nodes, best)[1]
        for j in (max(peak - 1, 0), min(peak + 1, count - 1)):
            _interval_end(
                arm, plane, branch, psi_t, found, excess, slopes[j], excesses[j], held, asked, mode, nodes, best
            )
        return

    around, at_around = np.empty(2), np.empty(2)
    for j in range(count):
        if costs[j] == np.inf:
            continue
        for k in range(2):
            other = j - 1 + 2 * k
            if not 0 <= other < count:
                around[k], at_around[k] = slopes[j], -np.inf
            elif costs[other] < np.inf:
                around[k], at_around[k] = slopes[other], costs[other]
            else:
                around[k], at_around[k] = _interval_end(
                    arm, plane, branch, psi_t, slopes[j], excesses[j], slopes[other], excesses[other],
                    held, asked, mode, nodes, best,
                )  # fmt: skip
                # from the end inwards the cost may still fall
                probe = around[k] + 0.1 * (slopes[j] - around[k])
                if try_slope(arm, plane, branch, psi_t, probe, held, asked, mode, nodes, best)[0] < at_around[k]:
                    _golden(arm, plane, branch, psi_t, around[k], slopes[j], False, held, asked, mode, nodes, best)
        if costs[j] <= min(at_around[0], at_around[1]) < np.inf:
            _golden(arm, plane, branch, psi_t, around[0], around[1], False, held, asked, mode, nodes, best)


@kernel
def _golden(arm, plane, branch, psi_t, a, b, climb, held, asked, mode, nodes, best):  # type: ignore[no-untyped-def]
    """Golden section between two slopes, up to the greatest margin or down to the least cost."""
    x, y = b - GOLDEN * (b - a), a + GOLDEN * (b - a)
    at_x = try_slope(arm, plane, branch, psi_t, x, held, asked, mode, nodes, best)
    at_y = try_slope(arm, plane, branch, psi_t, y, held, asked, mode, nodes, best)
    for _ in range(GOLDEN_STEPS):
        if at_x[2] >= at_y[2] if climb else at_x[0] <= at_y[0]:
            b, y, at_y = y, x, at_x
            x = b - GOLDEN * (b - a)
            at_x = try_slope(arm, plane, branch, psi_t, x, held, asked, mode, nodes, best)
        else:
            a, x, at_x = x, y, at_y
            y = a + GOLDEN * (b - a)
            at_y = try_slope(arm, plane, branch, psi_t, y, held, asked, mode, nodes, best)


@kernel
def _interval_end(arm, plane, branch, psi_t, inside, f_in, outside, f_out, held, asked, mode, nodes, best):  # type: ignore[no-untyped-def]
    """Locate where a slope just stops doing: regula falsi (Illinois), bisection where one side cannot be run.

    Returns:
        the last slope that will do, and its cost; inf where that is `inside` itself.
    """
    kept = 0
    at_end = np.inf
    for _ in range(ROOT_STEPS):
        if abs(outside - inside) < 1e-10 * (1.0 + abs(inside)):
            break
        share = 0.5
        if f_out > -np.inf and f_in > 0.0:
            share = min(max(f_in / (f_in - f_out), 1e-3), 1.0 - 1e-3)
        middle = inside + share * (outside - inside)
        cost, excess, _margin = try_slope(arm, plane, branch, psi_t, middle, held, asked, mode, nodes, best)
        if cost < np.inf:
            inside, f_in, at_end = middle, excess, cost
            if kept > 0:
                f_out *= 0.5
            kept = 1
        else:
            outside, f_out = middle, excess
            if kept < 0:
                f_in *= 0.5
            kept = -1
    return inside, at_end
