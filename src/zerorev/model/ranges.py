"""What is not known of an arm, as ranges: drives, gears, controller, tool.

A range is stated once, with its law and where it comes from; nothing here is a fact of any arm.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from zerorev.errors import InputError
from zerorev.model._arrays import Array

__all__ = ["HELD", "OF_THE_MANNER", "RANGES", "Basis", "Cell", "Conditioning", "Law", "Range"]

Law = Literal["log", "even"]
Basis = Literal["prior", "fitted", "conditioned"]


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
        most: what no value can exceed.
    """

    nominal: float
    low: float
    high: float
    law: Law
    means: str
    source: str = "a guess"
    basis: Basis = "prior"
    most: float = np.inf

    def __post_init__(self) -> None:
        """Check the order of the numbers.

        Raises:
            InputError: a nominal value outside, or nothing above 0 where the logarithm is taken.
        """
        least = 0.0 if self.law == "even" else np.nextafter(0.0, 1.0)
        if not least <= self.low <= self.nominal <= self.high <= self.most or not np.isfinite(self.high):
            above = "0 <= " if self.law == "even" else "0 < "
            below = f" <= {self.most:g}" if np.isfinite(self.most) else ""
            raise InputError(
                f"low {self.low:g}, nominal {self.nominal:g}, high {self.high:g} are not a range",
                accepted=f"{above}low <= nominal <= high{below}",
            )

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
    "behind": Range(0.3, 0.1, 0.9, "even", "share of the friction that lies behind the gear", most=1),
    "gap": Range(1.0, 0.3, 3.0, "log", "lost motion of all joints [arcmin]", SERVO_GEARS),
    "kind": Range(0.0, 0.0, 1.0, "even", "kind of lost motion: a gap below one half, else a hysteresis", most=1),
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
class Conditioning:
    """What was measured of the baseline of some holes, and in which manner: sets that are far from it do not count.

    Attributes:
        baseline: deviation by the encoders of the baseline [m], by the id of the hole.
        feed: programmed feed [m/s]; None: the plan's.
        corner: radius of the blend at the corner [m]; None: as programmed.
        factor: by which a set may be off at each hole.
    """

    baseline: Mapping[str, float]
    feed: float | None = None
    corner: float | None = None
    factor: float = 2.0

    def __post_init__(self) -> None:
        """Check that there is something to compare with.

        Raises:
            InputError: no hole, or a number that cannot be.
        """
        if not self.baseline:
            raise InputError("no hole", where="baseline_mm", accepted="a deviation for one hole or more")
        for hole, deviation in self.baseline.items():
            if not 0 < deviation < np.inf:
                raise InputError("a deviation that is not above 0", where=f"baseline_mm, hole {hole}",
                                 accepted="a number above 0 [mm]")  # fmt: skip
        if not 1 < self.factor < np.inf:
            raise InputError("a factor that is not above 1", where="factor", accepted="a number above 1")


@dataclass(frozen=True)
class Cell:
    """An arm with its controller, as far as it is known.

    Attributes:
        ranges: of every parameter, by its name.
        conditioning: what was measured of baselines; None: nothing was.
        robot: of which it is, by its name; empty: any.
    """

    ranges: Mapping[str, Range] = field(default_factory=lambda: dict(RANGES))
    conditioning: Conditioning | None = None
    robot: str = ""

    def __post_init__(self) -> None:
        """Give what is not stated its prior.

        Raises:
            InputError: a name that there is none of.
        """
        for name in self.ranges:
            if name not in RANGES:
                raise InputError(f"unknown parameter '{name}'", where="parameters", accepted=", ".join(RANGES))
        object.__setattr__(self, "ranges", RANGES | dict(self.ranges))
