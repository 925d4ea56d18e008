"""The curves of a simulation on the page: those of the study, in millimetres of path, with their bands."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("nicegui")

from oracles.published import POSITIONS
from zerorev.cell.ensemble import SIDES, study
from zerorev.cell.possible import finished, possible_arms
from zerorev.cell.reference import Manner
from zerorev.model.job import Job, Settings
from zerorev.model.ranges import Cell
from zerorev.planning.hole import plan
from zerorev.planning.job import unanswered
from zerorev.report.scene.study_curves import DRAWN, torque_curve
from zerorev.web.real_arm import Asked, Simulated
from zerorev.web.state import Steered
from zerorev.web.views.arm_charts import EVERY, stray_options, torque_options

P = POSITIONS[0]
NAMES = ("A1", "A2", "A3", "A4", "A5", "{A6}")


@pytest.fixture(scope="module")
def found(robot, tool):
    """Position 1 on three arms."""
    settings = Settings(min_rate=0.0, lead_in=0.0, proof_boxes=0)
    answer = plan(robot, tool, replace(P.hole, profile=P.profile), settings)
    whole = unanswered(Job(robot, tool, (P.hole,), settings), "asked", (answer,))
    arms = finished(possible_arms(whole, Cell(), 3, 0))
    (of,) = study(whole, arms.sets, manner=Manner(feed=0.1), motions=())
    motion = Steered(answer.motion.profile, answer.motion.branch)
    return Simulated(P.hole, motion, settings, Cell(), Asked(3, 0, 0.1, 0.0), arms, of)


def series(chart, name):
    return next(each for each in chart["series"] if each["id"] == name)


def banded(chart, name):
    """Path, low, median, high of a curve."""
    low, band, median = (np.array(series(chart, f"{name}{part}")["data"]) for part in ("-low", "-band", ""))
    np.testing.assert_array_equal(low[:, 0], median[:, 0])
    return median[:, 0], low[:, 1], median[:, 1], low[:, 1] + band[:, 1]


def test_the_tip_strays_as_in_the_study(found):
    chart = stray_options(found)
    json.dumps(chart, allow_nan=False)
    for k, side in enumerate(SIDES):
        for row, motion in enumerate(DRAWN):
            path, *curves = banded(chart, f"{side}-{motion}")
            np.testing.assert_allclose(path, found.study.path * P.hole.depth * 1e3, atol=1e-4)
            np.testing.assert_allclose(curves, found.study.profile[row, k] * 1e3, atol=2e-4)
            assert chart["yAxis"][k]["max"] > curves[1].max()


def test_torques_are_those_of_the_study_and_change_sign_where_they_are_marked(found):
    chart = torque_options(found, NAMES)
    json.dumps(chart, allow_nan=False)
    marked = 0
    for joint in range(6):
        for row, motion in enumerate(DRAWN):
            path, *curves = banded(chart, f"torque{joint}-{motion}")
            np.testing.assert_allclose(curves, found.study.torque[row, joint][:, ::EVERY], atol=0.02)
            rings = np.array(series(chart, f"torque{joint}-{motion}-changes")["data"]).reshape(-1, 2)
            changes = torque_curve(found.study, motion, joint).changes * P.hole.depth * 1e3
            np.testing.assert_allclose(rings[:, 0], changes, atol=1e-3)
            for place in changes:
                step = 2 * np.diff(path).max()
                near = curves[1][np.abs(path - place) <= step]
                assert near.min() <= 0 <= near.max()
            marked += len(changes)
    assert marked > 0
    assert [title["text"].split("}")[0] for title in chart["title"]][5] == "{n|A6"


def test_without_a_simulation_the_same_series_are_there_empty(found):
    for full, none in (
        (stray_options(found), stray_options(None)),
        (torque_options(found, NAMES), torque_options(None, NAMES)),
    ):
        assert [each["id"] for each in full["series"]] == [each["id"] for each in none["series"]]
        assert not any(each["data"] for each in none["series"])
        assert not any(title["text"] for title in none["title"])
