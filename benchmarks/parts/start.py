"""The first answer in a fresh process, of Python, each command and the app: kernels cached, and nothing cached."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Mapping
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from urllib.request import urlopen

from benchmarks.parts import Options
from benchmarks.table import Goal, Section
from benchmarks.timing import duration

__all__ = ["run"]

PYTHON = """
import zerorev as zr
robot, tool = zr.read_robot("kuka_kr6_r700_2"), zr.read_tool("thesis_drill")
plan = zr.plan(robot, tool, zr.Hole("first", target=[0.5, 0.3, 0.8], direction=[1, 0, 0], depth=0.05))
assert plan.score.reversals == 0 and plan.verified.passed
"""
COMMAND = [sys.executable, "-m", "zerorev.cli"]
ASKED = {
    "`zerorev.plan` of position 1": [sys.executable, "-c", PYTHON],
    "`zerorev plan`, three positions": [*COMMAND, "plan", "examples/jobs/thesis_positions.yaml"],
    "`zerorev depth`, three positions": [*COMMAND, "depth", "examples/jobs/thesis_positions.yaml"],
    "`zerorev map` of Table 5's plane, 81 cells": [*COMMAND, "map", "examples/maps/table5_plane.yaml", "-o", "MAP"],
    "`zerorev view`, until its page is served": [*COMMAND, "view", "--no-browser", "--port=0"],
}
NOTICE = "compiling kernels"
GOAL_COLD = 15.0  # [s]


def run(options: Options) -> Section:
    """Start processes and wait for their answers, one question after the other and that in turns."""
    for asked in ASKED:
        _fresh(asked, {})  # so that the caches are warm
    warm = {asked: list[float]() for asked in ASKED}
    failures = []
    for _ in range(options.rounds):
        for asked, seconds in warm.items():
            took, said = _fresh(asked, {})
            seconds.append(took)
            if NOTICE in said:
                failures.append(f"{asked}: a run with warm caches compiles")
    cold = {}
    for asked in ASKED:
        with TemporaryDirectory() as folder:
            cold[asked], said = _fresh(asked, {"NUMBA_CACHE_DIR": folder})
        if NOTICE not in said and "view" not in asked:
            failures.append(f"{asked}: a cold first run does not say that it compiles")
    first = next(iter(ASKED))
    return Section(
        name="start",
        title="The first answer in a fresh process",
        columns=("what is asked", "kernels cached: median, by the clock", "least", "nothing cached"),
        rows=[
            (asked, duration(median(warm[asked])), duration(min(warm[asked])), duration(cold[asked])) for asked in ASKED
        ],
        notes=[
            f"From the start of the process to its end, imports included; {options.rounds} processes each, in turns,"
            " and one that compiles all that it needs and says so. The page of the app needs no kernel."
        ],
        goals=[
            Goal("first answer in a fresh process, kernels cached", "", "0.7 s", duration(median(warm[first]))),
            Goal("the first plan on a fresh machine", "", duration(GOAL_COLD), duration(max(cold.values()))),
        ],
        failures=failures,
        figures={"warm": warm, "cold": cold},
    )


def _fresh(asked: str, variables: Mapping[str, str]) -> tuple[float, str]:
    """Seconds by the clock until a new process has answered, and what it said on the way."""
    # Python's own cache is one of those that are warm: a process that must not write it compiles every module again
    kept = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    with TemporaryDirectory() as folder:
        command = [str(Path(folder, "map.zarr")) if part == "MAP" else part for part in ASKED[asked]]
        began = time.perf_counter()
        process = subprocess.Popen(
            command, env={**kept, **variables}, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        )
        if "view" in command:
            took = _served(process, began)
            process.terminate()
            said = process.communicate()[1]
        else:
            _, said = process.communicate()
            took = time.perf_counter() - began
            if process.returncode:
                raise RuntimeError(f"{asked} ended with {process.returncode}: {said}")
    return took, said


def _served(process: subprocess.Popen[str], began: float) -> float:
    assert process.stdout
    for line in process.stdout:
        for word in line.split():
            if word.startswith("http://"):
                with urlopen(word) as answer:
                    answer.read()
                return time.perf_counter() - began
    raise RuntimeError("the app printed no address")
