"""Motions joined from legs against the slow twin that follows each motion by itself, on every branch."""

from __future__ import annotations

import numpy as np
import pytest

from oracles import sampled as twin
from oracles.starts import SLOW, TOOL, starts
from zerorev.kernels.cube import cube
from zerorev.motion.drilling import Drilling

UNEVEN = np.array([0.0, 0.03, 0.1, 0.3, 0.35, 0.6, 0.97, 1.0])
RATE = np.deg2rad(200.0)  # [rad/m] a motion threshold that some joints keep and some do not
WAYS = [(False, 0.0, False), (True, 0.0, False), (False, RATE, False), (True, RATE, True)]


def mapped(robot, hole, outer, target, *, first_point=False, rate=0.0, mean=False, only=-1):
    """Score, reversals, branch and travel, each (M, K, K)."""
    least = np.zeros(UNEVEN.size)
    if mean:
        least[-1] = rate * hole.depth
    else:
        least[:-1] = np.sin(rate * hole.depth * np.diff(UNEVEN))[::-1]
    shape = (target.size, outer.size, outer.size)
    score, travel = np.empty(shape), np.empty(shape)
    reversals, branch = np.empty(shape, dtype=np.int8), np.empty(shape, dtype=np.int8)
    cube(
        robot.arm, Drilling(robot, TOOL, hole).plane, hole.depth, UNEVEN, least, robot.limits.lower,
        robot.limits.upper, first_point, (1 / 7, 1 / (84 * np.pi)), only, outer, target, score, reversals, branch,
        travel,
    )  # fmt: skip
    return score, reversals, branch, travel


@pytest.mark.parametrize(("first_point", "rate", "mean"), WAYS)
def test_every_cell_is_the_best_branch_of_the_twin(first_point, rate, mean):
    rng, seen = np.random.default_rng(11), set()
    for start in starts(1 if SLOW else 4, seed=5, deepest=0.2):
        outer = np.sort(start.psi_t + rng.normal(size=2 if SLOW else 5) * [0.3, 1.0, 0.1, 3.0, 0.6][: 2 if SLOW else 5])
        target = start.psi_t + np.array([0.0, 0.4])
        score, reversals, branch, travel = mapped(
            start.robot, start.hole, outer, target, first_point=first_point, rate=rate, mean=mean
        )
        for m, s, e in np.ndindex(score.shape):
            spins = outer[s], target[m], outer[e]
            judged = twin.judge(
                start.robot, TOOL, start.hole, UNEVEN, spins, first_point=first_point, least_rate=rate, mean=mean
            )
            costs = np.array([cost for cost, _ in judged])
            assert score[m, s, e] == pytest.approx(costs.min(), abs=1e-9)
            best = np.flatnonzero(costs < costs.min() + 1e-9)
            assert reversals[m, s, e] in {judged[b][1] for b in best}
            if reversals[m, s, e] < 0:
                assert branch[m, s, e] == -1
                assert np.isnan(travel[m, s, e])
            else:
                assert branch[m, s, e] in best
                steps = np.diff(twin.path(start.robot, TOOL, start.hole, UNEVEN, spins, branch[m, s, e]), axis=0)
                assert travel[m, s, e] == pytest.approx(np.abs(steps).sum(), abs=1e-9)
            seen.add(int(reversals[m, s, e]))
    assert SLOW or len(seen) > 4
    assert SLOW or -1 in seen


def test_one_branch_alone_is_that_branch():
    start = next(iter(starts(1, seed=5, deepest=0.2)))
    outer, target = start.psi_t + np.array([-0.5, 0.2, 0.9]), np.array([start.psi_t])
    alone = [mapped(start.robot, start.hole, outer, target, only=b) for b in range(8)]
    for b, (_, _, branch, _) in enumerate(alone):
        assert set(np.unique(branch)) <= {-1, b}
    for s, e in np.ndindex(3, 3):
        spins = outer[s], target[0], outer[e]
        expected = twin.judge(start.robot, TOOL, start.hole, UNEVEN, spins, first_point=False)
        for (score, *_), (cost, _) in zip(alone, expected, strict=True):
            assert score[0, s, e] == pytest.approx(cost, abs=1e-9)
    together = mapped(start.robot, start.hole, outer, target)[0]
    np.testing.assert_array_equal(together, np.min([score for score, *_ in alone], axis=0))


def test_a_motion_and_its_mirror_score_the_same_to_the_last_bit():
    for start in starts(1 if SLOW else 3, seed=9, deepest=0.2):
        outer, target = start.psi_t + np.linspace(-1.0, 1.3, 3 if SLOW else 9), start.psi_t + np.array([-0.1, 0.3])
        score, reversals, _, travel = mapped(start.robot, start.hole, outer, target)
        np.testing.assert_array_equal(score, score.transpose(0, 2, 1))
        np.testing.assert_array_equal(reversals, reversals.transpose(0, 2, 1))
        np.testing.assert_array_equal(travel, travel.transpose(0, 2, 1))
