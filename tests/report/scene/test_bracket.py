"""The bracket as arrays: what lies between the legs does not reverse at the target, and the other way round."""

from __future__ import annotations

import numpy as np
import pytest

from oracles.published import POSITIONS
from zerorev.model.profile import Profile
from zerorev.motion.drilling import Drilling
from zerorev.motion.evaluation import evaluate
from zerorev.report.scene.bracket import bracket

STEP = np.deg2rad(1.0)


def rates_of(robot, tool, psi_deg, position=POSITIONS[0]):
    profile = Profile.straight(position.hole.depth, *np.deg2rad(psi_deg))
    return bracket(Drilling(robot, tool, position.hole), profile, position.branch, STEP), profile


def test_the_published_plan_brackets_all_six(robot, tool, position):
    found = bracket(Drilling(robot, tool, position.hole), position.profile, position.branch, STEP)
    assert found.between.all()
    start, target, end = position.psi_deg
    slopes = np.array([start - target, end - target]) / position.depth_mm
    np.testing.assert_allclose(found.slopes, slopes, atol=1e-12)
    assert found.chosen == pytest.approx(np.deg2rad(target))


def test_a_joint_reverses_at_the_target_exactly_where_it_is_not_between(robot, tool):
    position, rng, seen = POSITIONS[0], np.random.default_rng(7), set()
    for psi_deg in rng.uniform(-40, 40, (40, 3)):
        found, profile = rates_of(robot, tool, psi_deg)
        score = evaluate(robot, tool, position.hole, profile, position.branch).score
        if score is None:
            continue
        turned = {event.joint for event in score.events if event.leg == "target"}
        assert turned == {i + 1 for i in range(6) if not found.between[i]}
        seen.add(len(turned))
    assert len(seen) > 3


def test_the_marked_spins_are_those_at_which_these_slopes_would_reverse_nothing_at_the_target(robot, tool):
    position = POSITIONS[0]
    found, _ = rates_of(robot, tool, position.psi_deg)
    marked = found.psi[found.all_between]
    assert 0 < marked.size < found.psi.size
    slopes = np.deg2rad(found.slopes) * 1e3
    short = 1e-4  # [m]: of a stroke so short nothing turns within a leg
    for psi in found.psi[::9]:
        profile = Profile(np.array([short, 0, short]), psi + np.array([slopes[0] * short, 0, slopes[1] * short]))
        score = evaluate(robot, tool, position.hole, profile, position.branch).score
        if score is not None:
            at_target = sum(event.leg == "target" for event in score.events)
            assert (at_target == 0) == bool(np.isin(psi, marked))


def test_what_is_shown_holds_the_slopes_and_the_chosen_spin(robot, tool):
    found, _ = rates_of(robot, tool, (30, -40, 35))
    low, high = found.rates
    assert low < found.slopes.min() < found.slopes.max() < high
    left, right = found.reached
    assert left < found.chosen < right
    x, y = found.curve(0)
    assert x.shape == y.shape
    assert (np.diff(x) >= -1e-9).all()
