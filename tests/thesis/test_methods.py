"""The registry of search methods: each finds a planted optimum, keeps to its budget, and is known by its seed."""

from __future__ import annotations

from dataclasses import dataclass, replace
from importlib.util import find_spec

import numpy as np
import pytest

from zerorev.errors import InputError
from zerorev.model.job import Settings
from zerorev.model.profile import Profile
from zerorev.motion.drilling import Drilling
from zerorev.motion.evaluation import evaluate
from zerorev.search import exact
from zerorev.thesis import methods
from zerorev.thesis.methods import METHODS, SampledProblem, methods_named
from zerorev.thesis.sampled import Judged
from zerorev.thesis.trial import Trial

BOTTOM = np.array([1.5, 0.5, -1.0])  # one sense of rotation, as the swarms begin (eq. 4.8)
BOX = 2.5
LOOKING = [name for name in METHODS if name != "exact"]  # at motions
CLOSE = {"direct": 0.02, "swarm_trial_2": 0.1}  # how close each comes [rad]; the others 0.05


@pytest.fixture(params=LOOKING)
def method(request):
    """Each method that looks at motions, where its library is installed."""
    needs = METHODS[request.param].needs
    if needs and find_spec(needs) is None:
        pytest.skip(f"needs {needs}")
    return request.param


class Bowl:
    """A plain bowl in place of eq. 4.7, which remembers where it was examined; below 0.01 it has no reversals."""

    def __init__(self, scale=1.0):
        self.looked, self.evaluations, self.first_zero, self.scale = [], 0, None, scale

    def __call__(self, spins):
        return self.judged(spins).score

    def judged(self, spins):
        self.looked.append(np.array(spins))
        score = self.scale * ((spins - BOTTOM) ** 2).sum(axis=1)
        zeros = np.flatnonzero(score < 0.01)
        if self.first_zero is None and zeros.size:
            self.first_zero = self.evaluations + int(zeros[0]) + 1
        self.evaluations += len(spins)
        return Judged(score, np.full(len(spins), 3), np.where(score < 0.01, 0, 2))


@dataclass(frozen=True)
class Planted(SampledProblem):
    """A problem with a bowl in it; all of its objectives are kept."""

    made: tuple = ()
    flat: bool = False

    def objective(self):
        bowl = Bowl(scale=0.0) if self.flat else Bowl()
        object.__setattr__(self, "made", (*self.made, bowl))
        return bowl


@pytest.fixture
def planted(robot, tool, positions):
    return Planted(Drilling(robot, tool, positions[0].hole), bound=BOX)


class TestEveryMethod:
    def test_comes_close_to_a_planted_optimum(self, planted, method):
        outcome = METHODS[method].run(planted, 0, 5100)
        assert np.abs(outcome.spins - BOTTOM).max() < CLOSE.get(method, 0.05)
        assert outcome.score == pytest.approx(((outcome.spins - BOTTOM) ** 2).sum())
        assert outcome.branch == 3
        assert outcome.reversals == (0 if outcome.score < 0.01 else 2)

    @pytest.mark.parametrize("budget", [400, 1234])
    def test_keeps_to_its_budget_and_its_box(self, planted, method, budget):
        outcome = METHODS[method].run(planted, 1, budget)
        bowl, *_ = planted.made
        assert outcome.evaluations == bowl.evaluations == sum(map(len, bowl.looked)) <= budget
        assert outcome.evaluations >= budget / 2  # swarms may settle, and end with whole iterations
        assert np.abs(np.concatenate(bowl.looked)).max() <= BOX
        assert outcome.first_zero == bowl.first_zero

    def test_reports_the_best_that_it_examined(self, planted, method):
        outcome = METHODS[method].run(planted, 2, 600)
        looked = np.concatenate(planted.made[0].looked)
        np.testing.assert_array_equal(outcome.spins, looked[((looked - BOTTOM) ** 2).sum(axis=1).argmin()])

    def test_is_known_by_its_seed(self, planted, method):
        state = np.random.get_state()[1].copy()  # noqa: NPY002
        first, again, other = (METHODS[method].run(planted, seed, 400).spins for seed in (4, 4, 5))
        np.testing.assert_array_equal(first, again)
        assert (first != other).any() == METHODS[method].random
        # the generator that all of NumPy shares is left alone
        np.testing.assert_array_equal(np.random.get_state()[1], state)  # noqa: NPY002

    def test_ends_where_nothing_can_be_run(self, planted, method):
        """A flat objective, as eq. 4.7 is where no pose is in reach."""
        outcome = METHODS[method].run(replace(planted, flat=True), 0, 800)
        assert 0 < outcome.evaluations <= 800
        assert np.isfinite(outcome.spins).all()


