"""What a user should know of a motion that comes near to a joint limit."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from zerorev.model._arrays import Array
from zerorev.model.finding import Finding
from zerorev.model.plan import Event, HolePlan, LegName, Motion
from zerorev.motion.drilling import Drilling
from zerorev.motion.evaluation import event_distance
from zerorev.motion.joint_path import FULL_TURN, joints_along
from zerorev.program.ways import Way

__all__ = ["NEAR", "limit_findings"]

NEAR = float(np.deg2rad(1.0))  # to a joint limit
SAMPLES = 400  # of a leg, at most
SAID = 0.01  # [deg] to which a distance is said


def limit_findings(drilling: Drilling, answer: HolePlan, way: Way) -> Iterator[Finding]:
    """One for each joint that comes within 1 deg of a limit of the robot, on the linear moves of a hole.

    Args:
        drilling: robot, tool and hole.
        answer: with a motion and its score.
        way: to the motion and away from it.
    """
    motion, score = answer.motion, answer.score
    assert motion is not None
    assert score is not None
    limits, names = drilling.robot.limits, drilling.robot.joint_names
    outside = np.array([at for at, _ in _ends(way)])
    room = np.minimum(outside - limits.lower, limits.upper - outside)
    if min(score.limit_distance.min(), room.min()) >= NEAR:
        return
    # between these no joint turns round, but in the air; of places that are one the first is named
    places = [*_breakpoints(motion), *_ends(way), *_reversals(drilling, motion, score.events)]
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


def _ends(way: Way) -> Iterator[tuple[Array, str]]:
    """Of the linear moves outside the stroke."""
    yield way.lead_in.joints, "where the lead-in begins"
    yield way.approach.joints, "where the approach begins"
    yield way.retract.joints, "where the arm stops after the retract"


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
