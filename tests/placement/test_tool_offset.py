"""The tool's offset: what moving it means, the curve against the exact depth, the least offset against planted ones."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from robots import TRIED
from zerorev import cli
from zerorev.errors import InputError
from zerorev.files.io import read_robot
from zerorev.model.hole import Hole
from zerorev.model.job import Job, Settings
from zerorev.model.tool import Tool
from zerorev.motion.kinematics import wrist_offset
from zerorev.placement import tool_offset
from zerorev.placement.tool_offset import OffsetCurve, least_offset, offset_curve, offset_of, with_offset
from zerorev.report.figures.offset import tool_offset as figure_of
from zerorev.report.figures.style import png
from zerorev.search.deepest import Deepest, deepest_stroke

OFF = Settings(min_rate=0.0)
POSITION_1 = Hole("position_1", np.array([0.5, 0.3, 0.8]), np.array([1.0, 0.0, 0.0]), 0.05)
ROBOTS = [read_robot(name) for name in TRIED]
lengths, angles = st.floats(-0.3, 0.3), st.floats(-np.pi, np.pi)
tools = st.builds(
    lambda p, q: Tool.from_mm_deg(tuple(1e3 * x for x in p), tuple(np.rad2deg(q))),
    st.tuples(lengths, lengths, lengths),
    st.tuples(angles, st.floats(-1.5, 1.5), angles),
)


def distance_from_axis(robot, tool):
    """Of the wrist centre from the line through the tip along the drill, by a cross product."""
    T = tool.T_flange_tcp
    return np.linalg.norm(np.cross(np.array([0, 0, -robot.arm.c4]) - T[:3, 3], T[:3, 2]))


class TestMoving:
    @given(st.sampled_from(ROBOTS), tools, st.floats(1e-3, 0.5), angles)
    def test_offset_and_angle_are_those_asked_for_and_nothing_else_moves(self, robot, tool, offset, angle):
        moved = with_offset(robot, tool, offset, angle)
        assert distance_from_axis(robot, moved) == pytest.approx(offset, abs=1e-12)
        assert wrist_offset(robot, moved) == pytest.approx(offset, abs=1e-12)
        seen = offset_of(robot, moved)
        assert seen[0] == pytest.approx(offset, abs=1e-12)
        assert np.cos(seen[1] - angle) == pytest.approx(1)
        np.testing.assert_array_equal(moved.T_flange_tcp[:3, :3], tool.T_flange_tcp[:3, :3])
        step = moved.T_flange_tcp[:3, 3] - tool.T_flange_tcp[:3, 3]
        assert step @ tool.T_flange_tcp[:3, 2] == pytest.approx(0, abs=1e-12)

    @given(st.sampled_from(ROBOTS), tools)
    def test_at_its_own_offset_and_angle_the_tool_stays(self, robot, tool):
        np.testing.assert_allclose(with_offset(robot, tool, *offset_of(robot, tool)).T_flange_tcp, tool.T_flange_tcp,
                                   atol=1e-12)  # fmt: skip

    def test_the_thesis_drill_is_offset_along_the_flange_axis(self, robot, tool):
        assert offset_of(robot, tool) == pytest.approx((0.155, 0.0))
        quarter = with_offset(robot, tool, 0.155, np.pi / 2).T_flange_tcp
        # seen along Z_tcp = -X_flange a quarter turn takes +Z to +Y
        np.testing.assert_allclose(quarter[:3, 3], [0.1, 0.155, -robot.arm.c4], atol=1e-12)

    def test_of_a_drill_along_the_flange_axis_angles_count_from_x(self, robot):
        straight = Tool.from_mm_deg((30.0, 0.0, 200.0), (180.0, 0.0, 0.0))
        assert offset_of(robot, straight) == pytest.approx((0.03, 0.0), abs=1e-9)

    def test_the_own_angle_is_kept_where_none_is_given(self, robot, tool):
        turned = with_offset(robot, tool, 0.1, 0.7)
        assert offset_of(robot, with_offset(robot, turned, 0.04)) == pytest.approx((0.04, 0.7))

    @pytest.mark.parametrize(("offset", "angle"), [(-1e-3, 0.0), (np.nan, 0.0), (np.inf, None), (0.1, np.nan)])
    def test_no_such_offset_or_angle(self, robot, tool, offset, angle):
        with pytest.raises(InputError, match=r"offset|angle"):
            with_offset(robot, tool, offset, angle)


class TestCurve:
    def test_as_theory_1_has_it(self, robot, tool):
        offsets_mm, depths_mm = [0, 3, 10, 30, 60, 100, 155], [0, 2.8, 9.3, 27.8, 51.4, 76.9, 104.6]
        curve = offset_curve(robot, tool, [POSITION_1], OFF, np.array(offsets_mm) / 1e3)
        np.testing.assert_allclose(curve.deepest[:, 0, 0] * 1e3, depths_mm, atol=0.06)
        np.testing.assert_allclose(curve.margin[:, 0] * 1e3, np.array(depths_mm) - 50, atol=0.06)

    def test_at_the_own_offset_it_is_the_depth_of_the_tool_as_it_is(self, robot, tool, positions):
        holes = [position.hole for position in positions[1:]]
        e, angle = offset_of(robot, tool)
        curve = offset_curve(robot, tool, holes, OFF, e, angle)
        exact = [deepest_stroke(robot, tool, hole, OFF).depth for hole in holes]
        np.testing.assert_allclose(curve.deepest[0, 0], exact, rtol=1e-6)

    def test_a_corner_placed_deeper_takes_its_share(self, robot, tool):
        deeper = Settings(min_rate=0.0, blend=0.01, deepen_corner=True)
        assert deeper.corner_standoff == -0.005
        curve = offset_curve(robot, tool, [POSITION_1], deeper, 0.06)
        there = replace(POSITION_1, target=POSITION_1.target + 0.005 * POSITION_1.direction)
        exact = deepest_stroke(robot, with_offset(robot, tool, 0.06), there, OFF).depth
        assert curve.deepest[0, 0, 0] == pytest.approx(exact - 0.005)

    @pytest.mark.parametrize("offsets", [[], [0.1, 0.1], [-0.1, 0.1], [0.1, np.nan]])
    def test_offsets_that_are_none(self, robot, tool, offsets):
        with pytest.raises(InputError, match="offsets"):
            offset_curve(robot, tool, [POSITION_1], OFF, offsets)


@pytest.fixture
def planted(monkeypatch, robot, tool):
    """A rule depth(e, angle) -> a job of holes 50 and 20 mm deep whose strokes keep it, and its curve."""

    def plant(depth, offsets, angles):
        def deepest(drilling, settings):
            return Deepest(float(depth(*offset_of(drilling.robot, drilling.tool))))

        monkeypatch.setattr(tool_offset, "deepest_in_cycle", deepest)
        job = Job(robot, tool, (POSITION_1, replace(POSITION_1, id="other", depth=0.02)), OFF)
        return job, offset_curve(robot, tool, job.holes, OFF, offsets, angles)

    return plant


class TestLeast:
    def test_it_is_drilled_there_and_not_a_little_below(self, robot, tool):
        job = Job(robot, tool, (POSITION_1,), OFF)
        least = least_offset(job, offset_curve(robot, tool, job.holes, OFF, [0.03, 0.06]))
        assert 0.057 < least.offset < 0.059
        assert wrist_offset(robot, least.tool) == pytest.approx(least.offset)
        assert deepest_stroke(robot, least.tool, POSITION_1, OFF).depth == pytest.approx(least.deepest[0])
        assert least.deepest[0] >= POSITION_1.depth
        assert least.offset - least.fails_at <= 1e-4
        assert deepest_stroke(robot, with_offset(robot, tool, least.fails_at), POSITION_1, OFF).depth < POSITION_1.depth

    def test_a_planted_least_is_found_at_the_best_angle(self, planted):
        # 50 mm are reached at e = 0.1 / (1 + cos(angle - 2) / 2): of these angles the least is 0.0685 at 120 deg
        turns = np.deg2rad(np.arange(0, 360, 30))
        job, curve = planted(lambda e, a: 0.5 * e * (1 + 0.5 * np.cos(a - 2)), np.arange(0, 0.2, 0.01), turns)
        least = least_offset(job, curve)
        expected = 0.1 / (1 + 0.5 * np.cos(turns - 2))
        assert least.angle == turns[expected.argmin()]
        assert expected.min() <= least.offset <= expected.min() + 1e-4
        assert least.fails_at < expected.min()

    def test_of_several_angles_in_one_step_the_least_is_taken(self, planted):
        job, curve = planted(lambda e, a: e - 0.011 + 0.002 * a, [0.0, 0.1], [0.0, 1.0, 2.0])
        least = least_offset(job, curve)
        assert least.angle == 2.0
        assert least.offset == pytest.approx(0.057, abs=1.1e-4)

    def test_where_depth_falls_again_the_first_offset_counts(self, planted):
        job, curve = planted(lambda e, a: 0.06 * np.sin(e * np.pi / 0.1), np.linspace(0, 0.3, 31), [0.0])
        least = least_offset(job, curve)
        assert least.offset == pytest.approx(0.1 / np.pi * np.arcsin(5 / 6), abs=1.1e-4)

    def test_the_least_that_was_examined_is_not_gone_below(self, planted):
        job, curve = planted(lambda e, a: 0.1, [0.02, 0.04], [0.0])
        least = least_offset(job, curve)
        assert (least.offset, least.fails_at) == (0.02, None)

    def test_none_drills_it(self, planted):
        job, curve = planted(lambda e, a: 0.3 * e, [0.0, 0.1], [0.0, 1.0])
        assert least_offset(job, curve) is None


class TestFigure:
    @pytest.mark.parametrize(("n_offsets", "n_angles", "n_holes"), [(5, 1, 3), (5, 12, 1), (4, 4, 20), (1, 3, 2)])
    def test_it_is_drawn(self, robot, tool, n_offsets, n_angles, n_holes):
        holes = tuple(replace(POSITION_1, id=f"_${n}") for n in range(n_holes))
        e, a = np.linspace(0.05, 0.2, n_offsets), np.linspace(0, 2 * np.pi, n_angles, endpoint=False)
        deepest = e[:, None, None] * (1 + 0.2 * np.cos(a)[:, None]) * np.linspace(0.5, 1, n_holes)
        curve = OffsetCurve(e, a, deepest, np.full(n_holes, 0.05))
        least = tool_offset.LeastOffset(e[-1], a[-1], with_offset(robot, tool, e[-1], a[-1]), deepest[-1, -1], None)
        for marked in (least, None):
            assert png(figure_of(Job(robot, tool, holes, OFF), curve, marked)).startswith(b"\x89PNG")


@pytest.fixture
def job_file(tmp_path):
    """Position 1 with its stroke, as a job file."""

    def write(depth_mm=50):
        path = tmp_path / "one.yaml"
        hole = {"id": "P1", "target_mm": [500, 300, 800], "direction": [1, 0, 0], "depth_mm": depth_mm}
        settings = {"robot": "kuka_kr6_r700_2", "tool": "thesis_drill", "min_rate_deg_per_mm": 0}
        path.write_text(yaml.safe_dump(settings | {"holes": [hole]}))
        return str(path)

    return write


class TestCommand:
    def test_the_answer_is_written_shown_and_drawn(self, job_file, tmp_path, capsys):
        where, picture = tmp_path / "offset.json", tmp_path / "offset.png"
        asked = ["offset", job_file(), "--offsets-mm", "40:70:20", "-o", str(where), "--figure", str(picture)]
        assert cli.main(asked) == cli.FINE
        out = capsys.readouterr().out
        for part in ("straight legs; no motion threshold; spin periodic", "51.4", "e = 155.00 mm at 0 deg"):
            assert part in out
        data = json.loads(where.read_text())
        assert data["format"] == "zerorev.offset/1"
        assert data["offsets_mm"] == [40, 60]
        assert data["angles_deg"] == [0]
        assert data["holes"][0]["deepest_mm"][1][0] == pytest.approx(51.4, abs=0.06)
        assert data["margin_mm"][1][0] == pytest.approx(1.4, abs=0.06)
        assert data["least"]["offset_mm"] == pytest.approx(58, abs=0.15)
        assert data["least"]["tool"]["tcp_mm"][2] == pytest.approx(data["least"]["offset_mm"] - 90, abs=1e-6)
        assert picture.read_bytes().startswith(b"\x89PNG")

    def test_json_and_no_offset_that_does(self, job_file, capsys):
        assert cli.main(["offset", job_file(60), "--offsets-mm", "60", "--json"]) == cli.FOUND
        assert json.loads(capsys.readouterr().out)["least"] is None

    @pytest.mark.parametrize("given", ["a:b:c", "1:2", "3:1:1", "0:10:0", "0:1e9:1", "nan", "", "20,10", "-5,5"])
    def test_offsets_that_are_none_are_one_message(self, job_file, capsys, given):
        assert cli.main(["offset", job_file(), f"--offsets-mm={given}"]) == cli.BAD_INPUT
        err = capsys.readouterr().err
        assert err.count("error:") == 1
        assert "offsets" in err

    def test_angles_that_are_none(self, job_file, capsys):
        assert cli.main(["offset", job_file(), "--angles-deg", "north"]) == cli.BAD_INPUT
        assert "--angles-deg" in capsys.readouterr().err

    def test_the_job_is_not_written_over(self, job_file, capsys):
        job = job_file()
        assert cli.main(["offset", job, "-o", job]) == cli.BAD_INPUT
        assert "which is read" in capsys.readouterr().err
