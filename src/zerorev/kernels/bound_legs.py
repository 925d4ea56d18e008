"""Boxes of legs: what every leg of a box must do at the least (theory §3).

A box is an interval of spins at the target and an interval of slopes, on one posture. It is examined at a few
stand-offs only: if a joint has the wrong sign at one of them for every leg of the box, no leg of the box keeps that
joint's direction. What happens between those stand-offs is left to the motion itself, which is followed closely.

All joints are in model angles, with sin(q5) >= 0. Lengths in m, angles in rad. No kernel raises.
`formulas` is a `zerorev.search.bounds.rates.Formulas`, `rules` a `zerorev.search.bounds.tree.Rules` throughout.
"""

from __future__ import annotations

import numpy as np

from zerorev.kernels._jit import kernel
from zerorev.kernels.field import cos_sin
from zerorev.kernels.intervals import LANES, OUT_OF_REACH, UNKNOWN, VALUE, cos_sin_over, run
from zerorev.kernels.legs import NIL

LOOKS = 8  # stand-offs of one look
BOXES = LANES // LOOKS

# columns of a box of legs
LOW, HIGH, LEAST, BY_PSI_LOW, BY_PSI_HIGH, BY_SLOPE, TWIST, VALUE_OF, COLUMNS = 0, 1, 2, 3, 4, 5, 6, 7, 8
# what is known of its joints: least turns if it leaves the target forwards, or backwards; whether it may keep the
# threshold forwards, or backwards; turns that fit the limits, on either wrist flip
FORTH, BACK, MAY_FORTH, MAY_BACK, FITS, FITS_FLIPPED, KNOWN = range(7)

ALL_TURNS = 127  # multiples of a turn from -3 to 3
NEVER = 15  # turns of a joint that no leg makes
PAD = 1e-9  # [rad] kept for the rounding of angles and of their sums
EDGE = 1e-14  # [rad] likewise, of spins
GROUPS = 8
_TURN = 2.0 * np.pi
# inputs of the tapes
_COS, _SIN, _COS_C, _SIN_C, _STANDOFF, _SLOPE, _SLOPE_C, _HALF_PSI, _HALF_SLOPE, _THRESHOLD = range(10)


@kernel
def share(group, look):  # type: ignore[no-untyped-def]
    """Where on a leg, as a share of its length, the stand-offs of a group lie: Chebyshev's, then finer and finer."""
    if group == 0:
        return 0.5 * (1.0 - np.cos(np.pi * look / (LOOKS - 1)))
    if group == 1:
        return 0.5 * (1.0 - np.cos(np.pi * (look + 0.5) / LOOKS))
    phase = (0.25, 0.75, 0.125, 0.625, 0.375, 0.875)[group - 2]
    return (look + phase) / LOOKS


@kernel
def wrapped(angle):  # type: ignore[no-untyped-def]
    """An angle within half a turn of 0 [rad]."""
    return angle - _TURN * np.rint(angle / _TURN)


