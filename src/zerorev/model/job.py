"""The job: a robot, a tool, holes, and how they are to be drilled."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from zerorev.errors import InputError
from zerorev.model._arrays import Array, finite, is_rigid
from zerorev.model.corner import controller_of
from zerorev.model.finding import Finding
from zerorev.model.hole import Hole
from zerorev.model.measures import CRITERIA
from zerorev.model.robot import Robot
from zerorev.model.settings import Settings
from zerorev.model.tool import Tool

__all__ = ["Job", "Settings", "check_robot"]


def check_robot(robot: Robot, settings: Settings) -> None:
    """Hold settings to what the robot has.

    Raises:
        InputError: a criterion weighs that the robot has no masses for; or a joint has no range left.
    """
    robot.allowed(settings.limit_margin)
    for name, _ in settings.weights:
        if CRITERIA[name].needs_dynamics and robot.dynamics is None:
            raise InputError(
                f"{name} needs the masses of the robot {robot.name}, which its file does not have",
                where="objective",
                accepted="dynamics in the robot file: links, payload_kg",
            )


@dataclass(frozen=True)
class Job:
    """Everything that planning needs.

    Attributes:
        robot: the arm.
        tool: the drill on its flange.
        holes: what to drill, base frame.
        settings: how; where no controller is named, it becomes that of the robot's maker, if that is known.
        T_base_part: part frame, shape (4, 4), translation [m].
        name: of the job; names the program.
        psi_reference: what the spins of all holes are counted from where the part is moved: one of
            `zerorev.model.hole.REFERENCES`, or a vector in the part frame; None: their own `psi_zero` moves with it.
        notes: what was left out where the files of the job were read, in words.
        said: what was assumed there, and what is probably wrong with them.
        further: the same holes for the further tools, which drill them one after the other when this one has.
    """

    robot: Robot
    tool: Tool
    holes: tuple[Hole, ...]
    settings: Settings = field(default_factory=Settings)
    T_base_part: Array = field(default_factory=lambda: np.eye(4))
    name: str = "job"
    psi_reference: str | tuple[float, ...] | None = None
    notes: tuple[str, ...] = field(default=(), compare=False)
    said: tuple[Finding, ...] = field(default=(), compare=False)
    further: tuple[Job, ...] = ()

    def __post_init__(self) -> None:
        """Check the holes, that their ids differ, and name the controller."""
        known = controller_of(self.robot.manufacturer)
        if self.settings.controller is None and known is not None:
            object.__setattr__(self, "settings", replace(self.settings, controller=known.name))
        T = finite(self.T_base_part, (4, 4), "part_frame")
        if not is_rigid(T):
            raise InputError("not a rotation and a translation", where="part_frame")
        object.__setattr__(self, "T_base_part", T)
        if not self.holes:
            raise InputError("no holes", where="holes", accepted="one hole or more")
        seen: set[str] = set()
        for hole in self.holes:
            if hole.id in seen:
                raise InputError(f"the id '{hole.id}' is used twice", where="holes", accepted="ids that differ")
            seen.add(hole.id)
            cycle = self.settings.of(hole).cycle  # raises what does not fit together
            if hole.profile is None:
                cycle.check_count(hole.depth, f"hole {hole.id}, cycle, depth_mm")
        check_robot(self.robot, self.settings)

    @property
    def of_all_tools(self) -> tuple[Job, ...]:
        """This job, of the first tool, and those of the further ones."""
        return (self, *self.further)
