"""Holes in any direction on tilted parts: the file's poses, rotations and axis values are the plan's."""

import itertools
import re
from decimal import Decimal

import numpy as np
import pytest

from oracles.places import GOLDEN
from zerorev.errors import InputError
from zerorev.model.hole import Hole
from zerorev.model.profile import Profile
from zerorev.motion.drilling import Drilling
from zerorev.motion.joint_path import joint_path
from zerorev.motion.kinematics import forward, tcp_pose
from zerorev.program.dialects import read_program
from zerorev.program.export import export
from zerorev.program.krl.read import read_krl

DIRECTIONS = {
    "up": (0, 0, 1),
    "down": (0, 0, -1),
    "ahead": (1, 0, 0),
    "back": (-1, 0, 0),
    "left": (0, 1, 0),
    "oblique": (1, -2, -3),
    "nearly down": (1e-7, -2e-7, -1),
    "hardly off down": (1e-12, 1e-12, -1),
}
SPINS = {"small": (20, -10, -35), "across 180": (170, 200, 230), "wide": (70, 10, -80)}
TARGETS = [(0.45, 0.1, 0.6), (0.4, -0.2, 0.75), (0.35, 0.25, 0.45), (0.3, 0.0, 0.9)]
DEPTH = 0.012
AS_WRITTEN = np.array([[0, 0, 1], [0, 1, 0], [-1, 0, 0]])  # X = -Z_tcp, Y = Y_tcp, Z = X_tcp


def rotation(*rpy_deg):
    from scipy.spatial.transform import Rotation

    return Rotation.from_euler("ZYX", rpy_deg, degrees=True).as_matrix()


PARTS = {
    "base": (np.eye(3), (0, 0, 0)),
    "tilted": (rotation(25, -40, 15), (0.3, 0.2, 0.1)),
    "on its side": (rotation(0, 90, 0), (0.5, 0, 0.5)),
    "upside down": (rotation(180, 0, 180), (0, -0.4, 0.2)),
}


def runnable(kuka, drill, direction, spins):
    """A hole in a direction, and a motion of the given spins from wherever the robot can begin it."""
    for target in TARGETS:
        axis = np.array(direction, dtype=float)
        across = np.cross(axis, [0.3, 0.9, 0.31])
        hole = Hole("h", np.array(target), axis, DEPTH, across)
        for start in range(0, 360, 30):
            profile = Profile.straight(DEPTH, *np.deg2rad(np.array(spins) + start))
            for branch in range(8):
                if joint_path(Drilling(kuka, drill, hole), profile, branch, samples=400).runs:
                    return hole, profile
    pytest.fail("no target can be drilled")


@pytest.mark.parametrize("spins", SPINS.values(), ids=SPINS)
@pytest.mark.parametrize("direction", DIRECTIONS.values(), ids=DIRECTIONS)
def test_any_direction_on_any_part(direction, spins, krl, kuka, drill, planned, plan_of):
    hole, profile = runnable(kuka, drill, direction, spins)
    hole_plan = planned(hole, profile)
    for R, p in PARTS.values():
        T_base_part = np.eye(4)
        T_base_part[:3, :3], T_base_part[:3, 3] = R, p
        plan = plan_of(hole_plan, T_base_part=T_base_part, lead_in=2e-3, feed_retract=5e-4, feed_plunge=1e-4)
        text = export(plan).text
        ptp, *moves = krl.read(text).moves
        check_poses(plan, hole_plan, ptp, moves)
        check_angles(moves, profile)
        check_the_reader(text, ptp, moves)


def check_poses(plan, hole_plan, ptp, moves):
    """Against the poses of the plan, made here from its spins."""
    profile, hole = hole_plan.motion.profile, hole_plan.hole
    T_part_base = np.linalg.inv(plan.T_base_part)
    for move, s, psi in zip(moves, profile.standoff, profile.psi, strict=True):
        wanted = T_part_base @ tcp_pose(hole, s, psi)
        np.testing.assert_allclose(move.T_part_tool[:3, 3], wanted[:3, 3] * 1e3, rtol=0, atol=5e-4)
        assert angle(move.T_part_tool[:3, :3], wanted[:3, :3] @ AS_WRITTEN) < 5e-4
        # and through the $BASE and $TOOL of the file, where the flange must be
        T_flange_tcp = plan.tool.T_flange_tcp.copy()
        T_flange_tcp[:3, 3] *= 1e3
        T_flange_tcp[:3, :3] = T_flange_tcp[:3, :3] @ AS_WRITTEN
        np.testing.assert_allclose(move.state["$TOOL"], T_flange_tcp, rtol=0, atol=1e-4)
        np.testing.assert_allclose(move.T_base_tool[:3, 3], tcp_pose(hole, s, psi)[:3, 3] * 1e3, rtol=0, atol=1e-3)
    # the axis values lead to a point of the plunge leg's line, behind the start, turned as the leg goes on
    reached = forward(plan.robot, np.deg2rad(ptp.axes))
    reached[:3, 3] *= 1e3
    reached = reached @ ptp.state["$TOOL"]
    behind = -(reached[:3, 3] - hole.target * 1e3) @ hole.direction - profile.standoff[0] * 1e3
    assert -1e-3 < behind < plan.settings.lead_in * 1e3 + 1e-3
    lead_in = tcp_pose(
        hole, profile.standoff[0] + behind * 1e-3, profile.psi[0] + profile.twist_rate[0] * behind * 1e-3
    )
    np.testing.assert_allclose(reached[:3, 3], lead_in[:3, 3] * 1e3, rtol=0, atol=1e-3)
    assert angle(reached[:3, :3], lead_in[:3, :3] @ AS_WRITTEN) < 1e-3


