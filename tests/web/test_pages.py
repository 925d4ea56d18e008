"""What is kept of the browsers' tabs: many small ones, few large ones, and none that is in use is lost."""

from __future__ import annotations

from dataclasses import replace

import pytest

pytest.importorskip("nicegui")

from oracles.published import POSITIONS
from zerorev.model.job import Job
from zerorev.web import pages as kept
from zerorev.web.computing import Work
from zerorev.web.pages import Pages
from zerorev.web.session import Session
from zerorev.web.state import State, opened_job


class Client:
    """A page that is connected."""


@pytest.fixture
def pages():
    return Pages(State())


@pytest.fixture
def job(robot, tool):
    """Makes jobs of so many holes."""

    def made(count):
        return Job(robot, tool, tuple(replace(POSITIONS[0].hole, id=f"H{n}") for n in range(count)))

    return made


def visit(pages, tab, state=None):
    """A tab is opened."""
    session = Session(State() if state is None else state)
    pages._pages[tab] = kept._Page(session, Work(session), Client())


def leave(pages, tab):
    pages._gone(tab, pages._pages[tab].client)


def test_fifty_small_ones(pages, job):
    for number in range(kept.MOST_PAGES + 5):
        visit(pages, f"tab {number}", opened_job(job(1)))
        leave(pages, f"tab {number}")
    assert list(pages._pages) == [f"tab {number}" for number in range(5, kept.MOST_PAGES + 5)]


def test_of_large_ones_the_last_that_were_left(pages, job, monkeypatch):
    monkeypatch.setattr(kept, "MOST_HOLES", 50)
    for name in "abcd":
        visit(pages, name, opened_job(job(20)))
    visit(pages, "in use", opened_job(job(1000)))
    for name in "bacd":
        leave(pages, name)
    assert list(pages._pages) == ["in use", "c", "d"]
    visit(pages, "huge", opened_job(job(1000)))
    leave(pages, "huge")
    assert list(pages._pages) == ["in use", "huge"]


def test_tabs_of_one_job_count_once(pages, job, monkeypatch):
    monkeypatch.setattr(kept, "MOST_HOLES", 50)
    state = opened_job(job(40))
    for name in "abcd":
        visit(pages, name, state)
        leave(pages, name)
    assert list(pages._pages) == list("abcd")


def test_a_page_that_was_reloaded_is_not_left(pages, job):
    visit(pages, "a")
    old = pages._pages["a"].client
    pages._pages["a"].client = new = Client()
    pages._gone("a", old)
    assert pages._pages["a"].client is new
