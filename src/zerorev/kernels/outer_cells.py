"""Cells of the twist plane: between which slopes every free leg through a cell must stay (theory §4).

A cell is a stretch of stand-offs times an interval of spins, on one posture. For each joint and each direction the
slopes at which it can go that way anywhere in the cell are a half-line, or two where the sign of d theta / d psi is
open, or all; what the six joints have in common is enclosed by one interval. Everything is rounded outwards.

All joints are in model angles, with sin(q5) >= 0. Lengths in m, angles in rad. No kernel raises. `formulas` is a
`zerorev.search.bounds.cells.CellFormulas`, `rules` a `layout.Constraints`, `grid` a
`zerorev.search.bounds.free_legs.Grid` throughout.
"""

from __future__ import annotations

import numpy as np

from zerorev.kernels._jit import kernel
from zerorev.kernels.bound_boxes import PAD
from zerorev.kernels.bound_travel import flipped
from zerorev.kernels.field import BLOCK, PSI, ROOM, STANDOFF, THETA_PSI, THETA_S, cos_sin, fields
from zerorev.kernels.intervals import LANES, OUT_OF_REACH, UNKNOWN, VALUE, cos_sin_over, run

EDGE = 1e-12  # [rad] kept for the rounding of spins
# what is known of a joint in a cell: a slope; the most that the rate at that slope has above the threshold, times the
# denominator, forwards and backwards; how it changes with the slope, at least and at most
AT, FORTH, BACK, LEAST, MOST, RAW = range(6)
MOST_PIECES = 8
_TURN = 2.0 * np.pi
_COS, _SIN, _COS_C, _SIN_C, _STANDOFF, _STANDOFF_C, _ONE, _HALF_PSI, _HALF_STANDOFF = range(9)


@kernel
def tabulate(arm, plane, posture, formulas, rules, grid, slab, column, flips, raw, bent, swing):  # type: ignore[no-untyped-def]
    """What is known of the joints in some cells.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        posture: 0..3.
        formulas: of that posture.
        rules: whose threshold, limits and cap count.
        grid: of the cells.
        slab: of each cell, shape (N,).
        column: of each cell, shape (N,).
        flips: in and out, wrist flips on which a leg may pass a cell, as bits, shape (N,); 0: none.
        raw: out, shape (N, 6, RAW).
        bent: out, how far the elbow is from its singularity, at most, shape (N,) [m^2]: |Delta| of theory §3.
        swing: out, least and greatest angle of each joint, up to whole turns, shape (N, 6, 2) [rad]; or (0, 6, 2): not
            wanted. With joints whose angles the formulas leave out, and where nothing is known, it is not finite.
    """
    work, low, high = np.empty(ROOM), np.empty(LANES), np.empty(LANES)
    rows, unknown, inputs = formulas.rows, formulas.unknown, formulas.inputs
    count = column.shape[0]
    for first in range(0, count, LANES):
        for lane in range(LANES):
            n = min(first + lane, count - 1)
            s, t = grid.edges[slab[n]], grid.edges[slab[n] + 1]
            a = grid.left + column[n] * grid.width
            low[lane], high[lane] = a - EDGE, a + grid.width + EDGE
            middle, psi = 0.5 * (s + t), 0.5 * (low[lane] + high[lane])
            half_psi = 0.5 * grid.width + 2.0 * EDGE
            half_s = 0.5 * (t - s) * (1.0 + 1e-12) + 1e-15
            c, sine = cos_sin(psi)
            _fill(rows, inputs[_COS_C], lane, c - EDGE, c + EDGE)
            _fill(rows, inputs[_SIN_C], lane, sine - EDGE, sine + EDGE)
            _fill(rows, inputs[_STANDOFF], lane, s, t)
            _fill(rows, inputs[_STANDOFF_C], lane, middle, middle)
            _fill(rows, inputs[_ONE], lane, 1.0, 1.0)
            _fill(rows, inputs[_HALF_PSI], lane, half_psi, half_psi)
            _fill(rows, inputs[_HALF_STANDOFF], lane, half_s, half_s)
            work[STANDOFF * BLOCK + lane], work[PSI * BLOCK + lane] = middle, psi
        cos_sin_over(low, high, rows[inputs[_COS]], rows[inputs[_SIN]])
        fields(arm, plane, posture, LANES, work)
        for i in range(6):
            for lane in range(LANES):
                critical = -work[(THETA_S + i) * BLOCK + lane] / work[(THETA_PSI + i) * BLOCK + lane]
                # any slope is admissible: this one makes the enclosure tight
                critical = critical if abs(critical) < np.inf else 0.0
                critical = min(max(critical, -rules.steepest), rules.steepest)
                _fill(rows, formulas.slope[i], lane, critical, critical)
        unknown[:] = 0.0
        run(formulas.tape, formulas.constants, rows, unknown)
        for lane in range(min(LANES, count - first)):
            n = first + lane
            if unknown[OUT_OF_REACH, lane] != 0.0:
                flips[n] = 0
                continue
            known = unknown[VALUE, lane] == 0.0
            _gather(formulas, rules, known, lane, raw[n])
            bent[n] = rows[formulas.denominator[1], LANES + lane]
            for i in range(6):
                at, radius = 0.0, np.inf
                if known and formulas.whole[i] >= 0:
                    at, radius = _angle(formulas, grid, slab[n], lane, i)
                    flips[n] = _within_limits(rules, i, at, radius, flips[n])
                if swing.shape[0] > 0:
                    swing[n, i, 0], swing[n, i, 1] = at - radius, at + radius


