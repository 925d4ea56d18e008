"""What a program does at its positions as a job has them, in whole pulses: off the axis, tilted, joints that turn back.

Rounding never turns a joint back on a joint move, since it keeps the order of two angles; but it may leave a slow
joint standing there. On a straight move the tool goes from one rounded pose to the next, and so a little beside the
drill axis: a joint that hardly moves may turn back on it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from zerorev.model._arrays import Array
from zerorev.motion.kinematics import forward, inverse
from zerorev.program.inform.text import from_pulses, pulses
from zerorev.program.neutral import HoleProgram, Program

__all__ = ["Rounded", "rounded"]

SAMPLES = 33  # of a straight move
STILL = 1e-9  # [rad] between two samples: less is the round-off of the inverse
FULL_TURN = 2 * np.pi


class Rounded(NamedTuple):
    """A hole in whole pulses.

    Attributes:
        off_axis: farthest that a point lies beside where it was planned, across the drill axis [m].
        along: farthest along it [m].
        tilt: farthest that the drill is tilted there [rad].
        reversals: of each joint from the lead-in to the end of the stroke, shape (6,).
        standing: joints that stand on a joint move and move elsewhere, shape (6,).
        wrist: least angle of joint 5, on which straight moves depend [rad].
    """

    off_axis: float
    along: float
    tilt: float
    reversals: Array
    standing: npt.NDArray[np.bool_]
    wrist: float


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
    T = np.linalg.inv(program.T_base_part) @ forward(robot, joints) @ program.tool.T_flange_tcp
    planned = np.array([point.T_part_tcp for point in points])
    off = T[:, :3, 3] - planned[:, :3, 3]
    along = off @ hole.axis
    tilt = np.linalg.norm(np.cross(T[:, :3, 2], planned[:, :3, 2]), axis=1)
    paths = [
        _straight(program, before, after) if move.linear else np.array([before, after])
        for move, before, after in zip(hole.moves, joints, joints[1:], strict=False)
    ]
    first = int(hole.moves[0].leg == "approach")
    last = len(paths) - int(hole.moves[-1].leg == "depart")
    reversals, standing = _directions([(paths[k], hole.moves[k].linear) for k in range(first, last)])
    return Rounded(
        float(np.linalg.norm(off - along[:, None] * hole.axis, axis=1).max()),
        float(np.abs(along).max()),
        float(tilt.max()),
        reversals,
        standing,
        float(np.abs(np.vstack(paths)[:, 4]).min()),
    )


def _straight(program: Program, begin: Array, end: Array) -> Array:
    """Joints along a straight move between two postures [rad], shape (n, 6): the tool turns evenly about one axis."""
    robot, tool = program.robot, program.tool
    first, last = forward(robot, np.array([begin, end])) @ tool.T_flange_tcp
    share = np.linspace(0.0, 1.0, SAMPLES)
    T = np.broadcast_to(np.eye(4), (SAMPLES, 4, 4)).copy()
    T[:, :3, :3] = _turned(first[:3, :3], last[:3, :3], share)
    T[:, :3, 3] = first[:3, 3] + share[:, None] * (last[:3, 3] - first[:3, 3])
    near = begin + share[:, None] * (end - begin)
    found = inverse(robot, T @ np.linalg.inv(tool.T_flange_tcp))
    found += FULL_TURN * np.round((near[:, None] - found) / FULL_TURN)
    apart = np.nan_to_num(np.abs(found - near[:, None]).sum(axis=-1), nan=np.inf)
    branch = int(np.argmin(apart[0] + apart[-1]))
    return np.asarray(found[:, branch])


def _turned(first: Array, last: Array, share: Array) -> Array:
    """Rotations that lead evenly about one axis from one to another, shape (n, 3, 3) (Rodrigues)."""
    R = last @ first.T
    double = np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    sine = float(np.linalg.norm(double))
    if sine == 0:
        return np.broadcast_to(first, (len(share), 3, 3))
    x, y, z = double / sine
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    angle = share[:, None, None] * np.arctan2(sine, np.trace(R) - 1)
    return np.asarray((np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K) @ first)


def _directions(paths: list[tuple[Array, bool]]) -> tuple[Array, npt.NDArray[np.bool_]]:
    """Reversals of each joint along paths one after the other, and which joints stand on a joint move; shape (6,)."""
    steps = np.vstack([np.diff(path, axis=0) for path, _ in paths])
    signs = np.where(np.abs(steps) > STILL, np.sign(steps), 0.0)
    reversals = np.zeros(6, dtype=int)
    for joint in range(6):
        moving = signs[signs[:, joint] != 0, joint]
        reversals[joint] = int((moving[1:] != moving[:-1]).sum())
    still = np.array([(np.diff(path, axis=0) == 0).any(axis=0) for path, linear in paths if not linear])
    standing = still.any(axis=0) & (signs != 0).any(axis=0) if len(still) else np.zeros(6, dtype=bool)
    return reversals, standing
