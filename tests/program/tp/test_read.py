"""The reader of TP: what a controller makes of a file is read as the file; all else is refused by its line."""

import re
from decimal import Decimal

import pytest

from oracles.places import GOLDEN
from zerorev.errors import InputError
from zerorev.program.tp.dialect import TP
from zerorev.program.tp.read import read_starter, read_tp
from zerorev.program.tp.source import alike

ATTRIBUTES = """OWNER\t\t= MNEDITOR;
COMMENT\t\t= "drilling";
PROG_SIZE\t= 1034;
CREATE\t\t= DATE 26-11-30  TIME 16:00:48;
MODIFIED\t= DATE 26-11-30  TIME 16:00:50;
FILE_NAME\t= ;
VERSION\t\t= 0;
LINE_COUNT\t= 38;
MEMORY_SIZE\t= 2118;
PROTECT\t\t= READ_WRITE;
TCD:  STACK_SIZE\t= 0,
      TASK_PRIORITY\t= 50,
      TIME_SLICE\t= 0,
      BUSY_LAMP_OFF\t= 0,
      ABORT_REQUEST\t= 0,
      PAUSE_REQUEST\t= 0;
DEFAULT_GROUP\t= 1,*,*,*,*;
CONTROL_CODE\t= 00000000 00000000;"""

HOLE = """/PROG  A
/ATTR
DEFAULT_GROUP = 1,*,*,*,*;
/MN
   1:  !made for this test ;
   2:  UFRAME_NUM=1 ;
   3:  UTOOL_NUM=2 ;
   4:J P[1] 20% FINE    ;
   5:L P[2] 30cm/min CNT100    ;
   6:J P[3] 200msec CNT100    ;
   7:J P[4] 50msec CNT100    ;
   8:L P[5] 20mm/sec FINE    ;
/POS
P[1]{
   GP1:
\tUF : 1, UT : 2,\t
\tJ1=     0.000 deg,\tJ2=     1.500 deg,\tJ3=   -10.250 deg,
\tJ4=     0.000 deg,\tJ5=   -89.000 deg,\tJ6=      .001 deg
};
P[2]{
   GP1:
\tUF : 1, UT : 2,\t\tCONFIG : 'N U T, 0, 0, 0',
\tX =   385.000  mm,\tY =     -.050  mm,\tZ =   285.000  mm,
\tW =  -179.999 deg,\tP =     0.000 deg,\tR =    12.345 deg
};
P[3]{
   GP1:
\tUF : 1, UT : 2,\t
\tJ1=     0.000 deg,\tJ2=     1.600 deg,\tJ3=   -10.350 deg,
\tJ4=     0.000 deg,\tJ5=   -89.100 deg,\tJ6=      .101 deg
};
P[4]{
   GP1:
\tUF : 1, UT : 2,\t
\tJ1=     0.000 deg,\tJ2=     1.700 deg,\tJ3=   -10.450 deg,
\tJ4=     0.000 deg,\tJ5=   -89.200 deg,\tJ6=      .201 deg
};
P[5]{
   GP1:
\tUF : 1, UT : 2,\t\tCONFIG : 'N U T, 0, 0, 0',
\tX =   385.000  mm,\tY =     -.050  mm,\tZ =   295.000  mm,
\tW =  -179.999 deg,\tP =     0.000 deg,\tR =    14.345 deg
};
/END
"""


def test_what_a_controller_has_of_it():
    program = read_tp(HOLE)
    (hole,) = program.holes
    assert (program.name, program.tool, program.base) == ("A", None, None)
    assert hole.start.values == tuple(map(Decimal, ("0.000", "1.500", "-10.250", "0.000", "-89.000", "0.001")))
    assert [move.linear for move in hole.moves] == [True, False, False, True]
    assert [move.blend_mm for move in hole.moves] == [None, None, None, 0]
    assert [tuple(move.pace) for move in hole.moves] == [
        (30, "cm/min"), (Decimal("0.200"), "s"), (Decimal("0.050"), "s"), (Decimal("0.020"), "m/s")
    ]  # fmt: skip
    # about Z, then Y, then X
    assert hole.moves[0].end.turn == (Decimal("12.345"), Decimal("0.000"), Decimal("-179.999"))
    assert hole.moves[0].end.xyz_mm == (Decimal("385.000"), Decimal("-0.050"), Decimal("285.000"))
    assert [hole.line, *(move.line for move in hole.moves)] == [8, 9, 10, 11, 12]


