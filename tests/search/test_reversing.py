"""Where joints have to reverse: no branch alone has a better motion than the search on all branches at once."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from benchmarks.cases import NO_THRESHOLD, Case, drilled, random_place
from benchmarks.parts.holes import ANY_DEPTH

from oracles import search as twin
from zerorev.model.job import Settings
from zerorev.motion.drilling import Drilling
from zerorev.search.exact import search, sets_to_keep
from zerorev.search.problem import Problem
from zerorev.search.survey import survey, surveyed

# holes of the benchmark that no branch drills without a reversal
QUICK, MANY = [1013, 1024, 1120], [1006, 1025, 1029, 1032, 1036, 1041, 1050, 1067, 1072, 1078, 1088, 1116, 1123]
WEIGHTS = (3.0, 1.0, 1.0, 2.0, 1.0, 0.5)


def random_hole(seed: int) -> Case:
    """As the benchmark drills it, to any depth."""
    return drilled(random_place(seed), np.random.default_rng(seed).uniform(*ANY_DEPTH))


def problem_of(case: Case, settings: Settings = NO_THRESHOLD, branch: int | None = None) -> Problem:
    return Problem(Drilling(case.robot, case.tool, replace(case.hole, branch=branch)), settings)


def ranked(problem: Problem):
    """What the search finds, by reversals, lack of motion, and travel."""
    found = search(Drilling(problem.drilling.robot, problem.drilling.tool, problem.drilling.hole), problem.settings)
    return (np.inf, np.inf, np.inf) if found is None else problem.order.rank(found)[:3]


def check_no_branch_is_better(case: Case, settings: Settings) -> None:
    cost, lack, value = ranked(problem_of(case, settings))
    assert np.isfinite(cost)
    assert cost > 0
    for branch in range(8):
        alone = ranked(problem_of(case, settings, branch))
        assert (cost, lack, value * (1 - 1e-9)) <= alone


class TestAllBranchesAtOnce:
    def test_a_valley_that_looks_dearer_than_another_branch_is_descended(self):
        """Random hole 1079: on the grid branches 0 and 1 look 18 % dearer than 2 and 3; they are 7 % cheaper."""
        case = random_hole(1079)
        found = search(Drilling(case.robot, case.tool, case.hole), NO_THRESHOLD)
        assert found.branch in (0, 1)
        assert found.score.reversals_per_joint == (0, 1, 1, 0, 0, 0)
        assert np.rad2deg(found.score.travel) == pytest.approx(73.6345, abs=1e-3)
        best = twin.best_on_grid(case.robot, case.tool, replace(case.hole, branch=0), spins=48)
        assert (found.score.reversals, found.score.travel) <= best.key

    @pytest.mark.parametrize("seed", [1079, QUICK[0]])
    def test_are_never_worse_than_one_alone(self, seed):
        check_no_branch_is_better(random_hole(seed), NO_THRESHOLD)

    @pytest.mark.long
    @pytest.mark.parametrize("settings", [NO_THRESHOLD, Settings()], ids=["no threshold", "threshold"])
    @pytest.mark.parametrize("seed", MANY)
    def test_are_never_worse_on_many_holes(self, seed, settings):
        check_no_branch_is_better(random_hole(seed), settings)

    @pytest.mark.long
    @pytest.mark.parametrize("seed", QUICK + MANY[:3])
    def test_nor_with_other_weights(self, seed):
        check_no_branch_is_better(random_hole(seed), replace(NO_THRESHOLD, reversal_weights=WEIGHTS))


class TestSets:
    def test_all_but_the_whole_come_once_those_first_that_cost_least(self):
        problem = problem_of(random_hole(1079), replace(NO_THRESHOLD, reversal_weights=WEIGHTS))
        sets = list(sets_to_keep(problem))
        costs = [sum(weight for weight, kept in zip(WEIGHTS, keep, strict=True) if not kept) for keep in sets]
        assert len({tuple(keep) for keep in sets}) == 2**6 - 1
        assert not any(keep.all() for keep in sets)
        assert costs == sorted(costs)
        assert costs[0] == min(WEIGHTS)


class TestSurvey:
    def test_says_what_the_best_pairs_of_each_branch_do(self):
        """Regardless of other branches; and refining makes no pair worse than the grid has it."""
        problem = problem_of(random_hole(1079))
        pairs, found = survey(problem), surveyed(problem)
        for branch in range(8):
            there = [problem.order.rank(each)[:3] for each in found if each.branch == branch]
            on_grid = min(tuple(pair) for pair in pairs[branch, :, :3])
            assert bool(there) == np.isfinite(on_grid[0])
            if there:
                assert min(there) <= on_grid
                alone = [
                    problem.order.rank(each)[:3] for each in surveyed(problem_of(random_hole(1079), branch=branch))
                ]
                assert there == alone
