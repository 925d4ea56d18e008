"""What the reader of RAPID refuses, and what makes no difference to it."""

import re
from decimal import Decimal

import numpy as np
import pytest

from oracles import rapid_reader
from oracles.makers import position_plan, stand_in
from oracles.places import GOLDEN
from zerorev.errors import InputError
from zerorev.program.dialects import read_program
from zerorev.program.export import export
from zerorev.program.rapid.read import read_rapid


@pytest.fixture(scope="module")
def text():
    return export(position_plan(stand_in("ABB"), 1), version="test").text


@pytest.mark.parametrize("path", sorted(GOLDEN.glob("*.mod")), ids=lambda path: path.stem)
def test_golden_programs(path):
    program, other = read_program(path), rapid_reader.read(path.read_text())
    assert program.name == other.name
    assert [len(hole.moves) for hole in program.holes] == [len(moves) - 1 for moves in other.holes()]


MOVE = "MoveL [[450.0000,300.0000,800.0000]"
LAST = "position_1_tool\\WObj:=position_1_part;\n  ConfL"
FAULTS = [
    ("  ConfL\\Off;", "  WaitTime 1;", "WaitTime before the first move of a hole"),
    (MOVE, "SetDO do1,1;\n" + MOVE, "'SetDO do1,1;' is not a statement"),
    (MOVE, "Stop;\n" + MOVE, "'Stop;' is not a statement"),
    ("  ! plunge: target\n", "  my_own 1;\n", "'my_own 1;' is called between blended moves"),
    ("PROC ", "my_own 1;\nPROC ", "'my_own 1;' is called outside of the procedure"),
    (MOVE, "x:=1;\n" + MOVE, "not a statement"),
    (MOVE, MOVE.replace("MoveL", "MoveJ"), "'MoveJ .*' is not a statement"),
    (MOVE, MOVE.replace("300.0000,", ""), "a number for each 0"),
    (MOVE, MOVE.replace("300.0000", "3e2"), "'3e2' in .* is neither a name nor a number"),
    (MOVE, MOVE.replace("300.0000", "nan"), "not a statement"),
    (MOVE, MOVE.replace("300.0000", "+300.0000"), "neither a name nor a number"),
    (MOVE, MOVE.replace("300.0000", "\u0663"), "a character that is not ASCII"),
    (MOVE, f"{MOVE};{MOVE}", "not a statement"),
    ("zone_0_5000,position_1_tool", "zone_0_6000,position_1_tool", "the zone ZONE_0_6000 is not declared"),
    ("zone_0_5000,position_1_tool", "z1,position_1_tool", "the zone Z1 is not declared"),
    ("feed_5_000,zone", "v5,zone", "the speed V5 is not declared"),
    ("way_speed,fine", "vmax,fine", "the speed VMAX is not declared"),
    ("way_speed,fine", "way_speed,zone_1_0000", "not a statement"),
    ("position_1_tool\\WObj:=position_1_part;", "tool0\\WObj:=position_1_part;", "not a statement"),
    ("position_1_tool\\WObj:=position_1_part;", "position_1_tool;", "not a statement"),
    ("\\T:=0.200000", "\\T:=0", "a time of 0 s"),
    ("\\T:=0.200000", "\\V:=5", "not a statement"),
    ("\\T:=0.200000", "", "not a statement"),
    ("[FALSE,1.0000,1.0000,", "[FALSE,1.0000,1.5000,", "ZONE_1_0000 has different radii"),
    ("[FALSE,1.0000,1.0000,1.0000,", "[TRUE,1.0000,1.0000,1.0000,", "not a statement"),
    ("[FALSE,1.0000,1.0000,1.0000,30.0,1.0000,1.0000]", "[FALSE,0,0,0,30,0,0]", "ZONE_1_0000 is not above 0"),
    ("[5.000,", "[0.000,", "FEED_5_000 is not above 0"),
    ("[0.3000,[50", "[0.0000,[50", "a load of 0.0000 kg"),
    ("[[0,0,0],[1,0,0,0]]];", "[[0,0,1],[1,0,0,0]]];", "an object frame within the user frame"),
    ("[TRUE,[[100", "[FALSE,[[100", "not a statement"),
    ('FALSE,TRUE,""', 'FALSE,FALSE,""', "not a statement"),
    ('FALSE,TRUE,""', 'FALSE,TRUE,"STN1"', "not a statement"),
    ('FALSE,TRUE,""', 'FALSE,TRUE,"', "a text that does not end"),
    ("LOCAL CONST speeddata feed_5", "LOCAL PERS speeddata feed_5", "not a statement"),
    ("  ConfL\\Off;\n", "", "a move before CONFL"),
    ("  SingArea\\Off;\n", "", "a move before SINGAREA"),
    ("  PDispOff;\n", "", "a move before PDISPOFF"),
    ("SingArea\\Off", "SingArea\\Wrist", r"accepted: SingArea\\Off;\)"),
    ("ConfL\\Off;", "ConfL\\On;", "a move before CONFL|ConfL.On before the first hole"),
    ("AccSet 100,100", "AccSet 50,100", "AccSet 100,100|ACCSET 100,100"),
    ("VelSet 100,5000", "VelSet 50,5000", "VELSET 100,5000"),
    ("  ConfJ\\On;", "  ConfJ\\On;\n  ConfJ\\On;", "CONFJ is set a second time"),
    ("  ConfL\\On;\n", "", "ENDPROC before ConfL"),
    ("ENDPROC\n", "", "ENDMODULE before ENDPROC"),
    ("ENDMODULE\n", "", "not complete"),
    ("ENDMODULE\n", "ENDMODULE\nStop;\n", "'Stop;' after ENDMODULE"),
    ("MODULE position_1", "MODULE position_1(SYSMODULE)", "MODULE name, of at most 27"),
    ("MODULE position_1", "MODULE a_name_that_is_much_too_long", "MODULE name, of at most 27"),
    ("MODULE position_1\n", "MODULE position_1\nMODULE other\n", "a second module"),
    ("MODULE position_1", "VAR num n;\nMODULE position_1", "before MODULE"),
    ("PROC position_1_run()", "PROC main()", r"accepted: PROC NAME_run\(\)"),
    ("PROC position_1_run()", "PROC position_1_run(num n)", "not a statement"),
    (f"fine,{LAST}", f"zone_1_0000,{LAST}",
     r"the last move of a hole \(line \d+\) is blended"),
]  # fmt: skip


