"""Which solids move with an arm and its tool, and which of them are held apart.

Held apart are all bodies that move from what stands around; and of the arm itself the wrist and the tool from base,
shoulder and upper arm, and the forearm from base and shoulder. Where the robot's file states its bodies, those of the
tool are held apart from the forearm, too. Neighbours touch by their making and are left out.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from zerorev.model._arrays import transform
from zerorev.model.body import Body, Capsule
from zerorev.model.robot import Robot
from zerorev.model.settings import Settings
from zerorev.model.tool import Tool

__all__ = ["TOUCHING", "Pair", "bodies_of", "pairs_of", "withdrawn"]

# radii of the capsules that stand for bodies of which no file says anything, of the reach of the arm
BASE, SHOULDER, UPPER_ARM, FOREARM, WRIST, TOOL, DRILL = 0.16, 0.13, 0.12, 0.075, 0.065, 0.05, 0.008
TOUCHING = 1e-6  # [m] nearer than this two bodies touch
WITHDRAWN = 1e-3  # [m] by which what touches the part at a hole is drawn back from it between holes, for size 1


class Pair(NamedTuple):
    """Two solids that are held apart.

    Attributes:
        body: number of the body that is farther out.
        other: number of the body that is farther in; None: it is an obstacle.
        obstacle: number of the obstacle, or None.
        least: how far they are held apart [m].
        exempt: whether the body touches the part at a hole, so that they are not held apart on the hole's own moves.
    """

    body: int
    other: int | None
    obstacle: int | None
    least: float
    exempt: bool = False


def bodies_of(robot: Robot, tool: Tool) -> tuple[Body, ...]:
    """All bodies of an arm with its tool: those that files state, and capsules about its own lines for the others.

    Args:
        robot: the arm.
        tool: on its flange.
    """
    return (*(robot.bodies or _of_the_arm(robot)), *(tool.bodies or _of_the_tool(robot, tool)))


def _capsule(name: str, link: int, one: npt.ArrayLike, other: npt.ArrayLike, radius: float) -> Body:
    ends = np.stack([np.asarray(one, dtype=float), np.asarray(other, dtype=float)])
    return Body(name, link, Capsule(ends, radius), touches_part=name == "drill", guessed=True)


def _of_the_arm(robot: Robot) -> tuple[Body, ...]:
    arm, reach, origin = robot.arm, robot.reach, (0.0, 0.0, 0.0)
    top = (0.0, 0.0, arm.c1)
    return (
        _capsule("base", 0, origin, top, BASE * reach),
        _capsule("shoulder", 1, top, (arm.a1, arm.b, arm.c1), SHOULDER * reach),
        _capsule("upper arm", 2, origin, (0.0, 0.0, arm.c2), UPPER_ARM * reach),
        _capsule("forearm", 3, origin, (arm.a2, 0.0, arm.c3), FOREARM * reach),
        _capsule("wrist", 6, (0.0, 0.0, -arm.c4), origin, WRIST * reach),
    )


def _of_the_tool(robot: Robot, tool: Tool) -> tuple[Body, ...]:
    """The drill, from its tip to the point of its axis that is nearest to the flange, and what holds it."""
    reach, tip, back = robot.reach, tool.T_flange_tcp[:3, 3], tool.T_flange_tcp[:3, 2]
    thick, length = DRILL * reach, max(-float(tip @ back), 0.0)
    foot = tip + length * back
    # the round end of the drill ends at the tip
    drill = _capsule("drill", 6, tip + min(thick, length) * back, foot, thick)
    holder = _capsule("tool", 6, foot, (0.0, 0.0, 0.0), TOOL * reach)
    return (drill, holder) if np.linalg.norm(foot) > 0 else (drill,)


def pairs_of(robot: Robot, tool: Tool, settings: Settings) -> tuple[Pair, ...]:
    """Which solids are held apart, and how far.

    Args:
        robot: the arm.
        tool: on its flange.
        settings: with what stands around, and the clearance that is asked for.
    """
    return tuple(_pairs(robot, tool, settings))


def _pairs(robot: Robot, tool: Tool, settings: Settings) -> Iterator[Pair]:
    bodies = bodies_of(robot, tool)
    for b, body in enumerate(bodies):
        for o, obstacle in enumerate(settings.surroundings.obstacles):
            # what stands on the floor touches it
            if body.link > (1 if obstacle.kind == "floor" else 0):
                exempt = body.touches_part and obstacle.kind == "part"
                yield Pair(b, None, o, max(settings.clearance, TOUCHING), exempt)
        for c, other in enumerate(bodies):
            if _may_meet(body, other):
                yield Pair(b, c, None, TOUCHING)


def _may_meet(body: Body, other: Body) -> bool:
    """Whether two bodies of the arm are held apart; the body is the one farther out."""
    if other.link <= 2 and body.link >= 4:
        return True
    if other.link <= 1 and body.link == 3:
        return True
    return body.link == 6 and other.link == 3 and not (body.guessed or other.guessed)


def withdrawn(robot: Robot, tool: Tool) -> Tool:
    """The tool as it is held apart from the part between holes: what touches that at a hole is drawn back a little.

    A move between holes may begin where a drill has just left its hole; what it must not do is dip deeper.

    Args:
        robot: the arm.
        tool: on its flange.
    """
    shift = transform(np.eye(3), WITHDRAWN * robot.size * tool.T_flange_tcp[:3, 2])
    bodies = tool.bodies or _of_the_tool(robot, tool)
    return replace(
        tool, bodies=tuple(replace(one, T_link=shift @ one.T_link) if one.touches_part else one for one in bodies)
    )
