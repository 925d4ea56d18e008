"""What stands around the arm, as the settings have it; without numpy, for the help of the commands reads them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from zerorev.errors import InputError

if TYPE_CHECKING:
    from zerorev.model.body import Obstacle

__all__ = ["NOTHING_AROUND", "Surroundings"]


@dataclass(frozen=True)
class Surroundings:
    """What stands around the arm.

    Attributes:
        obstacles: the part, fixtures and the floor; their ids differ.
    """

    obstacles: tuple[Obstacle, ...] = ()

    def __post_init__(self) -> None:
        """Check that the ids differ."""
        seen: set[str] = set()
        for obstacle in self.obstacles:
            if obstacle.id in seen:
                raise InputError(f"the id '{obstacle.id}' is used twice", where="fixtures", accepted="ids that differ")
            seen.add(obstacle.id)

    @property
    def part(self) -> Obstacle | None:
        """The part, where its shape is known."""
        return next((one for one in self.obstacles if one.kind == "part"), None)


NOTHING_AROUND = Surroundings()
