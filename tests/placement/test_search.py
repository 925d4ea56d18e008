"""Where a part should stand: planted optima, brute force, and the real robot; the job that is written really drills."""

from __future__ import annotations

import json
from dataclasses import replace
from itertools import product

import numpy as np
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

import zerorev as zr
from oracles.places import JOBS
from zerorev import cli
from zerorev.errors import InputError
from zerorev.files.io import job_from_dict
from zerorev.files.moved_job import write_job
from zerorev.files.yaml_text import yaml_document, yaml_text
from zerorev.model._arrays import rotation_rpy, transform
from zerorev.model.hole import Hole
from zerorev.model.job import Job, Settings
from zerorev.placement.freedom import AXES, Freedom, frame_at, job_at
from zerorev.placement.search import KEPT, place, placements
from zerorev.report.words.placement import placement_data, placement_lines
from zerorev.search.deepest import Deepest, deepest_stroke
from zerorev.workers import Machines

OFF = Settings(min_rate=0.0)
TURNED = transform(rotation_rpy(0.1, -0.2, 0.5), np.array([0.5, 0.3, 0.8]))


def pattern(robot, tool, T=TURNED, depth=0.05, corners=((0, 0), (0.1, 0), (0, 0.06), (0.1, 0.06))):
    """A plate of holes in its XY plane, drilled along its X."""
    holes = [
        Hole(f"H{k}", T[:3, :3] @ [0.0, *yz] + T[:3, 3], T[:3, :3] @ [1.0, 0, 0], depth) for k, yz in enumerate(corners)
    ]
    return Job(robot, tool, tuple(holes), OFF, T)


@pytest.fixture
def planted(monkeypatch):
    """Set the rule by which a hole has its deepest stroke; counts how often it was asked."""

    def plant(rule):
        asked = []

        def deepest(drilling, settings):
            asked.append(drilling.hole.id)
            return Deepest(max(0.0, float(rule(drilling.hole))))

        monkeypatch.setattr("zerorev.placement.margins.deepest_in_cycle", deepest)
        return asked

    return plant


class TestFreedom:
    @pytest.mark.parametrize(
        "given", [{"x": (0.1, 0.0)}, {"z": (np.nan, 0.0)}, {"y": (0.0, np.inf)}, {"turn": (0.0, 7.0)}, {"x": (0, 0, 0)}]
    )
    def test_ranges_that_are_none(self, given):
        with pytest.raises(InputError, match=next(iter(given))):
            Freedom(**given)

    def test_the_grid_holds_every_corner_once_and_begins_in_the_middle(self):
        freedom = Freedom(x=(-0.1, 0.3), turn=(0.0, 1.0))
        places = freedom.grid(5)
        assert places.shape == (25, 4)
        assert len({tuple(place) for place in places}) == 25
        np.testing.assert_allclose(places[0], [0.1, 0, 0, 0.5], atol=1e-5)
        assert {tuple(place[[0, 3]]) for place in places} >= set(product((-0.1, 0.3), (0.0, 1.0)))

    def test_ends_and_what_widens_them(self):
        freedom = Freedom(x=(-0.1, 0.3), y=(0.2, 0.2), turn=(-1.0, 1.0))
        assert freedom.ends_at(np.array([0.3, 0.2, 0.0, -1.0])) == [(0, 1), (3, 0)]
        assert freedom.ends_at(np.array([0.298, 0.2, 0.0, 0.99])) == []
        assert freedom.widened(0, 1) == pytest.approx((-0.1, 0.7))
        assert freedom.widened(0, 0) == pytest.approx((-0.5, 0.3))
        assert freedom.widened(3, 0) == pytest.approx((-3.0, 1.0))
        wide = Freedom(turn=(-2.0, 2.0)).widened(3, 1)
        assert wide == pytest.approx((-2.0, 2 * np.pi - 2.0))
        assert Freedom(turn=wide).ends_at(np.array([0, 0, 0, wide[1]])) == []  # a full turn ends nowhere

    def test_no_freedom_is_one_place(self):
        np.testing.assert_array_equal(Freedom(y=(0.2, 0.2)).grid(7), [[0, 0.2, 0, 0]])


