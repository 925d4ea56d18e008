"""Where should the part stand? A panel that cannot be drilled at all, until it hangs some 250 mm lower."""

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

import zerorev as zr
from zerorev.files.moved_job import write_job
from zerorev.placement.freedom import Freedom, frame_at
from zerorev.placement.search import place

file = Path(__file__).parent / "jobs" / "place_panel.yaml"
job = zr.read_job(file)
found = place(job, Freedom(z=(-0.3, 0.0)), grid=7)  # it may be moved down by 300 mm, and no other way
print(f"as it stands: {(found.as_it_stands + 0.1).round(3) * 1e3} mm deep without a reversal, 100 mm needed")
print(f"{-found.place[2] * 1e3:.1f} mm lower: {(found.margins * 1e3 + 100).round(1)} mm")
print("and it may hang {:.1f} mm lower or {:.1f} mm higher than that".format(*np.abs(found.room[2]) * 1e3))

with TemporaryDirectory() as folder:
    write_job(Path(folder) / "moved.yaml", file, T_base_part=frame_at(job.T_base_part, found.place))
    plan = zr.plan_job(zr.read_job(Path(folder) / "moved.yaml"))
print(
    "reversals:",
    [hole.score.reversals for hole in plan.holes],
    "checked:",
    all(hole.verified.passed for hole in plan.holes),
)
