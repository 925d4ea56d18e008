"""One page's state over time."""

from __future__ import annotations

from contextlib import contextmanager

from zerorev.web.session import Session
from zerorev.web.state import State


def test_views_are_told_of_changes_and_of_nothing_else():
    session, told = Session(State()), []
    session.watch(lambda before, after: told.append((before, after)))
    first, second = session.state, State(selected="a")
    session.change(first)
    session.change(second)
    assert told == [(first, second)]
    assert session.state is second
    session.unwatch()
    session.change(first)
    assert len(told) == 1


def test_a_view_that_was_let_go_meanwhile_hears_no_more():
    session, told = Session(State()), []
    session.watch(lambda before, after: session.unwatch())
    session.watch(lambda before, after: told.append(after))
    session.change(State(selected="a"))
    assert not told


def test_views_are_told_within_the_page():
    session, order = Session(State()), []

    @contextmanager
    def page():
        order.append("in")
        yield
        order.append("out")

    session.page = page
    session.watch(lambda before, after: order.append("told"))
    session.change(State(selected="a"))
    assert order == ["in", "told", "out"]


def test_two_sessions_share_nothing():
    one, other = Session(State()), Session(State())
    told = []
    other.watch(lambda before, after: told.append(after))
    one.change(State(selected="a"))
    assert other.state.selected is None
    assert not told
