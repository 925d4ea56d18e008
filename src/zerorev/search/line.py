"""Searches along a line: the bottom of a valley, the way up to enough, the end of where a function is finite."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

__all__ = ["climb", "edge", "golden"]

RATIO = (np.sqrt(5) - 1) / 2


def golden(
    f: Callable[[float], float],
    low: float,
    high: float,
    steps: int,
    enough: Callable[[list[float]], bool] = lambda least: False,
) -> float:
    """Where f is least between low and high, if it has one valley there: golden section.

    Args:
        f: may be infinite outside the valley.
        low: one end.
        high: the other.
        steps: after the first two values.
        enough: called with the least value after each step; says whether to stop.
    """
    x, y = high - RATIO * (high - low), low + RATIO * (high - low)
    fx, fy = f(x), f(y)
    least = [min(fx, fy)]
    for _ in range(steps):
        if enough(least):
            break
        if fx <= fy:
            high, y, fy = y, x, fx
            x = high - RATIO * (high - low)
            fx = f(x)
        else:
            low, x, fx = x, y, fy
            y = low + RATIO * (high - low)
            fy = f(y)
        least.append(min(fx, fy, least[-1]))
    return float(x if fx <= fy else y)


def climb(lack: Callable[[float], float], low: float, high: float, steps: int) -> float:
    """A place between low and high at which nothing is lacking, or where least is.

    It stops as soon as nothing is lacking, or as soon as what is gained has become too little to get there: near the
    bottom of a valley the gains of each step shrink.
    """

    def enough(least: list[float]) -> bool:
        return least[-1] <= 0 or (len(least) > 4 and not least[-4] > 1.2 * least[-1])

    return golden(lack, low, high, steps, enough)


def edge(f: Callable[[float], float], inside: float, outside: float, steps: int) -> float:
    """The last place towards `outside` at which f is finite."""
    if np.isfinite(f(outside)):
        return outside
    for _ in range(steps):
        middle = (inside + outside) / 2
        if np.isfinite(f(middle)):
            inside = middle
        else:
            outside = middle
    return inside
