"""A workspace map that is opened: its cells are in the picture of the robot at once, and still there after a reload."""

from __future__ import annotations

import numpy as np
import pytest

from oracles.made_map import made_map

pytestmark = pytest.mark.xdist_group("browser")
expect = pytest.importorskip("playwright.sync_api", reason="the tests in a browser need playwright").expect

CELL = "document.querySelector('[data-testid=\"cell\"]')?.cell"
CELLS = f"() => {CELL}?.slice?.words ?? null"
DEPTHS = [[10, 20], [30, 90], [np.nan, 50]]  # [mm] over y and z
WORDS = ["10.0 mm", "20.0 mm", "30.0 mm", "90.0 mm", "out of reach", "50.0 mm"]


@pytest.fixture
def opened(serve, open_page, robot, tool, tmp_path):
    """Opens a made map with planes at some x [mm]; the one at 500 mm has the deepest hole, and is shown."""

    def page(*x):
        y, z = [0, 100, 200], [600, 700]

        def depth(*at):
            return DEPTHS[y.index(at[1])][z.index(at[2])] - (500 - at[0]) / 10

        found = made_map(robot, tool, (x, y, z), np.array([[1.0, 0, 0]]), depth, branch=4, psi_deg=(5, 0, -5))
        found.to_zarr(tmp_path / "map.zarr", consolidated=False)
        return open_page(serve(tmp_path / "map.zarr"))

    return page


def test_a_map_of_one_plane_shows_its_cells_also_after_a_reload(opened):
    page = opened(500)
    for reloads in (True, False):
        page.wait_for_function(CELLS)
        assert page.evaluate(CELLS) == WORDS
        if reloads:
            page.reload()
    page.get_by_test_id("tab-map").click()
    expect(page.get_by_test_id("map-legend")).to_contain_text("90")
    page.get_by_test_id("map-away").click()
    page.wait_for_function(f"() => {CELL} && !{CELL}.slice")


def test_a_map_of_several_planes_shows_the_best_one_at_once(opened):
    page = opened(480, 500)
    page.wait_for_function(CELLS)
    assert page.evaluate(CELLS) == WORDS
