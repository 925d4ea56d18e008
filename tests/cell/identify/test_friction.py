"""Friction and tool mass out of sweeps: exact of exact equations, near of an arm of known parameters."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from oracles.sweeps import known_arm, recorded
from zerorev.cell.identify.cell import identified
from zerorev.cell.identify.friction import fitted
from zerorev.cell.identify.segments import Segment, segments
from zerorev.cell.recordings.krc4_write import write_krc4
from zerorev.cell.recordings.read import read_recording
from zerorev.cell.recordings.table import write_csv
from zerorev.errors import InputError
from zerorev.model.dynamics import nominal_drives

COULOMB = np.array([18.0, 31.0, 17.0, 8.0, 11.0, 5.0])
VISCOUS = np.array([8.0, 15.0, 3.5, 3.6, 1.6, 1.8])


def made_up(mass: float, lever: float, peak: float, fade: float) -> list[Segment]:
    """Segments that satisfy the equations exactly, without a kernel."""
    chance = np.random.default_rng(1)
    found = []
    for joint in range(6):
        for speed in (0.03, 0.06, 0.12, 0.25, 0.5):
            for sense in (1, -1):
                v, bare, flange, moment = sense * speed, *chance.uniform(-30, 30, 1), *chance.uniform(-3, 3, 2)
                friction = sense * COULOMB[joint] * (1 + (peak - 1) * np.exp(-((v / fade) ** 2))) + VISCOUS[joint] * v
                torque = bare + mass * (flange + lever * moment) + friction
                found.append(Segment(joint, v, torque, bare, flange, moment, 0.1, 0.0, 100))
    return found


@pytest.mark.parametrize(("peak", "fade"), [(1.3, 0.03), (1.15, 0.045), (1.5, 0.022)])
def test_exact_segments_give_back_what_they_were_made_of(robot, peak, fade):
    found = fitted(made_up(0.8, 0.55, peak, fade), robot, "made up")
    assert found.coulomb[0] == pytest.approx(COULOMB, rel=2e-3)
    assert found.viscous[0] == pytest.approx(VISCOUS, rel=2e-2)
    assert found.mass[0] == pytest.approx(0.8, rel=1e-3)
    assert found.lever[0] == pytest.approx(0.55, rel=1e-2)
    assert found.stribeck[0] == pytest.approx(fade, rel=2e-2)
    assert found.breakaway[0] == pytest.approx(peak, rel=1e-2)
    for low, high, true in zip(found.coulomb[1], found.coulomb[2], COULOMB, strict=True):
        assert low <= true <= high


def as_recorded(recording, folder, how):
    """Through the bytes of a real file."""
    if how == "csv":
        write_csv(recording, folder / "sweeps.csv")
        return read_recording(folder / "sweeps.csv")
    return read_recording(write_krc4(recording, folder / "SWEEPS")[0])


def check_recovered(found, arm, robot):
    true, nominal = arm.arm(robot.dynamics), nominal_drives(robot.dynamics.payload).coulomb
    off = np.abs(found.friction.coulomb[0] / true.coulomb - 1)
    assert np.median(off) <= 0.03, off
    assert off.max() <= 0.08, off
    assert abs(found.friction.mass[0] / arm["tool_mass"] - 1) <= 0.10
    for joint in range(6):
        each = found.cell.ranges[f"friction_{joint + 1}"]
        assert each.basis == "fitted"
        assert each.low <= true.coulomb[joint] / nominal[joint] * 1.02
        assert each.high >= true.coulomb[joint] / nominal[joint] * 0.98
    assert {name for name, each in found.cell.ranges.items() if each.basis == "conditioned"} == set()
    assert {found.cell.ranges[name].basis for name in ("gap", "stiffness", "behind", "bandwidth")} == {"prior"}


def test_an_arm_of_known_parameters_is_recovered(plan, meant, sweeps, recording, arm, tmp_path):
    read = as_recorded(recording, tmp_path, "csv")
    found = identified(plan, meant.drilling, sweeps.posture, [read])
    check_recovered(found, arm, plan.robot)


@pytest.mark.long
@pytest.mark.parametrize("seed", [4, 8])
def test_more_arms_are_recovered_from_traces(plan, meant, sweeps, reference, tmp_path, seed, request):
    arm = known_arm(seed)
    read = as_recorded(recorded(reference, arm, seed=seed), tmp_path, "krc4")
    found = identified(plan, meant.drilling, sweeps.posture, [read])
    check_recovered(found, arm, plan.robot)
    off = np.abs(found.friction.coulomb[0] / arm.arm(plan.robot.dynamics).coulomb - 1)
    words = f"dry friction off by {100 * np.median(off):.2f} % in the median joint, {100 * off.max():.2f} % at most; "
    words += f"tool mass off by {100 * abs(found.friction.mass[0] / arm['tool_mass'] - 1):.1f} %"
    request.node.user_properties.append(("measured", words))


def test_torques_of_the_motors_are_taken_by_their_ratio(meant, sweeps, recording, plan):
    ratio = np.array([101.0, -101.0, 88.5, 50.0, 50.0, 40.0])
    motors = replace(recording, torque=recording.torque / ratio)
    ours = segments(recording, meant.drilling, sweeps.posture)
    theirs = segments(motors, meant.drilling, sweeps.posture, ratio)
    assert [each.torque for each in theirs] == pytest.approx([each.torque for each in ours])
    with pytest.raises(InputError, match="--torque-ratio"):
        fitted(segments(motors, meant.drilling, sweeps.posture), plan.robot, "motors")


def shortened(recording, keep):
    arrays = {name: getattr(recording, name)[keep] for name in ("time", "joints", "joints_commanded", "torque")}
    return replace(recording, **arrays)


BAD = {
    "no torque": (lambda r: replace(r, torque=None), "no torque is recorded"),
    "still": (lambda r: replace(r, joints=r.joints * 0 + r.joints[0], joints_commanded=None), "no joint moves alone"),
    "elsewhere": (lambda r: replace(r, joints=r.joints + np.deg2rad([0, 0, 30, 0, 0, 0])), "A3 is 30.0 deg from where"),
    "another robot": (lambda r: replace(r, joints=r.joints * 50), "beyond its limit"),
    "too slow": (lambda r: shortened(r, slice(None, None, 9)), "one sample every 108 ms"),
    "one speed": (lambda r: shortened(r, slice(0, 900)), "moves alone upwards at 1 even speeds"),
}


@pytest.mark.parametrize("name", BAD)
def test_recordings_that_cannot_be_used_are_refused_by_one_message(plan, meant, sweeps, recording, name):
    change, said = BAD[name]
    with pytest.raises(InputError) as error:
        identified(plan, meant.drilling, sweeps.posture, [change(recording)])
    assert said in str(error.value)
    assert "made up" in str(error.value)
    assert error.value.accepted


def test_a_robot_without_masses_is_refused(plan, meant, sweeps, recording):
    bare = replace(plan, robot=replace(plan.robot, dynamics=None))
    with pytest.raises(InputError, match="the masses of the robot kuka_kr6_r700_2 are not known"):
        identified(bare, meant.drilling, sweeps.posture, [recording])