def test_the_world_frame_is_a_frame():
    program = read_tp(HOLE.replace("UFRAME_NUM=1", "UFRAME_NUM=0").replace("UF : 1", "UF : 0"))
    assert program.base is not None
    assert not any((*program.base.xyz_mm, *program.base.turn))


@pytest.mark.parametrize("path", sorted(GOLDEN.glob("*.ls")), ids=lambda path: path.stem)
def test_saved_by_a_controller(path):
    """All attributes, blanks elsewhere, no zero before the point, carriage returns."""
    text = path.read_text()
    other = re.sub(r"COMMENT.*?;\nDEFAULT_GROUP.*?;", ATTRIBUTES + "\n/APPL", text, flags=re.DOTALL)
    other = (
        re.sub(r"(?<=[ -])0\.", ".", other).replace("    ;", " ;").replace("\tUF :", "\t UF : ").replace("\n", "\r\n")
    )
    assert other != text
    assert read_tp(other) == read_tp(text)


EDITS = {
    "nothing": ("", "/PROG, /ATTR, /MN, /POS, /END is missing"),
    "no begin": (HOLE[8:], "/PROG is missing"),
    "something before the begin": ("HALT\n" + HOLE, "before /PROG"),
    "no end": (HOLE.replace("/END\n", ""), "/END is missing"),
    "sections in another order": (HOLE.replace("/ATTR", "/POS", 1), "another section of a program is expected"),
    "something after the end": (HOLE + "HALT\n", "where nothing is expected"),
    "another group": (HOLE.replace("1,*,*,*,*", "1,1,*,*,*"), "DEFAULT_GROUP"),
    "an attribute": (HOLE.replace("DEFAULT", "STACK = 1;\nDEFAULT"), "line 3: 'STACK = 1;' is not an attribute"),
    "an application": (HOLE.replace("/MN", "/APPL\nSPOT : TRUE ;\n/MN"), "line 5: 'SPOT : TRUE ;'"),
    "a line without a number": (HOLE.replace("   4:J", "    :J"), "line 8: ':J P[1] 20% FINE    ;' is not a numbered"),
    "a number twice": (HOLE.replace("   5:L", "   4:L"), "line 9: line number 4 where 5 is expected"),
    "no semicolon": (HOLE.replace("FINE    ;\n   5", "FINE\n   5"), "line 8"),
    "an unknown statement": (HOLE.replace("UTOOL_NUM=2", "PAYLOAD[2]"), "line 7: 'PAYLOAD[2]' is not a statement"),
    "a frame from a register": (HOLE.replace("UTOOL_NUM=2", "UTOOL_NUM=R[2]"), "line 7"),
    "no frame": (HOLE.replace("UTOOL_NUM=2", "!"), "line 8: a motion before UTOOL_NUM is set"),
    "a frame twice": (HOLE.replace("UTOOL_NUM=2", "UFRAME_NUM=1"), "line 7: UFRAME_NUM is set a second time"),
    "other frames": (HOLE.replace("UTOOL_NUM=2", "UTOOL_NUM=3"), "is in other frames than the program selects"),
    "a blended start": (HOLE.replace("20% FINE", "20% CNT100"), "line 8: a J move at a share of the speed"),
    "another blend": (HOLE.replace("30cm/min CNT100", "30cm/min CNT50"), "line 9"),
    "a speed of nothing": (HOLE.replace("30cm/min", "0cm/min"), "line 9: a speed of 0"),
    "a speed from a register": (HOLE.replace("30cm/min", "R[1]cm/min"), "line 9"),
    "half a speed": (HOLE.replace("30cm/min", "30.5cm/min"), "line 9"),
    "a joint move in mm/sec": (HOLE.replace("200msec", "200mm/sec"), "line 10: a move J in mm/sec"),
    "a straight move in msec": (HOLE.replace("20mm/sec", "20msec"), "line 12: a move L in msec"),
    "a straight move to joints": (
        HOLE.replace("L P[5]", "L P[4]").replace("J P[4]", "J P[5]"),
        "line 11: P[5] is a pose",
    ),
    "a position register": (HOLE.replace("L P[5]", "L PR[5]"), "line 12"),
    "a circular move": (HOLE.replace("L P[5]", "C P[5]"), "line 12"),
    "no such position": (HOLE.replace("L P[5]", "L P[6]"), "line 12: P[6] is not among the positions"),
    "a position twice": (HOLE.replace("J P[4]", "J P[3]"), "line 11: P[3] is moved to a second time"),
    "a position too many": (
        HOLE.replace("/END", HOLE[HOLE.index("P[5]{") : -5].replace("P[5]", "P[6]") + "/END"),
        "P[6] is not moved to",
    ),
    "two of one number": (HOLE.replace("P[4]{", "P[3]{"), "where the next position begins"),
    "a blended end": (HOLE.replace("20mm/sec FINE", "20mm/sec CNT100"), "the last move of a hole (line 12) is blended"),
    "moves without a start": (
        HOLE.replace("   4:J P[1] 20% FINE    ;", "   4:  !;"),
        "a move of a hole before the J move",
    ),
    "no holes": (re.sub(r"(?s)   5:L.*?/POS", "/POS", HOLE), "the program has no holes"),
    "a second group": (HOLE.replace("};\nP[2]", "   GP2:\n\tUF : 1, UT : 2,\n\tJ1= 0.0 mm\n};\nP[2]"), "another form"),
    "an external axis": (HOLE.replace("12.345 deg", "12.345 deg,\n\tE1= 1.0 mm"), "another form"),
    "inches": (HOLE.replace("385.000  mm", "385.000  in"), "another form"),
    "other letters": (HOLE.replace("'N U T", "'N L T"), "another form"),
    "a number that is none": (HOLE.replace("385.000", "385.0.0"), "another form"),
    "a masked number": (HOLE.replace("385.000", "*******"), "another form"),
    "a position that does not end": (HOLE.replace("};\n/END", "/END"), "P[5] does not end"),
    "a call between blended moves": (
        HOLE.replace("   6:J", "   6:  CALL X ;\n   7:J")
        .replace("   7:J P[4]", "   8:J P[4]")
        .replace("   8:L", "   9:L"),
        "line 10: X is called between blended moves",
    ),
    "an expression in a call": (HOLE.replace("   4:J P[1] 20% FINE    ;", "   4:  CALL X(R[1]) ;"), "line 8"),
    "a control character": (HOLE.replace("made", "ma\x0bde"), "line 5: a character of control"),
    "another alphabet": (HOLE.replace("made", "mäde"), "line 5: a character that is not ASCII"),
}


