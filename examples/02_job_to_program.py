"""A job file to a plan, to figures of its numbers, to a robot program."""

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

import zerorev as zr

job = zr.read_job(Path(__file__).parent / "jobs" / "thesis_positions.yaml")
plan = zr.plan_job(job)
for answer in plan.holes:
    spins = np.rad2deg(answer.motion.profile.psi)
    print(f"{answer.hole.id}: {answer.score.reversals} reversals at spins of {spins.round(2)} deg")

with TemporaryDirectory() as folder:
    file = Path(folder) / "positions.plan.json"
    zr.write_plan(plan, file)
    program = zr.export(zr.read_plan(file), "krl")
    print(program.text.splitlines()[3], "...", len(program.text.splitlines()), "lines of KRL")
for finding in program.findings:
    print(f"{finding.level}: {finding.message}")
