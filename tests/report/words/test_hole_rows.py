"""The table of the holes: what stands in a row, and which rows are wanted."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from zerorev.errors import InputError
from zerorev.files.conversion import hole_from
from zerorev.files.schema import HoleForm
from zerorev.model._arrays import rotation_rpy, transform
from zerorev.model.finding import Finding
from zerorev.report.words.hole_rows import QUICK, HoleRow, hole_row, matching, part_data, standing

ROWS = (
    HoleRow("A1", "", "", 40.0, "zero", 6, 0, 90.0, 12.0),
    HoleRow("A2", "", "", 20.0, "reversals", 6, 2, 50.0, -3.0, 2),
    HoleRow("B1", "", "", 20.0, "infeasible", findings=1),
    HoleRow("b12", "", "", 60.0, "unplanned"),
)


@pytest.mark.parametrize(
    ("wanted", "quick", "ids"),
    [
        ("", "all", "A1 A2 B1 b12"),
        ("b1", "all", "B1 b12"),
        ("A reversals>0", "all", "A2"),
        ("reversals=0", "all", "A1"),
        ("margin<0", "all", "A2"),
        ("depth>=40 travel<100", "all", "A1"),
        ("before<=6", "all", "A1 A2"),
        ("findings>1,5", "all", "A2"),
        ("", "with reversals", "A2"),
        ("", "infeasible", "B1"),
        ("", "not planned", "b12"),
        ("A", "with findings", "A2"),
        ("nothing", "all", ""),
    ],
)
def test_rows_that_are_wanted(wanted, quick, ids):
    assert [row.id for row in ROWS if matching(wanted, quick)(row)] == ids.split()


@pytest.mark.parametrize("wanted", ["foo>1", "reversals>", "depth=deep", "A depth>x"])
def test_a_condition_that_is_none(wanted):
    with pytest.raises(InputError) as caught:
        matching(wanted, next(iter(QUICK)))
    assert "reversals" in caught.value.accepted


def test_a_row_says_what_its_answer_says(published):
    plan, T = published, np.eye(4)
    for answer in plan.holes[:3]:
        row = hole_row(answer.hole, replace(answer, deepest=answer.hole.depth + 0.01), T)
        assert (row.id, row.standing, row.after) == (answer.hole.id, "zero", 0)
        assert row.before == answer.baseline.reversals
        assert row.travel == pytest.approx(np.rad2deg(answer.score.travel))
        assert row.margin == pytest.approx(10)
        assert row.depth == pytest.approx(answer.hole.depth * 1e3)
    lost = hole_row(plan.holes[3].hole, plan.holes[3], T)
    assert (lost.standing, lost.after, lost.travel, lost.margin) == ("infeasible", None, None, None)
    assert hole_row(plan.holes[0].hole, None, T).standing == "unplanned"


def test_warnings_and_errors_are_counted_and_an_error_is_a_failure(published):
    answer = published.holes[0]
    found = [Finding(level, "x", "y", answer.hole.id) for level in ("info", "warning", "error")]
    row = hole_row(answer.hole, replace(answer, findings=tuple(found)), np.eye(4))
    assert (row.findings, row.standing) == (2, "failed")
    assert standing(replace(answer, findings=(found[1],))) == "zero"


def test_part_data_is_what_a_job_would_say_of_the_hole(tool):
    T = transform(rotation_rpy(0.1, -0.4, 2.0), np.array([0.3, -0.2, 0.9]))
    form = HoleForm(id="A", target_mm=[12.5, -3.0, 7.0], direction=[0.6, 0.0, -0.8], depth_mm=33.0)
    target, direction, depth = part_data(hole_from(form, "base_y", tool, T), T)
    assert (target, direction, depth) == (form.target_mm, form.direction, form.depth_mm)
