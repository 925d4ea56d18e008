"""Inertia schemes of the particle swarm: how much of its velocity a particle keeps (W_in of thesis eq. 4.6, Table 3).

The weights of a whole run are drawn beforehand: W_in(0) makes the first new velocity, W_in(1) the next.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Protocol

import numpy as np

from zerorev.errors import InputError
from zerorev.model._arrays import Array

__all__ = ["INERTIA", "Chaotic", "Constant", "Geometric", "Inertia", "Linear", "Random", "inertia_named"]


class Inertia(Protocol):
    """One scheme."""

    def weights(self, count: int, rng: np.random.Generator) -> Array:
        """W_in(0), W_in(1), ..., shape (count,), for a run of so many iterations."""
        ...


class _Scheme:
    """Checks the numbers of a scheme."""

    def __post_init__(self) -> None:
        for each in fields(self):  # type: ignore[arg-type]
            value = getattr(self, each.name)
            if not 0 <= value < np.inf:
                raise InputError(f"{value!r} is out of range", where=f"inertia, {each.name}", accepted="0 or more")


@dataclass(frozen=True)
class Constant(_Scheme):
    """The same at every iteration; the thesis found that it stops short at local minima (sec. 4.5)."""

    value: float = 0.7

    def weights(self, count: int, rng: np.random.Generator) -> Array:
        """One value."""
        return np.full(count, self.value)


@dataclass(frozen=True)
class Random(_Scheme):
    """Drawn again at every iteration, for the whole swarm: low + rand() * (high - low)."""

    low: float = 0.5
    high: float = 1.0

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.low > self.high:
            raise InputError(f"{self.low:g} to {self.high:g} is the wrong way round", where="inertia, low",
                             accepted="low <= high")  # fmt: skip

    def weights(self, count: int, rng: np.random.Generator) -> Array:
        """Uniform draws."""
        return rng.uniform(self.low, self.high, count)


@dataclass(frozen=True)
class Geometric(_Scheme):
    """W_in(t) = factor * W_in(t - 1): decaying for a factor below 1, growing above it."""

    first: float = 0.7
    factor: float = 0.95

    def weights(self, count: int, rng: np.random.Generator) -> Array:
        """A geometric sequence."""
        return np.asarray(self.first * self.factor ** np.arange(count))


@dataclass(frozen=True)
class Linear(_Scheme):
    """From first to last in a straight line over the iterations: 0.7 - 0.7 t / 50 in the thesis' trial 8."""

    first: float = 0.7
    last: float = 0.0

    def weights(self, count: int, rng: np.random.Generator) -> Array:
        """An arithmetic sequence that would reach `last` one step after its end."""
        return self.first + (self.last - self.first) * np.arange(count) / max(count, 1)


@dataclass(frozen=True)
class Chaotic(_Scheme):
    """Descending, with a share of the logistic map z -> 4 z (1 - z): (first - last) (1 - t / count) + last * z(t).

    The chaotic scheme that the thesis' source recommends for accuracy (its reference 35; Feng et al. 2007); z(0) is
    random.
    """

    first: float = 0.9
    last: float = 0.4

    def weights(self, count: int, rng: np.random.Generator) -> Array:
        """A chaotic sequence."""
        z = np.empty(count)
        value = rng.uniform(0.05, 0.2)  # clear of 0, 1/4, 1/2, 3/4 and 1, where the map stands still sooner or later
        for t in range(count):
            value = 4 * value * (1 - value)
            z[t] = value
        return (self.first - self.last) * (1 - np.arange(count) / max(count, 1)) + self.last * z


INERTIA: dict[str, Inertia] = {
    "random": Random(),
    "decaying": Geometric(0.7, 0.95),
    "growing": Geometric(0.1, 1.05),
    "linear": Linear(),
    "constant": Constant(),
    "chaotic": Chaotic(),
}
"""The schemes by name, with the numbers of the thesis' Table 3 where it has any."""


def inertia_named(name: str) -> Inertia:
    """The scheme of this name.

    Raises:
        InputError: there is none.
    """
    if name not in INERTIA:
        raise InputError(f"unknown inertia scheme {name!r}", where="inertia", accepted=", ".join(INERTIA))
    return INERTIA[name]
