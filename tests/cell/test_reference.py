"""What a controller makes of a program: speeds, corner, smoothing, and the feed that the arm can run."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from zerorev.cell.followed import STEP
from zerorev.cell.motions import compared
from zerorev.cell.reference import Manner
from zerorev.errors import InputError
from zerorev.model.cycle import Cycle


def reference_of(published_plan, number=0, name="plan", **manner):
    hole = published_plan.holes[number]
    return compared(published_plan, hole, Manner(**manner), (name,)).followed[name]


def test_the_tip_stays_on_the_axis_and_the_joints_on_the_branch(published_plan):
    from zerorev.motion.kinematics import forward

    found = reference_of(published_plan, feed=0.05, corner=5e-3)
    drilling = found.drilling
    T = forward(drilling.robot, found.q) @ drilling.tool.T_flange_tcp
    places = drilling.hole.target - found.standoff[:, None] * drilling.hole.direction
    np.testing.assert_allclose(T[:, :3, 3], places, rtol=0, atol=1e-9)
    first, last = found.q[0], found.q[-1]
    stated = published_plan.holes[0].motion.joints
    np.testing.assert_allclose(last, stated[-1], rtol=0, atol=1e-6)
    assert np.abs(first - stated[0]).max() < 0.3  # the lead-in lies before


def test_the_corner_is_rounded_by_half_its_radius(published_plan):
    sharp = reference_of(published_plan, feed=0.02, corner=1e-6, smoothing=0.0, acceleration=100.0)
    blunt = reference_of(published_plan, feed=0.02, corner=8e-3, smoothing=0.0, acceleration=100.0)
    assert sharp.standoff.min() == pytest.approx(0.0, abs=3e-5)
    assert blunt.standoff.min() == pytest.approx(4e-3, abs=3e-5)


def test_where_the_tool_stands_the_tip_rests_as_long_as_asked_for(published_plan):
    standing = replace(published_plan, settings=replace(published_plan.settings, cycle=Cycle(dwell=0.5)))
    found = reference_of(standing, feed=0.02, smoothing=0.0, acceleration=100.0)
    rests = np.count_nonzero(found.standoff < 1e-9) * STEP
    assert rests == pytest.approx(0.5, abs=5 * STEP)
    assert np.ptp(found.q[found.standoff < 1e-9], axis=0).max() < 1e-9


def test_a_feed_so_small_that_no_memory_would_hold_it_is_refused(published_plan):
    with pytest.raises(InputError, match=r"takes 10,\d{3} s at this feed.*a greater feed: at most 300 s"):
        reference_of(published_plan, feed=1e-5)


def test_a_feed_that_is_programmed_is_reached_and_another_may_be_asked_for(published_plan):
    slow = reference_of(published_plan, feed=0.02, corner=1e-3)
    assert slow.slowed == 1.0
    assert slow.speed == pytest.approx(0.02, rel=1e-3)
    two = replace(published_plan, settings=replace(published_plan.settings, feed_plunge=5e-3, feed_retract=20e-3))
    found = reference_of(two, corner=1e-3)
    speed = np.diff(found.standoff) / STEP
    assert np.median(speed[speed < 0]) == pytest.approx(-5e-3, rel=0.01)
    assert np.median(speed[speed > 0]) == pytest.approx(20e-3, rel=0.01)


def test_what_the_arm_cannot_run_is_slowed(published_plan):
    """At 200 mm/s the published motions of positions 1 to 3 run at some 160, 40 and 125 mm/s."""
    for number, (low, high) in enumerate([(140, 185), (35, 50), (110, 145)]):
        found = reference_of(published_plan, number, feed=0.2, corner=10e-3)
        assert low < found.speed * 1e3 < high
        assert found.slowed < 1
        assert np.abs(np.gradient(found.psi, STEP)).max() < np.deg2rad(202)
        assert (np.abs(found.qd) <= 1.01 * found.drilling.robot.limits.speed).all()


def test_speeds_and_accelerations_are_those_of_the_joints(published_plan):
    found = reference_of(published_plan, feed=0.1, corner=5e-3)
    np.testing.assert_allclose(np.diff(found.q, axis=0) / STEP, (found.qd[1:] + found.qd[:-1]) / 2, rtol=0, atol=2e-3)
