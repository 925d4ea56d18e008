"""Masses in robot and tool files: read, written, and what is wrong with them said."""

from __future__ import annotations

import pytest
import yaml

from zerorev.errors import InputError
from zerorev.files.conversion import robot_data, robot_from, tool_data, tool_from
from zerorev.files.io import read_robot, read_tool
from zerorev.files.robot_schema import RobotForm, ToolForm

ROBOTS = ["kuka_kr6_r700_2", "abb_irb1200_5_90"]


@pytest.mark.parametrize("name", ROBOTS)
def test_a_robot_is_written_and_read_again(name):
    data = robot_data(read_robot(name))
    stated = data.pop("sha256")
    assert robot_data(robot_from(RobotForm.model_validate(data)))["sha256"] == stated
    assert len(data["dynamics"]["links"]) == 6


def test_a_robot_without_masses_has_the_fingerprint_that_it_had_before_there_were_any():
    assert "dynamics" not in robot_data(read_robot("yaskawa_gp8"))


def test_a_tool_is_written_and_read_again():
    data = tool_data(read_tool("thesis_drill"))
    stated = data.pop("sha256")
    assert data["mass_kg"] == 0.3
    assert tool_data(tool_from(ToolForm.model_validate(data)))["sha256"] == stated


def changed(**links):
    data = yaml.safe_load(yaml.safe_dump(robot_data(read_robot(ROBOTS[0]))))
    del data["sha256"]
    data["format"] = "zerorev.robot/1"
    data["dynamics"]["links"][2] |= links
    return data


@pytest.mark.parametrize(
    ("links", "message"),
    [
        ({"mass_kg": -1.0}, r"dynamics.links\[2\].mass_kg.*above 0"),
        ({"inertia_kgm2": [1.0, 0, 0, 0.1, 0, 0.1]}, r"dynamics.links\[2\].*the inertia of no body.*none greater"),
        ({"inertia_kgm2": [1.0]}, r"dynamics.links\[2\].inertia_kgm2"),
        ({"com_mm": [1.0, 2.0]}, r"dynamics.links\[2\].com_mm"),
        ({"weight": 1.0}, r"unknown key 'weight'"),
    ],
)
def test_a_link_that_is_none(links, message, tmp_path):
    path = tmp_path / "robot.yaml"
    path.write_text(yaml.safe_dump(changed(**links)))
    with pytest.raises(InputError, match=message):
        read_robot(path)


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"mass_kg": 1.0}, "com_mm: is missing"),
        ({"com_mm": [0, 0, 10]}, "mass_kg: is missing"),
        ({"mass_kg": 0.0, "com_mm": [0, 0, 10]}, "mass_kg.*above 0"),
        ({"mass_kg": 1.0, "com_mm": [0, 0, 10], "inertia_kgm2": [1, 0, 0, 0.1, 0, 0.1]}, "the inertia of no body"),
    ],
)
def test_a_load_that_is_none(keys, message, tmp_path):
    path = tmp_path / "tool.yaml"
    path.write_text(
        yaml.safe_dump({"format": "zerorev.tool/1", "name": "t", "tcp_mm": [0, 0, 100], "rpy_deg": [0, 0, 0]} | keys)
    )
    with pytest.raises(InputError, match=message):
        read_tool(path)


def test_a_criterion_that_takes_masses_needs_them(tmp_path):
    from zerorev.files.io import read_job

    job = {
        "robot": "yaskawa_gp8", "tool": "thesis_drill", "objective": {"lost_motion": 1},
        "holes": [{"id": "a", "target_mm": [600, 0, 300], "direction": [1, 0, 0], "depth_mm": 20}],
    }  # fmt: skip
    path = tmp_path / "job.yaml"
    path.write_text(yaml.safe_dump(job))
    with pytest.raises(
        InputError, match=r"lost_motion needs the masses of the robot yaskawa_gp8.*dynamics in the robot"
    ):
        read_job(path)
