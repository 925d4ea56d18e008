"""Edits of one token of a job: each is refuted or refused, naming the line, or harmless by name."""

import re
from collections import Counter

import pytest

from oracles.inform_reader import read
from oracles.judged import Judge
from oracles.token_edits import Language, edits
from zerorev.model.cycle import Cycle
from zerorev.program.inform.dialect import INFORM


def harmless(kind, token, line):
    """What the reader leaves to the controller: the date, a comment of the job, and comments."""
    if line.startswith(("///DATE", "///COMM", "'")):
        return "date or comment"
    return "comment" if kind == "insert a statement" and token == "'" else None


INFORM_EDITS = Language(
    token=re.compile(r"-?\d+(?:\.\d+)?|[A-Z]+|///?|[=,:]"),
    comment=re.compile(r"'.*"),
    words=("MOVL", "MOVJ", "MOVC", "PL", "VR", "V", "VJ", "C", "NOP", "END", "CALL", "RB2", "BASE", "RW"),
    statements=("TIMER T=1.00", "MOVL C00000 V=5.0 PL=0", "DOUT OT#(1) ON", "CALL JOB:OTHER", "///TOOL 4", "NOP"),
    rounded=lambda line: re.match(r"C\d{5}=", line) is not None,
    harmless=harmless,
)


@pytest.fixture(scope="module")
def plan(plan_for):
    return plan_for("ma2010", "panel", count=2)


def hold(plan, count, seed):
    """Every edit to what it claims; how many there were of each kind and name."""
    judge, found = Judge.of(plan, INFORM), Counter()
    text, original = judge.text, judge.read(judge.text)
    assert judge.certified(original)
    for kind, edited, name in edits(text, INFORM_EDITS, count, seed):
        found[kind, name] += 1
        program, reasons = judge.judged(edited)
        if program is None:  # what is harmless may be refused all the same
            assert re.search(r"\bline \d+", reasons[0]), (kind, edited)
            continue
        if name is None:
            assert reasons, (kind, edited)
            assert re.search(r"\bline \d+", reasons[0]), (kind, reasons)
        elif name == "last printed digit":
            assert not reasons, (kind, reasons)
            moved = [abs(a.pulses - b.pulses).sum() for a, b in zip(read(text).moves, read(edited).moves, strict=True)]
            assert sorted(moved)[-2:] == [0, 1]
            judge.certified(program)
        else:
            assert not reasons, (kind, name, reasons)
            assert program == original, (kind, name)
    return found


def test_a_sample_of_edits(plan):
    found = hold(plan, 100, seed=1)
    assert len({kind for kind, _ in found}) > 8


@pytest.mark.parametrize("moving", [False, True])
@pytest.mark.parametrize("count", [60, pytest.param(500, marks=pytest.mark.long)])
def test_edits_where_the_tool_dwells(moving, count, plan_for):
    hold(plan_for("ma2010", 1, cycle=Cycle(dwell=0.12, moving=moving)), count, seed=4)


@pytest.mark.long
def test_five_hundred_edits(plan):
    found = hold(plan, 500, seed=2)
    assert len({kind for kind, _ in found}) == 11
    assert sum(count for (_, name), count in found.items() if name is None) > 350
    assert found["another number", "last printed digit"]
