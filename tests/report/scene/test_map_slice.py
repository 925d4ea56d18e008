"""A slice shows what the map holds: its values, places and reasons, cell by cell; and a cell becomes its hole."""

from __future__ import annotations

from contextlib import closing
from dataclasses import replace

import numpy as np
import pytest
from matplotlib.colors import to_rgb

import zerorev as zr
from oracles.made_map import made_map
from zerorev.errors import InputError
from zerorev.maps.cells import STATUS
from zerorev.model.map_task import Question
from zerorev.report.figures.style import REVERSAL_COLOURS
from zerorev.report.scene import map_slice
from zerorev.report.scene.map_slice import WHY_COLOURS, computed, plane_task, slice_of
from zerorev.workers import HERE

AXES = ([300, 400, 500], [-200, -100, 0, 100, 200], [600, 700, 800])
DIRECTIONS = np.array([[1.0, 0, 0], [0.8, 0.6, 0], [0, 0, -1]])
X = np.array([1.0, 0, 0])
TILTED = np.array([0.8, 0.36, -0.48])
STRAIGHT = zr.Settings(min_rate=0.0)


def stroke(x, y, z, direction):
    """A smooth map with a corner that is out of reach."""
    return np.nan if x == 500 and z == 800 else x / 10 + abs(y) / 20 + (z - 600) / 50 + 10 * abs(direction[1])


@pytest.fixture
def found(robot, tool):
    return made_map(robot, tool, AXES, DIRECTIONS, stroke, branch=4, psi_deg=(5, 0, -5))


@pytest.mark.parametrize("across", [None, "x", "y", "z"])
@pytest.mark.parametrize("direction", [0, 1, 2])
def test_cells_are_those_of_the_dataset(found, across, direction):
    seen = set()
    planes = range(found.sizes[slice_of(found, direction, across).across])
    for plane in planes:
        cut = slice_of(found, direction, across, plane)
        for n, value in enumerate(cut.value):
            cell = found.isel(cut.index(n))
            np.testing.assert_equal(value, float(cell["deepest_mm"]))
            np.testing.assert_allclose(cut.position[n] * 1e3, [float(cell[f"{axis}_mm"]) for axis in "xyz"])
            assert cut.status[n] == int(cell["status"])
            seen.add(tuple(cut.index(n).values()))
    assert len(seen) == 45


def test_the_plane_with_the_best_cell_comes_first(found):
    cut = slice_of(found, 0)
    assert (cut.across, cut.at) == ("x", 2)
    assert cut.value[cut.best] == np.nanmax(found["deepest_mm"].values[..., 0])
    assert slice_of(found, 2).across == "z"
    np.testing.assert_allclose(cut.edges, [[0, 0.1, 0], [0, 0, 0.1]])


def test_colours_grow_lighter_with_the_value_and_greys_say_why(found):
    cut = slice_of(found, 0, "x", 2)
    reported = np.isfinite(cut.value)
    light = np.array([np.dot(to_rgb(colour), (0.299, 0.587, 0.114)) for colour in cut.colours])
    order = np.argsort(cut.value[reported])
    assert (np.diff(light[reported][order]) >= -1e-9).all()
    assert {colour for colour, there in zip(cut.colours, reported, strict=True) if not there} == {
        WHY_COLOURS["out_of_reach"]
    }
    assert cut.legend[0].words == "0.0 mm"
    assert cut.legend[-2].words == f"{np.nanmax(cut.value):.1f} mm"
    assert cut.legend[-1].words == "out of reach: 5"
    assert "out of reach" in [cut.words(n) for n in range(15)]


def test_reversals_have_their_own_colours(robot, tool):
    counts = iter(range(9))
    found = made_map(
        robot, tool, ([500], [0, 100, 200], [600, 700, 800]), X[None], lambda *_: next(counts),
        variable="reversals", quantity="fewest_reversals", depth_mm=50.0, branch=0, psi_deg=(1, 2, 3),
    )  # fmt: skip
    cut = slice_of(found)
    wanted = [REVERSAL_COLOURS[min(n, 6)].lower() for n in range(9)]
    assert list(cut.colours) == wanted
    assert [key.words for key in cut.legend] == [
        "0 reversals", "1 reversal", "2 reversals", "3 reversals", "4 reversals", "5 reversals", "6+ reversals"
    ]  # fmt: skip


def test_a_cell_becomes_its_hole(found):
    cut = slice_of(found, 1, "x", 1)
    hole = cut.hole(7, depth=0.05)
    assert hole.id == "cell 400 0 700 d1"
    np.testing.assert_allclose(hole.target, [0.4, 0, 0.7])
    np.testing.assert_allclose(hole.direction, [0.8, 0.6, 0])
    assert hole.depth == pytest.approx(cut.value[7] / 1e3)  # the deepest stroke, not the one given
    np.testing.assert_allclose(np.rad2deg(hole.profile.psi), [5, 0, -5])


