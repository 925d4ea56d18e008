"""Compass searches from a pair of legs: what they end at is no worse, and where edges are tilted it is the bottom."""

from __future__ import annotations

import numpy as np
import pytest
from benchmarks.cases import NO_THRESHOLD, drilled, random_place

from oracles.starts import SLOW
from zerorev.kernels import compass, fan, legs
from zerorev.model.profile import Profile
from zerorev.motion.drilling import Drilling
from zerorev.motion.evaluation import evaluate
from zerorev.search.problem import Problem

# random hole 1159: `refine` stops at these spins [deg] on branch 3, at an edge; 5 reversals are the fewest there
STOPPED = [135.18490219, 137.09106445, 130.67173494]
# what SciPy's evolution got down to in 20 runs from there [deg of travel]
PEERS = 159.87160


@pytest.fixture
def problem():
    case = drilled(random_place(1159), 0.052375893186591437)
    return Problem(Drilling(case.robot, case.tool, case.hole), NO_THRESHOLD)


def point_of(problem, spins):
    start, target, end = np.deg2rad(spins)
    return np.array(
        [target, (start - target) / problem.drilling.hole.depth, (end - target) / problem.drilling.hole.depth]
    )


def searched(how, problem, point, step, nodes=24):
    """Where it ends, and the figures there."""
    (asked, mode), best, point = problem.objective(), np.empty(3), point.copy()
    how(problem.drilling.robot.arm, problem.drilling.plane, 3, point, step, problem.weights, asked, mode, nodes, best)
    return point, best


def judged(problem, point, nodes=24):
    room, (asked, mode) = np.empty((2, legs.ROWS, 6)), problem.objective()
    return compass.judge_point(
        problem.drilling.robot.arm, problem.drilling.plane, 3, point, problem.weights, asked, mode, nodes, room
    )


@pytest.mark.parametrize("how", [compass.refine, compass.settle])
def test_ends_no_worse_than_it_began_and_says_what_is_there(problem, how, monkeypatch):
    if SLOW:
        monkeypatch.setattr(compass, "COMPASS_STEPS", 1)
        monkeypatch.setattr(compass, "SETTLE_STEPS", 1)
    rng = np.random.default_rng(7)
    for _ in range(1 if SLOW else 8):
        began = point_of(problem, STOPPED) + rng.normal(size=3) * [0.02, 0.2, 0.2]
        ended, best = searched(how, problem, began, 0.003)
        assert tuple(best) == judged(problem, ended)
        before = judged(problem, began)
        assert tuple(best) == before or fan.is_better(*best, np.array(before))


@pytest.mark.skipif(SLOW, reason="a minute, uncompiled")
def test_descends_along_an_edge(problem):
    began = point_of(problem, STOPPED)
    stopped = searched(compass.refine, problem, began, problem.step / 10, nodes=96)[1]
    point, settled = searched(compass.settle, problem, began, problem.step / 10, nodes=96)
    assert stopped[0] == settled[0] == 5
    assert np.rad2deg(stopped[2] - settled[2]) > 0.005
    psi_t, *slopes = point
    start, end = (psi_t + slope * problem.drilling.hole.depth for slope in slopes)
    motion = Profile.straight(problem.drilling.hole.depth, start, psi_t, end)
    score = evaluate(problem.drilling.robot, problem.drilling.tool, problem.drilling.hole, motion, 3).score
    assert score.reversals == 5
    assert np.rad2deg(score.travel) < PEERS
