"""Which of two robots should drill which hole? A panel too wide for either of them, and both of them before it."""

from dataclasses import replace
from pathlib import Path

import numpy as np

import zerorev as zr
from zerorev.placement.sharing import share

folder = Path(__file__).parent / "jobs" / "two_robots"
jobs = [zr.read_job(folder / f"{name}.yaml") for name in ("left", "right")]  # the same holes.csv, seen from two places
shares = share(jobs, balance=True)

for row in ("B", "A"):  # the upper row first
    holes = [k for k, name in enumerate(shares.ids) if name.startswith(row)]
    print(row, "  ".join(jobs[shares.taken_by[k]].name[0].upper() for k in holes))
for job, margins in zip(jobs, shares.margins, strict=True):
    print(f"{job.name} alone could drill {(margins >= 0).sum()} of {len(shares.ids)}")
print(f"together all {(shares.taken_by >= 0).sum()}, each with {shares.least * 1e3:.1f} mm or more of margin")

for r, job in enumerate(jobs):
    mine = tuple(hole for k, hole in enumerate(job.holes) if shares.taken_by[k] == r)
    plan = zr.plan_job(replace(job, holes=mine))
    reversals = np.array([hole.score.reversals for hole in plan.holes])
    checked = all(hole.verified.passed for hole in plan.holes)
    print(f"{job.name}: {len(mine)} holes, {reversals.sum()} reversals, checked: {checked}")
