"""The one order of motions, and the one noun for a motion that was found (theory §3.1).

Every search, the plan, the maps and the app compare motions here and nowhere else, so that no two of them can disagree:
fewest reversals (weighted), then the motion threshold, then the objective, then what tells equal motions apart.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from zerorev.model.job import Settings
from zerorev.model.plan import Score
from zerorev.model.profile import Profile
from zerorev.motion.criteria import measure, objective_of
from zerorev.motion.drilling import Drilling
from zerorev.motion.evaluation import Evaluation, evaluated, meets_threshold, steady_rates

__all__ = ["SAME_COST", "Candidate", "Order", "Rank"]

SAME_COST = 1e-9  # weighted counts of reversals that differ by less are one
DIGITS = 9  # to which they are rounded, accordingly
LACK_DIGITS = 5  # of the motion threshold: margins below it that are alike so far are one, and the cost decides


@dataclass(frozen=True)
class Candidate:
    """A motion that can be run, and what it does to the joints.

    Attributes:
        profile: the spin along the path.
        branch: 0..7.
        evaluation: of this motion, with a score.
        keeps_threshold: whether every joint that does not reverse keeps the motion threshold.
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

    @property
    def depth(self) -> float:
        """Stand-off at which it begins [m]."""
        return float(self.profile.standoff[0])

    @property
    def psi_target(self) -> float:
        """Spin at the corner [rad]."""
        return float(self.profile.psi[self.profile.corner])


class Rank(NamedTuple):
    """What motions are compared by, the first difference deciding; the least is the best.

    Attributes:
        reversals: weighted count.
        lack: by how much the slowest joint is below the motion threshold [rad/m], rounded; 0 where it is kept.
        cost: what the settings ask to be least.
        plunge_rotation: angle that the tool is spun through while it cuts [rad]: of two twins the one that spins less.
        branch: 0..7.
        psi_target: spin at the corner [rad].
    """

    reversals: float
    lack: float
    cost: float
    plunge_rotation: float
    branch: int
    psi_target: float


@dataclass(frozen=True)
class Order:
    """Which motion of a hole is better.

    Attributes:
        drilling: robot, tool and hole.
        settings: weights of the joints, motion threshold, and the objective or the weights of the criteria.
    """

    drilling: Drilling
    settings: Settings

    def candidate(self, profile: Profile, branch: int) -> Candidate | None:
        """A motion of the hole, evaluated; None where it cannot be run.

        Args:
            profile: the spin along the path.
            branch: 0..7.
        """
        return self.judged(profile, branch, evaluated(self.drilling, profile, branch, self.settings))

    def judged(self, profile: Profile, branch: int, evaluation: Evaluation) -> Candidate | None:
        """A motion that was evaluated already; None where it cannot be run."""
        if evaluation.score is None:
            return None
        return Candidate(profile, branch, evaluation, meets_threshold(evaluation.score, self.settings))

    def reversals(self, candidate: Candidate) -> float:
        """Weighted count of reversals."""
        return float(np.dot(self.settings.reversal_weights, candidate.score.reversals_per_joint))

    def lack(self, candidate: Candidate) -> float:
        """By how much the slowest joint is below the motion threshold [rad/m], rounded; 0 where it is kept."""
        if candidate.keeps_threshold:
            return 0.0
        threshold = self.settings.min_rate
        return threshold * max(round(1.0 - self.margin(candidate) / threshold, LACK_DIGITS), 10.0**-LACK_DIGITS)

    def rank(self, candidate: Candidate) -> Rank:
        """What a motion is compared by."""
        return Rank(
            round(self.reversals(candidate), DIGITS),
            self.lack(candidate),
            self._cost(candidate),
            _plunge_rotation(candidate),
            candidate.branch,
            candidate.psi_target,
        )

    def best(self, candidates: Iterable[Candidate | None]) -> Candidate | None:
        """The best of several motions of the hole; None where there is none."""
        return min((one for one in candidates if one is not None), key=self.rank, default=None)

    def margin(self, candidate: Candidate) -> float:
        """Rate of the slowest joint that does not reverse [rad/m]; 0 where all reverse."""
        steady = steady_rates(candidate.score, self.settings)
        return float(steady.min()) if steady.size else 0.0

    def _cost(self, candidate: Candidate) -> float:
        if self.settings.weights:
            measures = measure(self.drilling, candidate.evaluation, self.settings)
            return objective_of(self.settings)(measures)
        match self.settings.objective:  # a single criterion orders motions as its own figure does
            case "travel":
                return candidate.score.travel
            case "margin":
                return -self.margin(candidate)
            case "plunge_rotation":
                return _plunge_rotation(candidate)


def _plunge_rotation(candidate: Candidate) -> float:
    profile = candidate.profile
    return float(np.abs(np.diff(profile.psi[: profile.corner + 1])).sum())
