"""The best leg on a side of the critical rates: one dimension, the slope (theory §3).

Lengths in m, angles in rad, rates outwards in rad/m. No kernel raises.
`constraints` is a `layout.Constraints` throughout.
"""

from __future__ import annotations

import numpy as np

from zerorev.kernels._jit import kernel, lean
from zerorev.kernels.legs import GREATEST_MARGIN, PLUNGE_ROTATION, ROWS, judge_leg, trace_leg
from zerorev.kernels.order import order_of
from zerorev.kernels.weigh import SIEVE_ERROR, sift, weigh_leg

GEOMETRIC_SLOPES = 12
SLOPES_BETWEEN = 4
MAX_SLOPES = 1 + GEOMETRIC_SLOPES + 6 * SLOPES_BETWEEN
ROOT_STEPS = 24
ROOT_TOLERANCE = 1e-9
GOLDEN_STEPS = 20
GOLDEN = (np.sqrt(5.0) - 1.0) / 2.0


@lean
def slope_candidates(kappa, keep, side, psi_t, constraints, out):  # type: ignore[no-untyped-def]
    """Slopes worth examining on one side of the critical rates of the joints to keep.

    Args:
        kappa: critical rates at the target [rad/m], shape (6,).
        keep: whether a joint must keep its direction, shape (6,).
        side: 1 above, -1 below.
        psi_t: spin at the target [rad].
        constraints: `Constraints`, for the steepest slope and the bound on the spin.
        out: out, shape (MAX_SLOPES,): slopes in order away from the critical rates, the outermost of which, or the
            bound, is the first.

    Returns:
        how many slopes were written.
    """
    # slopes are measured along the side: side * slope, from `nearest` to `farthest`
    nearest, farthest = -constraints.steepest, constraints.steepest
    if constraints.psi_bound > 0.0:
        nearest = max(nearest, (-constraints.psi_bound - side * psi_t) / constraints.depth)
        farthest = min(farthest, (constraints.psi_bound - side * psi_t) / constraints.depth)
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
    at, last = MAX_SLOPES - 7, MAX_SLOPES - 7  # at the end of what is written, in order
    out[at] = nearest
    for i in range(6):
        if not keep[i] and nearest < side * kappa[i] < farthest:
            n = last
            while out[n] > side * kappa[i]:
                out[n + 1] = out[n]
                n -= 1
            out[n + 1] = side * kappa[i]
            last += 1
    outermost = out[last]
    out[0] = side * nearest
    count = 1
    for p in range(at, last):
        for j in range(SLOPES_BETWEEN):
            out[count] = side * (out[p] + (out[p + 1] - out[p]) * (j + 0.5) / SLOPES_BETWEEN)
            count += 1
    span = farthest - outermost
    for j in range(GEOMETRIC_SLOPES):
        out[count] = side * (outermost + span * 1e-4 ** (1.0 - j / (GEOMETRIC_SLOPES - 1.0)))
        count += 1
    return count


@lean
def try_slope(arm, plane, branch, psi_t, slope, demands, constraints, mode, nodes, work, best):  # type: ignore[no-untyped-def]
    """Follow one slope and remember it where it is the best so far.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        branch: 0..7.
        psi_t: spin at the target [rad].
        slope: twist rate [rad/m].
        demands: what the leg must do at this target: (sense, keep, at_target), see `judge_leg`.
        constraints: `Constraints`; limits that are infinite are not examined.
        mode: TRAVEL, GREATEST_MARGIN or PLUNGE_ROTATION.
        nodes: points on a leg.
        work: room for `fields`.
        best: in and out, shape (3,): least cost, its slope, and the greatest margin seen.

    Returns:
        cost: inf where the slope will not do.
        excess: by how much it does [rad/m]; negative where it does not, -inf out of reach.
        margin: see `judge_leg`; beyond a limit, less than asked; -inf out of reach.
    """
    if constraints.turn_inside and constraints.lower[0] > -np.inf:
        margin, slack, travel = _follow(arm, plane, branch, psi_t, slope, demands, constraints, nodes, work)
    else:
        margin, slack, travel = weigh_leg(arm, plane, branch, psi_t, slope, demands, constraints, nodes, work)
    if margin == -np.inf:
        return np.inf, -np.inf, -np.inf
    if slack < 0.0:
        # as if it lacked margin: so there is a way to climb back within the limits
        margin = min(margin, constraints.min_rate + slack / constraints.depth)
    best[2] = max(best[2], margin)
    if margin < constraints.min_rate:
        return np.inf, margin - constraints.min_rate, margin
    cost = travel
    if mode == GREATEST_MARGIN:
        cost = -margin
    elif mode == PLUNGE_ROTATION:
        cost = abs(slope)
    if cost < best[0]:
        best[0], best[1] = cost, slope
    return cost, min(margin - constraints.min_rate, slack / constraints.depth), margin