class TestMoved:
    @pytest.mark.parametrize("reference", ["base_y", "nearest_base", "part_x", "part_y", [0.0, 1.0, 1.0]])
    def test_a_moved_job_is_the_job_file_with_that_part_frame(self, reference):
        hole = {"id": "A", "target_mm": [10, 20, 30], "direction": [0.5, 0.2, -1], "depth_mm": 20}
        data = {"robot": "kuka_kr6_r700_2", "tool": "thesis_drill", "psi_reference": reference, "holes": [hole]}
        job = job_from_dict(data | {"part_frame": {"xyz_mm": [400, 100, 700], "rpy_deg": [10, -20, 30]}})
        moved = job_at(job, np.array([0.01, -0.02, 0.03, np.deg2rad(25)]))
        again = job_from_dict(data | {"part_frame": {"xyz_mm": [410, 80, 730], "rpy_deg": [10, -20, 55]}})
        np.testing.assert_allclose(moved.T_base_part, again.T_base_part, atol=1e-12)
        for name in ("target", "direction", "psi_zero"):
            ours, theirs = (getattr(each.holes[0], name) for each in (moved, again))
            np.testing.assert_allclose(ours, theirs, atol=1e-9)

    def test_without_a_reference_psi_zero_turns_with_the_part(self, robot, tool):
        moved = job_at(pattern(robot, tool, np.eye(4)), np.array([0, 0, 0, np.pi / 2]))
        np.testing.assert_allclose(moved.holes[0].psi_zero, [-1, 0, 0], atol=1e-12)


