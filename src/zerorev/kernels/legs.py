"""Legs out of a target, and the best pair of them (theory §2, §3).

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
# columns of what a search over slopes or pairs returns
VALUE, SLOPE_ABOVE, SLOPE_BELOW, MARGIN = range(4)
# what makes one leg better than another
TRAVEL, GREATEST_MARGIN, PLUNGE_ROTATION = range(3)

NIL = np.deg2rad(1e-6)  # [rad/m] 1e-9 deg/mm: below it a joint does not move
GEOMETRIC_SLOPES = 16
SLOPES_BETWEEN = 4
MAX_SLOPES = 1 + GEOMETRIC_SLOPES + 6 * SLOPES_BETWEEN
EVEN_SLOPES = 48
MAX_FAN = 7 + 2 * GEOMETRIC_SLOPES + 6 * SLOPES_BETWEEN + EVEN_SLOPES
ROOT_STEPS = 24
GOLDEN_STEPS = 20
COMPASS_STEPS = 40
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


@kernel
def turn_choices(principal, asked):  # type: ignore[no-untyped-def]
    """In how many ways the turns of six joints can be chosen so that the target lies within the limits."""
    choices = 1
    for i in range(6):
        first = np.ceil((asked.lower[i] - principal[i]) / (2.0 * np.pi))
        last = np.floor((asked.upper[i] - principal[i]) / (2.0 * np.pi))
        choices *= max(0, int(last - first) + 1)
    return choices


@kernel
def take_turns(principal, asked, choice, at_target):  # type: ignore[no-untyped-def]
    """Joint angles at the target for one of the `turn_choices`, written to `at_target`, shape (6,)."""
    for i in range(6):
        first = np.ceil((asked.lower[i] - principal[i]) / (2.0 * np.pi))
        options = int(np.floor((asked.upper[i] - principal[i]) / (2.0 * np.pi)) - first) + 1
        at_target[i] = principal[i] + 2.0 * np.pi * (first + choice % options)
        choice //= options


@kernel
def best_pair(arm, plane, branch, psi_t, keep, asked, unlimited, mode, nodes, out):  # type: ignore[no-untyped-def]
    """The best two legs out of one point of the target line, one on each side of the critical rates.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        branch: 0..7.
        psi_t: spin at the target [rad].
        keep: whether a joint must keep its direction, shape (6,).
        asked: `Asked`.
        unlimited: the same without joint limits.
        mode: TRAVEL, GREATEST_MARGIN or PLUNGE_ROTATION.
        nodes: points on a leg.
        out: out, shape (4,): value to be least (inf where no pair will do), slope above, slope below, and the greatest
            margin that both legs can have (-inf where one cannot be run at all).
    """
    cs = np.empty((6, 2))
    theta_s, theta_psi = np.empty(6), np.empty(6)
    kappa, sense, principal, at_target = np.empty(6), np.empty(6), np.empty(6), np.empty(6)
    out[:] = np.inf, np.nan, np.nan, -np.inf
    if not twist_field(arm, plane, 0.0, psi_t, branch // 2, cs, theta_s, theta_psi):
        return
    controller_angles(arm, cs, branch % 2 == 1, principal)
    five = flip_sign(arm, branch)
    for i in range(6):
        if np.isnan(theta_psi[i]):
            return
        kappa[i] = -theta_s[i] / theta_psi[i]
        sense[i] = 1.0 if theta_psi[i] > 0.0 else -1.0
    sense[4] *= five

    # The limits seldom bind: look without them first, and keep that answer if some choice of turns brings it within.
    _pair_within(arm, plane, branch, psi_t, principal, sense, kappa, keep, unlimited, mode, nodes, out)
    if out[MARGIN] == -np.inf or not turn_choices(principal, asked):
        out[:] = np.inf, np.nan, np.nan, -np.inf
        return
    if out[VALUE] < np.inf:
        legs = np.empty((2, ROWS, 6))
        trace_leg(arm, plane, branch, psi_t, out[SLOPE_ABOVE], asked.depth, nodes, legs[0])
        trace_leg(arm, plane, branch, psi_t, out[SLOPE_BELOW], asked.depth, nodes, legs[1])
        fits = True
        for i in range(6):
            least = principal[i] + min(legs[0, LEAST_ANGLE, i], legs[1, LEAST_ANGLE, i])
            greatest = principal[i] + max(legs[0, GREATEST_ANGLE, i], legs[1, GREATEST_ANGLE, i])
            first = np.ceil((asked.lower[i] - least) / (2.0 * np.pi))
            fits = fits and greatest + 2.0 * np.pi * first <= asked.upper[i]
        if fits:
            return
    out[:] = np.inf, np.nan, np.nan, -np.inf
    for choice in range(turn_choices(principal, asked)):
        take_turns(principal, asked, choice, at_target)
        _pair_within(arm, plane, branch, psi_t, at_target, sense, kappa, keep, asked, mode, nodes, out)


@kernel
def _pair_within(arm, plane, branch, psi_t, at_target, sense, kappa, keep, asked, mode, nodes, out):  # type: ignore[no-untyped-def]
    """`best_pair` for one choice of turns; `out` is bettered where this choice betters it."""
    legs, gentle = np.empty((2, 3)), np.empty((2, 3))
    leg_mode = GREATEST_MARGIN if mode == GREATEST_MARGIN else TRAVEL
    for k in range(2):
        side = 1.0 - 2.0 * k
        held = (side * sense, keep, at_target)
        best_leg(arm, plane, branch, psi_t, side, kappa, held, asked, leg_mode, nodes, legs[k])
        if legs[k, 2] == -np.inf:
            return
        if mode == PLUNGE_ROTATION and legs[k, 0] < np.inf:
            best_leg(arm, plane, branch, psi_t, side, kappa, held, asked, mode, nodes, gentle[k])
    out[MARGIN] = max(out[MARGIN], min(legs[0, 2], legs[1, 2]))
    if not (legs[0, 0] < np.inf and legs[1, 0] < np.inf):
        return
    above, below = legs[0, 1], legs[1, 1]
    if mode == TRAVEL:
        value = legs[0, 0] + legs[1, 0]
    elif mode == GREATEST_MARGIN:
        value = max(legs[0, 0], legs[1, 0])
    else:
        # one leg, the plunge, turns least; the other travels least
        value = min(gentle[0, 0], gentle[1, 0])
        if gentle[0, 0] <= gentle[1, 0]:
            above = gentle[0, 1]
        else:
            below = gentle[1, 1]
    if value < out[VALUE]:
        out[VALUE], out[SLOPE_ABOVE], out[SLOPE_BELOW] = value, above, below


@kernel
def fan_slopes(kappa, between, psi_t, asked, out, critical):  # type: ignore[no-untyped-def]
    """Slopes of the legs that are followed out of one point of the target line, whatever joints are to be kept.

    Args:
        kappa: critical rates at the target [rad/m], shape (6,).
        between: whether slopes between the critical rates are wanted, too.
        psi_t: spin at the target [rad].
        asked: `Asked`, for the steepest slope and the bound on the spin.
        out: out, shape (MAX_FAN,): rising slopes.
        critical: out, shape (MAX_FAN,): whether a slope is a critical rate.

    Returns:
        how many slopes were written.
    """
    low, high = -asked.steepest, asked.steepest
    if asked.psi_bound > 0.0:
        low = max(low, (-asked.psi_bound - psi_t) / asked.depth)
        high = min(high, (asked.psi_bound - psi_t) / asked.depth)
    anchors = np.empty(6)
    pieces = 0
    for i in range(6):
        if low < kappa[i] < high:
            anchors[pieces] = kappa[i]
            pieces += 1
    count = 0
    if pieces == 0:
        anchors[0] = min(max(0.0, low), high)
        pieces = 1
    anchors = np.sort(anchors[:pieces])
    marked = np.zeros(MAX_FAN)
    for p in range(pieces):
        if p == 0 or between or p == pieces - 1:
            out[count], marked[count] = anchors[p], 1.0
            count += 1
        if between and p < pieces - 1:
            for j in range(SLOPES_BETWEEN):
                out[count] = anchors[p] + (anchors[p + 1] - anchors[p]) * (j + 0.5) / SLOPES_BETWEEN
                count += 1
    for j in range(GEOMETRIC_SLOPES):
        share = 1e-4 ** (1.0 - j / (GEOMETRIC_SLOPES - 1.0))
        out[count] = anchors[0] - (anchors[0] - low) * share
        out[count + 1] = anchors[pieces - 1] + (high - anchors[pieces - 1]) * share
        count += 2
    if between:
        for j in range(EVEN_SLOPES):
            out[count] = low + (high - low) * (j + 0.5) / EVEN_SLOPES
            count += 1
        if low < 0.0 < high:  # the spin held
            out[count] = 0.0
            count += 1
    order = np.argsort(out[:count])
    out[:count] = out[:count][order]
    for j in range(count):
        critical[j] = marked[order[j]] > 0.0
    return count


@kernel
def follow(arm, plane, psi, between, asked, nodes, branches, fan):  # type: ignore[no-untyped-def]
    """Follow a fan of legs out of every spin of a grid, once for both wrist flips of a posture and for any `keep`.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        psi: spins at the target [rad], shape (K,).
        between: see `fan_slopes`.
        asked: `Asked`.
        nodes: points on a leg.
        branches: whether to look at a branch, shape (8,).
        fan: out, `Fan`.
    """
    cs = np.empty((6, 2))
    theta_s, theta_psi, principal = np.empty(6), np.empty(6), np.empty(6)
    fan.counts[:] = 0
    fan.fits[:] = False
    for posture in range(4):
        if not (branches[2 * posture] or branches[2 * posture + 1]):
            continue
        for n in range(psi.shape[0]):
            if not twist_field(arm, plane, 0.0, psi[n], posture, cs, theta_s, theta_psi) or np.isnan(theta_psi[0]):
                continue
            slopes = fan.slopes[posture, n]
            for i in range(6):
                fan.kappa[posture, n, i] = -theta_s[i] / theta_psi[i]
                fan.sense[posture, n, i] = 1.0 if theta_psi[i] > 0.0 else -1.0
            fan.sense[posture, n, 4] *= flip_sign(arm, 2 * posture)
            count = fan_slopes(fan.kappa[posture, n], between, psi[n], asked, slopes, fan.critical[posture, n])
            fan.counts[posture, n] = count
            for j in range(count):
                leg = fan.legs[posture, n, j]
                if not trace_leg(arm, plane, 2 * posture, psi[n], slopes[j], asked.depth, nodes, leg):
                    continue
                for flip in range(2):
                    if branches[2 * posture + flip]:
                        controller_angles(arm, cs, flip == 1, principal)
                        fan.fits[posture, n, j, flip] = turns_fit(leg, leg, flip == 1, principal, asked)


@kernel
def turns_fit(a, b, flipped, principal, asked):  # type: ignore[no-untyped-def]
    """Whether some turns bring both of two legs within the limits.

    Args:
        a: a leg from `trace_leg`, shape (ROWS, 6); b the other.
        b: see a.
        flipped: whether the legs were followed on the other wrist flip, whose joint 5 moves the other way.
        principal: angles at the target within (-pi, pi], shape (6,).
        asked: `Asked`.
    """
    for i in range(6):
        low, high = min(a[LEAST_ANGLE, i], b[LEAST_ANGLE, i]), max(a[GREATEST_ANGLE, i], b[GREATEST_ANGLE, i])
        if flipped and i == 4:
            low, high = -high, -low
        first = np.ceil((asked.lower[i] - principal[i] - low) / (2.0 * np.pi))
        if not principal[i] + high + 2.0 * np.pi * first <= asked.upper[i]:
            return False
    return True


@kernel
def look(fan, keep, asked, out):  # type: ignore[no-untyped-def]
    """A coarse look along the target line: what `best_pair` would find from the legs of the fan alone.

    Args:
        fan: `Fan`, from `follow`.
        keep: whether a joint must keep its direction, shape (6,).
        asked: `Asked`.
        out: out, shape (8, K, 2): least travel over pairs that keep the margin (inf where none does), and the greatest
            margin of a pair (-inf where none can be run).
    """
    sense, anywhere = np.empty(6), np.zeros(6)
    best = np.empty((2, 2, 2))  # flip; side; least travel, greatest margin
    near = np.empty((2, 2))  # flip; margin and travel of the candidate before
    out[:, :, 0] = np.inf
    out[:, :, 1] = -np.inf
    for posture in range(4):
        for n in range(fan.counts.shape[1]):
            count = fan.counts[posture, n]
            if count == 0:
                continue
            kappa = fan.kappa[posture, n]
            best[:, :, 0] = np.inf
            best[:, :, 1] = -np.inf
            for k in range(2):
                side = 1.0 - 2.0 * k
                nearest = -np.inf
                for i in range(6):
                    sense[i] = side * fan.sense[posture, n, i]
                    if keep[i] and np.isfinite(kappa[i]):
                        nearest = max(nearest, side * kappa[i])
                if nearest == -np.inf:
                    nearest = 0.0
                near[:, 0] = -np.inf
                for m in range(count):
                    j = m if k == 0 else count - 1 - m  # away from the critical rates
                    if side * fan.slopes[posture, n, j] < nearest:
                        continue
                    fits = fan.fits[posture, n, j]
                    if not (fits[0] or fits[1]):
                        near[:, 0] = -np.inf
                        continue
                    margin, _slack, travel = judge_leg(
                        fan.legs[posture, n, j], sense, keep, anywhere, asked.depth, asked
                    )
                    for flip in range(2):
                        if not fits[flip]:
                            near[flip, 0] = -np.inf
                            continue
                        best[flip, k, 1] = max(best[flip, k, 1], margin)
                        if margin >= asked.min_rate:
                            # the end of the interval lies between this candidate and the one before
                            if -np.inf < near[flip, 0] < asked.min_rate:
                                share = (margin - asked.min_rate) / (margin - near[flip, 0])
                                end = travel + share * (near[flip, 1] - travel)
                                best[flip, k, 0] = min(best[flip, k, 0], end)
                            best[flip, k, 0] = min(best[flip, k, 0], travel)
                        near[flip, 0], near[flip, 1] = margin, travel
            for flip in range(2):
                out[2 * posture + flip, n, 0] = best[flip, 0, 0] + best[flip, 1, 0]
                out[2 * posture + flip, n, 1] = min(best[flip, 0, 1], best[flip, 1, 1])


@kernel
def judge_pair(a, b, slope_a, slope_b, weights, asked, mode):  # type: ignore[no-untyped-def]
    """What two legs out of the same point are worth together, limits aside: each figure the less the better.

    Args:
        a: a leg from `trace_leg`, shape (ROWS, 6); b the other.
        b: see a.
        slope_a: twist rates [rad/m]; slope_b the other.
        slope_b: see slope_a.
        weights: what a reversal of each joint costs, shape (6,).
        asked: `Asked`.
        mode: TRAVEL, GREATEST_MARGIN or PLUNGE_ROTATION.

    Returns:
        cost: weighted count of reversals.
        lack: by how much the slowest joint that does not reverse falls short of the threshold [rad/m].
        value: what is to be least.
    """
    cost, margin, travel = 0.0, np.inf, 0.0
    for i in range(6):
        turns = a[TURNS, i] + b[TURNS, i]
        at_a, at_b = a[TARGET_RATE, i], b[TARGET_RATE, i]
        if abs(at_a) > NIL and abs(at_b) > NIL and at_a * at_b > 0.0:
            turns += 1.0
        cost += weights[i] * turns
        travel += joint_travel(a, i) + joint_travel(b, i)
        moves = False
        slowest = np.inf
        for k in range(2):
            leg = a if k == 0 else b
            if leg[LEAST_RATE, i] < -NIL or leg[GREATEST_RATE, i] > NIL:
                moves = True
                if asked.mean_rule:
                    slowest = min(slowest, abs(leg[END_ANGLE, i]) / asked.depth)
                else:
                    slowest = min(slowest, max(leg[LEAST_RATE, i], -leg[GREATEST_RATE, i]))
        if turns == 0.0 and moves:
            margin = min(margin, slowest)
    lack = max(0.0, asked.min_rate - margin)
    if mode == GREATEST_MARGIN:
        return cost, lack, -margin
    if mode == PLUNGE_ROTATION:
        return cost, lack, min(abs(slope_a), abs(slope_b)) * asked.depth
    return cost, lack, travel


@kernel
def is_better(cost, lack, value, than):  # type: ignore[no-untyped-def]
    """Whether fewer reversals, else less lack of motion, else a lower value; `than` holds those three."""
    if abs(cost - than[0]) > 1e-9:
        return cost < than[0]
    if abs(lack - than[1]) > 1e-12:
        return lack < than[1]
    return value < than[2]


@kernel
def survey(arm, plane, psi, fan, weights, asked, mode, branches, out):  # type: ignore[no-untyped-def]
    """The best pair of legs of the fan at every spin, whatever reverses (theory §3).

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        psi: spins at the target [rad], shape (K,).
        fan: `Fan`, from `follow` with slopes between the critical rates.
        weights: see `judge_pair`.
        asked: `Asked`.
        mode: see `judge_pair`.
        branches: whether to look at a branch, shape (8,).
        out: out, shape (8, K, 5): cost, lack and value of the best pair, inf where none can be run, and its slopes.
    """
    cs = np.empty((6, 2))
    theta_s, theta_psi, principal = np.empty(6), np.empty(6), np.empty((2, 6))
    inside = np.empty(MAX_FAN)
    out[:] = np.inf
    for posture in range(4):
        for n in range(psi.shape[0]):
            count = fan.counts[posture, n]
            if count == 0:
                continue
            twist_field(arm, plane, 0.0, psi[n], posture, cs, theta_s, theta_psi)
            controller_angles(arm, cs, False, principal[0])
            controller_angles(arm, cs, True, principal[1])
            legs, fits = fan.legs[posture, n], fan.fits[posture, n]
            for j in range(count):
                inside[j] = np.inf  # at a critical rate the count is a matter of rounding
                if not fan.critical[posture, n, j] and (fits[j, 0] or fits[j, 1]):
                    inside[j] = 0.0
                    for i in range(6):
                        inside[j] += weights[i] * legs[j, TURNS, i]
            for x in range(count):
                for y in range(x + 1):
                    least = inside[x] + inside[y]
                    if least == np.inf or least > max(out[2 * posture, n, 0], out[2 * posture + 1, n, 0]) + 1e-9:
                        continue
                    a, b = fan.slopes[posture, n, x], fan.slopes[posture, n, y]
                    cost, lack, value = judge_pair(legs[x], legs[y], a, b, weights, asked, mode)
                    for flip in range(2):
                        best = out[2 * posture + flip, n]
                        if (
                            branches[2 * posture + flip] and fits[x, flip] and fits[y, flip]
                            and is_better(cost, lack, value, best)
                            and turns_fit(legs[x], legs[y], flip == 1, principal[flip], asked)
                        ):  # fmt: skip
                            best[0], best[1], best[2], best[3], best[4] = cost, lack, value, a, b


@kernel
def judge_point(arm, plane, branch, point, weights, asked, mode, nodes, legs):  # type: ignore[no-untyped-def]
    """`judge_pair` of (psi_t, slope, slope), inf where it cannot be run; `legs` is room for two legs."""
    psi_t, a, b = point
    if asked.psi_bound > 0.0 and (
        max(abs(psi_t), abs(psi_t + a * asked.depth), abs(psi_t + b * asked.depth)) > asked.psi_bound
    ):
        return np.inf, np.inf, np.inf
    if max(abs(a), abs(b)) > asked.steepest:
        return np.inf, np.inf, np.inf
    cs = np.empty((6, 2))
    theta_s, theta_psi, principal = np.empty(6), np.empty(6), np.empty(6)
    if not twist_field(arm, plane, 0.0, psi_t, branch // 2, cs, theta_s, theta_psi):
        return np.inf, np.inf, np.inf
    controller_angles(arm, cs, branch % 2 == 1, principal)
    if not (
        trace_leg(arm, plane, branch, psi_t, a, asked.depth, nodes, legs[0])
        and trace_leg(arm, plane, branch, psi_t, b, asked.depth, nodes, legs[1])
        and turns_fit(legs[0], legs[1], False, principal, asked)
    ):
        return np.inf, np.inf, np.inf
    return judge_pair(legs[0], legs[1], a, b, weights, asked, mode)


@kernel
def refine(arm, plane, branch, point, step, weights, asked, mode, nodes, best):  # type: ignore[no-untyped-def]
    """Compass search from a pair of legs: any of its three figures may move, alone or together, by ever less.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        branch: 0..7.
        point: in and out, shape (3,): psi_t [rad] and the two slopes [rad/m].
        step: of psi_t, to begin with [rad].
        weights: see `judge_pair`.
        asked: `Asked`.
        mode: see `judge_pair`.
        nodes: points on a leg.
        best: out, shape (3,): cost, lack and value.
    """
    legs = np.empty((2, ROWS, 6))
    best[0], best[1], best[2] = judge_point(arm, plane, branch, point, weights, asked, mode, nodes, legs)
    tried = np.empty(3)
    for _ in range(COMPASS_STEPS):
        stuck = True
        for move in range(27):
            tried[0] = point[0] + (move % 3 - 1) * step
            tried[1] = point[1] + (move // 3 % 3 - 1) * step / asked.depth
            tried[2] = point[2] + (move // 9 - 1) * step / asked.depth
            cost, lack, value = judge_point(arm, plane, branch, tried, weights, asked, mode, nodes, legs)
            if is_better(cost, lack, value, best):
                best[0], best[1], best[2] = cost, lack, value
                point[:] = tried
                stuck = False
        if stuck:
            step *= 0.5
