"""How near the tool comes to the part on moves of all axes at once, each joint in proportion to the others.

On a piece of such a move each joint stays within half of its turn of where it is in the middle, so a point moves from
there by at most the sum over the joints of that half turn times its greatest distance from the axis: one joint changed
after the other from the tip inwards. The distance of a capsule changes by no more than the larger move of its two
ends. Where a piece is short, its speed in the middle and a bound of its acceleration say more. So one pose in the
middle bounds the whole piece; pieces that may hold the least distance are halved, until it is known to `EXACT`.

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
from zerorev.motion.kinematics import forward, jacobian

Numbers = npt.NDArray[np.int64]

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
    turn = moves[:, 1] - moves[:, 0]
    sweep, bend = _sweep(np.abs(turn), capsules)
    least, body = np.full(len(moves), np.inf), np.zeros(len(moves), dtype=np.int64)

    def look(move: Numbers, share: Array) -> tuple[Array, Array, Array]:
        """Distances at shares of moves, how far the ends are behind the planes, and the joints; the least are noted."""
        joints = moves[move, 0] + share[:, None] * turn[move]
        behind = _behind(robot, capsules, joints, planes[move])
        distance = _distances(capsules, behind, thickness)
        order = np.argsort(distance.min(axis=1))[::-1]  # the last one that is written is the least
        order = order[distance[order].min(axis=1) < least[move[order]]]
        least[move[order]], body[move[order]] = distance[order].min(axis=1), distance[order].argmin(axis=1)
        return distance, behind, joints

    every = np.arange(len(moves))
    look(every, np.zeros(len(moves)))
    look(every, np.ones(len(moves)))
    move, middle, half = every, np.full(len(moves), 0.5), 0.5
    for _ in range(HALVINGS):
        distance, behind, joints = look(move, middle)
        bound = (distance - half * sweep[move]).min(axis=1) - ROUNDING
        open_ = bound < least[move] - EXACT
        move, middle, behind, joints = move[open_], middle[open_], behind[open_], joints[open_]
        rate = _rates(robot, capsules, joints, turn[move], planes[move])
        furthest = behind + half * np.abs(rate) + half**2 / 2 * bend[move][..., None]
        open_ = _before(capsules, furthest, thickness) - ROUNDING < least[move] - EXACT
        half /= 2
        move = np.repeat(move[open_], 2)
        middle = np.repeat(middle[open_], 2) + np.tile([-half, half], int(open_.sum()))
        if not move.size:
            break
    return [Nearest(float(each), BODIES[which]) for each, which in zip(least, body, strict=True)]


def _sweep(turn: Array, capsules: Capsules) -> tuple[Array, Array]:
    """How far each capsule moves on a whole move at most [m], shape (M, 3), and how its ends bend, shape (M, 3, 2).

    A joint that turns by w moves a point at w times its distance from the axis; another one further in turns that
    velocity. So the acceleration is at most the sum over the joints of w times the distance, times w and twice the
    turns of all joints further in.

    Args:
        turn: of the joints [rad], shape (M, 6).
        capsules: that move.
    """
    moved = turn[:, None, None] * capsules.reach
    inwards = np.cumsum(turn, axis=1) - turn
    return moved.sum(axis=-1).max(axis=-1), (moved * (turn + 2 * inwards)[:, None, None]).sum(axis=-1)


def _behind(robot: Robot, capsules: Capsules, joints: Array, planes: Array) -> Array:
    """How far the ends of the capsules are behind the planes [m], shape (n, 3, 2, 2): capsule, end, plane."""
    T = forward(robot, joints)
    ends = np.einsum("nij,cej->ncei", T[:, :3, :3], capsules.ends) + T[:, None, None, :3, 3]
    return np.asarray(np.einsum("npi,ncei->ncep", planes[..., :3], ends) - planes[:, None, None, :, 3])


def _rates(robot: Robot, capsules: Capsules, joints: Array, turn: Array, planes: Array) -> Array:
    """How fast they get there [m per whole move], likewise, where the joints turn by so much [rad], shape (n, 6)."""
    twist = np.einsum("nij,nj->ni", jacobian(robot, capsules.tool, joints), turn)
    R = forward(robot, joints)[:, :3, :3]
    lever = np.einsum("nij,cej->ncei", R, capsules.ends - capsules.tool.T_flange_tcp[:3, 3])
    velocity = twist[:, None, None, :3] + np.cross(twist[:, None, None, 3:], lever)
    return np.asarray(np.einsum("npi,ncei->ncep", planes[..., :3], velocity))


def _before(capsules: Capsules, furthest: Array, thickness: float | None) -> Array:
    """No capsule is nearer to the part than this [m], shape (n,), if its ends are no further behind the planes.

    Where they may be deep in a part of some thickness that says nothing.
    """
    deepest, _ = _depths(furthest)
    bound = (-deepest - capsules.radius).min(axis=1)
    return bound if thickness is None else np.where((deepest <= thickness / 2).all(axis=1), bound, -np.inf)


def _distances(capsules: Capsules, behind: Array, thickness: float | None) -> Array:
    """Distances of the capsules from the part [m], shape (n, 3)."""
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
