"""check_proofs(plan): is what a plan states of its optimality proven?

The search is run once more with a log of all that it leaves out. `verify.optimality` then checks the log, box by box,
in ball arithmetic, with formulas of its own.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from zerorev.model.plan import HolePlan, Plan
from zerorev.model.proof_tree import ProofCheck, ProofTree
from zerorev.motion.drilling import Drilling
from zerorev.search.optimum import deepest_as_drilled, optimum, too_short
from zerorev.verify.optimality.claims import down_to_the_corner, statements
from zerorev.verify.optimality.prove import check_tree

__all__ = ["StatementCheck", "check_proofs", "logged_trees"]


@dataclass(frozen=True)
class StatementCheck:
    """One statement of a plan about its optimality, checked.

    Attributes:
        hole: its id.
        field: of the plan file.
        words: what it says.
        proof: what the check of its proof came to; None: the search, run again, does not prove it.
    """

    hole: str
    field: str
    words: str
    proof: ProofCheck | None

    @property
    def confirmed(self) -> bool:
        """Whether it is proven."""
        return self.proof is not None and self.proof.verdict == "confirmed"


def check_proofs(
    plan: Plan, *, sample: int | None = None, seed: int = 0, progress: Callable[[int, int], None] | None = None
) -> list[StatementCheck]:
    """Check what a plan states of the optimality of its holes, and of their deepest strokes.

    Args:
        plan: with straight legs; what is stated of free legs does not rest on a tree.
        sample: check so many boxes of each proof, at random; None: all.
        seed: of the sample.
        progress: called with (holes checked, holes in all) before the first and after each.
    """
    checks: list[StatementCheck] = []
    for done, stated in enumerate(plan.holes):
        if progress:
            progress(done, len(plan.holes))
        known: dict[int, ProofCheck] = {}
        trees = logged_trees(plan, stated)
        drilled = down_to_the_corner(stated.hole, plan.settings)
        for statement in statements(stated, plan.settings, trees):
            proof = None
            for tree in statement.trees[:1]:
                if id(tree) not in known:
                    known[id(tree)] = check_tree(plan.robot, plan.tool, drilled, tree, sample=sample, seed=seed)
                proof = known[id(tree)]
            checks.append(StatementCheck(stated.hole.id, statement.field, statement.words, proof))
    if progress:
        progress(len(plan.holes), len(plan.holes))
    return checks


def logged_trees(plan: Plan, stated: HolePlan) -> list[ProofTree]:
    """The trees of all proofs of one hole, by the search of the plan run again.

    Args:
        plan: whose robot, tool and settings count.
        stated: one of its holes.
    """
    trees: list[ProofTree] = []
    nothing = stated.optimality is None and stated.deepest_at_most is None
    if nothing or plan.settings.legs == "free" or too_short(Drilling.of(plan, stated.hole)):
        return trees
    hole = stated.hole
    if stated.optimality is None:
        given = hole if stated.motion is None or hole.profile else replace(hole, profile=stated.motion.profile)
        deepest_as_drilled(Drilling.of(plan, given), plan.settings, trees)
    else:
        optimum(Drilling.of(plan, hole), plan.settings, trees)
    return trees
