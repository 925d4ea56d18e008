"""The weighted search: against the exact searches of one criterion, a naive twin on a grid, and planted optima."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from oracles.search import pairs, trace_legs
from zerorev.model.hole import Hole
from zerorev.model.job import Settings
from zerorev.model.measures import CRITERIA
from zerorev.model.profile import Profile
from zerorev.motion.criteria import measure, objective_of
from zerorev.motion.drilling import Drilling
from zerorev.motion.evaluation import evaluate, meets_threshold
from zerorev.search import weighted
from zerorev.search.exact import search
from zerorev.search.straight import straight_motion
from zerorev.search.weighted import search_weighted

STIFFNESS = (4e4, 5e4, 3e4, 1e4, 1.2e4, 6e3)
MIXED = (("travel", 2.0), ("margin", 0.2), ("limit_distance", 0.5), ("compliance_lateral", 0.2))


def asking(*weights, **settings):
    return Settings(weights=weights, joint_stiffness=STIFFNESS, **settings)


def cost(robot, tool, hole, settings, profile, branch):
    """Of a motion as it is evaluated; inf where it reverses a joint or is too slow."""
    evaluation = evaluate(robot, tool, hole, profile, branch, settings)
    if evaluation.score is None or evaluation.score.reversals or not meets_threshold(evaluation.score, settings):
        return np.inf
    return objective_of(settings)(measure(Drilling(robot, tool, hole), evaluation, settings))


def cost_of(robot, tool, hole, settings, found):
    return cost(robot, tool, hole, settings, found.profile, found.branch)


class TestAgainstTheExactSearch:
    def test_travel_alone_is_the_exact_least_travel(self, robot, tool, position):
        exact = search(Drilling(robot, tool, position.hole), Settings())
        found = search_weighted(Drilling(robot, tool, position.hole), asking(("travel", 3.0)))
        assert (found.reversals, found.keeps_threshold) == (0, True)
        assert np.rad2deg(found.score.travel) == pytest.approx(np.rad2deg(exact.score.travel), abs=1e-3)

    def test_margin_alone_is_the_exact_greatest_margin(self, robot, tool, position):
        exact = search(Drilling(robot, tool, position.hole), Settings(objective="margin"))
        found = search_weighted(Drilling(robot, tool, position.hole), asking(("margin", 1.0)))
        assert np.rad2deg(found.score.min_rate.min()) / 1e3 == pytest.approx(
            np.rad2deg(exact.score.min_rate.min()) / 1e3, abs=1e-5
        )

    @pytest.mark.long
    @pytest.mark.parametrize("weights", [MIXED, (("manipulability", 1.0), ("plunge_rotation", 0.5))])
    def test_is_never_worse_than_any_exact_answer(self, robot, tool, position, weights):
        settings = asking(*weights)
        best = cost_of(
            robot, tool, position.hole, settings, search_weighted(Drilling(robot, tool, position.hole), settings)
        )
        for word in ("travel", "margin", "plunge_rotation"):
            single = search(Drilling(robot, tool, position.hole), Settings(objective=word))
            assert best <= cost_of(robot, tool, position.hole, settings, single) + 1e-12


class TestPlanted:
    """The exact optimum of one criterion is known from elsewhere; here the search does not know it."""

    @pytest.mark.parametrize(("criterion", "seed"), [("travel", "margin"), ("margin", "travel")])
    def test_is_found_from_the_answer_to_another_question(self, robot, tool, position, monkeypatch, criterion, seed):
        hole = position.hole
        known = search(Drilling(robot, tool, hole), Settings(objective=criterion))
        other = search(Drilling(robot, tool, hole), Settings(objective=seed))
        monkeypatch.setattr(weighted, "search", lambda *_: other)
        settings = asking((criterion, 1.0))
        found = search_weighted(Drilling(robot, tool, hole), settings)
        planted = cost_of(robot, tool, hole, settings, known)
        assert cost_of(robot, tool, hole, settings, other) > planted + 0.01
        assert cost_of(robot, tool, hole, settings, found) <= planted + 1e-5

    def test_is_found_where_limits_leave_little_else(self, robot, tool, positions):
        """A motion is planted by joint limits around its joints; the survey does not know of it."""
        first, settings = positions[0], asking(("travel", 1.0), min_rate=0.0)
        joints = evaluate(robot, tool, first.hole, first.profile, first.branch).motion.joints
        limits = replace(robot.limits, lower=joints.min(axis=0) - 0.03, upper=joints.max(axis=0) + 0.03)
        tight = replace(robot, limits=limits)
        problem = weighted.WeightedLegs(Drilling(tight, tool, first.hole), settings)
        found = problem.polished(min(problem.survey()))
        planted = cost(tight, tool, first.hole, settings, first.profile, first.branch)
        assert cost_of(tight, tool, first.hole, settings, found) <= planted


class TestNaiveTwin:
    @pytest.mark.long
    @pytest.mark.parametrize("weights", [MIXED, (("compliance_axial", 1.0),), (("limit_distance", 1.0),)])
    def test_no_motion_of_a_grid_is_better(self, robot, tool, position, weights):
        """Every pair of legs without reversal of a grid, each evaluated and measured as a whole motion."""
        settings, hole, spins = asking(*weights, min_rate=np.deg2rad(1.0)), position.hole, 60
        step = 2 * np.pi / spins
        twist = np.arange(-spins // 2, spins // 2 + 1) * step
        legs = trace_legs(robot, tool, hole, np.arange(spins) * step - np.pi + 0.01, twist, nodes=17)
        motions = [
            (branch, k, n, m)
            for k in range(spins)
            for branch in range(8)
            for n, m in np.argwhere(np.triu(pairs(robot, legs, k, branch, np.ones(6))[0] == 0)).tolist()
        ]
        assert motions or position.name == "position 2"
        best = cost_of(robot, tool, hole, settings, search_weighted(Drilling(robot, tool, hole), settings))
        rng = np.random.default_rng(1)
        for i in rng.permutation(len(motions))[:80]:
            branch, k, n, m = motions[i]
            slopes = twist[n] / hole.depth, twist[m] / hole.depth
            profile = straight_motion(hole.depth, legs.psi_t[k], slopes, periodic=True)
            assert best <= cost(robot, tool, hole, settings, profile, branch) + 1e-9

    @pytest.mark.long
    def test_nothing_next_to_the_answer_is_better(self, robot, tool, position):
        settings, hole = asking(*MIXED), position.hole
        found = search_weighted(Drilling(robot, tool, hole), settings)
        best = cost_of(robot, tool, hole, settings, found)
        rng = np.random.default_rng(2)
        for scale in (1e-1, 1e-2, 1e-3, 1e-4):
            for _ in range(25):
                psi = found.profile.psi + scale * rng.normal(size=3)
                nearby = cost(robot, tool, hole, settings, Profile(found.profile.standoff, psi), found.branch)
                assert best <= nearby + 1e-7

    @pytest.mark.parametrize("name", CRITERIA)
    def test_pairs_cost_what_the_motion_costs(self, robot, tool, position, name):
        """Legs judged one by one and joined, against the motion measured as a whole."""
        settings, hole = asking((name, 1.0)), position.hole
        problem = weighted.WeightedLegs(Drilling(robot, tool, hole), settings)
        for point in problem.survey():
            profile = straight_motion(hole.depth, point.psi_t, point.slopes, periodic=True)
            whole = cost(robot, tool, hole, replace(settings, min_rate=0.9 * settings.min_rate), profile, point.branch)
            if name == "lost_motion":  # of the better order, and of the wrist flip that was followed
                swapped = profile.reversed()
                whole = min(whole, cost(robot, tool, hole, replace(settings, min_rate=0.0), swapped, point.branch))
            assert point.cost == pytest.approx(
                whole, abs=2e-3 if name != "lost_motion" or point.branch % 2 == 0 else 0.15
            )


class TestWhatIsAsked:
    def test_the_mean_rule(self, robot, tool, positions):
        settings = asking(*MIXED, min_rate_rule="mean", min_rate=np.deg2rad(40.0))
        found = search_weighted(Drilling(robot, tool, positions[0].hole), settings)
        assert (found.reversals, found.keeps_threshold) == (0, True)
        assert found.score.mean_rate.min() >= np.deg2rad(40.0) * (1 - 1e-6)

    def test_the_bound_on_the_spin(self, robot, tool, positions):
        bound = np.deg2rad(35)
        settings = asking(*MIXED, psi_bound=bound)
        found = search_weighted(Drilling(robot, tool, positions[0].hole), settings)
        assert found.reversals == 0
        assert np.abs(found.profile.psi).max() <= bound + 1e-12

    def test_the_branch(self, robot, tool, positions):
        hole = replace(positions[0].hole, branch=3)
        found = search_weighted(Drilling(robot, tool, hole), asking(("manipulability", 1.0)))
        assert (found.branch, found.reversals) == (3, 0)

    def test_the_same_answer_twice(self, robot, tool, positions):
        once, again = (search_weighted(Drilling(robot, tool, positions[2].hole), asking(*MIXED)) for _ in range(2))
        assert np.array_equal(once.profile.psi, again.profile.psi)

    def test_out_of_reach_there_is_none(self, robot, tool):
        far = Hole("far", np.array([3.0, 0.0, 0.5]), np.array([1.0, 0.0, 0.0]), 0.02)
        assert search_weighted(Drilling(robot, tool, far), asking(*MIXED)) is None

    def test_where_joints_must_reverse_the_fewest_come_first(self, robot, tool, positions):
        """Deeper than any motion without reversal: never more of them for the sake of the sum."""
        deep = replace(positions[1].hole, depth=0.04)
        settings = asking(("travel", 1.0), ("limit_distance", 1.0))
        exact = search(Drilling(robot, tool, deep), Settings())
        assert exact.reversals > 0
        found = search_weighted(Drilling(robot, tool, deep), settings)
        assert found.reversals <= exact.reversals
        if found.reversals == exact.reversals and found.keeps_threshold == exact.keeps_threshold:
            sums = [
                objective_of(settings)(measure(Drilling(robot, tool, deep), one.evaluation, settings))
                for one in (found, exact)
            ]
            assert sums[0] <= sums[1]

    def test_a_threshold_out_of_reach_leaves_the_greatest_margin(self, robot, tool, positions):
        settings = asking(*MIXED, min_rate=np.deg2rad(500.0))
        found = search_weighted(Drilling(robot, tool, positions[0].hole), settings)
        exact = search(Drilling(robot, tool, positions[0].hole), replace(settings, weights=(), objective="margin"))
        assert not found.keeps_threshold
        assert found.score.min_rate.min() == pytest.approx(exact.score.min_rate.min(), rel=1e-6)
