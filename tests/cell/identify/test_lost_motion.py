"""Reversal values: the formula against the simulated arm, and what values say of gap and stiffness."""

from __future__ import annotations

import numpy as np
import pytest

from oracles.sweeps import known_arm, moved
from zerorev.cell.followed import STEP, Followed
from zerorev.cell.identify.lost_motion import (
    Reversal,
    loads_at,
    lost_motion_ranges,
    read_reversals,
    reversal_value,
)
from zerorev.cell.parameters import ARCMIN, ParameterSet
from zerorev.cell.plant import run
from zerorev.errors import InputError
from zerorev.model.dynamics import nominal_drives
from zerorev.model.ranges import RANGES

SPEED = 0.06
SWING = np.deg2rad(2.0)
GEARS = {
    "kind": 0.0, "breakaway": 1.1, "stribeck": 0.02, "bandwidth": 400.0, "tool_mass": 1.0, "tool_lever": 0.5,
    "friction": 1.0, "presliding": 1e-4, "damping": 0.1,
}  # fmt: skip
NEAR_EDGE = 0.2  # of F_l: a load so near to the friction behind the gear may lie on either side along a swing


def simulated(meant, posture, arm, joint):
    """How far the link turns between two stands at one angle of the encoder, half-way through a swing up and down."""
    own = [np.full(300, posture[joint])]
    for side in (1, -1, 1):
        own.append(moved(own[-1][-1], posture[joint] + side * SWING, SPEED))
    angle = np.concatenate(own)
    q = np.repeat(posture[None], len(angle), axis=0)
    q[:, joint] = angle
    qd = np.gradient(q, STEP, axis=0)
    nothing = np.zeros(len(q))
    reference = Followed(meant.drilling, nothing, nothing, q, qd, np.gradient(qd, STEP, axis=0), 1.0)
    done = run(reference, arm)
    twist = (done.rotor - done.link)[:, joint]
    near = np.abs(angle - posture[joint]) < SWING / 4
    begun = np.arange(len(angle)) > len(own[0]) + len(own[1])
    up, down = (near & begun & (np.sign(qd[:, joint]) == sense) for sense in (1, -1))
    return float(twist[up].mean() - twist[down].mean())


def behind_of(arm, drives, joint):
    """Friction behind the gear at the speed of the swing [N m]."""
    peak = 1 + (drives.breakaway - 1) * np.exp(-((SPEED / drives.stribeck) ** 2))
    return drives.behind * (drives.coulomb[joint] * peak + drives.viscous[joint] * SPEED)


@pytest.mark.parametrize("seed", [1, 2])
def test_the_formula_is_within_three_percent_of_the_simulated_arm(plan, meant, sweeps, seed, request):
    arm, worst, compared = known_arm(seed, **GEARS), 0.0, 0
    drives = arm.arm(plan.robot.dynamics)
    loads = loads_at(meant.drilling, sweeps.posture, arm["tool_mass"], arm["tool_lever"], 0.0)
    for joint in range(6):
        friction = behind_of(arm, drives, joint)
        if abs(abs(loads[joint]) / friction - 1) < NEAR_EDGE:
            continue
        wanted = reversal_value(friction, drives.stiffness[joint], drives.gap[joint], loads[joint])
        off = simulated(meant, sweeps.posture, arm, joint) / wanted - 1
        worst, compared = max(worst, abs(off)), compared + 1
        assert abs(off) <= 0.03, (joint, off, loads[joint] / friction)
    assert compared >= 4
    request.node.user_properties.append(("measured", f"reversal values off by {100 * worst:.1f} % at most"))


def test_loads_of_a_weight_are_those_of_its_lever(meant, sweeps):
    without, under = (loads_at(meant.drilling, sweeps.posture, 1.0, 0.5, weight) for weight in (0.0, 2.0))
    tip = meant.drilling.tool.T_flange_tcp
    J = (twice(meant, sweeps.posture) @ tip[:, 3])[:, 2]
    assert under - without == pytest.approx(2.0 * 9.81 * J, abs=1e-4)


def twice(meant, posture):
    """Change of the pose of the flange per angle of each joint, by differences, shape (6, 4, 4)."""
    from zerorev.motion.kinematics import forward

    step = 1e-6 * np.eye(6)
    return (forward(meant.drilling.robot, posture + step) - forward(meant.drilling.robot, posture - step)) / 2e-6


