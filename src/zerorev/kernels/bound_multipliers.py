"""Boxes of pairs of legs, bounded with several conditions at once (theory §3).

A box is dead if one condition fails all over it. But next to the least travel it is conditions that keep it from being
less; boxes reach across them, and the travel beyond, where no motion may go, counts. So conditions g_k >= 0 are added
to the travel f with multipliers l_k >= 0: f - sum l_k g_k is no more than f wherever all conditions are kept, for any
multipliers; with Lagrange's it is level at the optimum, and what a box of width w leaves open is of the order
of w^2 instead of w. Where a few conditions contradict each other the same sum refutes without f (Farkas): no motion
keeps them all where it is positive.

The multipliers of a node are those of the linear programme that its conditions make at the middle of its best pair of
boxes. They are for its halves. A term is a condition with its multiplier: leg, joint, stand-off, direction of the joint
on that leg, and the multiplier of its rate [m]; where that is 0 there is none. A condition that is tightest within the
leg is best seen there: next to it one of the first stand-offs is moved. Conventions are those of `bound_boxes`.
"""

from __future__ import annotations

import numpy as np

from zerorev.kernels._jit import kernel
from zerorev.kernels.bound_boxes import (
    ALONG_SLOPE,
    BACK,
    BY_PSI_HIGH,
    BY_PSI_LOW,
    COLUMNS,
    FORTH,
    HIGH,
    LEAST,
    LOW,
    MAY_BACK,
    MAY_FORTH,
    PER_LEG,
    SAMPLES,
    STRETCH,
    WEIGHED,
    clear,
    place,
    place_along,
    share,
)  # fmt: skip
from zerorev.kernels.intervals import DERIVATIVE, LANES, UNKNOWN, VALUE, run
from zerorev.kernels.legs import NIL
from zerorev.kernels.simplex import CONTRADICTED, FOUND, WIDTH, weighed

MOST_TERMS = 4
LEG, JOINT, SAMPLE, DIRECTION, MULTIPLIER, TERM = range(6)  # columns of a term
ROUNDING = 1e-14  # relative: more than that of the few operations here
UNKNOWNS = 3  # spin at the target, twist of the first leg, twist of the second
MOST_ROWS = 2 * 6 * SAMPLES
CLOSE = 0.02  # [rad] width of a node below which stand-offs are moved
TIGHT = 0.1  # of the greatest along the leg: a rate that is no less is not taken for tight
APART = 1e-3  # of the depth, between two stand-offs
AROUND = 4.0  # half widths of twist about a pair, within which its neighbours are to be level, too


@kernel
def turns_of(one, other, i):  # type: ignore[no-untyped-def]
    """How often a joint reverses at least on a motion of two boxes of legs."""
    fp, bp, fr, br = one[FORTH, i], one[BACK, i], other[FORTH, i], other[BACK, i]
    turns = min(min(fp + br, bp + fr), 1 + min(fp + fr, bp + br))
    if turns == 0 and not ((one[MAY_FORTH, i] and other[MAY_BACK, i]) or (one[MAY_BACK, i] and other[MAY_FORTH, i])):
        turns = 1
    return turns


@kernel
def goes(one, other, i):  # type: ignore[no-untyped-def]
    """Which way a joint goes on the first leg of a motion of two boxes that does not reverse it; 0: that is open."""
    if turns_of(one, other, i) > 0:
        return 0
    return int(one[MAY_FORTH, i] and other[MAY_BACK, i]) - int(one[MAY_BACK, i] and other[MAY_FORTH, i])


@kernel
def least_rate(rules):  # type: ignore[no-untyped-def]
    """What a rate must be at least in a joint's own direction; a joint that stands still does not reverse [rad/m]."""
    return rules.min_rate if rules.min_rate > 0.0 else -NIL


