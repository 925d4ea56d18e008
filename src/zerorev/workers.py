"""The same task on many things, on as many processes as wanted; the results in order, and the same for any number."""

from __future__ import annotations

import logging
import os
import signal
import sys
import threading
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from itertools import islice
from multiprocessing import connection, get_context, parent_process
from multiprocessing.reduction import ForkingPickler
from types import TracebackType
from typing import Any, Generic, TypeVar

from zerorev.errors import ZerorevError

__all__ = ["Workers", "interrupts_held_back"]

AHEAD = 8  # things that each worker may be ahead of the first that is not finished

Thing = TypeVar("Thing")
Result = TypeVar("Result")


class Workers(Generic[Thing, Result]):
    """Processes that do one task; used in a `with` statement, with which they end."""

    def __init__(self, task: Callable[[Thing], Result], count: int) -> None:
        """Begin; no process is started before it is needed.

        Args:
            task: what to do with each thing; goes to the workers as it is.
            count: of processes; 1: everything is done in this one.
        """
        self._task, self._count, self._begun = task, count, False
        self._pool: ProcessPoolExecutor | None = None

    def map(self, things: Iterable[Thing]) -> Iterator[Result]:
        """The results in the order of the things, each as soon as it and those before it are there.

        The very first is found in this process, so that kernels that are not in the cache are compiled once.

        Raises:
            ZerorevError: a worker ended before its time.
        """
        left = iter(things)
        here = None if self._count == 1 else int(not self._begun)
        for thing in islice(left, here):
            result = self._task(thing)
            self._begun = True
            yield result
        if here is None:
            return
        running: deque[Future[Result]] = deque()
        try:
            self._submit(running, left, self._count * AHEAD)
            while running:
                yield running.popleft().result()
                self._submit(running, left, 1)
        except BrokenProcessPool:
            raise ZerorevError("a worker process ended before its time (is there enough memory?)") from None

    def _submit(self, running: deque[Future[Result]], things: Iterator[Thing], count: int) -> None:
        for thing in islice(things, count):
            if self._pool is None:
                task = bytes(ForkingPickler.dumps(self._task))
                self._pool = ProcessPoolExecutor(self._count, get_context("spawn"), _begin, (task,))
            with interrupts_held_back():  # workers are started here, and know nothing of Ctrl-C from their first moment
                running.append(self._pool.submit(_done, thing))

    def __enter__(self) -> Workers[Thing, Result]:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        if self._pool is not None:
            self._pool.shutdown(cancel_futures=True)


_task: Callable[[Any], Any]  # of a worker


def _begin(task: bytes) -> None:
    """Make a worker ready; it ends with its parent, also where that is killed, from its first moment on.

    The task comes pickled, because what it is made of takes a second to import.
    """
    global _task
    threading.Thread(target=_end_with_parent, daemon=True).start()
    logging.getLogger("zerorev").addHandler(logging.NullHandler())
    _task = ForkingPickler.loads(task)


def _end_with_parent() -> None:
    parent = parent_process()
    assert parent is not None
    connection.wait([parent.sentinel])
    os._exit(1)


def _done(thing: Any) -> Any:
    return _task(thing)


@contextmanager
def interrupts_held_back() -> Iterator[None]:
    """Hold Ctrl-C back for a moment; a process started meanwhile never gets it.

    What is started inherits the mask. The mask alone would not hold: it is of this thread, and where another thread
    takes the signal, Python still interrupts the main one.
    """
    handler = signal.getsignal(signal.SIGINT)
    if sys.platform == "win32" or threading.current_thread() is not threading.main_thread() or not callable(handler):
        yield
        return
    came: list[int] = []
    signal.signal(signal.SIGINT, lambda number, _: came.append(number))
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
        signal.signal(signal.SIGINT, handler)
        if came:
            signal.raise_signal(signal.SIGINT)
