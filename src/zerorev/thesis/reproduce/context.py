"""What every section starts from: robot, tool, how many seeds, and whom to tell how far it is."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import Any, TypeVar

import numba

from zerorev.errors import InputError
from zerorev.files.io import read_robot, read_tool
from zerorev.model.job import Settings
from zerorev.model.robot import Robot
from zerorev.model.tool import Tool

__all__ = ["SEEDS", "Context"]

SEEDS = 100
MOST_SEEDS = 10_000
MAP_SIZE = 100

T = TypeVar("T")
R = TypeVar("R")


@dataclass(frozen=True)
class Context:
    """The thesis' robot and drill, and how much work a section may do.

    Attributes:
        seeds: runs of the swarm from which a rate is estimated; tables of many trials take three tenths as many.
        map_size: cells of the parameter map along each axis.
        kept: what several sections report, so that it is computed once.
        tell: called with (done, total) on the way through a section.
        robot: the thesis' arm.
        tool: the thesis' drill.
    """

    seeds: int = SEEDS
    map_size: int = MAP_SIZE
    kept: dict[Any, Any] = field(default_factory=dict, compare=False)
    tell: Callable[[int, int], None] | None = None
    robot: Robot = field(default_factory=lambda: read_robot("kuka_kr6_r700_2"))
    tool: Tool = field(default_factory=lambda: read_tool("thesis_drill"))

    def __post_init__(self) -> None:
        """Check the numbers."""
        for name, value, most in (("seeds", self.seeds, MOST_SEEDS), ("map size", self.map_size, 1000)):
            if isinstance(value, bool) or not isinstance(value, int) or not 2 <= value <= most:
                raise InputError(f"{name} of {value}", where=name, accepted=f"a whole number, 2 to {most}")

    @property
    def few(self) -> int:
        """Seeds of a table with many rows."""
        return max(2, self.seeds * 3 // 10)

    @property
    def thesis(self) -> Settings:
        """What the exact search is asked: zero reversals, then least travel, without a motion threshold."""
        return Settings(min_rate=0.0, psi_bound=None)

    def each(self, work: Callable[[T], R], items: Iterable[T]) -> list[R]:
        """The work on each of many items, several at a time, telling how far it is.

        Args:
            work: on one item; what it returns must not depend on the others.
            items: in the order of the answers.
        """
        todo = list(items)
        done = []
        pool = ThreadPoolExecutor(numba.get_num_threads(), thread_name_prefix="zerorev-reproduce")
        try:
            for answer in pool.map(work, todo):
                done.append(answer)
                if self.tell is not None:
                    self.tell(len(done), len(todo))
        finally:
            pool.shutdown(cancel_futures=True)
        return done
