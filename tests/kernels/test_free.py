"""Tubes of reachable spins against a naive twin on a grid; admissible slopes against slopes tried one by one."""

from __future__ import annotations

import numba
import numpy as np
import pytest

from oracles import free as twin
from zerorev.kernels import field, free, segments, tube
from zerorev.kernels.layout import Constraints
from zerorev.model.hole import Hole
from zerorev.motion.drilling import Drilling
from zerorev.search.viable import Grain

SLOW = bool(numba.config.DISABLE_JIT)
X = np.array([1.0, 0.0, 0.0])
CAP = np.deg2rad(5e3)
LEAST = np.deg2rad(1e-4)
COARSE, FINE = Grain(4e-3, 0.4, 0.2, 1e-3), Grain(1e-3, 0.1, 0.05, 1e-6)
# target [mm], posture, spin at the target [deg] near the deepest
PLACES = [((200, 200, 1000), 3, 24.0), ((500, 300, 800), 2, 10.0), ((200, 400, 600), 0, -168.0)]


@pytest.fixture(autouse=True)
def division_by_zero_gives_infinity():
    """As in compiled kernels, also where they run as plain Python."""
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        yield


def hole_at(target_mm):
    return Hole("h", np.array(target_mm) * 1e-3, X, 0.01)


def held_by(robot, *, min_rate=LEAST, psi_bound=0.0, steepest=CAP):
    return Constraints(robot.limits.lower, robot.limits.upper, min_rate, psi_bound, steepest, 2 * np.pi)


class Marched:
    """Both tubes out of one spin at the target."""

    def __init__(self, robot, tool, target, posture, psi_deg, held, grain, longest):
        self.plane, self.posture, self.psi_t = (
            Drilling(robot, tool, hole_at(target)).plane,
            posture,
            np.deg2rad(psi_deg),
        )
        self.room, self.sense = tube.workspace(), np.empty(6)
        self.tubes, self.rows = np.empty((2, tube.MAX_ROWS, tube.WIDTH)), np.zeros(2, np.int64)
        self.depth = free.free_depth(
            robot.arm, self.plane, posture, self.psi_t, self.sense, held, grain, longest,
            self.room, self.tubes, self.rows,
        )  # fmt: skip


def test_admissible_slopes_are_those_that_keep_every_joint_going(robot, tool):
    """On random points, for random signs, among slopes tried one by one."""
    rng = np.random.default_rng(1)
    hole, held = hole_at((500, 300, 800)), held_by(robot, min_rate=np.deg2rad(10.0))
    plane = Drilling(robot, tool, hole).plane
    work, lo, hi, spare = tube.workspace()
    slopes = np.linspace(-CAP, CAP, 4001)
    seen = 0
    for _ in range(10 if SLOW else 60):
        posture, s = int(rng.integers(4)), rng.uniform(0, 0.1)
        psi = rng.uniform(-np.pi, np.pi, 8)
        work[field.STANDOFF * field.BLOCK :][:8], work[field.PSI * field.BLOCK :][:8] = s, psi
        field.fields(robot.arm, plane, posture, 8, work)
        theta_s, theta_psi = twin.rates_at(robot, tool, hole, 2 * posture, s, psi)
        unflipped = np.array([1, 1, 1, 1, 1.0 if robot.arm.sign[4] > 0 else -1.0, 1])
        for n in range(8):
            # signs that some slope has, so that there is something to find
            sigma = np.sign(theta_s[n] + rng.uniform(-CAP, CAP) * theta_psi[n])
            if np.isnan(sigma).any():
                sigma = np.ones(6)
            tube.admissible(work, 8, sigma * unflipped, held, lo, hi, spare)
            good = slopes[twin.keeps(theta_s[n], theta_psi[n], slopes[:, None], sigma, held.min_rate)]
            between = slopes[(slopes > lo[n] + 1e-6) & (slopes < hi[n] - 1e-6)]
            assert np.isin(between, good).all()
            assert ((good >= lo[n] - 1e-6) & (good <= hi[n] + 1e-6)).all()
            assert (spare[0, n] >= 0) == (lo[n] <= hi[n])
            seen += good.size > 0
    assert seen > (20 if SLOW else 200)


