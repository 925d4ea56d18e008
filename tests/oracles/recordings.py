"""Runs made up with known errors, and their metrics computed again in the plainest way."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from zerorev.model.hole import Hole
from zerorev.model.recording import Recording
from zerorev.motion.drilling import Drilling
from zerorev.motion.kinematics import inverse, tcp_pose

Error = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]


@dataclass(frozen=True)
class Run:
    """A run of a published position.

    Attributes:
        drilling: robot, tool and hole.
        recording: of it.
        begin: index of the sample in which the command begins to move.
        path: path distance of the samples from the turn [m].
        horizontal: lateral error of the samples [m].
        vertical: the same [m].
    """

    drilling: Drilling
    recording: Recording
    begin: int
    path: np.ndarray
    horizontal: np.ndarray
    vertical: np.ndarray


def no_error(path: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return np.zeros_like(path), np.zeros_like(path)


def kick(path: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """An offset, a kick at the turn, and a slow bend [m]."""
    turn = 0.15e-3 * np.exp(-((path / 4e-3) ** 2)) * np.sign(path)
    return 0.08e-3 + turn, -0.02e-3 + 0.06e-3 * np.cos(path / 9e-3)


def along(path_time: np.ndarray, depth: float, feed: float, acceleration: float = 2.0) -> np.ndarray:
    """Distance run [m] at times after the start [s]: two trapezoids with a stop at the turn."""
    ramp = feed / acceleration
    leg = depth / feed + ramp

    def one(t: np.ndarray) -> np.ndarray:
        t = np.clip(t, 0.0, leg)
        up, down = np.minimum(t, ramp), np.maximum(t - (leg - ramp), 0.0)
        return (
            acceleration * up**2 / 2
            + feed * np.clip(t - ramp, 0.0, leg - 2 * ramp)
            + feed * down
            - (acceleration * down**2 / 2)
        )

    return one(path_time) + one(path_time - leg)


def run_of(
    robot, tool, position, *, feed=0.02, interval=0.004, before=75, error: Error = no_error, held=False,
    noise=0.0, torque=True, tips=False, seed=1,
) -> Run:  # fmt: skip
    """A run of a position as published, or with its spin held: joints that put the tip off the axis by `error`."""
    hole: Hole = position.hole
    profile = position.held_spin if held else position.profile
    drilling, depth = Drilling(robot, tool, hole), hole.depth
    count = before + math.ceil((2 * depth / feed + 4 * feed / 2.0 + 0.3) / interval)
    time = np.arange(count) * interval
    run = along(time - time[before], depth, feed)
    path, (standoff, psi) = run - depth, profile.at(run)
    T = tcp_pose(hole, standoff, psi)
    commanded = _joints(robot, tool, T, position.branch)
    across, up = np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0])  # the published positions are drilled along X
    horizontal, vertical = error(path)
    off = T.copy()
    off[:, :3, 3] += horizontal[:, None] * across + vertical[:, None] * up
    chance = np.random.default_rng(seed)
    joints = _joints(robot, tool, off, position.branch) + noise * chance.normal(size=commanded.shape)
    rate = np.gradient(commanded, time, axis=0)
    begun = np.arange(count) >= before
    moment = np.where(begun[:, None], 1.0 + np.tanh(50 * rate), 0.0)
    recording = Recording(
        time, joints, commanded, moment + noise * chance.normal(size=moment.shape) if torque else None,
        off[:, :3, 3] if tips else None, T[:, :3, 3] if tips else None,
        torque_commanded=moment if torque else None, source=f"run of {position.name}",
    )  # fmt: skip
    return Run(drilling, recording, before, path, horizontal, vertical)


def _joints(robot, tool, T, branch):
    return np.unwrap(inverse(robot, T @ np.linalg.inv(tool.T_flange_tcp))[:, branch], axis=0)
