"""Edits of a TP program: each is refused or refuted, naming the line, or harmless by name."""

import re
from collections import Counter
from itertools import pairwise

import pytest

from oracles.judged import Judge
from oracles.makers import position_plan
from oracles.token_edits import Language, edits
from zerorev.model.cycle import Cycle
from zerorev.program.tp.dialect import TP


def harmless(kind, token, line):
    if kind == "white space before a token":
        return "white space"
    return "attributes" if line.startswith("COMMENT") else None


LANGUAGE = Language(
    token=re.compile(r"-?\d+(?:\.\d+)?|/?[A-Za-z_][A-Za-z0-9_/]*|[%\[\]{}:;,=*'\"]"),
    comment=re.compile(r"!.*"),
    words=("J", "L", "C", "FINE", "CNT0", "CNT100", "P", "PR", "UF", "UT", "UFRAME_NUM", "UTOOL_NUM", "CALL", "mm",
           "deg", "N", "F", "U", "D", "T", "B", "X", "Z", "W", "J1", "J3", "msec", "sec", "cm/min", "mm/sec", "GP2"),
    statements=("   1:L P[2] 5mm/sec CNT100    ;", "   1:  PAUSE ;", "   1:  DO[1]=ON ;", "P[9]{", "};", "/END"),
    rounded=lambda line: re.match(r"\t.*(mm|deg)(,|$)", line) is not None,
    harmless=harmless,
)  # fmt: skip
MUST_PASS = ("last printed digit",)


@pytest.fixture(scope="module")
def judge(fanuc, for_tp):
    return Judge.of(position_plan(fanuc, 2, **for_tp), TP)


@pytest.fixture(scope="module")
def text(judge):
    return judge.text


def hold(judge, count, seed):
    original, found = judge.read(judge.text), Counter()
    for edit in edits(judge.text, LANGUAGE, count, seed):
        program, reasons = judge.judged(edit.text)
        found[edit.kind, edit.harmless, not reasons] += 1
        if reasons:
            assert edit.harmless not in MUST_PASS, (edit.kind, reasons)
            assert re.search(r"\bline \d+", reasons[0]), (edit.kind, reasons)
        elif edit.harmless == "last printed digit":
            # as printed it is either proven, by ball arithmetic, or not: both are right
            judge.certified(program)
        else:
            same = edit.text.split() == judge.text.split()  # a line that is cut may lose white space alone
            assert edit.harmless is not None or same, (edit.kind, edit.text)
            # the reader sees no difference, so that the certificate of the original is its own
            assert program == original, (edit.kind, edit.harmless)
    return found


def test_a_sample_of_edits(judge):
    found = hold(judge, 120, seed=1)
    assert sum(count for (_, name, _), count in found.items() if name is None) > 60


@pytest.mark.parametrize("moving", [False, True])
@pytest.mark.parametrize("count", [60, pytest.param(500, marks=pytest.mark.long)])
def test_edits_where_the_tool_dwells(moving, count, fanuc, for_tp):
    hold(Judge.of(position_plan(fanuc, 2, cycle=Cycle(dwell=0.12, moving=moving), **for_tp), TP), count, seed=4)


@pytest.mark.long
def test_five_hundred_edits(judge):
    found = hold(judge, 500, seed=2)
    assert len({kind for kind, _, _ in found}) == 11
    assert {name for _, name, passed in found if passed} >= {"last printed digit", "zeros of a number", "white space"}
    assert sum(count for (_, name, _), count in found.items() if name is None) > 250


# --- edits of whole lines, numbered again -----------------------------------------------------------------------------


def numbered(head, lines, rest):
    again = [re.sub(r"^ *\d+:", f"{count:4d}:", line) for count, line in enumerate(lines, start=1)]
    return "\n".join([head, "/MN", *again, "/POS", rest])


def parts(text):
    head, _, behind = text.partition("\n/MN\n")
    listing, _, rest = behind.partition("\n/POS\n")
    return head, listing.split("\n"), rest


def test_lines_left_out_doubled_or_swapped(text, judge):
    head, lines, rest = parts(text)
    assert numbered(head, lines, rest) == text
    stated = [k for k, line in enumerate(lines) if ":  !" not in line]
    for k in stated:
        assert judge.judged(numbered(head, lines[:k] + lines[k + 1 :], rest))[1]
        assert judge.judged(numbered(head, [*lines[: k + 1], *lines[k:]], rest))[1]
    for first, second in pairwise(stated[2:]):
        swapped = lines.copy()
        swapped[first], swapped[second] = lines[second], lines[first]
        assert judge.judged(numbered(head, swapped, rest))[1]


STATEMENTS = [
    "UFRAME_NUM=0 ", "UTOOL_NUM=4 ", "UTOOL[3]=PR[1] ", "CALL OTHER ", "WAIT    .00(sec) ", "OVERRIDE=100% ", "PAUSE ",
    "DO[1]=ON ", "R[1]=1 ", "$MCR.$GENOVERRIDE=50 ", "JMP LBL[1] ", "LBL[1] ", "OFFSET CONDITION PR[1] ", "PAYLOAD[1] ",
    "SKIP CONDITION DI[1]=ON ", "//PAUSE ", "--eg:text ", "", "ABORT ", "END ",
]  # fmt: skip


@pytest.mark.parametrize("statement", STATEMENTS)
def test_a_statement_put_in_anywhere(statement, text, judge):
    head, lines, rest = parts(text)
    stated = [k for k, line in enumerate(lines) if ":  !" not in line]
    for k in [*stated, len(lines)]:
        reasons = judge.judged(numbered(head, [*lines[:k], f"   1:  {statement};", *lines[k:]], rest))[1]
        assert reasons
        assert "line" in reasons[0]


OPTIONS = [
    "ACC50",
    "Offset,PR[1]",
    "Tool_Offset,PR[1]",
    "INC",
    "Skip,LBL[1]",
    "TB .10sec,CALL X",
    "Wjnt",
    "COORD",
    "PTH",
]


@pytest.mark.parametrize("option", OPTIONS)
def test_an_option_of_a_motion(option, text, judge):
    found = re.findall(r"P\[\d+\] \S+ (?:FINE|CNT100)", text)
    assert len(found) > 4
    for motion in found:
        assert judge.judged(text.replace(motion, f"{motion} {option}"))[1]


def test_remarks_are_free(text, judge):
    head, lines, rest = parts(text)
    other = [":  ! ours ;" if ":  !" in line else line for line in lines]
    other = [f"   1{line}" if line.startswith(":") else line for line in [*other, ":  ! the end ;"]]
    assert judge.judged(numbered(head, other, rest)) == (judge.read(text), ())