@pytest.mark.parametrize("place", PLACES[:1] if SLOW else PLACES, ids=lambda place: str(place[0]))
def test_as_deep_as_the_naive_twin_and_little_deeper(robot, tool, place):
    target, posture, psi_deg = place
    step, turn, longest = (2e-3, np.deg2rad(1.0), 0.02) if SLOW else (1e-3, np.deg2rad(0.1), 0.08)
    held = held_by(robot)
    marched = Marched(robot, tool, target, posture, psi_deg, held, COARSE if SLOW else FINE, longest)
    depths = []
    unflipped = np.array([1, 1, 1, 1, 1.0 if robot.arm.sign[4] > 0 else -1.0, 1])
    for side in (1.0, -1.0):
        sigma = side * marched.sense * unflipped
        depths.append(
            twin.reach(
                robot, tool, hole_at(target), 2 * posture, marched.psi_t, sigma,
                step=step, turn=turn, steepest=CAP, min_rate=LEAST, longest=longest, widest=np.deg2rad(110),
            )
        )  # fmt: skip
    naive = min(depths)
    assert naive > 0.01
    assert marched.depth >= naive - 1e-3
    assert marched.depth <= 1.05 * naive + 3 * step


@pytest.mark.skipif(SLOW, reason="many rows")
@pytest.mark.parametrize("place", PLACES, ids=lambda place: str(place[0]))
def test_finer_grains_agree(robot, tool, place):
    depths = [
        Marched(robot, tool, *place, held_by(robot), Grain(step, 100 * step, 50 * step, 1e-7), 0.4).depth
        for step in (1e-3, 5e-4, 2.5e-4)
    ]
    assert depths[1:] == pytest.approx(depths[:-1], abs=3e-4)
    assert depths[2] == pytest.approx(depths[1], abs=1.2e-4)


@pytest.mark.skipif(SLOW, reason="many rows")
def test_less_is_reached_with_less_twist_more_threshold_or_bounded_spin(robot, tool):
    target, posture, psi_deg = PLACES[0]

    def depth(**rules):
        return Marched(robot, tool, target, posture, psi_deg, held_by(robot, **rules), FINE, 0.4).depth

    assert depth(steepest=CAP) >= depth(steepest=0.7 * CAP) > 0
    assert depth() > depth(min_rate=np.deg2rad(5.0)) > depth(min_rate=np.deg2rad(20.0))
    assert depth() > depth(psi_bound=np.deg2rad(50.0)) > 0


@pytest.mark.skipif(SLOW, reason="many rows")
@pytest.mark.parametrize("unit", [0.0, 0.05])
def test_the_derivatives_of_segments_are_those_of_differences(robot, tool, unit):
    plane = Drilling(robot, tool, hole_at((500, 300, 800))).plane
    standoff, psi, shares = np.array([0.0, 0.02, 0.05, 0.09]), np.array([0.35, 0.5, 0.7, 1.0]), np.linspace(0, 1, 5)
    side = np.array([1.0, -1.0, 1.0, 1.0, -1.0, 1.0])

    def look(s, p):
        out = np.empty((3, 5, 6, 5))
        segments.linearise(robot.arm, plane, 2, side, s, p, shares, np.deg2rad(5.0), unit, out)
        return out

    here = look(standoff, psi)
    assert np.isfinite(here).all()
    for n in range(1, 4):
        for column, nudge in enumerate((np.array([1e-6, 0.0]), np.array([0.0, 1e-6]))):
            axis = np.eye(4)[n]
            ahead = look(standoff + nudge[0] * axis, psi + nudge[1] * axis)[..., 0]
            behind = look(standoff - nudge[0] * axis, psi - nudge[1] * axis)[..., 0]
            numeric = (ahead - behind) / 2e-6
            np.testing.assert_allclose(here[n - 1, ..., 3 + column], numeric[n - 1], rtol=1e-4, atol=1e-3)
            if n < 3:
                np.testing.assert_allclose(here[n, ..., 1 + column], numeric[n], rtol=1e-4, atol=1e-3)
