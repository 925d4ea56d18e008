"""Running a workspace map: its missing chunks, on this machine or on a cluster, each written as soon as it is there."""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from contextlib import closing
from dataclasses import dataclass
from math import prod
from pathlib import Path

from zerorev.kernels._ahead import expect
from zerorev.maps.cells import Block, Values, answer
from zerorev.maps.workspace import MapStore
from zerorev.model.map_task import MapTask, Question
from zerorev.workers import HERE, Machines, Workers

__all__ = ["Ran", "answerers", "answering", "run_map"]

Answered = tuple[int, Values]


@dataclass(frozen=True)
class Ran:
    """What a run did.

    Attributes:
        chunks: of the map.
        before: chunks that were finished before it.
    """

    chunks: int
    before: int


def run_map(
    task: MapTask,
    path: str | Path,
    machines: Machines = HERE,
    progress: Callable[[int, int], None] | None = None,
) -> Ran:
    """Answer the chunks of a map that are not there yet, or not whole, and write each as soon as it is answered.

    However it is ended, what was written stays, and the same call resumes; the finished map is the same to
    the last bit, regardless of interruptions and of the runner.

    Args:
        task: the map.
        path: its folder.
        machines: to run it on.
        progress: called with the number of cells done and in all.

    Raises:
        OutputError: it cannot be written, or the disk is full.
        InputError: the folder holds another map; no scheduler answers.
        ZerorevError: a worker, or the cluster, is lost.
    """
    with answerers(task, machines) as workers, MapStore(path, task) as store:
        missing = store.missing()
        done = task.cells - sum(prod(store.chunks.extent(n)) for n in missing)
        if progress:
            progress(done, task.cells)
        for cells in answering(store, missing, workers):
            done += cells
            if progress:
                progress(done, task.cells)
        return Ran(store.chunks.count, store.chunks.count - len(missing))


def answerers(task: MapTask, machines: Machines) -> Workers[Block, Answered]:
    """Those who answer the chunks of a map."""
    return Workers(_Answerer(task.question), machines)


def answering(store: MapStore, missing: Sequence[int], workers: Workers[Block, Answered]) -> Generator[int, None, None]:
    """Answer chunks of a map that is open to be written, one after the other.

    Args:
        store: of the map.
        missing: its chunks that are wanted.
        workers: of `answerers`.

    Yields:
        how many cells the chunk has that was just written.
    """
    with closing(workers.map(map(store.chunks.block, missing), len(missing))) as answered:
        for number, values in answered:
            store.write(number, values)
            yield len(values["status"])


class _Answerer:
    """What a chunk is answered by; goes to the workers as it is."""

    def __init__(self, question: Question) -> None:
        self.question = question

    def __call__(self, block: Block) -> Answered:
        expect(f"map of {self.question.quantity}")
        return block.number, answer(self.question, block)
