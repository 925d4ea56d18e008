"""The data behind a picture of clearances agrees with distances that are found by other formulas."""

from __future__ import annotations

import base64
from dataclasses import replace

import numpy as np
import pytest

from oracles.solids import box_at, least_at
from zerorev.files.io import read_job
from zerorev.model.arm_bodies import bodies_of
from zerorev.model.body import Box, Mesh, Obstacle
from zerorev.model.profile import Profile
from zerorev.model.surroundings import Surroundings
from zerorev.motion.drilling import Drilling
from zerorev.motion.evaluation import evaluated
from zerorev.motion.links import link_frames
from zerorev.planning.clearance import clearance_of
from zerorev.planning.hole import plan
from zerorev.report.scene.cell_data import track_data
from zerorev.report.scene.clearance import clearance_zone
from zerorev.report.scene.clearance_data import least_data, nearest_data
from zerorev.report.scene.solids_data import MOST_DRAWN, solids_data
from zerorev.report.scene.twist_map_data import zone_data

BRANCH = 4
CLEARANCE = 5e-3


@pytest.fixture(scope="module")
def scene():
    job = read_job("examples/jobs/thesis_positions.yaml")
    hole = job.holes[0]
    box = box_at(hole.target + np.array([-0.15, 0.1, 0.05]), [0.05, 0.1, 0.2])
    settings = replace(job.settings, surroundings=Surroundings((box,)), clearance=CLEARANCE)
    return Drilling(job.robot, job.tool, hole), settings, box


def floats(text):
    return np.frombuffer(base64.b64decode(text), dtype="<f4")


def least(scene, joints):
    """Of the bodies that move [m], shape (n,), by formulas of their own."""
    drilling, _, box = scene
    moving = [body for body in bodies_of(drilling.robot, drilling.tool) if body.link > 0]
    return least_at(drilling.robot, moving, joints, box)


def inside(rings, point):
    """Whether a point lies in outlines, holes in them among them: a ray crosses them an odd number of times."""
    count = 0
    for ring in rings:
        (x, y), (u, v) = ring.T, np.roll(ring, -1, axis=0).T
        crossed = (y > point[1]) != (v > point[1])
        x, y, u, v = x[crossed], y[crossed], u[crossed], v[crossed]
        count += np.count_nonzero(point[0] < x + (point[1] - y) * (u - x) / (v - y))
    return count % 2 == 1


def test_the_zone_is_where_the_nearest_is_too_near(scene):
    drilling, settings, _ = scene
    zone = clearance_zone(drilling, settings, BRANCH, shape=(9, 37))
    s, p = np.meshgrid(zone.standoff, zone.psi, indexing="ij")
    joints = drilling.angles(s, p)[..., BRANCH, :]
    reached = ~np.isnan(joints[..., 0])
    assert not zone.near[~reached].any()
    apart = np.full(s.shape, np.inf)
    apart[reached] = least(scene, joints[reached])
    assert zone.near[apart < CLEARANCE - 1e-6].all()
    # besides, two bodies of the arm may meet
    assert np.count_nonzero(zone.near & (apart > CLEARANCE + 1e-6)) < 0.1 * zone.near.sum()
    assert 0.02 < zone.near.mean() < 0.9


