"""The joint curves on the page: as they are along the motion, with its reversals where they are."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("nicegui")

from oracles.published import POSITIONS
from zerorev.model.job import Settings
from zerorev.model.profile import Profile
from zerorev.model.robot import Display
from zerorev.motion.drilling import Drilling
from zerorev.motion.kinematics import forward, tcp_pose
from zerorev.report.scene.motion_look import curves, held, look
from zerorev.web.views.curves import options

P = POSITIONS[0]


def chart_of(robot, tool, profile):
    drilling = Drilling(robot, tool, P.hole)
    found = curves(drilling, profile, P.branch, Settings(), 60)
    here, constant = (look(drilling, each, P.branch, Settings()) for each in (profile, held(profile)))
    return options(found, here, constant), here, constant


def series(chart, name):
    return next(each for each in chart["series"] if each["id"] == name)


def test_the_curves_are_joint_angles_that_hold_the_tool_where_the_spin_says(robot, tool):
    chart, _, _ = chart_of(robot, tool, P.profile)
    json.dumps(chart, allow_nan=False)
    points = np.array([series(chart, f"planned{i}")["data"] for i in range(6)])
    across, angles = points[:, :, 0], np.deg2rad(points[:, :, 1].T)
    np.testing.assert_array_equal(across, np.tile(across[0], (6, 1)))
    standoff, psi = P.profile.at(across[0] / 1e3 + P.hole.depth)
    there = forward(robot, angles) @ tool.T_flange_tcp
    np.testing.assert_allclose(there, tcp_pose(P.hole, standoff, psi), atol=2e-4)


def test_a_curve_names_the_joint_that_turns(robot, tool):
    shows_ground = replace(robot, arm=robot.arm._replace(sign=(-1, 1, -1, -1, 1, -1)), display=Display(j3_less_j2=True))
    names = curves(Drilling(shows_ground, tool, P.hole), P.profile, P.branch, Settings(), 20).names
    assert names == ("A1", "A2", "A3 against link 2", "A4", "A5", "A6")
    assert curves(Drilling(robot, tool, P.hole), P.profile, P.branch, Settings(), 20).names == robot.joint_names


def test_each_reversal_is_marked_on_its_joint_where_it_is(robot, tool):
    profile = Profile.straight(P.hole.depth, *np.deg2rad((20, 10, 30)))
    chart, here, constant = chart_of(robot, tool, profile)
    assert here.reversals > 0
    for i in range(6):
        marked = [mark["value"] for mark in series(chart, f"turns{i}")["data"]]
        wanted = [mark.distance * 1e3 for each in (constant, here) for mark in each.marks if mark.joint == i + 1]
        np.testing.assert_allclose([value[0] for value in marked], wanted, atol=1e-3)
        count = here.score.reversals_per_joint[i]
        assert chart["title"][i]["text"].endswith(f"{constant.score.reversals_per_joint[i]} → {count}}}")


def test_a_limit_is_shaded_where_it_is_in_view(robot, tool):
    chart, here, _ = chart_of(robot, tool, P.profile)
    near = np.rad2deg(here.score.limit_distance)
    for i in range(6):
        shaded = series(chart, f"baseline{i}")["markArea"]["data"]
        low, high = chart["yAxis"][i]["min"], chart["yAxis"][i]["max"]
        lower, upper = np.rad2deg([robot.limits.lower[i], robot.limits.upper[i]])
        assert bool(shaded) == (low < lower or high > upper)
        if near[i] > 180:
            assert not shaded


def test_where_the_robot_cannot_follow_there_is_a_gap_and_no_number(robot, tool):
    chart, here, _ = chart_of(robot, tool, Profile.straight(P.hole.depth, 0.0, 0.0, 3.1))
    assert not here.runs
    json.dumps(chart, allow_nan=False)
    assert any(up is None for _, up in series(chart, "planned0")["data"])
    assert "?" in chart["title"][0]["text"]


def test_without_a_motion_the_same_series_are_there_empty(robot, tool):
    full, none = chart_of(robot, tool, P.profile)[0], options(None, None, None)
    assert [each["id"] for each in full["series"]] == [each["id"] for each in none["series"]]
    assert not any(each["data"] for each in none["series"])
