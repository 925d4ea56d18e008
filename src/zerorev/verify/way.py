"""The way to a motion and away from it, and its corner of joint moves, for the check of what they come near to."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from zerorev.model._arrays import Array
from zerorev.model.hole import Hole
from zerorev.model.plan import Clearance, Corner, Motion
from zerorev.model.robot import Robot
from zerorev.model.settings import Settings
from zerorev.model.tool import Tool
from zerorev.verify.arm import posture_of
from zerorev.verify.joint_corner import corner_figures
from zerorev.verify.path import Path, Track, follow

__all__ = ["corner_moves", "way_as_asked", "way_tracks"]

SAMPLES = 2_000  # of each part of the way
TOLERANCE = 1e-9  # [m], for an arm of size 1


def way_tracks(robot: Robot, tool: Tool, hole: Hole, motion: Motion, claimed: Clearance) -> list[Track]:
    """Lead-in and approach, inwards, and the retract, outwards, as long as a plan says that they are covered.

    The lead-in continues the plunge leg backwards; approach and retract lie along the drill axis at constant spin.

    Args:
        robot: the arm.
        tool: the drill.
        hole: the drill axis.
        motion: of the hole.
        claimed: with the lengths; of what it does not say nothing is examined.
    """
    profile = motion.profile
    out, first, last = float(profile.standoff[0]), float(profile.psi[0]), float(profile.psi[-1])
    slope = (profile.psi[1] - first) / (profile.standoff[1] - out)
    lead_in, approach, retract = (length or 0.0 for length in (claimed.lead_in, claimed.approach, claimed.retract))
    begun = first + float(slope) * lead_in
    tracks: list[Track] = []
    start = motion.joints[0]
    for begin, length, psi, to in ((out, lead_in, first, begun), (out + lead_in, approach, begun, begun)):
        if length > 0:
            tracks.append(_outwards(robot, tool, hole, (begin, length), (psi, to), start))
            start = tracks[-1].joints[-1]
            if np.isnan(start).any():
                return tracks
    # they are followed from the motion outwards, and run the other way: what is near to them is the same
    if retract > 0:
        tracks.append(_outwards(robot, tool, hole, (out, retract), (last, last), motion.joints[-1]))
    return tracks


def _outwards(
    robot: Robot, tool: Tool, hole: Hole, standoff: tuple[float, float], psi: tuple[float, float], start: Array
) -> Track:
    """A line of the twist plane from a stand-off, so long [m], with the spins at both ends [rad]."""
    share = np.linspace(0.0, 1.0, SAMPLES)
    path = Path(standoff[0] + share * standoff[1], psi[0] + share * (psi[1] - psi[0]), (), SAMPLES)
    return Track(path, follow(robot, tool, hole, path, posture_of(robot.arm, start), start), robot.nil_rate)


def way_as_asked(robot: Robot, settings: Settings, claimed: Clearance) -> Iterator[str]:
    """That a part of the way is said to be longer than asked for.

    Args:
        robot: the arm.
        settings: with the lengths that are asked for.
        claimed: with the lengths that are covered.
    """
    for name, length, asked in (
        ("lead-in", claimed.lead_in, settings.lead_in), ("approach", claimed.approach, settings.approach),
        ("retract", claimed.retract, settings.retract),
    ):  # fmt: skip
        if length is not None and length > asked + TOLERANCE * robot.size:
            yield f"a {name} of {length * 1e3:g} mm is said to keep clear, asked for are {asked * 1e3:g} mm"


def corner_moves(robot: Robot, tool: Tool, hole: Hole, motion: Motion, corner: Corner | None) -> Array:
    """Joints at the ends of the joint moves of a corner [rad], shape (n, 6); n = 0 where it is made of none.

    Args:
        robot: the arm.
        tool: the drill.
        hole: the drill axis.
        motion: of the hole.
        corner: what the plan says of it.
    """
    if corner is None or corner.kind not in ("joint", "spin") or not 0 < corner.reach <= hole.depth:
        return np.empty((0, 6))
    spin = corner.spin_moves or 0
    if not spin < motion.profile.corner:  # which is said elsewhere
        return np.empty((0, 6))
    return corner_figures(robot, tool, hole, motion, corner.reach, spin).joints
