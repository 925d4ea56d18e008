"""A map in the state of a page: what is opened with it, and a cell that becomes a hole."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from oracles.made_map import made_map
from zerorev.errors import InputError
from zerorev.report.scene.map_slice import slice_of
from zerorev.web.job_edits import with_cell
from zerorev.web.state import opened_map

AXES = ([500], [0, 100, 200], [600, 700])


@pytest.fixture
def state(robot, tool):
    """An opened map: its best cell is at (500, 100, 700), and (500, 200, 600) is out of reach."""
    values = iter([10, 20, 30, 90, np.nan, 50])
    return opened_map(
        slice_of(
            made_map(robot, tool, AXES, np.array([[1.0, 0, 0]]), lambda *_: next(values), branch=4, psi_deg=(5, 0, -5))
        )
    )


def test_a_map_opens_with_its_best_cell(state):
    assert [hole.id for hole in state.job.holes] == [state.selected] == ["cell 500 100 700"]
    assert state.hole.depth == pytest.approx(0.09)
    assert state.cells.best == 3


def test_a_map_without_an_answer_opens_all_the_same(robot, tool):
    state = opened_map(slice_of(made_map(robot, tool, AXES, np.array([[1.0, 0, 0]]), lambda *_: np.nan)))
    assert (len(state.job.holes), state.cells.best) == (1, None)


def test_a_cell_is_added_once(state):
    more = with_cell(state, 5)
    assert [hole.id for hole in more.job.holes] == ["cell 500 100 700", "cell 500 200 700"]
    assert more.selected == "cell 500 200 700"
    assert with_cell(more, 5) is more
    back = with_cell(more, 3)
    assert (back.job is more.job, back.selected) == (True, "cell 500 100 700")


def test_a_cell_that_cannot_be_drilled_changes_nothing(state):
    with pytest.raises(InputError, match="out of reach"):
        with_cell(state, 4)
    with pytest.raises(InputError, match="no map"):
        with_cell(replace(state, cells=None), 0)
