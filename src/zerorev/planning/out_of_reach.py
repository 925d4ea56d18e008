"""By how much a hole is out of reach, and which way to move it: from how far the wrist centre is from the shoulder."""

from __future__ import annotations

import numpy as np

from zerorev.model._arrays import Array
from zerorev.motion.drilling import Drilling
from zerorev.motion.kinematics import tcp_pose, wrist_in_tcp

__all__ = ["shift_into_reach"]

SPINS = 360  # that are tried
STEPS = 12  # as the shoulder turns with the wrist, the way is found in steps
MARGIN = 1e-3  # of the reach: beyond the edge, so that the stroke is not drilled with a stretched arm


def shift_into_reach(drilling: Drilling) -> Array | None:
    """A short way [m] to move a hole, base frame, shape (3,), after which the arm reaches its whole stroke.

    Joint limits are not counted. None where the arm reaches both ends already: then something else is wrong.

    Args:
        drilling: robot, tool and hole.
    """
    wrists = _wrists(drilling)
    ways = np.zeros((SPINS, 3))
    for _ in range(STEPS):
        step = _steps(drilling, wrists + ways[:, None])
        ways += step
        if not step.any():
            break
    length = np.linalg.norm(ways, axis=1)
    open_still = np.abs(_steps(drilling, wrists + ways[:, None])).max(axis=1) > 0
    best = int(np.argmin(np.where(open_still, np.inf, length)))
    return None if open_still[best] or length[best] == 0 else ways[best]


def _wrists(drilling: Drilling) -> Array:
    """The wrist centre at both ends of the stroke, by spins, shape (SPINS, 2, 3)."""
    psi = np.linspace(0, 2 * np.pi, SPINS, endpoint=False)
    T = tcp_pose(drilling.hole, np.array([0.0, drilling.hole.depth]), psi[:, None])
    return np.asarray(T[..., :3, :3] @ wrist_in_tcp(drilling.robot, drilling.tool) + T[..., :3, 3])


def _steps(drilling: Drilling, wrists: Array) -> Array:
    """For each spin the way by which the farther end comes to the edge of the reach, shape (SPINS, 3); 0 within it."""
    arm, reach = drilling.robot.arm, drilling.robot.reach
    least, margin = abs(arm.c2 - np.hypot(arm.a2, arm.c3)), MARGIN * reach
    radius = np.hypot(wrists[..., 0], wrists[..., 1])
    ahead = np.where(radius > 1e-9, 1.0, 0.0)[..., None] * wrists[..., :2] / np.maximum(radius, 1e-9)[..., None]
    shoulder = np.concatenate([arm.a1 * ahead, np.full((*radius.shape, 1), arm.c1)], axis=-1)
    between = shoulder - wrists
    # the forearm runs beside the plane of axis 1 by b, which leaves less of its length in the plane
    far = np.hypot(np.hypot(between[..., 0], between[..., 1]), between[..., 2])  # of any depth, without an overflow
    apart = np.sqrt(np.maximum(far - arm.b, 0.0)) * np.sqrt(np.maximum(far + arm.b, 0.0))
    beyond = np.where(apart > reach, apart - reach + margin, 0.0) - np.where(apart < least, least - apart + margin, 0.0)
    worst = np.abs(beyond).argmax(axis=1)[:, None]
    amount = np.take_along_axis(beyond, worst, axis=1)
    way = np.take_along_axis(between / np.maximum(far, 1e-9)[..., None], worst[..., None], axis=1)[:, 0]
    return np.asarray(amount * way)
