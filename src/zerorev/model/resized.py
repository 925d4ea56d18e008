"""The same drilling at another size: all lengths times a factor, all rates per length divided by it (theory §3.3)."""

from __future__ import annotations

from dataclasses import replace

from zerorev.model.hole import Hole
from zerorev.model.job import Settings
from zerorev.model.profile import Profile
from zerorev.model.robot import Robot
from zerorev.model.stated import scaled
from zerorev.model.surroundings import NOTHING_AROUND
from zerorev.model.tool import Tool

__all__ = ["resized", "resized_profile"]


def resized(
    robot: Robot, tool: Tool, hole: Hole, settings: Settings, factor: float
) -> tuple[Robot, Tool, Hole, Settings]:
    """Robot, tool, hole and settings at another size; every motion does the same to the joints.

    Masses are left out: what they do depends on the size. So is the controller's base, on which no motion depends, and
    what the arm may touch: clearances are of the arm's own size.

    With a power of two as the factor no digit changes, so that an answer comes back exactly.

    Args:
        robot: the arm.
        tool: the drill.
        hole: what is drilled.
        settings: how; weights of criteria are not of any size, and stay as they are.
        factor: above 0.
    """
    arm, T = robot.arm, tool.T_flange_tcp.copy()
    T[:3, 3] *= factor
    a1, a2, b, c1, c2, c3, c4 = (length * factor for length in arm[:7])
    return (
        replace(
            robot,
            arm=arm._replace(a1=a1, a2=a2, b=b, c1=c1, c2=c2, c3=c3, c4=c4),
            dynamics=None,
            base_in_root=None,
            bodies=(),
        ),
        replace(tool, T_flange_tcp=T, load=None, bodies=()),
        replace(
            hole,
            target=hole.target * factor,
            depth=hole.depth * factor,
            profile=None if hole.profile is None else resized_profile(hole.profile, factor),
        ),
        replace(scaled(settings, factor), surroundings=NOTHING_AROUND),
    )


def resized_profile(profile: Profile, factor: float) -> Profile:
    """The same spins at stand-offs times a factor."""
    return Profile(profile.standoff * factor, profile.psi)
