"""Whether the digits of a program turn a joint round that all but rests: from its own text, read back.

A point is printed with so many digits, and a joint that hardly moves from one point to the next may move the other way
between the printed ones. Each language has digits of its own, so the printed points decide, and not a rule.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from zerorev.model._arrays import Array
from zerorev.model.finding import Finding
from zerorev.model.plan import HolePlan, Plan, named_holes
from zerorev.model.robot import Robot
from zerorev.model.tool import Tool
from zerorev.model.written import WrittenHole, WrittenProgram
from zerorev.motion.joint_path import direction_changes
from zerorev.motion.kinematics import inverse
from zerorev.verify.as_planned import Places, places
from zerorev.verify.printed import angle_slack, joints_of, length_slack

__all__ = ["directions", "listed_joints", "straight", "turned_by_digits"]

SAMPLES = 33  # places of a straight move at which it is asked which way each joint moves
NEXT = 1e-3  # share of the move between the two points that tell
STILL = 1e-12  # [rad] between two points: less is the round-off of the inverse
FULL_TURN = 2 * np.pi
AMPLE = 10.0  # times what the digits leave open: a joint that moves by more on each move is not turned round by them
AT_REST = float(np.deg2rad(5e-6))  # [rad/m] 5e-9 deg/mm: half of what the slowest joint of any plan keeps
LEVER = 0.1  # [m] at which a displacement of the tip turns a joint


class _Point(NamedTuple):
    T: Array  # pose of the tcp frame in the base, shape (4, 4)
    joints: Array  # [rad], shape (6,)
    linear: bool  # whether the move to it is straight


def turned_by_digits(plan: Plan, ids: Sequence[str], written: WrittenProgram) -> tuple[Finding, ...]:
    """The finding of joints that the printed numbers turn round where the plan does not; none where they do not.

    Args:
        plan: from which the program was written, stroke by stroke.
        ids: of the holes of the program, in its order.
        written: the program, read back.
    """
    answers, turned = {hole.hole.id: hole for hole in plan.holes}, []
    for hole_id, own in zip(ids, written.holes, strict=True):
        hole = answers[hole_id]
        assert hole.score is not None
        if _in_doubt(plan.robot, hole, own):
            turned.append((_turned_round(plan, hole, written, own), hole_id))
    return tuple(
        listed_joints(
            plan.robot.joint_names,
            turned,
            "in the digits of this program {which} would turn back or stand where the plan does not, since a joint all "
            "but rests there, and it cannot be certified: plan with a motion threshold (min_rate_deg_per_mm: 0.01)",
        )
    )


def _in_doubt(robot: Robot, hole: HolePlan, own: WrittenHole) -> bool:
    """Whether the slowest joint moves so little that the digits might turn it round."""
    assert hole.score is not None
    assert hole.motion is not None
    ends = [move.end for move in own.moves]
    open_ = max(angle_slack(robot, end) + length_slack(robot, end) / LEVER for end in ends)
    steady = np.array(hole.score.reversals_per_joint) == 0
    slowest = float(hole.score.min_rate[steady].min(initial=np.inf))
    reach = hole.corner.reach if hole.corner and hole.corner.reach else np.inf
    shortest = min(reach, float(np.abs(np.diff(hole.motion.profile.standoff)).min()))
    return slowest * shortest < AMPLE * open_


def _turned_round(plan: Plan, hole: HolePlan, written: WrittenProgram, own: WrittenHole) -> npt.NDArray[np.bool_]:
    """Which joints turn round or rest on the printed points from lead-in to end of stroke, and not as planned: (6,)."""
    assert hole.score is not None
    at = places(plan, hole, written, own)
    points = _points(plan, hole, own, at)[at.first : at.last + 1]
    slowest = np.full(6, np.inf)
    way = np.sign(points[-1].joints - points[0].joints)
    for n, (before, after) in enumerate(pairwise(points), start=at.first):
        length = abs(float(at.standoff[n + 1] - at.standoff[n]))
        if after.linear:
            path = straight(plan.robot, plan.tool, (before.T, after.T), (before.joints, after.joints))
            rates = np.diff(path, axis=0)[::2] / (NEXT * length)
            rates = np.vstack([_beyond(rates[:3]), rates, _beyond(rates[:-4:-1])])
        else:
            rates = (after.joints - before.joints)[None] / length
        slowest = np.minimum(slowest, _least(way * rates))
    planned = np.array(hole.score.reversals_per_joint) == 0
    return np.asarray(planned & (hole.score.min_rate > AT_REST) & (slowest < AT_REST))


def _beyond(rates: Array) -> Array:
    """The rate at the very end of a move, half a step of `NEXT` beyond the first of three, by the parabola: (6,)."""
    share = 0.5 * NEXT * (SAMPLES - 1) / (1 - NEXT)
    first, second, third = rates
    curved = 0.5 * share * (share + 1) * (third - 2 * second + first)
    return np.asarray(first - share * (second - first) + curved)


def _least(rates: Array) -> Array:
    """The least of evenly spaced rates, shape (n, 6), between them by the parabola through three; shape (6,)."""
    least = np.asarray(rates.min(axis=0))
    if len(rates) < 3:
        return least
    before, here, after = rates[:-2], rates[1:-1], rates[2:]
    bend = before - 2 * here + after
    dips = (here <= before) & (here <= after) & (bend > 0)
    lower = here - (before - after) ** 2 / np.where(dips, 8 * bend, np.inf)
    return np.asarray(np.minimum(least, np.where(dips, lower, np.inf).min(axis=0)))


def _points(plan: Plan, hole: HolePlan, own: WrittenHole, at: Places) -> list[_Point]:
    """The points of a hole's moves, with joints that follow one another on the branch of the plan."""
    assert hole.motion is not None
    flange = at.T_base_tcp @ np.linalg.inv(plan.tool.T_flange_tcp)
    found = inverse(plan.robot, flange)[:, hole.motion.branch]
    here = joints_of(plan.robot, own.start)
    points = []
    for n, T in enumerate(at.T_base_tcp):
        # no move turns a joint by half a turn without passing the samples of `straight`
        here = found[n] + FULL_TURN * np.round((here - found[n]) / FULL_TURN)
        points.append(_Point(T, here, n == 0 or own.moves[n - 1].linear))
    return points


