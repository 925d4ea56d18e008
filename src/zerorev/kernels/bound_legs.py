"""Boxes of legs: what every leg of a box must do at least (theory §3).

A box is examined at a few stand-offs only: if a joint has the wrong sign at one of them for every leg of the box, no
leg of the box keeps that joint's direction. What happens between those stand-offs is left to the motion itself, which
is followed closely. Conventions are those of `bound_boxes`.
"""

from __future__ import annotations

import numpy as np

from zerorev.kernels._jit import kernel
from zerorev.kernels.bound_boxes import (
    ALL_TURNS,
    BACK,
    BY_PSI_HIGH,
    BY_PSI_LOW,
    BY_SLOPE,
    COLUMNS,
    EDGE,
    FITS,
    FITS_FLIPPED,
    FORTH,
    HIGH,
    KNOWN,
    LEAST,
    LOW,
    MAY_BACK,
    MAY_FORTH,
    NEVER,
    PAD,
    STRETCH,
    TWIST,
    clear,
    place,
    share,
)  # fmt: skip
from zerorev.kernels.bound_travel import examine_travel
from zerorev.kernels.intervals import LANES, OUT_OF_REACH, VALUE, run
from zerorev.kernels.legs import NIL

FIRST_TURN = 1.5 * np.pi  # [rad] of twist, to which the stand-offs of steeper legs are drawn in


@kernel
def examine(formulas, rules, aim, psi, legs, known, count, groups, cuts, room):  # type: ignore[no-untyped-def]
    """Examine boxes of legs, and close the ranks of those that are left after each group of stand-offs.

    Args:
        formulas: of the posture.
        rules: what is asked.
        aim: terms, whether they are added to the travel, and the first stand-offs, see `bound_multipliers`.
        psi: interval of spins at the target, shape (2,).
        legs: in and out, boxes, shape (N, COLUMNS).
        known: out, shape (N, KNOWN, 6).
        count: of the boxes.
        groups: of stand-offs that are examined, at most GROUPS.
        cuts: more stand-offs, as shares of the depth, shape (M,).
        room: whether a box may hold a leg, shape (N,), and two rows, each of shape (LANES,).

    Returns:
        how many boxes are left, and how many passes that took, each at `rules.samples` stand-offs of one box.
    """
    alive, low, high = room
    for n in range(count):
        alive[n] = _begin(rules, psi, legs[n], known[n])
    count, passes = _closed(legs, known, count, alive), 0
    samples_of, boxes = rules.samples, LANES // rules.samples
    standoffs, swept = np.empty(samples_of), np.empty((6, samples_of))
    more = (cuts.shape[0] + samples_of - 1) // samples_of
    for group in range(groups + more):
        for j in range(samples_of):
            if group < groups:
                standoffs[j] = rules.depth * (aim[2][j] if group == 0 else share(samples_of, group, j))
            else:
                standoffs[j] = rules.depth * cuts[min(samples_of * (group - groups) + j, cuts.shape[0] - 1)]
        for first in range(0, count, boxes):
            some = min(boxes, count - first)
            _run(formulas, group == 0, rules, psi, legs, first, some, standoffs, group < groups, low, high)
            for box in range(some):
                n = first + box
                alive[n] = judge_signs(formulas, group == 0, rules, box, group < groups, known[n])
                alive[n] = alive[n] and _least_cost(rules, known[n]) <= rules.most_cost + 1e-9
            if group == 0:
                examine_travel(formulas, rules, aim, psi, legs, known, first, some, standoffs, alive, swept, low, high)
        passes += count
        count = _closed(legs, known, count, alive)
        if count == 0:
            break
    return count, passes


