"""Rates on a whole piece of an arc, enclosed: a Taylor polynomial at its middle, and a bound of the remainder.

The polynomial's coefficients come from the middle, where the balls are tiny; the remainder from the coefficient of
order n over the whole piece (Lagrange). In Bernstein's form a polynomial lies within the hull of its coefficients, and
the first and the last of them are its values at the ends: so a rate that is least at an end is bounded sharply.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from math import comb
from typing import NamedTuple

import numpy as np
from flint import arb, arb_mat, arb_series, ctx, fmpq

from zerorev.model._arrays import Array
from zerorev.verify.certificate.arm import Body, Setting, body_at, rates
from zerorev.verify.certificate.path import Arc

__all__ = ["NIL_RATE", "Piece", "ball_arithmetic", "bounds", "enclose"]

PRECISION = 128  # bits
NIL_RATE = float(np.deg2rad(1e-9) * 1e3)  # [rad/m]: below it a joint stands still (conventions: signature)
ORDER = 6  # Taylor coefficients of the rates


class Piece(NamedTuple):
    """Bounds of the six rates d theta / d path [rad/m] on a piece of an arc; all shape (6,), rounded outwards.

    Attributes:
        low: no rate on the piece is below.
        high: no rate on the piece is above.
        first: below and above the rates at its begin, shape (2, 6).
        last: the same at its end.
        turned: how far each joint turns on the piece [rad], with sign.
        path: length of the piece [m].
    """

    low: Array
    high: Array
    first: Array
    last: Array
    turned: list[arb]
    path: float

    def sign(self, joint: int) -> int:
        """The sign that a joint's rate has on the whole piece; 0 where none is proven."""
        return int(self.low[joint] > 0) - int(self.high[joint] < 0)

    def all_but_still(self, joint: int) -> bool:
        """Whether a joint's rate is numerically nil on the whole piece."""
        return bool(self.low[joint] >= -NIL_RATE and self.high[joint] <= NIL_RATE)


@contextmanager
def ball_arithmetic() -> Iterator[None]:
    """Set the precision of flint, which is global to the process, and put it back."""
    precision, terms = ctx.prec, ctx.cap
    ctx.prec = PRECISION
    try:
        yield
    finally:
        ctx.prec, ctx.cap = precision, terms


def enclose(setting: Setting, arc: Arc, begin: float, end: float) -> Piece | None:
    """Bounds on the piece between two parameters; None where it is not proven in reach and free of singularities.

    Args:
        setting: arm and posture.
        arc: the arc.
        begin: parameter, a dyadic number.
        end: a greater one.
    """
    half, middle = (arb(end) - arb(begin)) / 2, (arb(end) + arb(begin)) / 2
    try:
        body, whole = _rates(setting, arc, middle + half * arb(0, 1), half, ORDER + 1)
        _, inner = _rates(setting, arc, middle, half, ORDER)
    except ValueError:  # flint's word for a divisor that may be zero
        return None
    if not all(square[0] > 0 for square in body.squares) or not all(rate[ORDER].is_finite() for rate in whole):
        return None
    scale = 1 / (half * arc.length)
    coefficients = _to_bernstein(ORDER) * arb_mat([[rate[k] * scale for rate in inner] for k in range(ORDER)])
    rest = [arb(0, 1) * (rate[ORDER] * scale).abs_upper() for rate in whole]
    hull = [[coefficients[k, joint] + rest[joint] for joint in range(6)] for k in range(ORDER)]
    lower, upper = bounds(hull)
    path = 2 * half * arc.length
    turned = [sum((row[joint] for row in hull), arb(0)) * path / ORDER for joint in range(6)]
    ends = [np.stack([lower[k], upper[k]]) for k in (0, ORDER - 1)]
    return Piece(lower.min(axis=0), upper.max(axis=0), ends[0], ends[1], turned, float(path))


def bounds(balls: list[list[arb]]) -> tuple[Array, Array]:
    """Floats below and above balls; -inf and inf for what is not finite."""
    lower = np.array([[float(ball.lower()) for ball in row] for row in balls])
    upper = np.array([[float(ball.upper()) for ball in row] for row in balls])
    lower, upper = np.nextafter(lower, -np.inf), np.nextafter(upper, np.inf)
    return np.where(np.isnan(lower), -np.inf, lower), np.where(np.isnan(upper), np.inf, upper)


def _rates(setting: Setting, arc: Arc, t: arb, half: arb, terms: int) -> tuple[Body[arb_series], list[arb_series]]:
    """The pose and the rates as series in x, of so many terms, where the parameter of the arc is t + half x."""
    ctx.cap = terms
    pose, twist = arc.around(t, half)
    body = body_at(setting, pose)
    return body, rates(setting, body, twist)


@cache
def _to_bernstein(terms: int) -> arb_mat:
    """From coefficients of x^k, x in [-1, 1], to those of Bernstein's polynomials of y = (x + 1) / 2, in fractions.

    x^k = (2 y - 1)^k = sum_j C(k, j) 2^j (-1)^(k - j) y^j, and y^j = sum_(i >= j) C(i, j) / C(n, j) B_i.
    """
    n = terms - 1

    def share(i: int, k: int) -> fmpq:
        parts = (fmpq(comb(k, j) * 2**j * (-1) ** (k - j) * comb(i, j), comb(n, j)) for j in range(min(i, k) + 1))
        return sum(parts, fmpq(0))

    return arb_mat([[arb(share(i, k)) for k in range(terms)] for i in range(terms)])
