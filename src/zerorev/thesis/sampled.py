"""The thesis' objective (eq. 4.7) of one hole, counted on samples of the path: what its swarm and its peers search by.

    f = N_rev / 6 * W_rev + theta_trv / (6 * 360 deg) * W_trv + B_jump + B_limit + B_fault

on each of the eight branches, of which the best counts. A pose out of reach costs 1, regardless of the rest of the
path. As in the thesis a motion whose turns are too many can cost as much as one that cannot be run: both are past all
hope.

Samples overlook a reversal between two of them, most of all in the first step next to the target, where least travel
leads; `zerorev.motion.evaluation.evaluate` locates it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, NamedTuple, Protocol, get_args

import numpy as np
import numpy.typing as npt

from zerorev.errors import InputError
from zerorev.kernels.sampled import judge
from zerorev.model._arrays import Array
from zerorev.model.profile import Profile
from zerorev.motion.drilling import Drilling
from zerorev.motion.evaluation import Evaluation, evaluated
from zerorev.thesis.threads import share_out

__all__ = [
    "FINAL_SAMPLES",
    "SAMPLES",
    "THESIS",
    "THESIS_MIN_RATE",
    "ExaminedAgain",
    "Judged",
    "MotionObjective",
    "SampledObjective",
    "Turns",
    "Weighing",
    "crowded_fractions",
    "even_fractions",
]

SAMPLES = 200  # steps on the whole path while searching (thesis sec. 4.2)
FINAL_SAMPLES = 40_000  # when the best is examined again
THESIS_MIN_RATE = float(np.deg2rad(10.0))
"""0.005 deg/step at 200 steps on 100 mm of path (thesis sec. 4.3) [rad/m]."""

Ints = npt.NDArray[np.int64]
Turns = Literal["after_extents", "first_point"]


class Judged(NamedTuple):
    """What many motions are worth, each on its best branch.

    Attributes:
        score: eq. 4.7, least is best, shape (M,).
        branch: 0..7, shape (M,).
        reversals: of all joints, shape (M,); -1 where no branch can run the motion.
    """

    score: Array
    branch: Ints
    reversals: Ints


class MotionObjective(Protocol):
    """What a search over three spins needs of an objective."""

    def judged(self, spins: Array) -> Judged:
        """Judge motions given by psi_start, psi_target and psi_end [rad], shape (M, 3)."""
        ...


@dataclass(frozen=True)
class Weighing:
    """What eq. 4.7 counts, and how much.

    Attributes:
        reversals: W_rev, the weight of six reversals.
        travel: W_trv, the weight of six full turns.
        min_rate: motion threshold [rad/m]: a joint that does not reverse and moves less per metre of path excludes the
            branch like the other conditions, +1 (thesis sec. 4.3: 0.005 deg/step, `THESIS_MIN_RATE`; theory §5); 0
            switches it off.
        min_rate_rule: `pointwise` (each step) or `mean` (each leg).
        turns: `after_extents` (those that bring the whole path within the limits) or `first_point` (those of the first
            point, which lies within +-180 deg, joint 6 within 0 to 360 deg; so the thesis has them, hence the missing
            block of its Fig. 26).
    """

    reversals: float = 6 / 7
    travel: float = 1 / 7
    min_rate: float = 0.0
    min_rate_rule: Literal["pointwise", "mean"] = "pointwise"
    turns: Turns = "after_extents"

    def __post_init__(self) -> None:
        """Check ranges and words."""
        for name in ("reversals", "travel", "min_rate"):
            if not 0 <= getattr(self, name) < np.inf:
                raise InputError(f"{getattr(self, name)!r} is out of range", where=f"weighing, {name}",
                                 accepted="0 or more")  # fmt: skip
        for name, known in (("min_rate_rule", ("pointwise", "mean")), ("turns", get_args(Turns))):
            if getattr(self, name) not in known:
                raise InputError(f"unknown {name} {getattr(self, name)!r}", where="weighing", accepted=", ".join(known))


THESIS = Weighing()
"""As the thesis has it, but for its motion threshold, which its own plans do not keep (theory §5)."""


@dataclass(frozen=True)
class ExaminedAgain:
    """The best motion of a search, examined closely on its branch.

    Attributes:
        score: eq. 4.7 on many samples.
        reversals: as so many samples see it; -1 where it cannot be run.
        exact: the evaluation of the continuous motion, whose reversals are located, turns chosen after the extents.
    """

    score: float
    reversals: int
    exact: Evaluation


def even_fractions(samples: int) -> Array:
    """Evenly spaced samples of a leg, 0 at the target to 1 at its outer end, for so many steps on the whole path.

    Raises:
        InputError: no even number of steps, two or more.
    """
    if not (isinstance(samples, int | np.integer) and samples >= 2 and samples % 2 == 0):
        raise InputError(f"{samples!r} steps", where="samples", accepted="an even number, 2 or more: half on each leg")
    return np.linspace(0.0, 1.0, samples // 2 + 1)


def crowded_fractions(samples: int) -> Array:
    """About as many samples of a leg that crowd at both of its ends, where joints turn round between even ones.

    The one nearest to an end is a millionth of the leg away from it.

    Args:
        samples: steps on the whole path, an even number; at least 8 are made.

    Raises:
        InputError: no even number of steps, two or more.
    """
    nearest = 1e-6
    half = np.concatenate([[0.0], np.geomspace(nearest, 0.5, max(2, (even_fractions(samples).size - 1) // 2))])
    return np.unique(np.concatenate([half, 1 - half]))


class SampledObjective:
    """Eq. 4.7 of one hole. The figures are the same on any number of threads.

    Attributes:
        fractions: samples of a leg, from 0 at the target to 1 at its outer end, shape (L + 1,).
        least: the motion threshold as the kernels take it, shape (L + 1,); see `kernels.sampled.judge`.
        evaluations: motions judged so far.
        first_zero: how many had been judged when the first without reversal was, itself among them; None: none yet.
    """

    def __init__(
        self,
        drilling: Drilling,
        weighing: Weighing = THESIS,
        *,
        samples: int = SAMPLES,
        fractions: Array | None = None,
        threads: int | None = None,
    ) -> None:
        """Prepare to judge motions.

        Args:
            drilling: robot, tool and hole; its branch, where it has one, is the only one examined.
            weighing: weights, motion threshold and choice of turns.
            samples: steps on the whole path, an even number.
            fractions: samples of a leg instead, from 0 at the target to 1 at its outer end, shape (L + 1,).
            threads: how many to use; None: one per core.

        Raises:
            InputError: no such samples, or no threads.
        """
        if threads is not None and threads < 1:
            raise InputError(f"{threads} threads", where="threads", accepted="1 or more, or None for one per core")
        self.drilling, self.weighing, self.threads = drilling, weighing, threads
        self.fractions = even_fractions(samples) if fractions is None else np.ascontiguousarray(fractions, dtype=float)
        _check_fractions(self.fractions)
        self.evaluations, self.first_zero = 0, None  # type: int, int | None
        self.least = np.zeros(self.fractions.size)
        leg = weighing.min_rate * drilling.hole.depth
        if weighing.min_rate_rule == "pointwise":
            # the kernel looks at the sine of a step
            self.least[:-1] = np.sin(np.minimum(leg * np.diff(self.fractions), np.pi / 2))[::-1]
        else:
            self.least[-1] = leg

    def __call__(self, spins: Array) -> Array:
        """Score of the best branch [1], least is best, shape (M,), of spins [rad] (start, target, end), (M, 3)."""
        return self.judged(spins).score

    def judged(self, spins: Array) -> Judged:
        """Score, branch and reversals of motions given by psi_start, psi_target and psi_end [rad], shape (M, 3)."""
        found = self._best(spins)
        if self.first_zero is None and (found.reversals == 0).any():
            self.first_zero = self.evaluations + int((found.reversals == 0).argmax()) + 1
        self.evaluations += len(found.score)
        return found

    def reversals(self, spins: Array) -> Ints:
        """Reversals of the best branch, shape (M,), -1 where none can run the motion; not counted as evaluations."""
        return self._best(spins).reversals

    def branches(self, spins: Array) -> Ints:
        """The best branch, shape (M,); not counted as evaluations."""
        return self._best(spins).branch

    def on_branches(self, spins: Array) -> tuple[Array, Ints]:
        """Score, and reversals (-1 where it cannot be run), of each branch, each (M, 8); not counted as evaluations.

        Args:
            spins: psi_start, psi_target and psi_end [rad], shape (M, 3).

        Raises:
            InputError: the last axis is not of three spins.
        """
        spins = np.ascontiguousarray(spins, dtype=float)
        if spins.ndim != 2 or spins.shape[1] != 3:
            raise InputError(f"spins of shape {spins.shape}", accepted="(M, 3): start, target, end")
        costs, reversals = np.empty((len(spins), 8)), np.empty((len(spins), 8), dtype=np.int64)
        weights, limits = self.weighing, self.drilling.limits

        def judge_some(part: slice) -> None:
            judge(
                self.drilling.robot.arm, self.drilling.plane, self.drilling.hole.depth, self.fractions, self.least,
                limits.lower, limits.upper,
                weights.turns == "first_point", (weights.reversals / 6, weights.travel / (12 * np.pi)), spins[part],
                costs[part], reversals[part],
            )  # fmt: skip

        share_out(judge_some, len(spins), self.threads)
        return costs, reversals

    def examine(self, spins: Array, branch: int, samples: int = FINAL_SAMPLES) -> ExaminedAgain:
        """One motion on many more samples, as the thesis checks its best (sec. 4.2), and exactly.

        Args:
            spins: psi_start, psi_target and psi_end [rad], shape (3,).
            branch: 0..7.
            samples: steps on the whole path, an even number.

        Raises:
            InputError: no such samples.
        """
        finer = SampledObjective(self.drilling, self.weighing, samples=samples)
        scores, reversals = finer.on_branches(np.asarray(spins)[None])
        profile = Profile.straight(self.drilling.hole.depth, *np.asarray(spins).tolist())
        exact = evaluated(self.drilling, profile, branch)
        return ExaminedAgain(float(scores[0, branch]), int(reversals[0, branch]), exact)

    def _best(self, spins: Array) -> Judged:
        costs, reversals = self.on_branches(spins)
        only = self.drilling.hole.branch
        branch = costs.argmin(axis=1) if only is None else np.full(len(costs), only)
        rows = np.arange(len(costs))
        return Judged(costs[rows, branch], branch, reversals[rows, branch])


def _check_fractions(fractions: Array) -> None:
    rising = fractions.ndim == 1 and fractions.size > 1 and (np.diff(fractions) > 0).all()
    if not (rising and fractions[0] == 0.0 and fractions[-1] == 1.0):
        raise InputError("the samples of a leg do not rise from 0 to 1", where="fractions",
                         accepted="rising numbers, 0 first, 1 last")  # fmt: skip
