"""The figures of a plan once more, from the model alone: what `zerorev check` holds the stated ones against.

Every one is computed from robot, tool, settings, profile and the joints at the first breakpoint, with the check's own
kinematics (`verify.arm`) and its own Jacobian (`verify.lever`).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from zerorev.model._arrays import Array
from zerorev.model.hole import Hole
from zerorev.model.job import Settings
from zerorev.model.measures import Measures
from zerorev.model.plan import Baseline, Event, HolePlan, LostMotion, Motion, Score
from zerorev.model.robot import Robot
from zerorev.model.tool import Tool
from zerorev.verify.lever import compliance, line_rates, manipulability
from zerorev.verify.lost_motion import lost_motion
from zerorev.verify.sound import limit_distances
from zerorev.verify.turning import Course, Turning, turning

__all__ = ["Figures", "figures", "nearer_turn"]

TURN = 2 * np.pi
POSES = 400  # of a motion, evenly along its path: the measures of the criteria are the greatest or least of these
JUMP = 0.5  # [rad] between neighbouring samples: a baseline with such a step cannot be run
LIMIT_TOLERANCE = 1e-11  # [rad]
NO_LEVER = 1e-12  # of d theta / d psi: below it the spin does not move a joint
TOGETHER = 1e-9  # [m] on an arm of size 1: joints that turn closer together than this turn at one place


@dataclass(frozen=True)
class Figures:
    """What a motion comes to.

    Attributes:
        answer: the plan of the hole with score, baseline, critical rates, measures and wrist offset as found here.
        joints: along the motion [rad], shape (N, 6).
    """

    answer: HolePlan
    joints: Array


def figures(robot: Robot, tool: Tool, settings: Settings, stated: HolePlan) -> Figures | None:
    """The figures of a motion; what else the plan of the hole says is left as it is.

    Args:
        robot: the arm.
        tool: the drill.
        settings: for the rule of the threshold, the feed of the plunge and the stiffness of the joints.
        stated: with a motion.

    Returns:
        None where the motion cannot be followed, or leaves the posture it begins in.
    """
    motion = stated.motion
    if motion is None:
        return None
    hole, profile = stated.hole, motion.profile
    course = Course(robot, tool, hole, profile, motion.joints[0])
    joints = course.joints(course.segment, course.fraction)
    if not np.isfinite(joints).all():
        return None
    turned = turning(course)
    score = _score(course, turned)
    lost = lost_motion(course, settings.thrust)
    answer = replace(
        stated,
        score=score,
        wrist_offset=_wrist_offset(robot, tool),
        baseline=_baseline(robot, tool, hole, motion, settings.limit_margin),
        critical_rates=_critical(robot, tool, hole, motion),
        measures=_measures(course, settings, score, lost),
        lost_motion=lost,
    )
    return Figures(answer, joints)


def nearer_turn(robot: Robot, settings: Settings, motion: Motion, joints: Array) -> tuple[int, float] | None:
    """A joint (0 to 5) whose turn is not the one that the settings ask for, and that turn [rad]; None: all are.

    Of the turns that keep the whole path within the limits, it is the one nearest to `near_joints`, or else farthest
    from the limits.

    Args:
        robot: the arm.
        settings: with `near_joints`.
        motion: as stated.
        joints: along it [rad], shape (N, 6).
    """
    low, high = joints.min(axis=0), joints.max(axis=0)
    lower, upper = robot.limits.lower + settings.limit_margin, robot.limits.upper - settings.limit_margin
    aim = (lower + upper) / 2 if settings.near_joints is None else np.array(settings.near_joints)
    away = np.abs((low + high) / 2 - aim)
    for turn in (-TURN, TURN):
        fits = (low + turn >= lower) & (high + turn <= upper)
        better = fits & (np.abs((low + high) / 2 + turn - aim) < away - 1e-6)
        if better.any():
            joint = int(np.argmax(better))
            return joint, float(motion.joints[0, joint] + turn)
    return None


def _score(course: Course, turned: Turning) -> Score:
    """Travel and extents are taken through the very points where a joint turns."""
    knots = course.profile.distance
    distance = np.concatenate([course.distance(course.segment, course.fraction), turned.places])
    segment = np.minimum(np.searchsorted(knots, turned.places, side="right") - 1, knots.size - 2)
    fraction = (turned.places - knots[segment]) / np.diff(knots)[segment]
    order = np.argsort(distance, kind="stable")
    joints = course.joints(
        np.concatenate([course.segment, segment])[order], np.concatenate([course.fraction, fraction])[order]
    )
    moved = np.abs(np.diff(joints, axis=0))
    corner = course.profile.corner
    on_retract = distance[order][1:] > knots[corner]
    legs = np.stack([moved[~on_retract].sum(axis=0), moved[on_retract].sum(axis=0)])
    lengths = np.array([knots[corner], knots[-1] - knots[corner]])
    return Score(
        reversals_per_joint=tuple(sum(event.joint == joint + 1 for event in turned.events) for joint in range(6)),
        events=_in_order(turned.events, turned.places, TOGETHER * course.robot.size),
        travel=float(legs.sum()),
        min_rate=turned.slowest,
        mean_rate=(legs / lengths[:, None]).min(axis=0),
        limit_distance=limit_distances(course.robot, joints).min(axis=0),
    )


def _in_order(events: tuple[Event, ...], places: Array, together: float) -> tuple[Event, ...]:
    """Events in order of motion; those at one place, but for rounding, in order of joints."""
    group = np.cumsum(np.diff(places, prepend=places[:1]) > together)
    return tuple(events[i] for i in sorted(range(len(events)), key=lambda i: (group[i], events[i].joint)))


def _baseline(robot: Robot, tool: Tool, hole: Hole, motion: Motion, margin: float) -> Baseline | None:
    """The same hole at constant spin, from the same start; None where it cannot be run."""
    profile = motion.profile
    course = Course(robot, tool, hole, profile.at_constant_spin(), motion.joints[0])
    joints = course.joints(course.segment, course.fraction)
    if not np.isfinite(joints).all() or np.abs(np.diff(joints, axis=0)).max() > JUMP:
        return None
    turned = turning(course)
    score = _score(course, turned)
    low, high = joints.min(axis=0), joints.max(axis=0)
    least = np.ceil((robot.limits.lower + margin - low - LIMIT_TOLERANCE) / TURN)
    most = np.floor((robot.limits.upper - margin - high + LIMIT_TOLERANCE) / TURN)
    return Baseline(score.reversals_per_joint, score.travel) if (least <= most).all() else None


def _critical(robot: Robot, tool: Tool, hole: Hole, motion: Motion) -> Array:
    """The critical rates at the corner [rad/m], shape (6,); NaN where the spin does not move a joint."""
    corner = motion.joints[[motion.profile.corner]]
    by_standoff, by_spin = (line_rates(robot, tool, hole, corner, *by)[0] for by in ((1.0, 0.0), (0.0, 1.0)))
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(np.abs(by_spin) > NO_LEVER, -by_standoff / by_spin, np.nan)


def _wrist_offset(robot: Robot, tool: Tool) -> float:
    """Distance of the wrist centre from the drill axis [m]: both are fixed in the tool, so it takes no arm."""
    axis, tip = tool.T_flange_tcp[:3, 2], tool.T_flange_tcp[:3, 3]
    return float(np.linalg.norm(np.cross(axis, np.array([0.0, 0.0, -robot.arm.c4]) - tip)))


def _measures(course: Course, settings: Settings, score: Score, lost: LostMotion | None) -> Measures[float]:
    """What the criteria measure; compliance and manipulability at `POSES` poses, spread evenly along the path."""
    profile, robot, tool = course.profile, course.robot, course.tool
    lengths = np.abs(np.diff(profile.standoff))
    counts = np.maximum(2, np.ceil(POSES * lengths / lengths.sum()).astype(int) + 1)
    segment = np.repeat(np.arange(lengths.size), counts)
    fraction = np.concatenate([np.linspace(0.0, 1.0, count) for count in counts])
    joints = course.joints(segment, fraction)
    give = np.full(2, np.nan)
    if settings.joint_stiffness is not None:
        give = compliance(robot, tool, joints, settings.joint_stiffness, course.hole.direction).max(axis=1)
    rates = score.min_rate if settings.min_rate_rule == "pointwise" else score.mean_rate
    steady = rates[np.array(score.reversals_per_joint) == 0]
    turns = np.abs(np.diff(profile.psi))[: profile.corner]
    rises = profile.standoff[: profile.corner] - profile.standoff[profile.corner]
    drilled = int((rises > settings.creep * (1 + 1e-6)).sum())  # but for where the tool spins on
    half_range = (robot.limits.upper - robot.limits.lower) / 2
    return Measures(
        travel=score.travel,
        margin=float(steady.min(initial=np.inf)) if steady.size else 0.0,
        plunge_rotation=float(turns.sum()),
        tool_speed_change=float((turns / lengths[: profile.corner])[:drilled].max() * settings.feed_plunge),
        limit_distance=float((score.limit_distance / half_range).min()),
        compliance_axial=float(give[0]),
        compliance_lateral=float(give[1]),
        manipulability=float(manipulability(robot, tool, joints).min()),
        lost_motion=np.nan if lost is None else lost.at_tip,
    )
