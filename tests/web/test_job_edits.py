"""How the job of a page changes: answers stay only where they still hold."""

from __future__ import annotations

from dataclasses import replace

import pytest

from zerorev.errors import InputError
from zerorev.model.job import Settings
from zerorev.planning.hole import plan, plan_deepest
from zerorev.web.job_edits import answered, with_hole, with_holes, with_settings, without_hole
from zerorev.web.session import undone
from zerorev.web.state import Progress, State, Steered, opened_job, opened_plan, plan_of, selected, shown, steered


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
