"""The moves between holes: all axes at once, from where one hole ends to where the next one begins."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from zerorev.kernels.tour import move_time
from zerorev.model._arrays import Array
from zerorev.model.finding import Finding
from zerorev.model.plan import Transition
from zerorev.model.robot import JointLimits, Robot

__all__ = ["HOME", "LONG_TURN", "accelerations", "transition"]

RAMP = 0.3  # [s] within which an axis reaches its greatest speed, where the robot's file does not say: a guess
LONG_TURN = float(np.deg2rad(90.0))  # of one axis
HOME = "the home position"


def accelerations(limits: JointLimits) -> Array:
    """Greatest accelerations of the joints [rad/s^2], shape (6,): as the robot's file has them, or guessed."""
    return np.asarray(limits.speed / RAMP) if limits.acceleration is None else limits.acceleration


def transition(
    robot: Robot, start: str | None, to: str | None, joints: Sequence[Array], branches: tuple[int, int] | None
) -> Transition:
    """The move between two holes, and what a user should know of it.

    Args:
        robot: the arm.
        start: id of the hole that is left; None: the home position.
        to: id of the next one; None: the home position.
        joints: where the move begins, the points where it stops between, and where it ends [rad], shape (6,) each.
        branches: of the two holes; None where one end is the home position.
    """
    limits = robot.limits
    own = accelerations(limits)
    time = sum(float(move_time(one, other, limits.speed, own)) for one, other in pairwise(joints))
    points = np.array(joints)
    turns = np.abs(np.diff(points, axis=0)).sum(axis=0)
    axis = int(np.argmax(turns))
    changes = branches is not None and branches[0] != branches[1]
    found = []
    way = f"from {HOME if start is None else start} to {HOME if to is None else to}"
    if changes and branches is not None:
        message = f"{way} the arm changes its posture (branch {branches[0]} to {branches[1]})"
        found.append(Finding("warning", "posture_change", message, to or start))
    if turns[axis] > LONG_TURN:
        message = f"{way} {robot.joint_names[axis]} turns by {np.rad2deg(turns[axis]):.0f} deg"
        found.append(Finding("warning", "long_turn", message, to or start))
    return Transition(start, to, points, time, changes, float(turns[axis]), tuple(found))
