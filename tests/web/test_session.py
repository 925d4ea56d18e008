"""One page's state over time."""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import replace

import pytest

from zerorev.model.job import Job
from zerorev.model.profile import Profile
from zerorev.web.job_edits import with_hole, without_hole
from zerorev.web.session import Session
from zerorev.web.state import State, Steered, opened_job, selected, steered


def test_views_are_called_on_changes_and_on_nothing_else():
    session, reported = Session(State()), []
    session.watch(lambda before, after: reported.append((before, after)))
    first, second = session.state, State(selected="a")
    session.change(first)
    session.change(second)
    assert reported == [(first, second)]
    assert session.state is second
    session.unwatch()
    session.change(first)
    assert len(reported) == 1


def test_a_view_that_was_let_go_meanwhile_hears_no_more():
    session, reported = Session(State()), []
    session.watch(lambda before, after: session.unwatch())
    session.watch(lambda before, after: reported.append(after))
    session.change(State(selected="a"))
    assert not reported


def test_views_are_called_within_the_page():
    session, order = Session(State()), []

    @contextmanager
    def page():
        order.append("in")
        yield
        order.append("out")

    session.page = page
    session.watch(lambda before, after: order.append("called"))
    session.change(State(selected="a"))
    assert order == ["in", "called", "out"]


def test_two_sessions_share_nothing():
    one, other = Session(State()), Session(State())
    reported = []
    other.watch(lambda before, after: reported.append(after))
    one.change(State(selected="a"))
    assert other.state.selected is None
    assert not reported


@pytest.fixture
def session(robot, tool, positions):
    """Of the three published positions."""
    return Session(opened_job(Job(robot, tool, tuple(each.hole for each in positions))))


def motion(spin: float) -> Steered:
    return Steered(Profile.straight(0.05, spin, 0.0, 0.0), 4)


def test_edits_and_drags_are_one_history_there_and_back(session):
    first = session.state
    session.change(without_hole(first, first.job.holes[2].id))
    edited, drag = session.state, object()
    for spin in (0.1, 0.2, 0.3):  # a drag is sent in pieces
        session.change(steered(session.state, motion(spin)), of=drag)
    dragged = session.state
    session.change(steered(session.state, motion(0.4)), of=object())
    session.undo()
    assert session.state.steered is dragged.steered
    session.undo()
    assert (session.state.job, session.state.steered) == (edited.job, None)
    session.undo()
    assert session.state.job is first.job
    assert not session.can_undo
    session.undo()
    assert session.state.job is first.job
    for _ in range(3):
        assert session.can_redo
        session.redo()
    assert not session.can_redo
    assert session.state.job is edited.job
    assert session.state.steered.profile.psi[0] == 0.4
    session.undo()
    session.change(with_hole(session.state, first.job.holes[2]))
    assert not session.can_redo  # another way was taken


def test_a_motion_that_was_let_go_by_looking_elsewhere_comes_back(session):
    session.change(steered(session.state, motion(0.1)))
    session.change(selected(session.state, session.state.job.holes[1].id))
    assert session.state.steered is None
    session.undo()
    assert session.state.selected == session.state.job.holes[0].id
    assert session.state.steered.profile.psi[0] == 0.1


def test_looking_at_holes_is_not_a_step(session):
    session.change(selected(session.state, session.state.job.holes[1].id))
    assert not session.can_undo


def test_a_drag_that_is_dropped_leaves_no_step(session):
    drag = object()
    session.change(steered(session.state, motion(0.1)))
    kept = session.state.steered
    session.change(steered(session.state, motion(0.2)), of=drag)
    session.drop(object())
    session.drop(None)
    assert session.state.steered is not kept
    session.drop(drag)
    assert session.state.steered is kept
    session.undo()
    assert session.state.steered is None
    assert not session.can_undo


def test_of_the_files_opened_before_the_last_one_is_kept(robot, tool, positions):
    """Each may be large; the way back within one file is as long as ever."""
    session = Session(State())
    files = [opened_job(Job(replace(robot, name=f"r{n}"), tool, (positions[0].hole,))) for n in range(4)]
    for file in files:
        session.change(file)
        session.change(with_hole(session.state, replace(positions[0].hole, id="more")))
    session.undo()
    assert session.state.job is files[3].job
    session.undo()
    assert session.state.job.robot is files[2].job.robot
    assert not session.can_undo
    session.redo()
    assert session.state.job is files[3].job
