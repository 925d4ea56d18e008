"""The reader of jobs: what it takes, and at which line it refuses what."""

import re

import pytest

from oracles.places import DATA
from zerorev.errors import InputError
from zerorev.program.export import export
from zerorev.program.inform.read import read_job

SAMPLE = (DATA / "program" / "sample.JBI").read_text()


def test_a_job_in_the_shape_of_public_ones():
    """Head, positions and moves as the manuals of the controllers have them; the numbers are made up."""
    job = read_job(SAMPLE)
    assert job.name == "DRILL-1"
    assert [statement.words for statement in job.head] == [("//NAME", "DRILL-1"), ("///TOOL", 12)]
    (hole,) = job.holes
    assert (job.tool, job.base) == (None, None)
    assert hole.start.unit == "pulses"
    assert [int(value) for value in hole.start.values] == [15000, 22000, -31000, -400, -12000, 7000]
    assert [statement.words[0] for statement in hole.way] == ["MOVJ", "CALL"]
    assert [(move.linear, str(move.pace.value), move.pace.unit, move.blend_mm) for move in hole.moves] == [
        (True, "0.0050", "m/s", None),
        (False, "0.47", "%", None),
        (True, "0.0833", "m/s", 0),
    ]
    assert len(job.tail) == 1
    assert read_job(SAMPLE.replace("\n", "\r\n")) == job


EDITS = {
    "no job": ("/JOB\n", "", 1, "/JOB"),
    "a name too long": ("DRILL-1", "D" * 33, 2, "32 capitals"),
    "too few positions": ("///NPOS 6", "///NPOS 7", 14, "C00006="),
    "too many positions": ("///NPOS 6", "///NPOS 5", 13, "//INST"),
    "variables": ("///NPOS 6,0,0,0,0,0", "///NPOS 6,0,0,1,0,0", 4, "///NPOS 0,0,0,0,0,0"),
    "a Cartesian job": ("///POSTYPE PULSE", "///POSTYPE BASE", 6, "///POSTYPE PULSE"),
    "another tool for some": ("C00002=", "///TOOL 3\nC00002=", 10, "C00002="),
    "a position out of order": ("C00002=", "C00003=", 10, "C00002="),
    "half a pulse": ("22000,", "22000.5,", 9, "whole pulses"),
    "an axis missing": (",230\n", "\n", 8, "six axes"),
    "a station": ("///GROUP1 RB1", "///GROUP1 RB1,ST1", 18, "///GROUP1 RB1"),
    "a comment too long": ("///COMM made up", "///COMM " + 33 * "x", 16, "32 characters"),
    "no level": ("VJ=20.00 PL=0", "VJ=20.00", 21, "MOVJ C00000"),
    "a circle": ("MOVL C00002", "MOVC C00002", 24, "MOVJ C00000"),
    "an arc at the corner": ("PL=1", "CR=1.0", 24, "MOVJ C00000"),
    "a turning speed": ("MOVL C00002 V=5.0", "MOVL C00002 VR=5.0", 24, "MOVJ C00000"),
    "a share on a straight move": ("MOVL C00002 V=5.0", "MOVL C00002 VJ=5.0", 24, "MOVL with V="),
    "no speed": ("V=5.0", "V=0.0", 24, "above 0"),
    "more than all": ("VJ=20.00", "VJ=100.01", 21, "100 at most"),
    "a move twice": ("MOVL C00002", "MOVL C00001", 24, "C00002"),
    "a position unused": ("MOVJ C00005 VJ=20.00 PL=0\n", "", 27, "each position"),
    "a wait in a hole": ("MOVJ C00003", "TIMER T=1.00\nMOVJ C00003", 25, ""),
    "an output in a hole": ("MOVJ C00003", "DOUT OT#(1) ON\nMOVJ C00003", 25, "MOVJ C00000"),
    "a call in a hole": ("MOVJ C00003", "CALL JOB:A\nMOVJ C00003", 25, ""),
    "a comment in a hole": ("MOVJ C00003", "' here\nMOVJ C00003", 25, ""),
    "a blended end": ("V=83.3 PL=0", "V=83.3 PL=1", 27, "PL=0"),
    "a move before its hole": ("MOVJ C00000 VJ=20.00 PL=0", "MOVJ C00000 VJ=20.00 PL=1", 21, ""),
    "after the end": ("END\n", "END\nNOP\n", 29, "last line"),
    "no end": ("END\n", "", 27, "/JOB to END"),
    "small letters": ("MOVL C00002", "movl C00002", 24, "MOVJ C00000"),
    "a tab": ("MOVL C00002", "MOVL\tC00002", 24, "MOVJ C00000"),
    "a form feed": ("' made up", "' made\fup", 20, ""),
    "not ASCII": ("' made up", "' made \xe4p", 20, ""),
}


@pytest.mark.parametrize(("old", "new", "line", "accepted"), EDITS.values(), ids=EDITS)
def test_what_is_refused(old, new, line, accepted):
    assert old in SAMPLE
    with pytest.raises(InputError) as refused:
        read_job(SAMPLE.replace(old, new, 1), "here.JBI")
    assert f"here.JBI, line {line}" in str(refused.value)
    assert accepted in str(refused.value)


def test_another_date_and_another_comment_are_the_controllers(plan_for):
    text = export(plan_for("ma2010", 1)).text
    saved = text.replace("2000/01/01 00:00", "2026/11/30 17:45").replace("///COMM position_1\n", "")
    assert read_job(saved) == read_job(text)


def test_a_name_takes_what_a_controller_takes(plan_for):
    exported = export(plan_for("ma2010", 1), name="Left wing, first part")
    assert re.fullmatch(r"L_[A-Z0-9]{6}\.JBI", exported.files[0].name)
    assert export(plan_for("ma2010", 1), name="wing_1").files[0].name == "WING_1.JBI"
