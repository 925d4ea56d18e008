"""The joints of the arm as a chain, and where its links are at given joints.

Link frames: frame i lies on the axis of joint i and turns with it; with the arm straight up (model angles 0) all are
parallel to the base frame. Frame 6 is the flange.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from zerorev.model._arrays import Array
from zerorev.model.robot import Robot

__all__ = ["ORIGIN", "Joint", "Place", "chain", "link_frames"]

Place = tuple[float, float, float]
ORIGIN: Place = (0.0, 0.0, 0.0)


class Joint(NamedTuple):
    """One joint of the chain: frame i in frame i - 1 is `place`, then a turn about `axis`.

    Attributes:
        place: origin of the frame in the frame before [m].
        axis: 1 (y) or 2 (z).
        sign: model angle = sign * controller angle - offset.
        offset: [rad].
    """

    place: Place
    axis: int
    sign: float
    offset: float


def chain(robot: Robot) -> tuple[Joint, ...]:
    """The six joints; after the last one the flange (Brandstoetter et al. 2014, fig. 1)."""
    arm = robot.arm
    places = (
        ORIGIN, (arm.a1, arm.b, arm.c1), (0.0, 0.0, arm.c2), (arm.a2, 0.0, arm.c3), ORIGIN, (0.0, 0.0, arm.c4),
    )  # fmt: skip
    return tuple(
        Joint(place, axis, sign, offset)
        for place, axis, sign, offset in zip(places, (2, 1, 1, 2, 1, 2), arm.sign, arm.offset, strict=True)
    )


def link_frames(robot: Robot, joints: npt.ArrayLike) -> Array:
    """T_base_link of the six links, shape (..., 6, 4, 4), at controller angles [rad], shape (..., 6)."""
    joints = np.asarray(joints, dtype=float)
    T = np.broadcast_to(np.eye(4), (*joints.shape[:-1], 4, 4))
    frames = []
    for i, joint in enumerate(chain(robot)):
        q = joint.sign * joints[..., i] - joint.offset
        c, s = np.cos(q), np.sin(q)
        step = np.zeros_like(T)
        one, two = (0, 1) if joint.axis == 2 else (2, 0)
        step[..., one, one], step[..., one, two] = c, -s
        step[..., two, one], step[..., two, two] = s, c
        step[..., joint.axis, joint.axis] = step[..., 3, 3] = 1.0
        step[..., :3, 3] = joint.place
        T = T @ step
        frames.append(T)
    return np.stack(frames, axis=-3)
