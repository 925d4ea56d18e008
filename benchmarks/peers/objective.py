"""The thesis' objective (eq. 4.7) of many motions at once: zerorev's own, and an independent twin in plain NumPy.

    f = 6/7 * reversals / 6 + 1/7 * travel / (6 * 360 deg) + jump + limit + fault

counted on the steps between N samples, on each of the eight branches; the best branch counts. Turns are chosen after
the extents of the whole path are known. A path with a pose out of reach costs 1, regardless of the rest of it.
"""

from __future__ import annotations

import numpy as np

from benchmarks.arm_numpy import inverse, wrapped
from benchmarks.cases import Answer, Case
from zerorev.model._arrays import Array
from zerorev.model.profile import Profile
from zerorev.motion.drilling import Drilling
from zerorev.motion.kinematics import tcp_pose
from zerorev.thesis.sampled import SAMPLES, Judged, SampledObjective, crowded_fractions, even_fractions

__all__ = ["NumbaObjective", "NumpyObjective", "Objective", "graded"]

STILL = 1e-12  # [rad] a step that is none
JUMP = 0.5  # [rad] a step that no drilling motion makes
HALF_TURNS = np.array([0.0, 0.0, 0.0, np.pi, 0.0, np.pi])  # from one wrist flip to the other, but for A5


def graded() -> Array:
    """Samples of a leg that crowd at both of its ends, as fractions of it: where joints come to rest without notice.

    Evenly spread samples overlook a reversal in the first step next to the target, and a swarm settles there.
    """
    return crowded_fractions(SAMPLES)


class Objective:
    """Eq. 4.7 of one hole. `evaluations` counts the motions examined."""

    def __init__(self, case: Case, fractions: Array | None = None) -> None:
        self.case, self.evaluations = case, 0
        self.fractions = even_fractions(SAMPLES) if fractions is None else fractions

    def __call__(self, spins: Array) -> Array:
        """Cost of motions given by (psi_start, psi_target, psi_end) [rad], shape (P, 3); returns (P,)."""
        return self.judged(spins).score

    def judged(self, spins: Array) -> Judged:
        """Cost, branch and reversals of the same motions, as zerorev's swarm asks for them."""
        self.evaluations += len(spins)
        costs = self.costs(spins)
        least = costs.min(axis=1)
        return Judged(least, costs.argmin(axis=1), (7 * least).astype(np.int64))

    def answer(self, spins: Array) -> Answer:
        """One motion, shape (3,), on its best branch."""
        profile = Profile.straight(self.case.hole.depth, *spins.tolist())
        return Answer(profile, int(self.costs(spins[None])[0].argmin()))

    def reversals(self, answer: Answer) -> int:
        """Reversals of an answer, as the objective itself counts them; more than it has where it cannot be run."""
        return int(7 * self.costs(answer.profile.psi[None])[0, answer.branch])

    def costs(self, spins: Array) -> Array:
        """Cost on each branch, shape (P, 8)."""
        raise NotImplementedError


class NumbaObjective(Objective):
    """The product's own, on one thread."""

    def __init__(self, case: Case, fractions: Array | None = None) -> None:
        super().__init__(case, fractions)
        self.sampled = SampledObjective(Drilling(case.robot, case.tool, case.hole), fractions=self.fractions, threads=1)

    def costs(self, spins: Array) -> Array:
        """Cost on each branch."""
        return self.sampled.on_branches(spins)[0]


class NumpyObjective(Objective):
    """Vectorised over motions, samples and branches, inverse kinematics included."""

    def costs(self, spins: Array) -> Array:
        """Cost on each branch."""
        cost, low, high = self._postures(np.asarray(spins, dtype=float))
        limits = self.case.robot.limits
        # the other wrist flip makes the same steps, but for the sign of A5's: it differs in limits alone
        flipped_low, flipped_high = low + HALF_TURNS, high + HALF_TURNS
        flipped_low[..., 4], flipped_high[..., 4] = -high[..., 4], -low[..., 4]
        low, high = np.stack([low, flipped_low], axis=2), np.stack([high, flipped_high], axis=2)
        first, last = np.ceil((limits.lower - low) / (2 * np.pi)), np.floor((limits.upper - high) / (2 * np.pi))
        return np.asarray((cost[..., None] + (first > last).any(axis=-1)).reshape(-1, 8))

    def _postures(self, spins: Array) -> tuple[Array, Array, Array]:
        """Cost but for limits, shape (P, 4), and the joints' extents with A5 >= 0, each (P, 4, 6), NaN at a fault."""
        x = self.fractions
        start, target, end = (spins[:, i, None] for i in range(3))
        psi = np.concatenate([target + x[::-1] * (start - target), (target + x * (end - target))[:, 1:]], axis=1)
        standoff = self.case.hole.depth * np.concatenate([x[::-1], x[1:]])
        T = tcp_pose(self.case.hole, standoff, psi) @ np.linalg.inv(self.case.tool.T_flange_tcp)
        joints = inverse(self.case.robot.arm, T, (0, 2, 4, 6))  # (P, N, 4, 6)
        steps = wrapped(np.diff(joints, axis=1))
        path = np.concatenate([joints[:, :1], joints[:, :1] + np.cumsum(steps, axis=1)], axis=1)
        size = np.abs(steps)
        jump = (size > JUMP).any(axis=(1, 3))
        cost = _reversals(steps) / 7 + size.sum(axis=(1, 3)) / (84 * np.pi) + jump
        return np.where(np.isnan(cost), 1.0, cost), path.min(axis=1), path.max(axis=1)


def _reversals(steps: Array) -> Array:
    """Changes of sign along axis 1, zeros passed over, summed over the last; shape (P, N, K, 6) -> (P, K)."""
    signs = np.where(np.abs(steps) > STILL, np.sign(steps), 0.0)
    if (signs == 0).any():  # a joint that stands still keeps the direction it had
        place = np.arange(signs.shape[1])[None, :, None, None]
        last = np.maximum.accumulate(np.where(signs != 0, place, 0), axis=1)
        signs = np.take_along_axis(signs, last, axis=1)
    return np.asarray((signs[:, 1:] * signs[:, :-1] < 0).sum(axis=(1, 3)))
