"""The sampled objective's kernel against its slow twin, on every robot, and on paths that are known by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from oracles import sampled as twin
from oracles.starts import SLOW, TOOL, starts
from zerorev.kernels.sampled import judge
from zerorev.model.robot import JointLimits
from zerorev.motion.drilling import Drilling

CROWDED = np.array([0.0, 1e-4, 0.03, 0.1, 0.3, 0.35, 0.6, 0.97, 1.0])
EVEN = np.linspace(0.0, 1.0, 9)
RATE = np.deg2rad(200.0)  # [rad/m] a motion threshold that some joints keep and some do not
WAYS = pytest.mark.parametrize(
    ("first_point", "rate", "mean"), [(False, 0.0, False), (True, 0.0, False), (False, RATE, False), (True, RATE, True)]
)


def judged(robot, hole, fractions, spins, *, first_point=False, rate=0.0, mean=False):
    least = np.zeros(fractions.size)
    if mean:
        least[-1] = rate * hole.depth
    else:
        least[:-1] = np.sin(rate * hole.depth * np.diff(fractions))[::-1]
    costs, reversals = np.empty((len(spins), 8)), np.empty((len(spins), 8), dtype=np.int64)
    judge(
        robot.arm, Drilling(robot, TOOL, hole).plane, hole.depth, fractions, least, robot.limits.lower,
        robot.limits.upper, first_point, (1 / 7, 1 / (84 * np.pi)), spins, costs, reversals,
    )  # fmt: skip
    return costs, reversals


def motions(start, rng, count):
    """Motions around a reachable start, from hardly spinning to more than a turn."""
    spread = rng.choice([0.02, 0.3, 1.0, 4.0], (count, 1))
    return start.psi_t + spread * rng.normal(size=(count, 3))


class TestJudge:
    @WAYS
    @pytest.mark.parametrize("fractions", [EVEN, CROWDED], ids=["even", "crowded"])
    def test_agrees_with_the_twin_on_every_robot(self, fractions, first_point, rate, mean):
        rng, runnable, excluded = np.random.default_rng(7), 0, 0
        for start in starts(1 if SLOW else 6, seed=3, deepest=0.2):
            spins = motions(start, rng, 2 if SLOW else 8)
            costs, reversals = judged(
                start.robot, start.hole, fractions, spins, first_point=first_point, rate=rate, mean=mean
            )
            for m, motion in enumerate(spins):
                rules = {"first_point": first_point, "least_rate": rate, "mean": mean}
                expected = twin.judge(start.robot, TOOL, start.hole, fractions, motion, **rules)
                for branch, (cost, count) in enumerate(expected):
                    assert costs[m, branch] == pytest.approx(cost, abs=1e-9)
                    assert reversals[m, branch] == count
                    runnable += count >= 0
                    excluded += count < 0
        assert min(runnable, excluded) > (5 if SLOW else 50)

    def test_a_joint_may_wind_round_more_than_once(self):
        """Two and a half turns of the tool one way and back: travel and extents are not lost at +-180 deg."""
        rng, wound = np.random.default_rng(1), 0
        fractions = np.linspace(0.0, 1.0, 61)
        for start in starts(4, seed=5):
            free = replace(
                start.robot, limits=JointLimits(np.full(6, -20.0), np.full(6, 20.0), start.robot.limits.speed)
            )
            for held in (start.robot, free):
                spins = start.psi_t + np.array([[0.0, 5 * np.pi * rng.choice([-1, 1]), 0.0]])
                costs, _ = judged(held, start.hole, fractions, spins)
                joints = twin.path(held, TOOL, start.hole, fractions, spins[0])
                expected = twin.judge(held, TOOL, start.hole, fractions, spins[0], first_point=False)
                for branch, (cost, count) in enumerate(expected):
                    assert costs[0, branch] == pytest.approx(cost, abs=1e-9)
                    wound += count >= 0 and np.ptp(joints[:, branch], axis=0).max() > 2 * np.pi
        assert wound > 0 if SLOW else wound > 5

    def test_out_of_reach_is_1_and_no_more(self, robot, positions):
        far = replace(positions[0].hole, target=np.array([3.0, 0.0, 0.5]))
        costs, reversals = judged(robot, far, EVEN, np.zeros((2, 3)))
        assert (costs == 1.0).all()
        assert (reversals == -1).all()

    def test_a_step_of_half_a_radian_is_a_jump(self, robot, positions):
        """A joint's greatest step is made to be just less and just more than that."""
        hole, fractions, free = positions[0].hole, np.array([0.0, 1.0]), np.full(6, 20.0)
        robot = replace(robot, limits=JointLimits(-free, free, robot.limits.speed))
        least, most = 0.0, 2.0
        for _ in range(40):
            middle = (least + most) / 2
            steps = np.diff(twin.path(robot, TOOL, hole, fractions, (0.0, middle, 0.0), 4), axis=0)
            least, most = (middle, most) if np.abs(steps).max() < 0.5 else (least, middle)
        _, reversals = judged(robot, hole, fractions, np.array([[0, least - 1e-6, 0], [0, most + 1e-6, 0]]))
        assert reversals[0, 4] >= 0 > reversals[1, 4]
