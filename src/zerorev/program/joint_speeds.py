"""Whether the joints, and the tool, can turn as fast as the feeds ask for."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from zerorev.model.finding import Finding, Level
from zerorev.model.plan import Corner, Motion
from zerorev.model.settings import Settings
from zerorev.motion.drilling import Drilling
from zerorev.motion.joint_path import outward_rates
from zerorev.program.stroke_points import moves_of
from zerorev.program.ways import Way

__all__ = ["Piece", "pieces_of", "too_fast", "turn_speed", "turns_fast"]

SAMPLES = 401  # of a piece
ROUND_OFF = 1e-9


class Piece(NamedTuple):
    """A straight piece of a motion in the twist plane.

    Attributes:
        leg: which part of the motion it belongs to.
        begin: stand-off [m] and spin [rad].
        end: stand-off [m] and spin [rad].
        feed: of the tip [m/s].
    """

    leg: str
    begin: tuple[float, float]
    end: tuple[float, float]
    feed: float


def pieces_of(settings: Settings, motion: Motion, corner: Corner | None, way: Way) -> list[Piece]:
    """The pieces of a hole's own moves with their feeds, as a program has them.

    Args:
        settings: of the hole, with the feeds.
        motion: of the hole.
        corner: how it turns round.
        way: to the motion and away from it.
    """
    return [
        Piece(point.leg, (before.standoff, before.psi), (point.standoff, point.psi), feed)
        for before, point, feed in moves_of(settings, motion, corner, way)
    ]


def too_fast(drilling: Drilling, branch: int, pieces: Iterable[Piece], level: Level = "error") -> tuple[Finding, ...]:
    """Joints that cannot turn as fast as asked for: one finding a leg, of the joint that is farthest beyond its speed.

    Args:
        drilling: robot, tool and hole.
        branch: 0..7.
        pieces: of the motion.
        level: of the findings.
    """
    robot, hole = drilling.robot, drilling.hole.id
    allowed = robot.limits.speed
    worst: dict[str, tuple[float, int, float, float]] = {}  # leg -> share of the speed, joint, rate, feed
    for piece in pieces:
        (s0, psi0), (s1, psi1) = piece.begin, piece.end
        slope = (psi1 - psi0) / (s1 - s0)
        rates = outward_rates(drilling, branch, np.linspace(s0, s1, SAMPLES), np.linspace(psi0, psi1, SAMPLES), slope)
        if np.isnan(rates).any():
            message = f"a singularity on the {piece.leg}: the joint speeds are undefined"
            return (Finding(level, "joint_speed", message, hole),)
        peak = np.abs(rates).max(axis=0)
        share = peak * piece.feed / allowed
        joint = int(np.argmax(share))
        if share[joint] > max(1.0 + ROUND_OFF, worst.get(piece.leg, (0.0,))[0]):
            worst[piece.leg] = (float(share[joint]), joint, float(peak[joint]), piece.feed)
    return tuple(
        Finding(
            level,
            "joint_speed",
            f"{robot.joint_names[joint]} would have to turn at {np.rad2deg(rate * feed):.1f} deg/s on the {leg} "
            f"at a feed of {feed * 1e3:g} mm/s, and can turn at {np.rad2deg(allowed[joint]):.1f} deg/s; the greatest "
            f"feed that fits is {_floored(allowed[joint] / rate * 1e3)} mm/s",
            hole,
        )
        for leg, (_, joint, rate, feed) in worst.items()
    )


def turn_speed(pieces: Iterable[Piece]) -> float:
    """Greatest speed at which the pieces turn the tool about the drill axis [rad/s]."""
    return max(abs((each.end[1] - each.begin[1]) / (each.end[0] - each.begin[0])) * each.feed for each in pieces)


def turns_fast(hole: str, pieces: Iterable[Piece], usual: float) -> tuple[Finding, ...]:
    """A warning where the tool is turned faster than controllers usually turn it: they would throttle the feed.

    Args:
        hole: its id.
        pieces: of the motion.
        usual: up to which the controller turns a tool [rad/s].
    """
    if (speed := turn_speed(pieces)) <= usual:
        return ()
    message = (
        f"the tool turns at {np.rad2deg(speed):.0f} deg/s: see that the controller's limit of the orientation speed "
        "allows it, or it will throttle the feed"
    )
    return (Finding("warning", "turn_speed", message, hole),)


def _floored(feed_mm_s: float) -> str:
    """A feed with three digits, rounded down, so that it does fit."""
    digits = 2 - int(np.floor(np.log10(feed_mm_s)))
    return f"{np.floor(feed_mm_s * 10.0**digits) / 10.0**digits:.{max(digits, 0)}f}"
