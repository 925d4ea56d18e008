"""The thesis' swarm: its rules one by one on a plain bowl, its inertia schemes, and what it finds at the positions."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from zerorev.errors import InputError
from zerorev.motion.drilling import Drilling
from zerorev.thesis.inertia import INERTIA, Chaotic, Constant, Geometric, Linear, Random
from zerorev.thesis.sampled import Judged, SampledObjective
from zerorev.thesis.swarm import TABLE_3, TABLE_4, SwarmSettings, run_swarm

BOTTOM = np.array([1.0, -2.0, 0.5])


class Bowl:
    """A plain bowl in place of eq. 4.7; within `zero` of its bottom there are no reversals."""

    def __init__(self, bottom=BOTTOM, zero=0.0):
        self.bottom, self.zero, self.looked = np.array(bottom), zero, []

    def judged(self, spins):
        self.looked.append(spins)
        score = ((spins - self.bottom) ** 2).sum(axis=1)
        return Judged(score, np.full(len(spins), 3), np.where(score < self.zero, 0, 6))


def swarm(bowl=None, **settings):
    return run_swarm(bowl or Bowl(), SwarmSettings(**settings))


class TestRun:
    def test_comes_close_to_a_planted_optimum(self):
        apart = [np.abs(swarm(seed=seed).spins - BOTTOM).max() for seed in range(9)]
        assert np.median(apart) < 0.02

    def test_is_known_by_its_seed(self):
        first, again, other = (swarm(seed=seed, keep_history=True).history.positions for seed in (4, 4, 5))
        np.testing.assert_array_equal(first, again)
        assert (first[0] != other[0]).all()

    def test_tells_the_best_that_it_has_seen(self):
        bowl = Bowl()
        found = swarm(bowl, keep_history=True)
        looked = np.concatenate(bowl.looked)
        scores = ((looked - BOTTOM) ** 2).sum(axis=1)
        assert found.score == scores.min() == found.own.score.min() == found.history.best[-1]
        np.testing.assert_array_equal(found.spins, looked[scores.argmin()])
        assert found.evaluations == len(looked) == found.history.scores.size
        assert (found.branch, found.reversals) == (3, 6)

    def test_moves_by_equation_4_6(self):
        """Each move is the last one, shortened by W_in, and pulls towards both bests by no more than their weights."""
        found = swarm(particles=20, iterations=12, own_weight=0.3, swarm_weight=0.2, stop_when_settled=False,
                      keep_history=True, bounds=(-50.0, 50.0), inertia=Constant(0.4), first_velocity=0.01)  # fmt: skip
        x, scores = found.history.positions, found.history.scores
        for t in range(1, 12):
            leader = scores[: t + 1].argmin(axis=0)
            own = np.take_along_axis(x[: t + 1], leader[None, :, None], axis=0)[0]
            best = own[scores[: t + 1].min(axis=0).argmin()]
            pull = (x[t + 1] - x[t]) - 0.4 * (x[t] - x[t - 1])
            for p in range(20):
                towards = np.stack([0.3 * (own[p] - x[t, p]), 0.2 * (best - x[t, p])], axis=1)
                (r, s), *_ = np.linalg.lstsq(towards, pull[p], rcond=None)
                np.testing.assert_allclose(towards @ [r, s], pull[p], atol=1e-9)
                if np.linalg.matrix_rank(towards, tol=1e-6) == 2:
                    assert -1e-6 <= min(r, s) <= max(r, s) <= 1 + 1e-6

    def test_begins_as_equation_4_8_says_and_stays_within_its_bounds(self):
        bowl = Bowl([3.0, 3.1, -3.1])
        swarm(bowl, particles=400, iterations=8, bounds=(-2.0, 3.0), seed=1)
        start, target, end = bowl.looked[0].T
        assert ((target - start) * (end - target) >= 0).all()
        for spins in (start, target):
            assert np.histogram(spins, 5, (-2.0, 3.0))[0].min() > 50
        everywhere = np.concatenate(bowl.looked)
        assert (everywhere.min(), everywhere.max()) == (-2.0, 3.0)

    def test_begins_at_the_guess(self):
        bowl = Bowl()
        found = swarm(bowl, start=tuple(BOTTOM), iterations=3)
        np.testing.assert_array_equal(bowl.looked[0][0], BOTTOM)
        assert found.score == 0.0

    def test_moves_no_farther_than_it_may(self):
        for most in (0.05, 0.3):
            found = swarm(max_velocity=most, keep_history=True, iterations=10)
            moves = np.linalg.norm(np.diff(found.history.positions, axis=0), axis=2)
            assert most - 1e-9 < moves.max() < most + 1e-9

    def test_one_particle_is_a_swarm(self):
        assert swarm(particles=1, stop_when_settled=False).evaluations == 51

    def test_no_iteration_judges_the_beginning(self):
        found = swarm(iterations=0, keep_history=True)
        assert (found.evaluations, found.iterations, found.history.inertia.size) == (100, 0, 0)


class TestStopping:
    def test_after_the_iterations(self):
        found = swarm(iterations=7, stop_when_settled=False)
        assert (found.stopped, found.iterations, found.evaluations) == ("iterations", 7, 800)

    def test_when_95_percent_move_by_less_than_1_percent(self):
        """Eq. 4.3; the move that shows it is not judged any more."""
        found = swarm(iterations=500, keep_history=True)
        assert found.stopped == "settled"
        assert found.iterations < 500
        x = found.history.positions
        moved = np.linalg.norm(np.diff(x, axis=0), axis=2) / np.linalg.norm(x[1:], axis=2)
        assert ((moved < 0.01).mean(axis=1) < 0.95).all()
        on = swarm(iterations=found.iterations + 1, stop_when_settled=False, keep_history=True).history.positions
        np.testing.assert_array_equal(on[:-1], x)
        moved = np.linalg.norm(on[-1] - on[-2], axis=1) / np.linalg.norm(on[-1], axis=1)
        assert (moved < 0.01).mean() >= 0.95
        np.testing.assert_array_equal(found.last_spins, x[-1])

    def test_at_the_first_motion_without_reversal(self):
        for zero, seed in ((0.3, 0), (0.02, 1), (100.0, 2)):
            found = swarm(Bowl(zero=zero), stop_at_zero=True, seed=seed, keep_history=True)
            assert (found.stopped, found.reversals) == ("zero", 0)
            found_at = (found.history.reversals == 0).any(axis=1)
            assert found_at.tolist() == [False] * found.iterations + [True]
            assert found.score < zero
        assert found.iterations == 0
        assert swarm(Bowl(zero=0.3), seed=0).stopped != "zero"


class TestInertia:
    def weights(self, scheme, count=50, seed=0):
        return scheme.weights(count, np.random.default_rng(seed))

    def test_random(self):
        drawn = self.weights(Random(), 5000)
        assert 0.5 <= drawn.min() < 0.51
        assert 0.99 < drawn.max() < 1.0
        assert drawn.mean() == pytest.approx(0.75, abs=0.01)
        assert (drawn != self.weights(Random(), 5000, seed=1)).any()

    def test_decaying_and_growing(self):
        """Table 3, trials 2 and 5: each the factor times the one before."""
        for name, first, factor in (("decaying", 0.7, 0.95), ("growing", 0.1, 1.05)):
            found, expected = self.weights(INERTIA[name], 25), first
            for weight in found:
                assert weight == pytest.approx(expected, rel=1e-12)
                expected *= factor

    def test_linear(self):
        """Table 3, trial 8."""
        np.testing.assert_allclose(self.weights(INERTIA["linear"]), 0.7 - 0.7 * np.arange(50) / 50, atol=1e-15)

    def test_constant(self):
        assert (self.weights(Constant(0.6)) == 0.6).all()

    def test_chaotic(self):
        """What is left when the straight line is taken off follows the logistic map."""
        found = self.weights(Chaotic(0.9, 0.4), 40)
        z = (found - 0.5 * (1 - np.arange(40) / 40)) / 0.4
        assert ((z > 0) & (z < 1)).all()
        np.testing.assert_allclose(z[1:], 4 * z[:-1] * (1 - z[:-1]), atol=1e-9)
        assert np.ptp(z) > 0.9

    @pytest.mark.parametrize("name", INERTIA)
    def test_every_scheme_runs_by_name(self, name):
        found = swarm(inertia=name, keep_history=True, iterations=10, stop_when_settled=False)
        assert found.history.inertia.shape == (10,)
        assert found.score < found.history.best[0]

    def test_one_weight_an_iteration(self):
        for count in (0, 1, 7):
            assert all(self.weights(scheme, count).shape == (count,) for scheme in INERTIA.values())


class TestTable3:
    def test_is_that_of_the_thesis(self):
        sizes = {n: (trial.particles, trial.iterations) for n, trial in TABLE_3.items()}
        assert sizes == {1: (200, 25), 2: (200, 25), 3: (100, 50), 4: (50, 200), 5: (100, 50), 6: (100, 50),
                         7: (100, 50), 8: (100, 50)}  # fmt: skip
        pulls = {n: (trial.own_weight, trial.swarm_weight) for n, trial in TABLE_3.items()}
        assert pulls == dict.fromkeys(range(1, 9), (0.2, 0.1)) | {6: (0.1, 0.2), 7: (0.2, 0.4)}
        schemes = [TABLE_3[n].scheme for n in range(1, 9)]
        half = Random(0.5, 1.0)
        assert schemes == [half, Geometric(0.7, 0.95), half, half, Geometric(0.1, 1.05), half, Random(0.1, 0.6),
                           Linear(0.7, 0.0)]  # fmt: skip
        assert TABLE_3[3] == TABLE_4 == SwarmSettings()


class TestBadInput:
    @pytest.mark.parametrize(
        ("field", "value"),
        [
            ("particles", 0), ("particles", 2.5), ("particles", True), ("iterations", -1), ("seed", 1.5), ("seed", "1"),
            ("seed", -1), ("seed", None), ("own_weight", -0.1), ("swarm_weight", np.nan), ("first_velocity", -1.0),
            ("bounds", (1.0, -1.0)), ("bounds", (1.0, 1.0)), ("bounds", (-np.inf, 0.0)), ("max_velocity", 0.0),
            ("start", (0.0, 0.0)), ("start", (0.0, 0.0, 4.0)),
        ],
    )  # fmt: skip
    def test_says_what_and_what_would_be_accepted(self, field, value):
        with pytest.raises(InputError, match=field) as caught:
            SwarmSettings(**{field: value})
        assert caught.value.accepted

    def test_an_unknown_scheme_names_the_known_ones(self):
        with pytest.raises(InputError, match="swirling") as caught:
            SwarmSettings(inertia="swirling")
        assert all(name in caught.value.accepted for name in INERTIA)

    def test_schemes_have_ranges(self):
        for scheme, numbers in ((Random, (0.9, 0.5)), (Geometric, (-0.1, 0.9)), (Constant, (np.nan,))):
            with pytest.raises(InputError, match="inertia"):
                scheme(*numbers)


def runs(robot, tool, hole, seeds):
    return [run_swarm(SampledObjective(Drilling(robot, tool, hole)), replace(TABLE_4, seed=seed)) for seed in seeds]


class TestPositions:
    def test_position_1_always_reaches_zero(self, robot, tool, positions):
        found = runs(robot, tool, positions[0].hole, range(3))
        assert all(run.reversals == 0 for run in found)
        again = SampledObjective(Drilling(robot, tool, positions[0].hole))(found[0].spins[None])
        assert again[0] == found[0].score

    def test_is_the_same_to_the_last_bit_on_any_number_of_threads(self, robot, tool, positions):
        settings = replace(TABLE_4, iterations=10, keep_history=True)
        drilling = Drilling(robot, tool, positions[1].hole)
        swarms = (run_swarm(SampledObjective(drilling, threads=threads), settings) for threads in (1, 2))
        one, two = (found.history for found in swarms)
        for name in ("positions", "scores", "reversals", "branches"):
            np.testing.assert_array_equal(getattr(one, name), getattr(two, name))

    @pytest.mark.long
    def test_success_over_100_seeds(self, robot, tool, positions):
        """Theory §7: 100 % at position 1, where about half of the particles get there, 46 % and 98 % at the others."""
        for position, least, most in zip(positions, (100, 30, 94), (100, 60, 100), strict=True):
            found = runs(robot, tool, position.hole, range(100))
            assert least <= sum(run.reversals == 0 for run in found) <= most
            if least == most:
                share = np.mean([(run.own.reversals == 0).mean() for run in found])
                assert 0.35 < share < 0.6
