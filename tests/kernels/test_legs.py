"""Legs out of a target against their slow twin."""

from __future__ import annotations

import numpy as np
import pytest

from oracles import legs as twin
from oracles.starts import ALL_JOINTS, SLOW, Start, asked, starts
from zerorev.kernels import legs
from zerorev.model.hole import Hole


class TestTraceLeg:
    @pytest.mark.parametrize("nodes", [13, 25, 97])
    def test_is_what_dense_samples_show(self, nodes):
        compared = 0
        for start in starts(2 if SLOW else 25, seed=nodes):
            leg, dense = start.traced(nodes), start.naive()
            if leg is None:
                assert dense is None or start.naive() is None
                continue
            if dense is None:
                continue  # an excursion out of reach between two nodes
            h = start.hole.depth / (nodes - 1)
            rough = h**3 * dense.derivative(3)  # of the parabola through three nodes, times 15
            coarse = h**2 * (dense.derivative(2) * start.hole.depth + dense.derivative(1))
            if rough.max() > 0.5 or coarse.max() > 0.1:
                continue  # next to a singularity, where a third derivative says little
            rows = dense.rows
            for row in (legs.LEAST_RATE, legs.GREATEST_RATE):
                assert (np.abs(leg[row] - rows[row]) <= 1e-6 + 0.2 * rough).all()
            for row in (legs.LEAST_ANGLE, legs.GREATEST_ANGLE):
                assert (np.abs(leg[row] - rows[row]) <= 1e-9 + 0.2 * coarse).all()
            assert (np.abs(leg[legs.MOVED] - rows[legs.MOVED]) <= 1e-9 + coarse).all()
            np.testing.assert_allclose(leg[legs.END_ANGLE], rows[legs.END_ANGLE], atol=1e-9)
            np.testing.assert_allclose(leg[legs.TARGET_RATE], rows[legs.TARGET_RATE], atol=1e-9)
            nearest = np.abs(np.concatenate([rows[:2], dense.rates[[0, -1]]])).min(axis=0)
            clear = nearest > 1e-6 + 0.2 * rough
            np.testing.assert_array_equal(leg[legs.TURNS, clear], rows[legs.TURNS, clear])
            compared += 1
        assert compared > (4 if SLOW else 60)

    def test_a_dip_between_the_target_and_the_first_node_is_seen(self, robot, tool, positions):
        """The least rate lies within the first tenth of a node's width: samples alone miss it."""
        rng = np.random.default_rng(5)
        seen = 0
        for _ in range(10 if SLOW else 120):
            start = Start(robot, positions[0].hole, 4, rng.uniform(-1, 1), rng.uniform(-15, 15))
            leg, dense = start.traced(13), start.naive()
            if leg is None or dense is None:
                continue
            lowest = dense.rates.argmin(axis=0)
            for i in np.flatnonzero((lowest > 0) & (lowest < 2001 // 12)):
                sampled = min(dense.rates[0, i], dense.rates[1::166, i].min())
                assert leg[legs.LEAST_RATE, i] <= sampled + 1e-9
                seen += leg[legs.LEAST_RATE, i] < dense.rates[0, i]
        assert SLOW or seen >= 1

    def test_wrist_flips_share_their_legs(self):
        """But for the sign of joint 5 (theory §1)."""
        for start in starts(2 if SLOW else 20, seed=2):
            one, other = (start.traced(13, branch) for branch in (start.branch, start.branch ^ 1))
            assert (one is None) == (other is None)
            if one is not None:
                mirrored = other.copy()
                mirrored[:, 4] = -other[[1, 0, 3, 2, 4, 5, 6, 7], 4]
                mirrored[[legs.MOVED, legs.TURNS], 4] *= -1
                np.testing.assert_allclose(one, mirrored, atol=1e-9)

    def test_out_of_reach_is_false(self, robot):
        far = Hole("far", np.array([0.85, 0.0, 0.8]), np.array([-1.0, 0.0, 0.0]), 0.2)
        assert Start(robot, far, 0, 0.0, 0.0).traced(25) is None


@pytest.fixture(scope="module")
def followed():
    """Random legs, each traced finely and followed in dense samples."""
    every = starts(2 if SLOW else 20, seed=4)
    return [(start, start.traced(193), start.naive()) for start in every]


class TestJudgeLeg:
    @pytest.mark.parametrize("mean_rule", [False, True])
    @pytest.mark.parametrize("turn_inside", [False, True])
    def test_says_what_the_twin_says(self, followed, mean_rule, turn_inside):
        rng = np.random.default_rng(3)
        compared = 0
        for start, leg, dense in followed:
            if leg is None or dense is None or dense.derivative(1).max() > 3e3:
                continue
            wanted = asked(start.robot, start.hole, min_rate=0.2, mean_rule=mean_rule, turn_inside=turn_inside)
            sense, keep = rng.choice([-1.0, 1.0], 6), rng.random(6) < 0.6
            joints = start.at_target()[0]
            margin, slack, travel = legs.judge_leg(leg, sense, keep, joints, start.hole.depth, wanted)
            theirs = twin.judge(dense, sense, keep, joints, wanted)
            np.testing.assert_allclose((margin, slack, travel), theirs, rtol=1e-3, atol=2e-3)
            compared += 1
        assert compared > 4

    def test_a_joint_that_does_not_move_is_not_asked_to(self, robot):
        leg = np.zeros((legs.ROWS, 6))
        leg[:2, :5] = 3.0
        hole = Hole("any", np.array([0.5, 0.0, 0.8]), np.array([1.0, 0.0, 0.0]), 0.05)
        margin, _, _ = legs.judge_leg(leg, np.ones(6), ALL_JOINTS, np.zeros(6), 0.05, asked(robot, hole))
        assert margin == 3.0
