"""One workspace map on one process, on two, and on a cluster that loses a worker half-way: the same bytes."""

from __future__ import annotations

import re
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from benchmarks.box import content, thinned
from benchmarks.parts import Options
from benchmarks.table import Goal, Section
from benchmarks.timing import duration
from zerorev.maps.run import run_map
from zerorev.model.map_task import MapTask
from zerorev.workers import HERE, Machines

__all__ = ["run"]

CELLS = 3000  # some forty seconds on one process
CLUSTER_WORKERS = 3


@dataclass(frozen=True)
class _Made:
    """A map, made again.

    Attributes:
        how: in words.
        seconds: by the clock.
        content: its files.
    """

    how: str
    seconds: float
    content: dict[str, bytes]


def run(options: Options) -> Section:
    """Make the same map in each way, each from an empty folder."""
    task = thinned(min(CELLS, options.cells))
    _made("", thinned(5), HERE)  # so that the kernels are compiled
    made = [_made("one process", task, HERE), _made("two local workers", task, Machines(2))]
    lost, failures = _on_a_cluster(task)
    made.append(lost)
    failures += [f"{each.how}: other bytes than on one process" for each in made if each.content != made[0].content]
    return Section(
        name="map_scaling",
        title="Workspace maps: workers, and a cluster that loses one",
        columns=("how", "whole run", "cells a second", "times as fast", "same bytes"),
        rows=[_row(each, made[0], task.cells) for each in made],
        notes=[
            f"{task.cells:,} cells of the box of the next table; by the clock, each once, from an empty folder to the"
            " finished map. Two local workers include their start, some two seconds. The cluster is a scheduler and"
            " three worker processes on this machine, which have no more cores than the others; they are there when"
            " the clock starts, and load zerorev with their first chunk. One of them is killed (SIGKILL) when half of"
            " the cells are back; the chunks that it held go to the other two."
        ],
        goals=[
            Goal(
                "a map on two local workers, and on a cluster of which one worker is killed half-way",
                "",
                "the bytes of one process",
                f"{'NOT the same' if failures else 'the same'}; × {made[0].seconds / made[1].seconds:.2f} on two",
            )
        ],
        failures=failures,
        figures={"cells": task.cells, "seconds": {each.how: each.seconds for each in made}},
    )  # fmt: skip


def _row(made: _Made, first: _Made, cells: int) -> tuple[str, ...]:
    same = "yes" if made.content == first.content else "NO"
    return made.how, duration(made.seconds), f"{cells / made.seconds:.1f}", f"{first.seconds / made.seconds:.2f}", same


def _made(how: str, task: MapTask, machines: Machines, progress: Callable[[int, int], None] | None = None) -> _Made:
    with TemporaryDirectory() as folder:
        began = time.perf_counter()
        run_map(task, Path(folder) / "map.zarr", machines, progress)
        return _Made(how, time.perf_counter() - began, content(Path(folder)))


def _on_a_cluster(task: MapTask) -> tuple[_Made, list[str]]:
    """The map on a cluster that loses a worker, and what did not go as it should."""
    lost: list[int] = []
    with _dask() as (address, workers):

        def lose_one(done: int, of: int) -> None:
            if 2 * done >= of and not lost:
                workers[0].kill()
                lost.append(of - done)

        how = f"dask.distributed, {CLUSTER_WORKERS} workers, one killed half-way"
        made = _made(how, task, Machines(scheduler=address), lose_one)
        left = sum(worker.poll() is None for worker in workers)
    failures = [] if lost and lost[0] else ["no worker was killed before the map was finished"]
    if left != CLUSTER_WORKERS - 1:
        failures.append(f"{left} workers were left at the end, not {CLUSTER_WORKERS - 1}")
    return made, failures


@contextmanager
def _dask() -> Iterator[tuple[str, list[subprocess.Popen[str]]]]:
    """A scheduler's address and its workers, without nannies that would start a lost one again."""
    processes: list[subprocess.Popen[str]] = []

    def start(name: str, *arguments: str) -> subprocess.Popen[str]:
        command = [sys.executable, "-m", f"distributed.cli.dask_{name}", *arguments, "--no-dashboard"]
        processes.append(subprocess.Popen(command, stderr=subprocess.PIPE, text=True))
        return processes[-1]

    try:
        scheduler = start("scheduler", "--host", "127.0.0.1", "--port", "0")
        address = _said(scheduler, r"tcp://[\d.]+:\d+")
        workers = [start("worker", address, "--no-nanny", "--nthreads", "1") for _ in range(CLUSTER_WORKERS)]
        for worker in workers:
            _said(worker, "Registered to")
        yield address, workers
    finally:
        for process in reversed(processes):
            process.kill()
            process.communicate()


def _said(process: subprocess.Popen[str], pattern: str) -> str:
    """The first thing of the kind that a process says.

    Raises:
        RuntimeError: it ends before.
    """
    assert process.stderr is not None
    for line in process.stderr:
        if found := re.search(pattern, line):
            return found[0]
    raise RuntimeError(f"{process.args} ended with {process.wait()}")
