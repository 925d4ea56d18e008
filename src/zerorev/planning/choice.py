"""Which of its members each hole of a job takes, and in which order the holes are drilled.

Chosen are the members with the fewest changes of the arm's posture from hole to hole and then the least time between
holes, such that all holes together travel at most `posture_freedom` more than the least: for one order exactly, by a
shortest path through layers (`kernels.tour.chain`) and a bisection of what travel weighs. Orders are improved by
annealing, which proves nothing.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
from scipy.spatial import cKDTree

from zerorev.kernels import tour
from zerorev.model._arrays import Array
from zerorev.model.hole import Hole
from zerorev.model.job import Job, Settings
from zerorev.model.plan import HolePlan
from zerorev.model.profile import Profile
from zerorev.program.between import accelerations

__all__ = ["Member", "Offer", "chosen"]

Whole = npt.NDArray[np.int64]
SEED = 1  # of the annealing
CHANGE = 1e3  # [s] what a change of posture weighs for the members of an order: more than any time between two holes
CHANGE_ANNEALED = 5.0  # [s] the same while orders are tried
HOT, COLD = 0.03, 0.0003  # [s]
STEPS_A_HOLE, FEWEST_STEPS, MOST_STEPS = 3_000, 200_000, 10_000_000
NEAR = 10  # holes that may well follow one
LEAST_WEIGHT, MOST_WEIGHT, WEIGHINGS = 1e-3, 1e7, 40  # [s/rad] of travel, and how often it is bisected
ROUNDING = 1e-9  # [rad]


@dataclass(frozen=True)
class Member:
    """One motion that a hole may take.

    Attributes:
        profile: the spin along the path.
        branch: 0..7.
        joints: at the breakpoints, with turns [rad], shape (n, 6).
        start: where the move to it ends, or its safe height is [rad], shape (6,).
        end: where the move away begins, likewise.
        travel: sum over the joints of the angle moved [rad].
        time: from the safe height and to it [s].
        answer: of a hole that is drilled in several strokes; of others the motion is enough.
    """

    profile: Profile
    branch: int
    joints: Array
    start: Array
    end: Array
    travel: float
    time: float
    answer: HolePlan | None = None

    def turned(self, turns: Array) -> Member:
        """The same with whole turns of the axes added [rad], shape (6,)."""
        return replace(self, joints=self.joints + turns, start=self.start + turns, end=self.end + turns)


Offer = tuple[Member, ...]
"""The members of a hole, the one that was planned first; empty: it has no motion."""


def chosen(job: Job, offers: Sequence[Offer]) -> tuple[list[int], dict[int, Member]]:
    """The order of the holes that have a motion, by number, and the member of each."""
    settings, limits = job.settings, job.robot.limits
    able = [n for n, offer in enumerate(offers) if offer]
    if not able:
        return [], {}
    counts = [len(offers[n]) for n in able]
    flat = [member for n in able for member in offers[n]]
    travel = np.array([member.travel for member in flat])
    times = np.array([member.time for member in flat])
    home = np.empty((0, 6)) if settings.home_joints is None else np.array([settings.home_joints])
    asked = tour.Members(
        first=np.concatenate([[0], np.cumsum(counts)]).astype(np.int64),
        start=np.array([member.start for member in flat]),
        end=np.array([member.end for member in flat]),
        branch=np.array([member.branch for member in flat], dtype=np.int64),
        own=times,
        speed=limits.speed,
        acceleration=accelerations(limits),
        change=CHANGE,
        home=home,
    )
    # of the planned motions: where another objective decides, others may travel less
    least = sum(offers[n][0].travel for n in able)
    budget = (1 + settings.posture_freedom) * least + ROUNDING
    order, block = _blocks(settings, [job.holes[n] for n in able])
    choice, weight = _within(asked, order, travel, budget)
    if settings.order != "listed" and len(able) > 2:
        order, choice = _improved(asked, order, choice, block, times + weight * travel)
        choice, _ = _within(asked, order, travel, budget)
    numbers = [able[k] for k in order.tolist()]
    return numbers, {n: flat[m] for n, m in zip(numbers, choice.tolist(), strict=True)}


def _blocks(settings: Settings, holes: Sequence[Hole]) -> tuple[Whole, Whole]:
    """The order to begin with, and for each place of it the first and last place that its hole may take, (N, 2)."""
    count = len(holes)
    if settings.order != "groups":
        return np.arange(count), np.tile([0, count - 1], (count, 1))
    names = list(dict.fromkeys(hole.group for hole in holes))
    groups = [[n for n, hole in enumerate(holes) if hole.group == name] for name in names]
    ends = np.cumsum([len(group) for group in groups])
    block = [(end - len(group), end - 1) for group, end in zip(groups, ends.tolist(), strict=True) for _ in group]
    return np.array([n for group in groups for n in group]), np.array(block)


def _within(asked: tour.Members, order: Whole, travel: Array, budget: float) -> tuple[Whole, float]:
    """The best members of an order that travel no more than the budget, and what travel has to weigh for that [s/rad].

    Of the weights that keep the budget it is the least one found; another choice within the budget, which is the best
    for no weight, may still be better.
    """
    choice = np.empty(order.size, dtype=np.int64)

    def fits(weight: float) -> bool:
        tour.chain(asked._replace(own=asked.own + weight * travel), order, choice)
        return bool(travel[choice].sum() <= budget)

    if fits(0.0):
        return choice.copy(), 0.0
    low, high = np.log(LEAST_WEIGHT), np.log(MOST_WEIGHT)
    fits(float(np.exp(high)))
    kept, kept_weight = choice.copy(), float(np.exp(high))
    for _ in range(WEIGHINGS):
        middle = (low + high) / 2
        if fits(float(np.exp(middle))):
            high, kept, kept_weight = middle, choice.copy(), float(np.exp(middle))
        else:
            low = middle
    return kept, kept_weight


def _improved(asked: tour.Members, order: Whole, choice: Whole, block: Whole, own: Array) -> tuple[Whole, Whole]:
    """A better order and its members, by annealing."""
    order, choice = order.copy(), choice.copy()
    count = order.size
    middles = np.empty((count, 6))
    middles[order] = (asked.start[choice] + asked.end[choice]) / 2 / asked.speed
    near = cKDTree(middles).query(middles, min(NEAR + 1, count))[1][:, 1:].astype(np.int64)
    steps = int(np.clip(STEPS_A_HOLE * count, FEWEST_STEPS, MOST_STEPS))
    tour.anneal(
        asked._replace(change=CHANGE_ANNEALED, own=own), np.ascontiguousarray(near), block, order, choice, steps,
        HOT, COLD, SEED,
    )  # fmt: skip
    return order, choice