def test_the_outline_of_the_zone_is_where_the_clearance_is_just_kept(scene):
    drilling, settings, _ = scene
    zone = clearance_zone(drilling, settings, BRANCH, shape=(41, 145))
    edge = np.concatenate(zone.region.edges)
    apart = least(scene, drilling.angles(*edge.T)[:, BRANCH])
    just = np.abs(apart - CLEARANCE) < 1e-4
    assert just.sum() > 40
    # the rest runs along what is out of reach, but where two bodies of the arm meet
    assert np.count_nonzero(~just & (apart > 0)) < 0.1 * just.sum()
    rings = zone.region.rings
    for s, p in np.ndindex(zone.near.shape[0] // 9, zone.near.shape[1] // 9):
        s, p = 9 * s + 3, 9 * p + 5
        assert inside(rings, (zone.standoff[s], zone.psi[p])) == zone.near[s, p]


def test_the_zone_as_it_is_sent(scene):
    drilling, settings, _ = scene
    zone = clearance_zone(drilling, settings, BRANCH, shape=(9, 37))
    data = zone_data(zone)
    assert np.frombuffer(base64.b64decode(data["near"]), np.uint8).tolist() == zone.near.ravel().tolist()
    ring = np.array(data["rings"][0]).reshape(-1, 2)
    assert ring == pytest.approx(zone.region.rings[0] * [1e3, np.rad2deg(1)], abs=1e-3)
    assert data["text"] == "nearer than 5 mm to part, fixtures or itself"


def test_the_nearest_points_of_a_motion_are_so_far_apart(scene):
    drilling, settings, box = scene
    standoff, psi = np.linspace(0.05, 0.0, 12), np.linspace(-0.6, 0.8, 12)
    data = nearest_data(drilling, settings, BRANCH, standoff, psi)
    apart, pair, points = (floats(data[key]) for key in ("apart_mm", "pair", "points_mm"))
    joints = drilling.angles(standoff, psi)[:, BRANCH]
    assert apart == pytest.approx(np.maximum(least(scene, joints), 0) * 1e3, abs=1e-3)
    points = points.reshape(-1, 2, 3)
    free = apart > 1
    assert free.sum() > 3
    # both on the surfaces: so they are as far apart as said, and each lies on its solid
    assert np.linalg.norm(points[:, 0] - points[:, 1], axis=1)[free] == pytest.approx(apart[free], abs=1e-2)
    bodies = {body.id: body for body in bodies_of(drilling.robot, drilling.tool)}
    for n in np.flatnonzero(free):
        name, other = data["pairs"][int(pair[n])]
        assert other == "box"
        body = bodies[name]
        T = link_frames(drilling.robot, joints[n])[body.link - 1] @ body.T_link
        a, b = body.shape.ends @ T[:3, :3].T + T[:3, 3]
        point = points[n, 0] * 1e-3
        share = np.clip((point - a) @ (b - a) / max((b - a) @ (b - a), 1e-12), 0, 1)
        assert np.linalg.norm(point - a - share * (b - a)) == pytest.approx(body.shape.radius, abs=1e-5)
        local = np.abs(np.linalg.inv(box.T_base)[:3] @ np.append(points[n, 1] * 1e-3, 1))
        assert (local <= box.shape.size / 2 + 1e-6).all()


def test_a_pose_out_of_reach_has_no_nearest_points(scene):
    drilling, settings, _ = scene
    far = replace(drilling, hole=replace(drilling.hole, target=drilling.hole.target * 0.62))
    standoff = np.linspace(0, 0.05, 40)
    reached = ~np.isnan(far.angles(standoff, 0 * standoff)[:, BRANCH, 0])
    data = nearest_data(far, settings, BRANCH, standoff, 0 * standoff)
    assert ((floats(data["pair"]) >= 0) == reached).all()


@pytest.fixture(scope="module")
def clamped():
    job = read_job("examples/jobs/panel_clamped/job.yaml")
    return job, plan(job.robot, job.tool, job.holes[4], job.settings)


def test_the_least_clearance_is_that_of_the_plan(clamped):
    job, answer = clamped
    drilling = Drilling.of(job, answer.hole)
    data = least_data(drilling, job.settings, answer.motion)
    assert data["least"] == f"{answer.clearance.least * 1e3:.2f}"
    assert data["between"] == "forearm – part"
    assert (data["where"], data["x"], data["low"], data["why"]) == ("at the target", 0.0, False, "")
    assert data["psi"] == pytest.approx(np.rad2deg(answer.motion.profile.psi[1]), abs=1e-6)


@pytest.mark.parametrize(("start", "target", "end", "leg"), [(-40, 0, 20, "plunge"), (20, 0, -40, "retract")])
def test_a_motion_by_hand_has_a_least_clearance_too(clamped, start, target, end, leg):
    job, answer = clamped
    drilling = Drilling.of(job, answer.hole)
    plain = answer.motion.profile
    profile = Profile.straight(answer.hole.depth, *(plain.psi[1] + np.deg2rad([start, target, end])).tolist())
    motion = evaluated(drilling, profile, answer.motion.branch, job.settings).motion
    assert motion is not None
    wanted = clearance_of(drilling, job.settings, motion)
    found, fast = (least_data(drilling, job.settings, motion, fast=each) for each in (False, True))
    assert float(found["least"]) == pytest.approx(wanted.least * 1e3, abs=5e-3)
    assert float(fast["least"]) >= float(found["least"]) - 0.01  # of the stroke alone
    assert (found["x"] < 0) == (leg == "plunge")
    assert leg in found["where"] or "stroke" in found["where"]
    low = least_data(drilling, replace(job.settings, clearance=wanted.least + 1e-3), motion)
    assert low["low"]
    assert f"comes within {wanted.least * 1e3:.2f} mm of {wanted.between[1]}" in low["why"]


def test_the_solids_are_those_of_the_job(clamped):
    job, answer = clamped
    data = solids_data(job.robot, job.tool, job.settings)
    assert [body["id"] for body in data["bodies"]] == [body.id for body in bodies_of(job.robot, job.tool)]
    assert [(one["id"], one["kind"], one["shape"]) for one in data["obstacles"]] == [
        ("part", "part", "mesh"), ("left clamp", "fixture", "box"), ("right clamp", "fixture", "box"),
    ]  # fmt: skip
    assert data["obstacles"][1]["size"] == pytest.approx([50, 30, 60])
    assert data["floor_mm"] is None
    part = job.settings.surroundings.part.shape
    vertices = floats(data["obstacles"][0]["vertices_mm"]).reshape(-1, 3)
    assert vertices == pytest.approx(part.vertices * 1e3, abs=1e-4)
    track = track_data(
        Drilling.of(job, answer.hole), answer.motion.profile, answer.motion.branch, job.settings, near=True
    )
    assert floats(track["nearest"]["apart_mm"]).min() == pytest.approx(answer.clearance.least * 1e3, abs=0.01)


def test_a_floor_has_a_height_and_a_fine_mesh_is_drawn_coarser(scene):
    drilling, settings, _ = scene
    u = np.linspace(0, 0.4, 180)
    x, y = np.meshgrid(u, u, indexing="ij")
    k = np.arange(x.size).reshape(x.shape)
    faces = np.concatenate(
        [np.stack([k[:-1, :-1], k[1:, :-1], k[1:, 1:]], -1), np.stack([k[:-1, :-1], k[1:, 1:], k[:-1, 1:]], -1)]
    ).reshape(-1, 3)
    mesh = Mesh(np.stack([x, y, 0.01 * np.sin(20 * x)], axis=-1).reshape(-1, 3), faces)
    T = np.eye(4)
    T[2, 3] = -0.52
    around = (Obstacle("sheet", "part", mesh), Obstacle("floor", "floor", Box(np.array([40.0, 40.0, 1.0])), T))
    data = solids_data(drilling.robot, drilling.tool, replace(settings, surroundings=Surroundings(around)))
    assert data["floor_mm"] == pytest.approx(-20)
    (sheet,) = data["obstacles"]
    faces = np.frombuffer(base64.b64decode(sheet["faces"]), "<u4").reshape(-1, 3)
    vertices = floats(sheet["vertices_mm"]).reshape(-1, 3)
    assert MOST_DRAWN / 4 < len(faces) <= MOST_DRAWN < len(mesh.faces)
    assert np.ptp(vertices, axis=0) == pytest.approx([400, 400, 20], abs=6)
    one, two, three = vertices[faces].transpose(1, 0, 2)
    area = np.linalg.norm(np.cross(two - one, three - one), axis=1).sum() / 2
    assert area == pytest.approx(400 * 400, rel=0.03)


def test_nothing_stands_around(scene):
    drilling, settings, _ = scene
    bare = replace(settings, surroundings=Surroundings())
    assert solids_data(drilling.robot, drilling.tool, bare) is None
    assert clearance_zone(drilling, bare, BRANCH) is None
    assert nearest_data(drilling, bare, BRANCH, np.zeros(1), np.zeros(1)) is None
    assert least_data(drilling, settings, None) is None
