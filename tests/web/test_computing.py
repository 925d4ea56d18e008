"""Long work of a page: results come as they are found, one task at a time, and a cancelled one leaves the page free."""

from __future__ import annotations

import asyncio
import re
import threading
import time
from dataclasses import replace

import numpy as np
import pytest

from zerorev.errors import InputError
from zerorev.files.io import plan_to_json
from zerorev.model.job import Job, Settings
from zerorev.planning.hole import plan, plan_deepest
from zerorev.planning.job import plan_job
from zerorev.planning.sequence import with_moves
from zerorev.report.words.answer import sequence_line
from zerorev.web import computing
from zerorev.web.computing import Work
from zerorev.web.job_edits import with_hole, with_settings, without_hole
from zerorev.web.session import Session
from zerorev.web.state import Progress, State, Steered, opened_job, plan_of, selected, shown, steered

PATIENCE = 60.0  # [s]


@pytest.fixture
def job(robot, tool, positions):
    """The three published positions, of which none is planned."""
    return Job(robot, tool, tuple(each.hole for each in positions))


async def until(condition) -> None:
    """Wait until something has come about."""
    deadline = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < deadline, "it has not come about"
        await asyncio.sleep(0.01)


def test_plans_the_selected_hole_as_the_library_does(job):
    async def run():
        work = Work(Session(opened_job(job)))
        computing.plan_selected(work)
        progress = work.session.state.progress
        assert progress == Progress(f"planning hole {job.holes[0].id}", 0, 1)
        await until(lambda: not work.busy)
        return work.session.state

    state = asyncio.run(run())
    expected = plan(job.robot, job.tool, job.holes[0])
    assert list(state.answers) == [job.holes[0].id]
    np.testing.assert_array_equal(state.answer.motion.profile.psi, expected.motion.profile.psi)
    assert state.answer.verified.passed
    assert state.progress is None
    assert state.trouble is None


def test_all_holes_are_planned_as_the_sequence_that_the_library_plans(job):
    async def run():
        work = Work(Session(opened_job(job)))
        computing.plan(work, job.holes)
        await until(lambda: not work.busy)
        return work.session.state

    state = asyncio.run(run())
    expected = plan_job(job)
    assert state.trouble is None
    assert len({answer.motion.branch for answer in expected.holes}) == 1
    assert plan_to_json(with_moves(plan_of(state))) == plan_to_json(expected)
    assert state.transitions == state.moves.transitions
    assert [(move.start, move.to) for move in state.transitions] == [
        (move.start, move.to) for move in expected.transitions
    ]
    line, moves, *_ = state.outcome.splitlines()
    assert "planned" in line
    assert moves == sequence_line(expected.transitions)
    assert without_hole(state, job.holes[0].id).transitions == ()


def test_deepest_of_all_holes(job):
    async def run():
        work = Work(Session(opened_job(job)))
        computing.plan(work, job.holes, "deepest")
        await until(lambda: not work.busy)
        return work.session.state

    state = asyncio.run(run())
    assert state.strokes == "deepest"
    for hole in job.holes:
        assert state.answers[hole.id].hole.depth == plan_deepest(job.robot, job.tool, hole).hole.depth


def test_all_holes_say_at_the_end_what_they_came_to(job):
    asked = replace(job, holes=(job.holes[1], replace(job.holes[0], id="far", target=np.array([9.0, 0.0, 0.5]))))

    async def run():
        work = Work(Session(opened_job(asked)))
        computing.plan(work, asked.holes)
        await until(lambda: not work.busy)
        said = work.session.state.outcome
        computing.plan(work, asked.holes[:1])
        assert work.session.state.outcome is None  # it was of the work before
        await until(lambda: not work.busy)
        return said, work.session.state

    said, state = asyncio.run(run())
    assert re.fullmatch(r"2 holes planned in \d+ s: 1 without a reversal, 1 without a motion\.", said)
    assert state.outcome is None  # of one hole, its own line says it all


def test_keeps_and_certifies_an_edited_motion(job):
    async def run():
        work = Work(Session(opened_job(job)))
        computing.plan_selected(work)
        await until(lambda: not work.busy)
        planned = shown(work.session.state)
        by_hand = Steered(
            replace(planned.profile, psi=planned.profile.psi + np.array([0.02, 0.0, -0.02])), planned.branch
        )
        work.session.change(steered(work.session.state, by_hand))
        computing.keep(work)
        await until(lambda: not work.busy)
        kept = work.session.state
        computing.certify(work, job.holes)  # only one of them has a motion
        assert work.session.state.progress.total == 1
        await until(lambda: not work.busy)
        return by_hand, kept, work.session.state

    by_hand, kept, proven = asyncio.run(run())
    assert kept.steered is None
    assert kept.answer.status == "evaluated"
    np.testing.assert_array_equal(kept.answer.motion.profile.psi, by_hand.profile.psi)
    assert kept.answer.verified.passed
    assert kept.answer.certificate is None
    assert proven.answer.certificate.verdict == "certified"
    assert replace(proven.answer, certificate=None) == kept.answer


class Slow:
    """Finds numbers, one each time it is let."""

    def __init__(self, count: int) -> None:
        self.count, self.let, self.closed, self.given = count, threading.Semaphore(0), False, 0

    def __call__(self):
        try:
            for n in range(self.count):
                assert self.let.acquire(timeout=PATIENCE)
                self.given += 1
                yield n
        finally:
            self.closed = True


