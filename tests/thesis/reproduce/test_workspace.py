"""Table 5 as printed, and what the section says of it."""

from __future__ import annotations

import numpy as np
import pytest

from zerorev.motion.drilling import Drilling
from zerorev.motion.evaluation import evaluate
from zerorev.search.exact import search
from zerorev.thesis.reproduce import Context, workspace
from zerorev.thesis.reproduce.published import TABLE_5, TABLE_5_Y_MM, TABLE_5_Z_MM, hole_along_x

CONTEXT = Context(seeds=2, map_size=6)


def test_table_5_is_the_printed_one():
    table = np.array(TABLE_5)
    assert table.shape == (len(TABLE_5_Z_MM), len(TABLE_5_Y_MM)) == (9, 9)
    assert (table % 5 == 0).all()  # steps of 5 mm
    at = {(y, z): table[i, j] for i, z in enumerate(TABLE_5_Z_MM) for j, y in enumerate(TABLE_5_Y_MM)}
    # as they stand in the text, and the sums of rows and columns of the printed page
    assert (at[300, 800], at[-300, 800], at[300, 900], at[0, 1100], at[-400, 400]) == (90, 100, 120, 15, 40)
    assert table.sum(axis=1).tolist() == [0, 15, 395, 745, 800, 860, 365, 230, 280]
    assert table.sum(axis=0).tolist() == [400, 480, 425, 355, 295, 370, 460, 485, 420]
    field = workspace.printed()
    assert field.value.shape == (81, 1)
    for place, value in zip(field.target, field.value[:, 0], strict=True):
        assert np.nan_to_num(value) == at[place[1], place[2]]


def test_plane_of_table_5_is_its_own_mirror_and_cells_are_drilled_as_said(robot, tool):
    """Six cells and their mirrors; the motion of each is evaluated, and none is much deeper by another search."""
    target = np.array([(500.0, side * y, z) for y, z in ((300, 900), (200, 500), (400, 400)) for side in (1, -1)])
    depth = workspace._deepest(CONTEXT, target).value[:, 0]
    np.testing.assert_allclose(depth[0::2], depth[1::2], atol=0.05)
    for place, found in zip(target, depth, strict=True):
        hole = hole_along_x("cell", tuple(place), found * 0.99)
        motion = search(Drilling(robot, tool, hole), CONTEXT.thesis)
        assert evaluate(robot, tool, hole, motion.profile, motion.branch).score.reversals == 0
        beyond = search(Drilling(robot, tool, hole_along_x("cell", tuple(place), found * 1.02)), CONTEXT.thesis)
        assert beyond is None or beyond.reversals > 0


def test_spin_has_no_lever_on_axis_1_where_the_wrist_is_beside_it(robot, tool):
    assert workspace._lever_of_axis_1(CONTEXT, 100.0) < 1e-12
    assert workspace._lever_of_axis_1(CONTEXT, 101.0) > 1e-4
    target = np.array([(100.0, 300.0, 800.0), (100.0, 400.0, 600.0)])
    assert np.isnan(workspace._deepest(CONTEXT, target).value).all()
    # by hand: the wrist centre lies 100 mm behind the tip, at any spin
    wrist = tool.T_flange_tcp[:3, :3].T @ (np.array([0, 0, -robot.arm.c4]) - tool.T_flange_tcp[:3, 3])
    assert wrist[2] * 1e3 == pytest.approx(100.0)


@pytest.mark.long
def test_the_whole_section():
    section = workspace.make(CONTEXT)
    (table,) = section.tables
    assert len(table.rows) == 81
    names = {picture.name for picture in section.pictures}
    assert names == {"table_5", "fig_20", "fig_21", "fig_22_23", "fig_24", "fig_25"}
    gain = np.array([row[-1] for row in table.rows])
    assert np.median(gain) > 5
    periodic, bounded = (np.array([row[k] for row in table.rows]) for k in (5, 4))
    assert (periodic >= bounded - 0.05).all()
    assert section.results[4].exact.startswith("0 of 153")
