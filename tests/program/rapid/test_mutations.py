"""Edits of a RAPID program, one token at a time: each is refuted or refused, or harmless by name."""

import re
from collections import Counter

import pytest

import zerorev as zr
from oracles.judged import Judge
from oracles.makers import panel_plan, stand_in
from oracles.rapid_reader import commands
from oracles.token_edits import Language, edits
from zerorev.model.cycle import Cycle
from zerorev.program.rapid.dialect import RAPID

LANGUAGE = Language(
    token=re.compile(r'"[^"]*"|:=|-?\d+(?:\.\d+)?(?![\w.])|[\[\](),;\\]|\w+'),
    comment=re.compile(r"!.*"),
    words=("MoveL", "MoveJ", "MoveAbsJ", "MoveC", "fine", "z1", "z10", "v100", "vmax", "tool0", "wobj0", "On", "Off",
           "9E9", "TRUE", "LOCAL", "PERS", "VAR", "ENDPROC", "ConfL", "zone_1_0000", "feed_5_000", "way_speed"),
    statements=("WaitTime 1;", "SetDO do1,1;", "Stop;", "PDispOn tool0;", "ConfL\\On;", "VelSet 50,5000;", "EXIT;",
                "ENDPROC", "MoveL Offs(p1,0,0,5),v10,fine,tool0;", "VAR num n;", "n:=1;", "other_run;"),
    rounded=lambda line: line.lstrip().startswith(("MoveL", "MoveAbsJ", "PERS")),
    harmless=lambda kind, token, line: _harmless(kind, token, line),
)  # fmt: skip


def _harmless(kind, token, line):
    if kind == "white space before a token":
        return "white space"
    return None


@pytest.fixture(scope="module")
def plan():
    return panel_plan(stand_in("ABB"), 2, min_rate=zr.Settings().min_rate)


def hold(plan, count, seed):
    """Every edit of a plan's program to what it claims; how many there were of each name."""
    judge, found = Judge.of(plan, RAPID), Counter()
    text, original, reached = judge.text, judge.read(judge.text), commands(judge.text)
    assert judge.certified(original)
    for kind, edited, harmless in edits(text, LANGUAGE, count, seed):
        program, reasons = judge.judged(edited)
        if not reasons and harmless is None:
            harmless = unchanged(edited, reached, program, original)
            assert harmless, (kind, difference(text, edited))
        if harmless == "white space":
            # white space within a statement may also break it: a word of two signs, or a text
            assert reasons or unchanged(edited, reached, program, original), (kind, difference(text, edited))
        elif harmless == "last printed digit":
            if not reasons:  # as printed it is either proven, by ball arithmetic, or not: both are right
                judge.certified(program)
            else:
                assert not inside_a_point(text, edited), (reasons, difference(text, edited))
        elif harmless is not None:
            assert not reasons, (kind, harmless, reasons, difference(text, edited))
        if reasons:
            assert re.search(r"\bline \d+", reasons[0]), (kind, reasons)
        found[kind, harmless if not reasons else None] += 1
    return found


def unchanged(edited, reached, program, original):
    """Why an edit that passes does so: neither a controller nor the reader sees a difference."""
    return "no difference" if commands(edited) == reached and program == original else None


def difference(text, edited):
    lines = text.split("\n"), edited.split("\n")
    return next(((a, b) for a, b in zip(*lines, strict=False) if a != b), lines[0][-1:])


def inside_a_point(text, edited):
    """Whether the number that differs is one of a point or a frame: it has decimals, and stands in brackets."""
    old, new = difference(text, edited)
    at = next(k for k, (a, b) in enumerate(zip(old + "\0", new + "\0", strict=False)) if a != b)
    word = re.search(r"[-\d.]*$", old[:at])[0] + re.match(r"[-\d.]*", old[at:])[0]
    return "." in word and old[:at].count("[") > old[:at].count("]")


def test_a_sample_of_edits(plan):
    found = hold(plan, 120, seed=1)
    assert len({kind for kind, _ in found}) > 8


@pytest.mark.parametrize("moving", [False, True])
@pytest.mark.parametrize("count", [60, pytest.param(500, marks=pytest.mark.long)])
def test_edits_where_the_tool_dwells(moving, count):
    hold(
        panel_plan(stand_in("ABB"), 1, min_rate=zr.Settings().min_rate, cycle=Cycle(dwell=0.12, moving=moving)),
        count,
        seed=4,
    )


@pytest.mark.long
def test_five_hundred_edits(plan):
    found = hold(plan, 500, seed=2)
    assert {harmless for _, harmless in found} >= {None, "zeros of a number", "last printed digit"}
    assert sum(count for (_, harmless), count in found.items() if harmless is None) > 250
