"""All robots that ship: against an outside library, against each other's names, and as `zerorev robots` finds them."""

from __future__ import annotations

import json

import numpy as np
import py_opw_kinematics as opw
import pytest

from zerorev.cli import main
from zerorev.files.io import read_robot, robot_names
from zerorev.model.hole import Hole
from zerorev.motion.drilling import Drilling, joint_rates
from zerorev.motion.kinematics import forward, inverse, tcp_pose

ROBOTS = [read_robot(name) for name in robot_names()]
STEP = 1e-5


def test_there_are_as_many_as_the_docs_say():
    assert len(ROBOTS) >= 120
    assert len({robot.manufacturer for robot in ROBOTS}) == 5
    assert len({(robot.manufacturer, robot.model) for robot in ROBOTS}) == len(ROBOTS)


def test_each_agrees_with_a_second_source_or_says_that_it_has_none():
    for robot in ROBOTS:
        agrees = any("agrees" in line for line in robot.second_sources)
        assert agrees or any(line.startswith("One source alone") for line in robot.caveats), robot.name
        assert {"geometry", "sign", "offset", "limits", "speed"} <= robot.sources.keys(), robot.name
        assert robot.payload is None or "payload" in robot.sources, robot.name


def test_limits_are_those_of_an_arm():
    for robot in ROBOTS:
        limits = robot.limits
        assert (limits.upper - limits.lower > np.deg2rad(50)).all(), robot.name
        assert (limits.upper - limits.lower < np.deg2rad(1000)).all(), robot.name
        assert 0.3 < robot.wrist_reach < 4.0, robot.name


@pytest.mark.parametrize("maker", sorted({robot.manufacturer for robot in ROBOTS}))
def test_poses_joints_and_rates_are_those_of_an_outside_library(maker, tool):
    rng = np.random.default_rng(7)
    back = np.linalg.inv(tool.T_flange_tcp)
    for robot in (robot for robot in ROBOTS if robot.manufacturer == maker):
        arm = robot.arm
        model = opw.KinematicModel(*arm[:7], offsets=arm.offset, flip_axes=tuple(sign < 0 for sign in arm.sign))
        theirs = opw.Robot(model, degrees=False)
        joints = rng.uniform(robot.limits.lower, robot.limits.upper, (40, 6))
        bent = np.abs(np.sin(robot.bend(joints))) > 0.2
        T = forward(robot, joints[bent])
        for pose, q in zip(T[:10], joints[bent], strict=False):
            np.testing.assert_allclose(theirs.forward(q).as_matrix(), pose, atol=1e-9)
        found, wanted = inverse(robot, T), theirs.reach(opw.RigidTransform.from_matrix(T)).joints
        apart = np.abs(np.angle(np.exp(1j * (found[:, :, None] - wanted[:, None]))))
        nearest = np.nan_to_num(apart.max(axis=-1), nan=9.0).min(axis=2)
        assert nearest[~np.isnan(found).any(axis=-1)].max() < 1e-6, robot.name
        # rates along the drill axis and round it, by differences of the library's joints
        compared = 0
        for q in joints[bent][:12]:
            tip = forward(robot, q) @ tool.T_flange_tcp
            hole = Hole("here", tip[:3, 3], -tip[:3, 2], 0.01, psi_zero=tip[:3, 1])
            branch = int(np.nanargmin(np.abs(np.angle(np.exp(1j * (inverse(robot, tip @ back) - q)))).max(axis=-1)))
            for k, rate in enumerate(joint_rates(Drilling(robot, tool, hole), 0.0, 0.0)):
                ahead, behind = (
                    theirs.reach(opw.RigidTransform.from_matrix(
                        (tcp_pose(hole, *(STEP * side * np.eye(2)[k])) @ back)[None])).joints[0]
                    for side in (1, -1)
                )  # fmt: skip
                near = [
                    side[np.nanargmin(np.nan_to_num(np.abs(np.angle(np.exp(1j * (side - q)))).max(axis=-1), nan=9.0))]
                    for side in (ahead, behind)
                ]
                slope = np.angle(np.exp(1j * (near[0] - near[1]))) / (2 * STEP)
                if np.abs(rate[branch]).max() < 20:
                    np.testing.assert_allclose(slope, rate[branch], atol=2e-4 * (1 + np.abs(rate[branch]).max() ** 3))
                    compared += 1
        assert compared >= 6, robot.name


def names(capsys, *words):
    assert main(["robots", "--json", *words]) == 0
    return {sheet["name"] for sheet in json.loads(capsys.readouterr().out)}


def test_they_are_found_by_maker_reach_and_load(capsys):
    every = {robot.name: robot for robot in ROBOTS}
    assert names(capsys) == set(every)
    large = names(capsys, "--reach-mm", "2000:", "--payload-kg", "100:")
    assert large == {
        name for name, robot in every.items()
        if robot.wrist_reach >= 2.0 and robot.rated_load is not None and robot.rated_load >= 100
    }  # fmt: skip
    assert 20 < len(large) < 60
    assert names(capsys, "--maker", "staubli", "--reach-mm", ":1000") <= {n for n in every if n.startswith("staubli")}
    assert main(["robots", "--payload-kg", "5:6"]) == 0
    out = capsys.readouterr()
    assert f"of {len(every)} robots" in out.out
    assert "the rated load of" in out.err


@pytest.mark.parametrize("text", ["a:b", "100", "1:2:3", ""])
def test_a_range_that_is_none(text, capsys):
    assert main(["robots", "--reach-mm", text]) == 2
    assert "FROM:TO" in capsys.readouterr().err
