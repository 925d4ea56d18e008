"""Is a motion possible at all: in reach, on the drill axis, in one piece, within the joint limits."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from zerorev.model._arrays import Array
from zerorev.model.robot import Robot
from zerorev.verify.path import Track

__all__ = ["continuity", "limit_distances", "limits", "on_the_axis", "reach"]

POSITION_TOLERANCE = 1e-8  # [m]
ROTATION_TOLERANCE = 1e-8  # [rad]
LIMIT_TOLERANCE = 1e-9  # [rad]

# A jump to another posture is tens of degrees in one step, however short the step. A joint that needs more than these
# rates over more than an isolated step has no drill feed at which it could follow: 286 deg/s at 5 mm/s.
LEAST_JUMP = 0.01  # [rad]
GREATEST_RATE = 1000.0  # [rad/m]
GREATEST_GAIN = 100.0  # [rad per rad of spin]


def reach(track: Track) -> Iterator[str]:
    """Every sample must have joint angles."""
    lost = np.flatnonzero(~np.isfinite(track.joints).all(axis=1))
    if lost.size:
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
        worst = _greatest(error)
        if error[worst] > tolerance:
            yield f"{what} {error[worst] * scale:.3g} {unit} off what is asked {track.path.place(worst)}"


def continuity(robot: Robot, track: Track) -> Iterator[str]:
    """No joint may jump from one sample to the next."""
    steps = np.abs(np.diff(track.joints, axis=0))
    path = np.abs(np.diff(track.path.standoff))
    bound = LEAST_JUMP + GREATEST_RATE * path + GREATEST_GAIN * np.abs(np.diff(track.path.psi))
    for joint, name in enumerate(robot.joint_names):
        worst = _greatest(steps[:, joint] - bound)
        if steps[worst, joint] > bound[worst]:
            yield (
                f"{name} jumps by {np.rad2deg(steps[worst, joint]):.4g} deg within {path[worst] * 1e3:.3g} mm "
                f"{track.path.place(worst)}"
            )


def limit_distances(robot: Robot, joints: Array) -> Array:
    """Distance of joints, shape (N, 6), to the nearer limit [rad], shape (N, 6); negative beyond it."""
    return np.minimum(joints - robot.limits.lower, robot.limits.upper - joints)


def limits(robot: Robot, track: Track) -> Iterator[str]:
    """Every sample must be within the joint limits."""
    room = limit_distances(robot, track.joints)
    for joint, name in enumerate(robot.joint_names):
        worst = _greatest(-room[:, joint])
        if room[worst, joint] < -LIMIT_TOLERANCE:
            yield (
                f"{name} at {np.rad2deg(track.joints[worst, joint]):.4f} deg is {np.rad2deg(-room[worst, joint]):.3g} "
                f"deg beyond its limits ({np.rad2deg(robot.limits.lower[joint]):g} to "
                f"{np.rad2deg(robot.limits.upper[joint]):g} deg) {track.path.place(worst)}"
            )


def _greatest(values: Array) -> int:
    """Index of the greatest value; NaN counts as none."""
    return int(np.argmax(np.where(np.isnan(values), -np.inf, values)))
