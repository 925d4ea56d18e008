"""Legs improved by sequential linear programming: what its rows say, and where it ends."""

import numpy as np
import pytest
from numba import config

from zerorev.kernels import segments
from zerorev.kernels.layout import Constraints
from zerorev.model.hole import Hole
from zerorev.motion import kinematics
from zerorev.motion.drilling import Drilling
from zerorev.search.segments import GOALS, SegmentedLegs, improved

SLOW = config.DISABLE_JIT
NO_LIMIT = np.full(6, np.inf)
LEAST = np.deg2rad(1e-4)
TARGET = (0.5, 0.3, 0.8)
# position 1's straight legs, a little short of its deepest stroke (tests/test_depth.py)
BRANCH, PSI = 2, np.deg2rad([-31.3, 11.8, -76.0])


def hole_at(target=TARGET):
    return Hole("h", np.array(target), np.array([1.0, 0.0, 0.0]), 0.05)


def start_at(depth, spins=PSI):
    return SegmentedLegs(np.array([[0.0, depth]] * 2), np.array([[spins[0], spins[1]], [spins[0], spins[2]]]))


def setting_out(robot, plane, posture, psi_t):
    """Signs of d theta / d psi at the target."""
    theta_s, theta_psi = np.empty((6, 1)), np.empty((6, 1))
    from zerorev.kernels.field import rates

    rates(robot.arm, plane, posture, np.zeros(1), np.array([psi_t]), theta_s, theta_psi)
    return np.sign(theta_psi[:, 0])


