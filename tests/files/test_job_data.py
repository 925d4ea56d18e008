"""A job as a file: what is written reads back as the same job, also one that was edited or comes from a plan."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from oracles.places import JOBS
from zerorev.errors import InputError
from zerorev.files.io import job_from_text, read_job
from zerorev.files.job_data import job_files
from zerorev.model._arrays import rotation_rpy, transform
from zerorev.model.cycle import Cycle
from zerorev.model.hole import Hole
from zerorev.model.job import Job, Settings
from zerorev.model.profile import Profile


def same(one: Job, other: Job) -> None:
    """Two jobs, to the digits that a file keeps."""
    assert (one.name, one.settings, one.robot.name) == (other.name, other.settings, other.robot.name)
    np.testing.assert_allclose(one.T_base_part, other.T_base_part, atol=1e-12)
    np.testing.assert_allclose(one.tool.T_flange_tcp, other.tool.T_flange_tcp, atol=1e-12)
    assert [hole.id for hole in one.holes] == [hole.id for hole in other.holes]
    for a, b in zip(one.holes, other.holes, strict=True):
        for name in ("target", "direction", "psi_zero", "depth"):
            np.testing.assert_allclose(getattr(a, name), getattr(b, name), atol=1e-11)
        assert (a.branch, a.group, a.cycle) == (b.branch, b.group, b.cycle)
        assert (a.profile is None) == (b.profile is None)
        if a.profile is not None:
            np.testing.assert_allclose(a.profile.standoff, b.profile.standoff, atol=1e-12)
            np.testing.assert_allclose(a.profile.psi, b.profile.psi, atol=1e-12)


@pytest.mark.parametrize("path", sorted(JOBS.glob("*.yaml")), ids=lambda path: path.stem)
def test_every_example_reads_back(path):
    job = read_job(path)
    ((name, text),) = job_files(job).items()
    assert name == f"{job.name}.yaml"
    same(job, job_from_text(text, name))


@pytest.mark.parametrize("reference", ["base_y", "nearest_base", "part_x", "part_y", (0.3, 0.5, -0.2), None])
def test_any_reference_and_frame_and_a_given_motion(robot, tool, reference):
    T = transform(rotation_rpy(0.1, -0.7, 0.4), np.array([0.4, 0.1, 0.6]))
    source = Job(
        robot, tool, (Hole("a", [0.5, 0.1, 0.8], [0.9, 0.1, -0.2], 0.03),), Settings(min_rate=0.0), T, "my job"
    )
    given = {None: "part_x"}.get(reference, reference)
    text = job_files(source)["my_job.yaml"].replace("psi_reference: base_y", f"psi_reference: {_yaml(given)}")
    job = job_from_text(text, "x.yaml")
    job = replace(job, psi_reference=None) if reference is None else job
    profile = Profile.straight(0.03, 0.1, 0.2, 0.4)
    second = replace(job.holes[0], id="b", profile=profile, branch=3)
    third = replace(job.holes[0], id="c", group="rib", cycle=Cycle("peck", 0.01, dwell=0.2))
    job = replace(job, holes=(*job.holes, second, third))
    same(job, job_from_text(job_files(job)["my_job.yaml"], "y.yaml"))


def _yaml(reference: object) -> str:
    return str(list(reference)) if isinstance(reference, tuple) else str(reference)


def test_a_robot_that_does_not_ship_goes_along(tmp_path, robot, tool):
    own = replace(robot, limits=replace(robot.limits, lower=robot.limits.lower * 0.5))
    job = Job(own, tool, (Hole("a", [0.5, 0.3, 0.8], [1, 0, 0], 0.05),))
    for name, text in job_files(job).items():
        (tmp_path / name).write_text(text)
    again = read_job(tmp_path / "job.yaml")
    same(job, again)
    np.testing.assert_allclose(again.robot.limits.lower, own.limits.lower, atol=1e-12)


def test_holes_that_count_their_spins_differently_are_not_one_job(robot, tool):
    first = Hole("a", [0.5, 0.3, 0.8], [1, 0, 0], 0.05)
    job = Job(robot, tool, (first, replace(first, id="b", psi_zero=np.array([0.0, 0.6, 0.8]))))
    with pytest.raises(InputError, match="different directions"):
        job_files(job)
