"""The corner as two joint moves: the last of the plunge and the first of the retract, blended where they meet.

Along the drill axis the tip goes straight back at the corner, which not every controller blends. In the joints the two
moves meet below 90 deg, since no joint changes its direction there. Their ends lie on the motion; between these the tip
leaves the drill axis a little, and the tool tilts: as the square of their reach (theory §5.2).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from zerorev.model._arrays import Array
from zerorev.model.plan import Motion
from zerorev.motion.drilling import Drilling
from zerorev.motion.joint_path import FULL_TURN, joints_along
from zerorev.motion.kinematics import forward

__all__ = ["REACH", "JointCorner", "joint_corner", "off_axis_and_tilt"]

# lengths for an arm of size 1 (`Robot.size`)
REACH = 1e-3  # [m] the most, where nothing else is asked
STEP = 1e-6  # [m] down to a multiple of which a reach is made smaller, so that the last bits are not written
SHORTEST = 1e-5  # [m] on a shorter one the last printed digits decide how the joints go
ROUNDS = 8  # of making it smaller; one is the rule, more where the error does not go as the square yet
ROOM = 0.98  # share of a tolerance that is aimed at, since the error goes but nearly as the square
PARTS = 24  # of a side of the triangle of joint vectors; even, so that the middle of each side is examined


@dataclass(frozen=True)
class JointCorner:
    """Two joint moves in place of the corner of a motion.

    `off_axis` and `tilt` hold for every blend of the two moves: what a controller makes of them lies between their
    three ends, so they are the greatest of the whole triangle that these span in the space of the joints, not of its
    two sides alone. They are sampled; `verify.certificate.joint_corner` bounds them.

    Attributes:
        reach: stand-off above the corner at which the joint moves begin and end [m].
        off_axis: greatest distance of the tip from the drill axis [m].
        tilt: greatest angle of the tool against the drill axis [rad].
        joints: controller angles with turns at entry, corner and exit [rad], shape (3, 6); where the tool spins on
            before the corner, where each of its moves begins, too: shape (n, 6).
    """

    reach: float
    off_axis: float
    tilt: float
    joints: Array


def joint_corner(
    drilling: Drilling, motion: Motion, reach: float | None, tolerance: float, tilt: float, spin: int = 0
) -> JointCorner | None:
    """The corner of a motion as two joint moves, as long as asked for, or as long as the tolerances allow.

    Args:
        drilling: robot, tool and hole.
        motion: whose corner; the two segments of its profile that meet there are replaced up to the reach.
        reach: the most [m]; None: 1 mm for an arm of size 1. More than half of the shorter segment is never taken.
        tolerance: greatest distance of the tip from the drill axis [m], above 0.
        tilt: greatest angle of the tool against the drill axis [rad], above 0.
        spin: on how many moves the tool spins on, just before the corner.

    Returns:
        the joint moves, or None where even the shortest ones that can be printed exceed a tolerance, or where the
        motion cannot be followed.
    """
    size, profile = drilling.robot.size, motion.profile
    begin = profile.corner - spin
    around = np.abs(np.diff(profile.standoff))[[begin - 1, profile.corner]]
    longest, reach = float(around.min() / 2), REACH * size if reach is None else reach
    if reach > longest:
        reach = _rounded(longest, size)
    for _ in range(ROUNDS):
        if reach < SHORTEST * size:
            break
        joints = _ends(drilling, motion, reach, spin)
        if np.isnan(joints).any():
            break
        each = [off_axis_and_tilt(drilling, joints[k : k + 3]) for k in range(spin + 1)]
        off_axis, tilted = (max(values) for values in zip(*each, strict=True))
        excess = max(off_axis / tolerance, tilted / tilt)
        if excess <= 1:
            return JointCorner(reach, off_axis, tilted, joints)
        reach = _rounded(reach * np.sqrt(ROOM / excess), size)
    return None


def _rounded(reach: float, size: float) -> float:
    """A reach [m] down to a whole number of steps."""
    return float(np.floor(reach / (STEP * size)) * STEP * size)


def _ends(drilling: Drilling, motion: Motion, reach: float, spin: int) -> Array:
    """Joints with turns at entry, corner and exit [rad], of the spin too; at breakpoints they are the motion's."""
    profile, corner = motion.profile, motion.profile.corner
    ends = []
    for at, segment in ((corner - spin, corner - spin - 1), (corner, corner)):
        way = np.array([0.0, reach])
        standoff, psi = profile.standoff[at] + way, profile.psi[at] + profile.twist_rate[segment] * way
        start, end = joints_along(drilling, motion.branch, standoff, psi)
        ends.append(end + FULL_TURN * np.round((motion.joints[at] - start) / FULL_TURN))
    return np.array([ends[0], *motion.joints[corner - spin : corner + 1], ends[1]])


def off_axis_and_tilt(drilling: Drilling, joints: Array) -> tuple[float, float]:
    """Greatest distance from the drill axis [m] and tilt [rad] on the triangle of three joint vectors.

    Args:
        drilling: robot, tool and hole.
        joints: controller angles [rad], shape (3, 6).
    """
    hole = drilling.hole
    T = forward(drilling.robot, _shares() @ joints) @ drilling.tool.T_flange_tcp
    off_axis = np.linalg.norm(np.cross(T[:, :3, 3] - hole.target, hole.direction), axis=1)
    # |z + d| = 2 sin(tilt / 2): exact for small angles, where an arccos is not
    half_sine = np.minimum(np.linalg.norm(T[:, :3, 2] + hole.direction, axis=1) / 2, 1.0)
    return float(off_axis.max()), float(2 * np.arcsin(half_sine.max()))


def _shares() -> Array:
    """Shares of three corners that are spread evenly over their triangle, its sides and corners among them, (M, 3)."""
    first, second = np.nonzero(np.add.outer(np.arange(PARTS + 1), np.arange(PARTS + 1)) <= PARTS)
    return np.stack([first, PARTS - first - second, second], axis=1) / PARTS
