"""The best leg of a side against 2,000 slopes tried one by one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from oracles import legs as twin
from oracles.starts import ALL_JOINTS, LEAST_RATE, SLOW, TOOL, Start, asked, starts
from zerorev.kernels import leg_search, legs
from zerorev.kernels.layout import Constraints


class TestSlopeCandidates:
    def candidates(self, kappa, keep, side, psi_t=0.0, bound=0.0, steepest=100.0):
        wanted = Constraints(np.full(6, -9.0), np.full(6, 9.0), LEAST_RATE, bound, steepest, depth=0.05)
        out = np.empty(leg_search.MAX_SLOPES)
        return out[: leg_search.slope_candidates(np.array(kappa), np.array(keep), side, psi_t, wanted, out)]

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
        assert between.sum() == leg_search.SLOPES_BETWEEN

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
    wanted: Constraints
    tried: twin.Judged

    def least_travel(self):
        """Of the slopes that are admissible with a little margin: raw samples see no extreme between two of them."""
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
    def test_with_the_least_rotation_is_the_gentlest_admissible_one(self, sides):
        for one in sides:
            admissible = (one.tried.margin >= SPARE_RATE) & (one.tried.slack >= SPARE_ANGLE)
            if admissible.any():
                cost, slope, _ = one.start.best_leg(one.side, one.wanted, legs.PLUNGE_ROTATION)
                assert cost == abs(slope)
                assert cost <= np.abs(one.tried.slope[admissible]).min() * (1 + 1e-6) + 1e-9

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
        out = np.empty(leg_search.MAX_SLOPES)
        candidates = out[: leg_search.slope_candidates(kappa, ALL_JOINTS, side, start.psi_t, wanted, out)]
        assert judged(candidates, wanted).least_travel(wanted.min_rate) == np.inf
        cost, slope, margin = start.best_leg(side, wanted, nodes=33)
        assert np.isfinite(cost)
        assert margin >= wanted.min_rate
        assert slope == pytest.approx(fine.slope[fine.margin.argmax()], abs=3e-3 * wanted.steepest)
