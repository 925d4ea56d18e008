"""Work on many motions shared out among threads: kernels let go of Python's lock, so that threads run side by side."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import cache

from numba import config

__all__ = ["share_out"]

PARTS = 4  # a thread: some motions take longer than others


def share_out(work: Callable[[slice], None], count: int, threads: int | None = None) -> None:
    """Do the work on all of so many items.

    Numba's own parallel loops would do, but take no nested tuples, such as an arm's geometry.

    Args:
        work: does its part of the items; no part may depend on what another does.
        count: of items.
        threads: how many to use; None: as many as Numba would, one per core unless NUMBA_NUM_THREADS says otherwise.
    """
    threads = threads or config.NUMBA_NUM_THREADS  # type: ignore[attr-defined]
    if threads == 1:
        return work(slice(0, count))
    size = max(1, -(-count // (PARTS * threads)))
    for _ in _pool(threads).map(work, (slice(first, first + size) for first in range(0, count, size))):
        pass  # so that what goes wrong there is heard of here


@cache
def _pool(threads: int) -> ThreadPoolExecutor:
    return ThreadPoolExecutor(threads, thread_name_prefix="zerorev")
