"""The least value of a Taylor model over its domain, bounded from below."""

from __future__ import annotations

import numpy as np

from zerorev.model._arrays import Array
from zerorev.verify.certificate.taylor import BOX, ROUNDING, VARIABLES, Taylor

__all__ = ["least", "lowest_at"]


ROUNDS = 4


def least(model: Taylor) -> Array:
    """Bounds below n models, shape (n,); NaN or -inf where a model is not finite.

    Where a polynomial grows or falls along a variable all over the domain, that variable is put to its end, once, again
    and again; the quadratic terms of what is left are bounded by their sizes.
    """
    if model.terms is None:
        return np.asarray(model.c - model.rest)
    linear, quadratic = model.terms[0].copy(), model.terms[1:].copy()
    value = model.c.copy()
    open_ = np.ones((BOX, value.size), dtype=bool)
    for _ in range(BOX):
        # the slope along a variable varies by no more than twice its row of the quadratic terms
        row = np.abs(quadratic[:BOX, :BOX]) * open_
        slack = 2 * (row.sum(axis=1) + np.sqrt((quadratic[:BOX, BOX:] ** 2).sum(axis=1)))
        steady = open_ & (np.abs(linear[:BOX]) > slack * (1 + ROUNDING))
        if not steady.any():
            break
        for k in range(BOX):
            chosen = steady[k]
            end = np.where(chosen, -np.sign(linear[k]), 0.0)
            value += end * linear[k] + end**2 * quadratic[k, k]
            linear += 2 * end * quadratic[k]
            quadratic[k] = np.where(chosen, 0.0, quadratic[k])
            quadratic[:, k] = np.where(chosen, 0.0, quadratic[:, k])
            linear[k] = np.where(chosen, 0.0, linear[k])
        open_ &= ~steady
    row = np.abs(quadratic[:BOX, :BOX])
    mixed = 2 * np.sqrt((quadratic[:BOX, BOX:] ** 2).sum(axis=1)).sum(axis=0)
    box = np.abs(linear[:BOX]).sum(axis=0) + row.sum(axis=(0, 1)) + mixed
    return np.asarray(
        value - box + _ball(linear[BOX:], quadratic[BOX:, BOX:]) - model.rest - 10 * ROUNDING * model.most
    )


def _ball(linear: Array, quadratic: Array) -> Array:
    """Below l x + x' q x over the unit ball of three variables, shape (n,).

    Let n = l / |l| and x = s e - c n with e across n. The sum is -|l| c + a c^2 - 2 c s e'qn + s^2 e'qe with a = n'qn.
    Let |e'qn| <= b and |e'qe| <= g. If 2 a < |l|, it is least at c = sqrt(1 - s^2), and there, since c <= 1 - s^2 / 2,
    no less than -|l| + a - 2 b s + (|l| / 2 - a - g) s^2; which is least at s = b / (|l| / 2 - a - g).
    """
    length = np.sqrt((linear**2).sum(axis=0))
    size = np.sqrt((quadratic**2).sum(axis=(0, 1)))
    crude = -length - size
    with np.errstate(invalid="ignore", divide="ignore"):
        n = linear / length
        qn = (quadratic * n[None]).sum(axis=1)
        along = (n * qn).sum(axis=0)
        across = np.sqrt(((qn - along * n) ** 2).sum(axis=0))
        rest = np.sqrt(np.maximum(size**2 - along**2 - 2 * across**2, 0.0) + ROUNDING * size**2)
        stiff = length / 2 - along - rest
        fine = -length + along - across**2 / stiff
    return np.asarray(np.where(stiff > 0, np.fmax(crude, fine), crude))


def lowest_at(model: Taylor, column: int) -> Array:
    """Where in the domain one model's polynomial is least, or nearly, shape (7,): a guess, on which no proof rests."""
    if model.terms is None:
        return np.zeros(VARIABLES)
    terms = np.nan_to_num(model.terms[..., column])
    linear, quadratic = terms[0], terms[1:]
    x = np.zeros(VARIABLES)
    for _ in range(ROUNDS):
        slope = linear + 2 * quadratic @ x
        length = np.sqrt((slope[BOX:] ** 2).sum())
        x = np.concatenate([-np.sign(slope[:BOX]), -slope[BOX:] / length if length > 0 else np.zeros(3)])
    return x
