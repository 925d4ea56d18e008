"""Is a motion possible at all: in reach, on the drill axis, in one piece, within the joint limits."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from zerorev.model._arrays import Array
from zerorev.model.robot import Robot
from zerorev.verify.path import Track

__all__ = [
    "continuity",
    "greatest_step",
    "least_room",
    "limit_distances",
    "limits",
    "nearest_to_limit",
    "on_the_axis",
    "reach",
    "too_near",
]

POSITION_TOLERANCE = 1e-8  # [m]
ROTATION_TOLERANCE = 1e-8  # [rad]
LIMIT_TOLERANCE = 1e-9  # [rad]

# A jump to another posture is tens of degrees in one step, however short the step. A joint that needs more than these
# rates over more than an isolated step has no drill feed at which it could follow: 286 deg/s at 5 mm/s.
LEAST_JUMP = 0.01  # [rad]
GREATEST_RATE = 1000.0  # [rad/m] for an arm of size 1 (`Robot.size`)
GREATEST_GAIN = 100.0  # [rad per rad of spin]


def reach(track: Track) -> Iterator[str]:
    """Every sample must have joint angles."""
    if np.isfinite(track.extents).all():
        return
    lost = np.flatnonzero(~np.isfinite(track.joints).all(axis=1))
    yield f"out of reach or singular at {lost.size} samples, first {track.path.place(int(lost[0]))}"


def on_the_axis(track: Track, position: Array, rotation: Array) -> Iterator[str]:
    """Forward kinematics must give back the pose asked for.

    Args:
        track: N samples.
        position: position errors [m], shape (N,).
        rotation: rotation errors [rad], shape (N,).
    """
    for error, tolerance, scale, unit, what in (
        (position, POSITION_TOLERANCE, 1e3, "mm", "the tip is"),
        (rotation, ROTATION_TOLERANCE, np.rad2deg(1.0), "deg", "the tool is turned"),
    ):
        if error.max() <= tolerance:  # not where any is NaN
            continue
        worst = _greatest(error)
        if error[worst] > tolerance:
            yield f"{what} {error[worst] * scale:.3g} {unit} off what is asked {track.path.place(worst)}"


def continuity(robot: Robot, track: Track) -> Iterator[str]:
    """No joint may jump from one sample to the next."""
    if greatest_step(track) <= LEAST_JUMP and np.isfinite(track.extents).all():
        return
    path = track.path_steps
    bound = LEAST_JUMP + GREATEST_RATE / robot.size * path + GREATEST_GAIN * np.abs(np.diff(track.path.psi))
    for joint, name in enumerate(robot.joint_names):
        steps = np.abs(np.diff(track.joints[:, joint]))
        worst = _greatest(steps - bound)
        if steps[worst] > bound[worst]:
            yield (
                f"{name} jumps by {np.rad2deg(steps[worst]):.4g} deg within {path[worst] * 1e3:.3g} mm "
                f"{track.path.place(worst)}"
            )


def greatest_step(track: Track) -> float:
    """Greatest step of a joint between two samples that are in reach [rad]."""
    most = np.max([track.moves.most, -track.moves.least])
    return float(np.fmax.reduce(np.abs(np.diff(track.joints, axis=0)), axis=None) if np.isnan(most) else most)


def limit_distances(robot: Robot, joints: Array) -> Array:
    """Distance of joints, shape (..., 6), to the nearer limit [rad], shape (..., 6); negative beyond it."""
    return np.minimum(joints - robot.limits.lower, robot.limits.upper - joints)


def least_room(robot: Robot, track: Track) -> Array:
    """Least distance of each joint to its limits [rad], shape (6,); negative beyond them, NaN where any sample is."""
    low, high = track.extents
    return np.minimum(low - robot.limits.lower, robot.limits.upper - high)


def nearest_to_limit(robot: Robot, track: Track, joint: int) -> int:
    """The sample at which a joint (0 to 5) comes nearest to one of its limits, or goes farthest beyond."""
    limits, angles = robot.limits, track.joints[:, joint]
    return _greatest(-np.minimum(angles - limits.lower[joint], limits.upper[joint] - angles))


def limits(robot: Robot, track: Track, margin: float) -> Iterator[str]:
    """Every sample must be within the joint limits, and keep the room there that was asked for [rad]."""
    room = least_room(robot, track)
    for joint, name in enumerate(robot.joint_names):
        if room[joint] >= margin - LIMIT_TOLERANCE:
            continue
        worst = nearest_to_limit(robot, track, joint)
        nearest = limit_distances(robot, track.joints[worst])[joint]
        if nearest < margin - LIMIT_TOLERANCE:
            yield (
                f"{name} at {np.rad2deg(track.joints[worst, joint]):.4f} deg is {too_near(nearest, margin)} its limits "
                f"({np.rad2deg(robot.limits.lower[joint]):g} to "
                f"{np.rad2deg(robot.limits.upper[joint]):g} deg) {track.path.place(worst)}"
            )


def too_near(distance: float, margin: float) -> str:
    """How far beyond a joint's limits it is, or how near to them for the room that was asked for [rad]."""
    if distance < 0:
        return f"{np.rad2deg(-distance):.3g} deg beyond"
    return f"{np.rad2deg(distance):.3g} deg, and not {np.rad2deg(margin):g} deg, from"


def _greatest(values: Array) -> int:
    """Index of the greatest value; NaN counts as none."""
    return int(np.argmax(np.where(np.isnan(values), -np.inf, values)))
