"""The data behind a picture of clearances agrees with distances that are found by other formulas."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from oracles.solids import box_at, least_at
from zerorev.files.io import read_job
from zerorev.model.arm_bodies import bodies_of
from zerorev.model.surroundings import Surroundings
from zerorev.motion.drilling import Drilling
from zerorev.report.scene.clearance import clearance_zone, nearest_at, solids_of

BRANCH = 4


@pytest.fixture(scope="module")
def scene():
    job = read_job("examples/jobs/thesis_positions.yaml")
    hole = job.holes[0]
    box = box_at(hole.target + np.array([-0.15, 0.1, 0.05]), [0.05, 0.1, 0.2])
    settings = replace(job.settings, surroundings=Surroundings((box,)), clearance=5e-3)
    return Drilling(job.robot, job.tool, hole), settings, box


def test_the_zone_is_as_far_as_the_nearest(scene):
    drilling, settings, box = scene
    standoff, psi = np.meshgrid(np.linspace(0, 0.05, 4), np.linspace(-3, 3, 25), indexing="ij")
    zone = clearance_zone(drilling, settings, BRANCH, standoff, psi)
    joints = drilling.angles(standoff, psi)[..., BRANCH, :]
    assert (np.isnan(zone) == np.isnan(joints[..., 0])).all()
    moving = [body for body in bodies_of(drilling.robot, drilling.tool) if body.link > 0]
    reached = ~np.isnan(zone)
    least = least_at(drilling.robot, moving, joints[reached], box) - 5e-3
    free = zone[reached] > 0
    # where two bodies of the arm are nearer to each other than the arm is to the box, the zone is less
    assert (zone[reached][free] <= least[free] + 1e-6).all()
    assert (np.abs(zone[reached] - least)[free] < 1e-6).mean() > 0.5
    assert free.any()
    assert not free.all()


def test_the_nearest_points_are_so_far_apart(scene):
    drilling, settings, box = scene
    joints = drilling.angles(0.02, 0.3)[BRANCH]
    found = nearest_at(drilling, settings, joints)
    moving = [body for body in bodies_of(drilling.robot, drilling.tool) if body.link > 0]
    assert found.distance == pytest.approx(least_at(drilling.robot, moving, joints[None], box)[0], abs=1e-6)
    body = next(body for body in moving if body.id == found.between[0])
    apart = np.linalg.norm(found.points[0] - found.points[1])
    assert apart - body.shape.radius == pytest.approx(found.distance, abs=1e-6)
    assert found.between[1] == "box"


def test_nothing_stands_around(scene):
    drilling, settings, _ = scene
    bare = replace(settings, surroundings=Surroundings())
    assert solids_of(drilling, bare) == ((), ())
    assert clearance_zone(drilling, bare, 0, 0.0, 0.0) is None
    assert nearest_at(drilling, bare, np.zeros(6)) is None
    bodies, obstacles = solids_of(drilling, settings)
    assert {body.id for body in bodies} >= {"base", "upper arm", "forearm", "wrist", "tool", "drill"}
    assert [obstacle.id for obstacle in obstacles] == ["box"]
