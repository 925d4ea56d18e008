"""A command watched from outside: the time and the memory of it and of all processes that it starts."""

from __future__ import annotations

import json
import subprocess
import tempfile
import time
from collections.abc import Container, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path

import psutil

from zerorev.files.output import write_text

__all__ = ["Cost", "watched"]

EVERY = 0.5  # [s] between two looks
SAVE_EVERY = 10  # looks


@dataclass(frozen=True)
class Cost:
    """What a command cost, over all the runs that it took.

    Attributes:
        seconds: by the clock.
        processor: seconds of the processor, of all processes.
        most_of_one: most memory that any one process held [bytes].
        most_of_all: most that all of them held at one time, what they share counted in each [bytes].
        processes: most at one time.
        runs: how often it was begun.
        finished: whether it came to its end.
    """

    seconds: float = 0.0
    processor: float = 0.0
    most_of_one: int = 0
    most_of_all: int = 0
    processes: int = 0
    runs: int = 0
    finished: bool = False


@dataclass
class _Look:
    """What is known of the run under way."""

    began: float = field(default_factory=time.perf_counter)
    processor: dict[int, float] = field(default_factory=dict)  # by process
    cost: Cost = field(default_factory=Cost)

    def at(self, root: psutil.Process) -> None:
        sizes = []
        try:
            family = [root, *root.children(recursive=True)]
        except psutil.NoSuchProcess:
            family = []
        for process in family:
            try:
                with process.oneshot():
                    times = process.cpu_times()
                    sizes.append(process.memory_info().rss)
                    self.processor[process.pid] = times.user + times.system
            except psutil.NoSuchProcess:  # it ended meanwhile
                continue
        seconds, processor = time.perf_counter() - self.began, sum(self.processor.values())
        now = Cost(seconds, processor, max(sizes, default=0), sum(sizes), len(sizes))
        peaks = ("most_of_one", "most_of_all", "processes")
        self.cost = replace(now, **{name: max(getattr(now, name), getattr(self.cost, name)) for name in peaks})


def watched(
    command: Sequence[str], log: Path, *, environment: Mapping[str, str] | None = None, codes: Container[int] = (0,)
) -> Cost:
    """Run a command to its end, and tell what it cost, together with earlier runs of it that were broken off.

    Args:
        command: which resumes when it is run again; where it came to its end it is not.
        log: file in which the cost is kept on the way; where it is there already, it is added to.
        environment: of the command; None: this process' own.
        codes: with which it may end.

    Raises:
        RuntimeError: the command fails.
    """
    before = Cost(**json.loads(log.read_text(encoding="utf-8"))) if log.exists() else Cost()
    if before.finished:
        return before
    look, looks = _Look(), 0
    with tempfile.TemporaryFile("w+") as said:
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=said, env=environment)
        try:
            root = psutil.Process(process.pid)
            while process.poll() is None:
                look.at(root)
                if looks % SAVE_EVERY == 0:
                    write_text(log, json.dumps(asdict(_sum(before, look.cost))))
                looks += 1
                with suppress(subprocess.TimeoutExpired):
                    process.wait(EVERY)
        finally:
            process.terminate()
            process.wait()
        total = _sum(before, replace(look.cost, seconds=time.perf_counter() - look.began))
        total = replace(total, finished=process.returncode in codes)
        write_text(log, json.dumps(asdict(total)))
        if process.returncode not in codes:
            said.seek(0)
            raise RuntimeError(f"{' '.join(command)} ends with {process.returncode}: {said.read().strip()[-500:]}")
    return total


def _sum(before: Cost, now: Cost) -> Cost:
    return Cost(
        before.seconds + now.seconds,
        before.processor + now.processor,
        max(before.most_of_one, now.most_of_one),
        max(before.most_of_all, now.most_of_all),
        max(before.processes, now.processes),
        before.runs + 1,
    )