def check_the_reader(text, ptp, moves):
    """What the product reads back is what the other reader reads."""
    program = read_krl(text)
    (hole,) = program.holes
    assert [float(angle) for angle in hole.start.values] == list(ptp.axes)
    for move, other in zip(hole.moves, moves, strict=True):
        assert [float(number) for number in (*move.end.xyz_mm, *move.end.turn)] == [
            other.values[name] for name in "XYZABC"
        ]
        assert float(move.blend_mm) == (other.state["$APO.CDIS"] if other.blended else 0)
        assert (float(move.pace.value), move.line) == (other.state["$VEL.CP"], other.line)
    for name, frame in (("$TOOL", program.tool), ("$BASE", program.base)):
        R = rotation(*(float(angle) for angle in frame.turn))
        np.testing.assert_allclose(ptp.state[name][:3, :3], R, rtol=0, atol=1e-12)
        assert list(ptp.state[name][:3, 3]) == [float(length) for length in frame.xyz_mm]


def check_angles(moves, profile):
    """A and B constant, C alone turns, by what the spin does and the short way round."""
    assert len({(move.values["A"], move.values["B"]) for move in moves}) == 1
    C = np.array([move.values["C"] for move in moves])
    assert ((C > -180) & (C <= 180)).all()
    steps = (np.diff(C) + 180) % 360 - 180
    assert (np.abs(steps) <= 120).all()
    for a, b in itertools.pairwise(moves):
        turned = angle(a.T_part_tool[:3, :3], b.T_part_tool[:3, :3])
        assert turned == pytest.approx(abs((b.values["C"] - a.values["C"] + 180) % 360 - 180), abs=1e-3)
    assert steps.sum() == pytest.approx(-np.rad2deg(profile.psi[-1] - profile.psi[0]), abs=1e-3)


