"""Whole jobs, byte for byte. A difference is read as a safety review: every changed line moves a robot.

To write them again after such a review: `ZEROREV_WRITE_GOLDEN=1 pytest tests/program/inform/test_golden.py`.
"""

import os
import re
from dataclasses import replace

import pytest

from oracles.inform_reader import read
from oracles.places import GOLDEN
from zerorev.model.controller import Call, Calls
from zerorev.program.export import export


def check(exported):
    for file in exported.files:
        path = GOLDEN / file.name
        if os.environ.get("ZEROREV_WRITE_GOLDEN"):
            path.write_bytes(file.text.encode("ascii"))
        assert path.read_bytes() == file.text.encode("ascii")
        read(file.text)


@pytest.mark.parametrize("number", [1, 2, 3])
def test_position(number, plan_for):
    check(export(plan_for("ma2010", number), name=f"MA2010_{number}", version="golden"))


def test_parts_and_calls(plan_for):
    plan = plan_for("ma2010", "panel", count=3, approach=10e-3, retract=15e-3, deepen_corner=True)
    calls = Calls((Call("CLAMP"),), (Call("SPIN_ON"),), (Call("SPIN_OFF"),), (Call("UNCLAMP"),))
    called = replace(plan, settings=replace(plan.settings, calls=calls, holes_per_program=2))
    check(export(called, name="PARTS", version="golden"))


def test_the_page_shows_what_is_written():
    page = (GOLDEN.parents[1] / "docs" / "howto" / "controller_inform.md").read_text()
    shown = [line for line in page.split("\n") if re.match(r"(C\d{5}=|MOV[JL] C\d{5} VJ?=)", line)]
    golden = (GOLDEN / "MA2010_1.JBI").read_text().split("\n")
    assert len(shown) == 7
    assert [line for line in golden if line in shown] == shown
