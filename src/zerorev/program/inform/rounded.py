"""What a program does at its positions as a job has them, in whole pulses: off the axis, tilted, joints that turn back.

Rounding never turns a joint back on a joint move, since it keeps the order of two angles; but it may leave a slow
joint standing there. On a straight move the tool goes from one rounded pose to the next, and so a little beside the
drill axis: a joint that hardly moves may turn back on it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from zerorev.motion.kinematics import forward
from zerorev.program.inform.text import from_pulses, pulses
from zerorev.program.neutral import HoleProgram, Program
from zerorev.program.rounding import directions, straight

__all__ = ["Rounded", "rounded"]


class Rounded(NamedTuple):
    """A hole in whole pulses.

    Attributes:
        off_axis: farthest that a point lies beside where it was planned, across the drill axis [m].
        along: farthest along it [m].
        tilt: farthest that the drill is tilted there [rad].
        reversals: of each joint from the lead-in to the end of the stroke, shape (6,).
        standing: joints that stand on a joint move and move elsewhere, shape (6,).
    """

    off_axis: float
    along: float
    tilt: float
    reversals: npt.NDArray[np.int64]
    standing: npt.NDArray[np.bool_]


def rounded(program: Program, hole: HoleProgram) -> Rounded:
    """What comes of a hole.

    Args:
        program: whose robot has pulses.
        hole: one of it.
    """
    robot = program.robot
    points = [hole.start, *(move.end for move in hole.moves)]
    planned_joints = np.array([point.joints for point in points])
    joints = from_pulses(robot, pulses(robot, planned_joints, program.settings.limit_margin))
    poses = forward(robot, joints) @ program.tool.T_flange_tcp
    T = np.linalg.inv(program.T_base_part) @ poses
    planned = np.array([point.T_part_tcp for point in points])
    off = T[:, :3, 3] - planned[:, :3, 3]
    along = off @ hole.axis
    tilt = np.linalg.norm(np.cross(T[:, :3, 2], planned[:, :3, 2]), axis=1)
    paths = [
        straight(robot, program.tool, (poses[n], poses[n + 1]), (joints[n], joints[n + 1]))
        if move.linear
        else joints[n : n + 2]
        for n, move in enumerate(hole.moves)
    ]
    first = int(hole.moves[0].leg == "approach")
    last = len(paths) - int(hole.moves[-1].leg == "depart")
    reversals, standing = directions([(paths[k], hole.moves[k].linear) for k in range(first, last)])
    return Rounded(
        float(np.linalg.norm(off - along[:, None] * hole.axis, axis=1).max()),
        float(np.abs(along).max()),
        float(tilt.max()),
        reversals,
        standing,
    )
