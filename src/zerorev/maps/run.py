"""Running a workspace map: its missing chunks, on this machine or on a cluster, each written as soon as it is there."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable, Generator, Sequence
from contextlib import closing
from dataclasses import dataclass
from functools import partial
from itertools import islice
from math import prod
from pathlib import Path

from zerorev.errors import InputError
from zerorev.maps.cells import Block, Values, answer
from zerorev.maps.chunks import Chunks
from zerorev.maps.workspace import MapStore
from zerorev.model.map_task import MapTask, Question
from zerorev.workers import Workers

__all__ = ["Answered", "Ran", "Runner", "answering", "local", "run_map"]

BEGINNING = 0.5  # [s] answered in this process, after which it is known how long the map takes
WORTH_WORKERS = 4.0  # [s] of work left below which starting workers takes longer than they save

Answered = tuple[int, Values]
Runner = Callable[[Question, Chunks, Sequence[int]], Generator[Answered, None, None]]


@dataclass(frozen=True)
class Ran:
    """What a run did.

    Attributes:
        chunks: of the map.
        before: chunks that were finished before it.
    """

    chunks: int
    before: int


def run_map(task: MapTask, path: str | Path, runner: Runner, progress: Callable[[int, int], None] | None = None) -> Ran:
    """Answer the chunks of a map that are not there yet, or not whole, and write each as soon as it is answered.

    However it is ended, what was written stays, and the same call goes on from there; the finished map is the same to
    the last bit, whatever interruptions it had and whoever ran it.

    Args:
        task: the map.
        path: its folder.
        runner: of whom the answers are had: `local`, or `zerorev.maps.cluster.cluster`.
        progress: told how many cells are done, and of how many.

    Raises:
        InputError: the folder holds another map.
        OutputError: it cannot be written, or the disk is full.
        ZerorevError: a worker, or the cluster, is lost.
    """
    with MapStore(path, task) as store:
        missing = store.missing()
        done = task.cells - sum(prod(store.chunks.extent(n)) for n in missing)
        if progress:
            progress(done, task.cells)
        for cells in answering(store, missing, runner):
            done += cells
            if progress:
                progress(done, task.cells)
        return Ran(store.chunks.count, store.chunks.count - len(missing))


def answering(store: MapStore, missing: Sequence[int], runner: Runner) -> Generator[int, None, None]:
    """Answer chunks of a map that is open to be written, one after the other.

    Args:
        store: of the map.
        missing: its chunks that are wanted.
        runner: of whom the answers are had.

    Yields:
        how many cells the chunk has that was just written.
    """
    with closing(runner(store.task.question, store.chunks, missing)) as answered:
        for number, values in answered:
            store.write(number, values)
            yield len(values["status"])


def local(workers: int | None = None) -> Runner:
    """Processes on this machine.

    Args:
        workers: how many; None: one a core. They are started once it is clear that they are worth it.

    Raises:
        InputError: fewer than one.
    """
    if workers is None:
        workers = len(os.sched_getaffinity(0)) if sys.platform == "linux" else os.cpu_count() or 1
    if workers < 1:
        raise InputError(f"{workers} workers", where="--workers", accepted="1 or more")
    return partial(_answered, workers)


def _answered(
    workers: int, question: Question, chunks: Chunks, missing: Sequence[int]
) -> Generator[Answered, None, None]:
    ask, blocks = _Answerer(question), map(chunks.block, missing)
    yield from map(ask, islice(blocks, 1))  # the first may compile, and says nothing of those to come
    began = time.monotonic()
    for done, block in enumerate(blocks, 1):
        yield ask(block)
        spent = time.monotonic() - began
        if workers > 1 and spent > BEGINNING and spent / done * (len(missing) - 1 - done) > WORTH_WORKERS:
            break
    with Workers(ask, workers) as processes:
        yield from processes.map(blocks)


class _Answerer:
    """What a chunk is answered by; goes to the workers as it is."""

    def __init__(self, question: Question) -> None:
        self.question = question

    def __call__(self, block: Block) -> Answered:
        return block.number, answer(self.question, block)
