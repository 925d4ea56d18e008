"""The certificate of a TP program by itself: without the comparison with what `export` writes."""

import re

import pytest

from oracles.makers import position_plan
from zerorev.model.cycle import Cycle
from zerorev.program.dialect import ProgramFile
from zerorev.program.export import export
from zerorev.program.tp.dialect import TP
from zerorev.verify.certificate.program import certify_program_hole


@pytest.fixture(scope="module")
def plan(fanuc, for_tp):
    return position_plan(fanuc, 1, feed_plunge=2.5e-3, **for_tp)


@pytest.fixture(scope="module")
def text(plan):
    return export(plan, version="test").text


def alone(plan, text):
    program = TP.read([ProgramFile("a.ls", text)])
    return certify_program_hole(plan, plan.holes[0], program, program.holes[0])


def joints(text):
    """The numbers of the positions in joint values."""
    return [int(number) for number in re.findall(r"P\[(\d+)\]\{\n   GP1:\n[^\n]*\n\tJ1", text)]


def shifted(text, number, name, by):
    """The text with one value of one position changed."""
    begin = text.index(f"P[{number}]{{")
    found = re.compile(rf"{name} ?= *(-?[\d.]+)").search(text, begin)
    return text[: found.start(1)] + f"{float(found[1]) + by:.3f}" + text[found.end(1) :]


def test_as_it_is(plan, text):
    certificate = alone(plan, text)
    assert (certificate.verdict, certificate.reasons) == ("certified", ())
    assert "15cm/min CNT100" in text
    assert len(joints(text)) == 3


EDITS = {
    "another feed": lambda text: text.replace("15cm/min", "16cm/min"),
    "another unit": lambda text: text.replace("15cm/min", "15mm/sec"),
    "twice the time": lambda text: re.sub(r"(\d+)msec", lambda found: f"{2 * int(found[1])}msec", text, count=1),
    "a stop at the corner": lambda text: re.sub(r"msec CNT100", "msec FINE", text, count=1),
    "a stop on the way in": lambda text: text.replace("15cm/min CNT100", "15cm/min FINE", 1),
    "beside the axis": lambda text: shifted(text, 2, "Y", 0.01),
    "beyond the stroke": lambda text: shifted(text, 6, "X", -6.0),
    "the tool turned": lambda text: shifted(text, 3, "P", 0.02),
    "a joint of the corner": lambda text: shifted(text, joints(text)[1], "J4", 0.1),
    "a whole turn at the corner": lambda text: shifted(text, joints(text)[1], "J6", 360.0),
    "a whole turn at the start": lambda text: shifted(text, joints(text)[0], "J6", 360.0),
    "J3 against link 2": lambda text: shifted(text, joints(text)[0], "J3", -22.0),
}


@pytest.mark.parametrize("edit", EDITS.values(), ids=EDITS)
def test_refuted_by_geometry_alone(edit, plan, text):
    assert edit(text) != text
    certificate = alone(plan, edit(text))
    assert certificate.verdict == "refuted"
    assert certificate.reasons


def test_it_counts_from_the_controllers_base(plan, text, spoil):
    """Of a robot that counts from elsewhere, or that shows the joint that turns, it is another program."""
    for change in ({"base_in_root": None}, {"display": type(plan.robot.display)()}):
        other = spoil(plan, robot=spoil(plan.robot, **change))
        assert alone(other, text).verdict == "refuted"


def test_chips_are_broken(fanuc, for_tp, certificates):
    plan = position_plan(fanuc, 1, cycle=Cycle("chip_break", 10e-3, 0.3e-3), **for_tp)
    exported = export(plan, version="test")
    # into a corner and out of it, four times besides that at the target, and further in after each
    assert len(re.findall(r":J P\[\d+\] \d+msec CNT100", exported.text)) == 4 * 3 + 2
    assert [(each.verdict, each.reasons) for each in certificates(plan, exported)] == [("certified", ())]
