"""The exact search over straight legs: pairs of legs that bracket the critical rates (theory §2, §3).

All six joints are to keep their direction first (`valleys`). Where they cannot all, the pairs of legs of a grid are
counted (`survey`), which bounds the fewest reversals from above; then every set of joints that costs no more to leave
out is tried, cheapest first, as the grid may have missed a thin one.

Where joints reverse, a coarse sample says little about the travel: a leg may travel a third less between two of its
slopes. So each set is tried on each branch by itself, and none is given up because of another branch's result. The best
candidate gets a final local descent (`survey.settled`): joints that may turn are not described by a set, and the survey
is coarse.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations

import numpy as np

from zerorev.model.job import Settings
from zerorev.motion.drilling import Drilling
from zerorev.search.problem import Mask, Problem
from zerorev.search.rank import SAME_COST, Candidate
from zerorev.search.survey import settled, survey, surveyed
from zerorev.search.valleys import Valleys

__all__ = ["can_run", "search", "without_reversal"]

ALL = np.ones(6, dtype=bool)


def search(drilling: Drilling, settings: Settings, known: Sequence[Candidate] = ()) -> Candidate | None:
    """The best motion of one hole: fewest reversals (weighted), then the motion threshold, then the objective.

    Args:
        drilling: what is drilled; its `branch`, if any, is the only one searched; stand-offs count from its target.
        settings: threshold, bound on the spin, objective, weights of the joints.
        known: motions of this hole that were found otherwise; the answer is no worse than any of them.

    Returns:
        the motion, or None where no branch can run any.
    """
    problem = Problem(drilling, settings)
    best = problem.order.best([without_reversal(problem), *known])
    if best is not None and best.reversals == 0:
        return best
    found = surveyed(problem) + ([] if best is None else [best])
    if not found:
        return None
    best = min(found, key=problem.order.rank)
    lines = [Valleys(problem, [branch]) for branch in problem.branches]
    for keep in sets_to_keep(problem):
        if problem.cost_without(keep) > problem.order.reversals(best) + SAME_COST:
            break
        kept = [motion for line in lines for motion in line.motions(keep)]
        best = min([best, *kept], key=problem.order.rank)
    return settled(problem, best)


def without_reversal(problem: Problem) -> Candidate | None:
    """The best motion that was made to keep the direction of all six joints; None where the valleys show none.

    Args:
        problem: what is asked.
    """
    return Valleys(problem, problem.branches).best_motion(ALL)


def can_run(drilling: Drilling, settings: Settings) -> bool:
    """Whether any branch and spin can run the hole at all, with any reversals; as far as a grid can show."""
    return bool(np.isfinite(survey(Problem(drilling, settings))).any())


def sets_to_keep(problem: Problem) -> Iterator[Mask]:
    """Sets of joints to keep, but for all six, those first that cost least to leave out the others; shape (6,) each."""
    sets = [~np.isin(range(6), left_out) for size in range(1, 7) for left_out in combinations(range(6), size)]
    yield from sorted(sets, key=lambda keep: (problem.cost_without(keep), keep.tolist()))
