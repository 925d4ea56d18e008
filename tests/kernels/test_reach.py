"""Reachable and viable sets against a naive twin on a grid; straight segments against slopes tried one by one."""

from __future__ import annotations

from itertools import pairwise

import numba
import numpy as np
import pytest

from oracles import free as twin
from zerorev.kernels import polyline, reach, viable
from zerorev.kernels.layout import Constraints
from zerorev.model.hole import Hole
from zerorev.motion import kinematics
from zerorev.motion.drilling import Drilling, joint_rates
from zerorev.search.viable import Grain, Tubes

SLOW = bool(numba.config.DISABLE_JIT)
CAP, LEAST = np.deg2rad(5e3), np.deg2rad(1e-4)
SHARES = 0.5 - 0.5 * np.cos(np.linspace(0, np.pi, polyline.SAMPLES))
# target [mm], posture, spins at the target [deg] among which the deepest is
PLACES = [
    ((200, 200, 1000), 3, (15.0, 35.0)),
    ((500, 300, 800), 2, (0.0, 20.0)),
    ((200, 400, 600), 0, (-172.0, -160.0)),
]


@pytest.fixture(autouse=True)
def division_by_zero_gives_infinity():
    """As in compiled kernels, also where they run as plain Python."""
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        yield


class Pair:
    """Both legs out of a few degrees of the target line, joint limits left aside."""

    def __init__(self, robot, tool, place, *, longest, grain, steepest=CAP, limited=False):
        target, self.posture, spins = place
        self.robot, self.tool, self.hole = robot, tool, Hole("h", np.array(target) * 1e-3, np.array([1.0, 0, 0]), 0.01)
        self.plane, self.grain, self.limited = Drilling(robot, tool, self.hole).plane, grain, limited
        self.held = Constraints(robot.limits.lower, robot.limits.upper, LEAST, 0.0, steepest, 2 * np.pi)
        self.room, self.tubes, self.viable, self.overlap = reach.workspaces(), Tubes(), Tubes(), np.empty(2)
        self.low, self.high = np.deg2rad(spins)
        _, theta_psi = joint_rates(Drilling(robot, tool, self.hole), 0.0, 0.5 * (self.low + self.high))
        flip = np.array([1, 1, 1, 1, 1.0 if robot.arm.sign[4] > 0 else -1.0, 1])
        self.sigma = np.sign(theta_psi[2 * self.posture])
        self.sense = self.sigma * flip
        self.asked = (robot.arm, self.plane, 2 * self.posture, self.sense, self.held, limited, grain)
        self.bound = viable.pair_bound(
            *self.asked, self.low, self.high, 0.0, longest, self.room, self.tubes.raw, self.tubes.rows
        )

    def meets(self, depth):
        return viable.pair_meets(
            *self.asked, depth, self.room, self.tubes.raw, self.tubes.rows, self.viable.raw, self.viable.rows,
            self.overlap,
        )  # fmt: skip

    def depth(self, least, close=1e-4):
        return viable.pair_depth(
            *self.asked, least, self.bound, close, self.room, self.tubes.raw, self.tubes.rows, self.viable.raw,
            self.viable.rows, self.overlap,
        )  # fmt: skip

    def row(self, leg, r):
        """A viable set."""
        return self.viable.raw[2][leg, r, : self.viable.raw[1][leg, r]]


@pytest.mark.parametrize("place", PLACES[:1] if SLOW else PLACES, ids=lambda place: str(place[0]))
def test_spins_viable_at_the_target_are_those_of_the_naive_twin(robot, tool, place):
    depth, step, turn = (0.012, 2e-3, 0.5) if SLOW else (0.024, 1e-3, 0.1)
    pair = Pair(robot, tool, place, longest=depth, grain=Grain(depth / 12, 0.07, 0.035, 1e-5))
    assert pair.meets(depth)
    psi = np.deg2rad(np.arange(place[2][0] - 90, place[2][1] + 90, turn))
    family = (psi > pair.low) & (psi < pair.high)
    seen = 0
    for leg in range(2):
        naive = twin.viable(
            robot, tool, pair.hole, 2 * pair.posture, (1 - 2 * leg) * pair.sigma, psi,
            step=step, steepest=CAP, min_rate=LEAST, depth=depth,
        )  # fmt: skip
        a, b = pair.row(leg, 0)[0]
        here = family & (psi >= a) & (psi <= b)
        # slopes of the twin are those of its grid, so that it sees a little less
        missed = 1.5 * np.deg2rad(turn) + (0.05 if SLOW else 0.02)
        inner = family & (psi > a + missed) & (psi < b - missed)
        assert naive[inner].all()
        assert not naive[family & ~here & ~(np.abs(psi - a) < 0.02) & ~(np.abs(psi - b) < 0.02)].any()
        seen += int(inner.sum())
    assert seen > (0 if SLOW else 20)


@pytest.mark.skipif(SLOW, reason="many rows")
@pytest.mark.parametrize("place", PLACES, ids=lambda place: str(place[0]))
def test_finer_grains_agree_and_a_greater_cap_is_at_least_as_deep(robot, tool, place):
    def depth(rows, steepest=CAP):
        grain = Grain(0.05 / rows, 4 / rows, 2 / rows, 1e-5)
        return Pair(robot, tool, place, longest=0.4, grain=grain, steepest=steepest).depth(0.005)

    assert depth(64) == pytest.approx(depth(96), rel=0.01)
    depths = [depth(64, CAP * share) for share in (0.2, 0.4, 0.7, 1.0, 2.0, 4.0)]
    assert all(b >= a * (1 - 0.005) for a, b in pairwise(depths))


