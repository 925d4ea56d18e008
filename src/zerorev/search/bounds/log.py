"""The tree of a branch and bound as data, for a check that shares no code with it (theory §8.4)."""

from __future__ import annotations

import numpy as np

from zerorev.kernels import bound_boxes, bound_multipliers, bound_nodes
from zerorev.model.proof_tree import Claim, ProofTree
from zerorev.motion.drilling import Drilling
from zerorev.search.bounds.tree import Search

__all__ = ["logged_tree"]


def logged_tree(search: Search, drilling: Drilling) -> ProofTree:
    """What a search has proven so far.

    Args:
        search: with its log kept.
        drilling: what was searched.
    """
    tree, rules = search.tree, search.rules
    nodes, closed = int(tree.counts[bound_nodes.NODES]), int(tree.counts[bound_nodes.LOGGED])
    assert closed <= len(tree.closed)
    lists, rows = tree.lists[:nodes], tree.closed[:closed]
    slopes = slice(bound_nodes.CLOSED_LOW, bound_nodes.CLOSED_HIGH + 1)
    terms, shares = tree.terms[:nodes].copy(), tree.shares[:nodes, : rules.samples]
    sample = terms[..., bound_multipliers.SAMPLE].astype(int)
    terms[..., bound_multipliers.SAMPLE] = np.take_along_axis(shares, sample, axis=1)
    moved = shares != [bound_boxes.share(rules.samples, 0, sample) for sample in range(rules.samples)]
    return ProofTree(
        claim=Claim(
            depth=rules.depth,
            min_rate=rules.min_rate,
            psi_bound=rules.psi_bound,
            branch=drilling.hole.branch,
            weights=rules.weights,
            most_cost=rules.most_cost,
            value=search.bound,
            limit_margin=drilling.limit_margin,
        ),
        spins=tree.nodes[:nodes, :2].copy(),
        parents=lists[:, bound_nodes.PARENT].copy(),
        postures=lists[:, bound_nodes.POSTURE].copy(),
        lists=lists[:, [bound_nodes.START, bound_nodes.COUNT]],
        slopes=tree.slopes[: int(tree.counts[bound_nodes.SLOPES])].copy(),
        closed_of=rows[:, bound_nodes.CLOSED_NODE].astype(int),
        closed=rows[:, slopes].copy(),
        dead=rows[:, bound_nodes.CLOSED_DEAD] == 1.0,
        terms=terms,
        of_travel=tree.nodes[:nodes, bound_nodes.NODE_OF_TRAVEL] == 1.0,
        cuts=tuple(np.append(tree.cuts[n, : lists[n, bound_nodes.CUTS]], shares[n, moved[n]]) for n in range(nodes)),
    )
