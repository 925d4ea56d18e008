"""What a page shows: every change makes another value, and answers stay only where they still hold."""

from __future__ import annotations

from dataclasses import replace

import pytest

from zerorev.errors import InputError
from zerorev.files.io import plan_to_json
from zerorev.model.finding import Finding
from zerorev.planning.sequence import with_moves
from zerorev.web.job_edits import answered, with_hole
from zerorev.web.state import Progress, Steered, opened_job, opened_plan, plan_of, selected, shown, steered


def test_a_plan_opened_is_the_plan_taken_away(state, planned):
    assert plan_to_json(with_moves(plan_of(state))) == plan_to_json(planned)


def test_a_plan_in_pieces_is_the_plan_of_the_command_line(job, planned):
    state = opened_job(job)
    with pytest.raises(InputError, match="nothing is planned yet"):
        plan_of(state)
    for answer in reversed(planned.holes):
        state = answered(state, answer)
    assert plan_to_json(with_moves(plan_of(state))) == plan_to_json(planned)


def test_looking_at_another_hole_lets_the_edited_motion_go(state, job):
    by_hand = Steered(shown(state).profile.reversed(), 2)
    edited = steered(state, by_hand)
    assert shown(edited) is by_hand
    other = selected(edited, job.holes[1].id)
    assert other.steered is None
    assert other.hole is job.holes[1]
    assert selected(edited, job.holes[0].id) is edited
    with pytest.raises(InputError, match="no hole 'x'"):
        selected(state, "x")


def test_a_plan_of_some_holes_says_which_are_missing(job, planned):
    state = answered(opened_job(job), planned.holes[1])
    assert state.unplanned == (job.holes[0].id, job.holes[2].id)
    (found,) = [finding for finding in plan_of(state).findings if finding.kind == "unfinished"]
    assert (found.level, found.hole) == ("warning", None)
    assert found.message == f"only 1 of 3 holes planned; missing: holes {job.holes[0].id}, {job.holes[2].id}"
    assert with_moves(plan_of(opened_plan(planned))).findings == planned.findings


@pytest.mark.parametrize("level", ["error", "warning"])
def test_a_plan_that_is_opened_without_all_holes_says_so_when_it_is_made_again(job, planned, level):
    """`error` is what reading a part says, `warning` what the app says of a plan that was downloaded too soon."""
    said = Finding(level, "unfinished", "only 2 of 3 holes")
    state = opened_plan(replace(planned, holes=planned.holes[:2], findings=(*planned.findings, said)))
    state = with_hole(state, replace(job.holes[2], id="more"))
    first, second = (each for each in plan_of(state).findings if each.kind == "unfinished")
    assert (first.level, first.message) == (level, "only 2 of 3 holes (of the plan that was opened)")
    assert second.message == "only 2 of 3 holes planned; missing: hole more"


def test_progress_says_how_fast_and_how_long_yet():
    assert Progress("x", 0, 4).rate is None
    assert Progress("x", 0, 4).seconds_left is None
    assert Progress("x", 1, 4, seconds=2.0).rate == 0.5
    assert Progress("x", 1, 4, seconds=2.0).seconds_left == 6.0
