"""The legs that every pair is looked up in, and what a pair is worth."""

from __future__ import annotations

import numpy as np
import pytest

from oracles.starts import LEAST_RATE, SLOW, Start, asked, starts
from zerorev.kernels import fan, legs
from zerorev.kernels.layout import Constraints


class TestFan:
    def slopes(self, kappa, *, psi_t=0.0, bound=0.0):
        wanted = Constraints(np.full(6, -9.0), np.full(6, 9.0), LEAST_RATE, bound, 100.0, depth=0.05)
        out, critical = np.empty(fan.MAX_FAN), np.zeros(fan.MAX_FAN, dtype=bool)
        count = fan.fan_slopes(np.array(kappa), psi_t, wanted, out, critical)
        return out[:count], critical[:count]

    def test_slopes_rise_from_steepest_to_steepest_and_mark_the_critical_rates(self):
        slopes, critical = self.slopes([5, -8, 3, 0.1, -2, 7])
        assert (np.diff(slopes) >= 0).all()
        assert slopes[0] == pytest.approx(-100)
        assert slopes[-1] == pytest.approx(100)
        np.testing.assert_allclose(slopes[critical], [-8, -2, 0.1, 3, 5, 7])
        assert 0.0 in slopes

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
