"""The published motions as a plan."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

import zerorev as zr

JOB = Path(__file__).parents[2] / "examples/jobs/thesis_published.yaml"


@pytest.fixture(scope="session")
def published_plan():
    """The thesis' three motions, evaluated and checked, without a proof."""
    job = zr.read_job(JOB)
    return zr.plan_job(replace(job, settings=replace(job.settings, lead_in=0.0, proof_boxes=0)))
