"""Taylor models: polynomials of second degree in seven variables, each with a rigorous bound of what they leave out.

The variables say where on a piece of the motion the tool is, and where the part stands. Over their domain a quantity
differs from its polynomial by no more than its rest. Products and functions carry polynomials on as they are, so that
what cancels does cancel, and only what is of third degree, or rounding, goes into the rest (Makino and Berz, 1998).

Many models are computed at once, in columns of NumPy arrays. Where a column cannot be computed (a divisor that may be
zero), its rest becomes infinite or NaN.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np
from flint import arb

from zerorev.model._arrays import Array

__all__ = ["BOX", "ROUNDING", "VARIABLES", "Taylor", "no_terms"]

VARIABLES = 7
BOX = 4  # the first four variables lie in [-1, 1] each, the last three in the unit ball
ROUNDING = 1e-14  # relative: more than the rounding of one operation on all terms, which is below 40 * 2^-53
LEAST = 1e-150  # more than is lost where squares leave the range of normal numbers


class Taylor:
    """n models: all numbers within `rest` of c + l x + x' q x.

    Attributes:
        c: constant terms, shape (n,) or (1,).
        terms: linear terms l in row 0, quadratic ones q, symmetric, in the others, shape (8, 7, n); None for none.
        rest: how far the polynomial may be off, shape (n,) or (1,).
        bound: no less than the sum of the sizes of all terms, but for factors that `ROUNDING` covers; rough.
    """

    __slots__ = ("__dict__", "bound", "c", "rest", "terms")
    __array_ufunc__ = None  # so that NumPy leaves an array times a model to the model

    def __init__(self, c: Array, terms: Array | None, rest: Array, bound: Array) -> None:
        self.c, self.terms, self.rest, self.bound = c, terms, rest, bound

    @classmethod
    def constant(cls, values: Array) -> Taylor:
        """Numbers that are right but for the last digit or two, shape (n,)."""
        size = np.abs(values)
        return cls(values, None, ROUNDING * size, size)

    @classmethod
    def of_balls(cls, balls: Sequence[arb | float]) -> Taylor:
        """A number each."""
        model = cls.constant(np.array([float(ball) for ball in balls]))
        off = np.array([float(ball.rad()) if isinstance(ball, arb) else 0.0 for ball in balls])
        model.rest = model.rest + off * (1 + ROUNDING)
        return model

    @classmethod
    def side_by_side(cls, models: Sequence[Taylor]) -> Taylor:
        """All columns of several models, each of which has terms."""
        n = max(model.c.size for model in models)
        terms = [no_terms(n) if model.terms is None else model.terms for model in models]
        c, rest, bound = (
            np.concatenate([np.broadcast_to(part, n) for part in parts])
            for parts in zip(*((model.c, model.rest, model.bound) for model in models), strict=True)
        )
        return cls(c, np.concatenate(terms, axis=-1), rest, bound)

    @classmethod
    def polynomial(cls, c: Array, terms: Array, rest: float) -> Taylor:
        """Terms that are right but for their last digits."""
        model = cls(c, terms, np.full(c.shape, rest), np.zeros_like(c))
        model.bound = model.most
        model.rest = model.rest + ROUNDING * model.bound
        return model

    @cached_property
    def size(self) -> Array:
        """Bounds of the linear and of the quadratic part over the domain, shape (2, n)."""
        if self.terms is None:
            return np.zeros((2, *self.c.shape))
        squares = self.terms.reshape(-1, self.terms.shape[-1]) ** 2
        return np.asarray(_PARTS @ np.sqrt(_GROUPS @ squares) + LEAST)

    @cached_property
    def most(self) -> Array:
        """A bound of the polynomial's size over the domain, shape (n,)."""
        return np.asarray(np.abs(self.c) + self.size[0] + self.size[1])

    def __neg__(self) -> Taylor:
        return Taylor(-self.c, None if self.terms is None else -self.terms, self.rest, self.bound)

    def __add__(self, other: Taylor | arb | float) -> Taylor:
        if not isinstance(other, Taylor):
            other = Taylor.of_balls([other])
        bound = self.bound + other.bound
        rest = (self.rest + other.rest) * (1 + ROUNDING) + ROUNDING * bound
        terms = other.terms if self.terms is None else self.terms
        if self.terms is not None and other.terms is not None:
            terms = self.terms + other.terms
        return Taylor(self.c + other.c, terms, rest, bound)

    def __radd__(self, other: arb | float) -> Taylor:
        return self + other

    def __sub__(self, other: Taylor | arb | float) -> Taylor:
        return self + (-other)

    def __rsub__(self, other: arb | float) -> Taylor:
        return -self + other

    def __mul__(self, other: Taylor | arb | float) -> Taylor:
        if not isinstance(other, Taylor):
            other = Taylor.of_balls([other])
        if self.terms is None or other.terms is None:
            return other._times(self) if self.terms is None else self._times(other)
        terms = self.c * other.terms
        terms += other.c * self.terms
        outer = self.terms[0][:, None] * (other.terms[0] * 0.5)
        terms[1:] += outer
        terms[1:] += outer.swapaxes(0, 1)
        (linear_a, quadratic_a), (linear_b, quadratic_b) = self.size, other.size
        bound = self.most * other.most
        rest = linear_a * quadratic_b + quadratic_a * (linear_b + quadratic_b)
        rest += self.most * other.rest + self.rest * (other.most + other.rest)
        return Taylor(self.c * other.c, terms, rest * (1 + ROUNDING) + (ROUNDING * bound + LEAST), bound)

    def __rmul__(self, other: arb | float) -> Taylor:
        return self * other

    def __truediv__(self, other: Taylor | arb | float) -> Taylor:
        return self * (other._inverse() if isinstance(other, Taylor) else 1 / other)

    def __rtruediv__(self, other: arb | float) -> Taylor:
        return self._inverse() * other

    def sqrt(self) -> Taylor:
        """Square root; where a model may be 0 or less, its rest is NaN."""
        root, off = np.sqrt(self.c), self._off
        least = np.where(off < self.c, self.c - off, np.nan)
        # the third derivative is greatest where the argument is least; closer, but for rounding, is the rest of the
        # binomial series there, where all its terms but the first have one sign
        derivative = 1 / (16 * least**2 * np.sqrt(least))
        share = off / self.c
        series = root * (1 - share / 2 - share**2 / 8 - np.sqrt(least / self.c) + 2 * ROUNDING) / off**3
        return self._function(root, 0.5 / root, -0.125 / (self.c * root), np.fmin(derivative, series))

    def sin_cos(self) -> tuple[Taylor, Taylor]:
        """Sine and cosine of an angle [rad]."""
        sin, cos, third = np.sin(self.c), np.cos(self.c), np.full_like(self.c, 1 / 6)
        return self._function(sin, cos, -sin / 2, third), self._function(cos, -sin, -cos / 2, third)

    def atan2(self, other: Taylor) -> Taylor:
        """The angle [rad] whose sine and cosine are in proportion to this model and the other; turns as they fall."""
        length = np.hypot(self.c, other.c)
        sin, cos = Taylor.constant(self.c / length), Taylor.constant(other.c / length)
        # the tangent of the angle that is left when that of the constant terms is taken off
        tangent = (self * cos - other * sin) / (other * cos + self * sin)
        slope = 1 / (1 + tangent.c**2)
        left = tangent._function(np.arctan(tangent.c), slope, -tangent.c * slope**2, np.full_like(length, 1 / 3))
        return left + Taylor.constant(np.arctan2(self.c, other.c))

    def _inverse(self) -> Taylor:
        """1 / x: past the quadratic terms, u^3 / (c^3 x) is left, where u is how far x is off c."""
        inverse, nearest = 1 / self.c, np.abs(self.c) - self._off
        third = np.abs(inverse) ** 3 / np.where(nearest > 0, nearest, np.nan)
        return self._function(inverse, -(inverse**2), inverse**3, third)

    def _function(self, value: Array, first: Array, second: Array, third: Array) -> Taylor:
        """A function of the models by its Taylor series.

        Args:
            value: at the constant terms, shape (n,).
            first: derivative there.
            second: half the second derivative there.
            third: no less than a sixth of the third derivative's size over the domain.
        """
        (linear, quadratic), off = self.size, self._off
        # of the square of l + q + rest all but l^2
        beyond = quadratic + self.rest
        rest = np.abs(first) * self.rest + np.abs(second) * beyond * (2 * linear + beyond) + third * off**3
        bound = np.abs(value) + np.abs(first) * off + np.abs(second) * off**2
        terms = None
        if self.terms is not None:
            terms = first * self.terms
            terms[1:] += (second * self.terms[0])[:, None] * self.terms[0]
        return Taylor(value, terms, rest * (1 + ROUNDING) + (ROUNDING * bound + LEAST), bound)

    @cached_property
    def _off(self) -> Array:
        """How far the models may be off their constant terms."""
        return np.asarray((self.size[0] + self.size[1] + self.rest) * (1 + ROUNDING))

    def _times(self, number: Taylor) -> Taylor:
        """Times models without linear and quadratic terms."""
        factor, size = number.c, np.abs(number.c)
        terms = None if self.terms is None else self.terms * factor
        bound = self.bound * size
        rest = size * self.rest + number.rest * (self.bound + self.rest)
        return Taylor(self.c * factor, terms, rest * (1 + ROUNDING) + (ROUNDING * bound + LEAST), bound)


def no_terms(n: int) -> Array:
    """Room for linear and quadratic terms of n models, all 0."""
    return np.zeros((1 + VARIABLES, VARIABLES, n))


def _norms() -> tuple[Array, Array]:
    """How the linear and the quadratic part are bounded from the squares of their terms.

    A row of the first matrix sums squares of which the root is taken: of one term in the variables of the box; of the
    three that belong to one of these and the ball, or to the ball alone. The second adds up the roots.
    """
    groups: dict[tuple[int, ...], list[int]] = {}
    for row in range(1 + VARIABLES):
        for column in range(VARIABLES):
            kind = tuple(sorted((min(row - 1, BOX), min(column, BOX))))
            groups.setdefault(kind, []).append(row * VARIABLES + column)
    sums, parts = np.zeros((len(groups), (1 + VARIABLES) * VARIABLES)), np.zeros((2, len(groups)))
    for k, ((first, second), members) in enumerate(groups.items()):
        sums[k, members] = 1
        # a term in two variables stands twice in its group, and counts twice: sqrt(2 (q^2 + ...)) sqrt(2)
        parts[int(first >= 0), k] = np.sqrt(2) if 0 <= first != second else 1
    return sums, parts


_GROUPS, _PARTS = _norms()
