"""Critical rates and what they predict: against finite differences, evaluated motions and the exact answers."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from scipy.stats import spearmanr

from oracles.places import JOBS
from zerorev.cli import BAD_INPUT, FINE, main
from zerorev.errors import InputError
from zerorev.files.io import plan_to_json, read_plan, write_plan
from zerorev.model.hole import Hole
from zerorev.model.job import Job, Settings
from zerorev.model.profile import Profile
from zerorev.model.tool import Tool
from zerorev.motion.critical import critical, critical_at, kappa_of
from zerorev.motion.drilling import Drilling, joint_rates
from zerorev.motion.evaluation import evaluate
from zerorev.motion.kinematics import inverse, tcp_pose
from zerorev.planning.hole import plan
from zerorev.planning.job import plan_job
from zerorev.search import prediction
from zerorev.search.deepest import deepest_stroke
from zerorev.search.exact import search
from zerorev.search.prediction import earlier_root, first_order_root, predict, second_order_root

X = np.array([1.0, 0.0, 0.0])
OFF = Settings(min_rate=0.0)
JOB = JOBS / "thesis_positions.yaml"
DEG_PER_MM = np.deg2rad(1e3)


def hole_at(target_mm, depth=0.05):
    return Hole("h", np.array(target_mm) * 1e-3, X, depth)


POSITION_1 = hole_at((500, 300, 800))


def angles(robot, tool, hole, standoff, psi):
    """All branches by inverse kinematics alone, shape (..., 8, 6)."""
    return inverse(robot, tcp_pose(hole, standoff, psi) @ np.linalg.inv(tool.T_flange_tcp))


def wrapped(difference):
    return (difference + np.pi) % (2 * np.pi) - np.pi


class TestCritical:
    def test_as_theory_2_has_them(self, robot, tool):
        found = critical(Drilling(robot, tool, POSITION_1), 4, np.deg2rad(-5.9388))
        expected = [0.294, -0.480, -0.436, -0.005, 0.167, 0.388]
        np.testing.assert_allclose(found.kappa / DEG_PER_MM, expected, atol=1.1e-3)
        assert found.spread == pytest.approx(found.kappa.max() - found.kappa.min()) == pytest.approx(found.width)

    def test_against_finite_differences_of_the_inverse_kinematics(self, any_robot, tool):
        hole = Hole("h", np.array([0.45, 0.2, 0.7]), np.array([0.8, -0.3, -0.5]), 0.02)
        psi, step = 0.7, 1e-6
        places = [angles(any_robot, tool, hole, s, p) for s, p in ((step, psi), (-step, psi))]
        theta_s = wrapped(places[0] - places[1]) / (2 * step)
        places = [angles(any_robot, tool, hole, 0.0, p) for p in (psi + step, psi - step)]
        theta_psi = wrapped(places[0] - places[1]) / (2 * step)
        seen = critical_at(Drilling(any_robot, tool, hole), psi)
        assert {each.branch for each in seen} == set(np.flatnonzero(~np.isnan(theta_s[:, 0])))
        assert len(seen) >= 2
        for each in seen:
            expected = -theta_s[each.branch] / theta_psi[each.branch]
            np.testing.assert_allclose(each.kappa, expected, rtol=1e-4, atol=1e-4)

    @pytest.mark.parametrize("branch", [0, 3, 4])
    @pytest.mark.parametrize("psi", [-0.1, 0.2, -0.5])
    def test_slopes_just_beyond_the_bracket_have_no_reversal_and_slopes_just_within_have_one(
        self, robot, tool, branch, psi
    ):
        depth = 1e-5
        hole, at = hole_at((500, 300, 800), depth), critical(Drilling(robot, tool, POSITION_1), branch, psi)
        for beyond, reversals in ((1e-3, 0), (-1e-3, 1)):
            ends = psi + depth * np.array([at.below - beyond * at.width, at.above + beyond * at.width])
            seen = evaluate(robot, tool, hole, Profile.straight(depth, ends[0], psi, ends[1]), branch)
            assert seen.score is not None, seen.findings
            assert min(seen.score.reversals, 1) == reversals

    def test_the_threshold_is_met_at_the_ends_of_the_bracket(self, robot, tool):
        least = np.deg2rad(10.0)
        psi, step = -0.1, 1e-6
        at = critical(Drilling(robot, tool, POSITION_1), 4, psi, least)
        for slope in (at.below, at.above):
            on, back = (angles(robot, tool, POSITION_1, s, psi + slope * s)[4] for s in (step, -step))
            assert np.abs(wrapped(on - back) / (2 * step)).min() == pytest.approx(least, rel=1e-4)
        assert at.width > at.spread

    def test_without_a_lever_the_bracket_is_infinite(self, robot, tool):
        T = tool.T_flange_tcp.copy()
        T[2, 3] = -robot.arm.c4
        at = critical(Drilling(robot, Tool("no lever", T), POSITION_1), 4, 0.3)
        assert np.isinf(at.kappa[:3]).all()
        assert (at.spread, at.below, at.above) == (np.inf, -np.inf, np.inf)

    def test_out_of_reach(self, robot, tool):
        far = hole_at((3000, 0, 500))
        assert np.isnan(critical(Drilling(robot, tool, far), 0, 0.0).kappa).all()
        assert np.isnan(critical(Drilling(robot, tool, far), 0, 0.0).spread)
        assert critical_at(Drilling(robot, tool, far), 0.0) == ()

    def test_no_such_branch(self, robot, tool):
        with pytest.raises(InputError, match="branch 8"):
            critical(Drilling(robot, tool, POSITION_1), 8, 0.0)


class TestRoots:
    @example(2.0, 1e-308, 0.0)
    @example(2.0, -1e-308, 0.0)
    @given(st.floats(1e-3, 1e3), st.floats(-1e3, 1e3), st.floats(-1e3, 1e3))
    def test_against_the_companion_matrix(self, a, b, c):
        roots = np.roots([c / 2, b, a]) if abs(c) > 1e-6 else np.array([])
        real = roots[np.abs(roots.imag) < 1e-9 * np.abs(roots)].real
        expected = min(real[real > 0], default=np.inf)
        a, b, c = (np.array(value) for value in (a, b, c))
        if roots.size and (roots.imag == 0).all() == (np.abs(b * b - 2 * a * c) > 1e-6 * b * b):
            assert float(second_order_root(a, b, c)) == pytest.approx(expected, rel=1e-6)
        with np.errstate(over="ignore"):
            down = -a / b if b < 0 else np.inf
        assert float(first_order_root(a, b, c)) == pytest.approx(down)
        assert earlier_root(a, b, c) == min(first_order_root(a, b, c), second_order_root(a, b, c))

    def test_what_is_not_above_zero_has_no_way_to_go(self):
        for root in (first_order_root, second_order_root, earlier_root):
            assert root(np.array([0.0, -1.0]), np.array(1.0), np.array(1.0)).tolist() == [0.0, 0.0]


def test_the_expansion_is_that_of_the_joints_along_a_leg(robot, tool):
    """Third order by the rates' derivatives against inverse kinematics: the error shrinks with the fourth power."""
    line = prediction._target_line(Drilling(robot, tool, POSITION_1), OFF)
    n = int(np.flatnonzero(line.branch == 4)[7])
    u, errors = 8.0, []
    powers = [np.array([u**k for k in range(len(order))]) @ order[:, n] for order in line.motion]
    for s in (0.004, 0.008):
        predicted = powers[0] * s + powers[1] * s**2 / 2 + powers[2] * s**3 / 6
        there = angles(robot, tool, POSITION_1, s, line.psi[n] + u * s)[4]
        errors.append(np.abs(wrapped(there - line.angles[n]) - predicted).max())
    assert errors[0] < 1e-5
    assert errors[1] / errors[0] == pytest.approx(16, rel=0.25)


