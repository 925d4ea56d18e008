"""Map files: what they ask, and what is wrong with those that ask what cannot be."""

from __future__ import annotations

import numpy as np
import pytest
import yaml

from zerorev.errors import InputError
from zerorev.files.map_file import read_map_file
from zerorev.maps.chunks import Chunks
from zerorev.model.job import Settings
from zerorev.model.map_task import cone, sphere

PLANE = {
    "robot": "kuka_kr6_r700_2",
    "tool": "thesis_drill",
    "targets": {"x_mm": [500], "y_mm": {"start": -400, "stop": 400, "step": 100}, "z_mm": [900, 400]},
    "directions": [[2, 0, 0], [1, 0, -1]],
}


def read(folder, **changes):
    path = folder / "map.yaml"
    given = {key: value for key, value in (PLANE | changes).items() if value is not None}
    path.write_text(yaml.safe_dump(given))
    return read_map_file(path)


def test_a_box(tmp_path):
    task = read(tmp_path)
    assert task.dims == ("x", "y", "z", "direction")
    assert task.shape == (1, 9, 2, 2)
    assert task.axes[1].tolist() == list(range(-400, 401, 100))
    assert task.target_mm(1).tolist() == [500, -400, 400]
    assert task.directions[1] == pytest.approx(np.array([1, 0, -1]) / np.sqrt(2))


def test_its_settings_are_those_of_a_job(tmp_path):
    assert read(tmp_path).question.settings == Settings()
    given = {"legs": "free", "min_rate_deg_per_mm": 0.02, "psi_bound_deg": 90, "max_twist_deg_per_mm": 3}
    task = read(tmp_path, limit_margin_deg=2.5, **given)
    assert task.question.settings == Settings(
        legs="free", min_rate=np.deg2rad(20.0), psi_bound=np.pi / 2, max_twist=np.deg2rad(3e3),
        limit_margin=np.deg2rad(2.5),
    )  # fmt: skip
    with pytest.raises(InputError, match="limit_margin_deg"):
        read(tmp_path, limit_margin_deg=500)  # no joint has so wide a range


def test_a_range_ends_where_a_step_meets_its_stop(tmp_path):
    def z(start, stop, step):
        targets = PLANE["targets"] | {"z_mm": {"start": start, "stop": stop, "step": step}}
        return read(tmp_path, targets=targets).axes[2].tolist()

    assert z(0.1, 0.4, 0.1) == pytest.approx([0.1, 0.2, 0.3, 0.4])
    assert z(0, 95, 30) == [0, 30, 60, 90]
    assert z(5, 5, 1) == [5]


def test_points(tmp_path):
    (tmp_path / "points.csv").write_text("x_mm,id,y_mm,z_mm\n500,A,300,800\n200,B,400,600\n")
    task = read(tmp_path, targets=None, points="points.csv")
    assert task.dims == ("point", "direction")
    assert task.ids == ("A", "B")
    assert task.target_mm(1).tolist() == [200, 400, 600]


@pytest.mark.parametrize("count", [1, 2, 7, 100])
def test_a_cone_holds_its_axis_its_rim_and_nothing_beyond(count):
    axis, half = np.array([1.0, 2.0, -3.0]), np.deg2rad(25)
    found = cone(axis, half, count)
    assert found.shape == (count, 3)
    assert np.linalg.norm(found, axis=1) == pytest.approx(1)
    away = np.arccos(np.clip(found @ axis / np.linalg.norm(axis), -1, 1))
    assert away[0] == pytest.approx(0, abs=1e-7)
    assert away.max() <= half + 1e-7
    assert count == 1 or away[-1] == pytest.approx(half)


def test_a_sphere_is_covered_evenly():
    found = sphere(400)
    assert np.linalg.norm(found, axis=1) == pytest.approx(1)
    assert np.abs(found.mean(axis=0)).max() < 2e-3
    apart = np.arccos(np.clip(found @ found.T, -1, 1))
    np.fill_diagonal(apart, np.inf)
    nearest = apart.min(axis=1)
    # of hexagons that share the sphere out, neighbours are sqrt(8 pi / (sqrt(3) N)) apart
    ideal = np.sqrt(8 * np.pi / np.sqrt(3) / 400)
    assert nearest.min() > 0.7 * ideal
    assert nearest.max() <= 1.01 * ideal


