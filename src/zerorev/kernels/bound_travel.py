"""What the angles on a box of legs say: the least travel, and the turns that fit the limits (theory §3).

Conventions are those of `bound_boxes`.
"""

from __future__ import annotations

import numpy as np

from zerorev.kernels._jit import kernel
from zerorev.kernels.bound_boxes import (
    ALONG_SLOPE,
    BY_PSI_HIGH,
    BY_PSI_LOW,
    BY_SLOPE,
    EDGE,
    FITS,
    FITS_FLIPPED,
    HIGH,
    LEAST,
    LOW,
    MAY_BACK,
    MAY_FORTH,
    PAD,
    STRETCH,
    clear,
    place,
)  # fmt: skip
from zerorev.kernels.bound_multipliers import weigh
from zerorev.kernels.intervals import LANES, UNKNOWN, VALUE, run

_TURN = 2.0 * np.pi


@kernel
def wrapped(angle):  # type: ignore[no-untyped-def]
    """An angle within half a turn of 0 [rad]."""
    return angle - _TURN * np.rint(angle / _TURN)


@kernel
def examine_travel(formulas, rules, aim, psi, legs, known, first, count, standoffs, alive, swept, low, high):  # type: ignore[no-untyped-def]
    """Judge the travel of the boxes whose tape `angles` was run."""
    some = False
    for n in range(first, first + count):
        some = some or alive[n]
    if not some:
        return
    rows, unknown, at = formulas.sweep_rows, formulas.sweep_unknown, np.empty(rules.samples)
    clear(unknown)
    place(rows, formulas.inputs[2], True, rules, psi, legs, first, count, standoffs, True, low, high)
    run(formulas.sweep, formulas.constants[formulas.starts[2] :], rows, unknown)
    for box in range(count):
        n = first + box
        if not alive[n]:
            continue
        for j in range(rules.samples):
            at[j] = standoffs[j] * legs[n, STRETCH]
        for i in range(6):
            row = formulas.swept[i]
            for j in range(rules.samples - 1):
                lane = box * rules.samples + j
                most = max(abs(rows[row, lane]), abs(rows[row, LANES + lane]))
                swept[i, j] = UNKNOWN if unknown[VALUE, lane] != 0.0 else most * (at[j + 1] - at[j])
        alive[n] = judge_travel(formulas, rules, aim, psi, box, at, legs[n], known[n], swept)


@kernel
def judge_travel(formulas, rules, aim, psi, box, standoffs, legs, known, swept):  # type: ignore[no-untyped-def]
    """What the angles say of a box: the least travel, how it varies over the box, and the turns that fit the limits.

    Args:
        formulas: whose tape `angles` was run on stand-offs from the target outwards.
        rules: whose limits count.
        aim: terms, whether they are added to the travel, and the first stand-offs, see `bound_multipliers`.
        psi: interval of spins at the target, shape (2,).
        box: which one, of those that were placed.
        standoffs: shape (samples,) [m].
        legs: in and out, row of the box, shape (COLUMNS,).
        known: in and out, shape (KNOWN, 6).
        swept: greatest angle that a joint may move from each stand-off to the next [rad], shape (6, samples).

    Returns:
        whether a leg of the box may exist.
    """
    samples, (terms, of_travel, _) = rules.samples, aim
    rows, first = formulas.rows, box * samples
    middle = 0.5 * (psi[0] + psi[1])
    half_psi = max(psi[1] - middle, middle - psi[0]) + EDGE
    slope = 0.5 * (legs[LOW] + legs[HIGH])
    half_slope = max(legs[HIGH] - slope, slope - legs[LOW]) * (1.0 + 1e-12)
    at, slack, radius = np.empty(samples), np.empty(samples), np.empty(samples)
    by_low, by_high, share_of, along = np.empty(samples), np.empty(samples), np.empty(samples), np.empty(samples)
    least = by_psi_low = by_psi_high = by_slope_low = by_slope_high = 0.0
    for i in range(6):
        bounded = True
        for j in range(samples):
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
        for j in range(1, samples):
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
        for j in range(samples):
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
    legs[ALONG_SLOPE] = 0.5 * (by_slope_low + by_slope_high)
    weigh(formulas, rules, terms, of_travel, box, standoffs, (by_slope_low, by_slope_high), half_slope, legs)
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
            for j in range(at.shape[0] if resolved else 1):
                angle = flipped(i, flip, along[j]) + _TURN * k
                if angle + radius[j] < rules.lower[i] - PAD or angle - radius[j] > rules.upper[i] + PAD:
                    fits = False
                    break
            if fits:
                bits |= 1 << (k + 3)
        for j in range(at.shape[0]):  # each stand-off by itself, with any turn
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