class TestPlanted:
    wanted = np.array([0.0234, -0.0411, 0.0152, np.deg2rad(7.3)])

    def test_one_best_place_in_four_dimensions(self, robot, tool, planted):
        job = pattern(robot, tool)
        best = {hole.id: hole for hole in job_at(job, self.wanted).holes}
        planted(lambda hole: 0.08 - 4 * np.sum((hole.target - best[hole.id].target) ** 2))
        found = place(job, Freedom((-0.1, 0.1), (-0.1, 0.1), (-0.1, 0.1), (-0.4, 0.4)), grid=4)
        assert found.finished
        assert found.least == pytest.approx(0.03, abs=2e-6)
        np.testing.assert_allclose(found.place[:3], self.wanted[:3], atol=6e-4)
        assert found.place[3] == pytest.approx(self.wanted[3], abs=np.deg2rad(1))  # flat: 1 deg is 4 um

    def test_holes_that_pull_apart(self, robot, tool, planted):
        # of x the holes make a roof whose ridge is at 17 mm, of z one whose ridge is at -20 mm
        job = pattern(robot, tool)
        sides = {"H0": (0.3, 17, 0), "H1": (-0.5, 17, 0), "H2": (0.2, -20, 2), "H3": (-0.9, -20, 2)}
        here = {hole.id: hole.target for hole in job.holes}

        def rule(hole):
            slope, ridge, axis = sides[hole.id]
            return 0.06 + slope * (hole.target - here[hole.id] - ridge / 1e3)[axis]

        planted(rule)
        found = place(job, Freedom((-0.1, 0.1), (-0.05, 0.05), (-0.1, 0.1)), grid=4)
        assert found.least == pytest.approx(0.01, abs=2e-5)
        np.testing.assert_allclose(found.place[[0, 2]], [0.017, -0.02], atol=1e-4)

    def test_the_room_ends_where_a_hole_is_too_shallow(self, robot, tool, planted):
        job = pattern(robot, tool)
        here = job.holes[0].target
        planted(lambda hole: 0.08 - abs(hole.target[0] - here[0]) if hole.id == "H0" else 0.09)
        found = place(job, Freedom((-0.01, 0.1), (-0.02, 0.02)), grid=12)
        assert found.least == pytest.approx(0.03, abs=1e-9)
        assert found.place[0] == 0
        np.testing.assert_allclose(found.room[0], [-0.01, 0.03], atol=1e-4)
        np.testing.assert_allclose(found.place[1] + found.room[1], [-0.02, 0.02], atol=1e-12)
        assert found.room[0, 1] <= 0.03

    def test_slices_are_the_least_margin_everywhere(self, robot, tool, planted):
        job = pattern(robot, tool)
        rule = {"H0": lambda t: 0.06 - t[0] + t[1], "H1": lambda t: t[2], "H2": lambda t: 0.5, "H3": lambda t: t[0]}
        planted(lambda hole: rule[hole.id](hole.target))
        found = place(job, Freedom((-0.6, 0.1), (-0.1, 0.1), turn=(-0.1, 0.1)), grid=3, cells=4)
        assert [each.axes for each in found.slices] == [("x", "y"), ("x", "turn"), ("y", "turn")]
        for each in found.slices:
            for index in np.ndindex(each.margin.shape):
                there = found.place.copy()
                for axis, values, n in zip(each.axes, each.values, index, strict=True):
                    there[AXES.index(axis)] = values[n]
                holes = job_at(job, there).holes
                least = min(max(0.0, rule[hole.id](hole.target)) - hole.depth for hole in holes)
                assert each.margin[index] == pytest.approx(least, abs=1e-12)

    def test_few_holes_are_examined_where_one_is_always_the_worst(self, robot, tool, planted):
        job = pattern(robot, tool)
        asked = planted(lambda hole: hole.target[0] - 0.3 * (hole.id == "H3"))
        after = {}
        place(job, Freedom((-0.1, 0.1), (-0.1, 0.1)), grid=12,
              progress=lambda phase, done, total: after.setdefault((phase, done == total), len(asked)))  # fmt: skip
        assert 144 <= after["coarse grid", True] < 0.7 * 4 * 144

    def test_nothing_can_be_drilled(self, robot, tool, planted):
        planted(lambda hole: 0.0)
        found = place(pattern(robot, tool), Freedom((-0.1, 0.1)), grid=3)
        assert found.least == -0.05
        assert found.room is None
        assert found.finished

    def test_a_reference_along_the_drill_axis_is_not_a_place(self, robot, tool, planted):
        planted(lambda hole: 0.1)
        job = replace(pattern(robot, tool, np.eye(4)), psi_reference="base_y")
        found = place(job, Freedom(turn=(0.0, np.pi)), grid=3, cells=3)
        assert found.least == pytest.approx(0.05)
        np.testing.assert_allclose(found.slices[0].margin, [0.05, -0.05, 0.05])

    def test_what_is_known_only_gets_better(self, robot, tool, planted):
        job = pattern(robot, tool)
        planted(lambda hole: 0.1 - 3 * np.sum((hole.target - [0.55, 0.3, 0.8]) ** 2))
        known = list(placements(job, Freedom((-0.1, 0.1), (-0.1, 0.1)), grid=9, cells=3))
        margins = [each.least for each in known]
        assert margins == sorted(margins)
        assert [each.finished for each in known] == [False] * (len(known) - 1) + [True]

    def test_a_best_place_at_an_end_says_which_range_to_widen(self, robot, tool, planted):
        job = pattern(robot, tool)
        ridge = job.holes[0].target[2] + 0.15
        planted(lambda hole: 0.2 - abs(hole.target[2] - ridge) if hole.id == "H0" else 0.25)

        def said(freedom):
            found = place(job, freedom, grid=4)
            return found, [line.plain for line in placement_lines(job, freedom, found) if "widen" in line.plain]

        narrow, (words,) = said(Freedom((-0.02, 0.02), z=(-0.05, 0.1)))
        assert "at the stop of --z-mm, and" in words
        assert placement_data(job, Freedom(z=(-0.05, 0.1)), narrow)["best"]["at_end_of"] == {"z_mm": "stop"}
        low, high = (float(end) / 1e3 for end in words.rpartition("--z-mm=")[2].split(":"))
        wide, none = said(Freedom((-0.02, 0.02), z=(low, high)))
        assert none == []
        assert wide.place[2] == pytest.approx(0.15, abs=5e-4)
        assert wide.least > narrow.least + 0.04

    def test_nothing_to_vary_is_refused(self, robot, tool):
        with pytest.raises(InputError, match=r"nothing may be varied.*START:STOP"):
            place(pattern(robot, tool), Freedom(x=(0.1, 0.1)))

    @pytest.mark.parametrize("wrong", [{"grid": 1}, {"cells": 1}, {"cells": -1}])
    def test_no_grid(self, robot, tool, wrong):
        with pytest.raises(InputError, match=r"grid|cells"):
            place(pattern(robot, tool), Freedom(), **wrong)

    def test_a_given_motion_is_refused(self, robot, tool):
        job = pattern(robot, tool)
        given = replace(job.holes[0], profile=zr.Profile(np.array([0.05, 0, 0.05]), np.zeros(3)))
        with pytest.raises(InputError, match="given motion"):
            place(replace(job, holes=(given, *job.holes[1:])), Freedom())


