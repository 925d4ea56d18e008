"""Cells, planes, mirror and difference of maps whose numbers are known."""

from __future__ import annotations

import numpy as np
import pytest

from oracles.made_map import made_map
from zerorev.errors import InputError
from zerorev.maps.answers import best_cells, cells_of, difference, mirror_in_y
from zerorev.maps.planes import planes_of

AXES = ([300, 400, 500], [-200, 0, 200], [600, 700])
CONE = np.array([[1.0, 0, 0], [0.8, 0.6, 0], [0.8, -0.6, 0]])


def spread_out(x, y, z, direction):
    """Another number in every cell; none in one."""
    return np.nan if (x, y, z) == (400, 0, 700) else x / 10 + y / 1000 + z / 100 + direction[1]


@pytest.fixture
def found(robot, tool):
    return made_map(robot, tool, AXES, CONE, spread_out, branch=3, psi_deg=(1, 2, 3))


def test_every_cell_is_beside_its_target_and_direction(found):
    cells = cells_of(found)
    assert cells.value.shape == (18, 3)
    for (row, column), value in np.ndenumerate(cells.value):
        expected = spread_out(*cells.target[row], cells.direction[column])
        assert value == pytest.approx(expected, nan_ok=True)
        assert cells.branch[row, column] == (-1 if np.isnan(expected) else 3)
    np.testing.assert_array_equal(cells_of(found.transpose("direction", "z", "y", "x")).value, cells.value)


def test_a_map_at_points_reads_the_same(found):
    points = found.stack(point=("x", "y", "z")).drop_vars(["point", "x", "y", "z"], errors="ignore")
    points = points.transpose("point", "direction")
    cells, expected = cells_of(points), cells_of(found)
    np.testing.assert_array_equal(cells.target, expected.target)
    np.testing.assert_array_equal(cells.value, expected.value)


def test_the_best_come_first_by_the_sense_of_the_quantity(robot, tool, found):
    cells = cells_of(found)
    order = [cells.value[place] for place in best_cells(cells, 100)]
    assert len(order) == 51  # of 54 cells 3 have no answer
    assert order == sorted(order, reverse=True)
    travel = cells_of(made_map(robot, tool, AXES, CONE, spread_out, variable="travel_deg"))
    assert travel.value[best_cells(travel, 1)[0]] == np.nanmin(travel.value)


def test_no_stroke_and_no_reversals_are_not_the_same_nothing(robot, tool):
    def zero(*_):
        return 0

    assert np.isnan(cells_of(made_map(robot, tool, AXES, CONE, zero)).value).all()
    assert (cells_of(made_map(robot, tool, AXES, CONE, zero, variable="reversals")).value == 0).all()


@pytest.mark.parametrize(("across", "right", "up"), [("x", "y", "z"), ("y", "x", "z"), ("z", "y", "x")])
@pytest.mark.parametrize("shuffled", [False, True])
def test_planes_hold_each_cell_at_its_place(found, across, right, up, shuffled):
    if shuffled:
        found = found.isel(x=[2, 0, 1], y=[1, 2, 0], z=[1, 0])
    planes = planes_of(cells_of(found), 1, across)
    assert [plane.at for plane in planes] == AXES["xyz".index(across)]
    for plane in planes:
        assert (plane.right, plane.up) == (right, up)
        for (row, column), value in np.ndenumerate(plane.value):
            at = {across: plane.at, right: plane.width[column], up: plane.height[row]}
            assert value == pytest.approx(spread_out(at["x"], at["y"], at["z"], CONE[1]), nan_ok=True)


def test_a_plane_is_seen_along_the_drill_and_its_surface_moves_with_it(robot, tool):
    for drill in (*np.eye(3), *-np.eye(3)):
        plane = planes_of(cells_of(made_map(robot, tool, AXES, [drill], lambda x, y, z, _: 7)))[0]
        right, up = (np.eye(3)["xyz".index(axis)] for axis in (plane.right, plane.up))
        seen_right = -right if plane.flipped else right
        np.testing.assert_array_equal(np.cross(drill, up), seen_right)  # right of who looks along the drill
        places = plane.surface(2.0)
        np.testing.assert_allclose((places @ drill), plane.at * drill["xyz".index(plane.across)] + 14.0)


def test_what_is_not_a_grid_has_no_planes(found):
    cells = cells_of(found.isel(x=[0]).stack(point=("x", "y", "z")).isel(point=[0, 1, 2, 3, 5]))
    with pytest.raises(InputError, match="do not form a grid"):
        planes_of(cells)


def test_mirror_finds_a_planted_difference_and_counts_no_pair_twice(robot, tool):
    def symmetric(x, y, z, direction):
        return x + abs(y) + z + direction[1] * np.sign(y or 1) + (0.25 if (x, y, z) == (500, 200, 700) else 0)

    found = made_map(robot, tool, AXES, CONE[:1], symmetric)
    mirror = mirror_in_y(cells_of(found))
    assert (~np.isnan(mirror.change)).sum() == 6  # x by z at Y = 200; Y = 0 is its own mirror
    assert np.nanmax(np.abs(mirror.change)) == pytest.approx(0.25)
    assert mirror_in_y(cells_of(found.isel(y=[2]))) is None
    both = mirror_in_y(cells_of(made_map(robot, tool, AXES, CONE, lambda x, y, z, d: x + y * 10 * d[1] + 1e3)))
    assert (~np.isnan(both.change)).sum() == 6 * 3 + 6  # all directions at Y = 200, one of the two that lean at Y = 0
    assert np.nanmax(np.abs(both.change)) == pytest.approx(0, abs=1e-9)


def test_difference_is_of_common_cells_regardless_of_their_order(robot, tool, found):
    other = made_map(robot, tool, ([500, 300, 350], AXES[1], AXES[2]), CONE[[2, 0]],
                     lambda x, y, z, d: np.nan if (x, y) == (300, 200) else spread_out(x, y, z, d) + x)  # fmt: skip
    apart = difference(cells_of(found), cells_of(other))
    assert {*apart.target[:, 0]} == {300, 500}
    assert apart.change.shape == (12, 2)
    for row, column in np.ndindex(*apart.change.shape):
        x, y, _ = apart.target[row]
        # where the other has no stroke it counts as none
        expected = -apart.first[row, column] if (x, y) == (300, 200) else x
        assert apart.change[row, column] == pytest.approx(expected)


def test_maps_that_cannot_be_compared_are_refused(robot, tool, found):
    cells = cells_of(found)
    with pytest.raises(InputError, match="the other travel_deg"):
        difference(cells, cells_of(made_map(robot, tool, AXES, CONE, spread_out, variable="travel_deg")))
    with pytest.raises(InputError, match="no targets in common"):
        difference(cells, cells_of(made_map(robot, tool, ([1], [2], [3]), CONE, spread_out)))
    with pytest.raises(InputError, match="no directions in common"):
        difference(cells, cells_of(made_map(robot, tool, AXES, [[0, 0, 1]], spread_out)))
    with pytest.raises(InputError, match="no quantity"):
        cells_of(found.drop_vars("deepest_mm"))
