"""A map cut into chunks: each is one task for a worker, and one file a variable on the disk."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from zerorev.maps.cells import Block
from zerorev.model.map_task import MapTask
from zerorev.model.quantity import quantity

__all__ = ["Chunks"]

LEAST_CHUNKS = 16  # where there are cells enough: so that a small map, too, is shared out evenly
Index = tuple[int, ...]


@dataclass(frozen=True)
class Chunks:
    """The chunks of a map, numbered in the order of its dimensions.

    Attributes:
        task: the map.
        shape: cells of a chunk along each dimension.
    """

    task: MapTask
    shape: Index

    @classmethod
    def of(cls, task: MapTask) -> Chunks:
        """Chunks of so many cells as suit the quantity, long along the last dimensions; the same for the same map."""
        room = max(1, min(quantity(task.question.quantity).chunk, task.cells // LEAST_CHUNKS))
        shape: list[int] = []
        for size in reversed(task.shape):
            shape.insert(0, min(size, room))
            room = max(1, room // shape[0])
        return cls(task, tuple(shape))

    @property
    def grid(self) -> Index:
        """Chunks along each dimension."""
        return tuple(-(-size // each) for size, each in zip(self.task.shape, self.shape, strict=True))

    @property
    def count(self) -> int:
        """How many there are."""
        return int(np.prod(self.grid))

    def place(self, number: int) -> Index:
        """Where a chunk lies in the grid of chunks."""
        return tuple(int(at) for at in np.unravel_index(number, self.grid))

    def box(self, number: int) -> tuple[slice, ...]:
        """The cells of a chunk along each dimension."""
        places = zip(self.place(number), self.shape, self.task.shape, strict=True)
        return tuple(slice(at * each, min((at + 1) * each, size)) for at, each, size in places)

    def extent(self, number: int) -> Index:
        """How many cells of a chunk there are along each dimension."""
        return tuple(part.stop - part.start for part in self.box(number))

    def block(self, number: int) -> Block:
        """What a worker has to know to answer a chunk."""
        index = np.meshgrid(*(np.arange(part.start, part.stop) for part in self.box(number)), indexing="ij")
        cells = np.ravel_multi_index([each.ravel() for each in index], self.task.shape)
        places, directions = np.divmod(cells, len(self.task.directions))
        target_mm = self.task.target_mm(places)
        return Block(number, cells, target_mm / 1e3, self.task.drills[directions], self.task.in_base(target_mm))
