"""Processes that share work: what Ctrl-C may not break."""

from __future__ import annotations

import signal
import sys
import threading
import time

import pytest

from zerorev.workers import interrupts_held_back


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
