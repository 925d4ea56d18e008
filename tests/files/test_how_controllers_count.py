"""What a robot file says of its controller: the joints it shows, its base, its pulses; and the arms that ship."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml

from oracles.descriptions import CHAINS, TABLES
from robots import TRIED
from zerorev.errors import InputError
from zerorev.files.conversion import robot_data, robot_from
from zerorev.files.io import read_job, read_robot
from zerorev.files.job_data import job_files
from zerorev.files.robot_schema import RobotForm
from zerorev.model.robot import Display
from zerorev.motion.kinematics import forward

ROOT = Path(__file__).parents[2]
KEYS = {"display", "pulses_per_deg", "base_in_root"}
FANUC, YASKAWA, ABB = ([name for name in TRIED if name.startswith(maker)] for maker in ("fan", "yas", "abb"))
ALL = {
    "display": {"j3_less_j2": True},
    "pulses_per_deg": [1000.0, -2000.5, 1592.888923, 1.0, -1.0, 454.754161],
    "base_in_root": {"xyz_mm": [10.0, -20.0, 505.1], "rpy_deg": [1.0, 90.0, -180.0]},
}


def within_limits(robot, count=200, seed=0):
    lower, upper = robot.limits.lower, robot.limits.upper
    return lower + (upper - lower) * np.random.default_rng(seed).random((count, 6))


def file_of(tmp_path, name="yaskawa_gp8", **keys):
    data = yaml.safe_load((ROOT / f"src/zerorev/files/robots/{name}.yaml").read_text(encoding="utf-8"))
    path = tmp_path / "robot.yaml"
    path.write_text(yaml.safe_dump({key: value for key, value in data.items() if key not in KEYS} | keys))
    return path


# --- the keys ---------------------------------------------------------------------------------------------------------


def test_the_keys_are_read_and_written_again(tmp_path):
    robot = read_robot(file_of(tmp_path, **ALL))
    assert robot.display.j3_less_j2
    assert robot.pulses_per_deg == tuple(ALL["pulses_per_deg"])
    np.testing.assert_allclose(robot.T_root_base[:3, 3], [0.010, -0.020, 0.5051], atol=1e-15)
    # R = Rz(yaw) Ry(pitch) Rx(roll), by hand: X goes down, and Y and Z turn by 181 deg about it
    c, s = np.cos(np.deg2rad(1)), np.sin(np.deg2rad(1))
    np.testing.assert_allclose(robot.T_root_base[:3, :3], [[0, -s, -c], [0, -c, s], [-1, 0, 0]], atol=1e-15)
    data = robot_data(robot)
    assert {key: data[key] for key in KEYS} == ALL
    stated = data.pop("sha256")
    again = robot_data(robot_from(RobotForm.model_validate(json.loads(json.dumps(data)))))
    assert again.pop("sha256") == stated
    assert again == data


def test_a_robot_without_the_keys_is_written_as_before_there_were_any(tmp_path):
    of_before = json.loads((ROOT / "tests/data/program/fuzz.json").read_text())["robot"]
    assert not KEYS & of_before.keys()
    kuka = read_robot("kuka_kr6_r700_2")
    assert robot_data(replace(kuka, dynamics=None))["sha256"] == of_before["sha256"]
    assert not kuka.display.j3_less_j2
    assert kuka.pulses_per_deg is None
    np.testing.assert_array_equal(kuka.T_root_base, np.eye(4))


@pytest.mark.parametrize(
    "keys",
    [
        {"display": {}},
        {"display": {"j3_less_j2": False}},
        {"base_in_root": None, "pulses_per_deg": None},
        {"base_in_root": {"xyz_mm": [0, 0, 0], "rpy_deg": [0, 0, 0]}},
        {"base_in_root": {}},
    ],
)
def test_what_says_nothing_is_left_out(keys, tmp_path):
    plain, said = read_robot(file_of(tmp_path)), read_robot(file_of(tmp_path, **keys))
    assert robot_data(said) == robot_data(plain)
    assert not KEYS & robot_data(said).keys()


@pytest.mark.parametrize("key", sorted(KEYS))
def test_each_key_changes_the_fingerprint(key, tmp_path):
    plain, said = read_robot(file_of(tmp_path)), read_robot(file_of(tmp_path, **{key: ALL[key]}))
    assert robot_data(said)["sha256"] != robot_data(plain)["sha256"]


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"display": {"j3_less_j2": 1}}, r"display\.j3_less_j2: 1 is neither true nor false"),
        ({"display": {"j3_plus_j2": True}}, r"display.*unknown key 'j3_plus_j2'"),
        ({"display": True}, r"display: True is not a mapping.*j3_less_j2"),
        ({"pulses_per_deg": [1.0] * 5}, r"pulses_per_deg: has 5 entries.*six numbers"),
        (
            {"pulses_per_deg": [1.0, 1.0, 1.0, 0.0, 1.0, 1.0]},
            r"pulses_per_deg: is 0 for R \(accepted: six numbers, none",
        ),
        ({"pulses_per_deg": [1.0, 1.0, 1.0, "x", 1.0, 1.0]}, r"pulses_per_deg\[3\]: 'x' is not a number"),
        ({"pulses_per_deg": [1.0, 1.0, 1.0, float("nan"), 1.0, 1.0]}, r"pulses_per_deg\[3\]"),
        ({"base_in_root": {"xyz_mm": [0, 0]}}, r"base_in_root\.xyz_mm: has 2 entries.*three numbers"),
        ({"base_in_root": {"abc_deg": [0, 0, 0]}}, r"base_in_root.*unknown key 'abc_deg'"),
        ({"base_in_root": [0, 0, 330]}, r"base_in_root: .*is not a mapping"),
        ({"base_in_root": {"xyz_mm": [0, 0, 1e9]}}, r"base_in_root\.xyz_mm\[2\]: .*too large"),
    ],
)
def test_one_clear_error(keys, message, tmp_path):
    with pytest.raises(InputError, match=message):
        read_robot(file_of(tmp_path, **keys))


def test_a_display_needs_joints_that_count_in_opposite_senses(tmp_path):
    with pytest.raises(InputError, match=r"display\.j3_less_j2.*same sign.*accepted"):
        read_robot(file_of(tmp_path, "abb_irb4600_60_205", display={"j3_less_j2": True}))


def test_a_job_with_an_arm_of_its_own_keeps_the_keys(tmp_path):
    file_of(tmp_path, **ALL)
    (tmp_path / "job.yaml").write_text(
        "robot: ./robot.yaml\ntool: thesis_drill\n"
        "holes: [{id: a, target_mm: [600, 0, 300], direction: [1, 0, 0], depth_mm: 20}]\n"
    )
    written = yaml.safe_load(job_files(read_job(tmp_path / "job.yaml"))["robot.yaml"])
    assert {key: written[key] for key in KEYS} == ALL


# --- what the controller shows ----------------------------------------------------------------------------------------


def test_a_pendant_beside_the_joints_that_turn():
    # github:ros-industrial/fanuc_experimental#17: joint_states of the driver [rad], and J3 on the pendant [deg]
    turned = np.array([0.2743533253669739, 0.5467115640640259, -0.035214900970458984, 1.2852824926376343,
                       -1.7649667263031006, -0.5436538457870483])  # fmt: skip
    shown = np.rad2deg(read_robot("fanuc_lrmate200id").shown(turned))
    assert shown[2] == pytest.approx(-33.342, abs=5e-4)
    np.testing.assert_array_equal(np.delete(shown, 2), np.delete(np.rad2deg(turned), 2))


@pytest.mark.parametrize("name", [*FANUC, "yaskawa_gp8"])
def test_there_and_back(name):
    robot = read_robot(name)
    joints = within_limits(robot).reshape(10, 20, 6)
    before = joints.copy()
    shown = robot.shown(joints)
    np.testing.assert_allclose(robot.from_shown(shown), joints, atol=1e-14)
    np.testing.assert_allclose(robot.shown(robot.from_shown(joints)), joints, atol=1e-14)
    np.testing.assert_array_equal(joints, before)
    assert np.array_equal(shown, joints) == (not robot.display.j3_less_j2)
    assert np.shares_memory(shown, joints) is False


@pytest.mark.parametrize("name", FANUC)
def test_shown_joint_3_is_the_forearm_s_angle_against_the_ground(name):
    robot = read_robot(name)
    joints = within_limits(robot)
    joints[:, 4:] = 0.0
    flange = forward(robot, joints)  # with a straight wrist its Z lies along the forearm
    elevation = np.arcsin(np.clip(flange[:, 2, 2], -1, 1))
    np.testing.assert_allclose(np.sin(robot.shown(joints)[:, 2]), np.sin(elevation), atol=1e-12)


# --- the arms that ship -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", CHAINS)
def test_the_arm_is_that_of_its_description(name):
    robot, chain = read_robot(name), CHAINS[name]
    joints = within_limits(robot)
    expected = np.array([chain.forward(each) for each in joints])
    np.testing.assert_allclose(forward(robot, joints), expected, atol=1e-11)
    np.testing.assert_allclose(robot.T_root_base[:3, 3], [0, 0, chain.base], atol=1e-15)
    np.testing.assert_array_equal(robot.T_root_base[:3, :3], np.eye(3))


@pytest.mark.parametrize("name", TABLES)
def test_joints_as_shown_put_the_flange_where_the_controller_says(name):
    robot, table = read_robot(name), TABLES[name]
    joints = within_limits(robot, seed=1)
    expected = np.array([table.forward(each) for each in robot.shown(joints)])
    np.testing.assert_allclose(np.linalg.inv(robot.T_root_base) @ forward(robot, joints), expected, atol=1e-11)


def test_two_fanuc_three_yaskawa_and_three_abb_ship():
    assert len(FANUC) >= 2
    assert len(YASKAWA) >= 3
    assert len(ABB) >= 3
    for robot in map(read_robot, FANUC):
        assert robot.display == Display(j3_less_j2=True)
    for robot in map(read_robot, FANUC + YASKAWA):
        assert robot.T_root_base[2, 3] == pytest.approx(robot.arm.c1)  # both count from the height of axis 2
    for robot in map(read_robot, TRIED):
        assert {key for key in KEYS if key in robot_data(robot)} <= robot.sources.keys()


def test_pulses_of_the_ma2010_are_those_of_a_pendant_beside_its_degrees():
    # github:rpiRobotics/dx200_motion_progam_exec config/MA_2010_A0_pulse2deg_recording{1,2}.csv @ 0a91a5d762ce; the
    # degrees that this pendant shows of L, R and T have the other sign than the joints of the description
    pulses = np.array([[5504, 68994, 1678, 3751, 2726, 9171], [-42470, -13574, -27271, -31575, -4651, -7760]])
    degrees = np.array([
        [4.1032, -36.1665, 1.0534, -3.6671, 2.7809, -20.1669], [-31.66, 7.1154, -17.1204, 30.8692, -4.7447, 17.0641],
    ])  # fmt: skip
    joints = degrees * [1, -1, 1, -1, 1, -1]
    np.testing.assert_allclose(joints * read_robot("yaskawa_ma2010").pulses_per_deg, pulses, rtol=1e-4)
