"""What is not known of an arm, as ranges: drives, gears, controller, tool. One set of values is one possible arm.

A range is stated once, with its law and where it comes from; nothing here is a fact of any arm. Sets are drawn by a
Latin hypercube, so that few of them cover all ranges (scipy.stats.qmc).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np
from scipy.stats import qmc

from zerorev.cell.reference import Manner
from zerorev.errors import InputError
from zerorev.kernels.plant import GAP, HYSTERESIS, Arm
from zerorev.model._arrays import Array
from zerorev.model.dynamics import Dynamics, nominal_drives

__all__ = ["RANGES", "Basis", "ParameterSet", "Range", "drawn", "nominal"]

Law = Literal["log", "even"]
Basis = Literal["prior", "fitted", "conditioned"]
ARCMIN = float(np.deg2rad(1 / 60))
NO_LIMIT = 1e6  # [N m] of a drive of which the greatest torque is not known


@dataclass(frozen=True)
class Range:
    """What a parameter may be.

    Attributes:
        nominal: a value to begin with.
        low: least.
        high: greatest.
        law: whether it is spread evenly or in its logarithm.
        means: what it is, with its unit.
        source: what the range rests on.
        basis: whether it is a prior, fitted to recordings, or conditioned on one.
    """

    nominal: float
    low: float
    high: float
    law: Law
    means: str
    source: str = "a guess"
    basis: Basis = "prior"

    def at(self, share: Array) -> Array:
        """Values at shares of the range, 0 to 1."""
        if self.law == "log":
            return np.asarray(self.low * (self.high / self.low) ** share)
        return np.asarray(self.low + (self.high - self.low) * share)


def _six(name: str, range_: Range) -> dict[str, Range]:
    return {f"{name}_{joint}": range_ for joint in range(1, 7)}


SERVO_GEARS = "servo gears are sold with 1 to 3 arcmin"

RANGES: dict[str, Range] = {
    "friction": Range(1, 0.5, 2, "log", "factor on the nominal dry friction of all joints"),
    "viscous": Range(1, 0.5, 2, "log", "factor on the nominal viscous friction of all joints"),
    "drive_inertia": Range(1, 0.5, 2, "log", "factor on the nominal inertia of all drives"),
    **_six("friction", Range(1, 0.7, 1.4, "log", "factor on the dry friction of one joint")),
    **_six("gap", Range(1, 0.7, 1.4, "log", "factor on the lost motion of one joint")),
    "breakaway": Range(1.3, 1.1, 1.5, "even", "static over dry friction", "Manutec r3: 1.23 to 1.54"),
    "stribeck": Range(0.03, 0.01, 0.05, "log", "speed at which static friction fades [rad/s]", "TX40: 0.025 to 0.05"),
    "presliding": Range(2e-4, 0.5e-4, 5e-4, "log", "distance over which friction builds up [rad]"),
    "behind": Range(0.3, 0.1, 0.9, "even", "share of the friction that lies behind the gear"),
    "gap": Range(1.0, 0.3, 3.0, "log", "lost motion of all joints [arcmin]", SERVO_GEARS),
    "kind": Range(0.0, 0.0, 1.0, "even", "kind of lost motion: a gap below one half, a hysteresis above"),
    "stiffness": Range(1, 0.4, 2.5, "log", "factor on the nominal stiffness of all gears"),
    "damping": Range(0.08, 0.03, 0.2, "log", "damping ratio of the gears"),
    "bandwidth": Range(400, 150, 1000, "log", "bandwidth of the speed loop [rad/s]"),
    "position_gain": Range(0.12, 0.08, 0.2, "even", "gain of the position loop over that bandwidth"),
    "reset": Range(5, 3, 8, "even", "integration time times that bandwidth"),
    "forward": Range(1, 0.7, 1, "even", "share of the computed torque that is fed forward"),
    "friction_forward": Range(0, 0, 0.7, "even", "share of the friction that is fed forward"),
    "tool_mass": Range(0.3, 0.3, 3, "log", "mass of the tool [kg], where its file does not state it"),
    "tool_lever": Range(0.5, 0.3, 0.8, "even", "share of the way to the tip at which the tool's mass lies, likewise"),
    "corner": Range(10e-3, 1e-3, 10e-3, "even", "radius of the blend at the corner [m], where it is varied"),
    "acceleration": Range(2, 1, 4, "even", "of the tip along its path [m/s^2], where it is varied"),
    "smoothing": Range(30e-3, 0, 60e-3, "even", "width of the moving averages [s], where they are varied"),
    "tcp_error": Range(0, 0, 0.2e-3, "even", "error of the tool centre point across the axis [m], where it is varied"),
    "tcp_angle": Range(0, 0, 2 * np.pi, "even", "its direction [rad]"),
}
"""Every parameter by its name, the prior; a cell file may narrow each."""

OF_THE_MANNER = ("corner", "acceleration", "smoothing")
HELD = (*OF_THE_MANNER, "tcp_error", "tcp_angle")
"""Held at their nominal values unless asked for: they are choices of the cell, not of the arm."""


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
        held: names besides that stay at their nominal values.

    Raises:
        InputError: no set at all, or a name that there is none of.
    """
    if count < 1:
        raise InputError("no sets", where="sets", accepted="1 or more")
    for name in (*vary, *held, *ranges):
        if name not in RANGES:
            raise InputError(f"unknown parameter '{name}'", where="cell", accepted=", ".join(RANGES))
    names = [name for name in ranges if name not in held and (name not in HELD or name in vary)]
    shares = qmc.LatinHypercube(d=len(names), rng=np.random.default_rng(seed)).random(count)
    values = {name: ranges[name].at(shares[:, k]) for k, name in enumerate(names)}
    return [ParameterSet({name: float(each[n]) for name, each in values.items()}) for n in range(count)]
