"""Maps around the holes of a job: where their targets lie, and that each cell is what the hole there would be."""

from __future__ import annotations

import numpy as np
import pytest
import yaml

import zerorev as zr
from oracles.places import JOBS
from zerorev.cli import common as cli
from zerorev.cli import main
from zerorev.errors import InputError
from zerorev.files.io import job_from_dict
from zerorev.maps.answers import cells_of, difference, mirror_in_y
from zerorev.maps.around import task_around
from zerorev.maps.replan import hole_of, job_of
from zerorev.maps.run import run_map
from zerorev.maps.workspace import read_workspace_map
from zerorev.report.scene.map_slice import slice_of
from zerorev.search.deepest import deepest_stroke

FRAME = {"xyz_mm": [480, 150, 720], "rpy_deg": [0, -60, 0]}
JOB = {"robot": "kuka_kr6_r700_2", "tool": "thesis_drill", "part_frame": FRAME, "psi_reference": "part_y"}
SQUARE = [(-40, -30, 5), (60, -30, 5), (60, 20, 5)]


def job_of_holes(places, direction=(0, 0, -1), **other):
    """A job of holes at places of the part frame [mm], 12 mm deep."""
    holes = [{"id": f"H{n}", "target_mm": list(place), "direction": list(direction), "depth_mm": 12}
             for n, place in enumerate(places)]  # fmt: skip
    return job_from_dict(JOB | {"holes": holes} | other)


