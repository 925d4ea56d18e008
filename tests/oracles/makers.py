"""Plans for robots of other makers: the thesis' positions scaled to a robot's reach, a panel, a hole of free legs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from zerorev.files.io import read_robot, read_tool
from zerorev.model.hole import Hole
from zerorev.model.job import Job, Settings
from zerorev.model.plan import Plan
from zerorev.model.robot import Robot
from zerorev.planning.job import plan_job

__all__ = ["POSITIONS", "free_leg_plan", "panel_plan", "position_plan", "stand_in"]

POSITIONS = {1: ((500, 300, 800), 50), 2: ((200, 400, 600), 20), 3: ((200, 200, 1000), 30)}  # target, stroke [mm]


def stand_in(maker: str) -> Robot:
    """The thesis' robot as if it were made by another maker."""
    return replace(read_robot("kuka_kr6_r700_2"), name="stand_in", manufacturer=maker, model="stand-in")


def position_plan(robot: Robot, number: int, *, nearer: float = 1.0, **settings: object) -> Plan:
    """One of the thesis' positions, its target scaled to the reach of a robot, planned.

    Args:
        robot: any.
        number: 1, 2 or 3.
        nearer: by which the target's distances are multiplied besides: the drill does not grow with the arm.
        settings: by their names; without a motion threshold and a proof if nothing else is said.
    """
    target, depth = POSITIONS[number]
    scale = nearer * robot.reach / read_robot("kuka_kr6_r700_2").reach
    hole = Hole(f"position {number}", np.array(target) * 1e-3 * scale, np.array([1.0, 0, 0]), depth * 1e-3, _Y)
    return _planned(robot, (hole,), f"position_{number}", **settings)


def panel_plan(robot: Robot, count: int = 60, *, nearer: float = 1.0, **settings: object) -> Plan:
    """So many holes in rows of ten, 25 mm apart, on an upright panel before a robot, planned."""
    scale = nearer * robot.reach / read_robot("kuka_kr6_r700_2").reach
    first = np.array([0.48, -0.1, 0.75]) * scale
    holes = tuple(
        Hole(f"R{n // 10}C{n % 10}", first + 25e-3 * np.array([0, n % 10, n // 10]), np.array([1.0, 0, 0]), 8e-3, _Y)
        for n in range(count)
    )
    return _planned(robot, holes, "panel", **settings)


def free_leg_plan(robot: Robot, **settings: object) -> Plan:
    """Position 2 with free legs."""
    return replace(position_plan(robot, 2, legs="free", **settings), name="free_leg")


_Y = np.array([0.0, 1.0, 0.0])
_KNOWN: dict[object, Plan] = {}


def _planned(robot: Robot, holes: tuple[Hole, ...], name: str, **settings: object) -> Plan:
    chosen = Settings(**({"min_rate": 0.0, "proof_boxes": 0} | settings))
    key = (repr(robot), name, len(holes), *holes[0].target, repr(chosen))
    if key not in _KNOWN:
        _KNOWN[key] = plan_job(Job(robot, read_tool("thesis_drill"), holes, chosen, name=name))
    return _KNOWN[key]