@kernel
def _fill(rows, row, lane, low, high):  # type: ignore[no-untyped-def]
    rows[row, lane], rows[row, LANES + lane] = low, high


@kernel
def _gather(formulas, rules, known, lane, raw):  # type: ignore[no-untyped-def]
    """Rates of one lane against the threshold."""
    rows = formulas.rows
    for i in range(6):
        rate, by_slope, den = formulas.rate[i], formulas.by_slope[i], formulas.denominator[i]
        raw[i, AT] = rows[formulas.slope[i], lane]
        m = rules.min_rate
        least = m * (rows[den, lane] if m > 0.0 else rows[den, LANES + lane])
        forth, back = rows[rate, LANES + lane] - least, -rows[rate, lane] - least
        raw[i, FORTH] = forth + (abs(forth) + abs(least)) * 1e-15 if known else UNKNOWN
        raw[i, BACK] = back + (abs(back) + abs(least)) * 1e-15 if known else UNKNOWN
        raw[i, LEAST] = rows[by_slope, lane] if known else -UNKNOWN
        raw[i, MOST] = rows[by_slope, LANES + lane] if known else UNKNOWN


@kernel
def _angle(formulas, grid, slab, lane, i):  # type: ignore[no-untyped-def]
    """Angle of a joint in a cell, up to whole turns: its middle, and how far it may be from there [rad]."""
    rows = formulas.rows
    half_psi = 0.5 * grid.width + 2.0 * EDGE
    half_s = 0.5 * (grid.edges[slab + 1] - grid.edges[slab]) * (1.0 + 1e-12) + 1e-15
    at_low, at_high = rows[formulas.whole[i], lane], rows[formulas.whole[i], LANES + lane]
    mid_low, mid_high = rows[formulas.middle[i], lane], rows[formulas.middle[i], LANES + lane]
    turning, outward = formulas.turning[i], formulas.outward[i]
    by_psi = max(abs(rows[turning, lane]), abs(rows[turning, LANES + lane]))
    by_s = max(abs(rows[outward, lane]), abs(rows[outward, LANES + lane]))
    at, radius = 0.5 * (at_low + at_high), 0.5 * (at_high - at_low)
    if max(by_psi, by_s) < UNKNOWN and mid_high < UNKNOWN:
        varies = by_psi * half_psi + by_s * half_s + 0.5 * (mid_high - mid_low)
        if varies < radius:
            at, radius = 0.5 * (mid_low + mid_high), varies
    return at, (radius + PAD if radius < np.pi else np.inf)


@kernel
def _within_limits(rules, i, at, radius, flips):  # type: ignore[no-untyped-def]
    """On which of some wrist flips an angle may lie within a joint's limits, with any turns."""
    if not radius < np.pi:
        return flips
    for flip in range(2):
        angle = flipped(i, flip, at)
        k = np.ceil((rules.lower[i] - PAD - angle - radius) / _TURN)
        if angle - radius + _TURN * k > rules.upper[i] + PAD:
            flips &= ~(1 << flip)
    return flips


@kernel
def slopes(rules, raw, which, sense, flips, lo, hi):  # type: ignore[no-untyped-def]
    """Between which slopes legs stay whose joints go given ways.

    Args:
        rules: whose cap counts.
        raw: what `tabulate` has found, shape (M, 6, RAW).
        which: of these, shape (N,).
        sense: signs of the outward rates, shape (6,).
        flips: in and out, shape (N,); 0 where there is no slope.
        lo: out, shape (N,) [rad/m].
        hi: out, shape (N,) [rad/m].
    """
    pieces, cut = np.empty((MOST_PIECES, 2)), np.empty((MOST_PIECES, 2))
    for n in range(which.shape[0]):
        lo[n], hi[n] = 1.0, -1.0
        if flips[n] == 0:
            continue
        pieces[0, 0], pieces[0, 1] = -rules.steepest, rules.steepest
        count = 1
        for i in range(6):
            at, forth, back, least, most = raw[which[n], i]
            if sense[i] > 0.0:
                count = _cut(pieces, count, at, forth, least, most, cut)
            else:
                count = _cut(pieces, count, at, back, -most, -least, cut)
            pieces, cut = cut, pieces
        if count == 0:
            flips[n] = 0
            continue
        lo[n], hi[n] = pieces[0]
        for k in range(1, count):
            lo[n], hi[n] = min(lo[n], pieces[k, 0]), max(hi[n], pieces[k, 1])


@kernel
def _cut(pieces, count, at, spare, least, most, out):  # type: ignore[no-untyped-def]
    """Slopes u of some pieces with spare + (u - at) M >= 0 for an M between least and most; how many pieces."""
    if spare >= 0.0 and least <= 0.0 <= most:
        out[:count] = pieces[:count]
        return count
    # from `above` on, or down to `below`
    above, below = np.inf, -np.inf
    if most > 0.0:
        step = -spare / (most if spare < 0.0 else least)
        above = at + step - (abs(at) + abs(step)) * 1e-14
    if least < 0.0:
        step = spare / (-least if spare < 0.0 else -most)
        below = at + step + (abs(at) + abs(step)) * 1e-14
    found = 0
    for k in range(count):
        a, b = pieces[k]
        if max(a, above) <= b and found < MOST_PIECES:
            out[found] = max(a, above), b
            found += 1
        if a <= min(b, below) and below < above:
            if found < MOST_PIECES:
                out[found] = a, min(b, below)
                found += 1
            else:
                out[found - 1] = -np.inf, np.inf
    return found