def values_of(plan, meant, posture, arm, weights=(0.0, 8.0)):
    """What the formula gives for a known arm."""
    drives = arm.arm(plan.robot.dynamics)
    found = []
    for weight in weights:
        loads = loads_at(meant.drilling, posture, arm["tool_mass"], arm["tool_lever"], weight)
        found += [
            Reversal(
                joint,
                reversal_value(
                    drives.behind * drives.coulomb[joint], drives.stiffness[joint], drives.gap[joint], loads[joint]
                ),
                weight,
            )
            for joint in range(6)
        ]
    return found


@pytest.mark.parametrize("behind", [0.3, 0.6])
def test_what_made_the_values_is_in_the_ranges(plan, meant, sweeps, behind):
    arm = ParameterSet({"behind": behind, "stiffness": 0.8, "gap": 1.6, "tool_mass": 0.3, "tool_lever": 0.5})
    values = values_of(plan, meant, sweeps.posture, arm)
    found = lost_motion_ranges(values, meant.drilling, sweeps.posture, dict(RANGES), "gauge.csv")
    assert found["stiffness"].low <= 0.8 <= found["stiffness"].high
    assert found["gap"].low == found["gap"].high == 1.0
    for joint in range(1, 7):
        each = found[f"gap_{joint}"]
        assert each.low * 0.999 <= 1.6 <= each.high * 1.001, joint
        assert each.basis == "fitted"
    drop = [joint for joint in range(6) if values[6 + joint].value < 0.9 * values[joint].value]
    assert drop, "no joint is laid on a flank by the weight"
    for joint in drop:  # where the weight takes the gap away, it is what the value lost
        lost = (values[joint].value - values[6 + joint].value) / ARCMIN
        assert found[f"gap_{joint + 1}"].low <= lost * 1.001
    assert found["kind"].high < 0.5


def test_joints_without_values_keep_the_whole_prior(plan, meant, sweeps):
    found = lost_motion_ranges(
        [Reversal(0, 0.02 / 57.3, 0.0)], meant.drilling, sweeps.posture, dict(RANGES), "gauge.csv"
    )
    assert found["gap_5"].low == pytest.approx(RANGES["gap"].low * RANGES["gap_1"].low)
    assert found["gap_5"].high == pytest.approx(RANGES["gap"].high * RANGES["gap_1"].high)
    assert found["gap_5"].basis == "prior"
    assert "kind" not in found


def test_values_that_no_gear_has_are_refused(meant, sweeps, plan):
    friction = nominal_drives(plan.robot.dynamics.payload).coulomb[0]
    assert friction > 1
    with pytest.raises(InputError, match=r"gauge.csv: no gear has the reversal values of A1 \(accepted: values at"):
        lost_motion_ranges([Reversal(0, 0.5, 0.0)], meant.drilling, sweeps.posture, dict(RANGES), "gauge.csv")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("joint,value\nA1,0.02\n", "line 1: another header (accepted: a header joint,value_deg,weight_kg"),
        ("joint,value_deg,weight_kg\nB1,0.02,0\n", "line 2: no joint 'B1' (accepted: A1, A2"),
        ("joint,value_deg,weight_kg\nA1,x,0\n", "line 2"),
        ("joint,value_deg,weight_kg\nA1,-0.1,0\n", "line 2: a reversal value of -0.1 deg (accepted: above 0"),
        ("joint,value_deg,weight_kg\nA1,0.1,-1\n", "line 2: a weight of -1 kg"),
        ("joint,value_deg,weight_kg\n", "no rows"),
    ],
)
def test_bad_files_are_refused_by_one_message(tmp_path, text, said):
    (tmp_path / "gauge.csv").write_text(text)
    with pytest.raises(InputError) as error:
        read_reversals(tmp_path / "gauge.csv", ("A1", "A2", "A3", "A4", "A5", "A6"))
    assert said in str(error.value)


def test_a_file_is_read(tmp_path):
    (tmp_path / "gauge.csv").write_text("joint;value_deg;weight_kg\nA2;0,03;0\nA2;0,02;5\n")
    found = read_reversals(tmp_path / "gauge.csv", ("A1", "A2", "A3", "A4", "A5", "A6"))
    assert [(each.joint, each.weight) for each in found] == [(1, 0.0), (1, 5.0)]
    assert np.rad2deg([each.value for each in found]) == pytest.approx([0.03, 0.02])
