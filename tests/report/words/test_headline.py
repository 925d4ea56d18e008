"""The line of a hole: what is known of its motion, in few words."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from zerorev.model.plan import Certificate, Verification
from zerorev.model.profile import Profile
from zerorev.motion.drilling import Drilling
from zerorev.report.scene.motion_look import look
from zerorev.report.words.headline import headline

CHECKED = Verification(True, 1, 1, (0,) * 6, 0.0, 0.0, 0.0, 1.0)
PROVEN = Certificate("certified", 1, np.ones(6), np.ones(6), np.ones(6))
UNDECIDED, REFUTED = (replace(PROVEN, verdict=verdict, reasons=("r",)) for verdict in ("undecided", "refuted"))


def line(plan, answer, by_hand=None):
    hole = plan.holes[0].hole if answer is None else answer.hole
    return headline(hole, answer, plan.robot.joint_names, plan.settings, by_hand, None)


@pytest.mark.parametrize(
    ("change", "verdict", "tone"),
    [
        ({}, "not checked", "warn"),
        ({"verified": CHECKED}, "verified", "good"),
        ({"verified": replace(CHECKED, passed=False, failures=("A1 reverses",))}, "check failed", "bad"),
        ({"verified": CHECKED, "certificate": PROVEN}, "certified", "good"),
        ({"verified": CHECKED, "certificate": UNDECIDED}, "undecided", "warn"),
        ({"verified": CHECKED, "certificate": REFUTED}, "refuted", "bad"),
    ],
)  # fmt: skip
def test_what_is_known_of_a_planned_motion(published, change, verdict, tone):
    found = line(published, replace(published.holes[0], **change))
    assert (found.verdict, found.tone) == (verdict, tone)
    assert (found.before, found.after) == (6, 0)
    assert (found.why == "") == (tone == "good" or not change)


def test_a_hole_without_motion_or_without_answer(published):
    assert line(published, published.holes[3]).verdict == "no motion"
    unplanned = line(published, None)
    assert (unplanned.verdict, unplanned.after, unplanned.travel, unplanned.margin) == ("not planned", None, None, None)


def test_an_edited_motion_takes_the_place_of_the_planned_one(published):
    plan, answer = published, replace(published.holes[0], verified=CHECKED, deepest=0.09)
    hole, held = answer.hole, Profile.straight(answer.hole.depth, 0.2, 0.2, 0.2)
    seen = look(Drilling(plan.robot, plan.tool, hole), held, answer.motion.branch, plan.settings)
    found = line(plan, answer, seen)
    assert (found.after, found.verdict, found.tone) == (seen.score.reversals, "by hand, not checked", "warn")
    assert found.travel == pytest.approx(np.rad2deg(seen.score.travel))
    assert line(plan, answer).margin == pytest.approx(40)
    assert found.margin is None  # of the plan, and not of this motion
    lost = look(Drilling(plan.robot, plan.tool, hole), Profile.straight(hole.depth, 3.0, 3.0, 3.0), 4, plan.settings)
    assert not lost.runs
    found = line(plan, answer, lost)
    assert (found.after, found.verdict, found.why) == (None, "cannot run", lost.why)


def test_the_slowest_joint_is_named(published):
    found = line(published, published.holes[0])
    rate, name = found.slowest
    score = published.holes[0].score
    assert name == published.robot.joint_names[int(np.argmin(score.min_rate))]
    assert rate == pytest.approx(np.rad2deg(score.min_rate.min()) / 1e3)
