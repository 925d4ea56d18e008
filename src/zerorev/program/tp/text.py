"""The letters and numbers of TP: comments, speeds in whole numbers, and the letters of a posture."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from zerorev.model._arrays import Array
from zerorev.model.robot import Robot
from zerorev.program.letters import Comments, fixed, settled
from zerorev.verify.arm import branch_of

__all__ = [
    "CM_MIN", "COMMENT_WIDTH", "DECIMALS", "LONGEST_TEXT", "TP_COMMENTS", "Speed", "configuration", "joint_time",
    "standing", "tip_speed",
]  # fmt: skip

COMMENT_WIDTH = 32  # characters behind the sign
LONGEST_TEXT = 34  # characters of an argument
DECIMALS = 3  # of lengths [mm] and angles [deg]
CM_MIN = 1e-2 / 60  # [m/s]
WHOLE = 1e-6  # [mm/s] by which a feed may differ from the whole number that stands for it

TP_COMMENTS = Comments("!", 1 + COMMENT_WIDTH, str.maketrans({";": ","}), narrow=True)
"""A comment is a statement of its own, and ends as any does."""


class Speed(NamedTuple):
    """How fast a move is, in a whole number of a unit.

    Attributes:
        value: 0 where the unit is too coarse.
        unit: as TP writes it.
    """

    value: int
    unit: str

    def __str__(self) -> str:
        """As a motion has it."""
        return f"{self.value}{self.unit}"


def tip_speed(feed: float) -> Speed:
    """The speed of a straight move: whole mm/sec where that is the feed, else the nearest whole cm/min.

    Args:
        feed: of the tip [m/s].
    """
    whole = round(feed * 1e3)
    if abs(feed * 1e3 - whole) <= WHOLE:
        return Speed(whole, "mm/sec")
    return Speed(int(settled(feed / CM_MIN, 0)), "cm/min")


def joint_time(time: float) -> Speed:
    """The speed of a move of all joints, by the time that it takes [s]."""
    return Speed(int(settled(time * 1e3, 0)), "msec")


def standing(time: float) -> str:
    """For how long the robot stands [s]: two decimals, and none but these of less than a second."""
    return fixed(time, 2).removeprefix("0").rjust(6)


def configuration(robot: Robot, joints: Array) -> str:
    """The posture of a pose: letters of wrist, elbow and shoulder, and the turns of J4, J5 and J6.

    N: J5 is at 0 or below, F: above; U: the elbow is above the line from shoulder to wrist, D: below; T: the wrist
    centre is before axis 1, B: behind. That N goes with J5 <= 0, and of which joints the turns are counted, is how
    programs in use have it; of an arm that reaches back nobody is known to have tried the second letter.

    Args:
        robot: the arm.
        joints: that turn [rad], shape (6,).
    """
    branch, shown = branch_of(robot.arm, joints), np.rad2deg(robot.shown(joints))
    wrist, elbow, shoulder = "FN"[branch % 2], "UD"[branch // 2 % 2], "TB"[branch // 4]
    return f"{wrist} {elbow} {shoulder}, {', '.join(str(_turns(angle)) for angle in shown[3:])}"


def _turns(angle: float) -> int:
    """Whole turns: 0 within (-180, 180), 1 from 180 deg on, -1 from -180 deg down."""
    settled_angle = round(float(angle), 6)
    turns = int((abs(settled_angle) + 180.0) // 360.0)
    return turns if settled_angle >= 0 else -turns
