"""Holes that search and proof are measured on: random ones, and hostile ones."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

import zerorev as zr
from zerorev.files.io import robot_names
from zerorev.model._arrays import Array, rotation_rpy, transform
from zerorev.model.robot import Robot
from zerorev.model.tool import Tool
from zerorev.motion import kinematics
from zerorev.motion.drilling import Drilling
from zerorev.search.problem import Problem

__all__ = ["HOSTILE", "hostile_problem", "random_problem"]

NEAR = (0.9, 0.995)  # shares of its deepest stroke that half of the random holes are drilled to
NARROWED = 0.4  # share of its range that each joint of a quarter of them keeps
HOSTILE = ("edge of reach", "joint 5 near 0", "wrist near axis 1", "limits of a few degrees", "0.5 to 300 mm")
SCANNED = 721  # angles of a joint


def random_problem(seed: int) -> Problem:
    """A hole within the reach of any robot that ships, with the thesis' drill or a random tool."""
    rng = np.random.default_rng(seed)
    robot, tool = _robot_and_tool(seed, rng)
    joints = rng.uniform(robot.limits.lower, robot.limits.upper)
    depth = robot.size * float(rng.uniform(0.005, 0.06))
    hole = _hole(f"random {seed}", robot, tool, joints, depth)
    if seed % 4 == 0:
        wide = robot.limits.upper - robot.limits.lower
        lower = np.clip(joints - NARROWED * wide * rng.uniform(0.2, 0.8, 6), robot.limits.lower, None)
        lower = np.minimum(lower, robot.limits.upper - NARROWED * wide)
        robot = replace(robot, limits=replace(robot.limits, lower=lower, upper=lower + NARROWED * wide))
    if seed // 2 % 2:
        deepest = zr.deepest_stroke(robot, tool, hole, zr.Settings()).depth
        hole = replace(hole, depth=deepest * float(rng.uniform(*NEAR)) if deepest > 0 else depth)
    return Problem(Drilling(robot, tool, hole), zr.Settings())


def hostile_problem(seed: int) -> Problem:
    """One of the HOSTILE kinds in turn."""
    rng = np.random.default_rng(seed)
    robot, tool = _robot_and_tool(seed // len(HOSTILE), rng)
    limits, kind = robot.limits, HOSTILE[seed % len(HOSTILE)]
    joints = rng.uniform(limits.lower, limits.upper)
    depth = robot.size * float(rng.uniform(0.005, 0.06))
    near = float(np.deg2rad(rng.uniform(0.2, 5.0)) * rng.choice([-1.0, 1.0]))
    if kind == "edge of reach":
        joints[2] = _greatest(robot, joints, 2, lambda p: float(np.linalg.norm(p - _shoulder(robot, joints)))) + near
    elif kind == "joint 5 near 0":
        joints[4] = near
    elif kind == "wrist near axis 1":
        joints[1] = _greatest(robot, joints, 1, lambda p: -float(np.hypot(p[0], p[1]))) + near
    elif kind == "limits of a few degrees":
        room = np.deg2rad(rng.uniform(1.0, 12.0, (2, 6)))
        lower, upper = np.maximum(joints - room[0], limits.lower), np.minimum(joints + room[1], limits.upper)
        robot = replace(robot, limits=replace(limits, lower=lower, upper=upper))
    else:
        depth = robot.size * float(np.exp(rng.uniform(np.log(0.5e-3), np.log(300e-3))))
    return Problem(Drilling(robot, tool, _hole(f"{kind} {seed}", robot, tool, joints, depth)), zr.Settings())


def _robot_and_tool(number: int, rng: np.random.Generator) -> tuple[Robot, Tool]:
    """The robots in turn, with the thesis' drill or a random tool."""
    names = robot_names()
    robot, tool = zr.read_robot(names[number % len(names)]), zr.read_tool("thesis_drill")
    if rng.integers(2):
        place = robot.size * rng.uniform([-0.2, -0.2, 0.05], [0.2, 0.2, 0.25])
        tool = zr.Tool("random", transform(rotation_rpy(*rng.uniform(-np.pi, np.pi, 3)), place))
    return robot, tool


def _hole(name: str, robot: Robot, tool: Tool, joints: Array, depth: float) -> zr.Hole:
    """The hole that a robot stands at."""
    T = kinematics.forward(robot, joints) @ tool.T_flange_tcp
    return zr.Hole(name, T[:3, 3], -T[:3, 2], depth, psi_zero=T[:3, 1])


def _greatest(robot: Robot, joints: Array, joint: int, score: Callable[[Array], float]) -> float:
    """The angle of a joint within its limits at which a score of the wrist centre is greatest [rad]."""
    angles = np.linspace(robot.limits.lower[joint], robot.limits.upper[joint], SCANNED)
    poses = np.tile(joints, (SCANNED, 1))
    poses[:, joint] = angles
    T = kinematics.forward(robot, poses)
    return float(angles[np.argmax([score(wrist) for wrist in T[:, :3, 3] - robot.arm.c4 * T[:, :3, 2]])])


def _shoulder(robot: Robot, joints: Array) -> Array:
    """Where axis 2 meets the plane of the arm [m]."""
    arm = robot.arm
    theta = arm.sign[0] * joints[0] - arm.offset[0]
    return np.array([arm.a1 * np.cos(theta), arm.a1 * np.sin(theta), arm.c1])
