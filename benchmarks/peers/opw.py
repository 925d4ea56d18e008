"""py-opw-kinematics: compiled analytic inverse kinematics (Rust), all eight branches of a batch of poses."""

from __future__ import annotations

import numpy as np
import py_opw_kinematics as opw

from zerorev.model._arrays import Array
from zerorev.model.robot import ArmGeometry

__all__ = ["Opw"]


class Opw:
    """One arm, and a batch of poses in the form that the library takes."""

    def __init__(self, arm: ArmGeometry, T: Array) -> None:
        f1, f2, f3, f4, f5, f6 = (sign < 0 for sign in arm.sign)
        self.robot = opw.Robot(
            opw.KinematicModel(*arm[:7], offsets=arm.offset, flip_axes=(f1, f2, f3, f4, f5, f6)), degrees=False
        )
        self.poses = opw.RigidTransform.from_matrix(T)

    def solutions(self) -> Array:
        """Controller angles [rad], shape (N, 8, 6), NaN where there are none; one thread."""
        return np.asarray(self.robot.reach(self.poses).joints)

    def nearest(self) -> Array:
        """The solution nearest to that of the pose before, shape (N, 6); all eight are found on the way."""
        return np.asarray(self.robot.batch_inverse(self.poses))
