"""The best motion that keeps clear of what stands around the arm.

Whether a leg keeps clear does not depend on the other leg, and is decided exactly: proven, or hit at a pose. So it is
one more thing that a leg is held to, and what is found lies on an obstacle as it may lie on a limit: at every spin of a
grid the admissible slopes are located, ends of their intervals to the last bits, all pairs of legs compared, and the
best few points zoomed in on (`weighted`). First the motions without a reversal, then those below the motion threshold,
then those with reversals, around the best of which no joint turns otherwise.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import ClassVar, NamedTuple

import numpy as np

from zerorev.collision.arms import Setting, setting_of
from zerorev.collision.motions import hit_of
from zerorev.collision.near import MOST_OF_A_LEG, Nearest, legs_lack
from zerorev.model._arrays import Array
from zerorev.model.measures import CRITERIA
from zerorev.model.settings import Settings
from zerorev.motion.drilling import Drilling
from zerorev.search.leg_pairs import FINE_NODES, Counts, Mask, Point, Sides
from zerorev.search.problem import Problem
from zerorev.search.rank import Candidate, Order
from zerorev.search.survey import survey
from zerorev.search.weighted import VALLEYS, WeightedLegs, apart

__all__ = ["Cleared", "clear_of", "keeps_clear"]

FINALISTS = 4  # points that are zoomed in on finely, at most
WORTH_A_ZOOM = 0.1  # relative: a point of the grid this much above the best one may still lie below it
SAME = 1e-3  # relative: a point this much above the best one is not finished, once that is
WITHIN = np.array([0.25, 0.5, 0.75])  # of the way from one spin of the grid to the next
FIRST_SPINS = 32  # of all postures, that are surveyed before more are
PIECES = 300  # of a leg, that are examined until the best points are zoomed in on finely
MOST_TRIED = 600  # motions of the grid with reversals that are tried
SEEDS = 3  # of those that keep clear, that are improved


class Cleared(NamedTuple):
    """What is left of some motions among obstacles.

    Attributes:
        motions: that keep clear, the one to be preferred first; empty: none was found, or there was none to begin with.
        hit: what the best motion would have met, where it is not among them.
    """

    motions: tuple[Candidate, ...]
    hit: Nearest | None = None


def clear_of(drilling: Drilling, settings: Settings, best: Sequence[Candidate]) -> Cleared:
    """The best motions that keep clear of what stands around; the same ones, where nothing is known to.

    Args:
        drilling: what is drilled.
        settings: how, with what stands around.
        best: motions that cost the same, found regardless of it, the one to be preferred first.
    """
    setting = setting_of(drilling.robot, drilling.tool, settings)
    if setting is None or not best:
        return Cleared(tuple(best))
    hits = [hit_of(setting, drilling, settings, one.profile, one.branch) for one in best]
    clear = tuple(one for one, hit in zip(best, hits, strict=True) if hit is None)
    if clear:
        return Cleared(clear)
    found = _Search(drilling.without_motion(), settings, setting).best()
    return Cleared(() if found is None else (found,), hits[0])


def keeps_clear(drilling: Drilling, settings: Settings, motion: Candidate) -> bool:
    """Whether a motion keeps clear of what stands around, as far as anything is known to.

    Args:
        drilling: what is drilled.
        settings: with what stands around, and the clearance.
        motion: of the hole.
    """
    setting = setting_of(drilling.robot, drilling.tool, settings)
    return setting is None or hit_of(setting, drilling, settings, motion.profile, motion.branch) is None


@dataclass(frozen=True)
class _ClearLegs(WeightedLegs):
    """Pairs of legs that keep clear, too."""

    setting: Setting
    bisections: ClassVar[tuple[int, int]] = (8, 8)  # the windows shrink, and each leg costs

    def slack(self, sides: Sides, row: Counts, slope: Array, least: float, nodes: int) -> Array:
        """As `LegPairs.slack`; a leg that keeps all else but does not keep clear lacks by that."""
        spare = super().slack(sides, row, slope, least, nodes)
        able, most = np.flatnonzero(spare >= 0), MOST_OF_A_LEG if nodes == FINE_NODES else PIECES
        lack = legs_lack(self.setting, self.drilling, sides.branch, sides.psi_t[row[able]], slope[able], most)
        spare[able] = np.where(lack > 0, -lack, spare[able])
        return spare

    def survey(self) -> list[Point]:
        """As `WeightedLegs.survey`, the spins with the best free pairs first, until no other is worth a zoom.

        No pair is better among obstacles than without: what the best free pair of a spin costs bounds what can be found
        there, as closely as the grid of that survey sees it.
        """
        free = self._free_costs()
        order, begin, size, best = np.argsort(free, axis=None, kind="stable"), 0, FIRST_SPINS, np.inf
        found: list[Point] = []
        while begin < order.size and not free.flat[order[begin]] > best + WORTH_A_ZOOM * abs(best):
            chosen = np.zeros(free.shape, dtype=np.bool_)
            chosen.flat[order[begin : begin + size]] = True
            for posture in np.flatnonzero(chosen.any(axis=1)).tolist():
                found += self.surveyed(posture, self.spins[chosen[posture]])
            best = min((point.cost for point in found), default=np.inf)
            begin, size = begin + size, 2 * size
        promising = np.isfinite(free) & (free <= best + WORTH_A_ZOOM * abs(best))
        return sorted([*self.valleys(found), *self._between(found, promising)])[:VALLEYS]

    def _between(self, found: list[Point], promising: Mask) -> Iterator[Point]:
        """The best pairs between two spins of the grid that have none, one of which is promising.

        What an obstacle leaves of an interval of spins may be narrower than the grid.

        Args:
            found: pairs at spins of the grid.
            promising: which spins of which postures, shape (4, K).
        """
        none = np.ones(promising.shape, dtype=np.bool_)
        for point in found:
            none[point.branch // 2, np.searchsorted(self.spins, point.psi_t)] = False
        wanted = none & np.roll(none, -1, axis=1) & (promising | np.roll(promising, -1, axis=1))
        if self.settings.psi_bound is not None:
            wanted[:, -1] = False
        step = float(self.spins[1] - self.spins[0])
        for posture in np.flatnonzero(wanted.any(axis=1)).tolist():
            yield from self.surveyed(posture, np.add.outer(self.spins[wanted[posture]], step * WITHIN).ravel())

    def _free_costs(self) -> Array:
        """What the best pair at each spin costs without obstacles, shape (4, K), of either wrist flip; inf: none."""
        if self.settings.weights:
            return np.zeros((4, self.spins.size))
        pairs = survey(Problem(self.drilling, self.settings))
        criterion = CRITERIA[self.settings.objective]
        cost = criterion.cost_of(-pairs[..., 2] if criterion.more_is_better else pairs[..., 2])
        return np.asarray(np.where(pairs[..., 0] == 0, cost, np.inf).reshape(4, 2, -1).min(axis=1))


@dataclass(frozen=True)
class _Search:
    """One hole among obstacles.

    Attributes:
        drilling: what is drilled.
        settings: how.
        setting: what stands around.
    """

    drilling: Drilling
    settings: Settings
    setting: Setting

    def best(self) -> Candidate | None:
        """The best motion that was found to keep clear; None where none was."""
        order = Order(self.drilling, self.settings)
        for found in self._stages():
            if found:
                return min(found, key=order.rank)
        return None

    def _clear(self, one: Candidate) -> bool:
        return hit_of(self.setting, self.drilling, self.settings, one.profile, one.branch) is None

    def _stages(self) -> Iterator[list[Candidate]]:
        """Motions that keep clear, of ever worse kinds: without a reversal; below the threshold; with reversals."""
        yield self._without_reversal(self.settings)
        if self.settings.min_rate > 0:
            yield self._without_reversal(replace(self.settings, min_rate=0.0, objective="margin", weights=()))
        yield self._with_reversals()

    def _without_reversal(self, settings: Settings) -> list[Candidate]:
        legs = _ClearLegs(self.drilling, settings, self.setting)
        return self._improved(legs, legs.survey(), settings.min_rate)

    def _improved(self, legs: _ClearLegs, seeds: list[Point], least: float) -> list[Candidate]:
        """The motions of the best points around some others, as the settings judge them."""
        points: list[Point] = []
        for seed in apart(seeds):
            if points and seed.cost > min(points).cost + WORTH_A_ZOOM * abs(min(points).cost):
                break
            points.append(legs.zoomed(seed, least, fine=False))
        order, found = Order(self.drilling, self.settings), list[Candidate]()
        for point in apart(points)[:FINALISTS]:
            best = min(points).cost
            if not np.isfinite(point.cost) or (found and point.cost > best + SAME * abs(best)):
                continue
            polished = legs.polished(point)
            one = None if polished is None else order.candidate(polished.profile, polished.branch)
            if one is not None and self._clear(one):
                found.append(one)
        return found

    def _with_reversals(self) -> list[Candidate]:
        """Of the best pairs at each spin of a grid those that keep clear, and what is around them."""
        problem = Problem(self.drilling, self.settings)
        pairs = survey(problem)
        branch, n = np.nonzero(np.isfinite(pairs[..., 0]))
        ranked = np.lexsort((pairs[branch, n, 2], pairs[branch, n, 1], pairs[branch, n, 0]))
        found: list[Candidate] = []
        for k in ranked[:MOST_TRIED]:
            row = pairs[branch[k], n[k]]
            one = problem.found(int(branch[k]), float(problem.psi[n[k]]), (float(row[3]), float(row[4])))
            if one is not None and self._clear(one):
                found.append(one)
            if len(found) == SEEDS:
                break
        legs = _ClearLegs(self.drilling, self.settings, self.setting)
        return [*found, *self._improved(legs, [legs.point(one) for one in found], self.settings.min_rate)]
