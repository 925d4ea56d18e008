"""Whole programs, byte for byte. A difference is read as a safety review: every changed line moves a robot.

To write them again after such a review: `ZEROREV_WRITE_GOLDEN=1 pytest tests/program/test_golden.py`.
"""

import os

import numpy as np
import pytest

from oracles.places import GOLDEN
from zerorev.program.export import export

POSITIONS = {1: "position_1", 2: "position_2", 3: "position_3"}


def check(name, exported):
    assert exported.name == name
    path = GOLDEN / exported.files[0].name
    if os.environ.get("ZEROREV_WRITE_GOLDEN"):
        path.write_bytes(exported.text.encode("ascii"))
    assert path.read_bytes() == exported.text.encode("ascii")


@pytest.mark.parametrize("number", POSITIONS)
def test_published_position(number, published, plan_of):
    plan = plan_of(published(number), name=POSITIONS[number], spindle_rpm=3000.0)
    check(POSITIONS[number], export(plan, version="golden"))


def test_three_positions_on_a_tilted_part_with_a_deeper_corner(published, plan_of):
    T = np.eye(4)
    c, s = np.cos(np.deg2rad(30)), np.sin(np.deg2rad(30))
    T[:3, :3] = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
    T[:3, 3] = 0.4, -0.1, 0.3
    holes = [published(n, corner=-1e-3) for n in POSITIONS]
    plan = plan_of(*holes, name="tilted part", T_base_part=T, blend=2e-3, deepen_corner=True, lead_in=3e-3)
    check("tilted_part", export(plan, name="tilted_part", version="golden"))