HIGH = transform(np.eye(3), np.array([0.5, 0.32, 1.1]))
ROW = ((0, 0), (0.03, 0), (0, 0.03))


class TestReal:
    freedom = Freedom(y=(-0.06, 0.06), z=(-0.25, 0.0))

    def brute(self, job, grid):
        """Every hole at every place, one after the other."""
        axes = [np.linspace(-0.06, 0.06, grid), np.linspace(-0.25, 0.0, grid)]
        least = np.empty((grid, grid))
        for i, j in np.ndindex(least.shape):
            moved = [replace(hole, target=hole.target + np.array([0, axes[0][i], axes[1][j]])) for hole in job.holes]
            least[i, j] = min(deepest_stroke(job.robot, job.tool, hole, OFF).depth - hole.depth for hole in moved)
        return least

    @pytest.mark.long
    def test_the_grid_against_brute_force(self, robot, tool):
        job = pattern(robot, tool, HIGH, 0.08, ROW)
        found = place(job, self.freedom, grid=4)
        brute = self.brute(job, 4)
        ours = found.found[0, :, :, 0]
        known = np.isfinite(ours)
        np.testing.assert_allclose(ours[known], brute[known], rtol=0, atol=3e-5)  # places are rounded to 0.01 mm
        assert known.sum() >= min(KEPT, (brute > -0.08).sum())
        assert brute[~known].max() <= np.sort(brute.ravel())[-KEPT] + 1e-9
        assert found.least >= brute.max() - 1e-5
        assert found.as_it_stands.min() == -0.08  # nothing there, and 200 mm below there is room
        assert found.least > 0.02

    @pytest.mark.long
    def test_workers_and_the_box_make_no_difference(self, robot, tool):
        job = pattern(robot, tool, HIGH, 0.08, ROW[:2])
        freedom = Freedom(z=(-0.2, -0.1))
        one = place(job, freedom, grid=5, cells=3)
        two = place(job, freedom, grid=5, cells=3, machines=Machines(2))
        assert json.dumps(placement_data(job, freedom, one)) == json.dumps(placement_data(job, freedom, two))
        lower = job_at(job, np.array([0.0, 0, -0.13, 0]))
        again = place(lower, Freedom(z=(-0.07, 0.03)), grid=5)
        assert frame_at(lower.T_base_part, again.place)[2, 3] == pytest.approx(
            frame_at(job.T_base_part, one.place)[2, 3], abs=1e-4
        )
        assert again.least == pytest.approx(one.least, abs=1e-5)


