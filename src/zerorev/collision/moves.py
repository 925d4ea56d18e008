"""How near the tool comes to the part on moves of all axes at once, each joint in proportion to the others.

On a piece of such a move each joint stays within half of its turn of where it is in the middle, so a point moves from
there by at most the sum over the joints of that half turn times its greatest distance from the axis: one joint changed
after the other from the tip inwards. The distance of a capsule changes by no more than the larger move of its two
ends. So one pose in the middle bounds the whole piece; pieces that may hold the least distance are halved, until it is
known to `EXACT`.

The part is what lies behind the surface at both holes, planes across their drill axes: for a panel that bulges
towards the robot, or is plane, that encloses it; of one that is hollow towards the robot the rim is missing.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from zerorev.collision.shapes import BODIES, Body, Capsules
from zerorev.model._arrays import Array
from zerorev.model.robot import Robot
from zerorev.motion.kinematics import forward

__all__ = ["EXACT", "Nearest", "nearest"]

EXACT = 1e-5  # [m]
ROUNDING = 1e-9  # [m] more than the arithmetic of a pose can be off
AT_ONCE = 500  # moves, so that memory stays bounded
HALVINGS = 30  # of a move, at most


class Nearest(NamedTuple):
    """Where a move comes nearest to the part.

    Attributes:
        clearance: least distance that is met [m], below 0 inside the part; nowhere is it less by more than `EXACT`.
        body: what is nearest there.
    """

    clearance: float
    body: Body


def nearest(
    robot: Robot, capsules: Capsules, moves: Array, planes: Array, thickness: float | None
) -> tuple[Nearest, ...]:
    """The least distance from the part on each of some moves.

    Args:
        robot: the arm.
        capsules: that move with its flange.
        moves: controller angles at the begin and at the end [rad], shape (M, 2, 6).
        planes: the surface at two holes for each move: unit direction into the part, base frame, and its product with
            a point of the surface [m], shape (M, 2, 4).
        thickness: how far the part goes on behind the surface [m]; None: without end.
    """
    found: list[Nearest] = []
    for k in range(0, len(moves), AT_ONCE):
        found += _nearest(robot, capsules, moves[k : k + AT_ONCE], planes[k : k + AT_ONCE], thickness)
    return tuple(found)


def _nearest(robot: Robot, capsules: Capsules, moves: Array, planes: Array, thickness: float | None) -> list[Nearest]:
    turned = np.abs(moves[:, 1] - moves[:, 0])
    sweep = (turned[:, None, None] * capsules.reach).sum(axis=-1).max(axis=-1)  # of each capsule on a whole move
    least, body = np.full(len(moves), np.inf), np.zeros(len(moves), dtype=np.int64)

    def look(move: npt.NDArray[np.int64], share: Array) -> Array:
        """Distances of each capsule at shares of moves, shape (n, 3); the least ones are noted."""
        start, end = moves[move, 0], moves[move, 1]
        distance = _distances(robot, capsules, start + share[:, None] * (end - start), planes[move], thickness)
        order = np.argsort(distance.min(axis=1))[::-1]  # the last one that is written is the least
        move, distance = move[order], distance[order]
        better = distance.min(axis=1) < least[move]
        least[move[better]] = distance[better].min(axis=1)
        body[move[better]] = distance[better].argmin(axis=1)
        return np.asarray(distance[np.argsort(order)])

    every = np.arange(len(moves))
    look(every, np.zeros(len(moves)))
    look(every, np.ones(len(moves)))
    move, middle, half = every, np.full(len(moves), 0.5), 0.5
    for _ in range(HALVINGS):
        bound = (look(move, middle) - half * sweep[move]).min(axis=1) - ROUNDING
        open_ = bound < least[move] - EXACT
        half /= 2
        move = np.repeat(move[open_], 2)
        middle = np.repeat(middle[open_], 2) + np.tile([-half, half], int(open_.sum()))
        if not move.size:
            break
    return [Nearest(float(each), BODIES[which]) for each, which in zip(least, body, strict=True)]


def _distances(robot: Robot, capsules: Capsules, joints: Array, planes: Array, thickness: float | None) -> Array:
    """Distances of the capsules from the part [m], shape (n, 3), at controller angles [rad], shape (n, 6)."""
    T = forward(robot, joints)
    ends = np.einsum("nij,cej->ncei", T[:, :3, :3], capsules.ends) + T[:, None, None, :3, 3]
    behind = np.einsum("npi,ncei->ncep", planes[..., :3], ends) - planes[:, None, None, :, 3]  # capsule, end, plane
    deepest, highest = _depths(behind)
    if thickness is None:
        return np.asarray(-deepest - capsules.radius)
    across = np.where(highest >= thickness / 2, highest - thickness, -thickness / 2)
    return np.asarray(np.where(deepest <= thickness / 2, -deepest, across) - capsules.radius)


def _depths(behind: Array) -> tuple[Array, Array]:
    """Greatest and least depth on lines of which the ends lie so far behind two planes, shape (..., 2, 2): (...) each.

    The depth of a point is the lesser of the two; along a line it is greatest at an end, or where both are equal.
    """
    ends = behind.min(axis=-1)
    first, second = behind[..., 0, :], behind[..., 1, :]
    gap, slope = first[..., 0] - first[..., 1], np.diff(second - first, axis=-1)[..., 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.clip(np.nan_to_num(gap / slope, nan=0.0, posinf=0.0, neginf=0.0), 0.0, 1.0)
    crossing = (first + share[..., None] * (second - first)).min(axis=-1)
    return np.maximum(ends.max(axis=-1), crossing), ends.min(axis=-1)
