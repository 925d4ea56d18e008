"""The pieces of a motion as Taylor models: where the tool is, and how it moves, for every placement of the part.

The motion is fixed to the part. With the origin O of the part frame in the base, a placement error shifts the part by
p and turns it about O by the rotation vector w: a tip P comes to O + p + R(w) (P - O), a direction d to R(w) d.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
from flint import arb

from zerorev.model._arrays import Array
from zerorev.model.plan import Within
from zerorev.verify.certificate.arm import Pose, Twist
from zerorev.verify.certificate.path import Arc, Quadratic, Turn
from zerorev.verify.certificate.taylor import BOX, ROUNDING, Taylor, no_terms
from zerorev.verify.certificate.vector import Vector3, cross, turned

__all__ = ["Pieces", "Placed", "placed"]

Axes3 = tuple[Vector3[Taylor], Vector3[Taylor], Vector3[Taylor]]


class Pieces(NamedTuple):
    """Parts of arcs, n of them.

    Attributes:
        arc: index of the arc, shape (n,).
        begin: parameters at which they begin, shape (n,).
        end: parameters at which they end, shape (n,).
    """

    arc: Array
    begin: Array
    end: Array


class Placed(NamedTuple):
    """Poses of pieces for all placements.

    Attributes:
        pose: wrist centre and axis 6.
        twist: how the pose moves, per unit of the arc's parameter.
        flange: axes of the flange.
    """

    pose: Pose[Taylor]
    twist: Twist[Taylor]
    flange: Axes3


def placed(arcs: Sequence[Arc], pieces: Pieces, T_base_part: Array, within: Within) -> Placed:
    """The pieces under every placement error within bounds.

    The first variable is the place on the piece, -1 at its begin and 1 at its end; the next three are the shift along
    the axes of the part frame, and the last three the rotation vector, in proportion to their bounds.

    Args:
        arcs: of the motion.
        pieces: which parts of them; n.
        T_base_part: part frame, shape (4, 4), translation [m].
        within: bounds of the placement error.
    """
    chosen = [arcs[k] for k in pieces.arc]
    n = len(chosen)
    half = (pieces.end - pieces.begin) / 2
    t = _variable(n, 0, (pieces.end + pieces.begin) / 2, half)

    def quadratic(parts: Sequence[Quadratic]) -> tuple[Taylor, Taylor]:
        """A quadratic of the arcs' parameter, and its derivative."""
        c0, c1, c2 = (_column(part[k] for part in parts) for k in range(3))
        return c0 + t * (c1 + t * c2), c1 + 2 * (t * c2)

    tip = [quadratic([arc.tip[k] for arc in chosen]) for k in range(3)]
    still = Turn(chosen[0].turns[0].axis, (arb(0), arb(0), arb(0)))
    moved: list[Vector3[Taylor]] = [_columns([arc.rig.lever for arc in chosen])]
    moved += [_columns([arc.rig.flange[k] for arc in chosen]) for k in range(3)]
    zero = Taylor.constant(np.zeros(n))
    turning: Vector3[Taylor] = (zero, zero, zero)
    for k in range(max(len(arc.turns) for arc in chosen)):
        turns = [arc.turns[k] if k < len(arc.turns) else still for arc in chosen]
        axis = _columns([turn.axis for turn in turns])
        angle, rate = quadratic([turn.angle for turn in turns])
        sin, cos = angle.sin_cos()
        *moved, (wx, wy, wz) = [turned(vector, axis, cos, sin) for vector in (*moved, turning)]
        turning = wx + rate * axis[0], wy + rate * axis[1], wz + rate * axis[2]
    lever, *flange = moved
    ux, uy, uz = cross(turning, lever)
    velocity = tip[0][1] + ux, tip[1][1] + uy, tip[2][1] + uz

    origin, axes = T_base_part[:3, 3], T_base_part[:3, :3]
    R = _rotation(n, axes, within.rotation)
    from_origin = tuple(tip[k][0] + lever[k] - float(origin[k]) for k in range(3))
    wrist = [float(origin[k]) + part for k, part in enumerate(_onto(R, from_origin))]
    for k in range(3):
        shift = _variable(n, 1 + k, np.zeros(n), np.full(n, within.position))
        wrist = [part + float(axes[i, k]) * shift for i, part in enumerate(wrist)]
    x, y, z = (_onto(R, axis) for axis in flange)
    return Placed(Pose((wrist[0], wrist[1], wrist[2]), z), Twist(_onto(R, velocity), _onto(R, turning)), (x, y, z))


def _variable(n: int, index: int, middle: Array, half: Array) -> Taylor:
    """A variable scaled: n models."""
    terms = no_terms(n)
    terms[0, index] = half
    return Taylor.polynomial(middle, terms, 0.0)


def _rotation(n: int, axes: Array, bound: float) -> list[list[Taylor]]:
    """The matrix of R(w) = 1 + [w] + [w]^2 / 2 + ..., |w| up to a bound [rad]; w has components along given axes.

    What is left out is, as an operator, |w|^3 / 6 at most: R is a sum of exponentials of i |w|, 0 and -i |w|.
    """
    # component i of w in the base, as coefficients of the three variables
    w = axes * bound
    left_out = bound * bound * bound / 6 * (1 + ROUNDING) + ROUNDING
    rows = []
    for i in range(3):
        row = []
        for j in range(3):
            terms = no_terms(n)
            if i != j:
                k = 3 - i - j
                terms[0, BOX:] = (w[k] if (j - i) % 3 == 2 else -w[k])[:, None]
            # [w]^2 = w w' - |w|^2
            square = (np.outer(w[i], w[j]) + np.outer(w[j], w[i])) / 2 - (i == j) * np.eye(3) * bound * bound
            terms[1 + BOX :, BOX:] = (square / 2)[:, :, None]
            row.append(Taylor.polynomial(np.full(n, float(i == j)), terms, left_out))
        rows.append(row)
    return rows


def _onto(R: list[list[Taylor]], v: Sequence[Taylor]) -> Vector3[Taylor]:
    x, y, z = (row[0] * v[0] + row[1] * v[1] + row[2] * v[2] for row in R)
    return x, y, z


def _column(values: Iterable[arb]) -> Taylor:
    return Taylor.of_balls(list(values))


def _columns(vectors: Sequence[tuple[arb, arb, arb]]) -> Vector3[Taylor]:
    x, y, z = (_column(vector[k] for vector in vectors) for k in range(3))
    return x, y, z
