"""A hole drilled by a tool on a robot: its twist plane, made once, and the two rate fields of that (theory §1)."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Protocol

import numpy as np
import numpy.typing as npt

from zerorev.kernels.arm import angles_along, flip_sign
from zerorev.kernels.dynamics import Bodies
from zerorev.kernels.field import rates
from zerorev.kernels.layout import TwistPlane
from zerorev.model._arrays import Array
from zerorev.model.hole import Hole
from zerorev.model.resized import resized
from zerorev.model.robot import JointLimits, Robot
from zerorev.model.settings import Settings
from zerorev.model.tool import Tool
from zerorev.motion.bodies import bodies_of
from zerorev.motion.kinematics import inverse, tcp_pose, wrist_in_tcp, wrist_offset

__all__ = ["Drilling", "joint_rates"]


class Wanted(Protocol):
    """A job, a plan or the question of a map: who drills, and how."""

    @property
    def robot(self) -> Robot:
        """The arm."""
        ...

    @property
    def tool(self) -> Tool:
        """The drill."""
        ...

    @property
    def settings(self) -> Settings:
        """How it is drilled."""
        ...


@dataclass(frozen=True)
class Drilling:
    """Robot, tool and hole.

    Attributes:
        robot: the arm.
        tool: the drill.
        hole: what is drilled.
        limit_margin: room that every joint keeps to its limits [rad].
    """

    robot: Robot
    tool: Tool
    hole: Hole
    limit_margin: float = 0.0

    @classmethod
    def of(cls, wanted: Wanted, hole: Hole) -> Drilling:
        """A hole as a job, a plan or a map has it drilled."""
        return cls(wanted.robot, wanted.tool, hole, wanted.settings.limit_margin)

    @cached_property
    def limits(self) -> JointLimits:
        """What the joints may do: within the limits of the robot, less the room that is kept there."""
        return self.robot.allowed(self.limit_margin)

    @cached_property
    def plane(self) -> TwistPlane:
        """The hole's twist plane (theory §1)."""
        (y0, y1, y2), (d0, d1, d2) = self.hole.psi_zero.tolist(), self.hole.direction.tolist()
        x0, x1, x2 = y2 * d1 - y1 * d2, y0 * d2 - y2 * d0, y1 * d0 - y0 * d1
        return TwistPlane(
            target=tuple(self.hole.target.tolist()),
            R_base_tcp0=(x0, y0, -d0, x1, y1, -d1, x2, y2, -d2),
            R_tcp_flange=tuple(self.tool.T_flange_tcp[:3, :3].T.ravel().tolist()),
            wrist=tuple(wrist_in_tcp(self.robot, self.tool).tolist()),
        )

    @cached_property
    def bodies(self) -> Bodies | None:
        """Links and tool as rigid bodies; None where the masses of the robot are not known."""
        return bodies_of(self.robot, self.tool)

    @property
    def wrist_offset(self) -> float:
        """Distance e [m] of the wrist centre from the drill axis."""
        return wrist_offset(self.robot, self.tool)

    def angles(self, standoff: npt.ArrayLike, psi: npt.ArrayLike) -> Array:
        """Controller angles [rad] at points (...,) of the twist plane on all branches, shape (..., 8, 6)."""
        return inverse(self.robot, tcp_pose(self.hole, standoff, psi) @ np.linalg.inv(self.tool.T_flange_tcp))

    def angles_on(self, branch: int, standoff: npt.ArrayLike, psi: npt.ArrayLike) -> Array:
        """The same on one branch, 0..7, shape (..., 6)."""
        s, p = np.broadcast_arrays(np.asarray(standoff, dtype=float), psi)
        out = np.empty((s.size, 6))
        angles_along(
            self.robot.arm, self.plane, np.ascontiguousarray(s).ravel(), np.ascontiguousarray(p).ravel(), branch, out
        )
        return out.reshape(*s.shape, 6)

    def deep(self, depth: float) -> Drilling:
        """The same hole at another depth [m]; no other hole has the same twist plane."""
        return self._in_plane(replace(self.hole, depth=depth))

    def on_branch(self, branch: int | None) -> Drilling:
        """The same hole on one branch, 0..7, or on any."""
        return self._in_plane(replace(self.hole, branch=branch))

    def without_motion(self) -> Drilling:
        """The same hole without the motion that is given with it."""
        return self if self.hole.profile is None else self._in_plane(replace(self.hole, profile=None))

    def resized(self, settings: Settings, factor: float) -> tuple[Drilling, Settings]:
        """The same drilling at another size, with its settings (`model.resized`); a power of two changes no digit."""
        robot, tool, hole, settings = resized(self.robot, self.tool, self.hole, settings, factor)
        return Drilling(robot, tool, hole, self.limit_margin), settings

    def nearer(self, distance: float) -> Drilling:
        """The hole that ends so far [m] before this one's target, on the same line; its motion is left out."""
        hole = self.hole
        target = hole.target - distance * hole.direction
        return replace(self, hole=replace(hole, target=target, depth=hole.depth - distance, profile=None))

    def _in_plane(self, hole: Hole) -> Drilling:
        drilling = replace(self, hole=hole)
        drilling.__dict__["plane"] = self.plane
        return drilling


def joint_rates(drilling: Drilling, standoff: npt.ArrayLike, psi: npt.ArrayLike) -> tuple[Array, Array]:
    """theta_s [rad/m] and theta_psi [1], each (..., 8, 6), at points (...,) of the hole's twist plane (theory §1).

    NaN where a branch cannot reach, and at the singularities of shoulder, elbow and wrist.
    """
    standoff, psi = np.broadcast_arrays(np.asarray(standoff, dtype=float), np.asarray(psi, dtype=float))
    s, p = np.ascontiguousarray(standoff.ravel()), np.ascontiguousarray(psi.ravel())
    arm = drilling.robot.arm
    fields = np.empty((2, 4, 6, s.size))
    for posture in range(4):
        rates(arm, drilling.plane, posture, s, p, fields[0, posture], fields[1, posture])
    # the two wrist flips share their rates, but for the sign of joint 5
    branches = np.repeat(np.moveaxis(fields, -1, 1), 2, axis=2)
    branches[..., 4] *= [flip_sign(arm, branch) for branch in range(8)]
    theta_s, theta_psi = branches.reshape(2, *standoff.shape, 8, 6)
    return theta_s, theta_psi