class TestPredict:
    @pytest.mark.parametrize("settings", [OFF, Settings()], ids=["no threshold", "threshold"])
    def test_the_width_of_the_bracket_bounds_the_twist_of_what_the_search_finds(self, robot, tool, position, settings):
        hole = position.hole
        found = search(Drilling(robot, tool, hole), settings)
        assert found.reversals == 0
        start, target, end = found.profile.psi
        at = critical(
            Drilling(robot, tool, hole), found.branch, target, settings.min_rate if found.keeps_threshold else 0.0
        )
        bound = predict(Drilling(robot, tool, hole), settings).cheapest.width * hole.depth
        assert bound <= at.width * hole.depth * (1 + 1e-6) <= abs(end - start) * (1 + 2e-6)

    def test_the_narrowest_bracket_lies_between_those_of_a_coarser_and_of_a_finer_grid(self, robot, tool, position):
        hole, least = position.hole, []
        for count in (361, 7201):
            spins = np.linspace(-np.pi, np.pi, count)
            inside = angles(robot, tool, hole, 0.0, spins)
            turns = np.ceil((robot.limits.lower - inside) / (2 * np.pi))
            use = (inside + 2 * np.pi * turns <= robot.limits.upper).all(axis=-1)
            kappa = kappa_of(*joint_rates(Drilling(robot, tool, hole), 0.0, spins))
            least.append((kappa.max(axis=-1) - kappa.min(axis=-1))[use].min())
        narrowest = predict(Drilling(robot, tool, hole), OFF).cheapest.width
        assert least[1] * (1 - 1e-4) <= narrowest <= least[0] * (1 + 1e-4)

    def test_the_places_are_in_the_branch_and_the_bound_that_are_asked_for(self, robot, tool):
        settings = replace(OFF, psi_bound=0.4)
        predicted = predict(Drilling(robot, tool, replace(POSITION_1, branch=4)), settings)
        for at in (predicted.cheapest, predicted.deepest_at):
            assert at.branch == 4
            assert abs(at.psi) <= 0.4
        assert predicted.deepest < predict(Drilling(robot, tool, POSITION_1), OFF).deepest

    def test_a_deeper_hole_needs_more_twist_up_to_where_none_is_predicted(self, robot, tool):
        twists = [
            predict(Drilling(robot, tool, hole_at((500, 300, 800), depth)), OFF).least_twist
            for depth in (0.02, 0.05, 0.5)
        ]
        assert twists[0] < twists[1] < twists[2] == np.inf

    def test_the_threshold_costs_depth(self, robot, tool):
        assert (
            predict(Drilling(robot, tool, POSITION_1)).deepest < predict(Drilling(robot, tool, POSITION_1), OFF).deepest
        )

    def test_nothing_is_predicted_out_of_reach(self, robot, tool):
        nothing = predict(Drilling(robot, tool, hole_at((3000, 0, 500))))
        assert (nothing.cheapest, nothing.least_twist, nothing.deepest, nothing.deepest_at) == (None, np.inf, 0.0, None)

    def test_nothing_is_predicted_without_a_lever(self, robot, tool):
        T = tool.T_flange_tcp.copy()
        T[2, 3] = -robot.arm.c4
        assert predict(Drilling(robot, Tool("no lever", T), POSITION_1)).deepest == 0

    @pytest.mark.long
    def test_as_good_as_the_documentation_says(self, robot, tool):
        rng, exact, predicted = np.random.default_rng(11), [], []
        while len(exact) < 30:
            hole = Hole("h", rng.uniform([-0.9, -0.9, -0.5], [0.9, 0.9, 1.3]), rng.normal(size=3), 0.01)
            depth = deepest_stroke(robot, tool, hole, OFF).depth
            if depth > 0:
                exact.append(depth)
                predicted.append(predict(Drilling(robot, tool, hole), OFF).deepest)
        error = np.abs(np.array(predicted) / exact - 1)
        assert spearmanr(predicted, exact).statistic > 0.85
        assert np.median(error) < 0.25


