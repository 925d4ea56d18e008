"""One run of a search method: an objective within a box, counted, cut off at a budget, the best motion kept.

A library's own limits of evaluations are meant in different ways (checked after a generation, without the local search,
...). Here every method may look at as many motions as it likes, and is stopped from outside: all have the same budget,
and what counts is the best motion that the method has seen.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from typing import Protocol

import numpy as np

from zerorev.model._arrays import Array

__all__ = ["Algorithm", "Scoring", "Trial"]


class Scoring(Protocol):
    """What is to be least: scores of motions given by (psi_start, psi_target, psi_end) [rad], (M, 3) -> (M,)."""

    def __call__(self, spins: Array, /) -> Array:
        """Score the motions."""
        ...


class _SpentError(Exception):
    """The budget is spent: ends an algorithm, and never leaves `Trial.run`."""


class Trial:
    """An objective as an algorithm sees it.

    Attributes:
        low: least spins [rad], shape (3,).
        high: greatest spins [rad], shape (3,).
        best: the best motion seen so far [rad], shape (3,), the first of equals; NaN before the first.
        score: its score.
        left: evaluations that the budget still holds.
    """

    def __init__(self, objective: Scoring, budget: int, low: Array, high: Array) -> None:
        self.objective, self.left, self.low, self.high = objective, budget, low, high
        self.best, self.score = np.full(3, np.nan), np.inf

    def __call__(self, spins: Array) -> Array:
        """Score motions, shape (M, 3) -> (M,); ends the algorithm with the last that the budget holds."""
        spins = np.ascontiguousarray(spins[: self.left], dtype=float)
        scores = self.objective(spins)
        self.left -= len(spins)
        least = int(np.argmin(scores))
        if scores[least] < self.score:
            self.best, self.score = spins[least].copy(), float(scores[least])
        if self.left == 0:
            raise _SpentError
        return scores

    def one(self, spins: Array) -> float:
        """Score one motion, shape (3,), for libraries that know no more at a time."""
        return float(self(spins[None])[0])

    def run(self, algorithm: Algorithm, seed: int) -> Trial:
        """Let an algorithm look for the best motion, until it stops or the budget is spent; returns itself.

        Args:
            algorithm: which.
            seed: of all that is random in it.
        """
        with suppress(_SpentError):
            algorithm(self, seed)
        return self


Algorithm = Callable[[Trial, int], None]
"""Calls the trial with motions, as it likes; the second argument is its seed."""
