"""The pictures, the page and the lines of a workspace map show what is in it."""

from __future__ import annotations

import csv
import io
import json
import re

import numpy as np
import pytest
from matplotlib.colors import to_rgb, to_rgba

from oracles.made_map import made_map
from zerorev.cli import common as cli
from zerorev.cli import main
from zerorev.maps.answers import cells_of, difference
from zerorev.maps.planes import planes_of
from zerorev.report.figures import style
from zerorev.report.figures.cell import direction_rose
from zerorev.report.figures.map_difference import difference_figure
from zerorev.report.figures.workspace import map_figures, robot_at_home
from zerorev.report.figures.workspace_map import planes_figure, surface_figure, views_figure
from zerorev.report.figures.workspace_page import workspace_page
from zerorev.report.words.workspace_map import difference_csv, difference_lines, show_lines

AXES = ([300, 400, 500], [-200, -100, 0, 100, 200], [600, 700, 800])
CONE = np.array([[1.0, 0, 0], [0.8, 0.6, 0], [0.8, -0.6, 0], [0.8, 0, 0.6], [0.8, 0, -0.6]])


def stroke(x, y, z, direction):
    """A smooth map, symmetric in Y, with a corner that is out of reach."""
    return np.nan if x == 500 and z == 800 else x / 10 + abs(y) / 20 + (z - 600) / 50 + 10 * abs(direction[1])


@pytest.fixture
def found(robot, tool):
    return made_map(robot, tool, AXES, CONE, stroke, branch=4, psi_deg=(5, 0, -5))


@pytest.fixture
def stored(found, tmp_path):
    found.to_zarr(tmp_path / "m.zarr", consolidated=False)
    return tmp_path / "m.zarr"


def test_lines_say_range_best_and_symmetry(found):
    lines = show_lines(found)
    assert "45 targets, 5 directions" in lines[0]
    assert lines[1].startswith("200 of 225 cells (88.9 %) have a stroke")
    assert "30.0 mm to 68.0 mm" in lines[1]
    assert lines[2] == "the others: 25 out of reach"
    assert "68.0 mm at (500, -200, 700) mm, direction (0.8, 0.6, 0), branch 4, psi 5.00, 0.00, -5.00 deg" in lines[3]
    assert "differ by 0 mm at most; 0 have" in lines[-1]
    lopsided = found.copy(deep=True)
    lopsided["deepest_mm"][0, 4, 0, 0] += 2
    assert "differ by 2 mm at most, at (300, 200, 600) mm" in show_lines(lopsided)[-1]


def test_planes_have_the_colours_of_their_cells_and_units(found):
    planes = planes_of(cells_of(found))
    figure = planes_figure(planes, "robot")
    for axes, plane in zip(figure.axes, planes, strict=False):
        assert axes.xaxis_inverted()  # seen from behind the robot, +Y is left
        (mesh,) = axes.collections
        np.testing.assert_array_equal(np.ma.filled(mesh.get_array().astype(float), np.nan), plane.value)
        assert axes.get_facecolor() == pytest.approx(to_rgba(style.CANNOT_RUN))
        assert plane.name in axes.get_title(loc="left")
    assert "[mm]" in figure.axes[0].get_xlabel() + figure.axes[-1].get_ylabel()
    limits = {tuple(axes.collections[0].get_clim()) for axes in figure.axes[:3]}
    assert len(limits) == 1
    own = planes_figure(planes, "robot", alike=False)
    assert len({tuple(axes.collections[0].get_clim()) for axes in own.axes[:3]}) == 3


