"""Parts and fixtures that are probably not what was meant: warned of, with the cure."""

from __future__ import annotations

import numpy as np
import pytest

from zerorev.files.io import job_from_dict, read_job
from zerorev.files.job_data import job_files
from zerorev.files.moved_job import write_job
from zerorev.planning.likely_mistakes import likely_mistakes

trimesh = pytest.importorskip("trimesh")

HOLE = {"id": "a", "target_mm": [0, 0, -5], "direction": [0, 0, -1], "depth_mm": 10}
FRAME = {"xyz_mm": [500, 100, 700], "rpy_deg": [0, -60, 0]}
JOB = {
    "robot": "kuka_kr6_r700_2",
    "tool": "thesis_drill",
    "part_frame": FRAME,
    "holes": [HOLE],
    "psi_reference": "part_y",
}


@pytest.fixture
def folder(tmp_path):
    for name, size in (("mm", (300, 200, 10)), ("m", (0.3, 0.2, 0.01))):
        sheet = trimesh.creation.box(size)
        sheet.apply_translation((0, 0, -size[2] / 2))
        sheet.export(tmp_path / f"{name}.stl")
    return tmp_path


def said(folder, **keys):
    return [(one.kind, one.message) for one in likely_mistakes(job_from_dict(JOB | keys, folder))]


def test_a_part_that_fits_is_not_warned_of(folder):
    assert said(folder, part="mm.stl") == []


def test_metres_taken_for_millimetres(folder):
    ((kind, message),) = said(folder, part="m.stl")
    assert kind == "units"
    assert "0.3 mm long" in message
    assert "unit" in message
    assert said(folder, part={"file": "m.stl", "unit": "m"}) == []


def test_millimetres_taken_for_metres(folder):
    (kind, message), *_ = said(folder, part={"file": "mm.stl", "unit": "m"})
    assert kind == "units"
    assert "3e+05 mm long" in message


def test_a_part_beside_its_holes(folder):
    ((kind, message),) = said(folder, part="mm.stl", holes=[HOLE | {"target_mm": [400, 0, -5]}])
    assert kind == "units"
    assert "250 mm or more beside the part" in message


def test_what_stands_in_the_base(folder):
    post = {"id": "post", "box": {"size_mm": [50, 50, 300], "xyz_mm": [100, 0, 150]}}
    ((kind, message),) = said(folder, fixtures=[post])
    assert kind == "base_column"
    assert "post touches the base" in message
    assert said(folder, fixtures=[post], floor_mm=0)  # the floor is where the base stands
    assert said(folder, floor_mm=0) == []


def test_a_job_that_is_written_keeps_what_stands_around(folder):
    around = {
        "part": "mm.stl", "floor_mm": -10.0,
        "fixtures": [{"id": "clamp", "frame": "part", "box": {"size_mm": [10, 20, 30], "xyz_mm": [0, 0, 100]}}],
        "tool": {"tcp_mm": [100, 0, 65], "rpy_deg": [0, -90, 0], "bodies": [{"id": "cover", "file": "mm.stl"}]},
    }  # fmt: skip
    job = job_from_dict(JOB | around, folder)
    (text,) = job_files(job).values()
    (folder / "again.yaml").write_text(text)
    again = read_job(folder / "again.yaml")
    assert again.settings.surroundings == job.settings.surroundings
    assert again.tool.bodies == job.tool.bodies


def test_a_job_that_is_moved_finds_its_meshes(folder):
    source = folder / "job.yaml"
    source.write_text(
        "robot: kuka_kr6_r700_2\ntool: {tcp_mm: [100, 0, 65], rpy_deg: [0, -90, 0], bodies: [{id: c, file: mm.stl}]}\n"
        "part: {file: m.stl, unit: m}\nfixtures: [{id: post, file: mm.stl}]\nholes: "
        "[{id: a, target_mm: [500, 0, 800], direction: [1, 0, 0], depth_mm: 10}]\n"
    )
    (folder / "deeper").mkdir()
    moved = np.eye(4)
    moved[:3, 3] = 0.1, 0.2, 0.3
    write_job(folder / "deeper" / "moved.yaml", source, T_base_part=moved)
    job, again = read_job(source), read_job(folder / "deeper" / "moved.yaml")
    part, post = again.settings.surroundings.obstacles
    assert part.T_base[:3, 3] == pytest.approx([0.1, 0.2, 0.3])
    assert post == job.settings.surroundings.obstacles[1]
    assert again.tool.bodies == job.tool.bodies