def test_a_cell_without_an_answer_says_why(found):
    cut = slice_of(found, 0, "x", 2)
    nowhere = int(np.flatnonzero(np.isnan(cut.value))[0])
    with pytest.raises(InputError, match="out of reach"):
        cut.hole(nowhere, depth=0.05)
    with pytest.raises(InputError, match="no cell 15"):
        cut.hole(15, depth=0.05)
    reached = replace(cut, status=np.where(np.isnan(cut.value), 1, cut.status).astype(np.int8))
    hole = reached.hole(nowhere, depth=0.05)
    assert (hole.depth, hole.profile, hole.branch) == (0.05, None, None)


@pytest.mark.parametrize(("direction", "across", "at"), [(3, None, None), (-1, None, None), (0, "x", 3), (0, "y", -1)])
def test_what_a_map_lacks_is_refused(found, direction, across, at):
    with pytest.raises(InputError, match="accepted"):
        slice_of(found, direction, across, at)


@pytest.mark.parametrize("cut", ["x", "y", "z", "drill"])
def test_a_plane_lies_across_its_axis_around_the_target(robot, tool, cut):
    centre = np.array([0.5, 0.3, 0.8])
    task = plane_task(Question(robot, tool, settings=STRAIGHT), centre, TILTED, cut, (0.4, 0.21), 0.1)
    places = task.target_mm(np.arange(task.cells)) / 1e3
    normal = TILTED if cut == "drill" else np.eye(3)["xyz".index(cut)]
    np.testing.assert_allclose((places - centre) @ normal, 0, atol=1e-8)
    assert task.cells == 5 * 3
    np.testing.assert_allclose(places.mean(axis=0), centre, atol=1e-8)
    apart = np.linalg.norm(places[:, None] - places, axis=-1) + np.eye(len(places))
    assert apart.min() == pytest.approx(0.1, abs=1e-8)
    across = "xyz".index("x" if cut == "z" else "z")
    assert np.ptp(places[:, across]) > 0.1  # the height goes upwards, or along x where the plane lies flat


@pytest.mark.parametrize(
    ("size", "spacing", "where"),
    [
        ((-0.1, 0.1), 0.05, "width"),
        ((0.1, np.nan), 0.05, "height"),
        ((np.inf, 0.1), 0.05, "width"),
        ((0.1, 0.1), 0.0, "spacing"),
        ((10.0, 10.0), 0.001, "spacing"),
    ],
)
def test_a_plane_that_cannot_be_is_refused_by_name(robot, tool, size, spacing, where):
    with pytest.raises(InputError, match=where):
        plane_task(Question(robot, tool, settings=STRAIGHT), np.array([0.5, 0.3, 0.8]), X, "x", size, spacing)


@pytest.mark.parametrize("cut", ["x", "drill"])
def test_a_computed_plane_holds_what_the_depth_search_says(robot, tool, cut, tmp_path, monkeypatch):
    monkeypatch.setattr(map_slice.tempfile, "tempdir", str(tmp_path))
    task = plane_task(Question(robot, tool, settings=STRAIGHT), np.array([0.5, 0.3, 0.8]), X, cut, (0.2, 0.2), 0.1)
    *growing, whole = computed(task, HERE)
    unseen = [int((each["status"].values == -1).sum()) for each in (*growing, whole)]
    assert unseen == sorted(unseen, reverse=True)
    assert (unseen[0] > 0, unseen[-1]) == (True, 0)
    assert slice_of(growing[0]).legend[-1].words == f"not yet examined: {unseen[0]}"
    seen = slice_of(whole)
    assert not list(tmp_path.iterdir())
    assert seen.value.shape == (9,)
    np.testing.assert_allclose(np.abs(seen.edges).max(axis=1), 0.1)
    for n in (0, 4):
        hole = zr.Hole("same", seen.position[n], X, 0.01)
        assert seen.value[n] == zr.deepest_stroke(robot, tool, hole, STRAIGHT).depth * 1e3
    made = seen.hole(4, depth=0.05)
    answer = zr.plan(robot, tool, made, STRAIGHT)
    assert (answer.score.reversals, answer.verified.passed) == (0, True)
    assert made.depth == seen.value[4] / 1e3


def test_giving_up_leaves_nothing_behind(robot, tool, tmp_path, monkeypatch):
    monkeypatch.setattr(map_slice.tempfile, "tempdir", str(tmp_path))
    task = plane_task(Question(robot, tool, settings=STRAIGHT), np.array([0.5, 0.3, 0.8]), X, "x", (0.2, 0.2), 0.1)

    with closing(computed(task, HERE)) as growing:
        next(growing)
        assert list(tmp_path.iterdir())
    assert not list(tmp_path.iterdir())


def test_every_reason_has_a_colour_and_words():
    assert set(WHY_COLOURS) == set(map_slice.WHY_WORDS) - {"answered"}
    assert set(STATUS) - {"answered"} <= set(WHY_COLOURS)
