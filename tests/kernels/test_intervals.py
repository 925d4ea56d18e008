"""Every operation of interval arithmetic holds what exact arithmetic makes of any points of its arguments."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from zerorev.kernels import intervals as ops
from zerorev.kernels.intervals import LANES

WORK, OUT = 4, 3  # rows


def intervals(rng, signs=(-1.0, 1.0), size=LANES):
    """Rows of intervals of all sizes, some of them points."""
    middle = rng.choice(signs, size) * 10.0 ** rng.uniform(-6, 3, size)
    width = np.where(rng.uniform(size=size) < 0.2, 0.0, np.abs(middle) * 10.0 ** rng.uniform(-16, 1, size))
    return np.concatenate([middle - width, middle + width])


def run(op, rows, constant=0.0, third=0):
    """One operation on rows 0 and 1 (and 2), which also marks what is unknown."""
    work, unknown = np.zeros((WORK, 2 * LANES)), np.zeros((4, LANES))
    work[: len(rows)] = rows
    second = 0 if op in (ops.SCALE, ops.SHIFT) else 1
    ops.run(np.array([[op, OUT, 0, second, third]]), np.array([constant]), work, unknown)
    return work[OUT], unknown


def points(rng, row):
    """A point of each interval, often an end."""
    low, high = row[:LANES], row[LANES:]
    share = rng.choice([0.0, 1.0, rng.uniform()], LANES)
    return np.clip(low + share * (high - low), low, high)


def holds(row, lane, exact):
    return Fraction(row[lane]) <= exact <= Fraction(row[LANES + lane])


EXACT = {
    ops.ADD: lambda a, b: a + b,
    ops.SUB: lambda a, b: a - b,
    ops.MUL: lambda a, b: a * b,
    ops.SQR: lambda a, b: a * a,
}


class TestOperations:
    @pytest.mark.parametrize("op", EXACT)
    def test_hold_the_exact_result(self, op):
        rng = np.random.default_rng(op)
        for _ in range(20):
            rows = [intervals(rng), intervals(rng)]
            out, _ = run(op, rows)
            a, b = (points(rng, row) for row in rows)
            for lane in range(LANES):
                assert holds(out, lane, EXACT[op](Fraction(a[lane]), Fraction(b[lane])))

    @pytest.mark.parametrize("op", [ops.SCALE, ops.SHIFT])
    def test_hold_it_for_any_constant_that_rounds_to_the_one_given(self, op):
        rng = np.random.default_rng(op)
        for _ in range(20):
            row, k = intervals(rng), float(rng.normal() * 10.0 ** rng.uniform(-3, 3))
            out, _ = run(op, [row], constant=k)
            a = points(rng, row)
            for exact in (Fraction(k), Fraction(k) * (1 + Fraction(1, 2**53)), Fraction(k) * (1 - Fraction(1, 2**53))):
                for lane in range(LANES):
                    x = Fraction(a[lane])
                    assert holds(out, lane, exact * x if op == ops.SCALE else exact + x)

    def test_a_root_holds_the_root_of_what_is_not_negative(self):
        rng = np.random.default_rng(1)
        row = intervals(rng)
        out, unknown = run(ops.SQRT, [row], third=ops.OUT_OF_REACH)
        for lane in range(LANES):
            x = max(Fraction(points(rng, row)[lane]), Fraction(0))
            assert Fraction(max(out[lane], 0.0)) ** 2 <= max(x, Fraction(max(row[lane], 0.0)))
            assert Fraction(out[LANES + lane]) ** 2 >= x
            assert bool(unknown[ops.OUT_OF_REACH, lane]) == (row[LANES + lane] < 0)

    @pytest.mark.parametrize("op", [ops.SLOPE, ops.QUOTIENT, ops.RATIO])
    def test_a_quotient_holds_every_quotient_or_says_that_it_is_unbounded(self, op):
        rng = np.random.default_rng(op)
        for _ in range(20):
            rows = [intervals(rng), np.sort(np.abs(intervals(rng)).reshape(2, LANES), axis=0).ravel()]
            rows[1][:LANES] *= rng.choice([0.0, 1.0], LANES, p=[0.2, 0.8])
            out, unknown = run(op, rows, third=ops.DERIVATIVE)
            a, b = (points(rng, row) for row in rows)
            for lane in range(LANES):
                if unknown[ops.DERIVATIVE, lane]:
                    assert rows[1][lane] <= ops.LEAST_DIVISOR
                    continue
                if b[lane] == 0.0:
                    continue
                exact = Fraction(a[lane]) / Fraction(b[lane])
                if op == ops.RATIO and abs(exact) > 1:
                    continue  # a quotient that cannot be
                if abs(exact) < Fraction(ops.UNKNOWN):
                    assert holds(out, lane, exact)

    def test_a_spread_holds_every_point_around(self):
        rng = np.random.default_rng(3)
        a, slope, half = intervals(rng), intervals(rng), np.abs(intervals(rng))
        half[LANES:] = half[:LANES]
        out, _ = run(ops.SPREAD, [a, slope, half], third=2)
        for sign in (-1, 1):
            x, k = points(rng, a), points(rng, slope)
            for lane in range(LANES):
                assert holds(out, lane, Fraction(x[lane]) + sign * Fraction(k[lane]) * Fraction(half[lane]))

    def test_what_is_met_is_in_both_unless_derivatives_are_unknown(self):
        rng = np.random.default_rng(4)
        low = rng.normal(size=LANES)
        rows = np.array([np.append(low - 1, low + 2), np.append(low - 2, low + 1)])
        work, unknown = np.zeros((WORK, 2 * LANES)), np.zeros((4, LANES))
        work[:2] = rows
        unknown[ops.DERIVATIVE, ::2] = 1.0
        ops.run(np.array([[ops.MEET, OUT, 0, 1, 0]]), np.zeros(1), work, unknown)
        known = unknown[ops.DERIVATIVE] == 0
        np.testing.assert_array_equal(work[OUT][:LANES], rows[0][:LANES])
        np.testing.assert_array_equal(work[OUT][LANES:], np.where(known, rows[1][LANES:], rows[0][LANES:]))


class TestAngles:
    def test_an_arc_holds_the_angle_of_every_point_of_its_box(self):
        rng = np.random.default_rng(5)
        for _ in range(50):
            angle, size = rng.uniform(-np.pi, np.pi, LANES), 10.0 ** rng.uniform(-3, 3, LANES)
            wide = size * 10.0 ** rng.uniform(-15, 0, LANES)
            c, s = size * np.cos(angle), size * np.sin(angle)
            rows = [np.append(c - wide, c + wide), np.append(s - wide, s + wide)]
            out, _ = run(ops.ARC, rows)
            x, y = (points(rng, row) for row in rows)
            exact = np.arctan2(y, x)
            turns = 2 * np.pi * np.round((0.5 * (out[:LANES] + out[LANES:]) - exact) / (2 * np.pi))
            unbounded = out[LANES:] >= ops.UNKNOWN
            assert ((out[:LANES] <= exact + turns) & (exact + turns <= out[LANES:]) | unbounded).all()

    def test_cosine_and_sine_hold_every_angle_between(self):
        rng = np.random.default_rng(6)
        for turns in (0.1, 3.0, 40.0):
            low = rng.uniform(-turns, turns, LANES) * 2 * np.pi
            high = low + rng.choice([0.0, 1e-9, 0.3, 3.0, 6.2], LANES)
            cosine, sine = np.zeros((2, 2 * LANES))
            ops.cos_sin_over(low, high, cosine, sine)
            for share in np.linspace(0, 1, 21):
                angle = low + share * (high - low)
                for row, value in ((cosine, np.cos(angle)), (sine, np.sin(angle))):
                    assert ((row[:LANES] <= value) & (value <= row[LANES:])).all()
