"""Long work of a page: in a thread, one task at a time, with progress, and free again at once when it is cancelled."""

from __future__ import annotations

import asyncio
import logging
import signal
import sys
import threading
import time
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from contextlib import closing, suppress
from dataclasses import replace
from typing import Any

from zerorev.errors import ZerorevError
from zerorev.files.plan_conversion import as_written
from zerorev.model.hole import Hole
from zerorev.model.plan import HolePlan, Plan, Strokes
from zerorev.planning.job import answers
from zerorev.planning.sequence import Sequenced, sequenced
from zerorev.planning.tried_otherwise import TriedOtherwise
from zerorev.report.words.answer import sequence_line
from zerorev.report.words.outcome import outcome
from zerorev.web.job_edits import answered
from zerorev.web.session import Session
from zerorev.web.state import Moves, Progress, State
from zerorev.workers import Machines

__all__ = ["Take", "Work", "certify", "keep", "plan", "plan_selected"]

# what the page shows once it has these results, too; None: nobody asks for them any more
Take = Callable[[State, Sequence[Any]], State | None]
# what is said of all of it at the end: of the state then, and how long it took [s]
Said = Callable[[State, float], str]

PAUSE = 0.2  # [s] between two changes of the page: results come in batches
CLOSING = 2.0  # [s] that a task is given to end by itself when the app ends


class _Task:
    """A task in its thread; what it finds waits here to be taken."""

    def __init__(self, work: Callable[[], Iterable[Any]], report: Callable[[], None]) -> None:
        self.found: deque[Any] = deque()
        self.cancelled = self.ended = False
        self.trouble: str | None = None
        self._work, self._report = work, report
        self.thread = threading.Thread(target=self._run, name="zerorev-work", daemon=True)
        self.thread.start()

    def _run(self) -> None:
        if sys.platform != "win32":  # worker processes are started here, and are not to hear of Ctrl-C
            signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        try:
            with closing(_generated(self._work())) as results:
                for result in results:
                    if self.cancelled:
                        break
                    self.found.append(result)
                    self._report()
        except ZerorevError as error:
            self.trouble = str(error)
        except Exception as error:
            logging.getLogger("zerorev").exception("a fault in zerorev itself; please report the lines below")
            self.trouble = f"a fault in zerorev itself ({type(error).__name__}: {error}); the terminal says more"
        self.ended = True
        self._report()


def _generated(results: Iterable[Any]) -> Generator[Any, None, None]:
    """The same as a generator, which can be closed."""
    yield from results


class Work:
    """The long work of one session: one task at a time; what it finds goes to the session as it comes.

    A task lasts as long as the session's state shows its progress: whoever shows a state without, as a job that is
    opened again, has stopped it.

    Attributes:
        session: whose.
    """

    def __init__(self, session: Session) -> None:
        """Begin with nothing to do."""
        self.session = session
        self._task: _Task | None = None
        self._tasks: set[_Task] = set()  # with those that were cancelled and have not noticed yet

    @property
    def busy(self) -> bool:
        """Whether a task is under way."""
        return self._task is not None and self.session.state.progress is not None

    def start(
        self,
        title: str,
        total: int,
        run: Callable[[], Iterable[Any]],
        take: Take,
        *,
        each: str = "hole",
        said: Said | None = None,
        gives_way: bool = False,
    ) -> bool:
        """Begin a task, to be called in the event loop; while another is under way, nothing is begun.

        Args:
            title: what is done, as the page says it.
            total: how many results are awaited.
            run: finds them one after the other, in a thread of its own.
            take: called in the event loop with the newest results, five times a second at most.
            each: what a result is of.
            said: what the page says when all of it is done; None: nothing.
            gives_way: whether it is stopped where another hole is selected that has to be planned.

        Returns:
            whether it has begun.
        """
        if self.busy:
            return False
        self._let_go()
        loop, news = asyncio.get_running_loop(), asyncio.Event()

        def report() -> None:
            with suppress(RuntimeError):  # the loop is closed: the app has ended
                loop.call_soon_threadsafe(news.set)

        begun = Progress(title, 0, total, each, gives_way=gives_way)
        self.session.change(replace(self.session.state, progress=begun, trouble=None, outcome=None))
        self._task = task = _Task(run, report)
        self._tasks.add(task)
        self._following = loop.create_task(self._follow(task, news, begun, take, said))
        return True

    def cancel(self) -> None:
        """Stop the task that is under way; what it has found so far stays, and what it still finds is dropped."""
        self._let_go()
        self.session.change(replace(self.session.state, progress=None))

    def end(self) -> None:
        """Stop everything, as the app ends; no process that was started is left."""
        self._let_go()
        deadline = time.monotonic() + CLOSING
        for task in self._tasks:
            task.cancelled = True
            task.thread.join(max(0.0, deadline - time.monotonic()))

    def _let_go(self) -> None:
        if self._task is not None:
            self._task.cancelled, self._task = True, None

    async def _follow(self, task: _Task, news: asyncio.Event, begun: Progress, take: Take, said: Said | None) -> None:
        """Hand on what the task finds, until it has ended."""
        start, done, ended = time.monotonic(), 0, False
        while not ended:
            await news.wait()
            news.clear()
            ended = task.ended  # examined before its results, so that none is missed
            found = [task.found.popleft() for _ in range(len(task.found))]
            if task is self._task and self.busy:
                done += len(found)
                now = replace(begun, done=done, seconds=time.monotonic() - start)
                self._hand_on(task, found, now, take, said=said, ended=ended)
            if not ended:
                await asyncio.sleep(PAUSE)
        self._tasks.discard(task)

    def _hand_on(
        self, task: _Task, found: Sequence[Any], progress: Progress, take: Take, *, said: Said | None, ended: bool
    ) -> None:
        state, trouble, words = self.session.state, task.trouble, None
        try:
            taken = take(state, found) if found else state
        except ZerorevError as error:
            taken, trouble = state, str(error)
        if ended and said is not None and taken is not None and trouble is None:
            words = said(taken, progress.seconds)
        going = taken is not None and not ended
        if not going:
            self._let_go()
        now = replace(taken or state, progress=progress if going else None, trouble=trouble, outcome=words)
        try:
            self.session.change(now, of=task)
        except Exception:  # of a view; the work goes on
            logging.getLogger("zerorev").exception("a fault in the page")


