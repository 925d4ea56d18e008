"""What `place` and `share` show: the numbers of the answer, the robot moved instead, the picture of every freedom."""

from __future__ import annotations

import io
import json
from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from rich.console import Console

from zerorev.files.text import json_text
from zerorev.model._arrays import rotation_rpy, transform
from zerorev.model.hole import Hole
from zerorev.model.job import Job
from zerorev.placement.freedom import AXES, Freedom, frame_at
from zerorev.placement.room import Slice
from zerorev.placement.search import Placement
from zerorev.placement.sharing import Shares
from zerorev.report.figures.placement import placement_map
from zerorev.report.figures.style import png
from zerorev.report.words.placement import (
    placement_data,
    placement_lines,
    placement_table,
    robot_instead,
    share_data,
    share_lines,
    share_table,
)  # fmt: skip

PLACE = np.array([0.01, -0.02, -0.2, np.deg2rad(5)])
ENDS = ((-0.1, 0.1), (-0.05, 0.05), (-0.3, 0.0), (-0.2, 0.2))


@pytest.fixture
def job(robot, tool):
    """Two holes; names that mathematics or markup could misread."""
    holes = tuple(
        Hole(name, np.array([0.5, 0.3, z]), np.array([1.0, 0, 0]), 0.05) for name, z in (("_$1", 1), ("[b]", 1.1))
    )
    return Job(robot, tool, holes, T_base_part=transform(np.eye(3), np.array([0.5, 0.3, 1.0])), name="panel")


def answer(axes, margins=(0.02, 0.01)):
    """A finished answer with freedom along these axes."""
    freedom = Freedom(**{axis: ENDS[AXES.index(axis)] for axis in axes})
    place = np.where([axis in axes for axis in AXES], PLACE, 0.0)
    pairs = list(combinations(axes, 2)) or [(axis,) for axis in axes]
    values = {axis: freedom.values(AXES.index(axis), 4) for axis in axes}
    shown = tuple(
        Slice(
            pair,
            tuple(values[axis] for axis in pair),
            np.linspace(-0.05, max(margins), 4 ** len(pair)).reshape((4,) * len(pair)),
        )
        for pair in pairs
    )
    grid = tuple(freedom.values(axis, 3) for axis in range(4))
    room = np.array([[-0.01, 0.02]] * 4) if min(margins) >= 0 else None
    found = np.full([values.size for values in grid], np.nan)
    stands = np.array([-0.05, 0.0])
    return freedom, Placement(
        place, np.array(margins), stands, grid, found, room, slices=shown, strokes=17, finished=True
    )


def text_of(*shown):
    console = Console(width=160, record=True, file=io.StringIO())
    for each in shown:
        console.print(each)
    return console.export_text()


def test_moving_the_robot_is_moving_the_part_the_other_way():
    T = transform(rotation_rpy(0.1, 0.2, 0.3), np.array([0.5, 0.3, 0.9]))
    base = robot_instead(T, PLACE)  # of the moved robot, in the base frame that it has now
    np.testing.assert_allclose(np.linalg.inv(base) @ T, frame_at(T, PLACE), atol=1e-12)
    np.testing.assert_allclose(base[2, :3], [0, 0, 1], atol=1e-12)  # it stays upright