@pytest.mark.skipif(SLOW, reason="many rows")
def test_within_the_limits_means_every_joint_within(robot, tool):
    """The least room over the joints at random points, against the angles themselves."""
    rng, place = np.random.default_rng(2), PLACES[1]
    pair = Pair(robot, tool, place, longest=0.05, grain=Grain.of(0.05, 24))
    within = 0
    for _ in range(200):
        s, psi, branch = rng.uniform(0, 0.1), rng.uniform(-np.pi, np.pi), int(rng.integers(8))
        room = reach.limit_room(robot.arm, pair.plane, branch, pair.sense, s, psi, pair.held, pair.room[1:])
        pose = kinematics.tcp_pose(pair.hole, s, psi) @ np.linalg.inv(tool.T_flange_tcp)
        angles = kinematics.inverse(robot, pose)[branch] + 2 * np.pi * np.arange(-2, 3)[:, None]
        fits = ((angles >= pair.held.lower) & (angles <= pair.held.upper)).any(axis=0).all()
        assert (room >= 0) == fits
        within += fits
    assert 20 < within < 180


def test_the_steepest_slopes_along_a_segment_are_those_found_one_by_one(robot, tool):
    rng, place = np.random.default_rng(5), PLACES[1]
    pair = Pair(robot, tool, place, longest=0.02, grain=Grain.of(0.02, 4))
    tried = np.linspace(-40, 40, 161 if SLOW else 1601)
    found = 0
    for _ in range(3 if SLOW else 40):
        s, length, psi = rng.uniform(0.005, 0.03), rng.choice([-1, 1]) * rng.uniform(1e-3, 4e-3), rng.uniform(-0.3, 0.9)
        side, slopes = rng.choice([-1.0, 1.0]), np.empty(2)
        polyline.slopes_along(
            robot.arm, pair.plane, pair.posture, side * pair.sense, pair.held, s, length, np.full(2, psi),
            np.array([1.0, -1.0]), np.full(2, -40.0), np.full(2, 40.0), SHARES, pair.room[0], slopes,
        )  # fmt: skip
        good = np.ones(tried.size, dtype=bool)
        for share in SHARES:
            theta_s, theta_psi = twin.rates_at(
                robot, tool, pair.hole, 2 * pair.posture, s + share * length, psi + share * length * tried
            )
            keeps = [
                twin.keeps(theta_s[n], theta_psi[n], tried[n], side * pair.sigma, LEAST) for n in range(tried.size)
            ]
            good &= np.array(keeps)
        if good.any() and good[good.argmax() :][: good.sum()].all():  # one interval of slopes
            apart = 1.5 * (tried[1] - tried[0])
            assert slopes == pytest.approx([tried[good].max(), tried[good].min()], abs=apart)
            found += 1
        elif not good.any() and not np.isnan(slopes).any():
            assert slopes[0] - slopes[1] < tried[1] - tried[0]  # between two that were tried
    assert found >= (1 if SLOW else 10)


@pytest.mark.skipif(SLOW, reason="many rows")
@pytest.mark.parametrize("place", PLACES, ids=lambda place: str(place[0]))
def test_a_leg_of_segments_keeps_every_joint_going_and_gets_nearly_as_deep(robot, tool, place):
    pair = Pair(robot, tool, place, longest=0.4, grain=Grain(1e-3, 0.07, 0.035, 1e-5))
    deepest = pair.depth(0.005)
    part = np.tile(np.linspace(0, 1, 49) ** 1.3, (2, 1))
    spins, wide = np.empty((2, 49, 2)), []
    guarded = pair.held._replace(min_rate=2 * LEAST)
    for share in (0.6, 0.8, 0.9, 1.01):
        depth = min(share * deepest, pair.bound)
        width = polyline.pair_width(
            robot.arm, pair.plane, 2 * pair.posture, pair.sense, pair.held, guarded, False, pair.grain, depth, part,
            SHARES, pair.room, pair.tubes.raw, pair.tubes.rows, pair.viable.raw, pair.viable.rows, spins, pair.overlap,
        )  # fmt: skip
        wide.append(width)
        if share == 0.8:
            psi = np.empty((2, 49))
            psi[:, 0] = pair.overlap.mean()
            for leg in range(2):
                standoff, side = part[leg] * share * deepest, (1 - 2 * leg) * pair.sense
                assert polyline.leg_out(
                    robot.arm, pair.plane, pair.posture, side, guarded, standoff, SHARES, pair.room[0], spins[leg],
                    psi[leg],
                )  # fmt: skip
                for n in range(48):
                    slope = (psi[leg, n + 1] - psi[leg, n]) / (standoff[n + 1] - standoff[n])
                    for s in np.linspace(standoff[n], standoff[n + 1], 5):
                        rates = twin.rates_at(
                            robot, tool, pair.hole, 2 * pair.posture, s, psi[leg, n] + slope * (s - standoff[n])
                        )
                        assert twin.keeps(*rates, slope, (1 - 2 * leg) * pair.sigma, LEAST)
    assert min(wide[:3]) > 0
    assert wide[3] < 0  # deeper than any curve
