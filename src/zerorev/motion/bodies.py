"""Links and tool as rigid bodies, each in the frame of its joint."""

from __future__ import annotations

import numpy as np

from zerorev.kernels.dynamics import Bodies, about_z, place
from zerorev.model._arrays import Array
from zerorev.model.robot import Robot
from zerorev.model.tool import Tool

__all__ = ["bodies_of"]

# the frames are those of the kernel; a few calls are not worth compiling it for
_place, _about_z = (getattr(function, "py_func", function) for function in (place, about_z))


def bodies_of(robot: Robot, tool: Tool) -> Bodies | None:
    """Links and tool in the frames of the joints; None for a robot of which the masses are not known.

    Args:
        robot: the arm.
        tool: on its flange; one of which the weight is not known weighs nothing.
    """
    dynamics = robot.dynamics
    if dynamics is None:
        return None
    T = np.eye(4)
    mass, com, inertia = np.empty(6), np.empty((6, 3)), np.empty((6, 3, 3))
    arm = robot.arm
    for i, link in enumerate(dynamics.links):
        T = T @ _turned(i, -arm.offset[i], _place(arm, i))
        to_joint = np.linalg.inv(T) @ link.T_base_link
        R = to_joint[:3, :3]
        mass[i], com[i], inertia[i] = link.mass, R @ link.com + to_joint[:3, 3], R @ link.inertia @ R.T
    if (load := tool.load) is not None:
        whole = mass[5] + load.mass
        at = load.com + np.array([0.0, 0.0, arm.c4])
        middle = (mass[5] * com[5] + load.mass * at) / whole
        inertia[5] += load.inertia + sum(m * _of_a_point(p - middle) for m, p in ((mass[5], com[5]), (load.mass, at)))
        mass[5], com[5] = whole, middle
    return Bodies(mass, com, inertia)


def _turned(i: int, angle: float, place: tuple[float, float, float]) -> Array:
    c, s = np.cos(angle), np.sin(angle)
    T = np.eye(4)
    T[:3, :3] = [[c, -s, 0], [s, c, 0], [0, 0, 1]] if _about_z(i) else [[c, 0, s], [0, 1, 0], [-s, 0, c]]
    T[:3, 3] = place
    return T


def _of_a_point(p: Array) -> Array:
    """Inertia of a unit mass at p [m^2], shape (3, 3)."""
    return np.asarray((p @ p) * np.eye(3) - np.outer(p, p))