HOLES = [{"id": f"H{k}", "target_mm": [0, 30 * k, 0], "direction": [1, 0, 0], "depth_mm": 80} for k in range(2)]
JOB = {"robot": "kuka_kr6_r700_2", "tool": "thesis_drill", "part_frame": {"xyz_mm": [500, 300, 1140]}, "holes": HOLES}


@pytest.fixture
def job_file(tmp_path):
    """The job as a file."""

    def write(**other):
        path = tmp_path / "high.yaml"
        path.write_text(yaml.safe_dump(JOB | other))
        return path

    return write


class TestCommand:
    @pytest.mark.long
    def test_the_written_job_drills_every_hole(self, job_file, tmp_path, capsys):
        answer, moved = tmp_path / "place.json", tmp_path / "moved.yaml"
        asked = ["place", str(job_file()), "--z-mm=-260:0", "--grid", "6", "--cells", "5", "-o", str(answer)]
        assert cli.main([*asked, "--write-job", str(moved), "--figures", str(tmp_path / "fig")]) == cli.FINE
        out = capsys.readouterr().out
        for part in ("as it stands: least margin -80.0 mm (0 of 2", "best place: shift (0, 0, -", "room from there"):
            assert part in out
        data = json.loads(answer.read_text())
        assert data["format"] == "zerorev.placement/1"
        assert data["finished"]
        least = min(hole["deepest_mm"] - hole["depth_mm"] for hole in data["holes"])
        assert data["best"]["least_margin_mm"] == pytest.approx(least, abs=1e-6)
        plan = zr.verify_plan(zr.plan_job(zr.read_job(moved)))
        for hole, reported in zip(plan.holes, data["holes"], strict=True):
            assert hole.score.reversals == 0
            assert hole.verified.passed
            assert hole.deepest * 1e3 == pytest.approx(reported["deepest_mm"], abs=1e-3)
        assert (tmp_path / "fig" / "placement.png").read_bytes().startswith(b"\x89PNG")

    def test_no_place_drills_it(self, job_file, tmp_path, capsys):
        moved = tmp_path / "moved.yaml"
        asked = ["place", str(job_file()), "--z-mm", "0:30", "--grid", "2", "--write-job", str(moved)]
        assert cli.main(asked) == cli.FOUND
        said = capsys.readouterr()
        assert "80.0 mm too shallow" in said.out
        assert "no job written" in said.err
        assert not moved.exists()

    def test_ctrl_c_keeps_what_is_known(self, job_file, tmp_path, capsys, monkeypatch):
        calls = []

        def deepest(drilling, settings):
            calls.append(drilling.hole.id)
            if len(calls) > 90:
                raise KeyboardInterrupt
            return Deepest(0.5 - drilling.hole.target[1] ** 2)

        monkeypatch.setattr("zerorev.placement.margins.deepest_in_cycle", deepest)
        answer = tmp_path / "place.json"
        asked = ["place", str(job_file()), "--x-mm", "0:100", "--y-mm", "0:100", "-o", str(answer), "--workers", "1"]
        assert cli.main(asked) == cli.INTERRUPTED
        data = json.loads(answer.read_text())
        assert not data["finished"]
        assert data["holes"][0]["deepest_mm"] > 0
        assert "interrupted; the best place so far is written" in capsys.readouterr().err

    @pytest.mark.parametrize(
        "wrong",
        ["--x-mm=5:1", "--y-mm=a:b", "--z-mm=0:nan", "--turn-deg=0:400", "--x-mm=1:2:3", "--x-mm=", "--grid=1",
         "--cells=-2", "--workers=0", "--x-mm=50", "--z-mm=0:0"],
    )  # fmt: skip
    def test_freedom_that_is_none_is_one_message(self, job_file, tmp_path, capsys, wrong):
        asked = ["place", str(job_file()), wrong, "-o", str(tmp_path / "place.json")]
        assert cli.main(asked) == cli.BAD_INPUT
        err = capsys.readouterr().err
        assert err.count("error:") == 1
        assert wrong[2:].split("=")[0] in err
        assert not (tmp_path / "place.json").exists()

    @pytest.mark.parametrize(
        "other", [{"holes": []}, {"holes": [{k: v for k, v in HOLES[0].items() if k != "depth_mm"}]}]
    )
    def test_jobs_that_are_none(self, job_file, capsys, other):
        assert cli.main(["place", str(job_file(**other))]) == cli.BAD_INPUT
        assert "holes" in capsys.readouterr().err

    @pytest.mark.parametrize("option", ["-o", "--write-job"])
    def test_the_job_is_not_written_over(self, job_file, tmp_path, capsys, option):
        job = job_file()
        before = job.read_bytes()
        link = tmp_path / "link.yaml"
        link.symlink_to(job)
        for target in (job, link):
            assert cli.main(["place", str(job), option, str(target)]) == cli.BAD_INPUT
            assert "which is read" in capsys.readouterr().err
        assert job.read_bytes() == before


