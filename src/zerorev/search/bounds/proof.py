"""What no motion of straight legs can beat, and the better motion where there is one (theory §3).

Two runs of branch and bound answer it. The first leaves the motion threshold out and asks for fewer reversals than the
best motion has; with none left, so many are the fewest. The second keeps the threshold and asks for less travel. A
better motion that is found on the way takes the best one's place, so that the answer and its proof agree.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import product

import numpy as np

from zerorev.kernels import bound_nodes, bound_tree
from zerorev.kernels.layout import BoundRules
from zerorev.model._arrays import Array
from zerorev.model.plan import Optimality
from zerorev.model.proof_tree import ProofTree
from zerorev.motion.joint_path import outward_rates
from zerorev.search.bounds.log import logged_tree
from zerorev.search.bounds.tree import Search, model_limits
from zerorev.search.cut_short import descended, steadied
from zerorev.search.problem import Problem
from zerorev.search.rank import SAME_COST, Candidate
from zerorev.search.straight import LEAST_RATE

__all__ = ["MOST_REVERSALS", "Proof", "Prover", "prove"]

GAP = 3e-4  # of the travel: so much more than the least is proven enough
SAME_TRAVEL = 1e-6  # relative: by so little a motion is no better
STATED_GAP = 1e-3  # of the travel: what is called proven
SAME_RATE = 2e-6  # relative: a threshold missed by so little is kept (`evaluation.meets_threshold` asks for half of it)
MOST_REVERSALS = 12.0  # of all joints: what a hole without any motion is searched up to
TURNS_OF_LEG = 257  # points at which a motion that failed is examined
MOST_FRESH_CUTS = 8
SHORT = 0.03  # of the arm's size: on shorter strokes joints hardly change their rates
SAMPLES = 4, 8  # at a box at first
MORE_TWIST = 1 + 1e-9  # so that rounding leaves no slope out


@dataclass(frozen=True)
class Proof:
    """The best motion, and how much better one could be.

    Attributes:
        best: the motion that was given, or a better one; None where there is none.
        optimality: what is proven of it.
        boxes: how many boxes of legs were examined.
    """

    best: Candidate | None
    optimality: Optimality
    boxes: int


def prove(
    problem: Problem,
    best: Candidate | None,
    boxes: int,
    allows: Callable[[Candidate], bool] = lambda _: True,
    log: list[ProofTree] | None = None,
) -> Proof:
    """Bound what motions of straight legs can do, and improve on the best one where that is possible.

    Args:
        problem: one hole.
        best: the best motion known, of straight legs, or None.
        boxes: budget, in boxes of legs that are examined.
        allows: whether a motion is admissible; its demands are not part of the bounds, which hold all the same.
        log: out, the tree of each search that was made, or None.

    Returns:
        the best motion and what is proven of it. With criteria other than travel only the reversals are bounded.
    """
    return Prover(problem, boxes, allows, log).run(best)


@dataclass(frozen=True)
class _Least:
    """The outcome of a search for the least travel.

    Attributes:
        best: the best motion.
        bound: none travels less [rad].
        ended: whether nothing was left over.
    """

    best: Candidate | None
    bound: float
    ended: bool


class Prover:
    """The proof of one hole; a search of it is resumed where the budget is raised.

    Attributes:
        budget: in boxes of legs that are examined, in all.
        spent: of it.
        log: the tree of each search that was made, or None.
    """

    def __init__(
        self,
        problem: Problem,
        boxes: int,
        allows: Callable[[Candidate], bool] = lambda _: True,
        log: list[ProofTree] | None = None,
    ) -> None:
        self.problem, self.budget, self.spent, self.allows, self.log = problem, boxes, 0, allows, log
        self.scale = _cost_scale(problem.weights)
        settings = problem.settings
        self.travels = settings.objective == "travel" and not settings.weights
        self.threshold = settings.min_rate if settings.min_rate_rule == "pointwise" else 0.0

    def run(self, best: Candidate | None) -> Proof:
        """First no reversal at all, then the fewest, then the least travel with so many."""
        least: _Least | None = None
        if not self._is_perfect(best):
            # nothing else is worth as much, and where no joint may reverse the sign of each is known
            least = self.least(best, most=0.0, first=not self.travels)
            best = least.best
        fewest, decided = 0.0, True
        if not self._is_perfect(best):
            best, fewest, decided = self._fewest(best)
            least = None
        if best is None or not self.travels:
            return Proof(best, Optimality(fewest, None, None, decided), self.spent)
        if least is None:
            least = self.least(best, most=self._cost(best))
            best = least.best
            assert best is not None
        if not best.keeps_threshold:
            return Proof(best, Optimality(fewest, None, None, decided and least.ended), self.spent)
        travel = best.score.travel
        bound = min(max(least.bound, 0.0), travel)
        gap = 1.0 - bound / travel if travel > 0.0 else 0.0
        return Proof(best, Optimality(fewest, bound, gap, decided and gap <= STATED_GAP), self.spent)

    def search_for_least(self, best: Candidate | None, most: float) -> Search:
        """The search that `least` runs."""
        return self._search(self.threshold * (1 - SAME_RATE), most, best)

    def least(
        self, best: Candidate | None, most: float, *, first: bool = False, search: Search | None = None
    ) -> _Least:
        """The motion of the least travel that keeps the threshold, and costs no more than `most` in reversals.

        Args:
            best: to begin with, or None.
            most: what reversals may cost.
            first: whether the first such motion suffices.
            search: one that is resumed, or None.
        """
        search = search or self.search_for_least(best, most)

        def accepts(found: Candidate) -> bool:
            return found.keeps_threshold and self._cost(found) <= most + SAME_COST

        if best is not None and accepts(best):
            search.improve(self._scaled(best), best.score.travel)
        while True:
            reason = self._advance(search)
            if reason != bound_tree.CANDIDATE:
                break
            found = self._found(search)
            if found is not None and accepts(found) and self._is_better(found, best) and self.allows(found):
                best = found
                search.improve(self._scaled(best), best.score.travel)
                if first:
                    break
        self._note(search)
        cost = most if best is None else self._cost(best)
        bound = search.bound - bound_nodes.BIG * cost * self.scale
        return _Least(best, bound, reason in (bound_tree.EMPTY, bound_tree.PROVEN))

    def _fewest(self, best: Candidate | None) -> tuple[Candidate | None, float, bool]:
        """The best motion with the fewest reversals, a bound on their cost, and whether the two meet."""
        most = MOST_REVERSALS * float(self.problem.weights.sum()) if best is None else self._cost(best)
        search = self._search(0.0, most, best)
        if best is not None:
            search.improve(self._scaled(best), 0.0)
        while True:
            reason = self._advance(search)
            if reason != bound_tree.CANDIDATE:
                break
            found = self._found(search)
            fewer = found is not None and (best is None or self._cost(found) < self._cost(best) - SAME_COST)
            if found is not None and fewer and self.allows(found):
                best = found
                most = self._cost(best)
                search.improve(self._scaled(best), 0.0)
        self._note(search)
        decided = reason in (bound_tree.EMPTY, bound_tree.PROVEN)
        return best, most if decided else min(self._cost_bound(search.bound), most), decided

    def _advance(self, search: Search) -> int:
        """Resume a search within the budget."""
        before = search.passes
        reason = search.advance(before + self.budget - self.spent)
        self.spent += search.passes - before
        return reason

    def _note(self, search: Search) -> None:
        """Keep the tree of a search that has ended."""
        if self.log is not None:
            self.log.append(logged_tree(search, self.problem.drilling))

    def _search(self, min_rate: float, most: float, best: Candidate | None) -> Search:
        problem = self.problem
        lower, upper = model_limits(problem.drilling)
        branch = problem.drilling.hole.branch
        flips = np.ones(2, dtype=bool)
        if branch is not None:
            # the tapes have sin(q5) >= 0; where joint 5 is counted the other way, A5 < 0 is that one
            flips[:] = np.arange(2) == (branch % 2 if problem.drilling.robot.arm.sign[4] > 0 else 1 - branch % 2)
        weights = problem.weights * self.scale
        # where joints reverse, more samples show better how far they travel
        (few, many), straight_on = SAMPLES, most < problem.weights.min()
        rules = BoundRules(
            depth=problem.drilling.hole.depth,
            min_rate=min_rate,
            psi_bound=problem.settings.psi_bound or 0.0,
            lower=lower,
            upper=upper,
            flips=flips,
            weights=weights,
            most_cost=most * self.scale,
            least_weight=float(weights.min()),
            samples=few if straight_on and problem.drilling.hole.depth < SHORT * problem.drilling.robot.size else many,
        )
        # a leg travels at least its twist, and a joint that reverses n times at most n + 1 times its range
        ranges, reversals = upper - lower, most / max(float(problem.weights.min()), 1e-3)
        twist = float(ranges.sum() + min(reversals, MOST_REVERSALS) * ranges.max()) * MORE_TWIST
        if self._is_perfect(best):
            assert best is not None
            twist = min(twist, best.score.travel)
        postures = sorted({one // 2 for one in problem.branches})
        return Search(
            problem.drilling.robot.arm, problem.plane, rules, postures, twist, GAP, logged=self.log is not None
        )

    def _is_better(self, found: Candidate, best: Candidate | None) -> bool:
        """Whether a motion beats the best one by more than the last digits, by which the answer would vary."""
        if best is None or self.problem.order.best([found, best]) is best:
            return best is None
        alike = self._cost(found) == self._cost(best) and found.keeps_threshold == best.keeps_threshold
        return not (alike and self.travels and found.score.travel > best.score.travel * (1 - SAME_TRAVEL))

    def _is_perfect(self, motion: Candidate | None) -> bool:
        """Whether a motion has no reversal and keeps the threshold."""
        return motion is not None and motion.keeps_threshold and self._cost(motion) <= SAME_COST

    def _found(self, search: Search) -> Candidate | None:
        """The better of the motions on the two wrist flips that a candidate stands for; where it fails, it is cut."""
        psi, *slopes, posture = search.tree.candidate.tolist()
        rough = search.tree.values[bound_nodes.CANDIDATE_VALUE] >= bound_nodes.NOTHING
        problem = self.problem
        branches = [branch for branch in problem.branches if branch // 2 == int(posture)]
        found = problem.order.best(problem.found(branch, psi, (slopes[0], slopes[1])) for branch in branches)
        if found is not None and found.reversals == 0 and found.keeps_threshold:
            return descended(problem.order, found)
        if rough:  # where several conditions meet there is next to no room, which points miss
            search.cut(self._worst_places(int(posture), psi, slopes))
            return (
                self._slid(branches, psi, slopes)
                if search.tree.counts[bound_nodes.TRIED] % bound_tree.SELDOM == 0
                else None
            )
        value = np.inf if found is None else bound_nodes.BIG * self._scaled(found) + found.score.travel
        as_seen = value < search.tree.values[bound_nodes.CANDIDATE_VALUE] * (1 + 1e-6)
        if found is None or not as_seen or not found.keeps_threshold:
            search.cut(self._worst_places(int(posture), psi, slopes))
        return found

    def _slid(self, branches: list[int], psi: float, slopes: list[float]) -> Candidate | None:
        """A motion without a reversal to which the margin of two legs leads, descended; None where it leads to none."""
        order = self.problem.order
        rate = max(self.problem.settings.min_rate, LEAST_RATE)
        best = order.best(steadied(order, branch, psi, np.array(slopes), rate) for branch in branches)
        return descended(order, best) if best is not None and best.keeps_threshold else None

    def _worst_places(self, posture: int, psi: float, slopes: list[float]) -> Array:
        """Where on its legs a motion fails what it is asked, as shares of the depth."""
        problem, shares = self.problem, np.linspace(0.0, 1.0, TURNS_OF_LEG)
        places: list[float] = []
        for slope in slopes:
            s = shares * problem.drilling.hole.depth
            rates = outward_rates(problem.drilling, 2 * posture, s, psi + slope * s, np.full(s.size, slope))
            if np.isnan(rates).any():
                places.append(float(shares[np.argmax(np.isnan(rates).any(axis=1))]))
                continue
            most = np.where(np.abs(rates.max(axis=0)) > np.abs(rates.min(axis=0)), 1.0, -1.0)
            above = most * rates - problem.settings.min_rate
            worst = above.argmin(axis=0)
            places += [float(shares[n]) for i, n in enumerate(worst) if above[n, i] < 0.0]
        return np.unique(np.array(places))[:MOST_FRESH_CUTS]

    def _cost(self, motion: Candidate) -> float:
        return self.problem.order.reversals(motion)

    def _scaled(self, motion: Candidate) -> float:
        return self._cost(motion) * self.scale

    def _cost_bound(self, value: float) -> float:
        """The cost that a value stands for."""
        return float(np.floor(value / bound_nodes.BIG + 1e-9)) / self.scale


def _cost_scale(weights: Array) -> float:
    """What weighted counts of reversals are multiplied by, so that two that differ do so by 1 at least."""
    sums = np.unique(np.round(np.array(list(product(range(3), repeat=6))) @ weights, 9))
    return float(min(1.0 / np.diff(sums).min(), 1e4)) if sums.size > 1 else 1.0
