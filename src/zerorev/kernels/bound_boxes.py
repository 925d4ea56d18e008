"""Boxes of legs: what is kept of one, and how the tapes are filled in for a few of them (theory §3).

A box is an interval of spins at the target and an interval of slopes, on one posture. It is examined at a few
stand-offs at a time. All joints are in model angles, with sin(q5) >= 0. Lengths in m, angles in rad. No kernel raises.
`formulas` is a `zerorev.search.bounds.rates.Formulas`, `rules` a `layout.BoundRules` throughout.
"""

from __future__ import annotations

import numpy as np

from zerorev.kernels._jit import kernel
from zerorev.kernels.field import cos_sin
from zerorev.kernels.intervals import LANES, cos_sin_over

SAMPLES = 8  # stand-offs at which a box is examined, at most: `rules.samples` says how many

# columns of a box of legs; STRETCH: how much of the depth its stand-offs are spread over; ALONG_SLOPE: derivative of
# the travel by the slope, about
(LOW, HIGH, LEAST, BY_PSI_LOW, BY_PSI_HIGH, BY_SLOPE, TWIST, VALUE_OF, STRETCH, ALONG_SLOPE,
 # the travel less the weighted conditions, for either leg of a motion: by LEAST, BY_PSI_LOW, BY_PSI_HIGH, BY_SLOPE
 WEIGHED) = range(11)  # fmt: skip
PER_LEG = 4
COLUMNS = WEIGHED + 2 * PER_LEG
# what is known of its joints: least turns if it leaves the target forwards, or backwards; whether it may keep the
# threshold forwards, or backwards; turns that fit the limits, on either wrist flip
FORTH, BACK, MAY_FORTH, MAY_BACK, FITS, FITS_FLIPPED, KNOWN = range(7)

ALL_TURNS = 127  # multiples of a turn from -3 to 3
NEVER = 15  # turns of a joint that no leg makes
PAD = 1e-9  # [rad] kept for the rounding of angles and of their sums
EDGE = 1e-14  # [rad] likewise, of spins
GROUPS = 8
# inputs of the tapes
_COS, _SIN, _COS_C, _SIN_C, _STANDOFF, _SLOPE, _SLOPE_C, _HALF_PSI, _HALF_SLOPE, _THRESHOLD = range(10)


@kernel
def share(samples, group, sample):  # type: ignore[no-untyped-def]
    """Where on a leg, as a share of its length, the stand-offs of a group lie: Chebyshev's, then finer and finer."""
    if group == 0:
        return 0.5 * (1.0 - np.cos(np.pi * sample / (samples - 1)))
    if group == 1:
        return 0.5 * (1.0 - np.cos(np.pi * (sample + 0.5) / samples))
    phase = (0.25, 0.75, 0.125, 0.625, 0.375, 0.875)[group - 2]
    return (sample + phase) / samples


@kernel
def place_along(rows, inputs, rules, psi, slope, low, high):  # type: ignore[no-untyped-def]
    """Fill in the inputs of the tape `signs` for one leg, at LANES stand-offs spread evenly over it.

    Args:
        rows: of the tape, shape (R, 2 * LANES).
        inputs: which of them are inputs, shape (10,).
        rules: whose threshold counts.
        psi: spin at the target [rad].
        slope: [rad/m].
        low: room, shape (LANES,).
        high: room, shape (LANES,).
    """
    for lane in range(LANES):
        s = rules.depth * (lane + 0.5) / LANES
        low[lane], high[lane] = psi + s * slope - EDGE, psi + s * slope + EDGE
        c, sine = cos_sin(psi + s * slope)
        _fill(rows, inputs[_STANDOFF], lane, s, s)
        _fill(rows, inputs[_SLOPE], lane, slope, slope)
        _fill(rows, inputs[_COS_C], lane, c - EDGE, c + EDGE)
        _fill(rows, inputs[_SIN_C], lane, sine - EDGE, sine + EDGE)
        _fill(rows, inputs[_SLOPE_C], lane, slope, slope)
        _fill(rows, inputs[_HALF_PSI], lane, 0.0, 0.0)
        _fill(rows, inputs[_HALF_SLOPE], lane, 0.0, 0.0)
        _fill(rows, inputs[_THRESHOLD], lane, rules.min_rate, rules.min_rate)
    cos_sin_over(low, high, rows[inputs[_COS]], rows[inputs[_SIN]])


@kernel
def place(rows, inputs, sweeping, rules, psi, boxes, first, count, standoffs, spread, low, high):  # type: ignore[no-untyped-def]
    """Fill in the inputs of a tape for a few boxes.

    Args:
        rows: of the tape, shape (R, 2 * LANES).
        inputs: which of them are inputs, shape (10,).
        sweeping: whether lanes go from each stand-off to the next.
        rules: whose threshold counts.
        psi: interval of spins at the target, shape (2,).
        boxes: shape (N, COLUMNS).
        first: of the boxes.
        count: of the boxes, at most LANES // samples.
        standoffs: shape (samples,) [m].
        spread: whether each box has them drawn in by its STRETCH.
        low: room, shape (LANES,).
        high: room, shape (LANES,).
    """
    middle, samples = 0.5 * (psi[0] + psi[1]), standoffs.shape[0]
    half_psi = max(psi[1] - middle, middle - psi[0])
    for lane in range(LANES):
        box, sample = first + min(lane // samples, count - 1), lane % samples
        a, b = boxes[box, LOW], boxes[box, HIGH]
        stretch = boxes[box, STRETCH] if spread else 1.0
        s = t = standoffs[sample] * stretch
        if sweeping:
            t = standoffs[min(sample + 1, samples - 1)] * stretch
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
def clear(unknown):  # type: ignore[no-untyped-def]
    """Nothing is unknown yet."""
    for row in range(unknown.shape[0]):
        for lane in range(LANES):
            unknown[row, lane] = 0.0