@kernel
def _begin(rules, psi, legs, known):  # type: ignore[no-untyped-def]
    """Nothing is known of a box but its twist; whether a leg of it may exist."""
    for i in range(6):
        known[FORTH, i] = known[BACK, i] = 0
        known[MAY_FORTH, i] = known[MAY_BACK, i] = 1
        known[FITS, i] = known[FITS_FLIPPED, i] = ALL_TURNS
    legs[LEAST] = legs[BY_PSI_LOW] = legs[BY_PSI_HIGH] = legs[BY_SLOPE] = 0.0
    a, b = legs[LOW], legs[HIGH]
    # the tool's angular velocity is the sum of the joints' rates times unit axes: a leg travels its twist
    legs[TWIST] = max(max(a, -b), 0.0) * rules.depth
    # where the spin goes round more than once, the first turn shows what reverses
    legs[STRETCH] = min(1.0, FIRST_TURN / (max(abs(a), abs(b)) * rules.depth + EDGE))
    outside = psi[0] + a * rules.depth > rules.psi_bound + PAD or psi[1] + b * rules.depth < -rules.psi_bound - PAD
    return not (rules.psi_bound > 0.0 and outside)


@kernel
def _closed(legs, known, count, alive):  # type: ignore[no-untyped-def]
    """Close the ranks of the boxes that are left; returns how many these are."""
    left = 0
    for n in range(count):
        if alive[n]:
            if left < n:
                move(legs, known, left, legs, known, n)
            left += 1
    return left


@kernel
def move(legs, known, to, from_legs, from_known, at):  # type: ignore[no-untyped-def]
    """Put a box in another place; element by element, because Numba takes seconds to compile an array's assignment."""
    for k in range(COLUMNS):
        legs[to, k] = from_legs[at, k]
    for row in range(KNOWN):
        for i in range(6):
            known[to, row, i] = from_known[at, row, i]


@kernel
def _run(formulas, first_pass, rules, psi, legs, first, count, standoffs, spread, low, high):  # type: ignore[no-untyped-def]
    """Run the tape `angles` on the first pass, `signs` afterwards."""
    tape = 1 if first_pass else 0
    rows, unknown, constants = formulas.rows, formulas.unknown, formulas.constants[formulas.starts[tape] :]
    clear(unknown)
    place(rows, formulas.inputs[tape], False, rules, psi, legs, first, count, standoffs, spread, low, high)
    if first_pass:
        run(formulas.angles, constants, rows, unknown)
    else:
        run(formulas.signs, constants, rows, unknown)


@kernel
def judge_signs(formulas, first_pass, rules, box, ordered, known):  # type: ignore[no-untyped-def]
    """What the signs of one pass say of a box.

    Args:
        formulas: whose tape was run.
        first_pass: whether it is the first one, at stand-offs from the target on.
        rules: whose threshold counts.
        box: which one, of those that were placed.
        ordered: whether the stand-offs rise.
        known: in and out, shape (KNOWN, 6).

    Returns:
        whether a leg of the box may exist.
    """
    rows, unknown, first = formulas.rows, formulas.unknown, box * rules.samples
    tape = 1 if first_pass else 0
    for lane in range(first, first + rules.samples):
        if unknown[OUT_OF_REACH, lane] != 0.0:
            return False
    for i in range(6):
        rate, den = formulas.rate[tape, i], formulas.denominator[tape, i]
        plus, minus = formulas.plus[tape, i], formulas.minus[tape, i]
        start = changes = last = target = 0
        for sample in range(rules.samples):
            lane = first + sample
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
                if sample == 0:
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
            known[other, i] = max(known[other, i], NEVER if first_pass and target != 0 else changes + 1)
    return True


@kernel
def _least_cost(rules, known):  # type: ignore[no-untyped-def]
    """What the turns of a leg cost by themselves, at least."""
    cost = 0.0
    for i in range(6):
        turns = min(known[FORTH, i], known[BACK, i])
        if turns == 0 and known[MAY_FORTH, i] == 0 and known[MAY_BACK, i] == 0:
            turns = 1
        cost += rules.weights[i] * turns
    return cost
