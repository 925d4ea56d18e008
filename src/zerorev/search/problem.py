"""What the exact search is asked: one hole, what its legs are held to, and which motion is better than another."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from zerorev.evaluation import Evaluation, evaluate, meets_threshold
from zerorev.kernels import legs
from zerorev.kinematics import TwistPlane, twist_plane
from zerorev.model._arrays import Array
from zerorev.model.hole import Hole
from zerorev.model.job import Settings
from zerorev.model.plan import Score
from zerorev.model.profile import Profile
from zerorev.model.robot import Robot
from zerorev.model.tool import Tool
from zerorev.search.straight import GRID, LEAST_RATE, LIMIT_SLACK, LONGEST_TWIST, straight_motion, target_spins

__all__ = ["SAME_COST", "Asked", "Found", "Mask", "Problem"]

Mask = npt.NDArray[np.bool_]

SAME_COST = 1e-9  # weighted counts of reversals that differ by less are one


class Asked(NamedTuple):
    """What a leg is held to; a NamedTuple, so that kernels take it whole. SI units."""

    depth: float
    min_rate: float
    mean_rule: bool
    turn_inside: bool
    lower: Array
    upper: Array
    steepest: float
    psi_bound: float  # 0: periodic

    def unlimited(self) -> Asked:
        """The same without joint limits."""
        return self._replace(lower=np.full(6, -np.inf), upper=np.full(6, np.inf))


@dataclass(frozen=True)
class Found:
    """The best motion that the search found.

    Attributes:
        profile: two straight legs.
        branch: 0..7.
        evaluation: what the motion does to the joints.
        keeps_threshold: whether the motion threshold is met.
    """

    profile: Profile
    branch: int
    evaluation: Evaluation
    keeps_threshold: bool

    @property
    def score(self) -> Score:
        """What the motion does to the joints."""
        assert self.evaluation.score is not None
        return self.evaluation.score

    @property
    def reversals(self) -> int:
        """Count of direction changes over all joints."""
        return self.score.reversals


@dataclass(frozen=True)
class Problem:
    """One hole.

    Attributes:
        robot: the arm.
        tool: the drill.
        hole: what is drilled; its `branch`, if any, is the only one searched.
        settings: threshold, bound on the spin, objective, weights of the joints.
    """

    robot: Robot
    tool: Tool
    hole: Hole
    settings: Settings

    @cached_property
    def plane(self) -> TwistPlane:
        """The hole's twist plane."""
        return twist_plane(self.robot, self.tool, self.hole)

    @cached_property
    def psi(self) -> Array:
        """The spins at the target that are looked at first [rad], shape (K,)."""
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
        return list(range(8)) if self.hole.branch is None else [self.hole.branch]

    def asked(self, min_rate: float, *, mean_rule: bool = False, turn_inside: bool = False) -> Asked:
        """What the legs are held to."""
        limits = self.robot.limits
        return Asked(
            self.hole.depth,
            max(min_rate, LEAST_RATE),
            mean_rule,
            turn_inside,
            limits.lower + LIMIT_SLACK,
            limits.upper - LIMIT_SLACK,
            LONGEST_TWIST / self.hole.depth,
            self.settings.psi_bound or 0.0,
        )

    def objective(self, *, turn_inside: bool = False) -> tuple[Asked, int]:
        """What the settings ask of the legs, and what makes one better than another."""
        settings = self.settings
        mode = {
            "travel": legs.TRAVEL,
            "margin": legs.GREATEST_MARGIN,
            "plunge_rotation": legs.PLUNGE_ROTATION,
        }[settings.objective]
        mean_rule = settings.min_rate_rule == "mean"
        return self.asked(settings.min_rate, mean_rule=mean_rule, turn_inside=turn_inside), mode

    def found(self, branch: int, psi_t: float, slopes: tuple[float, float]) -> Found | None:
        """The motion of two legs out of one spin at the target, evaluated; None where it cannot be run."""
        profile = straight_motion(self.hole.depth, psi_t, slopes, periodic=self.periodic)
        evaluation = evaluate(self.robot, self.tool, self.hole, profile, branch, self.settings)
        if evaluation.score is None:
            return None
        return Found(profile, branch, evaluation, meets_threshold(evaluation.score, self.settings))

    def cost(self, found: Found) -> float:
        """Weighted count of reversals of what was found."""
        return float(np.dot(self.weights, found.score.reversals_per_joint))

    def cost_without(self, keep: Mask) -> float:
        """What it costs, at least, to leave out the joints that are not in a set."""
        return float(self.weights[np.logical_not(keep)].sum())

    def rank(self, found: Found) -> tuple[float, float, float]:
        """The order of plans: fewest reversals, then the motion threshold, then the objective; least is best."""
        settings, score = self.settings, found.score
        rates = score.min_rate if settings.min_rate_rule == "pointwise" else score.mean_rate
        margin = float(rates[np.array(score.reversals_per_joint) == 0].min(initial=np.inf))
        lack = 0.0 if found.keeps_threshold else settings.min_rate - margin
        start, target, _ = found.profile.psi
        value = {"travel": score.travel, "margin": -margin, "plunge_rotation": abs(target - start)}
        return round(self.cost(found), 9), lack, value[settings.objective]
