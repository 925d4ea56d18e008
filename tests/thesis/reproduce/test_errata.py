"""The numbers that the errata are shown by, against computations of their own."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from oracles.published import POSITIONS as KNOWN
from zerorev.thesis.reproduce import Context, errata, kinematics
from zerorev.thesis.reproduce.published import DEEPEST, MODIFIED_DH, POSITIONS, STANDARD_DH, TOOL_AS_NEEDED

CONTEXT = Context(seeds=2, map_size=6)


@pytest.mark.parametrize(("ours", "known"), list(zip(POSITIONS, KNOWN, strict=True)), ids=lambda each: each.name)
def test_published_numbers_are_those_of_the_tests(ours, known):
    assert ours.target_mm == known.target_mm
    assert ours.depth_mm == known.depth_mm
    assert ours.axis_deg == known.axis_deg
    np.testing.assert_allclose(ours.psi_deg, known.psi_deg, atol=0.005)
    # the increments of Appendix B are the differences of the spins
    np.testing.assert_allclose(np.abs(np.diff(ours.psi_deg)), ours.turned_deg, atol=2e-4)


def screw(alpha, a, theta, d, *, modified):
    """One step of a chain from elementary motions (numpy and scipy alone)."""

    def turn(axis, angle):
        T = np.eye(4)
        T[:3, :3] = Rotation.from_euler(axis, angle, degrees=True).as_matrix()
        return T

    def shift(x=0.0, z=0.0):
        T = np.eye(4)
        T[[0, 2], 3] = x, z
        return T

    about_x, about_z = turn("x", alpha) @ shift(x=a), turn("z", theta) @ shift(z=d)
    return about_x @ about_z if modified else about_z @ about_x


def chain(joints_deg, *, modified, third=1.0):
    T = np.eye(4)
    for i, q in enumerate(joints_deg):
        if modified:
            alpha, a, d, theta = MODIFIED_DH[i]
        else:
            theta, d, a, alpha = STANDARD_DH[i]
        T = T @ screw(alpha, a, theta + (third if i == 2 else 1.0) * q, d, modified=modified)
    return T


@pytest.mark.parametrize("seed", range(5))
def test_both_chains_are_products_of_screws(seed):
    joints = np.random.default_rng(seed).uniform(-180, 180, 6)
    np.testing.assert_allclose(kinematics.modified_chain(np.deg2rad(joints)), chain(joints, modified=True), atol=1e-10)
    np.testing.assert_allclose(
        kinematics.standard_chain(np.deg2rad(joints)), chain(joints, modified=False, third=-1.0), atol=1e-10
    )


def test_both_tables_are_one_arm_to_1e_12():
    (same, arm, tip, joints), *_ = [kinematics.make(CONTEXT).results]
    assert float(same.own.split()[3].rstrip(",")) < 1e-12
    assert float(arm.own.split()[3]) < 1e-12
    assert float(tip.own.split()[2]) < 1.5e-3
    assert float(joints.own.split()[2]) < 2e-4


def test_the_tip_misses_only_with_the_printed_readings():
    joints, tips = kinematics.appendix_b()
    for sign, ee, off in (
        (1.0, TOOL_AS_NEEDED, None),
        (-1.0, TOOL_AS_NEEDED, 800.0),
        (1.0, (65.0, 100.0), 35 * np.sqrt(2)),
    ):
        found = kinematics.worst_tip(kinematics.modified_chain(joints, height_sign=sign) @ kinematics.tool_of(ee), tips)
        # a wrong sign of d_1 = -400 mm with alpha_0 = 180 deg is worth twice the base height, the swap 35 mm both ways
        assert found == pytest.approx(off, abs=0.01) if off else found < 1.5e-3


def test_relative_rotations_against_rotation_vectors():
    joints = np.random.default_rng(4).uniform(-np.pi, np.pi, (40, 6))
    for third, differ in ((-1.0, False), (1.0, True)):
        angles = []
        for T in (kinematics.modified_chain(joints), kinematics.standard_chain(joints, third=third)):
            R = Rotation.from_matrix(T[:, :3, :3])
            angles.append(np.rad2deg((R[:-1].inv() * R[1:]).magnitude()))
        known = np.abs(angles[0] - angles[1]).max()
        assert errata.relative_rotations(joints, third) == pytest.approx(known, abs=1e-5)
        assert (known > 10) == differ


def test_identity_a_8_holds_with_a_plus():
    assert errata.identity_a_8(1.0) < 1e-10
    assert errata.identity_a_8(-1.0) > 90


def test_condition_3_16_is_the_wrong_way_round():
    ratio = errata.condition_3_16(np.random.default_rng(6).uniform(-np.pi, np.pi, (500, 6)))
    assert (ratio <= 1 + 1e-12).all()


def test_every_erratum_has_its_place_and_two_numbers():
    results = {result.what: result for result in errata.make(CONTEXT).results}
    assert len(results) == 15
    for result in results.values():
        assert result.source
        assert any(letter.isdigit() for letter in result.own)
        assert any(letter.isdigit() for letter in result.exact)
        assert result.remark
    twist = results["moving the rotation to the retract"]
    assert twist.own.startswith("2 reversals")
    assert twist.exact.startswith("0 reversals")
    baseline = results["reversals with constant spin at position 2"]
    assert baseline.own.startswith(f"{sum(KNOWN[1].baseline)} without a threshold")
    assert ", ".join(map(str, KNOWN[1].baseline)) in baseline.own
    assert "0.041°" in baseline.exact  # theory §6
    assert "200.08 mm" in results["mean of the optimised motion"].own
    assert "5 mm" in results["$APO.CDIS"].own


def test_the_deepest_strokes_are_those_of_the_table_in_the_theory():
    assert [(target, depth) for target, depth, _ in DEEPEST] == [
        ((500, 300, 800), 90.0),
        ((200, 400, 600), 21.9),
        ((200, 200, 1000), 32.8),
        ((500, 300, 900), 125.0),
    ]
