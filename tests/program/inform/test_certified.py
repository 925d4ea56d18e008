"""What the certificate makes of a job: its pulses exactly, and what is not the plan's by geometry alone."""

import re
from dataclasses import replace
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest
from flint import arb
from scipy.spatial.transform import Rotation

from zerorev.model.written import Drilled, WrittenJoints
from zerorev.program.dialect import ProgramFile
from zerorev.program.export import export
from zerorev.program.inform.dialect import INFORM
from zerorev.verify.certificate.moves import _joints
from zerorev.verify.certificate.piece import ball_arithmetic
from zerorev.verify.certificate.program import certify_program
from zerorev.verify.printed import angle_slack, joints_of, length_slack


def alone(plan, text):
    """The certificate without the comparison, statement by statement, with what `export` writes."""
    program = INFORM.read((ProgramFile("here.JBI", text),))
    (hole,) = certify_program(plan, program, [Drilled(program.holes[0])]).holes
    return hole.certificate


def test_pulses_are_taken_exactly(ma2010):
    counts = (53412, -146988, 217560, -40996, 74887, -51670)
    printed = WrittenJoints(tuple(Decimal(count) for count in counts), "pulses")
    pairs = zip(counts, ma2010.pulses_per_deg, strict=True)
    degrees = [Fraction(count) / Fraction(each) for count, each in pairs]
    np.testing.assert_allclose(joints_of(ma2010, printed), np.deg2rad([float(each) for each in degrees]), rtol=1e-15)
    with ball_arithmetic():
        for ball, each in zip(_joints(ma2010, printed), degrees, strict=True):
            exact = arb(each.numerator) / arb(each.denominator) * arb.pi() / 180
            assert ball.overlaps(exact)
            assert float((ball - exact).rad()) < 1e-15


def test_the_slack_is_half_a_pulse_of_each_axis(ma2010):
    printed = WrittenJoints((Decimal(0),) * 6, "pulses")
    half = sum(0.5 / count for count in ma2010.pulses_per_deg)
    assert np.rad2deg(angle_slack(ma2010, printed)) == pytest.approx(half, rel=1e-3)
    assert length_slack(ma2010, printed) == pytest.approx(np.deg2rad(half) * 3, rel=1e-3)
    mirrored = replace(ma2010, pulses_per_deg=tuple(-count for count in ma2010.pulses_per_deg))
    assert angle_slack(mirrored, printed) == angle_slack(ma2010, printed)


@pytest.mark.parametrize("number", [1, 2, 3])
def test_what_geometry_alone_finds(number, plan_for):
    plan = plan_for("ma2010", number)
    text = export(plan).text
    assert alone(plan, text).verdict == "certified"
    for share in re.findall(r"MOVJ C0000\d VJ=(\d+\.\d\d) PL=1", text):
        double = text.replace(f"VJ={share} PL=1", f"VJ={2 * float(share):.2f} PL=1")
        (reason,) = alone(plan, double).reasons
        assert "has a feed of" in reason
    feed = alone(plan, text.replace("V=20.0", "V=21.0"))
    assert feed.verdict == "refuted"
    assert "has a feed of" in feed.reasons[0]
    stop = alone(plan, re.sub(r"(MOVL C00002 V=\S+) PL=1", r"\1 PL=0", text))
    assert stop.verdict == "refuted"
    # 0.04 deg of axis S, over an arm of more than a metre
    moved = re.sub(r"C00001=(-?\d+)", lambda own: f"C00001={int(own[1]) + 60}", text)
    assert "off the planned axis" in " ".join(alone(plan, moved).reasons)


def test_another_robot_counts_otherwise(plan_for):
    """The same job on an arm of which one axis counts the other way."""
    plan = plan_for("ma2010", 1)
    s, *others = plan.robot.pulses_per_deg
    other = replace(plan, robot=replace(plan.robot, pulses_per_deg=(-s, *others)))
    assert alone(other, export(plan).text).verdict == "refuted"


def test_on_a_tilted_part(plan_for):
    """Pulses are of no frame: the part frame changes nothing but the pulses."""
    plan = plan_for("ma2010", 1)
    T = np.eye(4)
    T[:3, :3] = Rotation.from_euler("ZYX", (25, -40, 15), degrees=True).as_matrix()
    T[:3, 3] = 0.3, 0.2, 0.1
    tilted = replace(plan, T_base_part=T)
    assert export(tilted).text == export(plan).text
    assert alone(tilted, export(tilted).text).verdict == "certified"
