"""`zerorev depth`: the deepest stroke of each hole."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

from zerorev.cli.common import FINE, FOUND, Output, app, check_outputs

__all__ = ["depth"]


@app.command
def depth(
    job: Path,
    /,
    *,
    output: Output = None,
    legs: Literal["straight", "free"] | None = None,
    psi_bound_deg: float | None = None,
    min_rate_deg_per_mm: float | None = None,
    max_twist_deg_per_mm: float | None = None,
    proof_boxes: int | None = None,
    workers: int | None = None,
    json: bool = False,
) -> int:
    """Find the deepest stroke of each hole that has no reversal, and the motion that reaches it, and check that.

    The holes need no depth_mm. What DEPTHS.json holds is checked and exported as a plan is. The finished holes are kept
    in DEPTHS.json.part on the way; after an interruption the same command goes on from there.

    Args:
        job: The job file (YAML): robot, tool, holes.
        output: Where to write depths and plans (JSON). Without it the answer is only shown.
        legs: straight or free, instead of the job's.
        psi_bound_deg: Spins stay within +- this, instead of the job's bound.
        min_rate_deg_per_mm: Every joint moves so much at every point, instead of the job's motion threshold.
        max_twist_deg_per_mm: Greatest twist rate of free legs, instead of the job's.
        proof_boxes: How many boxes of legs the proof of each depth may examine, instead of the job's; 0: no proof.
        workers: Processes to run it on; by default all cores where the job is large. The answer is the same.
        json: Print what the file holds as JSON on standard output, and nothing else there.
    """
    from zerorev.files.io import read_job

    check_outputs((output,), job)
    options = {
        "legs": legs,
        "psi_bound_deg": psi_bound_deg,
        "min_rate_deg_per_mm": min_rate_deg_per_mm,
        "max_twist_deg_per_mm": max_twist_deg_per_mm,
        "proof_boxes": proof_boxes,
    }
    given = {key: value for key, value in options.items() if value is not None}
    wanted = read_job(job, depth_needed=False, options=given)

    from zerorev.cli.answering import run

    return FINE if run(wanted, "deepest", output, workers, json=json) else FOUND