def test_reversals_have_their_colours(robot, tool):
    found = made_map(robot, tool, AXES, CONE[:1], lambda x, y, z, _: (y + 200) // 100 * 2, variable="reversals")
    plane = planes_of(cells_of(found))[0]
    mesh = planes_figure([plane], "robot").axes[0].collections[0]
    colours = mesh.cmap(mesh.norm(mesh.get_array()))[..., :3]
    for (row, column), count in np.ndenumerate(plane.value):
        assert colours[row, column] == pytest.approx(to_rgb(style.REVERSAL_COLOURS[min(int(count), 6)]), abs=0.01)


def test_a_small_plane_has_its_numbers(found):
    plane = planes_of(cells_of(found))[0]
    reported = {text.xy: text.get_text() for text in planes_figure([plane], "robot").axes[0].texts}
    for (row, column), value in np.ndenumerate(plane.value):
        assert reported[plane.width[column], plane.height[row]] == f"{value:.1f}"


def test_surface_lies_as_deep_as_the_strokes(found):
    robot = robot_at_home(found)
    plane = planes_of(cells_of(found))[1]
    axes = surface_figure(plane, "robot", robot).axes[0]
    corners = np.concatenate(axes.collections[0]._faces)
    for (row, column), value in np.ndenumerate(plane.value):
        wanted = (plane.at + value, plane.width[column], plane.height[row])
        assert np.linalg.norm(corners - wanted, axis=1).min() < 1e-9
    np.testing.assert_allclose(np.transpose(axes.lines[0].get_data_3d()), robot)


def test_views_show_every_face_from_below_and_from_the_side(found):
    planes = planes_of(cells_of(found))
    figure = views_figure(planes, "robot", robot_at_home(found))
    below, side = figure.axes[:2]
    for axes, height in ((below, "Y"), (side, "Z")):
        (faces,) = axes.collections
        assert len(faces.get_paths()) == 3 * 2 * 4
        assert axes.get_xlabel() == "X [mm]"
        assert axes.get_ylabel() == f"{height} [mm]"
    assert below.yaxis_inverted()
    assert not side.yaxis_inverted()
    ring = side.lines[-1].get_xydata()[0]
    np.testing.assert_allclose(ring, (500 + 62, 700))  # the deepest along X at (500, ±200, 700)


def test_rose_has_each_direction_where_it_points(found):
    cells = cells_of(found)
    axes = direction_rose(cells, 4 * 3, "robot").axes[0]
    dots = axes.lines[0].get_xydata()
    # right of who looks along +X is -Y, up is +Z; equal areas: a distance of 2 sin(angle / 2)
    r = 2 * np.sin(np.arccos(0.8) / 2)
    np.testing.assert_allclose(dots, [(0, 0), (-r, 0), (r, 0), (0, r), (0, -r)], atol=1e-12)
    picture = axes.images[0]
    colours = picture.get_array()
    extent = picture.get_extent()
    assert cells.value[12].tolist() == pytest.approx([40, 46, 46, 40, 40])
    at = [round((place - extent[0]) / (extent[1] - extent[0]) * (colours.shape[0] - 1)) for place in (r, 0)]
    assert not np.allclose(colours[at[1], at[0]], colours[at[1], at[1]])


def test_what_is_not_there_is_not_drawn(found, robot, tool):
    assert set(map_figures(found)) == {"planes", "surface", "views", "cell", "rose"}
    line = made_map(robot, tool, ([300], [0], [600, 700]), CONE[:1], stroke)
    assert set(map_figures(line)) == {"planes", "cell"}
    none = made_map(robot, tool, AXES, CONE[:1], lambda *_: np.nan)
    assert set(map_figures(none)) == {"planes", "surface", "views", "cell"}
    assert show_lines(none)[1].startswith("0 of 45 cells (0 %)")


def test_page_needs_no_network_and_holds_the_map(found):
    page = workspace_page(found, robot_at_home(found))
    assert not re.search(r"<(script|link|img)[^>]+(src|href)=", page)
    assert page.count("</script>") == page.count("<script")
    data = json.loads(re.search(r"const map = (\{.*\});", page).group(1))
    assert data["across"] == "x"
    assert data["flipped"]["x"]
    shape = [len(data[axis]) for axis in "xyz"]
    shown = np.array([np.nan if v is None else v for v in data["value"]]).reshape(*shape, len(data["directions"]))
    np.testing.assert_allclose(shown, found["deepest_mm"].values, rtol=1e-4)


def test_difference_in_lines_file_and_picture(robot, tool, found):
    other = made_map(robot, tool, AXES, CONE, lambda x, y, z, d: stroke(x, y, z, d) + (5 if y > 0 else -1), legs="free")
    apart = difference(cells_of(found), cells_of(other))
    lines = difference_lines(apart, ("a", "b"))
    assert "225 common cells, 200 comparable" in lines[0]
    assert "b is better in 80 cells, worse in 120, alike in 0; median change -1.0 mm" in lines[2]
    rows = list(csv.reader(io.StringIO(difference_csv(apart, ("a", "b")))))
    assert rows[0][6:] == ["deepest_mm of a", "deepest_mm of b", "change of deepest_mm"]
    assert len(rows) == 226
    for row in rows[1:]:
        x, y, z, *direction = map(float, row[:6])
        value = stroke(x, y, z, direction)
        assert row[6] == ("" if np.isnan(value) else repr(float(value)))
        if row[8]:
            assert float(row[8]) == pytest.approx(5 if y > 0 else -1)
    panels = difference_figure(apart, ("a", "b")).axes[:3]
    change = panels[2].collections[0]
    assert change.get_clim() == (-5, 5)
    first, second = (np.asarray(axes.collections[0].get_array()) for axes in panels[:2])
    np.testing.assert_allclose(second - first, np.asarray(change.get_array()))


def test_commands(stored, tmp_path, capsys):
    arguments = ["--figures", str(tmp_path / "f"), "--page", str(tmp_path / "p.html"), "--at", "400,0,700"]
    assert main(["map", "show", str(stored), *arguments]) == cli.FINE
    assert "best: 68.0 mm" in capsys.readouterr().out
    names = {path.name for path in (tmp_path / "f").iterdir()}
    assert names == {"planes.png", "surface.png", "views.png", "cell.png", "rose.png"}
    arguments = ["-o", str(tmp_path / "d.csv"), "--figure", str(tmp_path / "d.png")]
    assert main(["map", "compare", str(stored), str(stored), *arguments]) == cli.FINE
    assert "alike in 200" in capsys.readouterr().out
    assert (tmp_path / "d.png").stat().st_size > 10_000


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["show", "{folder}/none.zarr"], "no folder of zarr"),
        (["show", "{folder}"], "no folder of zarr"),
        (["show", "{map}", "--direction", "5"], "0 to 4"),
        (["show", "{map}", "--across", "w"], "across"),
        (["show", "{map}", "--at", "1,2"], "three"),
        (["show", "{map}", "--at", "1,2,3", "--figures", "{folder}/f"], "no target of the map"),
        (["show", "{map}", "--page", "{folder}/no/p.html"], "does not exist"),
        (["compare", "{map}", "{folder}/none.zarr"], "no folder of zarr"),
    ],
    ids=str,
)
def test_bad_input_is_one_message(stored, tmp_path, capsys, arguments, said):
    filled = [argument.format(folder=tmp_path, map=stored) for argument in arguments]
    assert main(["map", *filled]) == cli.BAD_INPUT
    out, err = capsys.readouterr()
    assert out == ""
    assert err.count("error:") == 1
    assert said in err
    assert [path.name for path in tmp_path.iterdir()] == ["m.zarr"]