class TestWrittenJob:
    def test_paths_lead_where_they_led(self, tmp_path):
        (tmp_path / "a").mkdir()
        (tmp_path / "b").mkdir()
        holes = "id,x_mm,y_mm,z_mm,i,j,k,depth_mm\n1e3,1,2,3,1,0,0,20\nno,4,5,6,0,0,-1,30\n"
        (tmp_path / "a" / "holes.csv").write_text(holes)
        (tmp_path / "a" / "drill.yaml").write_text(
            yaml.safe_dump({"format": "zerorev.tool/1", "name": "d", "tcp_mm": [100, 0, 60], "rpy_deg": [0, -90, 0]})
        )
        source, target = tmp_path / "a" / "job.yaml", tmp_path / "b" / "job.yaml"
        source.write_text(yaml.safe_dump(JOB | {"holes": "holes.csv", "tool": "./drill.yaml", "blend_mm": 0.5}))
        T = transform(rotation_rpy(0.1, 0.2, 0.3), np.array([0.1, 0.2, 0.3]))
        write_job(target, source, T_base_part=T, note="moved")
        old, new = zr.read_job(source), zr.read_job(target)
        np.testing.assert_allclose(new.T_base_part, T, atol=1e-9)
        assert (new.name, new.settings) == (old.name, old.settings)
        np.testing.assert_array_equal(new.tool.T_flange_tcp, old.tool.T_flange_tcp)
        assert [hole.id for hole in new.holes] == ["1e3", "no"]
        write_job(target, source, ids={"no"})
        (kept,) = zr.read_job(target).holes
        np.testing.assert_array_equal(kept.target, old.holes[1].target)
        assert (kept.id, kept.depth) == ("no", 0.03)

    @given(
        st.recursive(
            st.none() | st.booleans() | st.integers(-(10**6), 10**6) | st.floats(allow_nan=False, allow_infinity=False)
            | st.text(st.characters(codec="utf-8", exclude_categories=("Cc", "Cs")), max_size=8)
            | st.sampled_from(["1e-3", "no", "~", "null", "1_0", "0x1", "2020-01-01", "=", "<<", "a: b", "- a", "#"]),
            lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text("abc", min_size=1), inner, max_size=3),
            max_leaves=8,
        )
    )  # fmt: skip
    def test_yaml_is_read_as_it_was_written(self, data):
        again = yaml_document(yaml_text({"key": data}), "text").data
        assert again == {"key": data}
        assert json.dumps(again) == json.dumps({"key": data})


def test_the_example_job_is_one_that_cannot_be_drilled_where_it_stands():
    job = zr.read_job(JOBS / "place_panel.yaml")
    for hole in job.holes:
        assert deepest_stroke(job.robot, job.tool, hole, job.settings).depth == 0
        lower = replace(hole, target=hole.target - [0, 0, 0.2])
        assert deepest_stroke(job.robot, job.tool, lower, job.settings).depth > 0.095
