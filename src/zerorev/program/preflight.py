"""What is examined before a program is written: speeds, turns, poses, and what the program tells about itself."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from zerorev.model._arrays import Array
from zerorev.model.corner import Controller
from zerorev.model.finding import Finding
from zerorev.model.plan import HolePlan, Plan
from zerorev.model.robot import Robot
from zerorev.motion.drilling import Drilling
from zerorev.motion.kinematics import forward, tcp_pose
from zerorev.program.joint_speeds import too_fast, turns_fast
from zerorev.program.neutral import HoleProgram, Program
from zerorev.program.notes import notes, pieces, segments, tool_turn
from zerorev.program.waypoints import GREATEST_TURN

__all__ = ["preflight"]

ON_POSE = (1e-5, float(np.deg2rad(0.01)))  # [m], [rad] between a plan's joints and its poses
ROUND_OFF = 1e-9
STRAIGHT_WRIST = float(np.deg2rad(5.0))  # [rad] of joint 5
# below these the decimals of a program no longer tell two points, a feed or a radius from none
SHORTEST_MOVE, SLOWEST_FEED, SMALLEST_BLEND = 1e-6, 1e-6, 1e-7  # [m], [m/s], [m]


def preflight(program: Program, plan: Plan, controller: Controller) -> tuple[Finding, ...]:
    """Look at a program before it is written; an error among the findings stops the export.

    Args:
        program: made from `plan`.
        plan: whose robot, tool and branches the joints are taken from.
        controller: that runs it.
    """
    usual = controller.turn_speed
    plans = {hole.hole.id: hole for hole in plan.holes}
    found = [
        finding
        for hole in program.holes
        for finding in (
            *_joints(plan, plans[hole.id], program, hole),
            *_speeds(plan, plans[hole.id], hole, usual),
            *_turns(hole),
            *_printable(hole),
            *_wrist(plan.robot, hole),
        )
    ]
    return (*found, *notes(program))


def _joints(plan: Plan, hole_plan: HolePlan, program: Program, hole: HoleProgram) -> tuple[Finding, ...]:
    """A plan's joints must be at its poses, and the program's first joints at its first pose and within the limits.

    The axis values go into the program as they stand in the plan: a plan file that was edited by hand, or a robot file
    that is no longer the one it was planned with, must not move the robot.
    """
    motion = hole_plan.motion
    assert motion is not None
    planned = tcp_pose(hole_plan.hole, motion.profile.standoff, motion.profile.psi)
    points = [hole.start, *(move.end for move in hole.moves)]
    poses = [*planned, *(program.T_base_part @ point.T_part_tcp for point in points)]
    joints = np.vstack([motion.joints, *(point.joints for point in points)])
    reached = forward(plan.robot, joints) @ plan.tool.T_flange_tcp
    off = max(float(np.linalg.norm(a[:3, 3] - b[:3, 3])) for a, b in zip(poses, reached, strict=True))
    turned = max(tool_turn(a, b) for a, b in zip(poses, reached, strict=True))
    found = []
    if not (off <= ON_POSE[0] and turned <= ON_POSE[1]):
        message = f"the plan's joints miss its poses by {off * 1e3:.3g} mm and {np.rad2deg(turned):.3g} deg"
        found.append(Finding("error", "joints", message, hole.id))
    margin = plan.settings.limit_margin
    # the home position, on the way, is the user's own
    beyond = _beyond(plan.robot, np.vstack([hole.way, program.end]), 0.0) | _beyond(plan.robot, joints, margin)
    if names := [name for name, bad in zip(plan.robot.joint_names, beyond, strict=True) if bad]:
        nearer = ", or nearer to them than limit_margin_deg" if margin else ""
        found.append(Finding("error", "limit", f"{' '.join(names)} beyond the joint limits{nearer}", hole.id))
    return tuple(found)


def _beyond(robot: Robot, joints: Array, margin: float) -> npt.NDArray[np.bool_]:
    """Which joints leave the limits less a margin [rad] at any of some postures [rad], shape (n, 6); shape (6,)."""
    limits = robot.allowed(margin)
    out = (joints < limits.lower - ROUND_OFF) | (joints > limits.upper + ROUND_OFF)
    return np.asarray(out.any(axis=0))


def _speeds(plan: Plan, hole_plan: HolePlan, hole: HoleProgram, usual: float) -> tuple[Finding, ...]:
    """Joint speeds at the job's feeds, and how fast they turn the tool."""
    assert hole_plan.motion is not None
    drilling, own = Drilling.of(plan, hole_plan.hole), pieces(hole)
    return (*too_fast(drilling, hole_plan.motion.branch, own), *turns_fast(hole.id, own, usual))


def _turns(hole: HoleProgram) -> tuple[Finding, ...]:
    """No move may turn the tool further than the short way round is certain, and each turns as its spin says."""
    found = []
    pose = hole.start.T_part_tcp
    for number, (_, psi, move) in enumerate(segments(hole), start=1):
        turn, by_pose = abs(move.psi - psi), tool_turn(pose, move.end.T_part_tcp)
        if turn > GREATEST_TURN + ROUND_OFF or abs(turn - by_pose) > 1e-6:
            message = f"linear move {number} turns the tool by {np.rad2deg(turn):.2f} deg, its poses differ by "
            message += f"{np.rad2deg(by_pose):.2f} deg; at most {np.rad2deg(GREATEST_TURN):g} deg are allowed"
            found.append(Finding("error", "move_turn", message, hole.id))
        pose = move.end.T_part_tcp
    return tuple(found)


def _wrist(robot: Robot, hole: HoleProgram) -> tuple[Finding, ...]:
    """Points with axes 4 and 6 nearly in line, where a controller slows a straight move down, or stops."""
    bend = robot.bend(np.array([hole.start.joints, *(move.end.joints for move in hole.moves)]))
    bend = np.arcsin(np.sin(bend))
    least = 0.0 if (bend > 0).any() and (bend < 0).any() else float(np.abs(bend).min())
    if least >= STRAIGHT_WRIST:
        return ()
    message = (
        f"{robot.joint_names[4]} comes within {np.rad2deg(least):.2g} deg of a straight wrist, where a controller may "
        "slow a straight move down, or stop with an alarm: another posture, or the part elsewhere"
    )
    return (Finding("warning", "controller", message, hole.id),)


def _printable(hole: HoleProgram) -> tuple[Finding, ...]:
    """What is so small that a program with its few decimals could not hold it, one error a kind."""
    shortest = min(abs(move.standoff - standoff) for standoff, _, move in segments(hole))
    slowest = min(move.feed for move in hole.moves)
    smallest = min((move.blend for move in hole.moves if move.blend > 0), default=np.inf)
    return tuple(
        Finding("error", "printable", f"{what} of {size * 1e3:.3g} {unit} is too small for a program", hole.id)
        for what, size, least, unit in (
            ("a linear move", shortest, SHORTEST_MOVE, "mm"),
            ("a feed", slowest, SLOWEST_FEED, "mm/s"),
            ("a blend", smallest, SMALLEST_BLEND, "mm"),
        )
        if size < least
    )