@pytest.mark.parametrize(("old", "new", "what"), FAULTS)
def test_what_zerorev_does_not_write_is_refused(old, new, what, text):
    assert old in text
    with pytest.raises(InputError, match=what) as caught:
        read_rapid(text.replace(old, new, 1), "here.mod")
    assert re.match(r"here\.mod, line \d+: ", str(caught.value))


ODD = [chr(code) for code in (*range(9), *range(11, 32), 0x7F, 0x85, 0xA0, 0xE4, 0xFEFF, 0x2028, 0x2029)]


@pytest.mark.parametrize("odd", ODD, ids=lambda odd: f"{ord(odd):#x}")
@pytest.mark.parametrize("place", ["comment", "statement"])
def test_no_character_that_a_controller_may_read_otherwise(odd, place, text, tmp_path):
    old, new = {"comment": ("  MoveL", f"  ! see{odd}MoveL"), "statement": ("ConfJ\\On", f"ConfJ{odd}\\On")}[place]
    hidden = text.replace(old, new, 1)
    line = next(k for k, line in enumerate(hidden.split("\n"), 1) if odd in line)
    with pytest.raises(InputError, match=rf"line {line}: a (character|carriage return)"):
        read_rapid(hidden)
    path = tmp_path / "odd.mod"
    path.write_bytes(hidden.encode())
    with pytest.raises(InputError, match=rf"line {line}: a (character|carriage return)"):
        read_program(path)


def test_what_makes_no_difference(text, tmp_path):
    program, path = read_rapid(text), tmp_path / "position_1.mod"
    for other in (
        text.replace("\n", "\r\n"),
        text.rstrip("\n"),
        "\ufeff" + text,
        text.upper(),
        text.replace("MODULE position_1\n", "MODULE  position_1 \n").replace(":=", " := ").replace(",", ",\t "),
        text.replace("\n", "  \n\n"),
        re.sub(r"(?m)^ *!.*\n", "", text),
        text.replace("zone_1_0000,position_1_tool\\WObj:=position_1_part;",
                     "zone_1_0000,position_1_tool\\WObj:=position_1_part; ! MoveL"),
    ):  # fmt: skip
        path.write_text(other, newline="")
        assert read_program(path) == program
    called = read_rapid(text.replace("position_1", "called_otherwise"))
    assert called.name == "called_otherwise"
    assert (called.holes, called.head[1:], called.tail) == (program.holes, program.head[1:], program.tail)


@pytest.mark.parametrize("content", [b"", b"\x00\x01", b"\xff\xfe", b"{}", b"MODULE a\nENDMODULE\n"])
def test_no_program_at_all(content, tmp_path):
    path = tmp_path / "a.mod"
    path.write_bytes(content)
    with pytest.raises(InputError, match=r"a\.mod"):
        read_program(path)


def test_numbers_are_the_decimals_that_are_printed(text):
    move = read_rapid(text.replace("[[450.0000,300.0000", "[[450.0000,300.0001", 1)).holes[0].moves[0]
    assert move.end.xyz_mm[1] == Decimal("300.0001")
    assert move.pace == (Decimal("0.005000"), "m/s")
    assert str(move.pace.value) == "0.005000"


@pytest.mark.parametrize("seed", range(3))
def test_a_spoiled_text_is_read_or_refused_and_never_a_fault(seed, text):
    rng = np.random.default_rng(seed)
    refused = 0
    for _ in range(200):
        at, length = int(rng.integers(len(text))), int(rng.integers(4))
        put = "".join(rng.choice(list('0.-,[]; \nAX:\\=!"'), int(rng.integers(3))))
        try:
            read_rapid(text[:at] + put + text[at + length :])
        except InputError:
            refused += 1
    assert refused > 50
