"""Whole programs, byte for byte. A difference is read as a safety review: every changed line moves a robot.

To write them again after such a review: `ZEROREV_WRITE_GOLDEN=1 pytest tests/program/urscript/test_golden.py`.
"""

import os
from dataclasses import replace

import numpy as np
import pytest

from oracles import arm
from oracles.places import GOLDEN
from zerorev.model.controller import Call, Calls
from zerorev.program.export import export

CALLS = Calls((Call("CLAMP", ("TRUE",)),), (Call("spin", ("6000",)),), (Call("rest"),), (Call("CLAMP", ("FALSE",)),))


def check(exported):
    for file in exported.files:
        path = GOLDEN / f"urscript_{file.name}"
        if os.environ.get("ZEROREV_WRITE_GOLDEN"):
            path.write_bytes(file.text.encode("ascii"))
        assert path.read_bytes() == file.text.encode("ascii")


@pytest.mark.parametrize("number", [1, 2, 3])
def test_positions(number, plan_called):
    plan = plan_called(f"position {number}", spindle_rpm=3000.0)
    check(export(plan, version="golden", plan_file="plan.json"))


def test_free_legs_on_a_tilted_part_with_calls_and_a_deeper_corner(plan_called):
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = arm.rotation(np.array([0.6, 0.0, 0.8]), 0.7)[:3, :3], (0.4, -0.1, 0.3)
    plan = replace(plan_called("free leg", calls=CALLS, deepen_corner=True), T_base_part=T)
    check(export(plan, version="golden"))


def test_three_holes_in_two_parts(plan_called):
    plan = plan_called("panel")
    plan = replace(plan, holes=plan.holes[:3], name="split")
    check(export(plan, version="golden", holes_per_program=2))
