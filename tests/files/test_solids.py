"""Solids in files: what is read, what is refused, and that what is written is read again the same."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from zerorev.errors import InputError
from zerorev.files.body_schema import SurroundingsForm
from zerorev.files.conversion import robot_data, tool_data
from zerorev.files.io import job_from_dict, plan_from_text, plan_to_json, read_job
from zerorev.files.meshes import mesh_from_text, mesh_text, read_mesh
from zerorev.files.solids import surroundings_data, surroundings_from
from zerorev.files.text import json_text
from zerorev.model.body import Body, Box, Capsule, Mesh
from zerorev.model.plan import HolePlan, Plan
from zerorev.model.surroundings import Surroundings

trimesh = pytest.importorskip("trimesh")

HOLE = {"id": "a", "target_mm": [500, 300, 800], "direction": [1, 0, 0], "depth_mm": 10}
JOB = {"robot": "kuka_kr6_r700_2", "tool": "thesis_drill", "holes": [HOLE]}
FRAME = {"xyz_mm": [500, 300, 800], "rpy_deg": [0, 90, 0]}


@pytest.fixture
def folder(tmp_path):
    trimesh.creation.box((300, 200, 10)).export(tmp_path / "sheet.stl")
    open_mesh = trimesh.creation.box((300, 200, 10))
    open_mesh.update_faces(np.arange(12) > 3)  # without two of its sides
    open_mesh.export(tmp_path / "open.stl")
    inverted = trimesh.creation.box((300, 200, 10))
    inverted.invert()
    inverted.export(tmp_path / "inverted.stl")
    return tmp_path


def read(folder, **keys):
    return job_from_dict(JOB | keys, folder).settings.surroundings


def test_part_fixtures_and_floor_are_placed(folder):
    around = read(
        folder, part_frame=FRAME, part="sheet.stl", floor_mm=-50,
        fixtures=[
            {"id": "clamp", "frame": "part", "box": {"size_mm": [10, 20, 30], "xyz_mm": [0, 0, 100]}},
            {"id": "post", "file": "sheet.stl", "unit": "in", "xyz_mm": [0, 0, 5]},
        ],
    )  # fmt: skip
    part, clamp, post, floor = around.obstacles
    assert [one.kind for one in around.obstacles] == ["part", "fixture", "fixture", "floor"]
    assert part.shape.extent == pytest.approx([0.3, 0.2, 0.01])
    assert part.T_base[:3, 3] == pytest.approx([0.5, 0.3, 0.8])
    assert clamp.T_base[:3, 3] == pytest.approx([0.6, 0.3, 0.8])  # z of the part lies along x of the base
    assert post.shape.extent == pytest.approx(np.array([0.3, 0.2, 0.01]) * 25.4)
    assert post.T_base[:3, 3] == pytest.approx([0, 0, 5e-3])
    assert floor.T_base[2, 3] + floor.shape.size[2] / 2 == pytest.approx(-0.05)


@pytest.mark.parametrize("name", ["open.stl", "inverted.stl"])
def test_a_mesh_need_not_be_closed_nor_turned_outwards(folder, name):
    assert len(read(folder, part=name).part.shape.faces) in (8, 12)


def test_what_is_written_is_read_again_to_the_last_bit(folder):
    around = read(
        folder, part_frame={"xyz_mm": [481.3, 150.7, 720], "rpy_deg": [1, -60, 13]}, part="sheet.stl", floor_mm=3,
        fixtures=[{"id": "clamp", "frame": "part", "box": {"size_mm": [10, 20, 30], "rpy_deg": [7, 8, 9]}}],
    )  # fmt: skip
    data = surroundings_data(around)
    again = surroundings_from(SurroundingsForm.model_validate(data))
    assert again == around
    assert surroundings_data(again) == data
    assert surroundings_data(Surroundings()) == {"part": None, "fixtures": [], "floor_mm": None}


def test_bodies_of_robot_and_tool_stay_in_the_plan(folder):
    tool = {
        "tcp_mm": [100, 0, 65], "rpy_deg": [0, -90, 0],
        "bodies": [
            {"id": "drill", "frame": "tcp", "capsule": {"from_mm": [0, 0, 3], "to_mm": [0, 0, 90], "radius_mm": 3},
             "touches_part": True},
            {"id": "motor", "box": {"size_mm": [80, 60, 120], "xyz_mm": [0, 0, 60]}},
            {"id": "cover", "file": "sheet.stl", "xyz_mm": [0, 0, 5]},
        ],
    }  # fmt: skip
    job = job_from_dict(JOB | {"tool": tool}, folder)
    drill, motor, cover = job.tool.bodies
    assert drill.touches_part
    assert not motor.touches_part
    assert drill.shape.ends[0] == pytest.approx([0.097, 0, 0.065])
    assert isinstance(cover.shape, Mesh)
    answer = HolePlan(job.holes[0], "infeasible", 0.155)
    text = json_text(plan_to_json(Plan(job.robot, job.tool, job.settings, (answer,))))
    again = plan_from_text(text, "plan")
    assert again.tool.bodies == job.tool.bodies
    assert tool_data(again.tool) == tool_data(job.tool)


def test_a_robot_file_states_its_bodies(folder, robot):

    stated = replace(robot, bodies=(Body("arm", 2, Capsule(np.array([[0, 0, 0], [0, 0, 0.3]]), 0.08)),))
    data = robot_data(stated)
    assert data["bodies"] == [
        {"id": "arm", "capsule": {"from_mm": [0, 0, 0], "to_mm": [0, 0, 300], "radius_mm": 80}, "link": 2}
    ]
    assert "bodies" not in robot_data(robot)
    assert robot_data(robot)["sha256"] != data["sha256"]


@pytest.mark.parametrize(
    ("keys", "what"),
    [
        ({"part": "missing.stl"}, "missing.stl"),
        ({"part": "sheet.txt"}, "a mesh of the kind .txt"),
        ({"part": {"file": "sheet.step", "unit": "m"}}, "states its unit"),
        ({"fixtures": [{"id": "a"}]}, "exactly one of"),
        ({"fixtures": [{"id": "a", "file": "sheet.stl", "box": {"size_mm": [1, 1, 1]}}]}, "exactly one of"),
        ({"fixtures": [{"id": "a", "box": {"size_mm": [1, 0, 1]}}]}, "size_mm"),
        ({"fixtures": [{"id": "part", "box": {"size_mm": [1, 1, 1]}}]}, "taken"),
        ({"fixtures": [{"id": "a", "box": {"size_mm": [1, 1, 1]}}] * 2}, "used twice"),
        ({"fixtures": [{"id": "a", "capsule": {}}]}, "capsule"),
    ],
)
def test_what_cannot_be_used_is_refused_in_plain_words(folder, keys, what):
    (folder / "sheet.txt").write_text("x")
    (folder / "sheet.step").write_text("x")
    with pytest.raises(InputError, match=what):
        read(folder, **keys)


@pytest.mark.parametrize("content", [b"", b"solid\nendsolid\n", b"\x00" * 90, b"solid x\nfacet normal a b c\n"])
def test_a_broken_mesh_is_refused(tmp_path, content):
    (tmp_path / "broken.stl").write_bytes(content)
    with pytest.raises(InputError, match=r"broken\.stl"):
        read_mesh(tmp_path / "broken.stl")


def test_an_altered_mesh_of_an_answer_is_refused():
    data = mesh_text(Mesh(np.eye(3), np.array([[0, 1, 2]])))
    assert mesh_from_text(**data) == Mesh(np.eye(3).astype(np.float32).astype(float), np.array([[0, 1, 2]]))
    for altered in ({"faces": data["faces"][:-4]}, {"vertices": "?"}, {"vertices": data["faces"][::-1]}):
        with pytest.raises(InputError):
            mesh_from_text(**(data | altered))


def test_a_job_without_these_keys_has_nothing_around():
    assert read_job("examples/jobs/panel.yaml").settings.surroundings == Surroundings()
    assert Box(np.ones(3)) == Box(np.ones(3))
    assert Box(np.ones(3)) != Box(np.ones(3) * 2)
