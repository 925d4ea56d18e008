"""A robot of the class from six axes in space: which conditions hold, and the seven lengths, signs and offsets.

Lengths, signs and model angles are those of Brandstoetter, Angerer, Hofbaur (2014), fig. 1; the arm is examined where
all of its joints are at 0, in a frame turned with axis 1.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from zerorev.errors import InputError
from zerorev.model._arrays import Array, rpy_of, transform
from zerorev.model.axes import Axes
from zerorev.model.robot import ArmGeometry, JointLimits, Robot, six
from zerorev.motion.kinematics import forward

__all__ = ["EQUAL", "TOLERANCE", "Found", "conditions", "robot_of_axes"]

TOLERANCE = 1e-6  # [m] and [rad]: what counts as parallel, perpendicular, meeting
EQUAL = 1e-9  # [m] and [1]: between the poses of the arm and those of its source
POSES = 200
DIGITS_MM, DIGITS_DEG = 8, 10  # beyond the tenth of a nanometre, what is left of a sum in metres is rounding


@dataclass(frozen=True)
class Found:
    """A robot that moves as the axes do.

    Attributes:
        robot: whose base frame stands on axis 1.
        T_root_arm: its base frame in the root frame of the axes, shape (4, 4).
        T_flange_tip: the tip in the flange frame of the robot, shape (4, 4); the identity where they are one.
        apart: the greatest difference of the poses from those of the axes [m], or of an entry of the rotation [1].
    """

    robot: Robot
    T_root_arm: Array
    T_flange_tip: Array
    apart: float


def conditions(axes: Axes) -> list[str]:
    """Which conditions of the class fail, each with its number; none where the arm is of the class.

    The class: axis 1 across axis 2, axes 2 and 3 parallel, axis 4 across axis 3, axes 4, 5, 6 each across the next, and
    meeting in one point.
    """
    z = axes.direction
    if _apart(z[1], z[2]) < TOLERANCE and _apart(z[2], z[3]) < TOLERANCE:
        return ["axes 2, 3 and 4 are parallel: an arm of the other class in closed form (UR and its like)"]
    failed = []
    if (off := _apart(z[1], z[2])) >= TOLERANCE:
        failed.append(f"axes 2 and 3 are {_deg(off)} from parallel")
    for one, other in ((1, 2), (3, 4), (4, 5), (5, 6)):
        off = abs(math.asin(np.clip(z[one - 1] @ z[other - 1], -1, 1)))
        if off >= TOLERANCE:
            failed.append(f"axes {one} and {other} are {_deg(off)} from perpendicular")
    for one, other in ((4, 5), (5, 6)):
        gap = _gap(axes, one - 1, other - 1)
        if gap >= TOLERANCE:
            failed.append(f"axes {one} and {other} pass each other {gap * 1e3:.4g} mm apart (offset wrist)")
    if not failed and (gap := _from_line(_meeting(axes), axes, 5)) >= TOLERANCE:
        failed.append(f"axes 4 and 5 meet {gap * 1e3:.4g} mm from axis 6 (no common wrist centre)")
    return failed


def robot_of_axes(axes: Axes, **words: object) -> Found:
    """The robot of six axes, compared with them at 200 random joint angles.

    Args:
        axes: of an arm with limits and speeds.
        words: further attributes of the robot: manufacturer, model, sources and so on.

    Raises:
        InputError: the arm is not of the class, a limit is missing, or the robot would not move as the axes do.
    """
    if failed := conditions(axes):
        accepted = "an ortho-parallel arm with a spherical wrist: docs/howto/own_robot.md"
        raise InputError(f"{axes.name}: {'; '.join(failed)}", accepted=accepted)
    T_root_arm = _arm_frame(axes)
    arm = _geometry(axes, T_root_arm)
    inner = np.linalg.inv(T_root_arm) @ axes.T_root_base
    robot = Robot(
        name=axes.name,
        arm=arm,
        limits=JointLimits(axes.lower, axes.upper, axes.speed),
        joint_names=axes.joint_names,
        base_in_root=_six(inner),
        **words,  # type: ignore[arg-type]
    )
    T_flange_tip = np.linalg.inv(forward(robot, np.zeros(6))) @ np.linalg.inv(T_root_arm) @ axes.T_root_tip
    if np.abs(T_flange_tip - np.eye(4)).max() < EQUAL:
        T_flange_tip = np.eye(4)
    joints = np.random.default_rng(0).uniform(-math.pi, math.pi, (POSES, 6))
    apart = float(np.abs(T_root_arm @ forward(robot, joints) @ T_flange_tip - axes.forward(joints)).max())
    if not apart < EQUAL:
        message = f"{axes.name}: the arm of the class that is nearest to it differs by {apart:.2g} m"
        raise InputError(message, accepted=f"less than {EQUAL:g} m")
    return Found(robot, T_root_arm, T_flange_tip, apart)


def _arm_frame(axes: Axes) -> Array:
    """The base frame of the arm in the root frame: the root's own axes, moved onto axis 1, where that stands upright.

    Else z lies along axis 1, and x next to the root's x.
    """
    z1, p1 = axes.direction[0], axes.point[0]
    R = np.eye(3)
    if _apart(z1, R[2]) >= TOLERANCE:
        z = z1 if z1[2] >= 0 else -z1
        ahead = R[0] if abs(z[0]) < 0.9 else R[1]
        x = ahead - (ahead @ z) * z
        x /= np.linalg.norm(x)
        R = np.column_stack([x, np.cross(z, x), z])
    foot = p1 - (p1 @ z1) * z1
    foot[np.abs(foot) < EQUAL] = 0.0
    return transform(R, foot)


def _geometry(axes: Axes, T_root_arm: Array) -> ArmGeometry:
    """Lengths, signs and offsets of an arm that fulfils the conditions."""
    R, origin = T_root_arm[:3, :3], T_root_arm[:3, 3]
    z, p = axes.direction @ R, (axes.point - origin) @ R  # in the base frame of the arm
    wrist = (_meeting(axes) - origin) @ R
    tip, tip_axes = (axes.T_root_tip[:3, 3] - origin) @ R, R.T @ axes.T_root_tip[:3, :3]
    e_z = np.array([0.0, 0.0, 1.0])
    e_y = z[1] - z[1, 2] * e_z
    e_y /= np.linalg.norm(e_y)
    e_x = np.cross(e_y, e_z)
    forward_of = p[1] @ e_x
    if abs(forward_of) < TOLERANCE:  # then the side on which the wrist is, else that of the base's x
        forward_of = wrist @ e_x if abs(wrist @ e_x) >= TOLERANCE else e_x[0]
    if forward_of < 0:
        e_x, e_y = -e_x, -e_y
    upper = p[2] - p[1] - ((p[2] - p[1]) @ e_y) * e_y
    q2 = math.atan2(upper @ e_x, upper @ e_z)
    to_wrist = wrist - p[2]
    along = to_wrist @ z[3] if abs(to_wrist @ z[3]) >= TOLERANCE else (tip - wrist) @ z[3]
    f = z[3] if along >= 0 else -z[3]
    q23 = math.atan2(f @ e_x, f @ e_z)
    x3 = math.cos(q23) * e_x - math.sin(q23) * e_z
    across = z[4] @ e_y if abs(z[4] @ e_y) >= TOLERANCE else 1.0
    e5 = z[4] if across > 0 else -z[4]
    q4 = math.atan2(-e5 @ x3, e5 @ e_y)
    out = (tip - wrist) @ z[5] if abs((tip - wrist) @ z[5]) >= TOLERANCE else tip_axes[:, 2] @ z[5]
    g = z[5] if out >= 0 else -z[5]
    q5 = math.atan2(np.cross(f, g) @ e5, f @ g)
    x5 = math.cos(q5) * (math.cos(q4) * x3 + math.sin(q4) * e_y) - math.sin(q5) * f
    q6 = math.atan2(tip_axes[:, 0] @ e5, tip_axes[:, 0] @ x5) if _apart(tip_axes[:, 2], g) < TOLERANCE else 0.0
    lengths = (
        p[1] @ e_x,
        to_wrist @ x3,
        wrist @ e_y,
        p[1] @ e_z,
        np.linalg.norm(upper),
        to_wrist @ f,
        (tip - wrist) @ g,
    )
    senses = (z[0] @ e_z, z[1] @ e_y, z[2] @ e_y, z[3] @ f, z[4] @ e5, z[5] @ g)
    angles = -np.rad2deg([math.atan2(e_x[1], e_x[0]), q2, q23 - q2, q4, q5, q6])
    offset = np.round(angles - 360.0 * np.ceil(angles / 360.0 - 0.5), DIGITS_DEG) + 0.0  # in (-180, 180]
    a1, a2, b, c1, c2, c3, c4 = (float(np.round(length * 1e3, DIGITS_MM) / 1e3 + 0.0) for length in lengths)
    sign = six([1.0 if sense > 0 else -1.0 for sense in senses])
    return ArmGeometry(a1, a2, b, c1, c2, c3, c4, sign, six(np.deg2rad(offset)))


def _meeting(axes: Axes) -> Array:
    """The point of axis 4 that is nearest to axis 5 [m]; they are not parallel."""
    z4, z5, p4, p5 = axes.direction[3], axes.direction[4], axes.point[3], axes.point[4]
    across = np.cross(z4, z5)
    return np.asarray(p4 + (np.cross(p5 - p4, z5) @ across / (across @ across)) * z4)


def _apart(one: Array, other: Array) -> float:
    """The angle between two lines [rad]."""
    return math.atan2(float(np.linalg.norm(np.cross(one, other))), abs(float(one @ other)))


def _gap(axes: Axes, one: int, other: int) -> float:
    """The least distance of two axes [m]."""
    across = np.cross(axes.direction[one], axes.direction[other])
    length = float(np.linalg.norm(across))
    between = axes.point[other] - axes.point[one]
    return _from_line(axes.point[other], axes, one) if length < 0.1 else float(abs(between @ across) / length)


def _from_line(point: Array, axes: Axes, k: int) -> float:
    """The distance of a point from an axis [m]."""
    return float(np.linalg.norm(np.cross(point - axes.point[k], axes.direction[k])))


def _six(T: Array) -> tuple[float, float, float, float, float, float] | None:
    """A frame as x, y, z [m], roll, pitch, yaw [rad]; None: it changes nothing."""
    if np.abs(T - np.eye(4)).max() < EQUAL:
        return None
    place, angles = np.round(T[:3, 3] * 1e3, DIGITS_MM) / 1e3, np.round(np.rad2deg(rpy_of(T[:3, :3])), DIGITS_DEG)
    return six(np.r_[place + 0.0, np.deg2rad(angles) + 0.0])


def _deg(angle: float) -> str:
    return f"{np.rad2deg(angle):.4g} deg"
