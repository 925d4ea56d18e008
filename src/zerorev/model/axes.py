"""An arm as six lines in space: what a robot description or a table of link parameters says."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from zerorev.errors import InputError
from zerorev.model._arrays import Array, finite

__all__ = ["Axes"]


@dataclass(frozen=True)
class Axes:
    """The axes of six turning joints, all joints at 0, and the tip that they carry; in the root frame.

    A pose is the product of the joints' turns about these lines, in their order, and of the tip at 0 (the product of
    exponentials: Lynch, Park, Modern Robotics, 2017, section 4.1).

    Attributes:
        name: of the arm.
        joint_names: six names.
        direction: unit vectors about which the joints turn, shape (6, 3).
        point: a point of each axis [m], shape (6, 3).
        T_root_tip: the tip where all joints are at 0, shape (4, 4), translation [m].
        tip: its name.
        T_root_base: the frame from which the controller counts, shape (4, 4).
        lower: the least angles of the joints [rad], shape (6,), NaN where none is stated.
        upper: the greatest ones, alike.
        speed: their greatest speeds [rad/s], alike.
    """

    name: str
    joint_names: tuple[str, str, str, str, str, str]
    direction: Array
    point: Array
    T_root_tip: Array
    tip: str
    T_root_base: Array
    lower: Array
    upper: Array
    speed: Array

    def __post_init__(self) -> None:
        """Check that there are six lines."""
        for name in ("direction", "point"):
            object.__setattr__(self, name, finite(getattr(self, name), (6, 3), f"arm {self.name}, {name}"))
        if not np.allclose(np.linalg.norm(self.direction, axis=1), 1.0, atol=1e-9):
            raise InputError("an axis is not of length 1", where=f"arm {self.name}", accepted="unit vectors")

    def forward(self, joints: Array) -> Array:
        """T_root_tip of joint angles.

        Args:
            joints: [rad], shape (n, 6).

        Returns:
            poses, shape (n, 4, 4), translation [m].
        """
        T = np.broadcast_to(np.eye(4), (len(joints), 4, 4))
        for k, (z, p) in enumerate(zip(self.direction, self.point, strict=True)):
            angle = joints[:, k, None, None]
            K = np.array([[0.0, -z[2], z[1]], [z[2], 0.0, -z[0]], [-z[1], z[0], 0.0]])
            turn = np.zeros((len(joints), 4, 4))
            turn[:, :3, :3] = np.eye(3) + np.sin(angle) * K + (1.0 - np.cos(angle)) * (K @ K)
            turn[:, :3, 3] = p - turn[:, :3, :3] @ p
            turn[:, 3, 3] = 1.0
            T = T @ turn
        return np.asarray(T @ self.T_root_tip)
