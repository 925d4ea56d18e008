"""The letters and numbers of KRL."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from zerorev.program.krl.text import KRL_COMMENTS, aggregate, frame_angles
from zerorev.program.letters import degrees, fixed, settled


@pytest.mark.parametrize(
    ("value", "text"), [(-1e-9, "0.0000"), (-0.0, "0.0000"), (1.00004, "1.0000"), (-12.34567, "-12.3457")]
)
def test_fixed_decimals_without_a_negative_zero(value, text):
    assert fixed(value) == text


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.31625, "0.3162"), (0.31635, "0.3163"), (1.0, "1.0000"), (0.00011, "0.0001"), (2.34567, "2.3457")],
)
def test_between_two_decimals_the_last_bits_do_not_decide(value, text):
    for bits in range(-3, 4):
        assert settled(value + bits * np.spacing(value)) == text


@pytest.mark.parametrize(
    ("angle_deg", "text"),
    [
        (180, "180.0000"),
        (-180, "180.0000"),
        (-179.99996, "180.0000"),
        (180.00004, "180.0000"),
        (181, "-179.0000"),
        (540, "180.0000"),
        (-359.99999, "0.0000"),
        (-1e-7, "0.0000"),
    ],
)
def test_degrees_are_wrapped_after_they_are_rounded(angle_deg, text):
    assert degrees(np.deg2rad(angle_deg)) == text


def test_frame_angles_of_any_rotation(krl):
    poles = Rotation.from_euler("ZYX", [[30, 90, 40], [30, -90, 40], [0, 90, 0], [179, 89.9999999, 3]], degrees=True)
    for rotation in [*Rotation.random(200, rng=np.random.default_rng(7)), *poles]:
        A, B, C = np.rad2deg(frame_angles(rotation.as_matrix()))
        back = krl.frame({"X": 0, "Y": 0, "Z": 0, "A": A, "B": B, "C": C})[:3, :3]
        np.testing.assert_allclose(back, rotation.as_matrix(), atol=1e-9)


def test_an_aggregate():
    assert aggregate("FRAME", "X Y", ["1.0", "2.0"]) == "{FRAME: X 1.0,Y 2.0}"
    assert aggregate("", "X Y", ["1.0", "2.0"]) == "{X 1.0,Y 2.0}"


def test_a_long_comment_is_wrapped_and_indented():
    lines = KRL_COMMENTS.lines("word " * 60, first="info: ")
    assert len(lines) > 1
    assert lines[0].startswith("; info: word")
    assert all(line.startswith(";       word") for line in lines[1:])
    assert max(map(len, lines)) <= 100
    assert KRL_COMMENTS.lines("") == [";"]
