"""The deepest motion of every hole of a job without a reversal: strokes, plans and a file of both."""

from pathlib import Path
from tempfile import TemporaryDirectory

import zerorev as zr

JOB = """
robot: kuka_kr6_r700_2
tool: thesis_drill
holes:                            # no depth_mm: it is what is asked for
  - {id: A, target_mm: [500, 300, 800], direction: [1, 0, 0], branch: 4}
  - {id: B, target_mm: [200, 200, 1000], direction: [1, 0, 0], branch: 4}
"""

with TemporaryDirectory() as folder:
    file = Path(folder) / "job.yaml"
    file.write_text(JOB)
    depths = zr.plan_job(zr.read_job(file, depth_needed=False), strokes="deepest")
    zr.write_plan(depths, Path(folder) / "depths.json")  # what `zerorev depth job.yaml -o depths.json` writes
    read = zr.verify_plan(zr.read_plan(Path(folder) / "depths.json"))
for answer in read.holes:
    print(f"{answer.hole.id}: {answer.deepest * 1e3:.1f} mm, {answer.score.reversals} reversals,", end=" ")
    print(f"slowest joint {answer.score.min_rate.min():.4f} rad/m, checked: {answer.verified.passed}")
