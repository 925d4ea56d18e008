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
        standoff: breakpoints [m] in order of motion, shape (n,), n >= 3: falling to the corner, strictly rising after
            it. On the way in the tool may draw back, to break chips. The corner is at 0, or below 0 where it is placed
            deeper to make good a blend.
        psi: spin [rad] at the breakpoints, shape (n,).
    """

    standoff: Array
    psi: Array

    def __post_init__(self) -> None:
        """Check that the stand-off falls to one deepest point, the corner, and rises after it."""
        n = np.size(self.standoff)
        standoff, psi = finite(self.standoff, (n,), "profile, standoff"), finite(self.psi, (n,), "profile, psi")
        object.__setattr__(self, "standoff", standoff)
        object.__setattr__(self, "psi", psi)
        if n < 3:
            raise InputError(f"a profile of {n} breakpoints", where="profile", accepted="three or more")
        steps, corner = np.diff(standoff), self.corner
        inwards = 0 < corner < n - 1 and (steps[:corner] != 0).all() and steps[0] < 0 and steps[corner - 1] < 0
        if not (inwards and (steps[corner:] > 0).all() and (standoff[1:corner] < standoff[0]).all()):
            raise InputError(
                "the stand-off does not fall to the target and rise again",
                where="profile, standoff",
                accepted="falling values, the target, strictly rising values, e.g. 50, 0, 50; on the way in the tool "
                "may draw back, e.g. 50, 25, 25.3, 0, 50",
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

    @cached_property
    def turns(self) -> tuple[int, ...]:
        """Indices of the breakpoints at which the tool turns round, in and out again: the corner among them."""
        inwards = np.diff(self.standoff) < 0
        return tuple((np.flatnonzero(inwards[1:] != inwards[:-1]) + 1).tolist())

    def just_before_corner(self, rise: float) -> int:
        """How many breakpoints lie before the corner and no more than so much above it.

        Args:
            rise: [m].
        """
        before = self.standoff[: self.corner] - self.standoff[self.corner]
        return int(np.count_nonzero(before <= rise * (1 + 1e-6)))

    @property
    def leg_lengths(self) -> Array:
        """Path of the plunge and of the retract [m], shape (2,)."""
        along = self.distance[[0, self.corner, -1]]
        return np.asarray(np.diff(along))

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
