"""The tree of a branch and bound as data, for a check that shares no code with it (theory §6)."""

from __future__ import annotations

from zerorev.kernels import bound_tree
from zerorev.model.proof_tree import Claim, ProofTree
from zerorev.search.bounds.tree import Search

__all__ = ["logged_tree"]


def logged_tree(search: Search, branch: int | None) -> ProofTree:
    """What a search has proven so far.

    Args:
        search: with its log kept.
        branch: the only one that was searched, or None.
    """
    tree, rules = search.tree, search.rules
    nodes, closed = int(tree.counts[bound_tree.NODES]), int(tree.counts[bound_tree.LOGGED])
    assert closed <= len(tree.closed)
    lists, rows = tree.lists[:nodes], tree.closed[:closed]
    slopes = slice(bound_tree.CLOSED_LOW, bound_tree.CLOSED_HIGH + 1)
    return ProofTree(
        claim=Claim(
            depth=rules.depth,
            min_rate=rules.min_rate,
            psi_bound=rules.psi_bound,
            branch=branch,
            weights=rules.weights,
            most_cost=rules.most_cost,
            value=search.bound,
        ),
        spins=tree.nodes[:nodes, :2].copy(),
        parents=lists[:, bound_tree.PARENT].copy(),
        postures=lists[:, bound_tree.POSTURE].copy(),
        lists=lists[:, [bound_tree.START, bound_tree.COUNT]],
        slopes=tree.slopes[: int(tree.counts[bound_tree.SLOPES])].copy(),
        closed_of=rows[:, bound_tree.CLOSED_NODE].astype(int),
        closed=rows[:, slopes].copy(),
        dead=rows[:, bound_tree.CLOSED_DEAD] == 1.0,
        cuts=tuple(tree.cuts[n, : lists[n, bound_tree.CUTS]].copy() for n in range(nodes)),
    )
