"""The pictures, the page and the lines of a parameter map show what is in it."""

from __future__ import annotations

import re

import numpy as np
import pytest
from matplotlib.colors import to_rgb

from zerorev.report.figures import style
from zerorev.thesis.figures.parameter_map import parameter_slices, zero_volume
from zerorev.thesis.figures.parameter_map_page import map_page
from zerorev.thesis.measures import Mirrored
from zerorev.thesis.parameter_map import parameter_map
from zerorev.thesis.parameter_map_lines import map_lines
from zerorev.thesis.sampled import Weighing


@pytest.fixture(scope="module")
def found(robot, tool, positions):
    return parameter_map(robot, tool, positions[0].hole, size=24)


def test_slices_have_units_start_across_end_up_and_the_colours_of_reversals(robot, tool, positions):
    at = {"size": 24, "psi_target": [0.0]}
    slices = {turns: parameter_map(robot, tool, positions[0].hole, Weighing(turns=turns), **at)
              for turns in ("after_extents", "first_point")}  # fmt: skip
    figure = parameter_slices(slices)
    upper, lower = figure.axes[0:2], figure.axes[2:4]
    assert [axes.get_title(loc="left") for axes in upper] == list(slices)
    assert all("[deg]" in axes.get_xlabel() for axes in lower)
    assert all("[deg]" in axes.get_ylabel() for axes in (upper[0], lower[0]))
    assert "[1]" in figure.axes[4].get_ylabel()
    for axes, each in zip(lower, slices.values(), strict=True):
        image, reversals = axes.images[0], each["reversals"].values[0]
        colours = image.cmap(image.norm(image.get_array()))[..., :3]
        for s, e in np.ndindex(reversals.shape):
            count = reversals[s, e]
            wanted = style.CANNOT_RUN if count < 0 else style.REVERSAL_COLOURS[min(count, 6)]
            assert colours[e, s] == pytest.approx(to_rgb(wanted), abs=0.01)
    shown = upper[1].images[0].get_array()
    cell = slices["first_point"].isel(psi_target_deg=0, psi_start_deg=8, psi_end_deg=15)
    assert int(cell["reversals"]) >= 0
    assert shown[15, 8] == float(cell["score"])


def test_volume_shows_every_cell_without_reversals(found):
    figure = zero_volume(found)
    axes = figure.axes[0]
    zero = int((found["reversals"].values == 0).sum())
    assert f"{zero:,}" in figure.texts[0].get_text()
    *shadows, points = axes.collections
    assert len(shadows) == 3
    x, y, z = points._offsets3d
    assert len(x) == zero
    for s, e, t in zip(x, y, z, strict=True):
        assert int(found["reversals"].sel(psi_start_deg=s, psi_end_deg=e, psi_target_deg=t)) == 0
    assert all("[deg]" in label for label in (axes.get_xlabel(), axes.get_ylabel(), axes.get_zlabel()))


def test_a_map_without_zeros_is_drawn_and_described(robot, tool, positions):
    none = parameter_map(robot, tool, positions[1].hole, size=4)
    assert (none["reversals"].values != 0).all()
    assert "0 of 64" in zero_volume(none).texts[0].get_text()
    assert "Plotly.newPlot" in map_page(none)
    assert "zero reversals: 0 cells, 0 %" in map_lines(none, {})[0]


def test_page_asks_nothing_of_the_network_and_thins_out_large_maps(found):
    page = map_page(found)
    assert not re.search(r"<(script|link|img)[^>]+(src|href)=", page)
    assert page.count("Plotly.addFrames") == 1
    assert page.count("</script>") == page.count("<script")
    wide = found.isel({name: np.arange(240) % 24 for name in found.sizes}).assign_coords(
        {name: np.linspace(-180, 180, 240) for name in found.sizes}
    )
    assert len(map_page(wide)) < 15e6


def test_lines_name_the_best_cell_and_both_mirrors(found):
    mirrors = {"after_extents": Mirrored(0.0, 0.0, 0.0), "first_point": Mirrored(0.0371, 1.0, 0.0139)}
    first, best, after, at_first = map_lines(found, mirrors)
    assert first.startswith("24 x 24 x 24 motions")
    assert "branch 4, 0 reversals" in best
    assert "0 % of the cells differ" in after
    assert "3.71 % of the cells differ from their mirror, by 1 at most; 1.39 % cannot" in at_first
