"""Are the moves between holes what a plan says of them: where they lead, how long they take, how near they come.

By samples of the moves, so that a fault of the proof of clearance does not certify itself: no sample may be nearer to
the part than the plan says.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from zerorev.model._arrays import Array
from zerorev.model.plan import HolePlan, Plan, Transition
from zerorev.verify.arm import Skeleton, branch_of, skeleton
from zerorev.verify.around import clear_between

__all__ = ["moves_claimed"]

SAMPLES = 200  # of each stretch between two stops
ALONG = 9  # points of each body, its ends among them
RAMP = 0.3  # [s] to the greatest speed, where the robot file states no acceleration
# lengths for an arm of size 1 (`Robot.size`)
OFF_AXIS = 1e-6  # [m] by which a move may end beside the drill axis of its hole
CLEARANCE = 2e-5  # [m]
ROUNDING = 1e-6  # [rad], [s], relative


def moves_claimed(plan: Plan) -> Iterator[str]:
    """One sentence for each thing that is said of a move between holes and is not so.

    Args:
        plan: any, with or without such moves.
    """
    holes = {hole.hole.id: hole for hole in plan.holes}
    for move in plan.transitions:
        name = f"the move from {move.start or 'the home position'} to {move.to or 'the home position'}"
        for wrong in _claimed(plan, holes, move):
            yield f"{name} {wrong}"


def _claimed(plan: Plan, holes: dict[str, HolePlan], move: Transition) -> Iterator[str]:
    ends = [None if end is None else holes.get(end) for end in (move.start, move.to)]
    if any(end is not None and hole is None for end, hole in zip((move.start, move.to), ends, strict=True)):
        yield "names a hole that is not there"
        return
    joints, limits = move.joints, plan.robot.limits
    if ((joints < limits.lower - ROUNDING) | (joints > limits.upper + ROUNDING)).any():
        yield "stops beyond a joint limit"
    for hole, at in zip(ends, (joints[:1], joints[-1:]), strict=True):
        yield from _at_home(plan, at) if hole is None else _on_axis(plan, hole, at)
    time = float(sum(_time(plan, abs(turn)) for turn in np.diff(joints, axis=0)))
    if abs(time - move.time) > ROUNDING * (1 + time):
        yield f"takes {time:.6g} s, the plan says {move.time:.6g} s"
    branches = {branch_of(plan.robot.arm, at) for at, hole in zip((joints[0], joints[-1]), ends, strict=True) if hole}
    if (len(branches) > 1) != move.changes_posture:
        yield f"changes the posture: {len(branches) > 1}, the plan says {move.changes_posture}"
    yield from clear_between(plan.robot, plan.tool, plan.settings, move.around, joints)
    if move.clearance is not None:
        met = _clearance(plan, [hole for hole in ends if hole is not None], joints)
        if met < move.clearance - CLEARANCE * plan.robot.size:
            yield f"comes within {met * 1e3:.6g} mm of the part, the plan says {move.clearance * 1e3:.6g} mm"


def _at_home(plan: Plan, joints: Array) -> Iterator[str]:
    home = plan.settings.home_joints
    if home is None or np.abs(joints - np.array(home)).max() > ROUNDING:
        yield "does not begin or end at the home position"


def _on_axis(plan: Plan, hole_plan: HolePlan, joints: Array) -> Iterator[str]:
    """Outside the stroke, the tip on the drill axis, the drill along it."""
    hole, body = hole_plan.hole, skeleton(plan.robot.arm, joints)
    R = body.R_base_flange[:, :, 0] @ plan.tool.T_flange_tcp[:3, :3]
    tip = body.flange[:, 0] + body.R_base_flange[:, :, 0] @ plan.tool.T_flange_tcp[:3, 3]
    out = (hole.target - tip) @ hole.direction
    beside = float(np.linalg.norm(hole.target - tip - out * hole.direction))
    tolerance = OFF_AXIS * plan.robot.size
    if beside > tolerance or out < hole.depth - tolerance or np.linalg.norm(R[:, 2] + hole.direction) > ROUNDING:
        yield f"does not begin or end on the drill axis of {hole.id}, outside its stroke"


def _time(plan: Plan, turn: Array) -> float:
    """Of the axis that takes longest [s]: it speeds up as long as it may, then slows down."""
    limits = plan.robot.limits
    gain = limits.speed / RAMP if limits.acceleration is None else limits.acceleration
    top = np.minimum(limits.speed, np.sqrt(turn * gain))
    way = turn - top**2 / gain
    return float((2 * top / gain + np.where(way > 0, way / np.maximum(top, 1e-300), 0.0)).max())


def _clearance(plan: Plan, holes: list[HolePlan], joints: Array) -> float:
    """The least distance from the part that a sample has [m]; behind the surface at all of the holes it is inside."""
    share = np.linspace(0.0, 1.0, SAMPLES)[:, None]
    posed = [first + share * (last - first) for first, last in pairwise(joints)]
    body = skeleton(plan.robot.arm, np.asfortranarray(np.concatenate(posed)))
    thickness, least = plan.settings.part_thickness, np.inf
    for points, radius in _bodies(plan, body):
        depth = np.full(points.shape[1:], np.inf)
        for each in holes:
            hole = each.hole
            surface = hole.entry
            depth = np.minimum(depth, np.einsum("i,i...->...", hole.direction, points) - hole.direction @ surface)
        outside = -depth if thickness is None else np.maximum(-depth, depth - thickness)
        least = min(least, float(outside.min()) - radius)
    return least


def _bodies(plan: Plan, body: Skeleton) -> Iterator[tuple[Array, float]]:
    """Points along the drill, the tool and the wrist [m], shape (3, N, points) each, and how thick these are."""
    T = plan.tool.T_flange_tcp
    back = np.einsum("ijn,j->in", body.R_base_flange, T[:3, 2])
    tip = body.flange + np.einsum("ijn,j->in", body.R_base_flange, T[:3, 3])
    foot = tip + np.maximum(((body.flange - tip) * back).sum(axis=0), 0.0) * back
    share = np.linspace(0.0, 1.0, ALONG)
    thick = 0.5 * abs(plan.robot.arm.c4)
    for one, other, radius in ((tip, foot, 0.0), (foot, body.flange, 0.0), (body.flange, body.wrist, thick)):
        yield one[..., None] + share * (other - one)[..., None], radius