def straight(robot: Robot, tool: Tool, T: tuple[Array, Array], ends: tuple[Array, Array]) -> Array:
    """Joints along a straight move [rad], shape (n, 6): the tool turns evenly about one axis.

    Args:
        robot: the arm.
        tool: on its flange.
        T: poses of the tcp frame in the base where the move begins and ends, shape (4, 4) each.
        ends: joints there [rad], shape (6,) each.
    """
    first, last = T
    share = (np.linspace(0.0, 1.0 - NEXT, SAMPLES)[:, None] + [0.0, NEXT]).ravel()
    poses = np.broadcast_to(np.eye(4), (share.size, 4, 4)).copy()
    poses[:, :3, :3] = _turned(first[:3, :3], last[:3, :3], share)
    poses[:, :3, 3] = first[:3, 3] + share[:, None] * (last[:3, 3] - first[:3, 3])
    near = ends[0] + share[:, None] * (ends[1] - ends[0])
    found = inverse(robot, poses @ np.linalg.inv(tool.T_flange_tcp))
    found += FULL_TURN * np.round((near[:, None] - found) / FULL_TURN)
    apart = np.nan_to_num(np.abs(found - near[:, None]).sum(axis=-1), nan=np.inf)
    branch = int(np.argmin(apart[0] + apart[-1]))
    return np.asarray(found[:, branch])


def _turned(first: Array, last: Array, share: Array) -> Array:
    """Rotations that lead evenly about one axis from one to another, shape (n, 3, 3) (Rodrigues)."""
    R = last @ first.T
    double = np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    sine = float(np.linalg.norm(double))
    if sine == 0:
        return np.broadcast_to(first, (len(share), 3, 3))
    x, y, z = double / sine
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    angle = share[:, None, None] * np.arctan2(sine, np.trace(R) - 1)
    return np.asarray((np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K) @ first)


def directions(paths: Sequence[tuple[Array, bool]]) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.bool_]]:
    """Reversals of each joint along paths one after the other, and which joints stand on a joint move; shape (6,).

    Args:
        paths: joints along each move [rad], shape (n, 6), and whether it is straight.
    """
    steps = np.vstack([np.diff(path, axis=0) for path, _ in paths])
    still = np.array([(np.diff(path, axis=0) == 0).any(axis=0) for path, linear in paths if not linear])
    standing = still.any(axis=0) & (np.abs(steps) > STILL).any(axis=0) if len(still) else np.zeros(6, dtype=bool)
    return direction_changes(steps, STILL), np.asarray(standing)


def listed_joints(
    names: Sequence[str], joints: Sequence[tuple[npt.NDArray[np.bool_], str]], message: str
) -> Iterator[Finding]:
    """One warning of the joints and the holes of which something is so, where it is of any.

    Args:
        names: of the joints.
        joints: which of them it is so of, shape (6,), and the hole's id; for each hole.
        message: with `{which}` where the names of the joints stand.
    """
    holes = [hole_id for which, hole_id in joints if which.any()]
    if holes:
        of_any = np.any([which for which, _ in joints], axis=0)
        which = " ".join(name for name, is_so in zip(names, of_any, strict=True) if is_so)
        at = "" if len(holes) == 1 else f" (at {len(holes):,} holes: {named_holes(holes)})"
        hole_id = holes[0] if len(holes) == 1 else None
        yield Finding("warning", "controller", message.format(which=which) + at, hole_id)
