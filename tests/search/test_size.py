"""Robot, tool, hole and settings greater or smaller together change nothing but lengths: no tolerance is in metres."""

from __future__ import annotations

from dataclasses import replace

import numba
import numpy as np
import pytest

from oracles.holes import ROBOTS, Drilled, random_hole, scaled
from zerorev.model.job import Settings
from zerorev.model.resized import resized, resized_profile
from zerorev.motion.drilling import Drilling
from zerorev.motion.evaluation import evaluate
from zerorev.planning.hole import plan
from zerorev.program.lead_in import find_lead_in
from zerorev.search.deepest import WORTH_RAISING, deepest_stroke

pytestmark = pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="whole searches")


def some_hole(seed, **kind):
    """A hole at a random share of its deepest stroke, without masses: what those do depends on the size."""
    drilled = random_hole(seed, narrowed=seed % 4 == 3, **kind)
    drilled = replace(drilled, robot=replace(drilled.robot, dynamics=None))
    deepest = deepest_stroke(*drilled.all).depth
    share = np.random.default_rng(seed).choice([0.5, 0.97, 1.05])
    return drilled.deep(share * deepest if deepest > 0 else 0.02 * drilled.robot.reach)


def check_size(drilled, factor, rel):
    """The plan at another size against the plan itself."""
    other = scaled(drilled, factor)
    mine, theirs = plan(*drilled.all), plan(*other.all)
    assert theirs.status == mine.status
    assert theirs.deepest / factor == pytest.approx(mine.deepest, rel=rel)
    assert [finding.kind for finding in theirs.findings] == [finding.kind for finding in mine.findings]
    if mine.motion is None:
        return
    # where no limit tells the two wrist flips apart, the last bits choose one
    assert theirs.motion.branch // 2 == mine.motion.branch // 2
    assert theirs.score.reversals_per_joint == mine.score.reversals_per_joint
    assert theirs.score.travel == pytest.approx(mine.score.travel, rel=rel)
    assert theirs.score.min_rate * factor == pytest.approx(mine.score.min_rate, rel=100 * rel, abs=1e-4)
    assert theirs.verified.passed
    leads = [
        find_lead_in(Drilling(each.robot, each.tool, answer.hole), answer.motion, each.settings.lead_in).length
        for each, answer in ((drilled, mine), (other, theirs))
    ]
    assert leads[1] / factor == pytest.approx(leads[0], abs=3e-6 * drilled.robot.size)


class TestStraightLegs:
    @pytest.mark.parametrize("factor", [0.02, 30.0])
    @pytest.mark.parametrize("seed", [6, 36, 20_098])
    def test_a_plan_is_the_same_at_any_size(self, seed, factor):
        """Of hole 36 the deepest stroke was once half of what it is, of 20,098 the travel a fifth more."""
        check_size(some_hole(seed), factor, 1e-5)

    @pytest.mark.parametrize(("seed", "depth"), [(20_412, 79.547e-3), (20_494, 2.0595e-3)])
    @pytest.mark.parametrize("factor", [0.02, 0.7, 5.0])
    def test_the_deepest_stroke_is(self, seed, depth, factor):
        """At least so deep [m]; it was 0.6 % less at some sizes next to a singularity, and half on flat ground."""
        drilled = some_hole(seed)
        mine, theirs = deepest_stroke(*drilled.all).depth, deepest_stroke(*scaled(drilled, factor).all).depth
        assert mine > depth
        assert theirs / factor == pytest.approx(mine, rel=WORTH_RAISING)

    @pytest.mark.long
    def test_more_plans_are(self):
        for seed in range(40, 52):
            check_size(some_hole(seed), (0.02, 0.3, 5.0, 30.0)[seed % 4], 1e-5)

    @pytest.mark.soak
    @pytest.mark.parametrize("seed", range(20_000, 20_500))
    def test_five_hundred_plans_are(self, seed):
        """To thrice of what a stroke is raised for."""
        drilled = some_hole(seed)
        for factor in (0.02, 0.3, 5.0, 30.0):
            check_size(drilled, factor, 3 * WORTH_RAISING)


class TestPowersOfTwo:
    @pytest.mark.parametrize(("legs", "factor"), [("straight", 2.0**-5), ("straight", 16.0), ("free", 16.0)])
    def test_change_no_digit(self, legs, factor):
        drilled = some_hole(5 if legs == "straight" else 2, legs=legs)
        mine, theirs = plan(*drilled.all), plan(*scaled(drilled, factor).all)
        assert theirs.deepest == mine.deepest * factor
        np.testing.assert_array_equal(theirs.motion.profile.psi, mine.motion.profile.psi)
        np.testing.assert_array_equal(theirs.motion.profile.standoff, mine.motion.profile.standoff * factor)
        assert theirs.score.reversals_per_joint == mine.score.reversals_per_joint
        assert theirs.score.travel == pytest.approx(mine.score.travel, rel=1e-12)


@pytest.mark.parametrize("factor", [0.25, 8.0])
def test_a_resized_evaluation_is_that_of_the_resized_motion(factor, robot, tool, positions):
    """Of one that reverses, so that events are resized, too."""
    drilled = Drilled(robot, tool, positions[0].hole, Settings())
    other = scaled(drilled, factor)
    held = positions[0].held_spin
    resized_there = evaluate(*drilled.all[:3], held, 4).resized(factor)
    there = evaluate(*other.all[:3], resized_profile(held, factor), 4)
    assert len(there.score.events) == 6
    for mine, theirs in zip(resized_there.score.events, there.score.events, strict=True):
        assert (mine.joint, mine.leg) == (theirs.joint, theirs.leg)
        assert mine.standoff == pytest.approx(theirs.standoff, abs=1e-12)
    for name in ("reversals_per_joint", "travel", "min_rate", "mean_rate", "limit_distance"):
        np.testing.assert_allclose(getattr(resized_there.score, name), getattr(there.score, name), rtol=1e-9, atol=1e-9)
    np.testing.assert_array_equal(resized_there.motion.profile.standoff, there.motion.profile.standoff)
    np.testing.assert_allclose(resized_there.motion.joints, there.motion.joints, atol=1e-12)


class TestSize:
    def test_is_the_power_of_two_next_to_the_reach(self):
        for robot in ROBOTS:
            assert 0.5**0.5 * (1 - 1e-12) <= robot.reach / 0.7 / robot.size <= 2**0.5 * (1 + 1e-12)
            assert np.frexp(robot.size)[0] == 0.5
            assert robot.nil_rate * robot.size == pytest.approx(np.deg2rad(1e-9) * 1e3)

    def test_resizing_and_back_changes_no_digit(self):
        drilled = random_hole(1)
        there = resized(*drilled.all, 0.25)
        robot, tool, hole, settings = resized(*there, 4.0)
        assert robot.arm == drilled.robot.arm
        np.testing.assert_array_equal(tool.T_flange_tcp, drilled.tool.T_flange_tcp)
        np.testing.assert_array_equal(hole.target, drilled.hole.target)
        assert (hole.depth, settings) == (drilled.hole.depth, drilled.settings)
        assert there[0].reach == drilled.robot.reach / 4
        assert there[3].min_rate == drilled.settings.min_rate * 4
