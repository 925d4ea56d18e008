"""Random holes of five robots, with random tools, thresholds and limits; a seed gives one hole."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from zerorev.files.io import read_robot, read_tool
from zerorev.model._arrays import rotation_rpy, transform
from zerorev.model.hole import Hole
from zerorev.model.job import Settings
from zerorev.model.robot import Robot
from zerorev.model.tool import Tool
from zerorev.motion import kinematics
from zerorev.motion.drilling import Drilling

__all__ = ["Drilled", "hostile_hole", "random_hole"]

ROBOTS = [  # a seed is to give the same hole, regardless of the robots that are added
    read_robot(name)
    for name in ("abb_irb4600_60_205", "kuka_kr120_r2700_2", "kuka_kr6_r700_2", "staubli_tx2_90l", "yaskawa_gp8")
]
THESIS_DRILL = read_tool("thesis_drill")
NARROWED = 0.4  # share of its range that a joint keeps where limits are narrowed


@dataclass(frozen=True)
class Drilled:
    """A hole with all that drills it."""

    robot: Robot
    tool: Tool
    hole: Hole
    settings: Settings

    @property
    def all(self):
        """Robot, tool, hole, settings."""
        return self.robot, self.tool, self.hole, self.settings

    @property
    def both(self):
        """Robot, tool and hole as one, and the settings."""
        return Drilling(self.robot, self.tool, self.hole, self.settings.limit_margin), self.settings

    def deep(self, depth):
        """The same with another stroke [m]."""
        return replace(self, hole=replace(self.hole, depth=depth))

    def asking(self, **changes):
        """The same with other settings."""
        return replace(self, settings=replace(self.settings, **changes))


def random_hole(seed, *, legs="straight", narrowed=False):
    """A reachable place in any posture of a robot; half of the holes have the motion threshold off.

    Args:
        seed: of it.
        legs: straight or free.
        narrowed: whether each joint keeps only a share of its range, the posture within it.
    """
    rng = np.random.default_rng(seed)
    robot = ROBOTS[seed % len(ROBOTS)]
    size = (robot.arm.c2 + robot.arm.c3) / 0.7
    while True:
        tool = THESIS_DRILL
        if rng.integers(2):
            rotation = rotation_rpy(*rng.uniform(-np.pi, np.pi, 3))
            tool = Tool("random", transform(rotation, size * rng.uniform([-0.2, -0.2, 0.05], [0.2, 0.2, 0.25])))
        limits = robot.limits
        joints = rng.uniform(limits.lower, limits.upper)
        T = kinematics.forward(robot, joints) @ tool.T_flange_tcp
        hole = Hole(f"random {seed}", T[:3, 3], -T[:3, 2], 0.01 * size, psi_zero=T[:3, 1])
        if kinematics.wrist_offset(robot, tool) > 0.02 * size and hole.target[2] > 0:
            break
    if narrowed:
        width = NARROWED * (limits.upper - limits.lower)
        lower = np.clip(joints - width * rng.uniform(0.2, 0.8, 6), limits.lower, limits.upper - width)
        robot = replace(robot, limits=replace(limits, lower=lower, upper=lower + width))
    min_rate = float(np.deg2rad(10.0)) / size * (seed // len(ROBOTS) % 2)
    return Drilled(robot, tool, hole, Settings(min_rate=min_rate, legs=legs))


def hostile_hole(seed):
    """A hole near a singularity of the wrist, of the elbow or of axis 1, or with limits of a few degrees; any depth.

    By turns in this order; every fifth seed has weights of reversals, and half of the holes the motion threshold off.
    """
    rng = np.random.default_rng([1, seed])
    robot = ROBOTS[seed % len(ROBOTS)]
    arm, limits, kind = robot.arm, robot.limits, seed % 4
    size = (arm.c2 + arm.c3) / 0.7
    while True:
        rotation = rotation_rpy(*rng.uniform(-np.pi, np.pi, 3))
        tool = Tool("random", transform(rotation, size * rng.uniform([-0.2, -0.2, 0.05], [0.2, 0.2, 0.25])))
        joints = rng.uniform(limits.lower, limits.upper)
        if kind == 0:
            joints[4] = 0.03 * rng.normal()
        if kind == 1:  # the arm is stretched where the forearm's offset makes good for itself
            stretched = -np.arctan2(arm.a2, arm.c3) + 0.05 * rng.normal()
            joints[2] = np.clip(arm.sign[2] * (stretched + arm.offset[2]), limits.lower[2], limits.upper[2])
        T = kinematics.forward(robot, joints) @ tool.T_flange_tcp
        depth = size * 10.0 ** rng.uniform(np.log10(0.0005), np.log10(0.1))
        hole = Hole(f"hostile {seed}", T[:3, 3], -T[:3, 2], depth, psi_zero=T[:3, 1])
        wrist = T @ np.linalg.inv(tool.T_flange_tcp) @ np.array([0.0, 0.0, -arm.c4, 1.0])
        near = np.hypot(wrist[0], wrist[1]) < 0.12 * size
        if kinematics.wrist_offset(robot, tool) > 0.01 * size and (near or kind != 2):
            break
    if kind == 3:
        width = np.deg2rad(rng.uniform(4, 40, 6))
        lower = np.clip(joints - width * rng.uniform(0.2, 0.8, 6), limits.lower, limits.upper - width)
        robot = replace(robot, limits=replace(limits, lower=lower, upper=lower + width))
    weights = tuple(float(w) for w in rng.choice([0.5, 1.0, 2.0, 3.0], 6)) if seed % 5 == 0 else (1.0,) * 6
    settings = Settings(min_rate=float(np.deg2rad(10.0)) / size * (seed // 4 % 2), reversal_weights=weights)
    return Drilled(robot, tool, hole, settings)


def scaled(drilled, factor):
    """The same hole for a robot and a tool that are greater by a factor: lengths times it, rates divided by it."""
    arm, T, settings = drilled.robot.arm, drilled.tool.T_flange_tcp.copy(), drilled.settings
    T[:3, 3] *= factor
    lengths = dict(zip(arm._fields[:7], (factor * length for length in arm[:7]), strict=True))
    shortfall = None if settings.blend_shortfall is None else settings.blend_shortfall * factor
    return Drilled(
        replace(drilled.robot, arm=arm._replace(**lengths)),
        replace(drilled.tool, T_flange_tcp=T),
        replace(drilled.hole, target=drilled.hole.target * factor, depth=drilled.hole.depth * factor),
        replace(
            settings,
            min_rate=settings.min_rate / factor,
            max_twist=settings.max_twist / factor,
            blend=settings.blend * factor,
            blend_shortfall=shortfall,
            lead_in=settings.lead_in * factor,
            corner_tolerance=settings.corner_tolerance * factor,
            feed_plunge=settings.feed_plunge * factor,
            feed_retract=settings.feed_retract * factor,
        ),
    )