def angle(a, b):
    """[deg], from the skew part, which keeps its digits near 0, and the trace near 180 deg."""
    R = a.T @ b
    skew = np.linalg.norm([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    return float(np.rad2deg(np.arctan2(skew, np.trace(R) - 1)))


@pytest.mark.parametrize(("direction", "B"), [((0, 0, 1), -90), ((0, 0, -1), 90)])
def test_straight_up_and_down_take_A_as_zero(direction, B, krl, kuka, drill, planned, plan_of):
    hole, profile = runnable(kuka, drill, direction, SPINS["small"])
    moves = krl.read(export(plan_of(planned(hole, profile))).text).moves[1:]
    assert {(move.values["A"], move.values["B"]) for move in moves} == {(0.0, float(B))}
    assert len({move.values["C"] for move in moves}) == len(moves)


def test_more_than_three_breakpoints(krl, published, planned, plan_of):
    first = published(1)
    standoff, psi = np.array([50, 30, 10, 0, 20, 50]), np.array([14.16, 5.0, -1.0, -5.94, -15.0, -30.46])
    profile = Profile(standoff * 1e-3, np.deg2rad(psi))
    hole = planned(first.hole, profile, near=np.rad2deg(first.motion.joints[0]))
    plan = plan_of(hole, feed_plunge=5e-3, feed_retract=20e-3)
    ptp, *moves = krl.read(export(plan).text).moves
    assert [move.blended for move in moves] == [True] * 5 + [False]
    assert [move.state["$VEL.CP"] for move in moves] == [0.005] * 4 + [0.02] * 2
    check_poses(plan, hole, ptp, moves)
    check_angles(moves, profile)


# --- the reader of the product ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("path", sorted(GOLDEN.glob("*.src")), ids=lambda path: path.stem)
def test_golden_programs(path, krl):
    program, other = read_program(path), krl.read(path.read_text())
    assert program.name == other.name
    assert [len(hole.moves) for hole in program.holes] == [len(moves) - 1 for moves in other.holes()]


@pytest.fixture(scope="module")
def text(published, plan_of):
    return export(plan_of(published(1), published(2)), version="test").text


LIN = "LIN {X 500.0000,Y 300.0000,Z 800.0000,A 0.0000,B 0.0000,C 5.9388}"


@pytest.mark.parametrize(
    ("old", "new", "what"),
    [
        ("$VEL.CP=", "WAIT SEC 1\n$VEL.CP=", "WAIT SEC before the first move of a hole"),
        (LIN, f"WAIT SEC 1\n{LIN}", "WAIT SEC between blended moves"),
        ("$VEL.CP=", "$OUT[1]=TRUE\n$VEL.CP=", "is neither a name nor a number"),
        ("$VEL.CP=", "$OV_PRO=50\n$VEL.CP=", r"'\$OV_PRO=50' is not a statement that zerorev writes"),
        ("$VEL.CP=", "$VEL.CP=-", "a number above 0"),
        ("$VEL.CP=", "; $VEL.CP=", r"a LIN before \$VEL.CP is set"),
        ("$APO.CDIS=", "; $APO.CDIS=", r"a LIN before \$APO.CDIS is set"),
        ("$APO.CDIS=1.0000", "$APO.CDIS=0.0000", "a number above 0"),
        ("$ORI_TYPE=#VAR", "$ORI_TYPE=#JOINT", r"accepted: \$ORI_TYPE=#VAR\)"),
        ("$IPO_MODE=#BASE", "$IPO_MODE=#TCP", r"accepted: \$IPO_MODE=#BASE\)"),
        ("$ORI_TYPE=#VAR\n", "", r"a move before \$ORI_TYPE is set"),
        ("$TOOL=", "$TOOL={FRAME: X 1,Y 0,Z 0,A 0,B 0,C 0}\n$TOOL=", r"\$TOOL is set a second time"),
        ("$VEL.CP=", "$BASE={FRAME: X 1,Y 0,Z 0,A 0,B 0,C 0}\n$VEL.CP=", r"\$BASE is set a second time"),
        ("BAS (#VEL_PTP", "$ADVANCE=3\nBAS (#INITMOV,0 )\nBAS (#VEL_PTP", "INITMOV would undo"),
        (LIN, LIN.replace("LIN", "LIN_REL"), "not a statement"),
        (LIN, LIN.replace("Y 300.0000,", ""), "LIN {X 0,Y 0,.* a number for each 0"),
        (LIN, LIN.replace("Y 300.0000", "Y 3e2"), "'3e2' in .* is neither a name nor a number"),
        (LIN, LIN.replace("Y 300.0000", "Y nan"), "LIN {X 0,Y 0,.* a number for each 0"),
        (LIN, LIN.replace("X 500.0000,Y 300.0000", "Y 300.0000,X 500.0000"), "is not a statement that zerorev writes"),
        (LIN, LIN.replace("Y 300.0000", "Y \u0663"), "a character that is not ASCII"),
        (LIN + " C_DIS", LIN + " C_VEL", "not a statement"),
        ("PTP {", LIN + "\nPTP {", "a LIN before the PTP of its hole"),
        ("\nEND\n", "\n", "not complete"),
        ("\nEND\n", "\nEND\nHALT\n", "'HALT' after END"),
        ("DEF ", "DEF other ( )\nDEF ", "a second program"),
        ("EXT BAS", "$ADVANCE=3 $ADVANCE=4", "not a statement"),
        ("EXT BAS (BAS_COMMAND :IN,REAL :IN )\n", "", "a move before EXT BAS is set"),
        ("BAS (#INITMOV,0 )\n", "", r"a move before BAS \(#INITMOV\) is set"),
        ("BAS (#VEL_PTP,20 )\n", "", r"a move before BAS \(#VEL_PTP\) is set"),
        ("BAS (#VEL_PTP,20 )", "BAS (#VEL_PTP,0 )", "a number above 0"),
        ("BAS (#INITMOV,0 )\nBAS (#VEL_PTP,20 )", "BAS (#VEL_PTP,20 )\nBAS (#INITMOV,0 )", "INITMOV would undo"),
        ("&ACCESS", " &ACCESS", "'&ACCESS' in"),
        ("EXT BAS", "&REL 2\nEXT BAS", "'&REL' in"),
        ("DEF test ( )", "DEF test ( ) LIN", r"accepted: DEF name \( \)"),
        ("DEF test ( )", "DEF test (a :IN)", r"accepted: DEF name \( \)"),
        ("DEF test ( )", "DEF tests_name_is_now_too_long ( )", "of at most 24 letters"),
        ("DEF test ( )", "GLOBAL DEF test ( )", "'GLOBAL DEF test .*' before DEF"),
        ("C_DIS ; target", "C_DIS" + 300 * " " + "C_DIS ; target", "a statement of 3.. characters"),
        ("BAS (#VEL_PTP,20 )", "BAS (#VEL_PTP,20 ) BAS (#VEL_PTP,30 )", "not a statement"),
    ],
)
def test_what_zerorev_does_not_write_is_refused(old, new, what, text):
    assert old in text
    with pytest.raises(InputError, match=what) as caught:
        read_krl(text.replace(old, new, 1), "here.src")
    assert re.match(r"here\.src, line \d+: ", str(caught.value))


# every control character but tab and line feed; what Python, Unicode or another editor take for the end of a line
ODD = [chr(code) for code in (*range(9), *range(11, 32), 0x7F, 0x85, 0xA0, 0xE4, 0xFEFF, 0x2028, 0x2029)]


@pytest.mark.parametrize("odd", ODD, ids=lambda odd: f"{ord(odd):#x}")
@pytest.mark.parametrize("place", ["comment", "statement", "header"])
def test_no_character_that_a_controller_may_read_otherwise(odd, place, text, tmp_path):
    hidden = text.replace(
        *{
            "comment": ("$VEL.CP=", f"; see{odd}$VEL.CP="),
            "statement": (" C_DIS", f"{odd} C_DIS"),
            "header": ("&COMMENT drilling", f"&COMMENT {odd}drilling"),
        }[place],
        1,
    )
    line = next(k for k, line in enumerate(hidden.split("\n"), 1) if odd in line)
    with pytest.raises(InputError, match=rf"line {line}: a (character|carriage return)"):
        read_krl(hidden)
    path = tmp_path / "odd.src"
    path.write_bytes(hidden.encode())
    with pytest.raises(InputError, match=rf"line {line}: a (character|carriage return)"):
        read_program(path)


def test_what_a_controller_adds_makes_no_difference(text, tmp_path):
    program, path = read_krl(text), tmp_path / "test.src"
    header = "&ACCESS RVP1\n&REL 27\n&PARAM EDITMASK = *\n& PARAM TEMPLATE = C:\\KRC\\Vorlage\n&USER a\n&COMMENT b\n"
    kept = text[text.index("DEF") :]
    for other in (
        kept,
        header + kept,
        text.replace("\n", "\r\n"),
        text.rstrip("\n"),
        "\ufeff" + text,
        text.lower(),
        text.replace("DEF test ( )", "DEF  test( )").replace("=", " = ").replace(",", ",\t "),
        text.replace("\n", "  \n\n"),
        re.sub(r" *;.*", "", text),
        re.sub(r"(?m)^(\$|LIN|PTP)", r"   \1", text).replace("; target", ";FOLD LIN P1;%{PE}%R 8"),
    ):
        path.write_text(other, newline="")
        assert read_program(path) == program


def test_the_line_of_a_fault(text):
    lines = text.split("\n")
    at = next(k for k, line in enumerate(lines) if line.startswith("LIN"))
    lines[at] = lines[at].replace("LIN", "CIRC")
    with pytest.raises(InputError, match=f"line {at + 1}: 'CIRC"):
        read_krl("\n".join(lines))


def test_the_last_move_of_a_hole_must_be_an_exact_stop(text):
    with pytest.raises(InputError, match=r"the last move of a hole \(line \d+\) is blended"):
        read_krl(text.replace(" ; end of the stroke", " C_DIS ; end of the stroke", 1))


def test_a_hole_without_moves(text):
    without = "\n".join(line for line in text.split("\n") if not line.startswith("LIN"))
    with pytest.raises(InputError, match="the program has no holes"):
        read_krl(without)
    first = text.index(";FOLD Hole")
    with pytest.raises(InputError, match="the program has no holes"):
        read_krl(text[:first] + "END\n")


@pytest.mark.parametrize("content", [b"", b"\x00\x01", b"\xff\xfe", b"{}", b"DEF a ( )\nEND\n"])
def test_no_program_at_all(content, tmp_path):
    path = tmp_path / "a.src"
    path.write_bytes(content)
    with pytest.raises(InputError, match=r"a\.src"):
        read_program(path)
    with pytest.raises(InputError, match="no such file"):
        read_program(tmp_path / "b.src")


def test_numbers_are_the_decimals_that_are_printed(text):
    move = read_krl(text.replace("Y 300.0000", "Y 300.0001", 1)).holes[0].moves[0]
    assert move.end.xyz_mm[1] == Decimal("300.0001")


@pytest.mark.parametrize("seed", range(3))
def test_a_spoiled_text_is_read_or_refused_and_never_a_fault(seed, text):
    rng = np.random.default_rng(seed)
    refused = 0
    for _ in range(200):
        at, length = int(rng.integers(len(text))), int(rng.integers(4))
        put = "".join(rng.choice(list("0.-,{}; \nAXC$=#LIN"), int(rng.integers(3))))
        try:
            read_krl(text[:at] + put + text[at + length :])
        except InputError:
            refused += 1
    assert refused > 50
