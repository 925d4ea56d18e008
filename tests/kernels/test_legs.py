"""Legs out of a target against their slow twin; the best leg of a side against 2,000 slopes tried one by one."""

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np
import pytest

from oracles import legs as twin
from zerorev import kinematics
from zerorev.kernels import fan, legs, pairs
from zerorev.model.files import read_robot, read_tool, robot_names
from zerorev.model.hole import Hole
from zerorev.search.exact import Asked

ROBOTS = [read_robot(name) for name in robot_names()]
TOOL = read_tool("thesis_drill")
SLOW = bool(numba.config.DISABLE_JIT)
ALL_JOINTS = np.ones(6, dtype=bool)
LEAST_RATE = np.deg2rad(1e-4)


@pytest.fixture(autouse=True)
def division_by_zero_gives_infinity():
    """As in compiled kernels, also where they run as plain Python."""
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        yield


def asked(robot, hole, *, min_rate=LEAST_RATE, mean_rule=False, turn_inside=False, limits=True, bound=0.0):
    low, high = (robot.limits.lower, robot.limits.upper) if limits else (np.full(6, -np.inf), np.full(6, np.inf))
    return Asked(hole.depth, min_rate, mean_rule, turn_inside, low, high, 2 * np.pi / hole.depth, bound)


@dataclass(frozen=True)
class Start:
    """One leg out of one target, on the branch that a random joint vector stands on."""

    robot: object
    hole: Hole
    branch: int
    psi_t: float
    slope: float

    @property
    def plane(self):
        return kinematics.twist_plane(self.robot, TOOL, self.hole)

    def traced(self, nodes, branch=None):
        """Rows of the leg, or None where it cannot be run."""
        leg = np.empty((legs.ROWS, 6))
        branch = self.branch if branch is None else branch
        args = self.robot.arm, self.plane, branch, self.psi_t, self.slope, self.hole.depth, nodes, leg
        return leg if legs.trace_leg(*args) else None

    def naive(self):
        return twin.trace(self.robot, TOOL, self.hole, self.branch, self.psi_t, self.slope)

    def at_target(self):
        """Principal angles, critical rates, and signs of theta_psi."""
        pose = kinematics.tcp_pose(self.hole, 0.0, self.psi_t) @ np.linalg.inv(TOOL.T_flange_tcp)
        joints = kinematics.inverse(self.robot, pose)[self.branch]
        _, theta_psi = kinematics.joint_rates(self.robot, TOOL, self.hole, 0.0, self.psi_t)
        kappa = kinematics.critical_rates(self.robot, TOOL, self.hole, 0.0, self.psi_t)[self.branch]
        return joints, kappa, np.sign(theta_psi[self.branch])


def starts(count, seed, robots=ROBOTS[:: 2 if SLOW else 1], deepest=0.06):
    """Random reachable targets, `count` a robot, with slopes of up to 3 deg/mm."""
    rng, found = np.random.default_rng(seed), []
    for robot in robots:
        scale = (robot.arm.c2 + robot.arm.c3) / 0.7
        taken = 0
        while taken < count:
            T = kinematics.forward(robot, rng.uniform(robot.limits.lower, robot.limits.upper)) @ TOOL.T_flange_tcp
            hole = Hole("random", T[:3, 3], -T[:3, 2], rng.uniform(0.01, deepest) * scale, psi_zero=T[:3, 1])
            start = Start(robot, hole, int(rng.integers(8)), rng.uniform(-0.3, 0.3), rng.normal() * 15 / scale)
            if np.isfinite(start.at_target()[1]).all():
                found.append(start)
                taken += 1
    return found


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


class TestTurns:
    def test_are_all_the_choices_there_are(self):
        rng = np.random.default_rng(6)
        for robot in ROBOTS:
            hole = Hole("any", np.array([0.5, 0.0, 0.8]), np.array([1.0, 0.0, 0.0]), 0.05)
            wanted = asked(robot, hole)
            for _ in range(3 if SLOW else 30):
                principal = rng.uniform(-np.pi, np.pi, 6)
                expected = twin.choices_of_turns(principal, wanted)
                assert pairs.turn_choices(principal, wanted) == len(expected)
                found = np.empty((len(expected), 6))
                for choice in range(len(expected)):
                    pairs.take_turns(principal, wanted, choice, found[choice])
                np.testing.assert_allclose(sorted(found.tolist()), sorted(expected), atol=1e-12)


def best_leg(start, side, wanted, mode=legs.TRAVEL, keep=ALL_JOINTS, nodes=97):
    """(least cost, its slope, greatest margin) and the twin's judgement of many slopes on that side."""
    joints, kappa, sense = start.at_target()
    best = np.empty(3)
    held = (side * sense, keep, joints)
    legs.best_leg(start.robot.arm, start.plane, start.branch, start.psi_t, side, kappa, held, wanted, mode, nodes, best)
    return best


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
            cost, slope, _ = best_leg(start, one.side, wanted, nodes=25 if SLOW else 97)
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
            cost, _, margin = best_leg(one.start, one.side, one.wanted, legs.GREATEST_MARGIN)
            assert -cost == margin
            assert margin >= greatest * (1 - 5e-3) - SPARE_RATE / 10
            feasible += 1
        assert feasible >= 12

    @pytest.mark.skipif(SLOW, reason="as above, of another aim")
    def test_with_the_least_rotation_is_the_gentlest_that_will_do(self, sides):
        for one in sides:
            will_do = (one.tried.margin >= SPARE_RATE) & (one.tried.slack >= SPARE_ANGLE)
            if will_do.any():
                cost, slope, _ = best_leg(one.start, one.side, one.wanted, legs.PLUNGE_ROTATION)
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
        cost, slope, margin = best_leg(start, side, wanted, nodes=33)
        assert np.isfinite(cost)
        assert margin >= wanted.min_rate
        assert slope == pytest.approx(fine.slope[fine.margin.argmax()], abs=3e-3 * wanted.steepest)