class TestPlacement:
    def test_the_file_holds_the_answer(self, job):
        freedom, found = answer(("x", "z", "turn"))
        data = json.loads(json_text(placement_data(job, freedom, found)))
        assert data["best"]["shift_mm"] == [10, 0, -200]
        assert data["best"]["turn_deg"] == 5
        assert data["best"]["part_frame"] == {"xyz_mm": [510, 300, 800], "rpy_deg": [0, 0, 5]}
        assert data["best"]["least_margin_mm"] == 10
        assert data["best"]["worst_hole"] == "[b]"
        assert data["best"]["room"]["z_mm"] == [-10, 20]
        assert data["freedom"] == {"x_mm": [-100, 100], "y_mm": [0, 0], "z_mm": [-300, 0],
                                   "turn_deg": pytest.approx([-11.459, 11.459], abs=1e-3)}  # fmt: skip
        assert [hole["deepest_mm"] for hole in data["holes"]] == pytest.approx([70, 60])
        assert [hole["deepest_as_it_stands_mm"] for hole in data["holes"]] == pytest.approx([0, 50])
        assert [each["axes"] for each in data["slices"]] == [
            ["x_mm", "z_mm"],
            ["x_mm", "turn_deg"],
            ["z_mm", "turn_deg"],
        ]
        assert np.shape(data["grid"]["least_margin_mm"]) == (3, 1, 3, 3)
        assert data["drillable"]

    def test_the_terminal_says_it(self, job):
        freedom, found = answer(("y", "z"))
        out = text_of(placement_table(job, found), *placement_lines(job, freedom, found))
        for part in (
            "[b]", "_$1", "+10.0", "as it stands: least margin -50.0 mm (1 of 2 holes", "shift (0, -20, -200) mm",
            "xyz_mm: [500.0, 280.0, 800.0]", "base instead: xyz_mm [0.0, 20.0, 200.0]",
            "y [mm] -10 to +20; z [mm] -10 to +20",
        ):  # fmt: skip
            assert part in out
        rows = [line for line in out.splitlines() if "+" in line]
        assert "[b]" in rows[0]  # the worst first

    def test_too_shallow(self, job):
        freedom, found = answer(("z",), (0.02, -0.03))
        out = text_of(*placement_lines(job, freedom, found))
        assert "hole [b] is 30.0 mm too shallow (1 of 2 holes" in out
        assert not placement_data(job, freedom, found)["drillable"]

    @pytest.mark.parametrize("axes", [("z",), ("turn",), ("y", "z"), ("x", "y", "turn"), AXES])
    @pytest.mark.parametrize("margins", [(0.02, 0.01), (-0.02, -0.05)])
    def test_it_is_drawn(self, job, axes, margins):
        _, found = answer(axes, margins)
        figure = placement_map(job, found)
        maps = [axes for axes in figure.axes if axes.get_visible() and axes.get_xlabel()]
        assert len(maps) == len(found.slices)
        for each, drawn in zip(found.slices, maps, strict=True):
            assert each.axes[0] in drawn.get_xlabel().lower()
            assert "[mm]" in drawn.get_ylabel() or "[deg]" in drawn.get_ylabel()
        assert png(figure).startswith(b"\x89PNG")

    def test_the_outline_is_where_the_margin_is_zero(self, job):
        _, found = answer(("y", "z"))
        y, z = found.slices[0].values
        plane = 0.2 * (y[:, None] - 0.012) + 0.0 * z
        figure = placement_map(job, replace(found, slices=(Slice(("y", "z"), (y, z), plane),)))
        (outline,) = [each for each in figure.axes[0].collections if type(each).__name__ == "QuadContourSet"]
        np.testing.assert_allclose(outline.get_paths()[0].vertices[:, 0], 12, atol=1e-6)


def test_shares(job):
    other = replace(job, name="other")
    shares = Shares(np.array([[0.01, -0.02], [0.03, np.nan]]), ("_$1", "[b]"), np.array([1, -1]))
    data = json.loads(json_text(share_data([job, other], shares)))
    assert [hole["taken_by"] for hole in data["holes"]] == [1, None]
    assert data["holes"][1]["margin_mm"] == [-20, None]
    assert [robot["holes"] for robot in data["robots"]] == [0, 1]
    assert data["least_margin_mm"] == 30
    out = text_of(share_table([job, other], shares), *share_lines([job, other], shares))
    for part in ("nobody", "margin of other", "1 holes are drilled by none", "takes 1 of the 1 holes", "+30.0 mm"):
        assert part in out