@kernel
def weigh(formulas, rules, terms, of_travel, box, standoffs, by_slope, half_slope, legs):  # type: ignore[no-untyped-def]
    """Add the weighted conditions to the travel of a box, for either leg of a motion.

    Args:
        formulas: whose tape `angles` was run.
        rules: whose threshold counts.
        terms: shape (MOST_TERMS, TERM).
        of_travel: 1.0, or 0.0 where the conditions are to contradict each other.
        box: which one, of those that were placed.
        standoffs: shape (samples,) [m].
        by_slope: derivative of the travel by the slope, at least and at most [m].
        half_slope: of the box [rad/m].
        legs: in and out, row of the box, shape (COLUMNS,); its travel is known.
    """
    rows, unknown, m = formulas.rows, formulas.unknown, least_rate(rules)
    for leg in range(2):
        at = WEIGHED + PER_LEG * leg
        least, low, high = of_travel * legs[LEAST], of_travel * legs[BY_PSI_LOW], of_travel * legs[BY_PSI_HIGH]
        slope_low, slope_high = of_travel * by_slope[0], of_travel * by_slope[1]
        size, psi_size, slope_size = abs(least), max(abs(low), abs(high)), max(abs(slope_low), abs(slope_high))
        known = legs[STRETCH] == 1.0
        for t in range(MOST_TERMS):
            if terms[t, MULTIPLIER] == 0.0 or terms[t, LEG] != leg or not known:
                continue
            i, sample = int(terms[t, JOINT]), int(terms[t, SAMPLE])
            lane, d, s = box * standoffs.shape[0] + sample, terms[t, DIRECTION], standoffs[sample]
            smooth = unknown[DERIVATIVE, lane] == 0.0
            row, den = formulas.rate[1, i], formulas.denominator[1, i]
            if smooth:
                row, den = formulas.rate_middle[i], formulas.denominator_middle[i]
            known = unknown[VALUE, lane] == 0.0 and rows[den, LANES + lane] > 0.0
            if not known:
                continue
            # the condition is on the rate times its denominator; any multiplier is admissible: this is the middle's
            factor = terms[t, MULTIPLIER] / rows[den, LANES + lane]
            most = max(d * rows[row, lane], d * rows[row, LANES + lane])
            most -= min(m * rows[den, lane], m * rows[den, LANES + lane])
            least -= factor * most
            size += factor * abs(most)
            if not smooth:  # next to a singularity: what holds all over the box
                continue
            row, den = formulas.rate_psi[i], formulas.denominator_psi[i]
            a, b = d * rows[row, lane], d * rows[row, LANES + lane]
            c, e = m * rows[den, lane], m * rows[den, LANES + lane]
            psi_low, psi_high = min(a, b) - max(c, e), max(a, b) - min(c, e)
            row = formulas.rate_slope[i]
            a, b = d * rows[row, lane], d * rows[row, LANES + lane]
            by_low, by_high = min(a, b) - s * max(c, e), max(a, b) - s * min(c, e)
            low, high = low - factor * psi_high, high - factor * psi_low
            slope_low, slope_high = slope_low - factor * by_high, slope_high - factor * by_low
            psi_size += factor * max(abs(psi_low), abs(psi_high))
            slope_size += factor * max(abs(by_low), abs(by_high))
        legs[at] = least - ROUNDING * size if known else -UNKNOWN
        legs[at + 1], legs[at + 2] = low - ROUNDING * psi_size, high + ROUNDING * psi_size
        legs[at + 3] = (max(abs(slope_low), abs(slope_high)) + ROUNDING * slope_size) * half_slope


@kernel
def terms_hold(terms, one, other):  # type: ignore[no-untyped-def]
    """Whether the joints of all terms go as these say on every motion of two boxes that does not reverse them."""
    some = False
    for t in range(MOST_TERMS):
        if terms[t, MULTIPLIER] == 0.0:
            continue
        some, i = True, int(terms[t, JOINT])
        forth = (terms[t, DIRECTION] > 0.0) == (terms[t, LEG] == 0.0)  # on the first leg; on the second it comes back
        if goes(one, other, i) != (1 if forth else -1):
            return False
    return some


