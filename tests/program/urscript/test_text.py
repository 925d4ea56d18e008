"""Numbers, poses, names and words of URScript."""

import re
from decimal import Decimal

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from zerorev.errors import InputError
from zerorev.model.written import WrittenFrame
from zerorev.program.urscript.names import KEPT, URSCRIPT_NAMES
from zerorev.program.urscript.source import URSCRIPT_WORDS, alike, statements
from zerorev.program.urscript.text import pose, rotation_vector
from zerorev.verify.printed import frame_of

TURNS = Rotation.random(3000, rng=np.random.default_rng(7))


def refuse(what):
    raise InputError(what)


def off(R, S):
    """Angle between rotations [rad]."""
    return (Rotation.from_matrix(R).inv() * Rotation.from_matrix(S)).magnitude()


def test_rotation_vectors_against_scipy():
    vectors = np.array([rotation_vector(turn.as_matrix()) for turn in TURNS])
    np.testing.assert_allclose(vectors, TURNS.as_rotvec(), rtol=0, atol=1e-12)


@pytest.mark.parametrize("angle", [0.0, 1e-12, 1e-8, 1e-3, np.pi - 1e-5, np.pi - 1e-7, np.pi - 1e-12, np.pi])
def test_rotation_vectors_at_no_turn_and_at_half_a_turn(angle):
    rng = np.random.default_rng(3)
    for axis in [*np.eye(3), *rng.normal(size=(50, 3))]:
        R = Rotation.from_rotvec(angle * axis / np.linalg.norm(axis)).as_matrix()
        vector = rotation_vector(R)
        assert np.linalg.norm(vector) <= np.pi + 1e-6
        assert off(Rotation.from_rotvec(vector).as_matrix(), R) < 3e-9


def test_a_tool_straight_down_has_one_vector_for_each_spin():
    """Half a turn: an axis and its opposite are the same rotation, and the last bits must not choose."""
    for spin in np.linspace(-3, 3, 61):
        R = np.diag([1.0, -1, -1]) @ Rotation.from_rotvec([0, 0, spin]).as_matrix()
        near = [R @ Rotation.from_rotvec(1e-13 * tilt).as_matrix() for tilt in TURNS.as_rotvec()[:20]]
        vectors = np.array([rotation_vector(each) for each in near])
        np.testing.assert_allclose(vectors, vectors[:1].repeat(20, axis=0), rtol=0, atol=1e-11)


def test_printed_poses_are_read_as_they_were():
    """What the controller of the format reads, and what the certificate does, within the digits."""
    rng = np.random.default_rng(5)
    for turn, origin in zip(TURNS[:300], rng.uniform(-2, 2, (300, 3)), strict=False):
        T = np.eye(4)
        T[:3, :3], T[:3, 3] = turn.as_matrix(), origin
        printed = re.fullmatch(r"p\[(-?\d\.\d{9}(?:, -?\d\.\d{9}){5})\]", pose(T))[1]
        numbers = [Decimal(number) for number in printed.split(", ")]
        read = frame_of(WrittenFrame(tuple(n.scaleb(3) for n in numbers[:3]), tuple(numbers[3:]), "vector_rad"))
        np.testing.assert_allclose(read[:3, 3], origin, rtol=0, atol=0.51e-9)
        assert off(read[:3, :3], T[:3, :3]) < 2e-9
        assert off(Rotation.from_rotvec([float(n) for n in numbers[3:]]).as_matrix(), T[:3, :3]) < 2e-9
    assert "-0.000000000" not in pose(np.eye(4) * -1e-12)


def test_words():
    assert URSCRIPT_WORDS.words("movel(pose_trans(part, p[0.1, -2]), a=0.5)", refuse) == (
        "movel", "(", "pose_trans", "(", "part", ",", "p[", Decimal("0.1"), ",", Decimal(-2), "]", ")", ",", "a", "=",
        Decimal("0.5"), ")",
    )  # fmt: skip
    assert URSCRIPT_WORDS.words('say("p[1] (x)", True)', refuse)[2] == '"p[1] (x)"'


@pytest.mark.parametrize(
    "text", ["x = 1e-3", "a=+1", "a=.5", "a=0x1", "m = {1}", "a;b", 'say("x)', "_x()", "a-b", "x^y"]
)
def test_other_words_are_refused(text):
    with pytest.raises(InputError, match="neither a name nor a number"):
        URSCRIPT_WORDS.words(text, refuse)


def test_statements_have_no_comments():
    found = list(statements("def a():\r\n\n  # all\n  x(1) # why\nend\n", lambda line, what: refuse(what)))
    assert [(each.line, each.source) for each in found] == [(1, "def a():"), (4, "x(1)"), (5, "end")]


@pytest.mark.parametrize(
    ("number", "new", "same"),
    [
        (0, "0.11", True),
        (0, "0.12", False),
        (5, "0.7", True),
        (6, "0.6", False),
        (7, "0.0051", False),
        (8, "0.0011", False),
    ],
)
def test_alike_within_one_last_digit_of_poses_and_joints_alone(number, new, same):
    wanted = URSCRIPT_WORDS.words(
        "movel(pose_trans(part, p[0.10, 0.2, 0.3, 0.4, 0.5, 0.6]), a=0.5, v=0.0050, r=0.0010)", refuse
    )
    at = [k for k, word in enumerate(wanted) if isinstance(word, Decimal)][number]
    assert alike([*wanted[:at], Decimal(new), *wanted[at + 1 :]], wanted) is same
    assert not alike(wanted[:-1], wanted)


@pytest.mark.parametrize(
    ("text", "name"),
    [("panel", "panel"), ("Panel_7", "Panel_7"), ("x" * 32, "x" * 32)],
)
def test_names_that_stay(text, name):
    assert URSCRIPT_NAMES.of(text) == name


@pytest.mark.parametrize("text", ["movej", "END", "part", "7up", "a b", "x" * 33, "", "täst", "con", "get_inverse_kin"])
def test_names_that_cannot_stay(text):
    name = URSCRIPT_NAMES.of(text)
    assert name != text
    assert re.fullmatch(r"[A-Za-z]\w{0,31}", name)
    assert name not in KEPT
