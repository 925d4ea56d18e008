"""The first answer in a fresh process: with the kernels cached, and with nothing cached."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from statistics import median
from tempfile import TemporaryDirectory

from benchmarks.parts import Options
from benchmarks.table import Goal, Section
from benchmarks.timing import duration

__all__ = ["run"]

FIRST_ANSWER = """
import zerorev as zr
robot, tool = zr.read_robot("kuka_kr6_r700_2"), zr.read_tool("thesis_drill")
plan = zr.plan(robot, tool, zr.Hole("first", target=[0.5, 0.3, 0.8], direction=[1, 0, 0], depth=0.05))
print(plan.score.reversals, plan.verified.passed)
"""
NOTICE = "compiling kernels"


def run(options: Options) -> Section:
    """Start processes and wait for their answers."""
    _fresh({})  # so that the caches are warm
    warm = [_fresh({}) for _ in range(options.rounds)]
    with TemporaryDirectory() as folder:
        cold, said = _fresh({"NUMBA_CACHE_DIR": folder})
    seconds = [each for each, _ in warm]
    failures = [] if NOTICE in said else ["a cold first run does not say that it compiles"]
    if any(NOTICE in said for _, said in warm):
        failures.append("a run with warm caches compiles")
    return Section(
        name="start",
        title="The first answer in a fresh process",
        columns=("caches", "median, by the clock", "least", "says that it compiles"),
        rows=[
            ("warm", duration(median(seconds)), duration(min(seconds)), "no, and does not"),
            ("none", duration(cold), duration(cold), "yes" if NOTICE in said else "NO"),
        ],
        notes=[f"`zerorev.plan` of position 1, checked, imports included; {options.rounds} processes."],
        goals=[
            Goal(
                "first answer in a fresh process, caches warm; a cold first run says that it compiles",
                "",
                "1 s",
                f"{duration(median(seconds))}; {'it says so' if NOTICE in said else 'it does not say so'}",
            )
        ],
        failures=failures,
        figures={"warm": seconds, "cold": cold},
    )


def _fresh(variables: dict[str, str]) -> tuple[float, str]:
    """Seconds by the clock until a new process has answered and ended, and what it said on the way."""
    # Python's own cache is one of those that are warm: a process that must not write it compiles every module again
    kept = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    began = time.perf_counter()
    done = subprocess.run(
        [sys.executable, "-c", FIRST_ANSWER],
        env={**kept, **variables},
        capture_output=True,
        text=True,
        check=True,
    )
    took = time.perf_counter() - began
    if done.stdout.split() != ["0", "True"]:
        raise RuntimeError(f"the first answer is {done.stdout!r}: zero reversals, verified, were expected")
    return took, done.stderr
