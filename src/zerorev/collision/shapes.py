"""The drill, the tool that holds it, and the wrist, as capsules: all points within a radius of a straight line."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from zerorev.model._arrays import Array
from zerorev.model.robot import Robot
from zerorev.model.tool import Tool

__all__ = ["BODIES", "Body", "Capsules", "capsules_of"]

Body = Literal["drill", "tool", "wrist"]
BODIES: tuple[Body, ...] = get_args(Body)
"""From the tip to the point of the drill axis nearest to the flange, from there to the flange, and on to the wrist."""

WRIST_RADIUS = 0.5  # of the distance from the wrist centre to the flange: a guess, no robot file states it


@dataclass(frozen=True)
class Capsules:
    """Capsules that move with the flange.

    Attributes:
        ends: of their lines, in the flange frame [m], shape (3, 2, 3); rows as in `BODIES`.
        radius: [m], shape (3,). Drill and tool are lines, since no file says how thick they are.
        tool: that ends in the first of them.
        reach: no end is farther than this from each axis, for any joints between [m], shape (3, 2, 6).
    """

    ends: Array
    radius: Array
    tool: Tool
    reach: Array


def capsules_of(robot: Robot, tool: Tool) -> Capsules:
    """The capsules of an arm with a tool.

    Args:
        robot: the arm.
        tool: on its flange.
    """
    arm = robot.arm
    wrist, flange = np.array([0.0, 0.0, -arm.c4]), np.zeros(3)
    tip, back = tool.T_flange_tcp[:3, 3], tool.T_flange_tcp[:3, 2]
    foot = tip + max(-float(tip @ back), 0.0) * back
    ends = np.array([[tip, foot], [foot, flange], [flange, wrist]])
    radius = np.array([0.0, 0.0, WRIST_RADIUS * abs(arm.c4)])
    return Capsules(ends, radius, tool, _reach(robot, ends))


def _reach(robot: Robot, points: Array) -> Array:
    """Greatest distances of points of the flange frame [m], shape (..., 3), from the six axes: shape (..., 6).

    From the wrist inwards each link adds its length at most, however the joints between stand (world.md §2.2).
    """
    arm = robot.arm
    from_wrist = np.linalg.norm(points + np.array([0.0, 0.0, arm.c4]), axis=-1)
    about_6 = np.hypot(points[..., 0], points[..., 1])
    elbow = from_wrist + np.hypot(arm.a2, arm.c3)
    shoulder = elbow + abs(arm.c2)
    base = shoulder + abs(arm.a1) + abs(arm.b)
    return np.stack([base, shoulder, elbow, from_wrist, from_wrist, about_6], axis=-1)
