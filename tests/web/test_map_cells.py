"""A workspace map that is opened: its cells are in the picture of the robot at once, and still there after a reload."""

from __future__ import annotations

import numpy as np
import pytest

from oracles.made_map import made_map

pytestmark = pytest.mark.xdist_group("browser")
expect = pytest.importorskip("playwright.sync_api", reason="the tests in a browser need playwright").expect

CELL = "document.querySelector('[data-testid=\"cell\"]')?.cell"
CELLS = f"() => {CELL}?.slice?.words ?? null"
PLANES = {"one plane": [500], "two planes": [480, 500]}
DEPTHS = [[10, 20], [30, 90], [np.nan, 50]]  # [mm] over y and z


@pytest.mark.parametrize("planes", PLANES)
def test_an_opened_map_shows_its_cells_also_after_a_reload(serve, open_page, robot, tool, tmp_path, planes):
    x, y, z = PLANES[planes], [0, 100, 200], [600, 700]

    def depth(*at):  # the plane at 500 mm has the deepest hole, and is the one that is shown
        return DEPTHS[y.index(at[1])][z.index(at[2])] - (500 - at[0]) / 10

    found = made_map(robot, tool, (x, y, z), np.array([[1.0, 0, 0]]), depth, branch=4, psi_deg=(5, 0, -5))
    found.to_zarr(tmp_path / "map.zarr", consolidated=False)
    page = open_page(serve(tmp_path / "map.zarr"))
    wanted = ["10.0 mm", "20.0 mm", "30.0 mm", "90.0 mm", "out of reach", "50.0 mm"]
    for _ in range(2):
        page.wait_for_function(CELLS)
        assert page.evaluate(CELLS) == wanted
        page.reload()
    page.wait_for_function(CELLS)
    page.get_by_test_id("tab-map").click()
    expect(page.get_by_test_id("map-legend")).to_contain_text("90")
    page.get_by_test_id("map-away").click()
    page.wait_for_function(f"() => {CELL} && !{CELL}.slice")