# --- what a page asks for ---------------------------------------------------------------------------------------------


def plan_selected(work: Work) -> None:
    """Plan the selected hole, instead of another single hole that is under way, and of what gives way."""
    progress = work.session.state.progress
    if progress is not None and (progress.total == 1 or progress.gives_way):
        work.cancel()
    hole = work.session.state.hole
    plan(work, () if hole is None else (hole,))


def plan(work: Work, holes: Sequence[Hole], strokes: Strokes = "asked") -> None:
    """Plan holes of the job: fewest reversals, then what the settings ask for; or each as deep as it goes.

    Where all holes have their answers then, they are planned as a sequence.

    Args:
        work: of the page.
        holes: of its job; none: the sequence alone.
        strokes: those `asked` for or the `deepest` without a reversal.
    """
    state = work.session.state
    job, before = state.job, dict(state.answers) if strokes == state.strokes else {}
    if job is None:
        return
    what, done = ("planning", "planned") if strokes == "asked" else ("finding the deepest stroke of", "made deepest")
    ids = [hole.id for hole in holes]
    helps = list[str]()

    def run() -> Iterator[HolePlan | Sequenced]:
        found = before
        if holes:
            asked = replace(job, holes=tuple(holes))
            tried = TriedOtherwise(asked)
            for answer in answers(asked, strokes=strokes, machines=Machines()):
                tried.add(answer)
                yield answer
                found[answer.hole.id] = answer
            if len(holes) > 1:
                helps.extend(finding.message for finding in tried.findings())
        if len(job.holes) > 1 and all(hole.id in found for hole in job.holes):
            written = [as_written(found[hole.id]) for hole in job.holes]
            yield sequenced(job, lambda: written, choose=strokes == "asked", machines=Machines())

    _answer(work, what, done, ids, strokes, run, helps)


def keep(work: Work) -> None:
    """Take the edited motion for the selected hole's answer: evaluated and checked as a planned one is."""
    state = work.session.state
    if state.job is None or state.hole is None or state.steered is None:
        return
    given = replace(state.hole, profile=state.steered.profile, branch=state.steered.branch)
    asked = replace(state.job, holes=(given,))
    _answer(work, "checking", "checked", [given.id], state.strokes, lambda: answers(asked))


def certify(work: Work, holes: Sequence[Hole]) -> None:
    """Prove the planned motions of holes on the continuous motion, not on samples of it."""
    state, job = work.session.state, work.session.state.job
    plans = [state.answers[hole.id] for hole in holes if hole.id in state.answers]
    plans = [answer for answer in plans if answer.motion is not None and answer.certificate is None]
    if job is None or not plans:
        return

    def proven() -> Iterator[HolePlan]:
        from zerorev.verify.certificate.certify import certify_plan

        for answer in plans:
            yield from certify_plan(Plan(job.robot, job.tool, job.settings, (answer,))).holes

    _answer(work, "proving", "proven", [answer.hole.id for answer in plans], state.strokes, proven)


def _answer(
    work: Work,
    what: str,
    done: str,
    ids: Sequence[str],
    strokes: Strokes,
    run: Callable[[], Iterable[HolePlan | Sequenced]],
    helps: Sequence[str] = (),
) -> None:
    """Find answers of holes of the job; each is taken if the page still asks for the same.

    A sequence of all holes is taken if they are all the same still. When all are there, what then stands in `helps` is
    said, too.
    """
    job = work.session.state.job
    assert job is not None
    asked = {hole.id: hole for hole in job.holes}

    def take(state: State, results: Sequence[HolePlan | Sequenced]) -> State | None:
        now = state.job
        if now is None or now.robot is not job.robot or now.tool is not job.tool or now.settings != job.settings:
            return None
        same = {hole.id for hole in now.holes if hole is asked.get(hole.id)}
        found = [each for each in results if isinstance(each, HolePlan)]
        sequences = [each for each in results if isinstance(each, Sequenced) and len(same) == len(asked)]
        found += [answer for each in sequences for answer in each.changed.values()]
        state = answered(state, *(answer for answer in found if answer.hole.id in same), strokes=strokes)
        for each in sequences:
            state = replace(state, order=each.order, moves=Moves(each.transitions, state.answers))
        return state

    def said(state: State, seconds: float) -> str:
        found = (state.answers[key] for key in ids if key in state.answers)
        said = [outcome(done, found, seconds, proven=done == "proven")]
        if state.transitions:
            said.append(sequence_line(state.transitions))
            said += [each.message for move in state.transitions for each in move.findings if each.level == "error"]
        return "\n".join((*said, *helps))

    which = f"hole {ids[0]}" if len(ids) == 1 else f"{len(ids)} holes" if ids else "the sequence"
    work.start(f"{what} {which}", max(len(ids), 1), run, take, said=said if len(ids) > 1 else None)
