"""The numbers of RAPID: quaternions, targets, configurations of the arm, and data of speeds and zones.

Decimals: positions have 4 (0.0001 mm), quaternions 8 (0.000001 deg), joints 5. A `num` of the controller holds about
seven digits.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from zerorev.model._arrays import Array
from zerorev.model.job import Settings
from zerorev.model.robot import Robot
from zerorev.program.letters import fixed
from zerorev.verify.arm import branch_of

__all__ = ["UNIT", "aggregate", "confdata", "external", "joint_target", "pose", "quaternion"]

POSITION_DECIMALS, QUATERNION_DECIMALS, JOINT_DECIMALS = 4, 8, 5
NOT_USED = "9E9"  # of an external axis that the robot does not have
UNIT = "[1,0,0,0]"  # the quaternion of no turn
DECIDED = 0.31415  # of a quaternion's number: greater than this is at least one, and no usual one is just as great
A_LITTLE = 1e-6  # [deg]: the last bits of a whole quadrant must not decide which one is written


def aggregate(values: Iterable[str]) -> str:
    """`[A,B]`."""
    return f"[{','.join(values)}]"


def quaternion(R: Array, near: Array | None = None) -> Array:
    """The unit quaternion w, x, y, z of a rotation, shape (3, 3).

    Args:
        R: a rotation.
        near: of the two quaternions the one nearer to this is meant; None: the one whose first clearly non-zero number
            is positive, so that the last bits do not decide.
    """
    # the squares of its numbers, times 4, and the products of the greatest one with all
    squares = 1 + np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]) @ np.diag(R)
    differences = np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    sums = np.array([R[2, 1] + R[1, 2], R[0, 2] + R[2, 0], R[1, 0] + R[0, 1]])
    products = np.array(
        [
            [squares[0], *differences],
            [differences[0], squares[1], sums[2], sums[1]],
            [differences[1], sums[2], squares[2], sums[0]],
            [differences[2], sums[1], sums[0], squares[3]],
        ]
    )
    q = products[int(np.argmax(squares))]
    q = q / np.linalg.norm(q)
    return np.asarray(q * np.sign(q[np.argmax(np.abs(q) > DECIDED)] if near is None else q @ near))


def pose(T: Array, near: Array | None = None) -> str:
    """`[x,y,z],[q1,q2,q3,q4]` of a frame, shape (4, 4), translation [m]; its quaternion is the one near another."""
    place = aggregate(fixed(x * 1e3, POSITION_DECIMALS) for x in T[:3, 3])
    return f"{place},{aggregate(fixed(q, QUATERNION_DECIMALS) for q in quaternion(T[:3, :3], near))}"


def external(settings: Settings) -> str:
    """Where the six external axes stand: E1 is RAPID's eax_a, and so on."""
    places = {axis.name: fixed(axis.at, POSITION_DECIMALS) for axis in settings.external_axes}
    return aggregate(places.get(f"E{number}", NOT_USED) for number in range(1, 7))


def joint_target(robot: Robot, joints: Array, settings: Settings) -> str:
    """Six joint values [rad] as the controller shows them, turns included, and the external axes."""
    shown = np.rad2deg(robot.shown(joints))
    return f"[{aggregate(fixed(angle, JOINT_DECIMALS) for angle in shown)},{external(settings)}]"


def confdata(robot: Robot, joints: Array) -> str:
    """The quadrants of axes 1, 4 and 6, counted from 0 to 90 deg, and which way round the arm reaches."""
    quadrants = np.floor((np.rad2deg(joints[[0, 3, 5]]) + A_LITTLE) / 90.0)
    joints = np.where(np.abs(joints) < np.deg2rad(A_LITTLE), 0.0, joints)
    return aggregate([*(f"{quadrant:.0f}" for quadrant in quadrants + 0.0), f"{branch_of(robot.arm, joints):d}"])
