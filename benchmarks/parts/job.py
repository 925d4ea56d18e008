"""Whole jobs through the command line: time per hole and memory as the number of holes grows, on one core and two."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from benchmarks.parts import Options
from benchmarks.table import Goal, Section
from benchmarks.timing import duration

__all__ = ["run"]

WORKERS = (1, 2)
PANEL = 180.0  # [mm] side of the square that is filled with holes
JOB = """
robot: kuka_kr6_r700_2
tool: thesis_drill
part_frame: {xyz_mm: [480, 150, 720], rpy_deg: [0, -60, 0]}
psi_reference: part_y
holes: holes.csv
"""
# runs a command, then prints how much memory any one process of it held at most [KiB]
WATCHED = """
import resource, subprocess, sys
code = subprocess.run(sys.argv[1:], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL).returncode
print(code, resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)
"""


def run(options: Options) -> Section:
    """Plan panels of more and more holes."""
    rows, figures, failures = [], [], list[str]()
    with TemporaryDirectory() as name:
        folder = Path(name)
        for size in options.jobs:
            _write(folder, size)
            plans = []
            for workers in WORKERS:
                plan = folder / f"{size}-{workers}.json"
                seconds, memory, code = _planned(folder / "job.yaml", plan, workers)
                if code not in (0, 1):
                    failures.append(f"{size} holes with {workers} workers end with the code {code}")
                    continue
                plans.append(plan.read_bytes())
                rows.append((f"{size:,}", str(workers), duration(seconds / size), f"{memory:.0f} MB"))
                figures.append({"holes": size, "workers": workers, "s": seconds, "megabytes": memory})
            if len(set(plans)) != 1:
                failures.append(f"{size} holes: the plan depends on the number of workers")
            elif (planned := len(json.loads(plans[0])["holes"])) != size:
                failures.append(f"{planned} of {size} holes are in the plan")
    per_hole = [each["s"] / each["holes"] for each in figures if each["workers"] == WORKERS[-1]]
    return Section(
        name="job",
        title="Jobs of many holes",
        columns=("holes", "workers", "time per hole, by the clock", "most memory of a process"),
        rows=rows,
        notes=[
            "`zerorev plan JOB -o PLAN --workers N` on a square panel, each hole searched and checked, and its margin"
            " found. The plan is the same to the byte for any number of workers."
        ],
        goals=[
            Goal(
                "a job of many holes: time per hole as the number grows, two workers",
                "",
                "flat",
                " / ".join(f"{duration(each)} ({size:,})" for each, size in zip(per_hole, options.jobs, strict=False)),
            )
        ],
        failures=failures,
        figures={"runs": figures},
    )


def _write(folder: Path, size: int) -> None:
    """A job of a square panel with so many holes."""
    side = int(np.ceil(np.sqrt(size)))
    at = np.linspace(-PANEL / 2, PANEL / 2, side)
    places = [(x, y) for x in at for y in at][:size]
    lines = [f"H{n},{x:.3f},{y:.3f},0,0,0,-1,12" for n, (x, y) in enumerate(places)]
    (folder / "holes.csv").write_text("\n".join(["id,x_mm,y_mm,z_mm,i,j,k,depth_mm", *lines]) + "\n")
    (folder / "job.yaml").write_text(JOB)


def _planned(job: Path, plan: Path, workers: int) -> tuple[float, float, int]:
    """Seconds by the clock, megabytes, and the exit code."""
    command = [sys.executable, "-m", "zerorev.cli", "plan", str(job), "-o", str(plan), "--workers", str(workers)]
    begin = time.perf_counter()
    done = subprocess.run([sys.executable, "-c", WATCHED, *command], capture_output=True, text=True, check=True)
    seconds = time.perf_counter() - begin
    code, kibibytes = map(int, done.stdout.split())
    return seconds, kibibytes * 1024 / 1e6, code
