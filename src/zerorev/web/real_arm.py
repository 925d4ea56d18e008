"""What a page knows of the real arm, and what was simulated with it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from zerorev.model.ranges import Cell

if TYPE_CHECKING:
    from zerorev.cell.ensemble import HoleStudy
    from zerorev.cell.possible import Arms
    from zerorev.model.hole import Hole
    from zerorev.model.job import Settings
    from zerorev.web.state import State, Steered

__all__ = ["Asked", "RealArm", "Simulated", "outdated"]


@dataclass(frozen=True)
class Asked:
    """What a simulation is asked for.

    Attributes:
        arms: how many possible ones are drawn.
        seed: that they are drawn with.
        feed: of both legs [m/s]; None: as planned.
        thrust: of the drill while it cuts [N].
    """

    arms: int
    seed: int
    feed: float | None
    thrust: float


@dataclass(frozen=True)
class Simulated:
    """What possible arms make of one motion of a hole.

    Attributes:
        hole: as it was then.
        motion: likewise.
        settings: likewise.
        cell: what was known of the arm.
        asked: how it was simulated.
        arms: the possible ones.
        study: of those arms that are finished.
    """

    hole: Hole
    motion: Steered
    settings: Settings
    cell: Cell
    asked: Asked
    arms: Arms
    study: HoleStudy


@dataclass(frozen=True)
class RealArm:
    """What is known of the arm, and what was found with it.

    Attributes:
        cell: ranges of what is not known of it.
        file: name of the cell file that says so; empty: all are priors.
        simulated: of the holes that were, by their id: the last of each.
    """

    cell: Cell = field(default_factory=Cell)
    file: str = ""
    simulated: Mapping[str, Simulated] = field(default_factory=lambda: MappingProxyType({}))


def outdated(of: Simulated, state: State, motion: Steered | None) -> str | None:
    """What has changed since a simulation, in words; None: it is of what is shown.

    Args:
        of: the simulation.
        state: of the page.
        motion: that it shows.
    """
    if state.job is None or of.hole is not state.hole:
        return "the hole has changed since"
    if motion is None or not _same(of.motion, motion):
        return "the motion has changed since"
    if of.settings != state.job.settings:
        return "the settings have changed since"
    return None if of.cell is state.arm.cell else "another cell file was opened since"


def _same(one: Steered, other: Steered) -> bool:
    pairs = ((one.profile.standoff, other.profile.standoff), (one.profile.psi, other.profile.psi))
    return one.branch == other.branch and all(np.array_equal(a, b) for a, b in pairs)
