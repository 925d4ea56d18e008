"""The bracket on the page: the words and the picture say the same as the rates do."""

from __future__ import annotations

import json

import numpy as np
import pytest

pytest.importorskip("nicegui")

from oracles.published import POSITIONS
from zerorev.model.profile import Profile
from zerorev.motion.drilling import Drilling
from zerorev.report.scene.bracket import bracket
from zerorev.web.views.bracket import options, sentence

NAMES = ("A1", "A2", "A3", "A4", "A5", "{A6}")
STEP = float(np.deg2rad(1.0))


def rates_of(robot, tool, psi_deg):
    hole = POSITIONS[0].hole
    return bracket(Drilling(robot, tool, hole), Profile.straight(hole.depth, *np.deg2rad(psi_deg)), 4, STEP)


def series(chart, name):
    return next(each for each in chart["series"] if each["id"] == name)


def test_all_between(robot, tool):
    rates = rates_of(robot, tool, POSITIONS[0].psi_deg)
    assert sentence(rates, NAMES).endswith("no joint reverses at the target.")
    chart = options(rates, NAMES)
    json.dumps(chart, allow_nan=False)
    points = series(chart, "crossings")["data"]
    assert [point["label"]["formatter"] for point in points] == [*NAMES[:5], "A6"]
    for point, rate in zip(points, rates.here, strict=True):
        np.testing.assert_allclose(point["value"], [np.rad2deg(rates.chosen), rate], atol=1e-3)


def test_who_is_out_is_named_and_marked(robot, tool):
    rates = rates_of(robot, tool, (0, 0, 0))
    assert not rates.between.any()
    words = sentence(rates, NAMES)
    assert words.startswith("A1, A2, A3, A4, A5 and {A6} stand still")
    assert words.endswith("so they reverse at the target.")
    assert all("✕" in point["label"]["formatter"] for point in series(options(rates, NAMES), "crossings")["data"])


def test_the_band_is_between_the_slopes_and_the_lines_are_named(robot, tool):
    rates = rates_of(robot, tool, POSITIONS[0].psi_deg)
    slopes = series(options(rates, NAMES), "slopes")
    band = [edge["yAxis"] for edge in slopes["markArea"]["data"][0]]
    np.testing.assert_allclose(band, sorted(rates.slopes), atol=1e-5)
    plunge, retract, spin = slopes["markLine"]["data"]
    assert plunge["label"]["formatter"].startswith("plunge")
    assert retract["yAxis"] == pytest.approx(rates.slopes[1], abs=1e-5)
    assert spin["xAxis"] == pytest.approx(np.rad2deg(rates.chosen), abs=1e-3)


def test_without_a_motion_the_same_series_are_there_empty(robot, tool):
    full, none = options(rates_of(robot, tool, (1, 0, -1)), NAMES), options(None, ())
    assert [each["id"] for each in full["series"]] == [each["id"] for each in none["series"]]
    assert not any(each["data"] for each in none["series"])
