"""Whole RAPID programs, byte for byte. A difference is read as a safety review: every changed line moves a robot.

To write them again after such a review: `ZEROREV_WRITE_GOLDEN=1 pytest tests/program/rapid/test_golden.py`.
"""

import os
from dataclasses import replace

import numpy as np
import pytest

from oracles.places import GOLDEN
from zerorev.motion.drilling import Drilling
from zerorev.planning.corner import corner_of
from zerorev.program.export import export

POSITIONS = {1: "position_1", 2: "position_2", 3: "position_3"}


@pytest.fixture(scope="module")
def abb(kuka):
    """The thesis' robot, as if an ABB were built so: its plans are known to the last digit."""
    return replace(kuka, name="stand_in", manufacturer="ABB", model="stand-in")


def with_corners(plan):
    """The plan with how each hole turns round, as planning states it."""
    holes = tuple(
        replace(hole, corner=corner_of(Drilling.of(plan, hole.hole), plan.settings, hole.motion)) for hole in plan.holes
    )
    return replace(plan, holes=holes)


def check(name, exported):
    path = GOLDEN / f"{name}.mod"
    assert exported.files[0].name == path.name
    if os.environ.get("ZEROREV_WRITE_GOLDEN"):
        path.write_bytes(exported.text.encode("ascii"))
    assert path.read_bytes() == exported.text.encode("ascii")


@pytest.mark.parametrize("number", POSITIONS)
def test_published_position(number, abb, published, plan_of):
    plan = plan_of(published(number), name=POSITIONS[number], robot=abb, controller="rapid", spindle_rpm=3000.0)
    check(POSITIONS[number], export(with_corners(plan), version="golden"))


def test_three_positions_on_a_tilted_part_with_a_deeper_corner(abb, published, plan_of):
    T = np.eye(4)
    c, s = np.cos(np.deg2rad(30)), np.sin(np.deg2rad(30))
    T[:3, :3] = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
    T[:3, 3] = 0.4, -0.1, 0.3
    holes = [published(n, corner=-1e-3) for n in POSITIONS]
    plan = plan_of(
        *holes, name="tilted part", robot=abb, T_base_part=T, corner="blend", blend=2e-3, deepen_corner=True,
        lead_in=3e-3, controller="rapid",
    )  # fmt: skip
    check("tilted_part", export(with_corners(plan), name="tilted_part", version="golden"))
