"""How near the moves between holes come to what stands around, and whether they touch it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from zerorev.collision.arms import Setting, setting_of
from zerorev.collision.near import Nearest, first_hit, moves, nearest_of
from zerorev.model._arrays import Array
from zerorev.model.arm_bodies import withdrawn
from zerorev.model.finding import Finding
from zerorev.model.plan import Clearance
from zerorev.model.robot import Robot
from zerorev.model.settings import Settings
from zerorev.model.tool import Tool
from zerorev.verify.around import proven

__all__ = ["Around"]

SLACK = 2e-5  # [m] to which a least distance is known
CURE = "; retract_mm, approach_mm and safe_height_mm lead it further away"


@dataclass(frozen=True)
class Around:
    """What the arm must not touch between holes.

    Attributes:
        robot: the arm.
        tool: on its flange.
        settings: with what stands around, and the clearance that is asked for.
        setting: the same for the kernels; what touches the part at a hole is drawn back a little.
    """

    robot: Robot
    tool: Tool
    settings: Settings
    setting: Setting

    @classmethod
    def of(cls, robot: Robot, tool: Tool, settings: Settings) -> Around | None:
        """What stands around; None where nothing is known to."""
        setting = setting_of(robot, tool, settings)
        if setting is None:
            return None
        touching = setting_of(robot, withdrawn(robot, tool), replace(settings, clearance=0.0))
        return None if touching is None else cls(robot, tool, settings, touching)

    def hit(self, joints: Array) -> Nearest | None:
        """What moves through some points, with a stop at each, touch, or are not proven not to; None: nothing.

        Args:
            joints: the points [rad], shape (n, 6).
        """
        return first_hit(self.setting, self.robot, moves(joints), self.setting.all_pairs)

    def clearance(self, joints: Array) -> Clearance | None:
        """The least distance on such moves, proven by the check's own code, too; None where nothing stands around."""
        found = nearest_of(self.setting, self.robot, moves(joints), self.setting.against)
        if found is None:
            return None
        claimed = Clearance(found.distance, None, found.between, certified=True)
        sound = found.proven and proven(self.robot, self.tool, self.settings, claimed, joints)
        return replace(claimed, certified=sound)

    def findings(self, name: str, hit: Nearest | None, near: Clearance | None, hole: str | None) -> Iterator[Finding]:
        """That such moves touch something, or come nearer to it than asked for.

        Args:
            name: how a message calls them.
            hit: what they touch.
            near: the least distance.
            hole: that the finding names.
        """
        if hit is not None:
            body, other = hit.between
            met = f"the {body} touches {other}" if body else "it could not be proven to keep clear"
            yield Finding("error", "collision", f"{name} {met}{CURE}", hole)
        elif near is not None and near.least < self.settings.clearance - SLACK:
            body, other = near.between
            wanted = f"{self.settings.clearance * 1e3:g} mm are asked for (clearance_mm)"
            message = f"{name} the {body} comes within {near.least * 1e3:.2f} mm of {other}, and {wanted}{CURE}"
            yield Finding("warning", "near_part", message, hole)
