"""The log of a branch and bound: an option that changes nothing else."""

from __future__ import annotations

import numpy as np
import pytest

import zerorev as zr
from oracles.proof_trees import THESIS
from zerorev.kernels import bound_nodes
from zerorev.motion.drilling import Drilling
from zerorev.search.bounds.proof import prove
from zerorev.search.bounds.straight_depth import bound_depth
from zerorev.search.exact import search
from zerorev.search.problem import Problem


def problem_of(robot, tool):
    target, depth = THESIS[1]
    hole = zr.Hole("2", target=target, direction=[1, 0, 0], depth=depth)
    return Problem(Drilling(robot, tool, hole), zr.Settings(min_rate=0.0))


def test_the_proof_is_the_same_with_it(robot, tool):
    problem = problem_of(robot, tool)
    best = search(Drilling(robot, tool, problem.drilling.hole), problem.settings)
    trees = []
    with_log, without = prove(problem, best, 100_000, log=trees), prove(problem, best, 100_000)
    assert (with_log.optimality, with_log.boxes) == (without.optimality, without.boxes)
    assert len(trees) == 1
    claim = trees[0].claim
    assert claim.value == without.optimality.travel_at_least
    assert (claim.depth, claim.min_rate, claim.most_cost) == (problem.drilling.hole.depth, 0.0, 0.0)


def test_it_is_whole(robot, tool):
    """Every interval of a node that is divided is closed, or in the lists of both halves; its room has grown."""
    problem = problem_of(robot, tool)
    trees = []
    bound_depth(problem, 0.0264, 100_000, trees)
    tree = max(trees, key=lambda one: len(one.closed))
    assert tree.claim.value == bound_nodes.NOTHING
    divided = 0
    for node in range(len(tree.spins)):
        closed = tree.closed[tree.closed_of == node]
        for half in np.flatnonzero(tree.parents == node):
            parts = np.diff(closed).sum() + np.diff(listed(tree, half)).sum()
            assert parts == pytest.approx(np.diff(listed(tree, node)).sum(), rel=1e-12)
            divided += 1
    assert divided > 20


def listed(tree, node):
    """Intervals of slopes of a node."""
    start, count = tree.lists[node]
    return tree.slopes[start : start + count]
