"""The same task on many things, here or on a cluster; the results in order, and the same wherever they are found.

`Machines` says where: processes of this machine, or the workers of a `dask.distributed` scheduler. `Workers` does the
work there.
"""

from __future__ import annotations

import gc
import logging
import os
import signal
import sys
import threading
import time
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import dataclass
from importlib.metadata import version
from multiprocessing import connection, get_context, parent_process
from multiprocessing.reduction import ForkingPickler
from types import TracebackType
from typing import Any, Generic, Protocol, TypeVar

from zerorev.errors import InputError, ZerorevError

__all__ = ["HERE", "Machines", "Workers", "interrupts_held_back"]

BEGINNING = 0.5  # [s] of work in this process, after which it is known how long the rest takes
WORTH_WORKERS = 4.0  # [s] of work left below which starting processes takes longer than they save
AHEAD = 8  # things that each process may be ahead of the first that is not finished
CLUSTER_AHEAD, LEAST_AHEAD = 4, 16  # the same for each thread of a cluster, and for all of it at least
PATIENCE = 10.0  # [s] for a scheduler to answer
WAIT_FOR_WORKERS = 60.0  # [s] for its first worker
RETRIES = 3

Thing = TypeVar("Thing")
Result = TypeVar("Result")


@dataclass(frozen=True)
class Machines:
    """Where work is done.

    Attributes:
        processes: of this machine; None: one per core, as soon as the work is found to be long enough.
        scheduler: address of a `dask.distributed` scheduler whose workers do it instead, e.g. tcp://10.0.0.1:8786.

    Raises:
        InputError: fewer than one process, or both are given.
    """

    processes: int | None = None
    scheduler: str | None = None

    def __post_init__(self) -> None:
        """Check that one of them is given at most."""
        if self.processes is not None and self.processes < 1:
            raise InputError(f"{self.processes} workers", where="--workers", accepted="1 or more")
        if self.processes is not None and self.scheduler is not None:
            what = "is for this machine, and --scheduler for another"
            raise InputError(what, where="--workers", accepted="one of them")


HERE = Machines(1)
"""Everything in this process."""


class _Crew(Protocol):
    """Those who do a task on things that are handed out to them."""

    ahead: int

    def submit(self, thing: Any) -> Any:
        """Hand out a thing."""

    def result(self, submitted: Any) -> Any:
        """Wait for what was found of it."""

    def close(self) -> None:
        """End; what is not begun is dropped."""


class Workers(Generic[Thing, Result]):
    """Those who do one task; used in a `with` statement, with which they end."""

    def __init__(self, task: Callable[[Thing], Result], machines: Machines = HERE) -> None:
        """Begin; nobody is called before there is work for them.

        Args:
            task: what to do with each thing; goes to the workers as it is.
            machines: where.
        """
        self._task, self._machines = task, machines
        self._crew: _Crew | None = None
        self._done, self._since = 0, 0.0  # here, and when the first of them was done

    def map(self, things: Iterable[Thing], total: int | None = None) -> Generator[Result, None, None]:
        """The results in the order of the things, each as soon as it and those before it are there.

        On this machine the very first is found in this process, so that kernels that are not in the cache are compiled
        once; and where the number of processes is left open, so are others, until the rest is worth starting them.

        Args:
            things: to do the task on.
            total: how many there are, if that is known.

        Raises:
            InputError: no scheduler answers, or it has no worker.
            ZerorevError: a worker ended before its time, or the cluster is lost.
        """
        left = iter(things)
        if self._crew is None and self._machines.scheduler is None:
            for done, thing in enumerate(left, 1):
                yield self._task(thing)
                if self._share(None if total is None else total - done):
                    break
            else:
                return
        running: deque[Any] = deque()
        for thing in left:
            running.append(self._called().submit(thing))
            if len(running) > self._called().ahead:
                yield self._called().result(running.popleft())
        while running:
            yield self._called().result(running.popleft())

    def _share(self, left: int | None) -> bool:
        """Whether to call processes, one more thing being done here."""
        processes = self._machines.processes
        self._done += 1
        now = time.monotonic()
        if self._done == 1:  # it may have compiled, and says nothing of those to come
            self._since = now
        if processes is not None:
            return processes > 1
        if _cores() == 1 or left == 0:
            return False
        if left is None:
            return True
        spent = now - self._since
        return spent > BEGINNING and spent / (self._done - 1) * left > WORTH_WORKERS

    def _called(self) -> _Crew:
        if self._crew is None:
            scheduler = self._machines.scheduler
            if scheduler is not None:
                self._crew = _Cluster(self._task, scheduler)
            else:
                self._crew = _Processes(self._task, self._machines.processes or _cores())
        return self._crew

    def __enter__(self) -> Workers[Thing, Result]:
        if self._machines.scheduler is not None:
            self._called()  # that there is none is known before anything is written
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        if self._crew is not None:
            self._crew.close()


