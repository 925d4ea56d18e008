"""What a twist map is drawn of, so that the same map is not drawn twice; and what of it is drawn a moment later."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from zerorev.collision.arms import setting_of
from zerorev.collision.near import lines, nearest_of
from zerorev.collision.poses import poses_nearest
from zerorev.model.hole import Hole
from zerorev.model.robot import Robot
from zerorev.model.settings import Settings
from zerorev.model.surroundings import Surroundings
from zerorev.model.tool import Tool
from zerorev.motion.drilling import Drilling
from zerorev.report.scene.clearance import ClearanceZone, clearance_zone

__all__ = ["WantedMap"]


class WantedMap(NamedTuple):
    """What `report.scene.twist_map` and `report.scene.clearance` are asked."""

    robot: Robot
    tool: Tool
    hole: Hole
    branch: int | None
    corner: float
    thrust: float
    limit_margin: float
    clearance: float
    surroundings: Surroundings

    @property
    def drilling(self) -> Drilling:
        """Robot, tool and hole."""
        return Drilling(self.robot, self.tool, self.hole, self.limit_margin)

    def same(self, other: WantedMap) -> bool:
        """Whether it is the same map: robots, tools and holes are not compared number by number."""
        things = all(a is b for a, b in zip(self[:3], other[:3], strict=True))
        return things and self[3:] == other[3:]

    def zone(self) -> ClearanceZone | None:
        """Where the clearance is not kept, in a thread of its own; None on a map of all branches.

        Besides, bodies and kernels of the distances along a motion are made ready, which takes seconds where a mesh is
        fine, or nothing is compiled yet.
        """
        settings = Settings(clearance=self.clearance, surroundings=self.surroundings)
        setting = setting_of(self.robot, self.tool, settings)
        if setting is None:
            return None
        line = lines(self.drilling, self.branch or 0, [(0.0, 0.0), (self.hole.depth, 0.0)])
        nearest_of(setting, self.robot, line, setting.drilled)
        poses_nearest(setting, self.drilling, 0, np.zeros(1), np.zeros(1))
        if self.branch is None:
            return None
        return clearance_zone(self.drilling, settings, self.branch, self.corner)
