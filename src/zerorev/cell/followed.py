"""A motion over time, as an arm is asked to follow it: its nodes, and the torques and masses of the arm along them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from zerorev.errors import InputError
from zerorev.kernels import dynamics
from zerorev.model._arrays import Array
from zerorev.model.dynamics import Dynamics, Load
from zerorev.model.robot import Robot
from zerorev.motion.bodies import bodies_of
from zerorev.motion.drilling import Drilling
from zerorev.motion.kinematics import jacobian
from zerorev.motion.loads import GRAVITY

__all__ = ["MASS_EVERY", "STEP", "Followed", "dynamics_of"]

STEP = 1e-3  # [s] between nodes
MASS_EVERY = 20  # nodes between mass matrices
LEVERS = (0.3, 0.55, 0.8)  # shares of the way to the tip at which a unit mass is weighed: three make a parabola
DIFFERENCE = 1e-4  # [rad] by which the weights are moved to see how their torques change


@dataclass(frozen=True)
class Followed:
    """A reference at nodes `STEP` apart, N of them.

    Attributes:
        drilling: robot, tool and hole.
        standoff: [m], shape (N,).
        psi: spin [rad], shape (N,).
        q: joints with turns [rad], shape (N, 6).
        qd: [rad/s], shape (N, 6).
        qdd: [rad/s^2], shape (N, 6).
        slowed: by how much the feed was slowed, 1 where it was not.
    """

    drilling: Drilling
    standoff: Array
    psi: Array
    q: Array
    qd: Array
    qdd: Array
    slowed: float

    @property
    def turn(self) -> int:
        """The node of greatest depth."""
        return int(np.argmin(self.standoff))

    @cached_property
    def path(self) -> Array:
        """Path distance of the nodes along the axis [m], 0 at the turn, shape (N,) (thesis fig. 33)."""
        along = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(self.standoff)))])
        return np.asarray(along - along[self.turn])

    @property
    def speed(self) -> float:
        """Greatest speed of the tip along the axis that is reached [m/s]."""
        return float(np.abs(np.diff(self.standoff)).max() / STEP)

    @cached_property
    def levers(self) -> Array:
        """Velocity of the tip per speed of the joints, base frame [m], shape (N, 6, 3)."""
        drilling = self.drilling
        J = jacobian(drilling.robot, drilling.tool, self.q)
        return np.ascontiguousarray(np.swapaxes(J[:, :3], 1, 2))

    @cached_property
    def torques(self) -> Array:
        """Torques of the bare arm, and of a unit mass at `LEVERS` besides [N m], shape (4, N, 6)."""
        bare = self._torques_of(self._bodies(None))
        return np.stack([bare, *(self._torques_of(self._bodies(lever)) - bare for lever in LEVERS)])

    @cached_property
    def masses(self) -> Array:
        """Mass matrices every `MASS_EVERY` nodes of the bare arm, and of a unit mass besides [kg m^2], (4, K, 6, 6)."""
        bare = self._masses_of(self._bodies(None))
        return np.stack([bare, *(self._masses_of(self._bodies(lever)) - bare for lever in LEVERS)])

    @cached_property
    def stiffenings(self) -> Array:
        """How the weights' torques change with the joints [N m/rad], shape (4, K, 6, 6), as `masses`."""
        bare = self._stiffenings_of(self._bodies(None))
        return np.stack([bare, *(self._stiffenings_of(self._bodies(lever)) - bare for lever in LEVERS)])

    def of_load(self, values: Array, mass: float, lever: float) -> Array:
        """`torques` or `masses` for a point mass [kg] at a share of the way from flange to tip; exact, not fitted.

        Args:
            values: of the bare arm and of a unit mass at `LEVERS`.
            mass: of the tool [kg].
            lever: share of the way to the tip.
        """
        a, b, c = LEVERS
        weights = (
            (lever - b) * (lever - c) / ((a - b) * (a - c)),
            (lever - a) * (lever - c) / ((b - a) * (b - c)),
            (lever - a) * (lever - b) / ((c - a) * (c - b)),
        )
        return np.asarray(values[0] + mass * sum(w * each for w, each in zip(weights, values[1:], strict=True)))

    @cached_property
    def loaded(self) -> tuple[Array, Array, Array]:
        """Torques (N, 6), mass matrices and stiffenings (K, 6, 6) with the tool's own load."""
        bodies = self.drilling.bodies
        assert bodies is not None
        return self._torques_of(bodies), self._masses_of(bodies), self._stiffenings_of(bodies)

    def _torques_of(self, bodies: dynamics.Bodies) -> Array:
        out = np.empty_like(self.q)
        dynamics.inverse_dynamics(self.drilling.robot.arm, bodies, self.q, self.qd, self.qdd, GRAVITY, out)
        return out

    @cached_property
    def _sparse(self) -> Array:
        """The joints every `MASS_EVERY` nodes, the last one beyond the end, shape (K, 6)."""
        rows = np.arange(0, len(self.q) + MASS_EVERY, MASS_EVERY).clip(max=len(self.q) - 1)
        return np.ascontiguousarray(self.q[rows])

    def _masses_of(self, bodies: dynamics.Bodies) -> Array:
        out = np.empty((len(self._sparse), 6, 6))
        dynamics.mass_matrix(self.drilling.robot.arm, bodies, self._sparse, out)
        return out

    def _stiffenings_of(self, bodies: dynamics.Bodies) -> Array:
        away = DIFFERENCE * np.eye(6)
        q = (self._sparse[:, None] + np.concatenate([away, -away])).reshape(-1, 6)
        held, still = np.empty_like(q), np.zeros_like(q)
        dynamics.inverse_dynamics(self.drilling.robot.arm, bodies, q, still, still, GRAVITY, held)
        ahead, back = np.moveaxis(held.reshape(-1, 2, 6, 6), 1, 0)
        return np.ascontiguousarray(np.swapaxes((ahead - back) / (2 * DIFFERENCE), 1, 2))

    def _bodies(self, lever: float | None) -> dynamics.Bodies:
        robot, tool = self.drilling.robot, self.drilling.tool
        load = None
        if lever is not None:
            load = Load(1.0, lever * tool.T_flange_tcp[:3, 3], np.zeros((3, 3)))
        bodies = bodies_of(robot, replace(tool, load=load))
        assert bodies is not None
        return bodies


def dynamics_of(robot: Robot) -> Dynamics:
    """The masses of a robot.

    Raises:
        InputError: they are not known.
    """
    if robot.dynamics is None:
        raise InputError(
            f"the masses of the robot {robot.name} are not known, so that nothing can be simulated",
            where="robot",
            accepted="a robot file with dynamics: links, payload_kg",
        )
    return robot.dynamics
