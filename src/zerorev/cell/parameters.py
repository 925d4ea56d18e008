"""One possible arm: a value for each parameter of which only a range is known (`zerorev.model.ranges`).

Sets are drawn by a Latin hypercube, so that few of them cover all ranges (scipy.stats.qmc).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from zerorev.cell.reference import Manner
from zerorev.errors import InputError
from zerorev.kernels.plant import GAP, HYSTERESIS, Arm
from zerorev.model.dynamics import Dynamics, nominal_drives
from zerorev.model.ranges import HELD, OF_THE_MANNER, RANGES, Basis, Range

__all__ = ["RANGES", "Basis", "ParameterSet", "Range", "drawn", "nominal"]

ARCMIN = float(np.deg2rad(1 / 60))
NO_LIMIT = 1e6  # [N m] of a drive of which the greatest torque is not known


@dataclass(frozen=True)
class ParameterSet:
    """One possible arm: a value for every parameter.

    Attributes:
        values: by name, as `RANGES` has them.
    """

    values: Mapping[str, float] = field(default_factory=dict)

    def __getitem__(self, name: str) -> float:
        """Value of a parameter; its nominal one where it was not drawn."""
        return self.values.get(name, RANGES[name].nominal)

    def arm(self, dynamics: Dynamics) -> Arm:
        """Drives and controller with these values, nominal ones multiplied."""
        nominal_arm = nominal_drives(dynamics.payload)
        joints = range(1, 7)
        limit = np.full(6, NO_LIMIT) if dynamics.effort_limit is None else dynamics.effort_limit
        return Arm(
            coulomb=nominal_arm.coulomb * self["friction"] * np.array([self[f"friction_{j}"] for j in joints]),
            viscous=nominal_arm.viscous * self["viscous"],
            breakaway=float(self["breakaway"]),
            stribeck=float(self["stribeck"]),
            presliding=float(self["presliding"]),
            behind=float(self["behind"]),
            drive=nominal_arm.inertia * self["drive_inertia"],
            stiffness=nominal_arm.stiffness * self["stiffness"],
            gap=self["gap"] * ARCMIN * np.array([self[f"gap_{j}"] for j in joints]),
            kind=HYSTERESIS if self["kind"] >= 0.5 else GAP,
            damping=float(self["damping"]),
            bandwidth=float(self["bandwidth"]),
            position=float(self["position_gain"]),
            reset=float(self["reset"]),
            forward=float(self["forward"]),
            friction_forward=float(self["friction_forward"]),
            limit=np.array(limit, dtype=np.float64),
        )

    def manner(self, manner: Manner) -> Manner:
        """How the controller runs a program, with what was drawn of it."""
        drawn_of = {name: self.values[name] for name in OF_THE_MANNER if name in self.values}
        return replace(manner, **drawn_of) if drawn_of else manner


def nominal() -> ParameterSet:
    """The set of all nominal values."""
    return ParameterSet()


def drawn(
    count: int,
    seed: int,
    ranges: Mapping[str, Range] = RANGES,
    *,
    vary: tuple[str, ...] = (),
    held: tuple[str, ...] = (),
) -> list[ParameterSet]:
    """Sets of parameters by a Latin hypercube.

    Args:
        count: how many.
        seed: the same seed gives the same sets, to the last bit, for the same names.
        ranges: what each may be.
        vary: of those that are `HELD` by themselves.
        held: names besides that stay at the nominal values of these ranges.

    Raises:
        InputError: no set at all, or a name that there is none of.
    """
    if count < 1:
        raise InputError("no sets", where="sets", accepted="1 or more")
    for name in (*vary, *held, *ranges):
        if name not in RANGES:
            raise InputError(f"unknown parameter '{name}'", where="cell", accepted=", ".join(RANGES))
    from scipy.stats import qmc  # heavy

    names = [name for name in ranges if name not in held and (name not in HELD or name in vary)]
    shares = qmc.LatinHypercube(d=len(names), rng=np.random.default_rng(seed)).random(count)
    values = {name: ranges[name].at(shares[:, k]) for k, name in enumerate(names)}
    for name in ranges.keys() - set(names):
        if ranges[name].nominal != RANGES[name].nominal:
            values[name] = np.full(count, ranges[name].nominal)
    return [ParameterSet({name: float(each[n]) for name, each in values.items()}) for n in range(count)]
