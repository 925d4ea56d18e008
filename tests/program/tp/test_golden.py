"""Whole TP programs, byte for byte. A difference is read as a safety review: every changed line moves a robot.

To write them again after such a review: `ZEROREV_WRITE_GOLDEN=1 pytest tests/program/tp/test_golden.py`.
"""

import os
from dataclasses import replace

import numpy as np
import pytest

from oracles.makers import free_leg_plan, position_plan
from oracles.places import GOLDEN
from zerorev.program.export import export


def check(stem, exported):
    path = GOLDEN / f"{stem}.ls"
    if os.environ.get("ZEROREV_WRITE_GOLDEN"):
        path.write_bytes(exported.text.encode("ascii"))
    assert path.read_bytes() == exported.text.encode("ascii")


@pytest.mark.parametrize("number", [1, 2, 3])
def test_positions(number, fanuc, for_tp):
    plan = position_plan(fanuc, number, spindle_rpm=3000.0, **for_tp)
    check(f"tp_position_{number}", export(plan, version="golden"))


def test_free_legs_in_a_user_frame(fanuc, for_tp):
    plan = free_leg_plan(fanuc, base_number=2, feed_plunge=4.5e-3, **for_tp)
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = [[0, -1, 0], [1, 0, 0], [0, 0, 1]], (0.4, -0.1, 0.3)
    check("tp_free_leg", export(replace(plan, T_base_part=T), name="free", version="golden"))
