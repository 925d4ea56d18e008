"""The order of motions, against the rules of theory §3.1 written out one by one, on made-up scores."""

from __future__ import annotations

from functools import cmp_to_key
from itertools import pairwise

import numba
import numpy as np
import pytest

from zerorev.model.hole import Hole
from zerorev.model.job import Settings
from zerorev.model.map_task import Question
from zerorev.model.plan import Score
from zerorev.model.profile import Profile
from zerorev.model.quantity import quantity
from zerorev.motion.drilling import Drilling
from zerorev.motion.evaluation import Evaluation, meets_threshold
from zerorev.planning.hole import plan
from zerorev.search.rank import Candidate, Order

X = np.array([1.0, 0.0, 0.0])
THRESHOLD = float(np.deg2rad(10.0))


def candidate(settings, per_joint, rate, travel, spins, branch=0):
    """A motion that does this to the joints: count of turns of each, rate of each [rad/m], travel [rad]."""
    score = Score(tuple(per_joint), (), travel, np.array(rate), 2 * np.array(rate), np.ones(6))
    profile = Profile.straight(0.02, *spins)
    return Candidate(profile, branch, Evaluation(None, score, ()), meets_threshold(score, settings))


def random_candidates(settings, count, seed):
    """Few different values of everything, so that ties of every kind come about."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        per_joint = rng.integers(0, 2, 6) * rng.integers(0, 2)
        rate = THRESHOLD * rng.choice([0.5, 0.8, 1.0, 1.5], 6)
        yield candidate(
            settings, per_joint, rate, rng.choice([1.0, 2.0]), rng.choice([-0.2, 0.0, 0.3], 3), int(rng.integers(8))
        )


def compared(settings, one, other):
    """-1 where `one` is the better motion, by the rules in words."""

    def reversals(motion):
        return sum(w * n for w, n in zip(settings.reversal_weights, motion.score.reversals_per_joint, strict=True))

    def slowest(motion):
        rates = motion.score.min_rate if settings.min_rate_rule == "pointwise" else motion.score.mean_rate
        steady = [r for r, n in zip(rates, motion.score.reversals_per_joint, strict=True) if n == 0]
        return min(steady) if steady else None

    def lack(motion):
        slow = slowest(motion)
        if slow is None or slow >= settings.min_rate * (1 - 1e-6):
            return 0.0
        return settings.min_rate * max(1e-5, round((settings.min_rate - slow) / settings.min_rate, 5))

    def turned_while_cutting(motion):
        start, target, _ = motion.profile.psi
        return abs(target - start)

    def cost(motion):
        if settings.objective == "travel":
            return motion.score.travel
        return turned_while_cutting(motion) if settings.objective == "plunge_rotation" else -(slowest(motion) or 0.0)

    for figure in (
        reversals, lack, cost, turned_while_cutting, lambda m: m.branch, lambda m: float(m.profile.psi[1]),
    ):  # fmt: skip
        if abs(figure(one) - figure(other)) > 1e-12:
            return -1 if figure(one) < figure(other) else 1
    return 0


@pytest.mark.parametrize("rule", ["pointwise", "mean"])
@pytest.mark.parametrize("objective", ["travel", "margin", "plunge_rotation"])
def test_motions_are_sorted_as_the_rules_in_words_sort_them(robot, tool, objective, rule):
    settings = Settings(
        min_rate=THRESHOLD, min_rate_rule=rule, objective=objective, reversal_weights=(1.0, 1.0, 2.0, 0.5, 1.0, 0.5)
    )
    order = Order(Drilling(robot, tool, Hole("h", X, X, 0.02)), settings)
    motions = list(random_candidates(settings, 150, 7))
    ranked, naive = (
        sorted(motions, key=order.rank),
        sorted(motions, key=cmp_to_key(lambda a, b: compared(settings, a, b))),
    )
    assert [order.rank(motion) for motion in ranked] == [order.rank(motion) for motion in naive]
    steps = [compared(settings, before, after) for before, after in pairwise(ranked)]
    assert set(steps) == {-1, 0}
    assert order.best([None, *motions]) is min(motions, key=order.rank)
    assert order.best([None]) is None


def test_less_lack_comes_before_less_travel(robot, tool):
    settings = Settings(min_rate=THRESHOLD)
    order = Order(Drilling(robot, tool, Hole("h", X, X, 0.02)), settings)
    slow = candidate(settings, [0] * 6, [0.3 * THRESHOLD] * 6, 1.0, (0.1, 0.0, -0.1))
    faster = candidate(settings, [0] * 6, [0.7 * THRESHOLD] * 6, 5.0, (0.1, 0.0, -0.1))
    fewer = candidate(settings, [0, 0, 0, 0, 0, 1], [2 * THRESHOLD] * 6, 0.5, (0.1, 0.0, -0.1))
    assert order.best([slow, fewer, faster]) is faster


def test_less_travel_comes_first_where_the_margin_is_the_same_to_four_digits(robot, tool):
    settings = Settings(min_rate=THRESHOLD)
    order = Order(Drilling(robot, tool, Hole("h", X, X, 0.02)), settings)
    slow = candidate(settings, [0] * 6, [0.4 * THRESHOLD * (1 - 1e-6)] * 6, 1.0, (0.1, 0.0, -0.1))
    faster = candidate(settings, [0] * 6, [0.4 * THRESHOLD] * 6, 5.0, (0.1, 0.0, -0.1))
    assert order.best([faster, slow]) is slow


def test_weights_of_criteria_decide_where_there_are_any(robot, tool, positions):
    """By the sum of the criteria of real motions, which the objective's own order would sort otherwise."""
    hole, alone = positions[0].hole, Settings(min_rate=0.0)
    weighed = Settings(min_rate=0.0, weights=(("margin", 1.0),))
    by_travel, by_margin = Order(Drilling(robot, tool, hole), alone), Order(Drilling(robot, tool, hole), weighed)
    spins = positions[0].profile.psi
    motions = [
        by_travel.candidate(Profile.straight(hole.depth, *(spins + wide * np.array([1, 0, -1]))), positions[0].branch)
        for wide in np.deg2rad([0.0, 2.0, 5.0])
    ]
    assert [motion.reversals for motion in motions] == [0, 0, 0]
    assert by_travel.best(motions) is motions[0]
    assert by_margin.best(motions) is max(motions, key=lambda motion: motion.score.min_rate.min())


@pytest.mark.long
@pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="free legs: thousands of tubes")
@pytest.mark.parametrize(
    ("target_mm", "depth", "least"), [((200, 400, 600), 0.020, 0.1346), ((200, 200, 1000), 0.030, 0.0990)]
)
def test_free_legs_below_the_threshold_keep_the_most_that_is_found(robot, tool, target_mm, depth, least):
    """Straight legs keep 0.0716 and 0.0383 deg/mm here and travel less; the plan and the map say the same."""
    settings = Settings(legs="free", min_rate=float(np.deg2rad(200.0)))
    hole = Hole("h", np.array(target_mm) * 1e-3, X, depth)
    planned = plan(robot, tool, hole, settings)
    margin = float(np.rad2deg(planned.score.min_rate.min())) / 1e3
    assert planned.score.reversals == 0
    assert margin >= least
    (finding,) = [finding for finding in planned.findings if finding.kind == "threshold"]
    assert finding.message.endswith("no motion with so few reversals was found that keeps more")
    question = Question(robot, tool, "greatest_margin", settings, "base_y", depth)
    mapped = quantity("greatest_margin").solve(question, hole, 0)
    assert mapped.value >= margin * (1 - 1e-9)