def collected(state: State, found) -> State:
    """What was found goes into the trouble, for want of another place."""
    return replace(state, selected=(state.selected or "") + "".join(map(str, found)))


def test_one_task_at_a_time_and_results_as_they_come():
    async def run():
        work, slow = Work(Session(State())), Slow(3)
        assert work.start("counting", 3, slow, collected, each="number")
        assert not work.start("another", 1, slow, collected)
        slow.let.release()
        await until(lambda: work.session.state.selected == "0")
        progress = work.session.state.progress
        assert (progress.title, progress.done, progress.total, progress.each) == ("counting", 1, 3, "number")
        assert progress.rate > 0
        assert progress.seconds_left == pytest.approx(2 / progress.rate)
        slow.let.release(2)
        await until(lambda: not work.busy)
        assert work.session.state == State(selected="012")

    asyncio.run(run())


def test_cancel_frees_the_page_at_once_and_drops_what_is_found_later():
    async def run():
        work, slow, next_ = Work(Session(State())), Slow(3), Slow(1)
        work.start("counting", 3, slow, collected)
        slow.let.release()
        await until(lambda: work.session.state.selected == "0")
        work.cancel()
        assert work.session.state == State(selected="0")
        assert work.start("the next", 1, next_, collected)  # while the first still waits
        slow.let.release()
        await until(lambda: slow.closed)
        assert slow.given == 2
        next_.let.release()
        await until(lambda: not work.busy)
        assert work.session.state == State(selected="00")

    asyncio.run(run())


def test_a_state_without_progress_stops_the_task(job):
    async def run():
        work, slow = Work(Session(State())), Slow(3)
        work.start("counting", 3, slow, collected)
        work.session.change(opened_job(job))  # as when another file is opened
        assert not work.busy
        slow.let.release(3)
        await until(lambda: slow.closed)
        await asyncio.sleep(2 * computing.PAUSE)
        assert work.session.state == opened_job(job)
        computing.plan_selected(work)
        await until(lambda: not work.busy)
        assert work.session.state.answer is not None

    asyncio.run(run())


def test_many_results_change_the_page_five_times_a_second_at_most():
    async def run():
        session = Session(State())
        changes = []
        session.watch(lambda before, after: changes.append(time.monotonic()))
        work = Work(session)

        def run():
            for n in range(200):
                time.sleep(0.005)
                yield n

        work.start("counting", 200, run, lambda state, found: replace(state, selected=str(found[-1])))
        await until(lambda: not work.busy)
        assert session.state.selected == "199"
        # the first, one each pause, and the last, at any speed of the machine
        assert len(changes) <= 4 + (changes[-1] - changes[0]) / computing.PAUSE

    asyncio.run(run())


@pytest.mark.parametrize("fault", [InputError("out of range", where="depth", accepted="above 0"), ZeroDivisionError()])
def test_what_goes_wrong_is_one_message(fault, caplog):
    async def run():
        work = Work(Session(State()))

        def run():
            yield 1
            raise fault

        work.start("dividing", 2, run, collected)
        await until(lambda: not work.busy)
        return work.session.state

    state = asyncio.run(run())
    assert state.selected == "1"
    assert state.progress is None
    if isinstance(fault, InputError):
        assert state.trouble == str(fault)
        assert not caplog.records
    else:
        assert "a fault in zerorev itself (ZeroDivisionError" in state.trouble
        assert "ZeroDivisionError" in caplog.text


def test_answers_of_what_has_changed_meanwhile_are_not_taken(job, monkeypatch):
    slow = Slow(3)

    def answers(asked, **_):
        for n in slow():
            yield plan(asked.robot, asked.tool, asked.holes[n])

    monkeypatch.setattr(computing, "answers", answers)
    first, second, _ = job.holes

    async def run():
        work = Work(Session(opened_job(job)))
        computing.plan(work, job.holes)
        edited = replace(second, branch=2)
        work.session.change(with_hole(work.session.state, edited, second.id))
        slow.let.release(2)
        await until(lambda: work.session.state.answers)
        assert list(work.session.state.answers) == [first.id]
        work.session.change(with_settings(work.session.state, Settings(min_rate=0.0)))
        slow.let.release()
        await until(lambda: not work.busy)
        assert not work.session.state.answers

    asyncio.run(run())


def test_looking_at_another_hole_takes_the_place_of_planning_one(job):
    async def run():
        work = Work(Session(opened_job(job)))
        computing.plan_selected(work)
        work.session.change(selected(work.session.state, job.holes[1].id))
        computing.plan_selected(work)
        assert work.session.state.progress.title == f"planning hole {job.holes[1].id}"
        await until(lambda: not work.busy)
        assert list(work.session.state.answers) == [job.holes[1].id]

    asyncio.run(run())


def test_a_view_that_fails_does_not_stop_the_work(caplog):
    async def run():
        session = Session(State())
        work = Work(session)

        def run():
            yield 1
            yield 2

        work.start("counting", 2, run, collected)
        session.watch(lambda before, after: 1 / 0)
        await until(lambda: not work.busy)
        return session.state

    assert asyncio.run(run()).selected == "12"
    assert "a fault in the page" in caplog.text


def test_the_end_waits_for_a_task_that_notices():
    async def run():
        work, slow = Work(Session(State())), Slow(2)
        work.start("counting", 2, slow, collected)
        threading.Timer(0.05, slow.let.release).start()
        work.end()
        assert slow.closed

    asyncio.run(run())
