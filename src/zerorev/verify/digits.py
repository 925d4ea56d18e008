"""What the digits of a plan file leave open of its figures: their change where what they come from moves by a digit.

Planning computes a figure from all digits of its numbers, the check from the thirteen that are written. Near a
singularity, or where a joint is all but at rest, that is a difference that can be seen.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from zerorev.model._arrays import Array
from zerorev.model.hole import Hole
from zerorev.model.job import Settings
from zerorev.model.plan import HolePlan, Motion
from zerorev.model.robot import Robot
from zerorev.model.tool import Tool
from zerorev.verify.figures import figures

__all__ = ["DIGIT", "moved_figures"]

DIGIT = 5e-13  # relative: half a unit in the thirteenth place of a number that begins with 1


def moved_figures(robot: Robot, tool: Tool, settings: Settings, stated: HolePlan) -> Iterator[HolePlan]:
    """The figures of a motion whose hole or whose profile is moved by the last digit, one move after the other.

    Args:
        robot: the arm.
        tool: the drill.
        settings: as for `figures`.
        stated: with a motion.
    """
    motion = stated.motion
    assert motion is not None
    holes = [(hole, motion) for hole in _moved_holes(stated.hole)]
    for hole, moved in [*holes, *((stated.hole, moved) for moved in _moved_motions(motion))]:
        found = figures(robot, tool, settings, replace(stated, hole=hole, motion=moved))
        if found is not None:
            yield found.answer


def _moved_holes(hole: Hole) -> Iterator[Hole]:
    away = DIGIT * float(np.abs(hole.target).max())
    for axis in np.eye(3):
        yield replace(hole, target=hole.target + away * axis, profile=None)
        turned = (vector + DIGIT * np.cross(axis, vector) for vector in (hole.direction, hole.psi_zero))
        direction, psi_zero = turned
        yield replace(hole, direction=direction, psi_zero=psi_zero, profile=None)


def _moved_motions(motion: Motion) -> Iterator[Motion]:
    """The spins of every third breakpoint, so that of three neighbours each moves alone; and all stand-offs."""
    profile = motion.profile
    away: Array = DIGIT * np.maximum(np.abs(profile.psi), 1e-3)
    for first in range(3):
        moves = np.arange(profile.psi.size) % 3 == first
        yield replace(motion, profile=replace(profile, psi=profile.psi + np.where(moves, away, 0.0)))
    yield replace(motion, profile=replace(profile, standoff=profile.standoff * (1 + DIGIT)))