@kernel
def weighed_pair(one, other, half_psi):  # type: ignore[no-untyped-def]
    """What a first leg and a second leg, each of a box, have at least with the weighted conditions [rad]."""
    a, b = WEIGHED, WEIGHED + PER_LEG
    varies = max(abs(one[a + 1] + other[b + 1]), abs(one[a + 2] + other[b + 2])) * half_psi + one[a + 3] + other[b + 3]
    return one[a] + other[b] - varies * (1.0 + 1e-12)


@kernel
def move_samples(formulas, rules, psi, slope, first_leg, one, other, shares, room):  # type: ignore[no-untyped-def]
    """Move stand-offs to where the rates of a leg are least within it.

    Args:
        formulas: of the posture.
        rules: what is asked.
        psi: spin at the target [rad].
        slope: [rad/m].
        first_leg: whether it is the first of its motion.
        one: what is known of the first leg's box, shape (KNOWN, 6).
        other: of the second's.
        shares: in and out, rising, shape (SAMPLES,).
        room: two rows, each of shape (LANES,).
    """
    rows, (low, high), m, samples = formulas.rows, room, least_rate(rules), rules.samples
    clear(formulas.unknown)
    place_along(rows, formulas.inputs[0], rules, psi, slope, low, high)
    run(formulas.signs, formulas.constants, rows, formulas.unknown)
    for i in range(6):
        d = float(goes(one, other, i)) * (1.0 if first_leg else -1.0)
        if d == 0.0:
            continue
        at, least, most = -1, 0.0, 0.0
        for lane in range(LANES):
            if formulas.unknown[VALUE, lane] != 0.0:
                at, most = -1, 0.0
                break
            value = d * rows[formulas.rate[0, i], lane] - m * rows[formulas.denominator[0, i], lane]
            low[lane] = value
            most = max(most, abs(value))
            if at < 0 or value < least:
                at, least = lane, value
        if at <= 0 or at == LANES - 1 or least > TIGHT * most:
            continue
        # the vertex of the parabola through the least of them and its neighbours
        bend = low[at - 1] - 2.0 * low[at] + low[at + 1]
        place_of = (at + 0.5 + (0.5 * (low[at - 1] - low[at + 1]) / bend if bend > 0.0 else 0.0)) / LANES
        nearest = 1
        for j in range(2, samples - 1):
            if abs(shares[j] - place_of) < abs(shares[nearest] - place_of):
                nearest = j
        if shares[nearest - 1] + APART < place_of < shares[nearest + 1] - APART:
            shares[nearest] = place_of


