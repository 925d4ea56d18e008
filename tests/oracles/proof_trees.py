"""Logged proofs of the thesis' positions, and small trees made by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import zerorev as zr
from zerorev.model.proof_tree import Claim, ProofTree
from zerorev.motion.drilling import Drilling
from zerorev.search.bounds.proof import prove
from zerorev.search.exact import search
from zerorev.search.problem import Problem

__all__ = ["THESIS", "around", "by_hand", "logged", "without_node"]

THESIS = (([0.5, 0.3, 0.8], 0.05), ([0.2, 0.4, 0.6], 0.02), ([0.2, 0.2, 1.0], 0.03))


def logged(robot, tool, hole, min_rate, boxes=100_000):
    """The best motion of a hole, and the tree that proves it."""
    settings = zr.Settings(min_rate=min_rate)
    trees = []
    proof = prove(
        Problem(Drilling(robot, tool, hole), settings), search(Drilling(robot, tool, hole), settings), boxes, log=trees
    )
    return proof.best, trees[-1]


def by_hand(claim, posture, spins, slopes, dead):
    """One node with its slopes, all of them closed: dead or not."""
    count = len(slopes)
    return ProofTree(
        claim=claim, spins=np.array([spins]), parents=np.array([-1]), postures=np.array([posture]),
        lists=np.array([[0, count]]), slopes=np.array(slopes), closed_of=np.zeros(count, dtype=int),
        closed=np.array(slopes), dead=np.array(dead), cuts=(np.zeros(0),),
        terms=np.zeros((1, 0, 5)), of_travel=np.array([True]),
    )  # fmt: skip


def without_node(tree, number):
    """The tree without one of its nodes, which has no halves."""
    keep = np.arange(len(tree.spins)) != number
    moved = np.cumsum(keep) - 1
    rows = tree.closed_of != number
    parents = tree.parents[keep]
    return replace(
        tree, spins=tree.spins[keep], postures=tree.postures[keep], lists=tree.lists[keep],
        parents=np.where(parents < 0, -1, moved[parents]), closed_of=moved[tree.closed_of[rows]],
        closed=tree.closed[rows], dead=tree.dead[rows], cuts=tuple(tree.cuts[n] for n in np.flatnonzero(keep)),
        terms=tree.terms[keep], of_travel=tree.of_travel[keep],
    )  # fmt: skip


def around(motion, value, *, width=1e-3, min_rate=0.0):
    """Claim, posture, spins and the two intervals of slopes around a motion of straight legs."""
    profile = motion.profile
    depth = motion.depth
    psi = float(profile.psi[1])
    ends = [(float(end) - psi) / depth for end in profile.psi[[0, 2]]]
    claim = Claim(depth, min_rate, 0.0, None, np.ones(6), 0.0, value)
    slopes = [[end - width / depth, end + width / depth] for end in sorted(ends)]
    return claim, motion.branch // 2, [psi - width, psi + width], slopes
