"""What a leg is weighed at from a few points, against the leg followed and judged."""

from __future__ import annotations

import numpy as np
import pytest

from oracles.starts import ALL_JOINTS, SLOW, TOOL, Start, asked, starts
from zerorev.kernels import field, legs, weigh
from zerorev.model.hole import Hole
from zerorev.motion import kinematics

NOWHERE = np.zeros(6)  # joints at the target, where no limit is examined


@pytest.fixture(scope="module")
def followed():
    """Random legs, each traced and followed in dense samples."""
    every = starts(1 if SLOW else 40, seed=10, deepest=0.03)
    return [(start, start.traced(field.BLOCK), start.naive()) for start in every]


class TestWeighLeg:
    """The short cut of `judge_leg` after `trace_leg`."""

    @staticmethod
    def weigh(start, sense, keep, wanted, joints=NOWHERE, nodes=field.BLOCK):
        """Margin, slack, travel."""
        at = start.robot.arm, start.plane, start.branch, start.psi_t, start.slope
        return weigh.weigh_leg(*at, (sense, keep, joints), wanted, nodes, np.empty(field.ROOM))

    @pytest.mark.parametrize("mean_rule", [False, True])
    @pytest.mark.parametrize("turn_inside", [False, True])
    @pytest.mark.parametrize("share", [1.0, 0.6, 0.2])
    def test_says_what_is_said_of_the_traced_leg(self, followed, share, mean_rule, turn_inside):
        rng, compared, willing = np.random.default_rng(11), 0, 0
        for start, leg, dense in followed:
            if leg is None or dense is None:
                assert SLOW or leg is not None or self.weigh(start, *self.any(start))[0] == -np.inf
                continue
            h = start.hole.depth / (field.BLOCK - 1)
            rough = (h**2 * dense.derivative(2)).max()  # of the parabolas, which are not all examined
            if rough > 0.05:
                continue
            # mostly the joints' own ways, so that many legs are admissible
            sense = np.where(rng.random(6) < 0.9, np.sign(dense.rates[0]), rng.choice([-1.0, 1.0], 6))
            keep = rng.random(6) < share
            wanted = asked(start.robot, start.hole, min_rate=0.2, mean_rule=mean_rule, turn_inside=turn_inside)
            joints = start.at_target()[0]
            margin, slack, travel = legs.judge_leg(leg, sense, keep, joints, start.hole.depth, wanted)
            found = self.weigh(start, sense, keep, wanted, joints)
            if margin >= wanted.min_rate or keep.all():
                np.testing.assert_allclose((found[0], found[2]), (margin, travel), rtol=1e-5, atol=1e-6 + 0.2 * rough)
                assert found[0] >= margin - 1e-7  # it looks at fewer parabolas
            else:  # which of two ways a joint lacks more is decided where it begins
                assert found[0] < wanted.min_rate
            if not leg[legs.TURNS].any():  # it comes nearest to a limit at its ends, one of which is known beforehand
                at_target = min((joints - wanted.lower).min(), (wanted.upper - joints).min())
                assert min(found[1], at_target) == pytest.approx(slack, abs=1e-6 + 0.2 * rough * start.hole.depth)
            compared += 1
            willing += margin >= wanted.min_rate
        assert compared >= (1 if SLOW else 60)
        assert SLOW or willing > 10

    @staticmethod
    def any(start):
        return np.ones(6), ALL_JOINTS, asked(start.robot, start.hole)

    def test_sees_a_dip_between_two_nodes(self, robot, positions):
        """The least rate of a coarse leg is that of a fine one to the fourth power of a node's width."""
        rng, seen = np.random.default_rng(12), 0
        for _ in range(5 if SLOW else 400):
            start = Start(robot, positions[0].hole, 4, rng.uniform(-1, 1), rng.uniform(-15, 15))
            dense = start.naive()
            if dense is None:
                continue
            sense, h = np.sign(dense.rates[0]), start.hole.depth / 12
            signed = sense * dense.rates
            i = signed.min(axis=0).argmin()
            at = signed[:, i].argmin()
            nearest = np.abs(dense.standoff[at] - h * np.arange(13)).min()
            if nearest < 0.3 * h or h**3 * dense.derivative(3).max() > 0.5:
                continue
            at_nodes = np.interp(h * np.arange(13), dense.standoff, signed[:, i]).min()
            found = self.weigh(start, sense, ALL_JOINTS, asked(robot, start.hole), nodes=13)[0]
            dip = at_nodes - signed[at, i]
            assert found <= at_nodes + 1e-9
            assert abs(found - signed[at, i]) <= 0.3 * dip + 0.1 * h**3 * dense.derivative(3)[i]
            seen += 1
        assert seen >= (0 if SLOW else 3)

    @pytest.mark.parametrize("mean_rule", [False, True])
    def test_a_joint_that_does_not_move_is_not_asked_to(self, robot, mean_rule):
        """A hole in the arm's own plane, the spin held: joints 1, 4 and 6 stand still."""
        joints = np.deg2rad([0.0, -60.0, 80.0, 0.0, 50.0, 0.0])
        T = kinematics.forward(robot, joints) @ TOOL.T_flange_tcp
        hole = Hole("any", T[:3, 3], -T[:3, 2], 0.02, psi_zero=T[:3, 1])
        start = Start(robot, hole, 0, 0.0, 0.0)
        leg = start.traced(24)
        still = np.abs(leg[[legs.LEAST_RATE, legs.GREATEST_RATE]]).max(axis=0) < legs.NIL
        np.testing.assert_array_equal(still, [True, False, False, True, False, True])
        sense = np.where(leg[legs.TARGET_RATE] > 0, 1.0, -1.0)
        wanted = asked(robot, hole, mean_rule=mean_rule)
        expected = legs.judge_leg(leg, sense, ALL_JOINTS, np.zeros(6), hole.depth, wanted)
        margin, _, travel = self.weigh(start, sense, ALL_JOINTS, wanted, nodes=24)
        assert margin == pytest.approx(expected[0], rel=1e-4)
        assert margin > legs.NIL
        assert travel == pytest.approx(expected[2], rel=1e-5)

    def test_out_of_reach_is_minus_infinity(self, robot):
        far = Hole("far", np.array([0.85, 0.0, 0.8]), np.array([-1.0, 0.0, 0.0]), 0.2)
        assert self.weigh(Start(robot, far, 0, 0.0, 0.0), np.ones(6), ALL_JOINTS, asked(robot, far))[0] == -np.inf


