"""Two plans of one part side by side, hole by hole: which motion is the better, and what only one of them drills."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from zerorev.model._arrays import Array
from zerorev.model.hole import Hole
from zerorev.model.plan import HolePlan, Plan
from zerorev.motion.drilling import Drilling
from zerorev.search.rank import Order

__all__ = ["Better", "Compared", "HolePair", "compared"]

Better = Literal["first", "second", "alike"]

ALIKE = 1e-6  # of what the settings ask to be least: motions that differ by a smaller share are alike
SAME_PLACE = 1e-5  # [m] in the part frame, by which one hole may differ in two plans
SAME_WAY = 1e-5  # of a direction, likewise


@dataclass(frozen=True)
class HolePair:
    """One hole in two plans.

    Attributes:
        first: its answer in the one.
        second: in the other.
        better: whose motion is; a motion is better than none.
        same_hole: whether both are of one place in the part frame, one direction and one depth.
    """

    first: HolePlan
    second: HolePlan
    better: Better
    same_hole: bool


@dataclass(frozen=True)
class Compared:
    """Two plans side by side.

    Attributes:
        first: the one.
        second: the other.
        pairs: the holes that both have, in the order of the first.
        only_first: answers of holes that the second has not.
        only_second: answers of holes that the first has not.
    """

    first: Plan
    second: Plan
    pairs: tuple[HolePair, ...]
    only_first: tuple[HolePlan, ...]
    only_second: tuple[HolePlan, ...]

    @cached_property
    def drilled(self) -> tuple[HolePair, ...]:
        """The pairs of which both have a motion."""
        return tuple(pair for pair in self.pairs if pair.first.score is not None and pair.second.score is not None)

    @cached_property
    def reversals(self) -> tuple[int, int]:
        """Of the holes that both drill."""
        first, second = (sum(each.score.reversals for each in side if each.score) for side in self._sides)
        return first, second

    @cached_property
    def travel(self) -> tuple[float, float]:
        """Of all joints over the holes that both drill [rad]."""
        first, second = (sum(each.score.travel for each in side if each.score) for side in self._sides)
        return first, second

    @cached_property
    def infeasible(self) -> tuple[int, int]:
        """How many of the holes that both have are without a motion in each."""
        first = sum(pair.first.score is None for pair in self.pairs)
        return first, sum(pair.second.score is None for pair in self.pairs)

    @cached_property
    def better(self) -> Better:
        """Which of the two: more of the common holes drilled, then fewer reversals, then less travel at those."""
        for one, other in (self.infeasible, self.reversals):
            if one != other:
                return "first" if one < other else "second"
        one_way, other_way = self.travel
        if abs(one_way - other_way) <= ALIKE * max(one_way, other_way):
            return "alike"
        return "first" if one_way < other_way else "second"

    @property
    def _sides(self) -> tuple[list[HolePlan], list[HolePlan]]:
        return [pair.first for pair in self.drilled], [pair.second for pair in self.drilled]


def compared(first: Plan, second: Plan) -> Compared:
    """Set two plans side by side; a hole of the same id is the same hole of the part.

    Motions are compared in the one order of motions, by the settings of the first plan; of two files of deepest strokes
    the deeper stroke is the better.

    Args:
        first: the one.
        second: the other.
    """
    others = {hole.hole.id: hole for hole in second.holes}
    pairs = tuple(_pair(first, hole, second, others[hole.hole.id]) for hole in first.holes if hole.hole.id in others)
    ids = {hole.hole.id for hole in first.holes}
    only_first = tuple(hole for hole in first.holes if hole.hole.id not in others)
    return Compared(first, second, pairs, only_first, tuple(hole for hole in second.holes if hole.hole.id not in ids))


def _pair(first: Plan, one: HolePlan, second: Plan, other: HolePlan) -> HolePair:
    deep = first.strokes == second.strokes == "deepest"
    same = _same(first, one.hole, second, other.hole) and (deep or abs(one.hole.depth - other.hole.depth) <= SAME_PLACE)
    if one.motion is None or other.motion is None:
        lacking = (one.motion is None, other.motion is None)
        better: Better = "alike" if all(lacking) else ("second" if lacking[0] else "first")
        return HolePair(one, other, better, same)
    cost_one, cost_other = (_cost(first, plan, hole, deep=deep) for plan, hole in ((first, one), (second, other)))
    return HolePair(one, other, _better(cost_one, cost_other), same)


def _same(first: Plan, one: Hole, second: Plan, other: Hole) -> bool:
    """Whether two holes have one place and one direction in the part frame."""

    def in_part(plan: Plan, hole: Hole) -> tuple[Array, Array]:
        R, origin = plan.T_base_part[:3, :3], plan.T_base_part[:3, 3]
        return (hole.target - origin) @ R, hole.direction @ R

    (place, way), (there, along) = in_part(first, one), in_part(second, other)
    return bool(np.linalg.norm(place - there) <= SAME_PLACE and np.linalg.norm(way - along) <= SAME_WAY)


def _cost(first: Plan, plan: Plan, hole: HolePlan, *, deep: bool) -> tuple[float, ...]:
    """What a motion is compared by; the least is the best."""
    assert hole.motion is not None
    order = Order(Drilling(plan.robot, plan.tool, hole.hole), first.settings)
    candidate = order.candidate(hole.motion.profile, hole.motion.branch)
    if candidate is None:  # it cannot be run, though the file states it
        return (np.inf,)
    rank = order.rank(candidate)
    deepest = (-round(hole.hole.depth / SAME_PLACE),) if deep else ()
    return (*deepest, rank.reversals, rank.lack, rank.cost)


def _better(one: tuple[float, ...], other: tuple[float, ...]) -> Better:
    for a, b in zip(one, other, strict=False):
        if abs(a - b) > ALIKE * max(abs(a), abs(b)) if np.isfinite(a + b) else a != b:
            return "first" if a < b else "second"
    return "alike"