class TestBestPair:
    def pair(self, start, keep=ALL_JOINTS, mode=legs.TRAVEL, **how):
        out = np.empty(4)
        wanted = asked(start.robot, start.hole, **how)
        args = start.robot.arm, start.plane, start.branch, start.psi_t, keep, wanted, wanted.unlimited(), mode
        pairs.best_pair(*args, 25 if SLOW else 97, out)
        return out

    def test_is_the_best_leg_of_either_side(self, robot, positions):
        for psi in np.deg2rad([-2.0, 0.0, 3.0]):
            start = Start(robot, positions[0].hole, 4, psi, 0.0)
            wanted = asked(robot, start.hole, limits=False)
            sides = [best_leg(start, side, wanted, nodes=25 if SLOW else 97) for side in (1.0, -1.0)]
            out = self.pair(start)
            assert out[pairs.VALUE] == pytest.approx(sides[0][0] + sides[1][0], rel=1e-12)
            assert out[pairs.SLOPE_ABOVE] == sides[0][1]
            assert out[pairs.SLOPE_BELOW] == sides[1][1]

    def test_brackets_the_critical_rates_of_the_joints_to_keep(self, sides):
        keep = np.array([True, True, False, True, False, True])
        found = 0
        for start in [one.start for one in sides[::2]]:
            out = self.pair(start, keep)
            if np.isfinite(out[pairs.VALUE]):
                kappa = start.at_target()[1][keep]
                assert out[pairs.SLOPE_ABOVE] > kappa.max() > kappa.min() > out[pairs.SLOPE_BELOW]
                found += 1
        assert found >= 1

    def test_out_of_reach_there_is_none(self, robot):
        far = Hole("far", np.array([3.0, 0.0, 0.8]), np.array([1.0, 0.0, 0.0]), 0.02)
        out = self.pair(Start(robot, far, 0, 0.0, 0.0))
        assert out[pairs.VALUE] == np.inf
        assert out[pairs.MARGIN] == -np.inf


class TestFan:
    """The legs that every set of joints is looked up in."""

    def slopes(self, kappa, *, between=True, psi_t=0.0, bound=0.0):
        wanted = Asked(0.05, LEAST_RATE, False, False, np.full(6, -9.0), np.full(6, 9.0), 100.0, bound)
        out, critical = np.empty(fan.MAX_FAN), np.zeros(fan.MAX_FAN, dtype=bool)
        count = fan.fan_slopes(np.array(kappa), between, psi_t, wanted, out, critical)
        return out[:count], critical[:count]

    def test_slopes_rise_from_steepest_to_steepest_and_mark_the_critical_rates(self):
        slopes, critical = self.slopes([5, -8, 3, 0.1, -2, 7])
        assert (np.diff(slopes) >= 0).all()
        assert slopes[0] == pytest.approx(-100)
        assert slopes[-1] == pytest.approx(100)
        np.testing.assert_allclose(slopes[critical], [-8, -2, 0.1, 3, 5, 7])
        assert 0.0 in slopes

    def test_without_the_slopes_between_the_outermost_critical_rates_are_enough(self):
        slopes, critical = self.slopes([5, -8, 3, 0.1, -2, 7], between=False)
        np.testing.assert_allclose(slopes[critical], [-8, 7])
        assert not ((slopes > -8) & (slopes < 7)).any()

    def test_slopes_stay_within_the_bound_on_the_spin(self):
        slopes, _ = self.slopes([5, -8, 3, 0.1, -2, 7], psi_t=0.8, bound=1.0)
        assert np.abs(0.8 + slopes * 0.05).max() == pytest.approx(1.0)

    def test_there_is_room_for_all(self):
        assert self.slopes([5, -8, 3, 0.1, -2, 7])[0].size <= fan.MAX_FAN

    @pytest.mark.parametrize("weights", [(1.0,) * 6, (3.0, 1.0, 1.0, 2.0, 1.0, 0.5)])
    def test_pairs_are_judged_as_their_dense_samples(self, weights):
        compared = 0
        for start in starts(1 if SLOW else 20, seed=9, deepest=0.03):
            other = Start(start.robot, start.hole, start.branch, start.psi_t, -start.slope)
            rows, dense = (start.traced(97), other.traced(97)), (start.naive(), other.naive())
            if any(leg is None for leg in (*rows, *dense)):
                continue
            rates = np.concatenate([leg.rates for leg in dense])
            if np.abs(rates).min() < 0.05 or max(leg.derivative(1).max() for leg in dense) > 3e3:
                continue
            turned = dense[0].turns + dense[1].turns + (dense[0].rates[0] * dense[1].rates[0] > 0)
            wanted = asked(start.robot, start.hole, min_rate=1e3)
            slopes = start.slope, -start.slope
            cost, lack, travel = fan.judge_pair(*rows, *slopes, np.array(weights), wanted, legs.TRAVEL)
            assert cost == pytest.approx(np.dot(weights, turned))
            moved = sum(np.abs(np.diff(leg.angles, axis=0)).sum() for leg in dense)
            assert travel == pytest.approx(moved, rel=1e-4)
            slowest = np.abs(rates).min(axis=0)[turned == 0].min(initial=np.inf)
            assert lack == pytest.approx(max(0.0, 1e3 - slowest), abs=2e-2)
            compared += 1
        assert compared >= (0 if SLOW else 1)
