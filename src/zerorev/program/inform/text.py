"""The letters and numbers of INFORM: comments, pulses, speeds, and which position level a blend has."""

from __future__ import annotations

import numpy as np

from zerorev.model._arrays import Array
from zerorev.model.robot import Robot
from zerorev.program.letters import Comments, settled
from zerorev.program.neutral import HoleProgram, Move, Program
from zerorev.program.waypoints import Leg

__all__ = [
    "BLENDED", "INFORM_COMMENTS", "LONGEST_COMMENT", "SHARES", "SLOWEST", "STOPS", "feed_written", "feeds_of",
    "from_pulses", "joint_moves", "position", "pulses", "share_needed", "share_written",
]  # fmt: skip

LONGEST_COMMENT = 32  # characters

INFORM_COMMENTS = Comments("'", width=LONGEST_COMMENT + 1, instead=str.maketrans({"'": ""}), narrow=True)

STOPS, BLENDED = 0, 1
"""Position levels: an exact stop, and the smallest of the eight blends. How far each reaches the controller knows."""

SLOWEST = 1e-4  # [m/s]: a speed of the tip has one decimal of a mm/s
SHARES = 0.01, 100.0  # [%]: least and greatest speed of a joint move


def pulses(robot: Robot, joints: Array, margin: float = 0.0) -> Array:
    """Whole pulses of joints, shape (..., 6): the nearest, but none by which a joint would leave its limits.

    A robot whose pulses are not known is refused before this is asked.

    Args:
        robot: with its pulses.
        joints: within the limits [rad], shape (..., 6).
        margin: room that the joints keep to their limits [rad].
    """
    assert robot.pulses_per_deg is not None
    limits = robot.allowed(margin)
    ends = np.sort(np.rad2deg([limits.lower, limits.upper]) * robot.pulses_per_deg, axis=0)
    nearest = np.rint(np.rad2deg(joints) * robot.pulses_per_deg)
    return np.asarray(np.clip(nearest, np.ceil(ends[0]), np.floor(ends[1])))


def from_pulses(robot: Robot, counts: Array) -> Array:
    """Joints [rad] at which the controller counts so many pulses, shape (..., 6)."""
    assert robot.pulses_per_deg is not None
    return np.asarray(np.deg2rad(counts / np.array(robot.pulses_per_deg)))


def position(number: int, counts: Array) -> str:
    """A position of the job, by its number from 0."""
    return f"C{number:05d}=" + ",".join(f"{int(count):d}" for count in counts)


def feed_written(feed: float) -> str:
    """The speed of the tip [m/s] as `V=` has it, in mm/s."""
    return settled(feed * 1e3, 1)


def share_written(share: float) -> str:
    """A share [%] of what the joints can as `VJ=` has it."""
    return settled(min(share, SHARES[1]), 2)


def share_needed(robot: Robot, begin: Array, move: Move) -> float:
    """Of what the joints can [%]: what a joint move needs to take its time.

    The joint that would need longest at full speed sets the time, and the others are slowed down to it.

    Args:
        robot: with its joint speeds.
        begin: joints where it begins [rad], shape (6,).
        move: the joint move.
    """
    fastest = float(np.max(np.abs(move.end.joints - begin) / robot.limits.speed))
    return 100.0 * fastest / move.time


def feeds_of(program: Program) -> list[tuple[Leg, float]]:
    """The feeds of straight moves [m/s], each once, and before each a leg that has it: plunge or retract if they do."""
    legs: dict[float, Leg] = {}
    for hole in program.holes:
        for move in hole.moves:
            if move.linear and (move.feed not in legs or move.leg in ("plunge", "retract")):
                legs[move.feed] = move.leg
    return [(leg, feed) for feed, leg in legs.items()]


def joint_moves(robot: Robot, hole: HoleProgram) -> list[tuple[Move, float]]:
    """The joint moves at the corner of a hole, and what each needs of what the joints can [%]."""
    begins = [hole.start.joints, *(move.end.joints for move in hole.moves)]
    return [
        (move, share_needed(robot, begin, move))
        for begin, move in zip(begins, hole.moves, strict=False)
        if not move.linear
    ]
