"""What a user should know of the loads on the gears along a motion (theory §9)."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import groupby

import numpy as np

from zerorev.model.finding import Finding
from zerorev.model.plan import HolePlan
from zerorev.model.profile import Profile
from zerorev.model.settings import Settings
from zerorev.motion.drilling import Drilling
from zerorev.motion.loads import LEVELS, lost_motion

__all__ = ["load_findings"]

SHARE = 0.25  # of the lost motion at constant spin, which an error of the tool centre point must not reach
WORST_TCP = 0.2e-3  # [m] an error that a careful calibration stays below


def load_findings(drilling: Drilling, settings: Settings, answer: HolePlan) -> Iterator[Finding]:
    """Joints whose gear changes its flank without a reversal, and how well the tool centre point has to be known.

    Args:
        drilling: robot, tool and hole.
        settings: for the thrust.
        answer: with a motion; nothing is said of one without a predicted lost motion.
    """
    lost, motion = answer.lost_motion, answer.motion
    if lost is None or motion is None:
        return
    hole = answer.hole.id
    events = sorted(lost.events, key=lambda event: event.joint)
    for joint, own in groupby(events, key=lambda event: event.joint):
        changes = list(own)
        levels = sorted({event.friction for event in changes})
        first = changes[0]
        place = "at the target" if first.leg == "target" else f"in the {first.leg}, {first.standoff * 1e3:.1f} mm out"
        shares = " or ".join(f"{level:.0%}" for level in levels)
        message = (
            f"{drilling.robot.joint_names[joint - 1]} does not reverse, but its load changes its sign {place}, if "
            f"{shares} of its nominal friction lies behind its gear: the gear then crosses its lost motion (predicted "
            f"at the tip, of all joints: {lost.at_tip * 1e3:.3f} mm)"
        )
        yield Finding("warning" if len(levels) == len(LEVELS) else "info", "lost_motion", message, hole)
    yield from _calibration(drilling, settings, answer, motion.profile, motion.branch)


def _calibration(
    drilling: Drilling, settings: Settings, answer: HolePlan, profile: Profile, branch: int
) -> Iterator[Finding]:
    """A tool centre point that is off by delta moves the tip by 2 delta sin(turn / 2) while the tool turns."""
    corner = profile.corner
    still = lost_motion(drilling, profile.at_constant_spin(), branch, settings.thrust)
    turn = float(profile.distance[corner])
    half = turn / 2
    _, spins = profile.at(np.linspace(turn - half, turn + half, 41))
    chord = 2 * np.sin(min(float(np.ptp(spins)), np.pi) / 2)
    if still is None or not np.isfinite(still) or chord * WORST_TCP < SHARE * still:
        return
    message = (
        f"the tool turns by {np.rad2deg(np.ptp(spins)):.0f} deg about the turning point: a tool centre point that is "
        f"off by {SHARE * still / chord * 1e3:.2f} mm across the drill axis moves the tip by a quarter of what the "
        f"gears are predicted to do at constant spin ({still * 1e3:.3f} mm)"
    )
    yield Finding("info", "tcp_calibration", message, answer.hole.id)
