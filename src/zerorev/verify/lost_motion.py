"""The predicted lost motion of a motion once more, with the check's own arm and its own statics (theory §9).

The weights are turned about the axes of the arm at rest, one after the other, and their moments taken; nothing follows
the recursion of the kernels.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

from zerorev.model._arrays import Array
from zerorev.model.dynamics import nominal_drives
from zerorev.model.plan import LegName, LostMotion, LostMotionEvent
from zerorev.verify.arm import skeleton
from zerorev.verify.lever import lever
from zerorev.verify.turning import Course

__all__ = ["lost_motion"]

GRAVITY = 9.81  # [m/s^2]
LEVELS = (0.1, 0.4, 1.0)  # of the dry friction, behind the gear
POINTS_A_SIDE = 12  # of the turn, over half a stroke
NARROWER, TIMES = 33, 5

BESIDE = 1e-9  # of a segment

Indices = npt.NDArray[np.intp]


def lost_motion(course: Course, thrust: float) -> LostMotion | None:
    """At the tip, and of the motion run backwards; None without dynamics, or where a joint cannot be followed.

    Args:
        course: the motion.
        thrust: of the drill while it plunges [N].
    """
    if course.robot.dynamics is None or len(course.profile.turns) > 1:
        return None
    at_tip = _at_tip(course, thrust)
    if not np.isfinite(at_tip):
        return None
    profile = course.profile
    backwards = profile.reversed()
    last = course.joints(np.array([0, profile.standoff.size - 2]), np.array([0.0, 1.0]))[1]
    twin = _at_tip(Course(course.robot, course.tool, course.hole, backwards, last), thrust)
    return LostMotion(at_tip, float(twin) if np.isfinite(twin) else None, tuple(_events(course, thrust)))


def _at_tip(course: Course, thrust: float) -> float:
    """Greatest deviation across the axis from its mean [m], over the levels of friction."""
    profile = course.profile
    knots, corner = profile.distance, profile.corner
    half = (profile.standoff[0] - profile.standoff[corner]) / 2
    places = knots[corner] + half * np.arange(-POINTS_A_SIDE, POINTS_A_SIDE + 1) / POINTS_A_SIDE
    segment = np.clip(np.searchsorted(knots, places, side="right") - 1, 0, knots.size - 2)
    segment[POINTS_A_SIDE] = corner - 1  # the turn itself is the end of the plunge
    fraction = np.clip((places - knots[segment]) / np.diff(knots)[segment], 0.0, 1.0)
    load, moves, _ = _carried(course, segment, fraction, thrust)
    drives = nominal_drives(course.robot.dynamics.payload) if course.robot.dynamics else None
    assert drives is not None
    give = load / drives.stiffness + drives.lost_motion / 2 * np.sign(load)
    d = course.hole.direction
    across = np.einsum("lnj,nja->lna", give, moves @ (np.eye(3) - np.outer(d, d)))
    return float(np.linalg.norm(across - across.mean(axis=1, keepdims=True), axis=-1).max())


def _events(course: Course, thrust: float) -> Iterator[LostMotionEvent]:
    """Where a load changes its sign, but not the joint its direction, in order of motion."""
    corner = course.profile.corner
    segment, fraction = _with_turns(course, thrust)
    load, _, sense = _carried(course, segment, fraction, thrust)
    crossed = (load[:, :-1] * load[:, 1:] < 0) & (sense[:-1] * sense[1:] > 0)
    found = []
    for level, n, joint in np.argwhere(crossed).tolist():
        k = int(segment[n])
        leg: LegName = "plunge" if k < corner else "retract"
        at = 1.0  # two samples of one place: only the thrust can change between them
        if segment[n + 1] == k:
            at = _between(course, thrust, k, fraction[n], fraction[n + 1], joint, level)
        elif k == corner - 1:
            leg = "target"
        standoff = float(course.profile.standoff[k] + at * np.diff(course.profile.standoff)[k])
        place = float(course.profile.distance[k] + at * np.diff(course.profile.distance)[k])
        found.append((place, joint, LEVELS[level], LostMotionEvent(joint + 1, leg, standoff, LEVELS[level])))
    yield from (event for *_, event in sorted(found, key=lambda each: each[:3]))


def _with_turns(course: Course, thrust: float) -> tuple[Indices, Array]:
    """The regular samples, and one on either side of each place where a joint turns round: segments and fractions."""
    segment, fraction = course.segment, course.fraction
    sense = _carried(course, segment, fraction, thrust)[2]
    inside = (segment[:-1] == segment[1:])[:, None] & (sense[:-1] * sense[1:] < 0)
    more = []
    for n, joint in np.argwhere(inside).tolist():
        k = int(segment[n])
        at = _between(course, thrust, k, fraction[n], fraction[n + 1], joint)
        more += [(k, at - BESIDE), (k, at + BESIDE)]
    both = sorted([*zip(segment.tolist(), fraction.tolist(), strict=True), *more])
    return np.array([k for k, _ in both]), np.array([at for _, at in both])


def _between(
    course: Course, thrust: float, segment: int, low: float, high: float, joint: int, level: int | None = None
) -> float:
    """Fraction of a segment at which a load of a level changes its sign, or a joint its direction."""
    for _time in range(TIMES):
        fractions = np.linspace(low, high, NARROWER)
        load, _, sense = _carried(course, np.full(NARROWER, segment), fractions, thrust)
        near = (sense if level is None else load[level])[:, joint]
        m = max(int(np.argmax(near * near[0] <= 0)), 1)
        low, high = float(fractions[m - 1]), float(fractions[m])
    return (low + high) / 2


def _carried(course: Course, segment: Indices, fraction: Array, thrust: float) -> tuple[Array, Array, Array]:
    """Loads of the joints, their moves of the tip, and which way they turn, at N points.

    Returns:
        loads [N m], shape (levels, N, 6); moves of the tip [m/rad], (N, 6, 3); directions, (N, 6): all of the angles
        that the controller shows.
    """
    robot, tool = course.robot, course.tool
    assert robot.dynamics is not None
    joints = course.joints(segment, fraction)
    sense = np.sign(course.rates(segment, fraction))
    sign = np.array(robot.arm.sign)
    parts, body = lever(robot, tool, joints), skeleton(robot.arm, joints)
    axes = np.moveaxis(parts.axes, -1, 0) * sign[:, None]
    base = np.zeros_like(parts.wrist)
    through = np.stack([base, body.shoulder, body.elbow, parts.wrist, parts.wrist, parts.wrist])
    through = np.moveaxis(through, -1, 0)
    moves = np.cross(axes, parts.tip.T[:, None] - through)
    weighs = np.array([link.mass for link in robot.dynamics.links])
    centres = _centres(course, joints)
    if tool.load is not None:
        weighs = np.append(weighs, tool.load.mass)
    held = np.zeros(joints.shape)
    for k, (mass, centre) in enumerate(zip(weighs, centres, strict=True)):
        carrying = slice(0, min(k, 5) + 1)
        held[:, carrying] += mass * GRAVITY * np.cross(axes, centre[:, None] - through)[:, carrying, 2]
    drives = nominal_drives(robot.dynamics.payload)
    pushed = np.where(segment < course.profile.corner, thrust, 0.0)[:, None] * (moves @ course.hole.direction)
    load = held + pushed + sense * np.outer(LEVELS, drives.coulomb)[:, None]
    return load, moves, sense


def _centres(course: Course, joints: Array) -> list[Array]:
    """Centres of mass of the links, and of the tool [m], (N, 3) each: turned about the axes of the arm at rest."""
    robot, tool = course.robot, course.tool
    assert robot.dynamics is not None
    rest = np.zeros((1, 6))
    parts, body = lever(robot, tool, rest), skeleton(robot.arm, rest)
    sign = np.array(robot.arm.sign)
    axes = parts.axes[..., 0] * sign[:, None]
    through = [np.zeros(3), body.shoulder[:, 0], body.elbow[:, 0], *[parts.wrist[:, 0]] * 3]
    places = [link.T_base_link[:3, :3] @ link.com + link.T_base_link[:3, 3] for link in robot.dynamics.links]
    if tool.load is not None:
        places.append(body.R_base_flange[..., 0] @ tool.load.com + body.flange[:, 0])
    found = []
    for k, place in enumerate(places):
        moved = np.tile(place, (len(joints), 1))
        for joint in range(min(k, 5), -1, -1):
            moved = _about(axes[joint], through[joint], joints[:, joint], moved)
        found.append(moved)
    return found


def _about(axis: Array, through: Array, angle: Array, places: Array) -> Array:
    """Places (N, 3) turned about a line by angles (N,) (Rodrigues)."""
    arm = places - through
    c, s = np.cos(angle)[:, None], np.sin(angle)[:, None]
    return np.asarray(through + c * arm + s * np.cross(axis, arm) + (1 - c) * (arm @ axis)[:, None] * axis)
