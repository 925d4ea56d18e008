"""Sweeps: each joint alone, there and back at several even speeds, from which friction and tool mass are identified.

A speed on a controller is a whole percentage of the greatest one. What is slower than one percent is reached by the
override, which the program only ever lowers: a person who has turned it down is not overruled.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from zerorev.errors import InputError
from zerorev.model._arrays import Array
from zerorev.model.plan import Motion
from zerorev.motion.drilling import Drilling
from zerorev.motion.kinematics import forward

__all__ = ["AMPLITUDE", "SPEEDS", "Sweep", "Sweeps", "sweeps_of"]

AMPLITUDE = float(np.deg2rad(8.0))
SPEEDS = (0.5, 0.25, 0.12, 0.06, 0.03)  # [rad/s]
LEAST_TIME = 2.0  # [s] of even motion at each speed
FINE = 33  # postures of a sweep at which the tip is followed


@dataclass(frozen=True)
class Sweep:
    """One joint at one speed.

    Attributes:
        joint: 0..5.
        percent: of the joint's greatest speed, 1..100.
        override: [%], 1..100, by which that is reduced further.
        cycles: how often it goes there and back.
        speed: what comes of it [rad/s].
    """

    joint: int
    percent: int
    override: int
    cycles: int
    speed: float


@dataclass(frozen=True)
class Sweeps:
    """All sweeps about one posture.

    Attributes:
        drilling: robot, tool and the hole at which they begin.
        posture: controller angles at the middle of each sweep [rad], shape (6,).
        sweeps: the override never rises from one to the next.
        box: least and greatest place of the tip on the way [m], base frame, shape (2, 3).
    """

    drilling: Drilling
    posture: Array
    sweeps: tuple[Sweep, ...]
    box: Array


def sweeps_of(drilling: Drilling, motion: Motion) -> Sweeps:
    """The sweeps about the posture in which a motion begins.

    Args:
        drilling: robot, tool and hole.
        motion: as planned.

    Raises:
        InputError: a joint is nearer to its limit than a sweep goes.
    """
    robot, posture = drilling.robot, np.asarray(motion.joints[0], dtype=float)
    room = np.minimum(posture - robot.limits.lower, robot.limits.upper - posture)
    if (room < AMPLITUDE).any():
        joint = int(np.argmin(room))
        raise InputError(
            f"{robot.joint_names[joint]} is {np.degrees(room[joint]):.1f} deg from its limit where the motion begins, "
            f"and a sweep goes {np.degrees(AMPLITUDE):.0f} deg to either side",
            where=f"hole {drilling.hole.id}",
            accepted="another hole of the plan, or one on another branch",
        )
    found = [_sweep(joint, speed, robot.limits.speed[joint]) for speed in SPEEDS for joint in range(6)]
    found.sort(key=lambda sweep: -sweep.override)
    return Sweeps(drilling, posture, tuple(found), _box(drilling, posture))


def _sweep(joint: int, speed: float, greatest: float) -> Sweep:
    share = min(100 * speed / greatest, 100.0)
    percent = max(round(share), 1)
    override = 100 if share >= 1 else max(round(100 * share), 1)
    real = greatest * percent * override / 1e4
    cycles = max(1, int(np.ceil(LEAST_TIME * real / (4 * AMPLITUDE))))
    return Sweep(joint, percent, override, cycles, float(real))


def _box(drilling: Drilling, posture: Array) -> Array:
    postures = np.repeat(posture[None], 6 * FINE, axis=0)
    for joint in range(6):
        postures[joint * FINE : (joint + 1) * FINE, joint] += np.linspace(-AMPLITUDE, AMPLITUDE, FINE)
    tips = (forward(drilling.robot, postures) @ drilling.tool.T_flange_tcp)[:, :3, 3]
    return np.stack([tips.min(axis=0), tips.max(axis=0)])
