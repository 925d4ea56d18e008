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


# --- metrics, once more ---


@dataclass(frozen=True)
class Plain:
    """What a run comes to, by loops over plain numbers."""

    path_mm: float
    max_mm: float
    rms_mm: float
    parts_mm: tuple[float, float]
    offset_mm: float


def between(places: list[float], values: list[float], at: float) -> float:
    """The value at a place, on the straight line between the two samples about it."""
    for k in range(1, len(places)):
        if places[k] >= at and places[k] > places[k - 1]:
            share = (at - places[k - 1]) / (places[k] - places[k - 1])
            return values[k - 1] + share * (values[k] - values[k - 1])
    return values[-1]


def plain_metrics(run: Run, window_mm: float, feed_mm_s: float) -> Plain:
    """Deviation from the mean path of a run along +X whose tips are recorded, and whose command moves exactly."""
    recording, hole = run.recording, run.drilling.hole
    commanded = [1e3 * (x - hole.target[0]) for x in recording.tcp_commanded[:, 0]]
    turn = max(range(len(commanded)), key=lambda k: commanded[k])
    slow = 0.01 * feed_mm_s * (recording.time[1] - recording.time[0])
    moving = [k for k in range(1, len(commanded)) if abs(commanded[k] - commanded[k - 1]) >= slow]
    first, last = moving[0] - 1, moving[-1]
    path = [0.0]
    for k in range(first + 1, last + 1):
        path.append(path[-1] + abs(commanded[k] - commanded[k - 1]))
    zero = path[turn - first]
    path = [each - zero for each in path]
    lateral = [[1e3 * (recording.tcp[k, axis] - hole.target[axis]) for k in range(first, last + 1)] for axis in (1, 2)]
    places = [path[0] + n * (path[-1] - path[0]) / 800 for n in range(801)]
    even = [[between(path, values, place) for place in places] for values in lateral]
    mean = [math.fsum(values) / 801 for values in even]
    inside = [n for n in range(801) if abs(places[n]) <= window_mm]
    apart = [(even[0][n] - mean[0], even[1][n] - mean[1]) for n in inside]
    return Plain(
        path[-1] - path[0],
        max(math.hypot(*each) for each in apart),
        math.sqrt(math.fsum(math.hypot(*each) ** 2 for each in apart) / len(apart)),
        (max(abs(each[0]) for each in apart), max(abs(each[1]) for each in apart)),
        math.hypot(*mean),
    )


def plain_reversals(angles: list[float], swing: float) -> int:
    """Direction changes of a zigzag: far points between which an angle runs by `swing` or more."""
    count, way, far = 0, 0, angles[0]
    for k, angle in enumerate(angles):
        if way == 0:
            low, high = min(angles[: k + 1]), max(angles[: k + 1])
            if angle - low >= swing or high - angle >= swing:
                way, far = (1 if angle - low >= swing else -1), angle
        elif (angle - far) * way >= 0:
            far = angle
        elif (far - angle) * way >= swing:
            count, way, far = count + 1, -way, angle
    return count
