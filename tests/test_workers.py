"""Processes that share work: what Ctrl-C may not break."""

from __future__ import annotations

import os
import signal
import sys
import threading
import time

import pytest

from zerorev import workers
from zerorev.errors import InputError, ZerorevError
from zerorev.workers import HERE, Machines, Workers, interrupts_held_back


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
class TestInterruptsHeldBack:
    def test_one_comes_after_the_work_whichever_thread_takes_it(self):
        """A signal to a process goes to any thread that takes it, and Python then interrupts the main one."""
        idle, done = threading.Event(), []
        other = threading.Thread(target=idle.wait)
        other.start()

        def work() -> None:
            with interrupts_held_back():
                signal.pthread_kill(other.ident, signal.SIGINT)
                until = time.monotonic() + 0.2  # it comes soon, were it not held back
                while time.monotonic() < until:
                    pass
                done.append(True)

        try:
            with pytest.raises(KeyboardInterrupt):
                work()
        finally:
            idle.set()
            other.join()
        assert done

    def test_all_is_as_before_afterwards(self):
        before = signal.getsignal(signal.SIGINT)
        with interrupts_held_back():
            assert signal.SIGINT in signal.pthread_sigmask(signal.SIG_BLOCK, [])
        assert signal.getsignal(signal.SIGINT) is before
        assert signal.SIGINT not in signal.pthread_sigmask(signal.SIG_BLOCK, [])


def _square(n: int) -> int:
    return n * n


def _slow_square(n: int) -> int:
    time.sleep(0.15)
    return n * n


class TestWorkers:
    @pytest.mark.parametrize("machines", [HERE, Machines(2), Machines()])
    @pytest.mark.parametrize("total", [None, 50])
    def test_results_are_in_order(self, machines, total):
        with Workers(_square, machines) as squares:
            assert list(squares.map(range(50), total)) == [n * n for n in range(50)]
            assert list(squares.map(range(3), 3)) == [0, 1, 4]
            assert list(squares.map([])) == []

    def test_processes_are_started_where_it_is_worth_it(self, monkeypatch):
        monkeypatch.setattr(workers, "_cores", lambda: 2)
        with Workers(_slow_square, Machines()) as squares:
            assert list(squares.map(range(3), 3)) == [0, 1, 4]
            assert squares._crew is None
            assert list(squares.map(range(60), 60)) == [n * n for n in range(60)]
            assert squares._crew is not None

    def test_a_worker_that_is_lost_is_said(self):
        with Workers(os._exit, Machines(2)) as exits:
            exits._crew = workers._Processes(os._exit, 2)  # the first, too, is done by them
            with pytest.raises(ZerorevError, match="before its time"):
                list(exits.map([1, 1]))


class TestMachines:
    def test_what_is_refused(self):
        with pytest.raises(InputError, match=r"--workers: 0 workers \(accepted: 1 or more\)"):
            Machines(0)
        with pytest.raises(InputError, match="--workers: is for this machine, and --scheduler for another"):
            Machines(2, "tcp://10.0.0.1:8786")
