"""Edits of one token of an exported program: each is refused, refuted, or harmless by name."""

import re
from collections import Counter

import pytest

from oracles.judged import Judge
from oracles.token_edits import Language, edits
from oracles.urscript_reader import ScriptError, commands
from zerorev.model.cycle import Cycle
from zerorev.program.urscript.dialect import URSCRIPT

LANGUAGE = Language(
    token=re.compile(r"p\[|[A-Za-z_]\w*|-?\d+(?:\.\d+)?|[\[\](),=:]"),
    comment=re.compile(r" *#.*"),
    words=(
        "movej", "movel", "movep", "servoj", "part", "base", "pose_trans", "pose_add", "set_tcp", "global", "local",
        "end", "r", "t",
    ),
    statements=(
        "sleep(1)", "halt", "stopj(2)", "freedrive_mode()", "set_tcp(p[0, 0, 0, 0, 0, 0])", "spin(1)", "end", "return",
        "part = p[0, 0, 0, 0, 0, 0]", "movej([0, 0, 0, 0, 0, 0], a=0.8, v=0.4)", "set_payload(1.0, [0, 0, 0])",
        "def a():", "movel(pose_trans(part, p[0.1, 0.1, 0.1, 0.0, 0.0, 0.0]), a=0.5, v=0.005, r=0.001)",
    ),
    rounded=lambda line: "[" in line,
)  # fmt: skip


@pytest.fixture(scope="module")
def plan(plan_called):
    return plan_called("free leg")


def within_brackets(old, new):
    """Whether two texts differ in one number of a pose or of joints."""
    pairs = [(a, b) for a, b in zip(commands(old), commands(new), strict=True) if a != b]
    if len(pairs) != 1 or len(pairs[0][0]) != len(pairs[0][1]):
        return False
    a, b = pairs[0]
    (k,) = [k for k, (x, y) in enumerate(zip(a, b, strict=True)) if x != y]
    opened = [word for word in a[:k] if str(word)[-1] in "[]"]
    return bool(opened) and str(opened[-1])[-1] == "["


def harmless(text, edited):
    """Whether the edited text tells a controller the same, by its commands alone."""
    try:
        return commands(edited) == commands(text)
    except ScriptError:
        return False


def hold(plan, count, seed):
    """Every edit of a plan's program to what it claims; how many there were of each kind and name."""
    judge, found = Judge.of(plan, URSCRIPT), Counter()
    text, original = judge.text, judge.read(judge.text)
    for edit in edits(text, LANGUAGE, count, seed):
        program, reasons = judge.judged(edit.text)
        name = edit.harmless
        if name is None and harmless(text, edit.text):
            name = "white space or comment"
        if name == "last printed digit" and not within_brackets(text, edit.text):
            name = None
        found[edit.kind, name] += 1
        if name is None:
            assert reasons, edit
            assert re.search(r"\bline \d+", reasons[0]), (edit.kind, reasons)
        else:
            assert not reasons, (edit.kind, name, reasons)
            if name != "last printed digit":
                assert program == original, edit.kind
            elif found[edit.kind, name] <= 3:
                # as printed it is either proven or not: both are right
                judge.certified(program)
    return found


def test_a_sample_of_edits(plan):
    found = hold(plan, 60, seed=1)
    assert len({kind for kind, _ in found}) > 8


@pytest.mark.long
def test_five_hundred_edits(plan):
    found = hold(plan, 500, seed=2)
    assert sum(count for (_, name), count in found.items() if name is None) > 300
    assert {name for _, name in found} == {None, "last printed digit", "zeros of a number", "white space or comment"}


@pytest.mark.parametrize("moving", [False, True])
@pytest.mark.parametrize("count", [60, pytest.param(500, marks=pytest.mark.long)])
def test_edits_where_the_tool_dwells(moving, count, plan_called):
    hold(plan_called("position 2", cycle=Cycle(dwell=0.12, moving=moving)), count, seed=4)