TARGETS = PLANE["targets"]


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"targets": None}, "neither targets nor points"),
        ({"points": "p.csv"}, "both targets and points"),
        ({"targets": None, "points": "none.csv"}, "no such file"),
        ({"targets": TARGETS | {"x_mm": []}}, "targets.x_mm: has 0 entries"),
        ({"targets": TARGETS | {"x_mm": 500}}, "targets.x_mm"),
        ({"targets": TARGETS | {"x_mm": [500, 500]}}, "a value appears twice"),
        ({"targets": TARGETS | {"z_mm": {"start": 900, "stop": 400, "step": 100}}}, "so the box is empty"),
        ({"targets": TARGETS | {"z_mm": {"start": 400, "stop": 900, "step": 0}}}, "targets.z_mm.step: 0 is too small"),
        ({"targets": TARGETS | {"z_mm": {"start": 400, "stop": 900, "step": -5}}}, "above 0 [mm]"),
        ({"targets": TARGETS | {"z_mm": {"start": 0, "stop": 1e30, "step": 1}}}, "1e+06 is the most"),
        ({"targets": TARGETS | {"z_mm": {"start": 0, "stop": 1e6, "step": 1e-6}}}, "or less"),
        ({"targets": {axis: {"start": 0, "stop": 1e4, "step": 1} for axis in TARGETS}}, "cells (accepted: 100,000,000"),
        ({"targets": {"x_mm": [0, 10], "y_mm": [0], "z_mm": [100, 200]}}, "every target lies inside the robot's base"),
        ({"directions": [[1, 0, 0], [0, 0, 0]]}, "directions, [1]: the zero vector has no direction"),
        ({"directions": []}, "directions: has 0 entries"),
        ({"directions": [[0, 1, 0]]}, "directions[0]: base_y is parallel to the drill axis"),
        ({"directions": {"cone": {"axis": [0, 0, 0], "half_angle_deg": 10, "count": 3}}}, "has no direction"),
        ({"directions": {"cone": {"axis": [1, 0, 0], "half_angle_deg": 0, "count": 3}}}, "half_angle_deg: 0"),
        ({"directions": {"sphere": 0}}, "directions.sphere: 0 is too small"),
        ({"quantity": "depth"}, "quantity: 'depth' is not among the choices"),
        ({"quantity": "least_travel"}, "depth_mm: is missing"),
        ({"depth_mm": 20}, "depth_mm: is not used by deepest"),
        ({"seed": 1}, "seed: is not used by deepest"),
        ({"quantity": "thesis_stepping", "legs": "free"}, "legs: free (accepted: straight"),
        ({"robot": "r2d2"}, "unknown robot 'r2d2'"),
        ({"psi_bound": 180}, "did you mean 'psi_bound_deg'?"),
        ({"format": "zerorev.job/1"}, "format: zerorev.map_file/1"),
    ],
    ids=str,
)
def test_what_cannot_be_mapped(tmp_path, changes, said):
    with pytest.raises(InputError) as refused:
        read(tmp_path, **changes)
    assert said in str(refused.value)
    assert "map.yaml" in str(refused.value) or "none.csv" in str(refused.value)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("id,x_mm,y_mm,z_mm\n", "no points"),
        ("id,x_mm,y_mm\nA,1,2\n", "no column z_mm"),
        ("id,x_mm,y_mm,z_mm\nA,1,2,inf\n", "line 2, column z_mm"),
        ("id,x_mm,y_mm,z_mm\nA,1,2,3\nA,4,5,6\n", "the id 'A' is used twice"),
    ],
    ids=str,
)
def test_points_that_cannot_be_mapped(tmp_path, text, said):
    (tmp_path / "points.csv").write_text(text)
    with pytest.raises(InputError, match=r"points\.csv") as refused:
        read(tmp_path, targets=None, points="points.csv")
    assert said in str(refused.value)


def test_targets_in_the_base_are_counted(tmp_path):
    targets = {"x_mm": [0, 50, 500], "y_mm": [0, 40], "z_mm": [100, 399, 400]}
    task = read(tmp_path, targets=targets, directions=[[1, 0, 0]])
    by_hand = [
        (x, y, z) for x in (0, 50, 500) for y in (0, 40) for z in (100, 399, 400) if np.hypot(x, y) < 75 and z < 400
    ]
    assert task.base_radius_mm == pytest.approx(75), "25 mm to axis 2, and 50 mm of body"
    assert task.cells_in_base == len(by_hand)
    assert task.in_base(task.target_mm(np.arange(18))).sum() == len(by_hand)


@pytest.mark.parametrize("shape", [(1, 9, 9, 1), (7, 5, 3, 2), (100, 100, 20, 5), (1, 1, 1, 1), (3, 1, 1000, 1)])
def test_chunks_share_out_every_cell_once(tmp_path, shape):
    axes = {name: (1000.0 + np.arange(n)).tolist() for name, n in zip(("x_mm", "y_mm", "z_mm"), shape, strict=False)}
    task = read(tmp_path, targets=axes, directions={"sphere": shape[3]} if shape[3] > 1 else [[1, 0, 0]])
    chunks = Chunks.of(task)
    seen = np.zeros(task.cells, dtype=int)
    for n in range(chunks.count):
        block = chunks.block(n)
        assert len(block.cells) == np.prod(chunks.extent(n)) <= 256
        seen[block.cells] += 1
        x, y, z, d = np.unravel_index(block.cells, shape)
        assert np.array_equal(block.target, np.stack([1000.0 + x, 1000.0 + y, 1000.0 + z], axis=-1) / 1e3)
        assert np.array_equal(block.direction, task.directions[d])
    assert (seen == 1).all()
    assert task.cells < 16 or chunks.count >= 8
