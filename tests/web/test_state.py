"""What a page shows: every change makes another value, and answers stay only where they still hold."""

from __future__ import annotations

from dataclasses import replace

import pytest

from zerorev.errors import InputError
from zerorev.files.io import plan_to_json
from zerorev.model.finding import Finding
from zerorev.model.job import Job, Settings
from zerorev.planning.hole import plan, plan_deepest
from zerorev.planning.job import plan_job
from zerorev.planning.sequence import with_moves
from zerorev.web.session import undone
from zerorev.web.state import (
    Progress,
    State,
    Steered,
    answered,
    opened_job,
    opened_plan,
    plan_of,
    selected,
    shown,
    steered,
    with_hole,
    with_holes,
    with_settings,
    without_hole,
)


@pytest.fixture(scope="module")
def job(robot, tool, positions):
    """The three published positions."""
    return Job(robot, tool, tuple(each.hole for each in positions))


@pytest.fixture(scope="module")
def planned(job):
    """Their plan."""
    return plan_job(job)


@pytest.fixture
def state(planned):
    """A page that shows it."""
    return opened_plan(planned)


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


def test_an_answer_takes_the_place_of_the_edited_motion_of_its_hole_alone(state, planned):
    edited = steered(state, Steered(shown(state).profile, 0))
    assert answered(edited, planned.holes[0]).steered is None
    assert answered(edited, planned.holes[1]).steered is edited.steered


def test_answers_of_what_was_edited_meanwhile_are_not_taken(job, planned):
    first = job.holes[0]
    for edited in (replace(first, depth=0.03), replace(first, target=first.target + 1e-6), replace(first, branch=2)):
        state = with_hole(opened_job(job), edited, first.id)
        assert not answered(state, planned.holes[0]).answers
    assert not answered(without_hole(opened_job(job), first.id), planned.holes[0]).answers
    assert not answered(State(), planned.holes[0]).answers


def test_a_motion_kept_by_hand_is_an_answer_on_any_branch(job):
    first = job.holes[0]
    by_hand = plan(job.robot, job.tool, replace(first, profile=shown_profile(job), branch=0))
    assert answered(opened_job(job), by_hand).answer is by_hand


def shown_profile(job):
    """The planned spins of the first hole."""
    return plan(job.robot, job.tool, job.holes[0]).motion.profile


def test_deepest_strokes_and_those_asked_for_do_not_mix(state, job):
    deepest = plan_deepest(job.robot, job.tool, job.holes[0])
    now = answered(state, deepest, strokes="deepest")
    assert list(now.answers) == [job.holes[0].id]
    assert plan_of(now).strokes == "deepest"
    assert now.hole is deepest.hole  # as deep as it goes, and the others as they were
    assert now.job.holes[1:] == job.holes[1:]


def test_editing_a_hole_drops_its_answer_alone(state, job):
    first, second, third = job.holes
    now = with_hole(state, replace(second, id="new", depth=0.01), second.id)
    assert [hole.id for hole in now.job.holes] == [first.id, "new", third.id]
    assert set(now.answers) == {first.id, third.id}
    assert now.selected == "new"
    assert len(state.job.holes) == len(state.answers) == 3  # the state before is as it was
    with pytest.raises(InputError, match="used twice"):
        with_hole(state, replace(second, id=first.id))
    with pytest.raises(InputError, match="nothing is opened"):
        with_hole(State(), first)
    with pytest.raises(InputError, match="used twice"):
        with_holes(state, [first])


def test_taking_holes_out(state, job):
    first, second, third = job.holes
    assert without_hole(state, first.id).selected == second.id
    assert without_hole(selected(state, third.id), third.id).selected == second.id
    assert without_hole(state, third.id).selected == first.id
    assert without_hole(state, "x") is state
    last = without_hole(without_hole(state, first.id), second.id)
    with pytest.raises(InputError, match="the last hole"):
        without_hole(last, third.id)


def test_other_settings_drop_all_answers(state):
    assert with_settings(state, state.job.settings) is state
    now = with_settings(state, Settings(min_rate=0.0))
    assert not now.answers
    assert now.job.settings.min_rate == 0.0


def test_taking_an_edit_back_keeps_what_was_found_since_and_holds(job, planned, state):
    before = opened_job(job)
    edited = with_hole(before, replace(job.holes[0], depth=0.03), job.holes[0].id)
    since = answered(edited, planned.holes[1])
    since = replace(since, progress=Progress("planning", 1, 2))
    back = undone(since, before)
    assert back.job is job
    assert list(back.answers) == [job.holes[1].id]
    assert back.progress is since.progress  # work goes on
    assert not undone(with_settings(state, Settings(min_rate=0.0)), before).answers


def test_a_motion_kept_by_hand_is_given_back_by_an_undo_and_by_a_redo(planned):
    """What planning finds meanwhile takes its place no more than it takes the place of the plan."""
    before = opened_plan(planned)
    answer = planned.holes[0]
    by_hand = replace(answer, hole=replace(answer.hole, profile=answer.motion.profile, branch=answer.motion.branch))
    kept = answered(before, by_hand)
    assert undone(kept, before).answers[answer.hole.id] is answer
    assert undone(before, kept).answers[answer.hole.id] is by_hand
    again = replace(answer)  # as after another plan of the same
    assert undone(answered(before, again), before).answers[answer.hole.id] is again


def test_a_plan_of_some_holes_says_which_are_missing(job, planned):
    state = answered(opened_job(job), planned.holes[1])
    assert state.unplanned == (job.holes[0].id, job.holes[2].id)
    (found,) = [finding for finding in plan_of(state).findings if finding.kind == "unfinished"]
    assert (found.level, found.hole) == ("warning", None)
    assert found.message == f"only 1 of 3 holes planned; missing: holes {job.holes[0].id}, {job.holes[2].id}"
    assert plan_of(opened_plan(planned)).findings == planned.findings


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
