"""Possible arms: drawn from what is known of the arm, and only those near what was measured of its baselines."""

from __future__ import annotations

from dataclasses import replace

import pytest

from zerorev.cell.parameters import drawn
from zerorev.cell.possible import check_robot, conditioned, finished, held_for, possible_arms
from zerorev.cell.reference import Manner
from zerorev.errors import InputError
from zerorev.model.ranges import RANGES, Cell, Conditioning

THESIS = Manner(feed=0.2, corner=10e-3)


@pytest.fixture(scope="module")
def recorded(published_plan):
    deviations = (0.20e-3, 0.14e-3, 0.15e-3)
    return dict(zip([hole.hole.id for hole in published_plan.holes], deviations, strict=True))


def test_conditioning_keeps_what_is_near(published_plan, recorded):
    sets = drawn(20, 3)
    kept = conditioned(published_plan, sets, recorded, THESIS)
    assert 0 < len(kept) < len(sets)
    name = next(iter(recorded))
    with pytest.raises(InputError, match="none of 20 sets"):
        conditioned(published_plan, sets, {name: 5e-3}, THESIS)
    with pytest.raises(InputError, match="no hole 'nowhere'"):
        conditioned(published_plan, sets, {"nowhere": 1e-4}, THESIS)


def test_arms_are_those_that_are_drawn_and_near_what_was_measured(published_plan, recorded):
    """Step by step, so that it can be dropped in between, and the same in steps of any size."""
    ranges = {"gap": replace(RANGES["gap"], low=0.9, high=1.1)}
    free, known = Cell(ranges), Cell(ranges, Conditioning(recorded, 0.2, 10e-3))
    every = finished(possible_arms(published_plan, free, 12, 3))
    stated = ("tool_mass", "tool_lever")  # by the file of the tool
    assert (every.sets, every.drawn, every.measured) == (tuple(drawn(12, 3, free.ranges, held=stated)), 12, None)
    assert all(0.9 <= each["gap"] <= 1.1 for each in every.sets)
    steps = list(possible_arms(published_plan, known, 12, 3, block=5))
    assert len(steps) == 3 * len(recorded)
    arms = finished(possible_arms(published_plan, known, 12, 3, block=5))
    assert arms == finished(possible_arms(published_plan, known, 12, 3))
    assert list(arms.sets) == conditioned(published_plan, every.sets, recorded, THESIS)
    assert (arms.drawn, arms.measured) == (12, 3)
    elsewhere = Cell(ranges, Conditioning({"nowhere": 1e-4}))
    assert finished(possible_arms(published_plan, elsewhere, 12, 3)) == replace(every, measured=0)


def test_what_the_tools_file_states_is_held_until_it_is_fitted(published_plan):
    tool = published_plan.tool
    assert held_for(replace(tool, load=None), Cell()) == ()
    assert held_for(tool, Cell()) == ("tool_mass", "tool_lever")
    fitted = Cell({"tool_mass": replace(RANGES["tool_mass"], basis="fitted")})
    assert held_for(tool, fitted) == ("tool_lever",)
    for cell, varied in ((Cell(), False), (fitted, True)):
        (arm,) = finished(possible_arms(published_plan, cell, 1, 0)).sets
        assert ("tool_mass" in arm.values) is varied


def test_a_cell_file_of_another_robot_is_refused():
    check_robot(Cell(), "any", "cell.yaml")
    check_robot(Cell(robot="this"), "this", "cell.yaml")
    with pytest.raises(InputError, match=r"cell\.yaml: is of the robot that, the plan of this"):
        check_robot(Cell(robot="that"), "this", "cell.yaml")
