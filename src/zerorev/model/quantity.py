"""What a map may be asked: each quantity is stated once, beside what computes it, and known by its name.

A room that computes quantities names them as an entry point of the group `zerorev.quantities`, and so may any other
package: files, maps, pages and the app take them from here.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from importlib.metadata import entry_points
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from zerorev.errors import InputError
from zerorev.model.hole import Hole
from zerorev.model.profile import Profile

if TYPE_CHECKING:
    from zerorev.model.map_task import Question

__all__ = ["Found", "Quantity", "in_words", "quantities", "quantity"]

GROUP = "zerorev.quantities"


class Found(NamedTuple):
    """The answer of a cell.

    Attributes:
        value: in the unit of the quantity.
        branch: 0..7.
        profile: the motion; or None, where there is but a spin at the target.
        psi_target: spin there [rad].
    """

    value: float
    branch: int
    profile: Profile | None
    psi_target: float


@dataclass(frozen=True)
class Quantity:
    """What is wanted in each cell of a map.

    Attributes:
        name: in map files.
        variable: its name in the dataset.
        unit: of the number; `1`: a count.
        title: in words.
        digits: after the point, as shown.
        more_is_better: whether a greater number is the better one.
        solve: finds it in a hole; the last argument is a seed.
        nothing: what a cell without an answer counts as beside one that has one; NaN: the two are not compared.
        needs_depth: whether it is asked at a depth.
        free_legs: whether legs may be free.
        cycles: whether chips may be broken on the way.
        seeded: whether it depends on a seed.
        chunk: cells of a chunk, at most: some seconds of work.
        offered: whether the app offers it.
    """

    name: str
    variable: str
    unit: str
    title: str
    digits: int
    more_is_better: bool
    solve: Callable[[Question, Hole, int], Found | None]
    nothing: float = np.nan
    needs_depth: bool = False
    free_legs: bool = True
    cycles: bool = True
    seeded: bool = False
    chunk: int = 256
    offered: bool = True

    @property
    def label(self) -> str:
        """For an axis."""
        return f"{self.title} [{self.unit}]"

    def shown(self, value: float) -> str:
        """A number with its unit."""
        return f"{value + 0.0:.{self.digits}f}" + ("" if self.unit == "1" else f" {self.unit}")


@cache
def quantities() -> dict[str, Quantity]:
    """All quantities that are installed, by their names."""
    groups = sorted(entry_points(group=GROUP), key=lambda each: each.name)
    return {each.name: each for group in groups for each in group.load()}


def quantity(name: str) -> Quantity:
    """The quantity of a name.

    Raises:
        InputError: there is none.
    """
    known = quantities()
    if name not in known:
        raise InputError(f"unknown quantity '{name}'", where="quantity", accepted=", ".join(known))
    return known[name]


def in_words(wanted: Callable[[Quantity], bool], last: str) -> str:
    """The names of some quantities: `a, b and c`.

    Args:
        wanted: which.
        last: the word before the last one.
    """
    *names, end = [name for name, each in quantities().items() if wanted(each)]
    return f"{', '.join(names)} {last} {end}" if names else end
