"""Legs out of a target against their slow twin; the best leg of a side against 2,000 slopes tried one by one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from oracles import legs as twin
from oracles.starts import ALL_JOINTS, LEAST_RATE, SLOW, TOOL, Start, asked, starts
from zerorev import kinematics
from zerorev.kernels import field, legs
from zerorev.model.hole import Hole
from zerorev.search.problem import Asked

NOWHERE = np.zeros(6)  # joints at the target, where no limit is looked at


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


class TestJudgeLeg:
    @pytest.mark.parametrize("mean_rule", [False, True])
    @pytest.mark.parametrize("turn_inside", [False, True])
    def test_says_what_the_twin_says(self, mean_rule, turn_inside):
        rng = np.random.default_rng(3)
        compared = 0
        for start in starts(2 if SLOW else 20, seed=4):
            leg, dense = start.traced(193), start.naive()
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


class TestWeighLeg:
    """The short cut of `judge_leg` after `trace_leg`."""

    @staticmethod
    def weigh(start, sense, keep, wanted, joints=NOWHERE, nodes=field.BLOCK):
        """Margin, slack, travel."""
        at = start.robot.arm, start.plane, start.branch, start.psi_t, start.slope
        return legs.weigh_leg(*at, (sense, keep, joints), wanted, nodes, np.empty(field.ROOM))

    @pytest.mark.parametrize("mean_rule", [False, True])
    @pytest.mark.parametrize("turn_inside", [False, True])
    @pytest.mark.parametrize("share", [1.0, 0.6, 0.2])
    def test_says_what_is_said_of_the_traced_leg(self, share, mean_rule, turn_inside):
        rng, compared, willing = np.random.default_rng(11), 0, 0
        for start in starts(1 if SLOW else 40, seed=10, deepest=0.03):
            leg, dense = start.traced(field.BLOCK), start.naive()
            if leg is None or dense is None:
                assert SLOW or leg is not None or self.weigh(start, *self.any(start))[0] == -np.inf
                continue
            h = start.hole.depth / (field.BLOCK - 1)
            rough = (h**2 * dense.derivative(2)).max()  # of the parabolas, which are not all looked at
            if rough > 0.05:
                continue
            # mostly the joints' own ways, so that many legs will do
            sense = np.where(rng.random(6) < 0.9, np.sign(dense.rates[0]), rng.choice([-1.0, 1.0], 6))
            keep = rng.random(6) < share
            wanted = asked(start.robot, start.hole, min_rate=0.2, mean_rule=mean_rule, turn_inside=turn_inside)
            joints = start.at_target()[0]
            margin, slack, travel = legs.judge_leg(leg, sense, keep, joints, start.hole.depth, wanted)
            found = self.weigh(start, sense, keep, wanted, joints)
            if margin >= wanted.min_rate or keep.all():
                np.testing.assert_allclose((found[0], found[2]), (margin, travel), rtol=1e-5, atol=1e-6 + 0.2 * rough)
                assert found[0] >= margin - 1e-7  # it looks at fewer parabolas
            else:  # which of two ways a joint lacks more is told from where it sets out
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
    """What four points of a leg tell of it."""

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
            legs.sift(*args, np.empty(field.ROOM), ceiling, travel, ends)
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
                np.testing.assert_allclose(ends[j], leg[legs.END_ANGLE], rtol=legs.SIEVE_ERROR, atol=1e-3)
                smooth += 1
        assert smooth >= (0 if SLOW else 100)
        assert max(errors, default=0.0) < legs.SIEVE_ERROR

    def test_out_of_reach_is_minus_infinity(self, robot):
        far = Hole("far", np.array([0.85, 0.0, 0.8]), np.array([-1.0, 0.0, 0.0]), 0.2)
        start = Start(robot, far, 0, 0.0, 0.0)
        ceiling, travel, ends = np.empty(1), np.empty(1), np.empty((1, 6))
        args = robot.arm, start.plane, 0, 0.0, np.zeros(1), 1, np.ones(6), ALL_JOINTS, asked(robot, far)
        legs.sift(*args, np.empty(field.ROOM), ceiling, travel, ends)
        assert (ceiling[0], travel[0]) == (-np.inf, np.inf)

    def test_many_legs_are_looked_at_as_each_alone(self, robot, positions):
        """More of them than one workspace holds."""
        start, count = Start(robot, positions[0].hole, 4, 0.1, 0.0), 61
        wanted, slopes = asked(robot, start.hole), np.linspace(-20, 20, count)
        ceiling, travel, ends = np.empty(count), np.empty(count), np.empty((count, 6))
        at = robot.arm, start.plane, 4, 0.1
        held, work = (start.at_target()[2], ALL_JOINTS, wanted), np.empty(field.ROOM)
        legs.sift(*at, slopes, count, *held, work, ceiling, travel, ends)
        alone = np.empty(1), np.empty(1), np.empty((1, 6))
        for j in range(0, count, 7):
            legs.sift(*at, slopes[j : j + 1], 1, *held, work, *alone)
            np.testing.assert_allclose(ceiling[j], alone[0][0], rtol=1e-12)
            np.testing.assert_allclose(travel[j], alone[1][0], rtol=1e-12)
            np.testing.assert_allclose(ends[j], alone[2][0], rtol=1e-9, atol=1e-12)


class TestSlopeCandidates:
    def candidates(self, kappa, keep, side, psi_t=0.0, bound=0.0, steepest=100.0):
        wanted = Asked(0.05, LEAST_RATE, False, False, np.full(6, -9.0), np.full(6, 9.0), steepest, bound)
        out = np.empty(legs.MAX_SLOPES)
        return out[: legs.slope_candidates(np.array(kappa), np.array(keep), side, psi_t, wanted, out)]

    @pytest.mark.parametrize("side", [1.0, -1.0])
    def test_run_from_the_outermost_critical_rate_to_the_steepest_in_order(self, side):
        slopes = self.candidates([5, -8, 3, 0.1, -2, 7], [True] * 6, side)
        assert slopes[0] == (7 if side > 0 else -8)
        assert slopes[-1] == pytest.approx(side * 100)
        assert (np.diff(side * slopes) > 0).all()

    @pytest.mark.parametrize("side", [1.0, -1.0])
    def test_the_joints_that_may_turn_cut_the_side_into_pieces(self, side):
        keep = [True, False, True, True, True, False]
        slopes = self.candidates([5, -8, 3, 0.1, -2, 7], keep, side)
        first, cut = (5, 7) if side > 0 else (-2, -8)
        assert slopes[0] == first
        assert (np.diff(side * slopes) > 0).all()
        between = (side * slopes > side * first) & (side * slopes < side * cut)
        assert between.sum() == legs.SLOPES_BETWEEN

    @pytest.mark.parametrize("side", [1.0, -1.0])
    def test_stay_within_the_bound_on_the_spin(self, side):
        slopes = self.candidates([5, -8, 3, 0.1, -2, 7], [True] * 6, side, psi_t=0.4, bound=1.0)
        spins = 0.4 + slopes * 0.05
        assert np.abs(spins).max() == pytest.approx(1.0)

    def test_there_are_none_where_the_bound_lies_before_the_critical_rates(self):
        assert self.candidates([5, -8, 3, 0.1, -2, 7], [True] * 6, 1.0, psi_t=0.9, bound=1.0).size == 0

    def test_a_joint_that_spin_does_not_move_has_no_critical_rate(self):
        slopes = self.candidates([np.inf, np.nan, -np.inf, 2, -2, 1], [True] * 6, 1.0)
        assert slopes[0] == 2


def brute_force(start, side, wanted, count=200 if SLOW else 2000, keep=ALL_JOINTS):
    """The twin's judgement of slopes on one side: half of them even, half crowded at the critical rates."""
    joints, kappa, sense = start.at_target()
    nearest = (side * kappa[keep]).max()
    span = wanted.steepest - nearest
    shares = np.concatenate([np.linspace(0, 1, count // 2), np.geomspace(1e-5, 1, count // 2)])
    slopes = side * (nearest + span * np.sort(shares))
    return twin.judge_slopes(
        start.robot, TOOL, start.hole, start.branch, start.psi_t, slopes, side * sense, keep, joints, wanted
    )


@dataclass(frozen=True)
class Side:
    """One side of a random target's critical rates, and 2,000 slopes tried on it."""

    start: Start
    side: float
    wanted: Asked
    tried: twin.Judged

    def least_travel(self):
        """Of the slopes that will do with a little to spare: raw samples see no extreme between two of them."""
        return self.tried.least_travel(margin=SPARE_RATE, slack=SPARE_ANGLE)


SPARE_RATE, SPARE_ANGLE = 0.05, 1e-3


@pytest.fixture(scope="module")
def sides():
    """Random targets within their limits, with room on both sides of their critical rates."""
    found = []
    for start in starts(2 if SLOW else 6, seed=8, deepest=0.03):
        joints, kappa, _ = start.at_target()
        inside = (joints > start.robot.limits.lower).all() and (joints < start.robot.limits.upper).all()
        if inside and np.abs(kappa).max() < 3 / start.hole.depth:
            wanted = asked(start.robot, start.hole)
            sides = [Side(start, side, wanted, brute_force(start, side, wanted)) for side in (1.0, -1.0)]
            found += sides
    return found


class TestBestLeg:
    def test_is_not_beaten_by_2000_slopes(self, sides):
        feasible = 0
        for one in sides:
            start, wanted = one.start, one.wanted
            cost, slope, _ = start.best_leg(one.side, wanted, nodes=24 if SLOW else 96)
            if np.isfinite(one.least_travel()):
                feasible += 1
                assert cost <= one.least_travel() * (1 + 1e-4)
            if np.isfinite(cost):
                found = twin.trace(start.robot, TOOL, start.hole, start.branch, start.psi_t, slope)
                joints, _, sense = start.at_target()
                margin, slack, travel = twin.judge(found, one.side * sense, ALL_JOINTS, joints, wanted)
                assert margin > -SPARE_RATE
                assert slack > -SPARE_ANGLE
                assert travel == pytest.approx(cost, rel=1e-2 if SLOW else 1e-3)
        assert feasible >= (2 if SLOW else 12)

    @pytest.mark.skipif(SLOW, reason="as above, of another aim")
    def test_with_the_greatest_margin_is_not_beaten_by_2000_slopes(self, sides):
        feasible = 0
        for one in sides:
            runs = one.tried.slack >= SPARE_ANGLE
            greatest = one.tried.margin[runs].max(initial=-np.inf)
            if greatest < SPARE_RATE:
                continue
            cost, _, margin = one.start.best_leg(one.side, one.wanted, legs.GREATEST_MARGIN)
            assert -cost == margin
            assert margin >= greatest * (1 - 5e-3) - SPARE_RATE / 10
            feasible += 1
        assert feasible >= 12

    @pytest.mark.skipif(SLOW, reason="as above, of another aim")
    def test_with_the_least_rotation_is_the_gentlest_that_will_do(self, sides):
        for one in sides:
            will_do = (one.tried.margin >= SPARE_RATE) & (one.tried.slack >= SPARE_ANGLE)
            if will_do.any():
                cost, slope, _ = one.start.best_leg(one.side, one.wanted, legs.PLUNGE_ROTATION)
                assert cost == abs(slope)
                assert cost <= np.abs(one.tried.slope[will_do]).min() * (1 + 1e-6) + 1e-9

    @pytest.mark.parametrize("side", [1.0, -1.0])
    def test_finds_a_thin_interval_planted_between_two_candidates(self, robot, positions, side):
        """A threshold just below the greatest margin there is leaves a sliver of slopes around its place."""
        start = Start(robot, positions[0].hole, 4, np.deg2rad(3.0), 0.0)
        wanted = asked(robot, start.hole, limits=False)
        joints, kappa, sense = start.at_target()

        def judged(slopes, wanted):
            args = robot, TOOL, start.hole, 4, start.psi_t, slopes, side * sense, ALL_JOINTS, joints, wanted
            return twin.judge_slopes(*args)

        rough = brute_force(start, side, wanted, 200)
        top = rough.slope[rough.margin.argmax()]
        fine = judged(top + np.linspace(-1, 1, 200) * 0.02 * wanted.steepest, wanted)
        greatest = fine.margin.max()
        wanted = asked(robot, start.hole, min_rate=greatest * (1 - 1e-4), limits=False)
        width = np.ptp(fine.slope[fine.margin > wanted.min_rate])
        assert width < 2e-3 * wanted.steepest
        out = np.empty(legs.MAX_SLOPES)
        candidates = out[: legs.slope_candidates(kappa, ALL_JOINTS, side, start.psi_t, wanted, out)]
        assert judged(candidates, wanted).least_travel(wanted.min_rate) == np.inf
        cost, slope, margin = start.best_leg(side, wanted, nodes=33)
        assert np.isfinite(cost)
        assert margin >= wanted.min_rate
        assert slope == pytest.approx(fine.slope[fine.margin.argmax()], abs=3e-3 * wanted.steepest)