class TestOnAHole:
    @pytest.fixture
    def problem(self, robot, tool, position):
        return SampledProblem(Drilling(robot, tool, position.hole))

    def test_exact_is_the_exact_search_without_a_threshold(self, problem):
        outcome = METHODS["exact"].run(problem, 0, 400)
        found = exact.search(problem.drilling, Settings(min_rate=0.0, psi_bound=np.pi))
        np.testing.assert_array_equal(outcome.spins, found.profile.psi)
        assert (outcome.branch, outcome.reversals, outcome.evaluations) == (found.branch, 0, 0)
        # its score is that of the sampled objective, which has the same travel
        assert outcome.score == pytest.approx(found.score.travel / (84 * np.pi), rel=1e-4)

    def test_exact_keeps_the_threshold_of_the_weighing(self, problem):
        least = np.deg2rad(10.0)
        outcome = METHODS["exact"].run(replace(problem, weighing=methods.Weighing(min_rate=least)), 0, 400)
        profile = Profile.straight(problem.drilling.hole.depth, *outcome.spins)
        score = evaluate(
            problem.drilling.robot, problem.drilling.tool, problem.drilling.hole, profile, outcome.branch
        ).score
        assert score.min_rate.min() >= least * (1 - 1e-6)

    def test_exact_finds_nothing_out_of_reach(self, problem):
        far = replace(
            problem,
            drilling=replace(
                problem.drilling, hole=replace(problem.drilling.hole, target=10 * problem.drilling.hole.target)
            ),
        )
        assert METHODS["exact"].run(far, 0, 400) is None

    @pytest.mark.parametrize("name", ["swarm", "differential_evolution"])
    def test_no_outcome_scores_better_than_exact_where_it_has_no_reversal(self, problem, name):
        best = METHODS["exact"].run(problem, 0, 400)
        outcome = METHODS[name].run(problem, 0, 2000)
        profile = Profile.straight(problem.drilling.hole.depth, *outcome.spins)
        score = evaluate(
            problem.drilling.robot, problem.drilling.tool, problem.drilling.hole, profile, outcome.branch
        ).score
        assert score.reversals > 0 or score.travel >= best.score * 84 * np.pi * (1 - 1e-4)

    def test_a_swarm_is_as_long_as_its_table_says(self, planted):
        assert METHODS["swarm_trial_4"].run(planted, 0, 100_000).evaluations <= 50 * 201
        assert METHODS["swarm"].run(planted, 0, 100_000).evaluations <= 100 * 51


class TestTrial:
    def test_more_motions_than_the_budget_holds_are_not_examined(self):
        seen = []

        def algorithm(trial, seed):
            seen.append(len(trial(np.zeros((7, 3)))))
            trial(np.arange(30).reshape(10, 3) * 1.0)
            seen.append("never")

        bowl = Bowl()
        trial = Trial(bowl, 10, np.full(3, -BOX), np.full(3, BOX)).run(algorithm, 0)
        assert seen == [7]
        assert (bowl.evaluations, trial.left) == (10, 0)

    def test_an_error_of_the_objective_is_not_swallowed(self):
        def broken(spins):
            raise ZeroDivisionError

        trial = Trial(broken, 10, np.full(3, -BOX), np.full(3, BOX))
        for method in ("differential_evolution", "direct", "dual_annealing"):
            with pytest.raises(ZeroDivisionError):
                trial.run(getattr(methods.scipys, method), 0)


class TestRegistry:
    def test_an_unknown_name_lists_the_known_ones(self):
        with pytest.raises(InputError, match="no method 'simplex'") as error:
            methods_named(["exact", "simplex"])
        assert all(name in str(error.value) for name in METHODS)

    @pytest.mark.parametrize("names", [[], ["swarm", "exact", "swarm"]], ids=["none", "twice"])
    def test_none_and_twice_are_refused(self, names):
        with pytest.raises(InputError, match="methods: "):
            methods_named(names)

    def test_order_is_kept(self):
        assert list(methods_named(["swarm", "exact"])) == ["swarm", "exact"]

    def test_a_package_that_is_missing_is_named(self, monkeypatch):
        monkeypatch.setattr(methods, "find_spec", lambda name: None)
        with pytest.raises(InputError, match=r"cma needs cma.*pip install 'zerorev\[methods\]'"):
            methods_named(["exact", "cma"])
        assert list(methods_named(["swarm", "direct"])) == ["swarm", "direct"]
