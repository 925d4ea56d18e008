"""Motions that break chips, as four numbers: the path and the margins that follow, and how they are improved."""

import numpy as np
import pytest

from oracles.broken_chips import kept, margin, way_back
from zerorev.kernels import broken
from zerorev.model.cycle import Cycle
from zerorev.model.hole import Hole
from zerorev.model.settings import Settings
from zerorev.motion.drilling import Drilling, joint_rates
from zerorev.search.broken_legs import BrokenLegs, Numbers

FIVE = Cycle("chip_break", 5e-3, 0.3e-3)
BRANCH = 3
# a motion of position 1 that breaks chips and turns no joint round
GOOD = Numbers(-0.52, 8.0, -10.0, 0.042)


@pytest.fixture
def drilling(robot, tool):
    return Drilling(robot, tool, Hole("h", np.array([0.5, 0.3, 0.8]), np.array([1.0, 0.0, 0.0]), 0.05))


def legs_of(drilling, numbers, **settings):
    return BrokenLegs.at(drilling, Settings(**settings), BRANCH, FIVE, numbers.depth)


@pytest.mark.parametrize("numbers", [GOOD, Numbers(-0.2, -9.0, 7.0, 0.031), Numbers(-0.52, 8.0, -4.0, 0.042)])
def test_the_path_is_the_one_of_the_definition(numbers, drilling):
    """The tool draws back with the slope nearest to the retract's that turns no joint round."""
    settings, psi = Settings(), numbers.psi
    profile = legs_of(drilling, numbers).motion(numbers)
    standoff, wanted = [0.0], [psi]
    for at in FIVE.breaks(numbers.depth)[::-1]:
        end = wanted[-1] + numbers.plunge * (at + FIVE.back - standoff[-1])
        slope = float(
            way_back(
                drilling, settings, BRANCH, at, np.array([end]), np.array([numbers.plunge]),
                np.array([numbers.retract]), FIVE.back,
            )[0]
        )  # fmt: skip
        slope = numbers.retract if np.isnan(slope) else slope
        standoff += [at + FIVE.back, at]
        wanted += [end, end - slope * FIVE.back]
    np.testing.assert_allclose(profile.standoff[1 : profile.corner + 1][::-1], standoff, atol=1e-12)
    np.testing.assert_allclose(profile.psi[1 : profile.corner + 1][::-1], wanted, atol=1e-9)
    assert profile.psi[0] == pytest.approx(wanted[-1] + numbers.plunge * (numbers.depth - standoff[-1]), abs=1e-9)
    assert profile.psi[-1] == pytest.approx(psi + numbers.retract * numbers.depth, abs=1e-12)


def test_what_lacks_is_what_the_slowest_joint_lacks(drilling):
    """By rates along each piece of the path, one after the other."""
    legs = legs_of(drilling, GOOD)
    _, lack = legs.improved(GOOD, "travel", np.inf)  # no step gains so much
    profile = legs.motion(GOOD)
    standoff, psi = profile.standoff[: profile.corner + 1][::-1], profile.psi[: profile.corner + 1][::-1]
    theta_s, theta_psi = (field[BRANCH] for field in joint_rates(drilling, 0.0, GOOD.psi))
    side = np.sign(theta_s + GOOD.plunge * theta_psi)[None]
    worst = [margin(drilling, BRANCH, side, -1, (0.0, GOOD.depth, psi[:1], np.array([GOOD.retract])))[0]]
    for n in range(standoff.size - 1):
        slope = np.array([(psi[n + 1] - psi[n]) / (standoff[n + 1] - standoff[n])])
        worst.append(margin(drilling, BRANCH, side, 1 - 2 * (n % 2), (*standoff[n : n + 2], psi[n : n + 1], slope))[0])
    assert -lack == pytest.approx(min(worst) - Settings().min_rate, rel=0.02, abs=1e-4)


@pytest.mark.parametrize("goal", ["depth", "travel"])
def test_small_steps_improve_a_motion_and_keep_the_rules(goal, drilling):
    legs = legs_of(drilling, GOOD)
    start, lack = legs.improved(GOOD, "travel", np.inf)
    assert start == GOOD
    assert lack <= 0
    deepest = FIVE.nearest + (legs.count + 1) * 5e-3
    found, lack = BrokenLegs(drilling, Settings(), BRANCH, FIVE, legs.count, deepest).improved(GOOD, goal, 1e-6)
    assert lack < 1e-6
    if goal == "depth":
        assert found.depth == pytest.approx(deepest, rel=1e-6)  # no joint keeps it from being deeper
    else:
        assert found.depth == GOOD.depth
        travel = [np.abs(np.diff(joints_at_the_ends(drilling, legs, each), axis=0)).sum() for each in (GOOD, found)]
        assert travel[1] < travel[0]
    standoff, spins = kept(
        drilling, Settings(min_rate=Settings().min_rate - 1e-4), BRANCH, found.depth, FIVE,
        *(np.array([value]) for value in found[:3]),
    )  # fmt: skip
    assert spins.shape[1] == 1
    np.testing.assert_allclose(standoff, legs.motion(found).standoff, atol=1e-12)


def joints_at_the_ends(drilling, legs, numbers):
    profile = legs.motion(numbers)
    return drilling.angles(profile.standoff[[0, -1]], profile.psi[[0, -1]])[:, BRANCH]


def test_out_of_reach_nothing_is_improved(drilling):
    far = Numbers(0.0, 8.0, -10.0, 3.0)
    assert BrokenLegs(drilling, Settings(), BRANCH, FIVE, 2).improved(far, "depth", 1e-5) == (far, np.inf)


def test_a_joint_at_its_limit_is_known(drilling):
    limits = drilling.limits
    joints = joints_at_the_ends(drilling, legs_of(drilling, GOOD), GOOD)
    assert not legs_of(drilling, GOOD).at_a_limit(GOOD)
    assert ((joints > limits.lower) & (joints < limits.upper)).all()
    breaking = legs_of(drilling, GOOD)._breaking
    tight = breaking._replace(upper=breaking.upper.copy())
    tight.upper[3] = joints[:, 3].max() - 0.01
    room = broken.room_of_joints(
        drilling.robot.arm, drilling.plane, BRANCH, tight, len(FIVE.breaks(GOOD.depth)), (2, 17), np.array(GOOD)
    )
    assert room == pytest.approx(-0.01, abs=1e-6)
