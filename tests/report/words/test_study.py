"""What is said beside a study: how much of it rests on guesses, and what thrust does."""

from __future__ import annotations

from dataclasses import replace

from zerorev.cell.possible import Arms
from zerorev.model.ranges import HELD, RANGES, Cell
from zerorev.report.words.study import kept_words, lines, rests_on

PRIOR = len(RANGES) - len(HELD)


def known(basis, *names):
    return {name: replace(RANGES[name], basis=basis) for name in names}


def test_every_range_is_said_to_be_a_guess_or_where_it_comes_from(tool):
    assert rests_on(Cell(), tool).startswith(f"All {PRIOR - 2} ranges are guesses")  # the tool's file states two
    tool = replace(tool, load=None)
    assert rests_on(Cell(), tool).startswith(f"All {PRIOR} ranges are guesses")
    six = [f"friction_{joint}" for joint in range(1, 7)]
    cell = Cell(known("fitted", "tool_mass", "friction", *six, "gap_3") | known("conditioned", "bandwidth"))
    said = rests_on(cell, tool)
    assert "Fitted to recordings: friction, friction_1 to friction_6, gap_3, tool_mass." in said
    assert "Narrowed by a recording: bandwidth." in said
    assert f"The other {PRIOR - 10} of {PRIOR} ranges are guesses." in said


def test_thrust_is_said_where_there_is_any(tool):
    quiet, loud = ([str(line) for line in lines([], {"h": "why"}, thrust, Cell(), tool)] for thrust in (0.0, 100.0))
    assert quiet == ["left out: hole h: why"]
    assert loud[0] == quiet[0]
    assert "With 100 N of thrust on a free tip" in loud[1]
    assert "the gain may be lost" in loud[1]
    assert "must let the tool turn" in loud[1]


def test_how_many_arms_are_near_what_was_measured():
    assert kept_words(Arms((), 5)) is None
    assert "no set is dropped" in kept_words(Arms((), 5, 0))
    assert kept_words(Arms((), 5, 2)) == "0 of 5 sets have baselines near those that were measured"
