"""The thesis' objective as a search meets it: words, counters, threads, the mirror law, and the second examination."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from oracles import sampled as twin
from zerorev.errors import InputError
from zerorev.motion.criteria import thesis_objective
from zerorev.motion.drilling import Drilling
from zerorev.motion.evaluation import evaluate
from zerorev.thesis.sampled import THESIS_MIN_RATE, SampledObjective, Weighing, even_fractions

ALL_ROUND = np.random.default_rng(0).uniform(-np.pi, np.pi, (60, 3))


def published(position):
    return np.deg2rad([position.psi_deg])


class TestSampledObjective:
    def test_is_the_best_branch_of_the_twin(self, robot, tool, position):
        objective, fractions = SampledObjective(Drilling(robot, tool, position.hole), samples=40), even_fractions(40)
        found = objective.judged(ALL_ROUND[:10])
        for m, motion in enumerate(ALL_ROUND[:10]):
            each = twin.judge(robot, tool, position.hole, fractions, motion, first_point=False)
            best = min(range(8), key=lambda branch: each[branch][0])
            assert found.score[m] == pytest.approx(each[best][0], abs=1e-9)
            assert each[found.branch[m]][0] == pytest.approx(each[best][0], abs=1e-9)
            assert found.reversals[m] == each[best][1]

    def test_the_published_motions_have_no_reversal(self, robot, tool, position):
        objective = SampledObjective(Drilling(robot, tool, position.hole))
        (score,), (branch,), (reversals,) = objective.judged(published(position))
        assert (branch // 2, reversals) == (position.branch // 2, 0)
        assert score == pytest.approx(np.deg2rad(position.travel_deg) / (84 * np.pi), rel=1e-3)

    def test_weights_are_those_asked_for(self, robot, tool, positions):
        hole = positions[0].hole
        reversals = SampledObjective(Drilling(robot, tool, hole), Weighing(reversals=1.0, travel=0.0))
        travel = SampledObjective(Drilling(robot, tool, hole), Weighing(reversals=0.0, travel=1.0))
        thesis = SampledObjective(Drilling(robot, tool, hole))
        counted, moved, both = (each.on_branches(ALL_ROUND)[0] for each in (reversals, travel, thesis))
        runs = thesis.on_branches(ALL_ROUND)[1] >= 0
        np.testing.assert_allclose(counted[runs] * 6, np.round(counted[runs] * 6), atol=1e-12)
        np.testing.assert_allclose(both[runs], 6 / 7 * counted[runs] + 1 / 7 * moved[runs], atol=1e-12)

    def test_counts_what_it_judges(self, robot, tool, positions):
        objective = SampledObjective(Drilling(robot, tool, positions[0].hole))
        assert (objective.evaluations, objective.first_zero) == (0, None)
        objective(np.zeros((7, 3)))
        assert (objective.evaluations, objective.first_zero) == (7, None)
        zeros = np.concatenate([np.zeros((2, 3)), published(positions[0]), published(positions[0])])
        assert (objective.reversals(zeros)[2:] == 0).all()
        assert (objective.branches(zeros)[2:] // 2 == positions[0].branch // 2).all()
        objective(zeros)
        assert (objective.evaluations, objective.first_zero) == (11, 10)
        objective(zeros)
        assert objective.first_zero == 10

    def test_is_the_same_to_the_last_bit_on_any_number_of_threads(self, robot, tool, position):
        alone = SampledObjective(Drilling(robot, tool, position.hole), threads=1).judged(ALL_ROUND)
        for threads in (2, 3, 7):
            shared = SampledObjective(Drilling(robot, tool, position.hole), threads=threads).judged(ALL_ROUND)
            for one, other in zip(alone, shared, strict=True):
                np.testing.assert_array_equal(one, other)

    def test_the_hole_may_name_the_branch(self, robot, tool, positions):
        hole = replace(positions[0].hole, branch=5)
        costs, reversals = SampledObjective(Drilling(robot, tool, hole)).on_branches(ALL_ROUND)
        found = SampledObjective(Drilling(robot, tool, hole)).judged(ALL_ROUND)
        np.testing.assert_array_equal(found.score, costs[:, 5])
        np.testing.assert_array_equal(found.reversals, reversals[:, 5])
        assert (found.branch == 5).all()

    def test_no_motions_give_no_scores(self, robot, tool, positions):
        assert SampledObjective(Drilling(robot, tool, positions[0].hole), threads=2)(np.empty((0, 3))).shape == (0,)


class TestTurns:
    def test_chosen_after_the_extents_the_mirror_law_holds(self, robot, tool, position):
        """Thesis eq. 4.12: start and end may change places."""
        objective = SampledObjective(Drilling(robot, tool, position.hole))
        spins = np.concatenate([ALL_ROUND, published(position)])
        there, back = objective.on_branches(spins), objective.on_branches(spins[:, ::-1])
        np.testing.assert_allclose(there[0], back[0], atol=1e-9)
        np.testing.assert_array_equal(there[1], back[1])

    def test_fixed_at_the_first_point_a_block_is_missing(self, robot, tool, positions):
        """The motion that the thesis names: psi = [-1, 0, 1] runs with 3 reversals, its mirror image does not run."""
        hole, spins = positions[0].hole, np.array([[-1.0, 0.0, 1.0], [1.0, 0.0, -1.0]])
        after, first = (SampledObjective(Drilling(robot, tool, hole), Weighing(turns=turns)).judged(spins)
                        for turns in ("after_extents", "first_point"))  # fmt: skip
        assert after.score[0] == pytest.approx(after.score[1], abs=1e-9)
        assert first.reversals.tolist() == [3, -1]
        assert first.score[0] == after.score[0]

    def test_fixed_at_the_first_point_is_never_better(self, robot, tool, positions):
        hole, both = positions[0].hole, (Weighing(), Weighing(turns="first_point"))
        after, first = (SampledObjective(Drilling(robot, tool, hole), each).on_branches(ALL_ROUND)[0] for each in both)
        assert (first >= after).all()
        assert (first > after).any()


class TestThreshold:
    def test_of_the_published_plans_only_position_1_keeps_it_on_the_mean(self, robot, tool, position):
        """Theory §5: 0.005 deg a step at 200 steps, which is another rate at every depth."""
        rate = np.deg2rad(0.005) * 200 / (2 * position.hole.depth)
        for rule, keeps in (("pointwise", False), ("mean", position.name == "position 1")):
            weighing = Weighing(min_rate=rate, min_rate_rule=rule)
            found = SampledObjective(Drilling(robot, tool, position.hole), weighing).on_branches(published(position))
            assert (found[1][0, position.branch] == 0) == keeps
            plain = SampledObjective(Drilling(robot, tool, position.hole)).on_branches(published(position))
            excess = found[0][0, position.branch] - plain[0][0, position.branch]
            assert excess == pytest.approx(0.0 if keeps else 1.0, abs=1e-12)

    def test_its_size_is_that_of_the_thesis(self):
        """0.005 deg a step, at 200 steps on 100 mm."""
        assert np.rad2deg(THESIS_MIN_RATE) * 100e-3 / 200 == pytest.approx(0.005)


class TestLookAgain:
    def test_sees_what_200_steps_overlook(self, robot, tool, positions):
        """A motion that just turns a joint round within the first step next to the target."""
        hole, branch = positions[0].hole, positions[0].branch
        start, target, end = published(positions[0])[0]
        shares = np.linspace(0.5, 1.0, 2001)
        spins = np.stack([np.full(2001, start), np.full(2001, target), target + shares * (end - target)], axis=1)

        def counted(spins, samples):
            return SampledObjective(Drilling(robot, tool, hole), samples=samples).on_branches(spins)[1][:, branch]

        spins = spins[counted(spins, 200) == 0][:20]  # where zero begins
        fine = counted(spins, 40_000)
        overlooked = np.flatnonzero(fine > 0)
        assert overlooked.size
        objective = SampledObjective(Drilling(robot, tool, hole))
        again = objective.examine(spins[overlooked[0]], branch)
        assert again.reversals == fine[overlooked[0]]
        assert again.exact.score.reversals >= again.reversals
        assert objective.evaluations == 0

    def test_is_equation_4_7_of_the_exact_evaluation(self, robot, tool, position):
        again = SampledObjective(Drilling(robot, tool, position.hole)).examine(published(position)[0], position.branch)
        exact = evaluate(robot, tool, position.hole, position.profile, position.branch)
        assert again.exact.score.reversals == exact.score.reversals == again.reversals == 0
        assert again.score == pytest.approx(thesis_objective(exact), abs=1e-6)


class TestBadInput:
    @pytest.mark.parametrize(
        ("field", "value"),
        [("reversals", -1.0), ("travel", -0.1), ("travel", np.nan), ("min_rate", -1.0), ("min_rate_rule", "often"),
         ("turns", "later")],
    )  # fmt: skip
    def test_weighing(self, field, value):
        with pytest.raises(InputError, match=field) as caught:
            Weighing(**{field: value})
        assert caught.value.accepted

    @pytest.mark.parametrize("samples", [0, -2, 3, 1.5, "200"])
    def test_samples(self, robot, tool, positions, samples):
        with pytest.raises(InputError, match="even number"):
            SampledObjective(Drilling(robot, tool, positions[0].hole), samples=samples)

    @pytest.mark.parametrize("fractions", [[0.0], [0.0, 0.5], [0.1, 1.0], [0.0, 0.6, 0.4, 1.0], [[0.0, 1.0]]])
    def test_fractions(self, robot, tool, positions, fractions):
        with pytest.raises(InputError, match="fractions"):
            SampledObjective(Drilling(robot, tool, positions[0].hole), fractions=np.array(fractions))

    def test_threads_and_shapes(self, robot, tool, positions):
        with pytest.raises(InputError, match="0 threads"):
            SampledObjective(Drilling(robot, tool, positions[0].hole), threads=0)
        with pytest.raises(InputError, match="start, target, end"):
            SampledObjective(Drilling(robot, tool, positions[0].hole))(np.zeros(3))
