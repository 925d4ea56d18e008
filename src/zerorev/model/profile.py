"""The spin of the tool along a motion, piecewise linear in the stand-off."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from zerorev.errors import InputError
from zerorev.model._arrays import Array, finite

__all__ = ["Profile"]


@dataclass(frozen=True)
class Profile:
    """psi as a piecewise-linear function of the stand-off, leg by leg (thesis eq. 3.20 is the case of three points).

    Attributes:
        standoff: breakpoints [m] in order of motion, shape (n,), n >= 3: strictly falling to the corner, strictly
            rising after it. The corner is at 0, or below 0 where it is placed deeper to make good a blend.
        psi: spin [rad] at the breakpoints, shape (n,).
    """

    standoff: Array
    psi: Array

    def __post_init__(self) -> None:
        """Check that the stand-off falls to one corner and rises after it."""
        n = np.size(self.standoff)
        standoff, psi = finite(self.standoff, (n,), "profile, standoff"), finite(self.psi, (n,), "profile, psi")
        object.__setattr__(self, "standoff", standoff)
        object.__setattr__(self, "psi", psi)
        if n < 3:
            raise InputError(f"a profile of {n} breakpoints", where="profile", accepted="three or more")
        steps, corner = np.diff(standoff), self.corner
        if not ((steps[:corner] < 0).all() and (steps[corner:] > 0).all() and 0 < corner < n - 1):
            raise InputError(
                "the stand-off does not fall to the target and rise again",
                where="profile, standoff",
                accepted="strictly falling values, the target, strictly rising values, e.g. 50, 0, 50; pecking, in and "
                "out of a hole in steps, is not planned",
            )

    @classmethod
    def straight(
        cls, depth: float, psi_start: float, psi_target: float, psi_end: float, *, corner: float = 0.0
    ) -> Profile:
        """Two straight legs (thesis eq. 3.20): depth and corner stand-off [m], spins [rad]."""
        return cls(np.array([depth, corner, depth]), np.array([psi_start, psi_target, psi_end]))

    @cached_property
    def corner(self) -> int:
        """Index of the breakpoint at the turning point of the motion."""
        return int(np.argmin(self.standoff))

    @property
    def distance(self) -> Array:
        """Path distance [m] of the breakpoints from the start of the motion, shape (n,) (thesis fig. 33)."""
        return np.concatenate([[0.0], np.cumsum(np.abs(np.diff(self.standoff)))])

    def at(self, distance: Array) -> tuple[Array, Array]:
        """Stand-off [m] and spin [rad] at path distances [m], each of the shape of `distance`."""
        knots = self.distance
        return np.interp(distance, knots, self.standoff), np.interp(distance, knots, self.psi)

    def reversed(self) -> Profile:
        """The same motion run backwards (the mirror law, thesis eq. 4.12)."""
        return Profile(self.standoff[::-1], self.psi[::-1])

    def at_constant_spin(self) -> Profile:
        """The same stroke with the spin that it begins with: how robots drill today, the baseline."""
        return Profile(self.standoff[[0, self.corner, -1]], np.full(3, self.psi[0]))

    @property
    def twist_rate(self) -> Array:
        """The rate d psi / d s of each segment, read outwards [rad/m], shape (n - 1,)."""
        return np.diff(self.psi) / np.diff(self.standoff)