class TestCommand:
    def test_table(self, capsys):
        assert main(["rates", str(JOB)]) == FINE
        out = capsys.readouterr().out
        row = next(line for line in out.splitlines() if "position_1" in line)
        for part in ("156.83", "-0.240", "0.614"):
            assert part in row

    def test_rates_at_a_spin(self, capsys):
        assert main(["rates", str(JOB), "--psi-deg", "-5.9388", "--json"]) == FINE
        found = json.loads(capsys.readouterr().out)
        one = next(each for each in found if each["id"] == "position_1" and each["branch"] == 4)
        assert one["critical_rates_deg_per_mm"] == pytest.approx(
            [0.294, -0.480, -0.437, -0.005, 0.166, 0.388], abs=1e-3
        )
        assert main(["rates", str(JOB), "--psi-deg", "-5.9388"]) == FINE
        assert "4, 5" in capsys.readouterr().out

    def test_json(self, capsys):
        assert main(["rates", str(JOB), "--json"]) == FINE
        first = json.loads(capsys.readouterr().out)[0]
        assert first["twist_bound_deg"] <= first["least_twist_deg"]
        assert first["deepest_mm"] > 50

    def test_no_such_job(self, capsys):
        assert main(["rates", "nowhere.yaml"]) == BAD_INPUT
        assert "nowhere.yaml" in capsys.readouterr().err


