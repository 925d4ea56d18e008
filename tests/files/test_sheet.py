"""Holes out of a spreadsheet: what is read, and what is said of a row that is not good."""

from __future__ import annotations

from contextlib import suppress

import numpy as np
import pytest

from zerorev.errors import InputError
from zerorev.files.io import job_from_dict
from zerorev.files.sheet import COLUMNS, MAX_ROWS, sheet_rows
from zerorev.model._arrays import rotation_rpy, transform

HEADER = ",".join(COLUMNS)
ROW = ("A", "500", "300", "800.5", "1", "0", "0", "40")


def read(text, tool, **options):
    return sheet_rows(text, "base_y", tool, np.eye(4), **options)


@pytest.mark.parametrize(
    "text",
    [
        "\t".join(ROW),
        ";".join(ROW),
        ",".join(ROW),
        ";".join(ROW).replace(".", ","),
        "\t".join(ROW).replace(".", ",") + "\t\t\n",
        f"{HEADER}\n{','.join(ROW)}",
        f"\n{HEADER.replace(',', ';').upper()}\n\n{';'.join(ROW)}\n",
        "depth_mm\tid\tz_mm\ty_mm\tx_mm\tk\tj\ti\n40\tA\t800,5\t300\t500\t0\t0\t1",
    ],
)
def test_the_same_hole_however_it_is_written(text, tool):
    (row,) = read(text, tool)
    assert row.problem is None
    assert row.hole.id == "A"
    np.testing.assert_allclose(row.hole.target, [0.5, 0.3, 0.8005])
    np.testing.assert_allclose(row.hole.direction, [1, 0, 0])
    assert row.hole.depth == pytest.approx(0.04)


def test_a_row_is_the_hole_that_a_job_has_of_it(tool):
    frame = {"xyz_mm": [400, 20, 700], "rpy_deg": [3, -8, 30]}
    hole = {"id": "A", "target_mm": [1, 2, 3], "direction": [0.2, 0.9, -0.1], "depth_mm": 40}
    job = job_from_dict(
        {"robot": "kuka_kr6_r700_2", "tool": "thesis_drill", "part_frame": frame, "psi_reference": "part_x",
         "holes": [hole]}
    )  # fmt: skip
    T = transform(rotation_rpy(*np.deg2rad(frame["rpy_deg"])), np.array(frame["xyz_mm"]) / 1e3)
    (row,) = sheet_rows("A;1;2;3;0,2;0,9;-0,1;40", "part_x", tool, T)
    for name in ("target", "direction", "psi_zero"):
        np.testing.assert_allclose(getattr(row.hole, name), getattr(job.holes[0], name), atol=1e-15)


@pytest.mark.parametrize(
    ("cells", "said"),
    [
        ("B\tx\t0\t0\t1\t0\t0\t5", "column x_mm: 'x' is not a finite number"),
        ("B\t\t0\t0\t1\t0\t0\t5", "column x_mm: '' is not a finite number"),
        ("B\t1.000,5\t0\t0\t1\t0\t0\t5", "'1.000,5' is not a finite number"),
        ("B\t1\t0\t0\t0\t0\t0\t5", "the zero vector has no direction"),
        ("B\t1\t0\t0\t0\t1\t0\t5", "parallel to the drill axis"),
        ("B\t1\t0\t0\t1\t0\t0\t0", "depth_mm: 0.0 is too small"),
        ("\t1\t0\t0\t1\t0\t0\t5", "id:"),
        ("A\t1\t0\t0\t1\t0\t0\t5", "'A' is used already"),
        ("T\t1\t0\t0\t1\t0\t0\t5", "'T' is used already"),
        ("B\t1\t0\t0\t1\t0\t0", "7 cells"),
    ],
)
def test_a_bad_row_says_what_where_and_what_is_accepted_and_spoils_no_other(cells, said, tool):
    text = "\n".join(["\t".join(ROW), cells, "C\t1\t0\t0\t1\t0\t0\t5"])
    first, bad, last = read(text, tool, taken={"T"})
    assert (first.hole.id, last.hole.id) == ("A", "C")
    assert (bad.line, bad.hole) == (2, None)
    assert said in str(bad.problem)
    assert bad.problem.accepted


def test_an_id_keeps_its_comma(tool):
    (row,) = read("1,5\t500\t300\t800\t1\t0\t0\t40", tool)
    assert row.hole.id == "1,5"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "no rows"),
        (HEADER, "no rows"),
        ("name;x;y\nA;1;2", "unknown column 'name', 'x', 'y'"),
        ("id,x_mm\nA,1", "no column y_mm"),
        (f"{HEADER},id\n{','.join(ROW)},A", "appears twice"),
        ("\n".join([",".join(ROW)] * (MAX_ROWS + 1)), "20,000 at most"),
    ],
)
def test_a_table_that_is_none(text, said, tool):
    with pytest.raises(InputError, match=said):
        read(text, tool)


def test_any_pasted_text_is_rows_or_one_clear_error(tool):
    rng = np.random.default_rng(4)
    letters = list("A1.,;\t\n\"' -eE_x\x00é")
    for _ in range(300):
        text = "".join(rng.choice(letters, size=rng.integers(0, 60)))
        with suppress(InputError):
            rows = read(text, tool)
            assert all((row.hole is None) != (row.problem is None) for row in rows)
