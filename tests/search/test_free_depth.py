"""The bound on the deepest stroke of free legs: never below a motion that exists, and close above those found."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import zerorev as zr
from oracles import free_walks, holes
from zerorev.model.hole import Hole
from zerorev.motion.drilling import Drilling
from zerorev.search.bounds.free_depth import bound_free_depth
from zerorev.search.free_deepest import CLOSEST, deepest_free
from zerorev.search.optimum import deepest_as_drilled
from zerorev.search.problem import Problem

BUDGET = 50_000
LESS = 0.7  # of a stroke that exists: a bound that is driven up from there does not know of it
CLOSE = {  # target [m]: by how much more than the stroke that is found the bound is, at most
    (0.5, 0.3, 0.8): 0.06,
    (0.2, 0.4, 0.6): 0.06,
    (0.2, 0.2, 1.0): 0.06,
    (0.5, 0.3, 0.9): 0.14,
}


def unknowing(drilled, depth, boxes=BUDGET):
    """The bound of a hole of which only a shallower stroke is known [m]."""
    return bound_free_depth(Problem(*drilled.both), LESS * depth, boxes).at_most


def free(seed):
    """A random hole with one of several caps, every fourth with narrow limits, every fifth with bounded spins."""
    drilled = holes.random_hole(seed, legs="free", narrowed=seed % 4 == 0)
    cap = np.deg2rad(1e3) * (1.0, 5.0, 12.0)[seed % 3] / drilled.robot.size
    return drilled.asking(max_twist=float(cap), psi_bound=2.0 if seed % 5 == 0 else None)


def evaluated(drilled, *effort):
    """The deepest stroke that is found [m]; its motion has no reversal, keeps the threshold and the cap."""
    found, profile, branch = deepest_free(*drilled.both, *effort)
    if profile is None:
        return 0.0
    hole = replace(drilled.hole, depth=found)
    seen = zr.evaluate(drilled.robot, drilled.tool, hole, profile, branch, drilled.settings)
    assert seen.score.reversals == 0
    assert not [finding for finding in seen.findings if finding.kind in ("limit", "threshold")]
    assert (seen.score.min_rate >= drilled.settings.min_rate).all()
    assert np.abs(profile.twist_rate).max() <= drilled.settings.max_twist * (1 + 1e-9)
    return found


def check_against_the_found(seed):
    drilled = free(seed)
    found = evaluated(drilled)
    if found > 0:
        assert unknowing(drilled, found) >= found


def check_against_very_many_segments(seed):
    """On holes whose sets of spins, which nobody evaluates, were up to half deeper than the bound."""
    drilled = holes.random_hole(seed, legs="free", narrowed=seed % 4 == 0)
    usual, inner = evaluated(drilled), evaluated(drilled, CLOSEST)
    assert inner <= bound_free_depth(Problem(*drilled.both), LESS * inner, BUDGET).at_most
    assert usual >= 0.95 * inner > 0.0


def check_against_walks(seed, spins, tries):
    """Of random legs, whose depth is good to a step, as rates are held against the threshold at its ends only."""
    rng, drilled = np.random.default_rng(seed), free(seed)
    reach = drilled.robot.reach
    step = 1e-3 * reach
    deepest = 0.0
    for branch in range(8):
        there = free_walks.deepest_of_walks(
            rng, drilled, branch, spins=spins, tries=tries, step=step, longest=0.4 * reach
        )
        deepest = max(deepest, there)
    if deepest > 4 * step:
        assert unknowing(drilled, deepest) >= deepest - 2 * step
    return deepest > 4 * step


class TestBound:
    @pytest.mark.parametrize("seed", range(900, 904))
    def test_is_never_below_a_stroke_that_is_found(self, seed):
        check_against_the_found(seed)

    @pytest.mark.parametrize("seed", [20, 24])
    def test_is_never_below_what_very_many_segments_attain(self, seed):
        check_against_very_many_segments(seed)

    def test_is_never_below_random_legs(self):
        assert sum(check_against_walks(seed, 40, 8) for seed in (940, 942)) > 0

    @pytest.mark.parametrize(("target", "share"), CLOSE.items())
    def test_is_close_at_the_thesis_targets(self, target, share):
        hole = Hole("one", target, [1, 0, 0], 0.02)
        settings = zr.Settings(legs="free", proof_boxes=BUDGET)
        deepest = deepest_as_drilled(
            Drilling(zr.read_robot("kuka_kr6_r700_2"), zr.read_tool("thesis_drill"), hole), settings
        )
        assert deepest.at_most is not None
        assert deepest.depth < deepest.at_most <= deepest.depth * (1 + share)

    def test_is_not_stated_without_a_budget(self):
        drilled = free(901).asking(proof_boxes=0)
        assert deepest_as_drilled(*drilled.both).at_most is None

    @pytest.mark.parametrize("seed", [907, 36])
    def test_a_greater_budget_costs_more_and_stays_within_it(self, seed):
        drilled = free(seed)
        found = deepest_free(*drilled.both)[0]
        small, large = (bound_free_depth(Problem(*drilled.both), found, boxes) for boxes in (30_000, 80_000))
        assert small.boxes <= 30_000
        assert large.boxes <= 80_000
        assert large.at_most <= small.at_most

    def test_where_no_stroke_is_without_a_reversal_next_to_none_is_allowed(self):
        """The drill axis passes through the wrist centre, so the spin moves none of joints 1 to 3."""
        robot = zr.read_robot("kuka_kr6_r700_2")
        T = np.diag([1.0, -1.0, -1.0, 1.0])
        T[2, 3] = 0.1
        tool = zr.Tool("straight", T)
        hole = Hole("one", [0.5, 0.1, 0.6], [1, 0, 0], 0.02)
        problem = Problem(Drilling(robot, tool, hole), zr.Settings(legs="free", min_rate=np.deg2rad(10.0)))
        assert bound_free_depth(problem, 0.0, BUDGET).at_most < 0.005

    @pytest.mark.long
    def test_is_never_below_a_stroke_that_is_found_on_many_holes(self):
        for seed in (*range(904, 908), *range(910, 926)):
            check_against_the_found(seed)

    @pytest.mark.long
    def test_is_never_below_what_very_many_segments_attain_on_more_holes(self):
        for seed in (2, 28, 34, 37, 50, 56):
            check_against_very_many_segments(seed)

    @pytest.mark.long
    def test_is_never_below_random_legs_on_many_holes(self):
        assert sum(check_against_walks(seed, 60, 12) for seed in range(950, 955)) >= 3