@kernel
def _follow(arm, plane, branch, psi_t, slope, demands, constraints, nodes, work):  # type: ignore[no-untyped-def]
    """Margin (-inf out of reach), slack and travel of a leg whose joints may come nearest to a limit anywhere."""
    leg = np.empty((ROWS, 6))
    if not trace_leg(arm, plane, branch, psi_t, slope, constraints.depth, nodes, work, leg):
        return -np.inf, -np.inf, np.inf
    return judge_leg(leg, demands[0], demands[1], demands[2], constraints.depth, constraints)


@kernel
def best_leg(arm, plane, branch, psi_t, side, kappa, demands, constraints, mode, nodes, work, best):  # type: ignore[no-untyped-def]
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
        demands: see `try_slope`.
        constraints: `Constraints`.
        mode: TRAVEL, GREATEST_MARGIN or PLUNGE_ROTATION.
        nodes: points on a leg.
        work: room for `fields`.
        best: out, shape (3,): least cost (inf where no slope is admissible), its slope, and the greatest margin seen
            (-inf where none can be run).
    """
    slopes, ceiling, estimate = np.empty(MAX_SLOPES), np.empty(MAX_SLOPES), np.empty(MAX_SLOPES)
    count = slope_candidates(kappa, demands[1], side, psi_t, constraints, slopes)
    best[:] = np.inf, np.nan, -np.inf
    ends = np.empty((MAX_SLOPES, 6))
    sift(arm, plane, branch, psi_t, slopes, count, demands[0], demands[1], constraints, work, ceiling, estimate, ends)
    if mode == GREATEST_MARGIN:
        estimate[:count] = -ceiling[:count]
    elif mode == PLUNGE_ROTATION:
        estimate[:count] = np.abs(slopes[:count])

    # runs of candidates that may do: from the most promising of each on, until one does
    first = 0
    while mode != GREATEST_MARGIN and first < count:
        end = first
        while end < count and ceiling[end] >= constraints.min_rate:
            end += 1
        if end > first:
            least = np.inf
            for j in range(max(first - 1, 0), min(end + 1, count)):
                least = np.minimum(least, estimate[j])
            if least * (1.0 - SIEVE_ERROR) < best[0]:
                for k in order_of(estimate[first:end]):
                    j = first + k
                    cost, excess, _ = try_slope(
                        arm, plane, branch, psi_t, slopes[j], demands, constraints, mode, nodes, work, best
                    )
                    if cost < np.inf:
                        _settle(
                            arm, plane, branch, psi_t, slopes[:count], estimate, j, cost, excess, demands, constraints,
                            mode, nodes, work, best,
                        )  # fmt: skip
                        break
        first = end + 1
    if best[0] < np.inf:
        return

    # none does: climb to the greatest margin, beginning with the candidate that has it
    peak, peak_margin = -1, -np.inf
    for k in range(count):
        estimate[k] = -ceiling[k]
    for j in order_of(estimate[:count]):
        if ceiling[j] <= peak_margin:
            break
        margin = try_slope(arm, plane, branch, psi_t, slopes[j], demands, constraints, mode, nodes, work, best)[2]
        if margin > peak_margin:
            peak, peak_margin = j, margin
    if peak < 0:
        return
    a, b = slopes[max(peak - 1, 0)], slopes[min(peak + 1, count - 1)]
    _golden(arm, plane, branch, psi_t, a, b, True, demands, constraints, mode, nodes, work, best)
    if mode == GREATEST_MARGIN or best[0] == np.inf:
        return
    # a thin interval was found: its ends lie on either side of it, before the next candidates
    found = best[1]
    excess = try_slope(arm, plane, branch, psi_t, found, demands, constraints, mode, nodes, work, best)[1]
    for end in (a, b):
        _interval_end(
            arm, plane, branch, psi_t, found, excess, end, -np.inf, demands, constraints, mode, nodes, work, best
        )


@lean
def _settle(  # type: ignore[no-untyped-def]
    arm, plane, branch, psi_t, slopes, estimate, j, cost, excess, demands, constraints, mode, nodes, work, best
):
    """From an admissible candidate, go to where the cost is least: the end of its interval, or a dip inside."""
    low, high = slopes[j], slopes[j]
    for k in (-1, 1):
        while 0 <= j + k < slopes.shape[0]:
            at_other, lacks, _ = try_slope(
                arm, plane, branch, psi_t, slopes[j + k], demands, constraints, mode, nodes, work, best
            )
            if not at_other < cost:
                break
            # the rough pass was mistaken about which is the cheaper
            low, j, cost, excess = slopes[j], j + k, at_other, lacks
        if not 0 <= j + k < slopes.shape[0]:
            end = slopes[j]
        elif at_other < np.inf:
            end = slopes[j + k]
        else:
            # the cost may fall towards the end of the interval, or dip on the way there
            onward = slopes[j] + 0.1 * (slopes[j + k] - slopes[j])
            falls = (
                try_slope(arm, plane, branch, psi_t, onward, demands, constraints, mode, nodes, work, best)[0] < cost
            )
            if not (falls or estimate[j + k] < estimate[j]):
                end = onward
            else:
                end, at_end = _interval_end(
                    arm, plane, branch, psi_t, slopes[j], excess, slopes[j + k], lacks, demands, constraints, mode,
                    nodes, work, best,
                )  # fmt: skip
                # from the end inwards the cost may still fall
                probe = end + 0.1 * (slopes[j] - end)
                at_probe, _, _ = try_slope(
                    arm, plane, branch, psi_t, probe, demands, constraints, mode, nodes, work, best
                )
                if at_end < cost and at_end <= at_probe:
                    return
        if k < 0:
            low = end
        else:
            high = end
    _golden(arm, plane, branch, psi_t, low, high, False, demands, constraints, mode, nodes, work, best)


@lean
def _golden(arm, plane, branch, psi_t, a, b, climb, demands, constraints, mode, nodes, work, best):  # type: ignore[no-untyped-def]
    """Golden section between two slopes, up to the greatest margin or down to the least cost."""
    x, y = b - GOLDEN * (b - a), a + GOLDEN * (b - a)
    at_x = try_slope(arm, plane, branch, psi_t, x, demands, constraints, mode, nodes, work, best)
    at_y = try_slope(arm, plane, branch, psi_t, y, demands, constraints, mode, nodes, work, best)
    at_a, at_b = np.nan, np.nan
    for _ in range(GOLDEN_STEPS):
        if abs(b - a) < ROOT_TOLERANCE:
            break
        if climb and mode != GREATEST_MARGIN:
            # enough is enough, and where too little can be gained it will not be
            if best[2] >= constraints.min_rate:
                break
            if best[2] + most_gained(a, x, y, b, at_a, at_x[2], at_y[2], at_b) < constraints.min_rate:
                break
        if at_x[2] >= at_y[2] if climb else at_x[0] <= at_y[0]:
            b, at_b = y, at_y[2]
            y, at_y = x, at_x
            x = b - GOLDEN * (b - a)
            at_x = try_slope(arm, plane, branch, psi_t, x, demands, constraints, mode, nodes, work, best)
        else:
            a, at_a = x, at_x[2]
            x, at_x = y, at_y
            y = a + GOLDEN * (b - a)
            at_y = try_slope(arm, plane, branch, psi_t, y, demands, constraints, mode, nodes, work, best)


@lean
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


@lean
def _interval_end(  # type: ignore[no-untyped-def]
    arm, plane, branch, psi_t, inside, f_in, outside, f_out, demands, constraints, mode, nodes, work, best
):
    """Locate where a slope just stops doing: regula falsi (Illinois), bisection where one side cannot be run.

    Returns:
        the last admissible slope, and its cost; inf where that is `inside` itself.
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
        cost, excess, _margin = try_slope(
            arm, plane, branch, psi_t, middle, demands, constraints, mode, nodes, work, best
        )
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
