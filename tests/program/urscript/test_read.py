"""The reader is strict: what is not of the format is refused, with its line and what is accepted."""

import re

import pytest

from zerorev.errors import InputError
from zerorev.program.export import export
from zerorev.program.urscript.read import read_urscript


@pytest.fixture(scope="module")
def text(plan_called):
    return export(plan_called("position 1")).text


def line(text, begin):
    """The only line that begins so, or the first."""
    return next(each for each in text.split("\n") if each.strip().startswith(begin))


def test_what_is_read(text):
    program = read_urscript(text)
    (hole,) = program.holes
    assert program.name == "position_1"
    assert [move.linear for move in hole.moves] == [True, True, False, False, True]
    assert [str(move.pace.value) for move in hole.moves] == [
        "0.0050000", "0.0050000", "0.2000000", "0.0500000", "0.0200000"
    ]  # fmt: skip
    assert [move.pace.unit for move in hole.moves] == ["m/s", "m/s", "s", "s", "m/s"]
    assert [float(move.blend_mm) for move in hole.moves] == [1.0, 0.45, 0.45, 0.45, 0.0]
    assert {hole.start.unit, *(move.end.unit for move in hole.moves if not move.linear)} == {"rad"}
    assert {move.end.form for move in hole.moves if move.linear} == {"vector_rad"}
    assert hole.moves[0].end.xyz_mm[0] * 1000 == program.holes[0].moves[0].end.xyz_mm[0].scaleb(3)


def test_line_ends_indents_and_comments_do_not_matter(text):
    plain = re.sub(r"(?m)^ +", "\t", re.sub(r" *#.*", "", text)).replace("\n", "\r\n")
    assert read_urscript(plain) == read_urscript(text)


NEW = "  movej([0.0, 0.0, 0.0, 0.0, 0.0, 0.0], a=0.8, v=0.4)\n"
EDITS = {
    "a movej with a blend": (r", a=0\.8, v=0\.4\)", ", a=0.8, v=0.4, r=0.01)", "movej"),
    "a movej to a pose": (r"movej\(\[([^]]*)\], t", r"movej(p[\1], t", "movej"),
    "a movep": (r"movel\(pose_trans", "movep(pose_trans", "movep"),
    "a movel to joints": (r"movel\(pose_trans\(part, p(\[[^]]*\])\)", r"movel(\1", "movel"),
    "a movel in the base": (r"movel\(pose_trans\(part, (p\[[^]]*\])\)", r"movel(\1", "movel"),
    "a movel in another frame": (r"pose_trans\(part,", "pose_trans(other,", "movel"),
    "a movel with a time": (r"v=0\.0200000\)", "v=0.0200000, t=1.0)", "movel"),
    "a movel without a speed": (r", v=0\.0200000\)", ")", "movel"),
    "a speed of 0": (r"v=0\.0200000", "v=0.0", "v=0.0"),
    "an acceleration below 0": (r"a=0\.5, v=0\.02", "a=-0.5, v=0.02", "a=-0.5"),
    "a time of 0": (r"t=0\.2000000", "t=0", "t=0"),
    "a radius of 0": (r"r=0\.0010000", "r=0", "r=0"),
    "the last move blended": (r"v=0\.0200000\)", "v=0.0200000, r=0.001)", "the last move of a hole"),
    "no tool": (r"  set_tcp.*\n", "", "a move before set_tcp"),
    "no part": (r"  local part.*\n", "", "a move before part"),
    "a part for the whole controller": ("local part", "global part", "global"),
    "the tool set twice": (r"(  set_tcp.*\n)", r"\1\1", "set_tcp is set a second time"),
    "the tool set within the hole": (r"(  set_tcp.*\n)([^@]*\n)(  movel.*\n)", r"\1\2\1\3", "set_tcp is set a second"),
    "a mass of 0": (r"set_payload\(0\.3000", "set_payload(0.0", "mass=0"),
    "a second function": (r"\nend", "\nend\ndef other():\nend", "after end"),
    "a function within": (r"(  set_tcp)", r"  def other():\n\1", "a second program"),
    "something before def": (r"^def", "set_tcp(p[0, 0, 0, 0, 0, 0])\ndef", "before def"),
    "a call at the end": (r"end\n$", "end\nposition_1()\n", "after end"),
    "no end": (r"end\n$", "", "not complete"),
    "a name that is none": (r"def position_1", "def movej", "def movej"),
    "a parameter": (r"position_1\(\)", "position_1(a)", "def position_1"),
    "two statements": (r"(  set_tcp.*)\n", r"\1; halt\n", "neither a name nor a number"),
    "freedrive": (r"(  set_payload)", r"  freedrive_mode()\n\1", "freedrive_mode"),
    "an if": (r"(  set_payload)", r"  if True:\n\1", "if"),
    "an expression": (r"v=0\.0200000", "v=0.01*2", "neither a name nor a number"),
    "a number in another notation": (r"v=0\.0200000", "v=2e-2", "neither a name nor a number"),
    "a sixth number missing": (r", [-0-9.]+\], t", "], t", "movej"),
    "a call between blended moves": (r"(  movej\(\[[^]]*\], t)", r"  spin()\n\1", "called between blended moves"),
    "a call with a variable": (r"(  set_payload)", r"  spin(fast)\n\1", "spin"),
    "an odd character in a comment": ("# target", "# target\u2028", "not ASCII"),
    "a carriage return alone": ("# target", "# target\rhalt()", "carriage return"),
    "a movel before the first movej": (r"(  local.*\n)([^@]*\n)(  movel.*\n)", r"\1\3\2\3", "before the movej"),
}  # fmt: skip


@pytest.mark.parametrize("edit", EDITS.values(), ids=EDITS)
def test_what_is_refused(edit, text):
    pattern, new, what = edit
    edited = re.sub(pattern, new, text, count=1)
    assert edited != text
    with pytest.raises(InputError, match=re.escape(what)) as refused:
        read_urscript(edited, "here.script")
    assert re.search(r"here\.script, line \d+", str(refused.value))


@pytest.mark.parametrize(
    "text", ["", "\n", "# only this\n", "def a():\nend\n", "def a():\n  b()\nend\n", "set_tcp(\n", "def\n", "\0"]
)
def test_other_texts_are_refused(text):
    with pytest.raises(InputError):
        read_urscript(text)