@pytest.mark.parametrize(("text", "why"), EDITS.values(), ids=EDITS)
def test_what_is_refused(text, why):
    assert text != HOLE
    with pytest.raises(InputError, match=re.escape(why)) as refused:
        read_tp(text, "a.ls")
    assert re.match(r"a\.ls, line \d+: ", str(refused.value))


def test_a_program_that_only_calls():
    text = re.sub(r"(?s)   2:.*?/POS.*?/END", "   2:  CALL CLAMP(1, 'on') ;\n   3:  CALL A_1 ;\n/POS\n/END", HOLE)
    name, statements = read_starter(text)
    assert name == "A"
    assert [statement.words for statement in statements[1:]] == [("CALL", "CLAMP", "1", "'on'"), ("CALL", "A_1")]
    assert read_starter(HOLE) is None


@pytest.mark.parametrize(
    ("found", "same"),
    [("-179.999", True), ("180.000", True), ("-180.000", True), ("-179.997", False), ("179.999", False)],
)
def test_last_digits_of_an_angle(found, same):
    words = [("L", "W", Decimal(number), "SPEED", "5", "mm/sec", "FINE") for number in (found, "-179.999")]
    assert alike(*words) == same


def test_a_speed_is_not_rounded():
    words = [("L", "W", Decimal("1.000"), "SPEED", speed, "mm/sec", "FINE") for speed in ("5", "6")]
    assert not alike(*words)
    assert TP.alike(words[0], words[0])
