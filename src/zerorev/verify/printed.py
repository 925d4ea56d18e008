"""What a program prints, in floats: poses, joints, and how far their last digits may lie off."""

from __future__ import annotations

from collections.abc import Iterable
from decimal import Decimal

import numpy as np

from zerorev.model._arrays import Array, rotation_rpy, transform
from zerorev.model.robot import Robot
from zerorev.model.written import WrittenFrame, WrittenJoints

__all__ = ["angle_slack", "frame_of", "half_a_unit", "joints_of", "length_slack"]

LEVER = 3.0  # [m] of an axis, at most
PLAN = 2e-8  # [m], [rad] that the digits of a plan file leave open
COARSEST = Decimal("0.001")  # [mm], [deg]: of numbers with fewer digits no more is forgiven
QUATERNION = 2.5  # [rad] by which a rotation is off at most, per unit of each number


def frame_of(printed: WrittenFrame) -> Array:
    """A pose, shape (4, 4), translation [m]."""
    turn = _floats(printed.turn)
    if printed.form == "zyx_deg":
        about_z, about_y, about_x = np.deg2rad(turn)
        R = rotation_rpy(float(about_x), float(about_y), float(about_z))
    else:
        R = _of_quaternion(turn if printed.form == "quaternion" else _to_quaternion(turn))
    return transform(R, _floats(printed.xyz_mm) * 1e-3)


def joints_of(robot: Robot, printed: WrittenJoints) -> Array:
    """The joints that turn [rad], shape (6,)."""
    values = _floats(printed.values)
    if printed.unit == "pulses":  # of the joints that turn
        return np.deg2rad(values / _pulses_per_deg(robot))
    shown = values if printed.unit == "rad" else np.deg2rad(values)
    if robot.display.j3_less_j2:
        shown[2] += shown[1]
    return shown


def length_slack(robot: Robot, printed: WrittenFrame | WrittenJoints) -> float:
    """How far a point may lie beside the one that was meant, for its last digits [m]."""
    if isinstance(printed, WrittenJoints):
        return _joints_slack(robot, printed) * LEVER + PLAN
    # half a unit in each of three numbers, of the point and of the frame in which it is given
    return 2 * 0.9 * float(_unit(printed.xyz_mm)) * 1e-3 + PLAN


def angle_slack(robot: Robot, printed: WrittenFrame | WrittenJoints) -> float:
    """How far the tool may be turned from what was meant, for the last digits [rad]."""
    if isinstance(printed, WrittenJoints):
        return _joints_slack(robot, printed) + PLAN
    unit = float(_unit(printed.turn))
    if printed.form == "zyx_deg":
        return float(np.deg2rad(3 * unit)) + PLAN
    return QUATERNION * unit + PLAN


def half_a_unit(number: Decimal) -> float:
    """By how much a printed number may be rounded."""
    return 0.5 * 10.0 ** int(number.as_tuple().exponent)


def _joints_slack(robot: Robot, printed: WrittenJoints) -> float:
    """Half a unit in each of six axes [rad]."""
    if printed.unit == "pulses":
        return float(np.deg2rad(0.5 / np.abs(_pulses_per_deg(robot))).sum())
    unit = float(_unit(printed.values))
    return 3 * (unit if printed.unit == "rad" else float(np.deg2rad(unit)))


def _pulses_per_deg(robot: Robot) -> Array:
    assert robot.pulses_per_deg is not None  # no program of pulses is written for a robot without them
    return np.array(robot.pulses_per_deg)


def _unit(numbers: Iterable[Decimal]) -> Decimal:
    """The unit of the last digit of the number that has the fewest."""
    return min(COARSEST, max(Decimal(1).scaleb(int(number.as_tuple().exponent)) for number in numbers))


def _of_quaternion(q: Array) -> Array:
    w, x, y, z = q / np.linalg.norm(q)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def _to_quaternion(vector: Array) -> Array:
    """Of a rotation vector [rad]."""
    angle = float(np.linalg.norm(vector))
    # sin(angle / 2) / angle, which is 1 / 2 at 0
    return np.array([np.cos(angle / 2), *(vector * np.sinc(angle / (2 * np.pi)) / 2)])


def _floats(values: Iterable[Decimal]) -> Array:
    return np.array([float(value) for value in values])
