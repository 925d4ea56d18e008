"""Measured holes: what a table says, in any order and with decimal commas, and what is wrong with one."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

from zerorev.cell.recordings.holes import read_holes
from zerorev.cli import main
from zerorev.errors import InputError

TABLE = """hole,depth_mm,diameter_mm,x_mm,y_mm,roundness_mm,operator
A1,1,6.01,0.03,0.04,0.010,Jürgen
A1,21,6.03,0.05,0.12,0.012,Jürgen
A1,11,6.02,0.04,0.08,0.011,Jürgen
B/2,0,5.99,,,,
B/2,10,6.00,,,,
"""


def written(folder, text, encoding="utf-8"):
    (folder / "holes.csv").write_bytes(text.encode(encoding))
    return folder / "holes.csv"


@pytest.mark.parametrize("encoding", ["utf-8", "cp1252"])
@pytest.mark.parametrize("comma", [False, True])
def test_a_table(tmp_path, encoding, comma):
    text = TABLE.replace(",", ";").replace(".", ",") if comma else TABLE
    (first, second), unused = read_holes(written(tmp_path, text, encoding))
    assert unused == ("operator",)
    assert (first.id, second.id) == ("A1", "B/2")
    assert first.depth.tolist() == pytest.approx([1e-3, 11e-3, 21e-3])
    assert first.diameter.tolist() == pytest.approx([6.01e-3, 6.02e-3, 6.03e-3])
    assert first.position_error == pytest.approx(0.13e-3)
    # 0.01 to the side and 0.04 up per 10 mm, exactly on a line
    assert first.tilt == pytest.approx(math.atan(math.hypot(0.001, 0.004)))
    assert first.roundness.max() == pytest.approx(0.012e-3)
    assert second.centre is None
    assert second.position_error is None
    assert second.tilt is None


def test_tilt_is_that_of_a_least_squares_line(tmp_path):
    chance = np.random.default_rng(3)
    depth, x, y = np.sort(chance.uniform(0, 30, 12)), chance.normal(0, 0.1, 12), chance.normal(0, 0.1, 12)
    rows = [f"h,{a!r},{b!r},{c!r}" for a, b, c in zip(depth.tolist(), x.tolist(), y.tolist(), strict=True)]
    ((hole,), _) = read_holes(written(tmp_path, "\n".join(["hole,depth_mm,x_mm,y_mm", *rows])))
    slopes = [np.polyfit(depth, values, 1)[0] for values in (x, y)]
    assert hole.tilt == pytest.approx(math.atan(math.hypot(*slopes)))
    assert hole.position_error == pytest.approx(np.hypot(x, y).max() * 1e-3)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (lambda text: text.replace("hole,", "bore,"), "line 1: no column hole"),
        (lambda text: text.replace("depth_mm", "z"), "line 1: no column depth_mm"),
        (lambda text: text.replace("y_mm", "x_mm"), "line 1: the column x_mm is there twice"),
        (lambda text: text.replace("0.12", "nan"), "line 3, column y_mm: 'nan' is not a finite number"),
        (lambda text: text.replace("A1,21", ",21"), "line 3: no hole"),
        (lambda text: text.replace("A1,21", "A1"), "line 3: 6 cells"),
        (lambda text: text.replace("A1,21", "A1,11"), "lines 2 to 4, hole A1: depths that do not rise"),
        (lambda text: text.replace("A1,1,", "A1,-1,"), "depths that do not rise from 0"),
        (lambda text: text.replace("6.03", "-6"), "a diameter of 0 or less"),
        (lambda text: text.replace("0.012", "-0.1"), "a negative roundness"),
        (lambda text: text.replace("0.05", ""), "hole A1: x_mm is empty in 1 of 3 rows"),
        (lambda text: text.replace("y_mm", "v"), "x_mm or y_mm without the other"),
        (lambda text: text.replace("5.99", "").replace("6.00", ""), "nothing measured but depths"),
        (lambda text: text.splitlines()[0], "no rows"),
        (lambda text: "", "no column hole, depth_mm"),
        (lambda text: text.replace("A1", "A\x00"), "holds a control character"),
    ],
)
def test_a_table_that_is_wrong_is_one_message(tmp_path, change, says):
    with pytest.raises(InputError) as refused:
        read_holes(written(tmp_path, change(TABLE)))
    assert says in str(refused.value)
    assert "holes.csv" in str(refused.value)


def test_the_command(tmp_path, capsys):
    path = written(tmp_path, TABLE)
    assert main(["recordings", "holes", str(path)]) == 0
    said = capsys.readouterr()
    assert "6.010 to 6.030" in said.out
    assert "not used: operator" in said.err
    assert main(["recordings", "holes", str(path), "--json"]) == 0
    first, second = json.loads(capsys.readouterr().out)["holes"]
    assert first["position_error_mm"] == pytest.approx(0.13)
    assert first["tilt_deg"] == pytest.approx(math.degrees(math.atan(math.hypot(0.001, 0.004))))
    assert first["diameter_mm"] == {"least": 6.01, "greatest": 6.03}
    assert second["position_error_mm"] is None
