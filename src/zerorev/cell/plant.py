"""One arm along one motion: where its tip goes, as the encoders see it and as it is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from zerorev.cell.followed import MASS_EVERY, STEP, Followed
from zerorev.cell.parameters import ParameterSet
from zerorev.kernels import plant as kernels
from zerorev.model._arrays import Array
from zerorev.motion.drilling import Drilling

__all__ = ["REST", "TIME_STEP", "Run", "run", "weighs_itself"]

TIME_STEP = 1e-4  # [s]
REST = 0.3  # [s] before the motion begins


@dataclass(frozen=True)
class Run:
    """A run at the nodes of its reference, N of them.

    Attributes:
        reference: what was asked for.
        rotor: encoder less reference [rad], shape (N, 6).
        link: link less reference [rad], shape (N, 6).
        drive: torques of the drives [N m], shape (N, 6).
        tcp_error: the tip less the one that the controller knows, in the tool's frame at psi = 0 [m], shape (2,).
    """

    reference: Followed
    rotor: Array
    link: Array
    drive: Array
    tcp_error: Array

    @property
    def encoder(self) -> Array:
        """Deviation of the tip from the commanded one by the encoders [m], base frame, shape (N, 3)."""
        return np.asarray(np.einsum("njk,nj->nk", self.reference.levers, self.rotor))

    @property
    def tool(self) -> Array:
        """Deviation of the tip itself [m], base frame, shape (N, 3)."""
        moved = np.einsum("njk,nj->nk", self.reference.levers, self.link)
        hole, psi = self.reference.drilling.hole, self.reference.psi
        y, z = hole.psi_zero, -hole.direction
        x = np.cross(y, z)
        c, s = np.cos(psi)[:, None], np.sin(psi)[:, None]
        a, b = self.tcp_error
        return np.asarray(moved + a * (c * x + s * y) + b * (c * y - s * x))


def run(
    reference: Followed,
    parameters: ParameterSet,
    *,
    shift: Array | None = None,
    thrust: Array | None = None,
    time_step: float = TIME_STEP,
) -> Run:
    """Let an arm follow a reference.

    Args:
        reference: of an arm with dynamics.
        parameters: of the arm.
        shift: what is added to the command [rad], shape (N, 6), the motion being measured against the reference still.
        thrust: force of the part on the drill against the plunge at the nodes [N], shape (N,); None: none.
        time_step: of the integration [s].
    """
    drilling = reference.drilling
    dynamics = drilling.robot.dynamics
    assert dynamics is not None
    if weighs_itself(drilling, parameters):
        torque, masses, stiffening = reference.loaded
    else:
        load = parameters["tool_mass"], parameters["tool_lever"]
        torque, masses, stiffening = (
            reference.of_load(values, *load) for values in (reference.torques, reference.masses, reference.stiffenings)
        )
    outer = np.zeros_like(torque)
    if thrust is not None:
        outer = -thrust[:, None] * (reference.levers @ drilling.hole.direction)
    inverse = np.asarray(np.linalg.inv(masses), dtype=np.float64)
    q, qd, qdd = reference.q, reference.qd, reference.qdd
    if shift is not None:
        added = np.gradient(shift, STEP, axis=0)
        q, qd, qdd = q + shift, qd + added, qdd + np.gradient(added, STEP, axis=0)
    count = len(q)
    rotor, link, drive = np.empty((3, count, 6))
    kernels.follow(
        kernels.Reference(
            STEP, q, qd, qdd, torque, outer, MASS_EVERY, inverse, stiffening,
            masses.diagonal(axis1=1, axis2=2).min(axis=0).copy(),
        ),
        parameters.arm(dynamics), REST, time_step, rotor, link, drive,
    )  # fmt: skip
    if shift is not None:
        rotor, link = rotor + shift, link + shift
    delta, angle = parameters["tcp_error"], parameters["tcp_angle"]
    return Run(reference, rotor, link, drive, delta * np.array([np.cos(angle), np.sin(angle)]))


def weighs_itself(drilling: Drilling, parameters: ParameterSet) -> bool:
    """Whether the tool's weight is that of its file, and not one that was drawn."""
    return drilling.tool.load is not None and "tool_mass" not in parameters.values