@pytest.fixture
def go(robot, tool):
    plane = Drilling(robot, tool, hole_at()).plane
    sense = setting_out(robot, plane, BRANCH // 2, PSI[0])

    def better(legs, goal="depth", branch=BRANCH, **rules):
        held = Constraints(**({"lower": -NO_LIMIT, "upper": NO_LIMIT, "min_rate": LEAST} | rules))
        return improved(robot.arm, plane, branch, sense, held, legs, goal, samples=5 if SLOW else 17, enough=1e-7)

    better.margin = lambda legs: dense_margin(robot, plane, sense, legs)
    return better


def dense_margin(robot, plane, sense, legs):
    """Least rate in the wanted direction of either leg at many points: a naive twin."""
    from zerorev.kernels.field import rates

    least = np.inf
    for k in range(2):
        depth, (psi_t, end) = legs.standoff[k, -1], legs.psi[k, [0, -1]]
        s = np.linspace(0, depth, 2001)
        theta_s, theta_psi = np.empty((2, 6, s.size))
        rates(robot.arm, plane, BRANCH // 2, s, psi_t + (end - psi_t) * s / depth, theta_s, theta_psi)
        rate = (1 - 2 * k) * sense[:, None] * (theta_s + (end - psi_t) / depth * theta_psi)
        least = min(least, rate.min())
    return least


def test_the_elbow_and_its_derivatives(robot, tool):
    """Its square sine against the angle of joint 3 itself, its derivatives against differences."""
    plane, rng, seen = Drilling(robot, tool, hole_at()).plane, np.random.default_rng(3), 0
    for _ in range(20):
        s, psi, posture = rng.uniform(0, 0.1), rng.uniform(-np.pi, np.pi), int(rng.integers(4))
        bend, by_s, by_psi = segments.elbow(robot.arm, plane, posture, s, psi)
        poses = kinematics.tcp_pose(hole_at(), s, psi) @ np.linalg.inv(tool.T_flange_tcp)
        joints = kinematics.inverse(robot, poses)[2 * posture]
        if np.isnan(joints).any():
            assert not bend > 0
            continue
        # the elbow is stretched where the forearm, a2 and c3 of it, lies in line with the upper arm
        model = joints[2] * robot.arm.sign[2] - robot.arm.offset[2]
        assert bend == pytest.approx(np.sin(model - np.arctan2(-robot.arm.a2, robot.arm.c3)) ** 2, abs=1e-9)
        for derivative, ds, dpsi in ((by_s, 1e-6, 0.0), (by_psi, 0.0, 1e-6)):
            ahead = segments.elbow(robot.arm, plane, posture, s + ds, psi + dpsi)[0]
            behind = segments.elbow(robot.arm, plane, posture, s - ds, psi - dpsi)[0]
            assert derivative == pytest.approx((ahead - behind) / 2e-6, rel=1e-5, abs=1e-7)
        seen += 1
    assert seen >= 5


class TestDepth:
    def test_ends_where_a_joint_just_stops_and_nothing_near_is_deeper(self, go):
        legs, lack = go(start_at(0.08))
        assert lack <= 1e-6
        assert go.margin(legs) == pytest.approx(LEAST, abs=2e-3 if SLOW else 1e-5)
        rng = np.random.default_rng(4)
        deeper = 1.002 * legs.depth
        for size in (1e-4, 1e-3, 1e-2, 1e-1):
            for _ in range(3 if SLOW else 50):
                moved = PSI.copy()
                moved[:] = legs.psi[0, 0], legs.psi[0, 1], legs.psi[1, 1]
                assert go.margin(start_at(deeper, moved + rng.normal(0, size, 3))) < LEAST

    def test_begins_as_well_where_the_rules_are_broken(self, go):
        one, other = go(start_at(0.08))[0], go(start_at(0.13))[0]
        assert other.depth == pytest.approx(one.depth, rel=1e-4)

    def test_limits_are_kept_at_the_outer_ends(self, robot, tool, go):
        """A limit set half way to where joint 1 would go without."""
        free, _ = go(start_at(0.08))

        def ends(legs):
            psi = [legs.psi[0, 1], legs.psi[0, 0], legs.psi[1, 1]]
            standoff = np.array([legs.depth, 0.0, legs.depth])
            poses = kinematics.tcp_pose(hole_at(), standoff, np.array(psi)) @ np.linalg.inv(tool.T_flange_tcp)
            return kinematics.inverse(robot, poses)[:, BRANCH]

        here = ends(free)
        furthest = here[:, 0].max()
        assert here[1, 0] < furthest < here[1, 0] + np.pi
        upper = NO_LIMIT.copy()
        upper[0] = 0.5 * (here[1, 0] + furthest)
        lower = np.where(np.isfinite(upper), upper - 2 * np.pi, -np.inf)
        held, lack = go(start_at(0.08), lower=lower, upper=upper)
        assert lack <= 1e-6
        assert ends(held)[:, 0].max() == pytest.approx(upper[0], abs=1e-6)
        assert held.depth < free.depth

    def test_the_spin_is_kept_within_its_bound(self, go):
        bound = np.deg2rad(60)
        legs, lack = go(start_at(0.05, np.deg2rad([-31.3, 0.0, -58.0])), psi_bound=bound)
        assert lack <= 1e-6
        assert np.abs(legs.psi).max() <= bound + 1e-9
        assert legs.depth < go(start_at(0.08))[0].depth

    def test_a_twist_rate_is_kept(self, go):
        free, _ = go(start_at(0.08))
        steepest = 0.8 * np.abs(np.diff(free.psi)).max() / free.depth
        legs, lack = go(start_at(0.05, PSI[0] + 0.4 * (PSI - PSI[0])), steepest=steepest)
        assert lack <= 1e-6
        assert np.abs(np.diff(legs.psi)).max() / legs.depth <= steepest * (1 + 1e-6)
        assert legs.depth < free.depth

    def test_what_cannot_be_run_is_left_as_it_is(self, robot, tool):
        plane = Drilling(robot, tool, hole_at((3.0, 0.0, 0.5))).plane
        start, held = start_at(0.05), Constraints(-NO_LIMIT, NO_LIMIT, LEAST)
        legs, lack = improved(robot.arm, plane, 0, np.ones(6), held, start, "depth")
        assert lack == np.inf
        np.testing.assert_array_equal(legs.psi, start.psi)


@pytest.mark.parametrize("goal", [goal for goal in GOALS if goal != "depth"])
def test_other_goals_keep_the_depth_and_are_improved(go, goal):
    start, lack = go(start_at(0.05), "margin", min_rate=np.deg2rad(5.0))
    assert lack <= 0
    legs, lack = go(start, goal, min_rate=np.deg2rad(5.0))
    assert legs.depth == start.depth
    assert lack <= 1e-6

    def turn(legs):
        return np.abs(legs.psi[:, 1] - legs.psi[:, 0]).min()

    if goal == "margin":
        assert go.margin(legs) >= go.margin(start) * (1 - 1e-6)
    elif goal == "plunge_rotation":
        assert turn(legs) < turn(start)
    else:
        assert legs.psi.tolist() != start.psi.tolist()


def test_the_greatest_margin_is_that_of_a_dense_search(go):
    """All spins around it on a grid that closes in, judged by the naive twin."""
    found, _ = go(start_at(0.06), "margin")
    best, centre = go.margin(start_at(0.06)), PSI.copy()
    rng = np.random.default_rng(5)
    for size in np.geomspace(0.3, 1e-3, 2 if SLOW else 40):
        for _ in range(2 if SLOW else 60):
            spins = centre + rng.normal(0, size, 3)
            margin = go.margin(start_at(0.06, spins))
            if margin > best:
                best, centre = margin, spins
    assert go.margin(found) >= best - 1e-6
    if not SLOW:
        assert go.margin(found) == pytest.approx(best, rel=2e-2)
