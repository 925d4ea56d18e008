"""The thesis' plan, the sweeps at its first hole, and an arm of known parameters that ran them."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

import zerorev as zr
from oracles.sweeps import known_arm, recorded, swept
from zerorev.cell.recordings.tip import planned_hole
from zerorev.program.sweeps import sweeps_of

ROOT = Path(__file__).parents[3]


@pytest.fixture(scope="session")
def published(tmp_path_factory):
    """The plan file of the thesis' own motions."""
    folder = tmp_path_factory.mktemp("published")
    plan = zr.plan_job(zr.read_job(ROOT / "examples/jobs/thesis_published.yaml"))
    zr.write_plan(plan, folder / "plan.json")
    return folder / "plan.json"


@pytest.fixture(scope="session")
def plan(published):
    return zr.read_plan(published)


@pytest.fixture(scope="session")
def meant(plan):
    return planned_hole(plan, "position_1")


@pytest.fixture(scope="session")
def sweeps(meant):
    return sweeps_of(meant.drilling, meant.motion)


@pytest.fixture(scope="session")
def reference(sweeps):
    return swept(sweeps)


@pytest.fixture(scope="session")
def arm():
    return known_arm(3)


@pytest.fixture(scope="session")
def recording(reference, arm):
    return recorded(reference, arm)


@pytest.fixture
def folder(tmp_path, published):
    shutil.copy(published, tmp_path / "plan.json")
    return tmp_path