@kernel
def place(rows, inputs, sweeping, rules, psi, boxes, first, count, standoffs, low, high):  # type: ignore[no-untyped-def]
    """Fill in the inputs of a tape for a few boxes.

    Args:
        rows: of the tape, shape (R, 2 * LANES).
        inputs: which of them are inputs, shape (10,).
        sweeping: whether lanes go from each stand-off to the next.
        rules: whose threshold counts.
        psi: interval of spins at the target, shape (2,).
        boxes: shape (N, COLUMNS).
        first: of the boxes.
        count: of the boxes, at most BOXES.
        standoffs: shape (LOOKS,) [m].
        low: room, shape (LANES,).
        high: room, shape (LANES,).
    """
    middle = 0.5 * (psi[0] + psi[1])
    half_psi = max(psi[1] - middle, middle - psi[0])
    for lane in range(LANES):
        box, look = first + min(lane // LOOKS, count - 1), lane % LOOKS
        a, b = boxes[box, LOW], boxes[box, HIGH]
        s = t = standoffs[look]
        if sweeping:
            t = standoffs[min(look + 1, LOOKS - 1)]
        low[lane] = psi[0] + min(min(s * a, t * a), min(s * b, t * b)) - EDGE
        high[lane] = psi[1] + max(max(s * a, t * a), max(s * b, t * b)) + EDGE
        _fill(rows, inputs[_STANDOFF], lane, s, t)
        _fill(rows, inputs[_SLOPE], lane, a, b)
        if not sweeping:
            slope = 0.5 * (a + b)
            c, sine = cos_sin(middle + s * slope)
            _fill(rows, inputs[_COS_C], lane, c - EDGE, c + EDGE)
            _fill(rows, inputs[_SIN_C], lane, sine - EDGE, sine + EDGE)
            _fill(rows, inputs[_SLOPE_C], lane, slope, slope)
            half = max(b - slope, slope - a)
            _fill(rows, inputs[_HALF_PSI], lane, half_psi, half_psi)
            _fill(rows, inputs[_HALF_SLOPE], lane, half, half)
            _fill(rows, inputs[_THRESHOLD], lane, rules.min_rate, rules.min_rate)
    cos_sin_over(low, high, rows[inputs[_COS]], rows[inputs[_SIN]])


@kernel
def _fill(rows, row, lane, low, high):  # type: ignore[no-untyped-def]
    if row >= 0:
        rows[row, lane], rows[row, LANES + lane] = low, high


@kernel
def judge_signs(formulas, tape, rules, box, at_target, ordered, known):  # type: ignore[no-untyped-def]
    """What the signs at one look say of a box.

    Args:
        formulas: whose tape was run.
        tape: 0: `signs`, 1: `angles`.
        rules: whose threshold counts.
        box: which one, of those that were placed.
        at_target: whether the first stand-off is the target.
        ordered: whether the stand-offs rise.
        known: in and out, shape (KNOWN, 6).

    Returns:
        whether a leg of the box may exist.
    """
    rows, unknown, first = formulas.rows, formulas.unknown, box * LOOKS
    for lane in range(first, first + LOOKS):
        if unknown[OUT_OF_REACH, lane] != 0.0:
            return False
    for i in range(6):
        rate, den = formulas.rate[tape, i], formulas.denominator[tape, i]
        plus, minus = formulas.plus[tape, i], formulas.minus[tape, i]
        start = changes = last = target = 0
        for look in range(LOOKS):
            lane = first + look
            if unknown[VALUE, lane] != 0.0:
                continue
            nil = NIL * rows[den, LANES + lane]
            sign = 0
            if rows[rate, lane] > nil:
                sign = 1
            elif rows[rate, LANES + lane] < -nil:
                sign = -1
            if sign != 0:
                if start == 0:
                    start = sign
                elif sign != last:
                    changes += 1
                last = sign
                if look == 0:
                    target = sign
            if rules.min_rate > 0.0:
                if rows[plus, LANES + lane] < 0.0:
                    known[MAY_FORTH, i] = 0
                if rows[minus, LANES + lane] < 0.0:
                    known[MAY_BACK, i] = 0
            elif sign > 0:
                known[MAY_BACK, i] = 0
            elif sign < 0:
                known[MAY_FORTH, i] = 0
        if start != 0 and ordered:
            same, other = (FORTH, BACK) if start > 0 else (BACK, FORTH)
            known[same, i] = max(known[same, i], changes)
            known[other, i] = max(known[other, i], NEVER if at_target and target != 0 else changes + 1)
    return True


@kernel
def judge_travel(formulas, rules, psi, box, standoffs, legs, known, swept):  # type: ignore[no-untyped-def]
    """What the angles say of a box: the least travel, how it varies over the box, and the turns that fit the limits.

    Args:
        formulas: whose tape `angles` was run on stand-offs from the target to the outer end.
        rules: whose limits count.
        psi: interval of spins at the target, shape (2,).
        box: which one, of those that were placed.
        standoffs: shape (LOOKS,) [m].
        legs: in and out, row of the box, shape (COLUMNS,).
        known: in and out, shape (KNOWN, 6).
        swept: greatest angle that a joint may move from each stand-off to the next [rad], shape (6, LOOKS).

    Returns:
        whether a leg of the box may exist.
    """
    rows, first = formulas.rows, box * LOOKS
    middle = 0.5 * (psi[0] + psi[1])
    half_psi = max(psi[1] - middle, middle - psi[0]) + EDGE
    slope = 0.5 * (legs[LOW] + legs[HIGH])
    half_slope = max(legs[HIGH] - slope, slope - legs[LOW]) * (1.0 + 1e-12)
    at, slack, radius = np.empty(LOOKS), np.empty(LOOKS), np.empty(LOOKS)
    by_low, by_high, share_of, along = np.empty(LOOKS), np.empty(LOOKS), np.empty(LOOKS), np.empty(LOOKS)
    least = by_psi_low = by_psi_high = by_slope_low = by_slope_high = 0.0
    for i in range(6):
        bounded = True
        for j in range(LOOKS):
            lane = first + j
            share_of[j] = 0.0
            turn_low, turn_high = rows[formulas.turning[i], lane], rows[formulas.turning[i], LANES + lane]
            mid_low, mid_high = rows[formulas.middle[i], lane], rows[formulas.middle[i], LANES + lane]
            all_low, all_high = rows[formulas.whole[i], lane], rows[formulas.whole[i], LANES + lane]
            steepest = max(abs(turn_low), abs(turn_high))
            varies = steepest * (half_psi + standoffs[j] * half_slope)
            around = 0.5 * (all_high - all_low)
            smooth = steepest < UNKNOWN and mid_high < UNKNOWN and formulas.unknown[VALUE, lane] == 0.0
            if smooth and not around < 0.5 * varies:
                at[j], slack[j] = 0.5 * (mid_low + mid_high), 0.5 * (mid_high - mid_low) + 0.1 * PAD
                by_low[j], by_high[j] = turn_low, turn_high
                radius[j] = varies + slack[j] + PAD
            else:
                # next to a singularity or to the edge of reach rates have no bound, but the angle has
                at[j], slack[j] = 0.5 * (all_low + all_high), around + 0.1 * PAD
                by_low[j] = by_high[j] = 0.0
                radius[j] = slack[j] + PAD
            if not radius[j] < 1e3 or formulas.unknown[VALUE, lane] != 0.0:
                bounded = False
        if not bounded:
            continue
        # a joint that may not reverse has one sign, and then a step of 185 deg is not one of 175 deg the other way
        sign = 0
        if rules.most_cost < rules.least_weight:
            sign = known[MAY_FORTH, i] - known[MAY_BACK, i]
        along[0] = wrapped(at[0])
        resolved, sum_of = True, 0.0
        for j in range(1, LOOKS):
            step = wrapped(at[j] - at[j - 1])
            by_psi = max(abs(by_low[j] - by_high[j - 1]), abs(by_high[j] - by_low[j - 1]))
            s, t = standoffs[j - 1], standoffs[j]
            by_slope = max(abs(t * by_low[j] - s * by_high[j - 1]), abs(t * by_high[j] - s * by_low[j - 1]))
            wide = by_psi * half_psi + by_slope * half_slope + slack[j] + slack[j - 1] + 0.1 * PAD
            wide = min(wide, radius[j] + radius[j - 1])
            if sign != 0 and sign * step < -wide:
                step += sign * _TURN
            along[j] = along[j - 1] + step
            farthest = abs(step) + wide
            if sign != 0:
                resolved = resolved and swept[i, j - 1] < _TURN - farthest
                clear = sign * step >= wide and farthest < _TURN
            else:
                resolved = resolved and swept[i, j - 1] < np.pi
                clear = farthest < np.pi
            if not clear:
                resolved = False
            elif abs(step) >= wide:
                direction = 1.0 if step > 0.0 else -1.0
                sum_of += abs(step)
                share_of[j] += direction
                share_of[j - 1] -= direction
        for j in range(LOOKS):
            k = share_of[j]
            sum_of -= abs(k) * slack[j]
            low, high = (k * by_low[j], k * by_high[j]) if k > 0.0 else (k * by_high[j], k * by_low[j])
            by_psi_low += low
            by_psi_high += high
            by_slope_low += standoffs[j] * low
            by_slope_high += standoffs[j] * high
        least += sum_of - PAD
        if not _fits(rules, i, at, along, radius, resolved, known):
            return False
    legs[LEAST], legs[BY_PSI_LOW], legs[BY_PSI_HIGH] = least, by_psi_low - PAD, by_psi_high + PAD
    legs[BY_SLOPE] = max(abs(by_slope_low), abs(by_slope_high)) * half_slope * (1.0 + 1e-12)
    fits = flipped = True
    for i in range(6):
        fits = fits and known[FITS, i] != 0
        flipped = flipped and known[FITS_FLIPPED, i] != 0
    return (fits and rules.flips[0]) or (flipped and rules.flips[1])


@kernel
def _fits(rules, i, at, along, radius, resolved, known):  # type: ignore[no-untyped-def]
    """Which turns of a joint may bring all of a leg within its limits, on either wrist flip; whether any does."""
    for flip in range(2):
        bits = 0
        for k in range(-3, 4):
            fits = True
            for j in range(LOOKS if resolved else 1):
                angle = flipped(i, flip, along[j]) + _TURN * k
                if angle + radius[j] < rules.lower[i] - PAD or angle - radius[j] > rules.upper[i] + PAD:
                    fits = False
                    break
            if fits:
                bits |= 1 << (k + 3)
        for j in range(LOOKS):  # each stand-off by itself, with any turn
            angle = flipped(i, flip, at[j])
            k = np.ceil((rules.lower[i] - PAD - angle - radius[j]) / _TURN)
            if angle - radius[j] + _TURN * k > rules.upper[i] + PAD:
                bits = 0
                break
        known[FITS + flip, i] = bits
    return known[FITS, i] != 0 or known[FITS_FLIPPED, i] != 0


@kernel
def flipped(i, flip, angle):  # type: ignore[no-untyped-def]
    """A model angle on the other wrist flip, if `flip` is 1."""
    if flip == 0 or i < 3:
        return angle
    return -angle if i == 4 else angle + np.pi


@kernel
def examine(formulas, rules, psi, legs, known, first, count, groups, cuts, alive, room):  # type: ignore[no-untyped-def]
    """Look at up to BOXES boxes of legs.

    Args:
        formulas: of the posture.
        rules: what is asked.
        psi: interval of spins at the target, shape (2,).
        legs: in and out, boxes, shape (N, COLUMNS).
        known: out, shape (N, KNOWN, 6).
        first: of the boxes.
        count: of the boxes.
        groups: of stand-offs that are examined, at most GROUPS.
        cuts: more stand-offs, as shares of the depth, shape (M,).
        alive: out, whether a leg of a box may exist, shape (N,).
        room: low and high, each of shape (LANES,).

    Returns:
        how many looks that were, each at LOOKS stand-offs of one box.
    """
    standoffs, swept = np.empty(LOOKS), np.empty((6, LOOKS))
    low, high = room
    for n in range(first, first + count):
        alive[n] = True
        for i in range(6):
            known[n, FORTH, i] = known[n, BACK, i] = 0
            known[n, MAY_FORTH, i] = known[n, MAY_BACK, i] = 1
            known[n, FITS, i] = known[n, FITS_FLIPPED, i] = ALL_TURNS
        legs[n, LEAST] = legs[n, BY_PSI_LOW] = legs[n, BY_PSI_HIGH] = legs[n, BY_SLOPE] = 0.0
        a, b = legs[n, LOW], legs[n, HIGH]
        # the tool's angular velocity is the sum of the joints' rates times unit axes: a leg travels its twist
        legs[n, TWIST] = max(max(a, -b), 0.0) * rules.depth
        if rules.psi_bound > 0.0 and (
            psi[0] + a * rules.depth > rules.psi_bound + PAD or psi[1] + b * rules.depth < -rules.psi_bound - PAD
        ):
            alive[n] = False
    looks = 0
    more = (cuts.shape[0] + LOOKS - 1) // LOOKS
    for group in range(groups + more):
        some = False
        for n in range(first, first + count):
            some = some or alive[n]
        if not some:
            break
        looks += count
        for j in range(LOOKS):
            if group < groups:
                standoffs[j] = rules.depth * share(group, j)
            else:
                standoffs[j] = rules.depth * cuts[min(LOOKS * (group - groups) + j, cuts.shape[0] - 1)]
        tape = 1 if group == 0 else 0
        _run(formulas, tape, rules, psi, legs, first, count, standoffs, low, high)
        for box in range(count):
            n = first + box
            alive[n] = alive[n] and judge_signs(formulas, tape, rules, box, group == 0, group < groups, known[n])
            if alive[n] and _least_cost(rules, known[n]) > rules.most_cost + 1e-9:
                alive[n] = False
        if group == 0:
            _travel(formulas, rules, psi, legs, known, first, count, standoffs, alive, swept, low, high)
    return looks


@kernel
def _clear(unknown):  # type: ignore[no-untyped-def]
    for row in range(unknown.shape[0]):
        for lane in range(LANES):
            unknown[row, lane] = 0.0


@kernel
def _run(formulas, tape, rules, psi, legs, first, count, standoffs, low, high):  # type: ignore[no-untyped-def]
    """Run the tape `signs` (0) or `angles` (1)."""
    rows, unknown, constants = formulas.rows, formulas.unknown, formulas.constants[formulas.starts[tape] :]
    _clear(unknown)
    place(rows, formulas.inputs[tape], False, rules, psi, legs, first, count, standoffs, low, high)
    if tape == 0:
        run(formulas.signs, constants, rows, unknown)
    else:
        run(formulas.angles, constants, rows, unknown)


@kernel
def _travel(formulas, rules, psi, legs, known, first, count, standoffs, alive, swept, low, high):  # type: ignore[no-untyped-def]
    """Judge the travel of the boxes whose tape `angles` was run."""
    some = False
    for n in range(first, first + count):
        some = some or alive[n]
    if not some:
        return
    rows, unknown = formulas.sweep_rows, formulas.sweep_unknown
    _clear(unknown)
    place(rows, formulas.inputs[2], True, rules, psi, legs, first, count, standoffs, low, high)
    run(formulas.sweep, formulas.constants[formulas.starts[2] :], rows, unknown)
    for box in range(count):
        n = first + box
        if not alive[n]:
            continue
        for i in range(6):
            row = formulas.swept[i]
            for j in range(LOOKS - 1):
                lane = box * LOOKS + j
                most = max(abs(rows[row, lane]), abs(rows[row, LANES + lane]))
                swept[i, j] = UNKNOWN if unknown[VALUE, lane] != 0.0 else most * (standoffs[j + 1] - standoffs[j])
        alive[n] = judge_travel(formulas, rules, psi, box, standoffs, legs[n], known[n], swept)


@kernel
def _least_cost(rules, known):  # type: ignore[no-untyped-def]
    """What the turns of a leg cost by themselves, at the least."""
    cost = 0.0
    for i in range(6):
        turns = min(known[FORTH, i], known[BACK, i])
        if turns == 0 and known[MAY_FORTH, i] == 0 and known[MAY_BACK, i] == 0:
            turns = 1
        cost += rules.weights[i] * turns
    return cost