def targets(task):
    """All of its targets, base frame [m]."""
    return task.target_mm(np.arange(task.cells // len(task.directions))) / 1e3


class TestWhere:
    def test_the_plane_of_the_holes_in_the_part_frame(self):
        job = job_of_holes(SQUARE)
        found = task_around(job, margin=0.03, cell=0.02)
        np.testing.assert_allclose(found.task.axes[0], np.arange(-80, 101, 20))
        np.testing.assert_allclose(found.task.axes[1], np.arange(-60, 61, 20))
        np.testing.assert_allclose(found.task.axes[2], [5])
        np.testing.assert_allclose(found.task.T_base_part, job.T_base_part, atol=1e-12)
        # every hole lies in the plane of the targets, and within a cell of one
        points = targets(found.task)
        for hole in job.holes:
            np.testing.assert_allclose((points - hole.target) @ hole.direction, 0, atol=1e-9)
            assert np.linalg.norm(points - hole.target, axis=1).min() <= 0.02 / np.sqrt(2)
        np.testing.assert_allclose(found.task.drills[0], job.holes[0].direction, atol=1e-12)
        assert (found.off, found.own_frame, found.left_out) == (pytest.approx(0, abs=1e-9), False, ())

    def test_sizes_that_are_not_given(self):
        found = task_around(job_of_holes(SQUARE))
        assert (found.margin, found.cell) == (pytest.approx(0.05), pytest.approx(0.01))
        assert task_around(job_of_holes([(0, 0, 0), (240, 0, 0)])).margin == pytest.approx(0.12)

    def test_a_plane_that_is_none_of_the_part_frame(self):
        tilt = np.array([np.cos(0.3), 0.0, np.sin(0.3)])
        places = [np.array([0, 1, 0]) * y + tilt * x for x in (-50, 0, 50) for y in (-40, 40)]
        along = np.cross(tilt, [0, 1, 0])
        job = job_of_holes(places, along if along[2] < 0 else -along)
        found = task_around(job, cell=0.01)
        assert found.own_frame
        assert found.off < 1e-6
        points = targets(found.task)
        for hole in job.holes:
            np.testing.assert_allclose((points - hole.target) @ hole.direction, 0, atol=1e-6)
            assert np.linalg.norm(points - hole.target, axis=1).min() <= 0.0072
        np.testing.assert_allclose(found.task.directions[0], [0, 0, -1], atol=1e-9)

    @pytest.mark.parametrize("places", [[(10, 20, 3)], [(0, 0, 3), (40, 0, 3)], [(0, 0, 3), (30, 40, 3)]])
    def test_few_holes_are_drilled_squarely(self, places):
        found = task_around(job_of_holes(places))
        assert [len(axis) > 1 for axis in found.task.axes] == [True, True, False]

    def test_a_slanted_row(self):
        found = task_around(job_of_holes([(0, 0, 0), (30, 40, 20), (60, 80, 40)]))
        assert found.own_frame
        assert found.off < 1e-9
        assert found.task.directions[0] @ [0, 0, -1] > 0.9

    def test_a_curved_part_says_how_far_it_is_off(self):
        job = job_of_holes([(x, y, x * x / 500) for x in (-50, 0, 50) for y in (-50, 50)])
        found = task_around(job)
        assert 0.002 < found.off < 0.005
        assert found.own_frame

    def test_holes_out_of_reach_are_left_out(self):
        found = task_around(job_of_holes([*SQUARE, (0, -2000, 5)]))
        assert found.left_out == ("H3",)
        assert found.task.axes[1].min() > -200

    @pytest.mark.parametrize(("sizes", "where"), [((-0.001, None), "margin"), ((None, 0.0), "cell"),
                                                  ((None, 1e-5), "cell"), ((np.nan, None), "margin")])  # fmt: skip
    def test_sizes_that_are_none(self, sizes, where):
        with pytest.raises(InputError, match=where):
            task_around(job_of_holes(SQUARE), *sizes)


@pytest.fixture(scope="module")
def around(tmp_path_factory):
    """A small map around a job: the job, the map."""
    job = job_of_holes(SQUARE, min_rate_deg_per_mm=0.02)
    path = tmp_path_factory.mktemp("around") / "map.zarr"
    run_map(task_around(job, margin=0.01, cell=0.04).task, path)
    return job, read_workspace_map(path)


class TestMap:
    def test_a_cell_is_the_hole_at_its_target(self, around):
        job, found = around
        cell = {"x": 1, "y": 1, "z": 0}
        place = np.array([float(found[f"{axis}_mm"][at]) for axis, at in cell.items()]) / 1e3
        target = job.T_base_part[:3, :3] @ place + job.T_base_part[:3, 3]
        hole = hole_of(found, **cell)
        np.testing.assert_allclose(hole.target, target, atol=1e-12)
        np.testing.assert_allclose(hole.direction, job.holes[0].direction, atol=1e-12)
        np.testing.assert_allclose(hole.psi_zero, job.holes[0].psi_zero, atol=1e-12)
        there = zr.Hole("there", target, job.holes[0].direction, 0.012, job.holes[0].psi_zero)
        deepest = deepest_stroke(job.robot, job.tool, there, job.settings).depth
        assert float(found["deepest_mm"].isel(**cell, direction=0)) == pytest.approx(deepest * 1e3, abs=1e-6)
        plan = zr.plan_job(job_of(found, [cell]))
        np.testing.assert_allclose(plan.T_base_part, job.T_base_part, atol=1e-12)
        assert plan.holes[0].verified.passed
        assert plan.holes[0].score.reversals == 0

    def test_the_app_shows_it_where_it_is(self, around):
        job, found = around
        shown = slice_of(found)
        np.testing.assert_allclose((shown.position - job.holes[0].target) @ job.holes[0].direction, 0, atol=1e-9)
        np.testing.assert_allclose(shown.edges @ job.holes[0].direction, 0, atol=1e-12)
        np.testing.assert_allclose(np.linalg.norm(shown.edges, axis=1), 0.04)
        np.testing.assert_allclose(shown.drill, job.holes[0].direction, atol=1e-12)

    def test_it_has_no_mirror_and_is_compared_in_its_own_frame_alone(self, around):
        _, found = around
        assert mirror_in_y(cells_of(found)) is None
        other = found.assign_attrs(part_frame=FRAME | {"xyz_mm": [480, 150, 721]})
        assert difference(cells_of(found), cells_of(found)).change.size == found["deepest_mm"].size
        with pytest.raises(InputError, match="different frames"):
            difference(cells_of(found), cells_of(other))

    @pytest.mark.parametrize("frame", [{}, {"xyz_mm": [1, 2], "rpy_deg": [0, 0, 0]}, "no", {"xyz_mm": "abc"}])
    def test_a_frame_that_is_none_is_refused(self, around, frame):
        with pytest.raises(InputError, match="part_frame"):
            cells_of(around[1].assign_attrs(part_frame=frame))


class TestCommand:
    def test_the_panel(self, tmp_path, capsys):
        target = tmp_path / "around.zarr"
        asked = ["map", "--around", str(JOBS / "panel.yaml"), "--cell-mm", "60", "-o", str(target)]
        assert main([*asked, "--margin-mm", "0"]) == cli.FINE
        said = capsys.readouterr()
        assert "hole R9C0 left out: out of reach" in said.err
        assert "25 cells: 25 with an answer" in said.out
        assert main(["map", "show", str(target), "--figures", str(tmp_path / "figures")]) == cli.FINE
        out = capsys.readouterr().out
        assert "part frame: {xyz_mm: [480.0, 150.0, 720.0], rpy_deg: [0.0, -60.0, 0.0]}" in out
        assert "symmetry" not in out
        assert (tmp_path / "figures" / "planes.png").stat().st_size > 10_000

    @pytest.mark.parametrize(
        ("arguments", "part"),
        [([], "neither"), (["map.yaml", "--around", "job.yaml"], "both"), (["map.yaml", "--cell-mm", "5"], "--cell-mm"),
         (["--around", "none.yaml"], "none.yaml")],
    )  # fmt: skip
    def test_one_of_them(self, tmp_path, capsys, monkeypatch, arguments, part):
        monkeypatch.chdir(tmp_path)
        (tmp_path / "job.yaml").write_text(yaml.safe_dump(JOB | {"holes": []}))
        assert main(["map", *arguments, "-o", "out.zarr"]) == cli.BAD_INPUT
        said = capsys.readouterr().err
        assert part in said
        assert "Traceback" not in said
        assert not (tmp_path / "out.zarr").exists()