class TestPlan:
    def test_states_the_critical_rates_that_its_legs_bracket(self, robot, tool, position):
        answer = plan(robot, tool, replace(position.hole, profile=position.profile, branch=position.branch))
        at = critical(Drilling(robot, tool, position.hole), position.branch, position.profile.psi[1])
        np.testing.assert_allclose(answer.critical_rates, at.kappa)
        low, high = sorted(position.profile.twist_rate)
        assert (low < answer.critical_rates).all()
        assert (answer.critical_rates < high).all()

    def test_of_a_corner_placed_deeper_they_are_those_at_the_corner(self, robot, tool):
        settings = Settings(min_rate=0.0, blend=0.01, deepen_corner=True)
        deeper = Profile.straight(0.05, 0.25, -0.1, -0.55, corner=settings.corner_standoff)
        answer = plan(robot, tool, replace(POSITION_1, profile=deeper, branch=4), settings)
        corner = replace(POSITION_1, target=POSITION_1.target + 0.005 * X)
        np.testing.assert_allclose(answer.critical_rates, critical(Drilling(robot, tool, corner), 4, -0.1).kappa)

    def test_the_file_holds_them(self, robot, tool, position, tmp_path):
        hole = replace(position.hole, profile=position.profile, branch=position.branch)
        answer = plan_job(Job(robot, tool, (hole,), OFF))
        kappa = answer.holes[0].critical_rates
        (data,) = plan_to_json(answer)["holes"]
        np.testing.assert_allclose(data["critical_rates_deg_per_mm"], kappa / DEG_PER_MM)
        assert data["twist_spread_deg_per_mm"] == pytest.approx((kappa.max() - kappa.min()) / DEG_PER_MM)
        write_plan(answer, tmp_path / "plan.json")
        again = read_plan(tmp_path / "plan.json")
        np.testing.assert_allclose(again.holes[0].critical_rates, kappa)
        assert plan_to_json(again) == plan_to_json(answer)

    def test_without_a_lever_there_is_no_spread(self, robot, tool):
        T = tool.T_flange_tcp.copy()
        T[2, 3] = -robot.arm.c4
        hole = replace(POSITION_1, profile=Profile.straight(0.05, 0.3, 0.3, 0.3))
        (data,) = plan_to_json(plan_job(Job(robot, Tool("no lever", T), (hole,), OFF)))["holes"]
        assert data["critical_rates_deg_per_mm"][:3] == [None] * 3
        assert data["twist_spread_deg_per_mm"] is None
