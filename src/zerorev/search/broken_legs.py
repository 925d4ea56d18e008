"""Motions that break chips, known by four numbers; the work is done in `kernels.broken`."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Literal, NamedTuple

import numpy as np

from zerorev.kernels import broken
from zerorev.kernels.layout import Breaking
from zerorev.model._arrays import Array
from zerorev.model.cycle import Cycle
from zerorev.model.profile import Profile
from zerorev.model.settings import Settings
from zerorev.motion.drilling import Drilling
from zerorev.search.straight import LEAST_RATE, LIMIT_SLACK

__all__ = ["CLEAN", "GUARDS", "ROOM", "BrokenLegs", "Goal", "Numbers"]

Goal = Literal["depth", "travel"]
GOALS: dict[Goal, int] = {"depth": broken.DEEPEST, "travel": broken.LEAST_TRAVEL}
# kept beyond the motion threshold [rad/m]: 0.001 deg/mm, so that the digits of a program turn no joint round
ROOM = float(np.deg2rad(1.0))
GUARDS = (0.0, 1e-4, 1e-3, 1e-2)  # beyond the motion threshold, for what lies between the points examined [rad/m]
CLEAN = 1e-6  # [rad/m] below what is asked: lost in rounding, and made up for by what is kept back, or by a guard
SAMPLES = 17  # points of a leg, about, at which rates are examined
NO_LIMIT = 1e3  # [rad]
NEAR_LIMIT = 1e-4  # [rad]


class Numbers(NamedTuple):
    """What such a motion is known by.

    Attributes:
        psi: spin at the corner [rad].
        plunge: slope of the plunge, read outwards [rad/m].
        retract: slope of the retract [rad/m].
        depth: stand-off at which the motion begins and ends [m].
    """

    psi: float
    plunge: float
    retract: float
    depth: float

    @classmethod
    def of(cls, profile: Profile) -> Numbers:
        """Those of a motion of two straight legs, with breaks in the first or without."""
        slopes, corner = profile.twist_rate, profile.corner
        return cls(
            float(profile.psi[corner]), float(slopes[corner - 1]), float(slopes[corner]), float(profile.standoff[0])
        )


@dataclass(frozen=True)
class BrokenLegs:
    """Motions of one hole on one branch that break the chips so many times.

    Attributes:
        drilling: robot, tool and hole, whose depth does not matter.
        settings: with the motion threshold, the bound on the spin, and the greatest twist of a way back.
        branch: 0..7.
        cycle: how often and how far the tool draws back.
        count: of the breaks.
        deepest: no motion with so many breaks is deeper [m].
        guard: what joints keep beyond the motion threshold [rad/m].
        evenly: see `Breaking`.
    """

    drilling: Drilling
    settings: Settings
    branch: int
    cycle: Cycle
    count: int
    deepest: float = np.inf
    guard: float = 0.0
    evenly: bool = False

    @classmethod
    def at(cls, drilling: Drilling, settings: Settings, branch: int, cycle: Cycle, depth: float) -> BrokenLegs:
        """Motions with as many breaks as a depth has [m]."""
        return cls(drilling, settings, branch, cycle, len(cycle.breaks(depth)))

    def motion(self, numbers: Numbers) -> Profile:
        """The motion of four numbers."""
        standoff, psi = np.empty((2, 2 * self.count + 2))
        arm, plane = self.drilling.robot.arm, self.drilling.plane
        broken.path(arm, plane, self.branch // 2, self._breaking, self.count, np.array(numbers), standoff, psi)
        end = numbers.psi + numbers.retract * (numbers.depth - standoff[0])
        return Profile(np.append(standoff[::-1], numbers.depth), np.append(psi[::-1], end))

    def improved(self, numbers: Numbers, goal: Goal, enough: float) -> tuple[Numbers, float]:
        """The best numbers that small steps reach from these, and by how much they violate what is asked.

        Args:
            numbers: to begin with; they need not keep the rules.
            goal: `depth`, as deep as can be; or the least `travel`, at the depth that is given.
            enough: less gain than this, relative, is none.

        Returns:
            numbers; by how much a rate, or the room to a limit over the depth, lacks what is asked [rad/m], 0 or less
            where none does, inf where the motion to begin with cannot be run.
        """
        found = np.array(numbers)
        lack = broken.better(
            self.drilling.robot.arm, self.drilling.plane, self.branch, self._breaking, self.count, self._samples,
            GOALS[goal], self.deepest, enough, found,
        )  # fmt: skip
        return Numbers(*found.tolist()), float(lack)

    def at_a_limit(self, numbers: Numbers) -> bool:
        """Whether a joint is at one of its limits, or the motion cannot be run."""
        room = broken.room_of_joints(
            self.drilling.robot.arm, self.drilling.plane, self.branch, self._breaking, self.count, self._samples,
            np.array(numbers),
        )  # fmt: skip
        return bool(room < NEAR_LIMIT)

    @property
    def _samples(self) -> tuple[int, int]:
        return max(2, SAMPLES // (self.count + 1)), SAMPLES

    @cached_property
    def _breaking(self) -> Breaking:
        settings = self.settings
        lower, upper = self._limits
        return Breaking(
            corner=settings.corner_standoff, peck=self.cycle.depth or 1.0, back=self.cycle.back,
            nearest=self.cycle.nearest, least=max(settings.min_rate, LEAST_RATE) + self.guard,
            least_back=settings.min_rate + ROOM, steepest=settings.max_twist,
            lead=settings.lead_in if settings.keep_lead_in else 0.0, evenly=self.evenly,
            psi_bound=settings.psi_bound or 0.0, lower=lower, upper=upper,
        )  # fmt: skip

    @property
    def _limits(self) -> tuple[Array, Array]:
        limits = self.drilling.limits
        bounded = np.isfinite(limits.lower) & np.isfinite(limits.upper)
        lower, upper = np.where(bounded, limits.lower, -NO_LIMIT), np.where(bounded, limits.upper, NO_LIMIT)
        return lower + LIMIT_SLACK, upper - LIMIT_SLACK
