"""The units of files and of people, each with the SI unit inside that goes with it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from zerorev.model._arrays import Array

__all__ = [
    "DEG", "DEG_PER_MM", "DEG_S", "DEG_S2", "KG", "KG_M2", "MM", "MM_S", "NEWTON", "NM", "NM_PER_RAD", "ONE", "PERCENT",
    "RPM", "UM_PER_N", "S", "Unit",
]  # fmt: skip

V = TypeVar("V", float, "Array")


@dataclass(frozen=True)
class Unit:
    """A unit of files and of people, and the SI unit inside that goes with it.

    Attributes:
        name: as people read it; empty for a bare number.
        suffix: of a key in a file.
        si: the unit inside.
        angle: whether it counts degrees, and radians inside.
        times: SI units in one of it, the angle left out: `times / per`, so that neither is rounded.
        per: see `times`.
        length: the exponent of length in it; so does a figure grow with the size of the arm (theory §6).
        most: the largest number that files accept: far beyond any arm, and near enough that nothing overflows.
    """

    name: str = ""
    suffix: str = ""
    si: str = ""
    angle: bool = False
    times: float = 1.0
    per: float = 1.0
    length: int = 0
    most: float = 1e12

    def inside(self, value: V) -> V:
        """A number in SI and radians."""
        si = value * self.times / self.per
        return si * (math.pi / 180) if self.angle else si

    def outside(self, value: V) -> V:
        """A number in this unit, of one in SI and radians."""
        turned = value * (180 / math.pi) if self.angle else value
        return turned * self.per / self.times


ONE = Unit()
MM = Unit("mm", "mm", "m", per=1e3, length=1, most=1e6)
MM_S = Unit("mm/s", "mm_s", "m/s", per=1e3, length=1)
DEG = Unit("deg", "deg", "rad", angle=True, most=36_000)
DEG_PER_MM = Unit("deg/mm", "deg_per_mm", "rad/m", angle=True, times=1e3, length=-1, most=1e4)
DEG_S = Unit("deg/s", "deg_s", "rad/s", angle=True)
DEG_S2 = Unit("deg/s^2", "deg_s2", "rad/s^2", angle=True)
S = Unit("s", "s", "s")
KG = Unit("kg", "kg", "kg")
KG_M2 = Unit("kg m^2", "kgm2", "kg m^2", most=1e9)
NM = Unit("N m", "nm", "N m")
NEWTON = Unit("N", "n", "N", most=1e6)
NM_PER_RAD = Unit("N m/rad", "nm_per_rad", "N m/rad")
PERCENT = Unit("%", "percent", per=100)
RPM = Unit("rev/min", "rpm", "rad/s", per=30 / math.pi)
UM_PER_N = Unit("um/N", "um_per_n", "m/N", per=1e6)
