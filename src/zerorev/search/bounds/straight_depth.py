"""How deep straight legs without a reversal could get at most: strokes a little deeper are refuted, or found."""

from __future__ import annotations

from dataclasses import dataclass, replace

from zerorev.model.proof_tree import ProofTree
from zerorev.search.bounds.proof import Prover
from zerorev.search.bounds.tree import Search
from zerorev.search.problem import Problem
from zerorev.search.rank import Candidate

__all__ = ["DepthBound", "bound_depth"]

# shares of the deepest stroke by which a deeper one is refuted; next to a singularity a coarse bound is all there is
DEEPER = (1e-3, 1e-2, 1e-1, 1.0)
SHARES = (0.15, 0.95, 1.0, 1.0)  # of the boxes that are left, for each of them: half of all holes need but the first
SHALLOWEST = 1e-4  # of the arm's reach: a stroke that is none


@dataclass(frozen=True)
class DepthBound:
    """How deep a stroke without a reversal could be.

    Attributes:
        at_most: no stroke of straight legs without a reversal that keeps the threshold is as deep [m]; None: not
            decided.
        deeper: a motion that is deeper than the one known, at its own depth; None: none was found.
        boxes: how many boxes of legs were examined.
    """

    at_most: float | None
    deeper: Candidate | None
    boxes: int


def bound_depth(problem: Problem, depth: float, boxes: int, log: list[ProofTree] | None = None) -> DepthBound:
    """Refute strokes deeper than one, or find one (theory §4): what is impossible at a depth is so at any greater one.

    Args:
        problem: one hole; its depth is left aside.
        depth: the deepest stroke known [m]; 0: none.
        boxes: budget, in boxes of legs that are examined.
        log: out, the tree of each search that was made, or None.
    """
    shallowest = SHALLOWEST * problem.drilling.robot.reach
    searches: list[_AnyMotion] = []

    def spent() -> int:
        return sum(one.boxes for one in searches)

    for step, share in zip(DEEPER if depth > 0 else (0.0,), SHARES, strict=False):
        search = _AnyMotion(problem, max(depth * (1 + step), shallowest), logged=log is not None)
        searches.append(search)
        search.go_on(int(share * (boxes - spent())))
        if search.decided:
            break
    if not search.motion:  # with a coarser bound there, the finest one has all that is left
        search = searches[0]
        search.go_on(boxes - spent())
    if log is not None:
        log += [tree for one in searches for tree in one.trees]
    if search.motion is not None:
        return DepthBound(None, search.motion, spent())
    at_most = min((one.depth for one in searches if one.refuted), default=None)
    return DepthBound(at_most, None, spent())


class _AnyMotion:
    """Whether any two straight legs of a depth have no reversal and keep the threshold at every point.

    Attributes:
        depth: [m].
        motion: one that does, or None so far.
        refuted: whether there is none.
    """

    def __init__(self, problem: Problem, depth: float, *, logged: bool) -> None:
        settings = replace(problem.settings, min_rate_rule="pointwise", weights=())
        there = replace(problem, drilling=problem.drilling.deep(depth), settings=settings)
        self._prover = Prover(there, 0, log=[] if logged else None)
        self._search: Search | None = None
        self.depth = depth
        self.motion: Candidate | None = None
        self.refuted = False

    @property
    def boxes(self) -> int:
        """How many boxes of legs were examined."""
        return self._prover.spent

    @property
    def decided(self) -> bool:
        """Whether the answer is known."""
        return self.refuted or self.motion is not None

    @property
    def trees(self) -> list[ProofTree]:
        """The tree of the search, where it was made and is logged."""
        return (self._prover.log or [])[-1:]

    def go_on(self, boxes: int) -> None:
        """Examine some more boxes."""
        if self.decided or boxes <= 0:
            return
        prover = self._prover
        prover.budget = prover.spent + boxes
        self._search = self._search or prover.search_for_least(None, most=0.0)
        least = prover.least(None, most=0.0, first=True, search=self._search)
        self.motion, self.refuted = least.best, least.ended and least.best is None
