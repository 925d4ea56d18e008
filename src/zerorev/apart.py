"""Work of a moment in a process of its own: reading and writing of files.

Parsers and checkers written in C keep Python's lock while they work, for seconds with a large file, for minutes with a
hostile one, and some crash. A process can be given a limit, too, and be stopped at any moment.
"""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
import threading
from collections.abc import Callable, Generator, Iterable, Iterator
from contextlib import suppress
from typing import IO, Any

from zerorev.errors import InputError, ZerorevError

__all__ = ["Apart", "Stopped", "Task"]

MOST_MEMORY = 4 * 2**30  # [bytes]
MOST_SECONDS = 120  # of a processor
BEGIN = "import sys; sys.path[:] = {path!r}; from zerorev.apart import serve; serve()"

ONE_THREAD = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}  # each thread takes address space

Task = Callable[[Iterator[Any]], Iterable[Any]]  # from what is given, piece by piece, to what comes of it


class Stopped(Exception):  # noqa: N818  no error
    """The task was stopped before its end."""


class Apart:
    """A task that is done in another process, once."""

    def __init__(self, task: Task) -> None:
        """Begin with nothing; the process is started by `results`.

        Args:
            task: a function of a module.
        """
        self._task = task
        self._process: subprocess.Popen[bytes] | None = None
        self._stopped = False

    def results(self, given: Iterable[Any]) -> Generator[Any, None, None]:
        """Do the task; to be called in a thread. Closing the generator stops the process.

        Args:
            given: to the task; it and the results are pickled one by one, so that the other threads of this process
                get their turns in between.

        Raises:
            ZerorevError: as the task raises it.
            Stopped: it was stopped.
            InputError: it took too much memory or too long, or crashed.
        """
        command = [sys.executable, "-c", BEGIN.format(path=sys.path)]
        process = self._process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, start_new_session=True, env=os.environ | ONE_THREAD
        )
        try:
            if self._stopped:
                raise EOFError
            assert process.stdin is not None
            assert process.stdout is not None
            with suppress(BrokenPipeError):
                for thing in (self._task, *given):
                    pickle.dump((True, thing), process.stdin, pickle.HIGHEST_PROTOCOL)
                pickle.dump((False, None), process.stdin)
                process.stdin.flush()
            yield from _received(process.stdout)
        except EOFError:
            if self._stopped:
                raise Stopped from None
            raise InputError(
                "cannot be taken: its reader fails, or needs too much memory or time",
                accepted=f"what is done within {MOST_MEMORY // 2**30} GiB and {MOST_SECONDS} s",
            ) from None
        finally:
            self._end(process)

    def stop(self) -> None:
        """Stop the process at once, from any thread."""
        self._stopped = True
        if self._process is not None:
            self._process.kill()

    def _end(self, process: subprocess.Popen[bytes]) -> None:
        process.kill()
        process.wait()
        for pipe in (process.stdin, process.stdout):
            if pipe is not None:
                with suppress(BrokenPipeError):
                    pipe.close()


def _received(pipe: IO[bytes]) -> Iterator[Any]:
    """What comes through a pipe until its end is said.

    Raises:
        EOFError: the other side has ended without a word.
    """
    while True:
        try:
            more, thing = pickle.load(pipe)
        except pickle.UnpicklingError:
            raise EOFError from None
        if not more:
            if thing is not None:
                raise thing
            return
        yield thing


# --- in the other process ---------------------------------------------------------------------------------------------


def serve() -> None:
    """Do the one task that comes in by the standard input, and send what comes of it by the standard output."""
    out = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # so that nothing prints into the results
    _limit()
    trouble: ZerorevError | None = None
    try:
        task, *given = _received(sys.stdin.buffer)
        threading.Thread(target=_end_with_parent, daemon=True).start()
        for thing in task(iter(given)):
            pickle.dump((True, thing), out, pickle.HIGHEST_PROTOCOL)
            out.flush()
    except ZerorevError as error:
        trouble = error
    except MemoryError:
        os._exit(1)
    pickle.dump((False, trouble), out)
    out.flush()
    os._exit(0)


def _limit() -> None:
    if sys.platform == "win32":
        return
    import resource

    os.nice(5)  # the pages come first
    for what, most in ((resource.RLIMIT_AS, MOST_MEMORY), (resource.RLIMIT_CPU, MOST_SECONDS)):
        with suppress(ValueError, OSError):  # macOS knows no limit of the address space
            resource.setrlimit(what, (most, resource.getrlimit(what)[1]))
    if sys.platform == "linux":
        import ctypes
        import signal

        ctypes.CDLL(None).prctl(1, signal.SIGKILL)  # PR_SET_PDEATHSIG: the end of the thread that waits for the results


def _end_with_parent() -> None:
    """Where no signal comes: the parent holds its end of the pipe for as long as it waits."""
    while os.read(0, 1):
        pass
    os._exit(1)