class TestSift:
    """What four points of a leg say about it."""

    @pytest.mark.parametrize("mean_rule", [False, True])
    @pytest.mark.parametrize("share", [1.0, 0.5])
    def test_bounds_the_margin_and_estimates_the_rest(self, share, mean_rule):
        rng, smooth, errors = np.random.default_rng(14), 0, []
        for start in starts(1 if SLOW else 12, seed=13, deepest=0.03):
            sense, keep = start.at_target()[2], rng.random(6) < share
            wanted = asked(start.robot, start.hole, min_rate=0.2, mean_rule=mean_rule)
            slopes = np.sort(rng.normal(size=31)) * 0.3 / start.hole.depth
            ceiling, travel, ends = np.empty(31), np.empty(31), np.empty((31, 6))
            args = start.robot.arm, start.plane, start.branch, start.psi_t, slopes, 31, sense, keep, wanted
            weigh.sift(*args, np.empty(field.ROOM), ceiling, travel, ends)
            for j in range(0, 31, 10 if SLOW else 1):
                one = Start(start.robot, start.hole, start.branch, start.psi_t, slopes[j])
                # 4 points out of 94 intervals are nodes of the fine leg, too: what they see it sees
                margin, _, moved = TestWeighLeg.weigh(one, sense, keep, wanted, nodes=94)
                assert ceiling[j] >= margin - 1e-9
                leg = one.traced(94)
                if leg is None or ceiling[j] == -np.inf:
                    continue
                rates = leg[[legs.LEAST_RATE, legs.GREATEST_RATE]]
                # a rate that doubles along the leg, or changes its sign, is not smooth to four points
                if (np.abs(rates).max(axis=0) > 2 * np.abs(rates).min(axis=0) + 0.1).any() or leg[legs.TURNS].any():
                    continue
                errors.append(abs(travel[j] / moved - 1))
                np.testing.assert_allclose(ends[j], leg[legs.END_ANGLE], rtol=weigh.SIEVE_ERROR, atol=1e-3)
                smooth += 1
        assert smooth >= (0 if SLOW else 100)
        assert max(errors, default=0.0) < weigh.SIEVE_ERROR

    def test_out_of_reach_is_minus_infinity(self, robot):
        far = Hole("far", np.array([0.85, 0.0, 0.8]), np.array([-1.0, 0.0, 0.0]), 0.2)
        start = Start(robot, far, 0, 0.0, 0.0)
        ceiling, travel, ends = np.empty(1), np.empty(1), np.empty((1, 6))
        args = robot.arm, start.plane, 0, 0.0, np.zeros(1), 1, np.ones(6), ALL_JOINTS, asked(robot, far)
        weigh.sift(*args, np.empty(field.ROOM), ceiling, travel, ends)
        assert (ceiling[0], travel[0]) == (-np.inf, np.inf)

    def test_many_legs_are_examined_as_each_alone(self, robot, positions):
        """More of them than one workspace holds."""
        start, count = Start(robot, positions[0].hole, 4, 0.1, 0.0), 61
        wanted, slopes = asked(robot, start.hole), np.linspace(-20, 20, count)
        ceiling, travel, ends = np.empty(count), np.empty(count), np.empty((count, 6))
        at = robot.arm, start.plane, 4, 0.1
        held, work = (start.at_target()[2], ALL_JOINTS, wanted), np.empty(field.ROOM)
        weigh.sift(*at, slopes, count, *held, work, ceiling, travel, ends)
        alone = np.empty(1), np.empty(1), np.empty((1, 6))
        for j in range(0, count, 7):
            weigh.sift(*at, slopes[j : j + 1], 1, *held, work, *alone)
            np.testing.assert_allclose(ceiling[j], alone[0][0], rtol=1e-12)
            np.testing.assert_allclose(travel[j], alone[1][0], rtol=1e-12)
            np.testing.assert_allclose(ends[j], alone[2][0], rtol=1e-9, atol=1e-12)
