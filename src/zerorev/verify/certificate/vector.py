"""Vectors and turns in ball arithmetic, of numbers (`arb`) and of Taylor series (`arb_series`) alike."""

from __future__ import annotations

from typing import Any, TypeVar

from flint import arb, arb_series

from zerorev.model._arrays import Array
from zerorev.verify.certificate.taylor import Taylor

__all__ = [
    "Axes",
    "Ball",
    "Vector",
    "Vector3",
    "across",
    "axis_angle",
    "columns",
    "combined",
    "cross",
    "dot",
    "onto",
    "scaled",
    "turned",
    "vector",
]

Ball = TypeVar("Ball", arb, arb_series, Taylor)
Vector3 = tuple[Ball, Ball, Ball]
Vector = tuple[arb, arb, arb]
Axes = tuple[Vector, Vector, Vector]
"""A rotation by its columns."""


def vector(values: Array) -> Vector:
    """Three floats as they are."""
    x, y, z = (arb(float(value)) for value in values)
    return x, y, z


def columns(R: Array) -> Axes:
    """The columns of a matrix of floats, shape (3, 3), as they are."""
    x, y, z = (vector(R[:, k]) for k in range(3))
    return x, y, z


def dot(a: Vector3[Ball], b: Vector) -> Ball:
    """Inner product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vector3[Ball], b: Vector3[Ball]) -> Vector3[Ball]:
    """Outer product."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def combined(*terms: tuple[Vector, arb]) -> Vector:
    """Sum of vectors, each times a factor."""
    x, y, z = (sum((v[k] * factor for v, factor in terms), arb(0)) for k in range(3))
    return x, y, z


def onto(axes: Axes, v: Vector) -> Vector:
    """A rotation applied to a vector."""
    return combined(*zip(axes, v, strict=True))


def scaled(v: Vector) -> Vector:
    """A vector made unit."""
    return combined((v, 1 / dot(v, v).sqrt()))


def across(v: Vector, axis: Vector) -> Vector:
    """The part of a vector across a unit axis, made unit."""
    return scaled(combined((v, arb(1)), (axis, -dot(v, axis))))


def turned(v: tuple[Any, Any, Any], axis: tuple[Any, Any, Any], cos: Ball, sin: Ball) -> Vector3[Ball]:
    """A vector, of numbers or of series, turned about a unit axis by the angle of a cosine and a sine (Rodrigues)."""
    along = dot(v, axis)
    x, y, z = (part * along for part in axis)
    a, b, c = v[0] - x, v[1] - y, v[2] - z
    i, j, k = axis
    return x + cos * a + sin * (c * j - b * k), y + cos * b + sin * (a * k - c * i), z + cos * c + sin * (b * i - a * j)


def axis_angle(first: Axes, last: Axes) -> tuple[Vector, arb]:
    """The unit axis and the angle in (0, pi) [rad] of the turn that leads from one rotation to another.

    The axis is not finite where the two may be equal, or half a turn apart.
    """
    # twice the skew part and the trace of last first^T, from the columns
    double = combined(*((cross(a, b), arb(1)) for a, b in zip(first, last, strict=True)))
    trace = sum((dot(a, b) for a, b in zip(first, last, strict=True)), arb(0))
    sine = dot(double, double).sqrt()
    return combined((double, 1 / sine)), arb.atan2(sine, trace - 1)
