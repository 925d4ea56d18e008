"""The program of the sweeps: one joint at a time, within its limits, never faster than the operator lets it."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from zerorev.errors import InputError, NotExportableError
from zerorev.motion.kinematics import forward
from zerorev.program.krl.sweeps import sweeps_to_krl
from zerorev.program.sweeps import AMPLITUDE, SPEEDS, sweeps_of


def test_every_joint_has_every_speed(sweeps):
    greatest = sweeps.drilling.robot.limits.speed
    for joint in range(6):
        own = sorted((sweep.speed for sweep in sweeps.sweeps if sweep.joint == joint), reverse=True)
        # a percentage is whole: the coarsest step that a joint of 540 deg/s has at 0.12 rad/s is a half
        assert own == pytest.approx(SPEEDS, rel=0.35)
        assert own[-1] == pytest.approx(SPEEDS[-1], rel=0.02)
    for sweep in sweeps.sweeps:
        assert sweep.speed == pytest.approx(greatest[sweep.joint] * sweep.percent * sweep.override / 1e4)
        assert 1 <= sweep.percent <= 100
        assert 1 <= sweep.override <= 100
        assert 4 * AMPLITUDE * sweep.cycles / sweep.speed >= 2.0


def test_the_text_moves_one_axis_at_a_time_within_its_limits(sweeps):
    text = sweeps_to_krl(sweeps, "my sweeps")
    assert "DEF my_sweeps_" in text
    lines = re.findall(r"(?m)^PTP \{AXIS: (.*)\}$", text)
    axes = np.array([[float(part.split()[1]) for part in line.split(",")] for line in lines])
    assert len(axes) == 1 + sum(2 * sweep.cycles + 1 for sweep in sweeps.sweeps)
    limits = sweeps.drilling.robot.limits
    assert (np.deg2rad(axes) >= limits.lower).all()
    assert (np.deg2rad(axes) <= limits.upper).all()
    off = np.abs(axes - np.rad2deg(sweeps.posture)) > 1e-4
    assert off.sum(axis=1).max() == 1
    assert np.abs(axes - np.rad2deg(sweeps.posture)).max() == pytest.approx(8.0, abs=1e-4)
    ratings = [int(value) for value in re.findall(r"\$OV_PRO=(\d+)", text)]
    assert ratings == sorted(ratings, reverse=True)
    assert len(re.findall(r"IF \$OV_PRO>(\d+) THEN\n\$OV_PRO=\1\nENDIF", text)) == len(ratings)
    assert "no part in place" in text
    assert text.isascii()


def test_the_tip_stays_in_the_box_that_is_stated(sweeps, meant):
    chance = np.random.default_rng(0)
    postures = np.repeat(sweeps.posture[None], 600, axis=0)
    postures[np.arange(600), np.arange(600) % 6] += chance.uniform(-AMPLITUDE, AMPLITUDE, 600)
    tips = (forward(meant.drilling.robot, postures) @ meant.drilling.tool.T_flange_tcp)[:, :3, 3]
    assert (tips >= sweeps.box[0] - 1e-4).all()
    assert (tips <= sweeps.box[1] + 1e-4).all()


def test_where_a_sweep_does_not_fit_it_is_refused(meant):
    joints = meant.motion.joints.copy()
    joints[0, 4] = meant.drilling.robot.limits.upper[4] - np.deg2rad(3.0)
    with pytest.raises(InputError, match=r"hole position_1: A5 is 3\.0 deg from its limit .*accepted: another hole"):
        sweeps_of(meant.drilling, replace(meant.motion, joints=joints))


def test_only_a_kuka_runs_krl(sweeps):
    robot = replace(sweeps.drilling.robot, manufacturer="ABB")
    with pytest.raises(NotExportableError, match="KRL runs on KUKA"):
        sweeps_to_krl(replace(sweeps, drilling=replace(sweeps.drilling, robot=robot)), "sweeps")