@kernel
def find_terms(formulas, rules, psi, legs, known, pair, terms, shares, room):  # type: ignore[no-untyped-def]
    """The multipliers of a pair of boxes.

    Args:
        formulas: of the posture.
        rules: what is asked.
        psi: interval of spins at the target, shape (2,).
        legs: boxes, shape (N, COLUMNS).
        known: shape (N, KNOWN, 6).
        pair: which two, shape (2,).
        terms: out, shape (MOST_TERMS, TERM).
        shares: out, where the first stand-offs are, as shares of the depth, shape (SAMPLES,).
        room: two rows, each of shape (LANES,).

    Returns:
        1.0; 0.0 if the conditions contradict each other.
    """
    low, high = room
    rows, unknown, standoffs = formulas.rows, formulas.unknown, np.empty(rules.samples)
    for t in range(MOST_TERMS):
        terms[t, MULTIPLIER] = 0.0
    for j in range(rules.samples):
        shares[j] = share(rules.samples, 0, j)
    middle = 0.5 * (psi[0] + psi[1])
    spins, boxes = np.array([middle, middle]), np.zeros((2, COLUMNS))
    cost, bound = np.zeros(UNKNOWNS), np.ones(UNKNOWNS)
    half = np.array([0.5 * (psi[1] - psi[0]), 0.0, 0.0])
    for leg in range(2):
        box = legs[pair[leg]]
        if box[STRETCH] < 1.0:
            return 1.0
        boxes[leg, LOW] = boxes[leg, HIGH] = 0.5 * (box[LOW] + box[HIGH])
        half[1 + leg] = AROUND * 0.5 * (box[HIGH] - box[LOW]) * rules.depth
        cost[0] += 0.5 * (box[BY_PSI_LOW] + box[BY_PSI_HIGH]) * half[0]
        cost[1 + leg] = box[ALONG_SLOPE] / rules.depth * half[1 + leg]
    if psi[1] - psi[0] < CLOSE and rules.most_cost < rules.least_weight:
        for leg in range(2):
            slope = boxes[leg, LOW]
            move_samples(formulas, rules, middle, slope, leg == 0, known[pair[0]], known[pair[1]], shares, room)
    for j in range(rules.samples):
        standoffs[j] = rules.depth * shares[j]
    clear(unknown)
    place(rows, formulas.inputs[1], False, rules, spins, boxes, 0, 2, standoffs, False, low, high)
    run(formulas.angles, formulas.constants[formulas.starts[1] :], rows, unknown)
    one, other, m = known[pair[0]], known[pair[1]], least_rate(rules)
    at, by, spare = np.zeros((MOST_ROWS, WIDTH), dtype=np.int64), np.zeros((MOST_ROWS, WIDTH)), np.empty(MOST_ROWS)
    which, size, count = np.empty((MOST_ROWS, 4), dtype=np.int64), np.empty(MOST_ROWS), 0  # size: of a row
    for i in range(6):
        way = goes(one, other, i)
        for leg in range(2 if way != 0 else 0):
            d = float(way if leg == 0 else -way)
            for j in range(rules.samples):
                lane = leg * rules.samples + j
                if unknown[VALUE, lane] != 0.0 or unknown[DERIVATIVE, lane] != 0.0:
                    continue
                by_den = m * rows[formulas.denominator_psi[i], lane]
                by_psi = (d * rows[formulas.rate_psi[i], lane] - by_den) * half[0]
                by_twist = d * rows[formulas.rate_slope[i], lane] - standoffs[j] * by_den
                by_twist *= half[1 + leg] / rules.depth
                value = d * rows[formulas.rate_middle[i], lane] - m * rows[formulas.denominator_middle[i], lane]
                most = max(abs(by_psi), abs(by_twist))
                if (
                    most > 0.0
                    and value < abs(by_psi) + abs(by_twist)
                    and rows[formulas.denominator_middle[i], lane] > 0.0
                ):
                    at[count, 1], by[count, 0], by[count, 1] = 1 + leg, by_psi / most, by_twist / most
                    spare[count], size[count] = value / most, most / rows[formulas.denominator_middle[i], lane]
                    which[count, 0], which[count, 1], which[count, 2], which[count, 3] = leg, i, j, int(d)
                    count += 1
    x, held, worth = np.empty(UNKNOWNS), np.empty(UNKNOWNS + 1, dtype=np.int64), np.empty(UNKNOWNS + 1)
    outcome = weighed(cost, -bound, bound, at, by, spare, count, x, held, worth)
    if outcome != FOUND and outcome != CONTRADICTED:
        return 1.0
    for k in range(UNKNOWNS + 1):
        n = held[k]
        if 0 <= n < count and worth[k] > 0.0:
            terms[k, LEG], terms[k, JOINT], terms[k, SAMPLE] = which[n, 0], which[n, 1], which[n, 2]
            terms[k, DIRECTION], terms[k, MULTIPLIER] = which[n, 3], worth[k] / size[n]
    return 1.0 if outcome == FOUND else 0.0
