"""What the exact search is asked: one hole, and what its legs are held to."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from zerorev.kernels import legs
from zerorev.kernels.layout import Constraints, TwistPlane
from zerorev.model._arrays import Array
from zerorev.model.job import Settings
from zerorev.motion.drilling import Drilling
from zerorev.search.rank import Candidate, Order
from zerorev.search.straight import GRID, constraints, steepest_twist, straight_motion, target_spins

__all__ = ["Mask", "Problem"]

Mask = npt.NDArray[np.bool_]


@dataclass(frozen=True)
class Problem:
    """One hole.

    Attributes:
        drilling: robot, tool and hole; its `branch`, if any, is the only one searched.
        settings: threshold, bound on the spin, objective, weights of the joints.
    """

    drilling: Drilling
    settings: Settings

    @cached_property
    def order(self) -> Order:
        """Which motion is better than another."""
        return Order(self.drilling, self.settings)

    @cached_property
    def plane(self) -> TwistPlane:
        """The hole's twist plane."""
        return self.drilling.plane

    @cached_property
    def psi(self) -> Array:
        """The spins at the target that are examined first [rad], shape (K,)."""
        return target_spins(self.settings.psi_bound, GRID)

    @property
    def step(self) -> float:
        """Distance of two of those spins [rad]."""
        return float(self.psi[1] - self.psi[0])

    @property
    def periodic(self) -> bool:
        """Whether full turns of the tool do not matter."""
        return self.settings.psi_bound is None

    @cached_property
    def weights(self) -> Array:
        """What a reversal of each joint costs, shape (6,)."""
        return np.array(self.settings.reversal_weights, dtype=float)

    @property
    def branches(self) -> list[int]:
        """Those that are searched, of 0..7."""
        return list(range(8)) if self.drilling.hole.branch is None else [self.drilling.hole.branch]

    def constraints(self, min_rate: float, *, mean_rule: bool = False, turn_inside: bool = False) -> Constraints:
        """What the legs are held to."""
        return constraints(
            self.drilling,
            self.settings,
            min_rate,
            steepest=steepest_twist(self.settings, self.drilling.hole.depth),
            depth=self.drilling.hole.depth,
            mean_rule=mean_rule,
            turn_inside=turn_inside,
        )

    def objective(self, *, turn_inside: bool = False) -> tuple[Constraints, int]:
        """What the settings ask of the legs, and what makes one better than another."""
        settings = self.settings
        mode = {
            "travel": legs.TRAVEL,
            "margin": legs.GREATEST_MARGIN,
            "plunge_rotation": legs.PLUNGE_ROTATION,
        }[settings.objective]
        mean_rule = settings.min_rate_rule == "mean"
        return self.constraints(settings.min_rate, mean_rule=mean_rule, turn_inside=turn_inside), mode

    def found(self, branch: int, psi_t: float, slopes: tuple[float, float]) -> Candidate | None:
        """The motion of two legs out of one spin at the target, evaluated; None where it cannot be run."""
        return self.order.candidate(
            straight_motion(self.drilling.hole.depth, psi_t, slopes, periodic=self.periodic), branch
        )

    def cost_without(self, keep: Mask) -> float:
        """What it costs, at least, to leave out the joints that are not in a set."""
        return float(self.weights[np.logical_not(keep)].sum())
