"""Whether a logged tree leaves nothing out: exact comparisons of its own numbers, without geometry (theory §8.4)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from zerorev.model._arrays import Array
from zerorev.model.proof_tree import NO_VALUE, PER_REVERSAL, ProofTree
from zerorev.model.robot import Robot

__all__ = ["Node", "fits", "holes_in", "most_reversals", "node_of"]

Indices = npt.NDArray[np.int64]

CIRCLE = 1e-15  # [rad] more than the rounding of pi; boxes are examined with as much around them


class Node(NamedTuple):
    """One node with what becomes of its slopes.

    Attributes:
        dead: intervals of slopes that no leg is in, shape (D, 2).
        closed: those of which any two, one of these and one of what is not dead, have to reach the value, shape (C, 2).
        passed: those that its halves continue with, shape (P, 2).
    """

    dead: Array
    closed: Array
    passed: Array


def node_of(tree: ProofTree, number: int, children: list[int], rows: Indices) -> Node:
    """What becomes of a node's slopes; where it has no halves, what is left is closed, too.

    Args:
        tree: of which it is.
        number: of the node.
        children: its halves.
        rows: of `tree.closed` that are its own.
    """
    dead, closed = tree.closed[rows][tree.dead[rows]], tree.closed[rows][~tree.dead[rows]]
    passed = [_list(tree, child) for child in children]
    if children:
        return Node(dead, closed, np.unique(np.concatenate(passed), axis=0))
    left = _without(_list(tree, number), tree.closed[rows])
    return Node(dead, np.concatenate([closed, left]), np.zeros((0, 2)))


def holes_in(tree: ProofTree, children: list[list[int]], rows: list[Indices]) -> Iterator[str]:
    """What a tree leaves out, one sentence each.

    Args:
        tree: any tree, also a wrong one, whose shapes fit each other.
        children: halves of each node.
        rows: of `tree.closed`, for each node.
    """
    claim, roots = tree.claim, np.flatnonzero(tree.parents < 0)
    bound = claim.psi_bound or np.pi
    for posture in range(4) if claim.branch is None else [claim.branch // 2]:
        here = roots[tree.postures[roots] == posture]
        if _gaps(np.array([[-bound, bound]]), tree.spins[here], CIRCLE):
            yield f"no node holds all spins on posture {posture}"
    for number, halves in enumerate(children):
        if not halves:
            continue
        if _gaps(tree.spins[[number]], tree.spins[halves]):
            yield f"the parts of node {number} leave spins out"
        for half in halves:
            if tree.postures[half] != tree.postures[number]:
                yield f"node {half} is on another posture than the node that it is a part of"
            if _gaps(_list(tree, number), np.concatenate([tree.closed[rows[number]], _list(tree, half)])):
                yield f"node {half} leaves slopes out, which node {number} does not close"


def most_reversals(tree: ProofTree, robot: Robot) -> float:
    """Of how many reversals a motion may be for the tree to hold all of its slopes; infinite: of any number.

    A leg travels its twist, at least. So a leg of a steeper slope than those of the roots has a greater travel than the
    value, or than the ranges of the joints allow, each of which a joint that reverses n times runs through n + 1 times.
    """
    claim = tree.claim
    roots = [_list(tree, number) for number in np.flatnonzero(tree.parents < 0).tolist()]
    ends = [_middle(one) for one in roots]
    slope = min((min(-low, high) for low, high in ends), default=0.0)
    twist = slope * claim.depth
    if (claim.psi_bound > 0 and 2 * claim.psi_bound <= twist) or (claim.value < PER_REVERSAL and claim.value <= twist):
        return np.inf
    ranges = (robot.limits.upper - robot.limits.lower - 2 * claim.limit_margin) * (1 + 1e-12)
    least = float(claim.weights.min())
    asked = claim.most_cost / least if least > 0 else np.inf
    allowed = np.floor((twist - ranges.sum()) / ranges.max())
    return np.inf if allowed >= np.floor(asked + 1e-9) else float(max(allowed, -1.0))


def _middle(intervals: Array) -> tuple[float, float]:
    """Ends of the piece without a gap in which 0 lies; 0, 0: there is none."""
    low = high = 0.0
    for one in intervals[np.argsort(intervals[:, 0])]:
        if one[0] <= high:
            high = max(high, float(one[1])) if one[1] >= 0 else high
    for one in intervals[np.argsort(-intervals[:, 1])]:
        if one[1] >= low:
            low = min(low, float(one[0])) if one[0] <= 0 else low
    return low, high


def _list(tree: ProofTree, number: int) -> Array:
    start, count = tree.lists[number]
    return tree.slopes[start : start + count]


def _without(whole: Array, taken: Array) -> Array:
    """What is left of intervals."""
    left = []
    taken = taken[np.argsort(taken[:, 0])]
    for low, high in whole:
        for a, b in taken[(taken[:, 1] > low) & (taken[:, 0] < high)]:
            if a > low:
                left.append((low, a))
            low = max(low, b)
        if low < high:
            left.append((low, high))
    return np.array(left).reshape(-1, 2)


def _gaps(whole: Array, parts: Array, slack: float = 0.0) -> bool:
    """Whether parts leave out some of what they should cover."""
    return bool((np.diff(_without(whole, parts), axis=1) > slack).any()) if len(whole) else False


def fits(tree: ProofTree) -> bool:
    """Whether the arrays of a tree fit each other: the shapes, the numbers of nodes, intervals that are none."""
    nodes, slopes = len(tree.spins), len(tree.slopes)
    alike = all(
        len(part) == nodes for part in (tree.parents, tree.postures, tree.lists, tree.cuts, tree.terms, tree.of_travel)
    )
    if not nodes or not alike or not len(tree.closed) == len(tree.closed_of) == len(tree.dead):
        return False
    ends = tree.lists.sum(axis=1)
    before = (tree.parents < np.arange(nodes)).all() and (tree.parents >= -1).all()
    shaped = tree.terms.ndim == 3 and tree.terms.shape[2] == 5
    inside = (tree.lists >= 0).all() and (ends <= slopes).all()
    known = ((tree.closed_of >= 0) & (tree.closed_of < nodes)).all()
    finite = all(np.isfinite(part).all() for part in (tree.spins, tree.slopes, tree.closed))
    rising = all((part[:, 0] <= part[:, 1]).all() for part in (tree.spins, tree.slopes, tree.closed))
    claim = tree.claim
    sound = 0 < claim.depth < np.inf and claim.min_rate >= 0 and claim.psi_bound >= 0 and claim.value <= NO_VALUE
    return bool(before and shaped and inside and known and finite and rising and sound)
