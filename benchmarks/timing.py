"""Work timed in turns (A B C A B C ...), so that a slow minute of the machine falls on all of it alike."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from statistics import median
from typing import Generic, TypeVar

__all__ = ["Timed", "duration", "in_turns"]

T = TypeVar("T")


@dataclass(frozen=True)
class Timed(Generic[T]):
    """What each round of one piece of work gave, and how long it took.

    Attributes:
        values: one a round.
        seconds: one a round, of the processor's time or as another clock has it.
    """

    values: tuple[T, ...]
    seconds: tuple[float, ...]

    @property
    def median(self) -> float:
        """Median time [s]."""
        return median(self.seconds)

    @property
    def least(self) -> float:
        """Least time [s]: what the work costs where nothing else slows the machine."""
        return min(self.seconds)


def in_turns(
    work: Mapping[str, Callable[[int], T]],
    rounds: int,
    clock: Callable[[], float] = time.process_time,
    least: float = 0.0,
) -> dict[str, Timed[T]]:
    """Run each piece of work once a round, after one run that is not timed (it may compile).

    Args:
        work: by name; called with the number of the round, which serves as the seed of what is random.
        rounds: how many.
        clock: reads the time [s]; where threads share the work, the wall's.
        least: work that is done sooner [s] is done again in the same turn until then, and the turn's mean is taken:
            what takes less than a millisecond would else be timed on caches that the others left full of theirs.
    """
    for call in work.values():
        call(0)
    values: dict[str, list[T]] = {name: [] for name in work}
    seconds: dict[str, list[float]] = {name: [] for name in work}
    for n in range(rounds):
        for name, call in work.items():
            began, runs = clock(), 0
            while runs == 0 or clock() - began < least:
                value, runs = call(n), runs + 1
            seconds[name].append((clock() - began) / runs)
            values[name].append(value)
    return {name: Timed(tuple(values[name]), tuple(seconds[name])) for name in work}


def duration(seconds: float) -> str:
    """A time with three digits and the unit that suits it."""
    for unit, size in (("s", 1.0), ("ms", 1e-3), ("µs", 1e-6)):
        if seconds >= size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds * 1e9:.3g} ns"
