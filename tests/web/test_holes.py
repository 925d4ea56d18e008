"""The table of the holes without a browser: what is sent to the grid on a change, and no more than that."""

from __future__ import annotations

import asyncio
from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("nicegui")

from nicegui import Client
from nicegui.page import page as page_of

from oracles.published import POSITIONS
from zerorev.model.finding import Finding
from zerorev.model.hole import Hole
from zerorev.model.job import Job, Settings
from zerorev.model.plan import HolePlan, LostMotion
from zerorev.report.words.hole_rows import matching
from zerorev.web.job_edits import answered, with_hole, without_hole
from zerorev.web.session import Session
from zerorev.web.state import opened_job, selected
from zerorev.web.views import holes as view


@pytest.fixture
def session(robot, tool):
    holes = tuple(replace(POSITIONS[0].hole, id=f"H{n}") for n in range(4))
    return Session(opened_job(Job(robot, tool, holes, Settings())))


@pytest.fixture
def reported(session, monkeypatch):
    """Run edits with the table on a page; what was sent to its grid."""

    def run(*edits):
        calls = []
        monkeypatch.setattr(Client, "run_javascript", lambda *_, **__: None)

        async def main():
            with Client(page_of("/")):
                table = view._Table(session)
                table.draw()
                monkeypatch.setattr(table._grid, "run_grid_method", lambda *call: calls.append(call))
                for edit in edits:
                    edit(table)
                await asyncio.sleep(0.05)

        asyncio.run(main())
        return calls

    return run


def lost(hole):
    return HolePlan(hole, "infeasible", 0.1, findings=(Finding("error", "limit", "why <b>", hole.id),))


def test_an_answer_updates_its_own_row_alone(session, reported):
    hole = session.state.job.holes[2]
    ((name, change), *_) = reported(lambda _: session.change(answered(session.state, lost(hole))))
    assert name == "applyTransaction"
    assert (change["add"], change["remove"]) == ([], [])
    assert [(row["id"], row["standing"], row["findings"]) for row in change["update"]] == [("H2", "infeasible", 1)]


def test_looking_at_another_hole_changes_no_row(session, reported):
    assert not reported(lambda _: session.change(selected(session.state, "H3")))


def test_a_hole_that_is_added_or_taken_out_is_all_that_is_sent(session, reported):
    new = Hole("N", np.array([0.5, 0.1, 0.7]), np.array([1.0, 0, 0]), 0.03)
    calls = reported(
        lambda _: session.change(with_hole(session.state, new)),
        lambda _: session.change(without_hole(session.state, "H1")),
    )
    added, removed = (change for name, change in calls if name == "applyTransaction")
    assert [row["id"] for row in added["add"]] == ["N"]
    assert not added["update"]
    assert removed["remove"] == [{"id": "H1"}]


def test_an_undo_puts_the_row_back_where_it_was(session, reported):
    calls = reported(lambda _: session.change(without_hole(session.state, "H1")), lambda _: session.undo())
    _, what, rows = next(call for call in calls if call[0] == "setGridOption")
    assert what == "rowData"
    assert [row["id"] for row in rows] == ["H0", "H1", "H2", "H3"]


def test_the_filter_lets_through_what_matches_and_says_how_many(session, reported):
    words = []

    def look(table):
        table.show_count = words.append
        table.filter(matching("h1"))
        table.filter(matching("h1"))
        table.filter(None)

    calls = reported(look)
    passes = [call[1][":doesExternalFilterPass"] for call in calls if call[0] == "updateGridOptions"]
    assert len(passes) == 2
    assert '["H1"]' in passes[0]
    assert passes[1] == "() => true"
    assert words == ["1 of 4", "1 of 4", "4 holes"]


def test_findings_of_other_holes_are_counted(session):
    hole, other, *_ = session.state.job.holes
    planned = HolePlan(hole, "planned", 0.1)
    state = answered(session.state, planned, lost(other))
    rows = view._rows(state, {}, None)
    assert "no findings for this hole" in view._words(hole, planned)
    assert "1 other hole has warnings or errors" in view._others(rows, hole.id)
    assert view._others(rows, other.id) == ""
    rows = view._rows(answered(state, lost(session.state.job.holes[2])), {}, None)
    assert "2 other holes have" in view._others(rows, hole.id)
    assert "1 other hole has" in view._others(rows, other.id)


def test_the_lost_motion_is_there_with_what_it_rests_on(session):
    hole = session.state.hole
    answer = HolePlan(hole, "evaluated", 0.1)
    assert "lost motion" not in view._words(hole, answer).lower()
    said = view._words(hole, replace(answer, lost_motion=LostMotion(0.0000674, 0.0001523)))
    assert "Lost motion at the tip: 0.067 mm, with the legs swapped 0.152 mm." in said
    assert "are guesses" in said
    assert "must let the tool turn" in said


def test_findings_are_shown_as_text_and_never_as_markup(session):
    hole = session.state.job.holes[0]
    words = view._words(hole, lost(hole))
    assert "why &lt;b&gt;" in words
    assert "✕" in words
