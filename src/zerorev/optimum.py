"""The one result behind plan, maps, placement and the app: the best motion of a hole, and its deepest stroke.

Every source of motions puts its candidates into one pool, and the one order of motions (`search.rank`) takes the best.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from zerorev.depth import Deepest, deepest_stroke
from zerorev.model.hole import Hole
from zerorev.model.job import Settings
from zerorev.model.profile import Profile
from zerorev.model.robot import Robot
from zerorev.model.tool import Tool
from zerorev.search.exact import search
from zerorev.search.free import search_free
from zerorev.search.rank import Candidate, Order
from zerorev.search.weighted import search_weighted

__all__ = ["best_motion", "deepest_as_drilled"]


def best_motion(robot: Robot, tool: Tool, hole: Hole, settings: Settings) -> Candidate | None:
    """The best motion of a hole, its stand-off counted from the hole's own target where the corner is placed deeper.

    Args:
        robot: the arm.
        tool: the drill.
        hole: what to drill; its `branch`, if any, is the only one searched.
        settings: how; with `weights` their sum decides, else the objective.

    Returns:
        the motion, or None where no branch can run any.
    """
    drilled, order = _to_the_corner(hole, settings), Order(robot, tool, hole, settings)
    straight = (search_weighted if settings.weights else search)(robot, tool, drilled, settings)
    free = search_free(robot, tool, drilled, settings) if settings.legs == "free" else None
    if free is not None and straight is not None and np.abs(straight.profile.twist_rate).max() > settings.max_twist:
        straight = None
    return order.best(
        order.candidate(_from_the_target(found.profile, settings), found.branch)
        for found in (straight, free)
        if found is not None
    )


def deepest_as_drilled(robot: Robot, tool: Tool, hole: Hole, settings: Settings) -> Deepest:
    """The deepest stroke, counted from the hole's own target where the corner is placed deeper."""
    found = deepest_stroke(robot, tool, _to_the_corner(replace(hole, profile=None), settings), settings)
    depth = found.depth + settings.corner
    if found.profile is None or depth <= 0:
        return Deepest(0.0)
    return replace(found, depth=depth, profile=_from_the_target(found.profile, settings))


def _to_the_corner(hole: Hole, settings: Settings) -> Hole:
    """The hole down to the programmed corner."""
    corner = settings.corner
    return replace(hole, target=hole.target - corner * hole.direction, depth=hole.depth - corner)


def _from_the_target(profile: Profile, settings: Settings) -> Profile:
    """A motion that was found for the hole down to the programmed corner, for the hole itself."""
    return Profile(profile.standoff + settings.corner, profile.psi)
