"""What a user should know of a motion that comes near to a joint limit."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from zerorev.model._arrays import Array
from zerorev.model.finding import Finding
from zerorev.model.plan import Event, HolePlan, LegName, Motion
from zerorev.model.settings import Settings
from zerorev.motion.drilling import Drilling
from zerorev.motion.evaluation import event_distance
from zerorev.motion.joint_path import FULL_TURN, joints_along
from zerorev.program.lead_in import find_lead_in

__all__ = ["NEAR", "limit_findings"]

NEAR = float(np.deg2rad(1.0))  # to a joint limit
SAMPLES = 400  # of a leg, at most
SAID = 0.01  # [deg] to which a distance is said


def limit_findings(drilling: Drilling, settings: Settings, answer: HolePlan) -> Iterator[Finding]:
    """One for each joint that comes within 1 deg of a limit of the robot, on the legs or in the lead-in.

    Args:
        drilling: robot, tool and hole.
        settings: for the length of the lead-in.
        answer: with a motion and its score.
    """
    motion, score = answer.motion, answer.score
    if motion is None or score is None:
        return
    limits, names = drilling.robot.limits, drilling.robot.joint_names
    start = find_lead_in(drilling, motion, settings.lead_in).joints
    room = np.minimum(start - limits.lower, limits.upper - start)
    if min(score.limit_distance.min(), room.min()) >= NEAR:
        return
    # between these places no joint turns round
    places = [(start, "where the lead-in begins"), *_breakpoints(motion), *_reversals(drilling, motion, score.events)]
    joints = np.array([at for at, _ in places])
    below, above = joints - limits.lower, limits.upper - joints
    room = np.minimum(below, above)
    for joint, place in enumerate(room.argmin(axis=0).tolist()):
        least = float(room[place, joint])
        if least >= NEAR:
            continue
        distance, lower = float(np.rad2deg(least)), below[place, joint] < above[place, joint]
        within = f"within {distance:.2f} deg" if distance >= SAID else f"nearer than {SAID:g} deg"
        end = float(np.rad2deg((limits.lower if lower else limits.upper)[joint]))
        message = (
            f"{names[joint]} comes {within} of its limit of {end:g} deg, {places[place][1]}: a part that stands off its"
            " place may bring it beyond; limit_margin_deg keeps room there"
        )
        yield Finding("warning", "near_limit", message, answer.hole.id)


def _breakpoints(motion: Motion) -> Iterator[tuple[Array, str]]:
    profile, joints = motion.profile, motion.joints
    last = len(joints) - 1
    ends = {0: "where the plunge begins", profile.corner: "at the target", last: "where the retract ends"}
    for k, standoff in enumerate(profile.standoff.tolist()):
        yield joints[k], ends.get(k) or _place("plunge" if k < profile.corner else "retract", standoff)


def _reversals(drilling: Drilling, motion: Motion, events: tuple[Event, ...]) -> Iterator[tuple[Array, str]]:
    profile = motion.profile
    corner = float(profile.distance[profile.corner])
    for event in events:
        if event.leg != "target":
            # followed from the target, for the turns
            between = np.linspace(corner, event_distance(profile, event), SAMPLES)
            joints = joints_along(drilling, motion.branch, *profile.at(between))
            turns = FULL_TURN * np.round((motion.joints[profile.corner] - joints[0]) / FULL_TURN)
            yield joints[-1] + turns, _place(event.leg, event.standoff)


def _place(leg: LegName, standoff: float) -> str:
    return f"in the {leg}, {standoff * 1e3:.2f} mm out"