def _cores() -> int:
    return len(os.sched_getaffinity(0)) if sys.platform == "linux" else os.cpu_count() or 1


# --- processes of this machine ----------------------------------------------------------------------------------------


class _Processes:
    def __init__(self, task: Callable[[Any], Any], count: int) -> None:
        self.ahead = count * AHEAD
        pickled = bytes(ForkingPickler.dumps(task))
        self._pool = ProcessPoolExecutor(count, get_context("spawn"), _begin, (pickled,))

    def submit(self, thing: Any) -> Any:
        with interrupts_held_back():  # workers are started here, and know nothing of Ctrl-C from their first moment
            return self._pool.submit(_do, thing)

    def result(self, submitted: Any) -> Any:
        try:
            return submitted.result()
        except BrokenProcessPool:
            raise ZerorevError("a worker process ended before its time (is there enough memory?)") from None

    def close(self) -> None:
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


def _do(thing: Any) -> Any:
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


# --- a cluster --------------------------------------------------------------------------------------------------------


class _Cluster:
    def __init__(self, task: Callable[[Any], Any], address: str) -> None:
        from distributed import Client

        self._task, self._address, self._version = task, address, version("zerorev")
        self._client = _client(Client, address)
        self.ahead = max(LEAST_AHEAD, CLUSTER_AHEAD * sum(self._client.nthreads().values()))

    def submit(self, thing: Any) -> Any:
        # lost workers are the scheduler's business: it gives their things to others
        return self._client.submit(_do_there, self._version, self._task, thing, pure=False, retries=RETRIES)

    def result(self, submitted: Any) -> Any:
        from asyncio import CancelledError

        try:
            result = submitted.result()
        except ZerorevError:
            raise
        except CancelledError:
            raise ZerorevError(f"the scheduler at {self._address} is lost") from None
        except Exception as error:  # anything that kills a worker or its task, on another machine
            why = f"{type(error).__name__}: {error}"
            raise ZerorevError(f"the cluster at {self._address} failed: {why}") from None
        submitted.release()
        return result

    def close(self) -> None:
        self._client.close(timeout=PATIENCE)


def _client(make: Any, address: str) -> Any:
    """A client of the scheduler, which has a worker at least.

    Raises:
        InputError: no scheduler answers, or it has no worker.
    """
    accepted = "the address that dask scheduler prints, e.g. tcp://10.0.0.1:8786"
    client, why = None, ""
    try:
        client = make(address, timeout=PATIENCE, set_as_default=False)
    except (OSError, ValueError, ImportError) as error:  # ValueError: no such kind of address
        why = str(error).partition("\n")[0] or type(error).__name__
    if client is None:
        # a client that never came to be has to end now: while another one begins, it would wait for that for ever
        gc.collect()
        raise InputError(f"no scheduler answers at {address!r} ({why})", where="--scheduler", accepted=accepted)
    try:
        client.wait_for_workers(1, timeout=WAIT_FOR_WORKERS)
    except (OSError, TimeoutError):
        client.close(timeout=PATIENCE)
        what = f"the scheduler at {address} has no worker"
        raise InputError(what, where="--scheduler", accepted=f"dask worker {address}, once or more") from None
    return client


def _do_there(wanted: str, task: Callable[[Any], Any], thing: Any) -> Any:
    """Do a task on a worker of a cluster, which must be of the same version: results are the same wherever found."""
    here = version("zerorev")
    if here != wanted:
        raise ZerorevError(f"a worker of the cluster has zerorev {here}, and this is {wanted}; install the same on all")
    return task(thing)
