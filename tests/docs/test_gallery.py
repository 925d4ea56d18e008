"""The gallery has every public figure once, with a picture that is one and its explanation."""

from __future__ import annotations

import re

import numpy as np
import pytest
from PIL import Image
from tools import gallery

from zerorev import figures


def test_the_page_is_up_to_date():
    assert gallery.PAGE.read_text(encoding="utf-8") == gallery.text(), "run `python tools/gallery.py`"


def test_it_has_exactly_the_public_figures():
    listed = re.findall(r"(?m)^::: zerorev\.figures\.(\w+)$", gallery.PAGE.read_text(encoding="utf-8"))
    assert sorted(listed) == sorted(gallery.DRAWN) == figures.__all__
    assert sorted(path.stem for path in gallery.PICTURES.glob("*.png")) == figures.__all__


def test_every_picture_is_small_and_not_blank():
    for path in gallery.PICTURES.glob("*.png"):
        assert path.stat().st_size < 100_000, path
        with Image.open(path) as image:
            assert image.width == 1200
            assert np.ptp(np.asarray(image.convert("L"))) > 150


def test_every_figure_is_explained_on_the_built_page(site):
    built = (site / "reference/gallery.html").read_text(encoding="utf-8")
    assert [name for name in figures.__all__ if f'id="zerorev.figures.{name}"' not in built] == []
    explained = re.findall(r"to draw (?:the strokes at one angle )?into", built)
    assert len(explained) == 9  # the argument of those that have one axes


QUICK = {
    "joint_angles",
    "twist_plane",
    "critical_rates",
    "map_planes",
    "map_surface",
    "map_views",
    "map_cell",
    "zero_volume",
    "robot_catalogue",
}


@pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=pytest.mark.long if name in QUICK else pytest.mark.soak) for name in gallery.DRAWN],
)
def test_every_picture_can_be_drawn_again(name):
    assert any(axes.has_data() for axes in gallery.DRAWN[name]().axes)
