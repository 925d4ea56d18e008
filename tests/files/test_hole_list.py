"""Lists of holes: what is read, and what is said of a row that is not good."""

from __future__ import annotations

from contextlib import suppress

import numpy as np
import pytest

from zerorev.errors import InputError
from zerorev.files.hole_list import all_of, in_base_frame, read_hole_list, text_of_list
from zerorev.files.hole_meaning import Meaning
from zerorev.files.io import job_from_dict
from zerorev.files.table_layout import COLUMNS, Given
from zerorev.model._arrays import rotation_rpy, transform

HEADER = ",".join(COLUMNS)
ROW = ("A", "500", "300", "800.5", "1", "0", "0", "40")
CAD = {"id": "NAME", "x_mm": "LOCX", "y_mm": "LOCY", "z_mm": "LOCZ", "i": "WX", "j": "WY", "k": "WZ"}


def read(text, *, header=True, reference="base_y", T=None, columns=None, unit=None, decimal=None, most=20_000,
         taken=(), depth_needed=True, tool=None, **meaning):  # fmt: skip
    given = Given(columns or {}, unit, decimal, header)
    options = {"most": most, "taken": taken, "depth_needed": depth_needed}
    return read_hole_list(text, given, Meaning(**meaning), **options)


def numbers(row):
    assert row.problem is None, row.problem
    return [*row.form.target_mm, *row.form.direction, row.form.depth_mm]


def refused(text, **options):
    with pytest.raises(InputError) as caught:
        all_of(read(text, **options))
    assert caught.value.accepted or "\n" in str(caught.value)
    return str(caught.value)


@pytest.mark.parametrize("header", [True, False])
@pytest.mark.parametrize(
    "text",
    [
        f"{HEADER}\n{','.join(ROW)}",
        f"\ufeff{HEADER}\r\n{','.join(ROW)}\r\n",
        f"\n{HEADER.replace(',', ';').upper()}\n\n{';'.join(ROW)}\n",
        f"sep=;\n{HEADER.replace(',', ';')}\n{';'.join(ROW).replace('.', ',')}",
        f'"SEP=\t"\n{HEADER}\n{",".join(ROW)}'.replace(",", "\t"),
        f"{HEADER}\n" + ",".join(f'"{cell}"' for cell in ROW).replace(".", ","),
        "depth_mm\tid\tz_mm\ty_mm\tx_mm\tk\tj\ti\n40\tA\t800,5\t300\t500\t0\t0\t1",
        f"# of station 7\n//\nPanel 4711;;;\n{HEADER.replace(',', ';')}\n;mm;mm;mm;;;;mm\n# begins\n{';'.join(ROW)}",
        f"# {HEADER}\n{','.join(ROW)}",
        f"{HEADER},,\n{','.join(ROW)},,,,",
        f"{HEADER}\n{','.join(ROW)},",
        f"{HEADER}\n{','.join(ROW)}\n,,,,,,,\n" + ",".join(['""'] * 8),
        f"id,X [mm],Y (mm),z mm,i [-],j,k,depth_mm\n{','.join(ROW)}",
        f'colour;{HEADER.replace(",", ";")};note\nred;{";".join(ROW)};"a;b"',
    ],
)
def test_the_same_hole_however_it_is_written(text, header):
    (row,) = read(text, header=header).rows
    assert row.form.id == "A"
    assert numbers(row) == [500, 300, 800.5, 1, 0, 0, 40]


@pytest.mark.parametrize("text", ["\t".join(ROW), ";".join(ROW).replace(".", ","), ",".join(ROW) + ",,,\n"])
def test_the_header_may_be_missing_where_a_user_sees_the_rows_first(text):
    (row,) = read(text, header=False).rows
    assert numbers(row) == [500, 300, 800.5, 1, 0, 0, 40]
    assert "line 1: no header" in refused(text)


@pytest.mark.parametrize("minus", ["\u2212", "\u2013", "\u2010", "\uff0d"])
def test_any_minus(minus):
    (row,) = read(f"{HEADER}\nA,{minus}5.5,{minus}.5,0,1,0,0,1e1").rows
    assert numbers(row) == [-5.5, -0.5, 0, 1, 0, 0, 10]


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-32"])
def test_encodings(encoding):
    text = f"{HEADER}\nÄ-7,500,300,800.5,1,0,0,40\n"
    (row,) = read(text_of_list(text.encode(encoding))).rows
    assert row.form.id == "Ä-7"


@pytest.mark.parametrize("content", [f"{HEADER}\nÄ".encode("latin-1"), HEADER.encode("utf-16") + b"\x00"])
def test_bytes_that_are_not_text(content):
    with pytest.raises(InputError, match=r"is not text \(byte \d+ is not UTF"):
        text_of_list(content)


# --- what CAD calls it ------------------------------------------------------------------------------------------------


def test_columns_by_other_names_in_inches():
    text = "NAME;KFLAG;LOCX;LOCY;LOCZ;WX;WY;WZ;DIA\nA;1;1,5;-2;0;1;0;0;0,25\n"
    listed = read(text, columns=CAD, unit="in", depth_mm=12.0)
    assert numbers(listed.rows[0]) == pytest.approx([38.1, -50.8, 0, 1, 0, 0, 12])
    assert listed.notes == ("columns left out, since they are not needed: KFLAG, DIA",)


def test_a_depth_of_its_own_comes_before_that_of_the_job():
    rows = read(f"{HEADER}\nA,0,0,0,1,0,0,\nB,0,0,0,1,0,0,7\n", depth_mm=12.0).rows
    assert [row.form.depth_mm for row in rows] == [12, 7]


def test_a_column_of_branches():
    rows = read(f"{HEADER},branch\nA,0,0,0,1,0,0,5,4\nB,0,0,0,1,0,0,5,\n").rows
    assert [row.form.branch for row in rows] == [4, None]
    assert "8 is too large" in refused(f"{HEADER},branch\nA,0,0,0,1,0,0,5,8\n")


def test_a_row_of_units_is_the_units_of_its_columns():
    text = "id;X;Y;Z;i;j;k;depth\n;in;in;in;;;;[m]\nA;1;2;3;1;0;0;0,01"
    columns = {"x_mm": "x", "y_mm": "y", "z_mm": "z", "depth_mm": "depth"}
    assert numbers(read(text, columns=columns).rows[0]) == pytest.approx([25.4, 50.8, 76.2, 1, 0, 0, 10])
    for row in ("cm;cm;cm", "in;cm;in", "in;;in", "in;2;in", "iqn;iqn;iqn"):
        assert "line 2: '" in (said := refused(text.replace("in;in;in", row), columns=columns))
        assert "is neither a number nor a unit" in said
    assert "the row of units says in, the job says m" in refused(text, columns=columns, unit="m")
    assert "its name says mm, the row of units says in" in refused(text.replace("X;Y;Z", "x_mm;y_mm;z_mm"),
                                                                columns={"depth_mm": "depth"})  # fmt: skip


def test_names_in_mm_are_in_mm():
    assert "say mm, and the job says unit: in" in refused(f"{HEADER}\n{','.join(ROW)}", unit="in")
    text = "id,LOCX [in],LOCY [in],LOCZ [in],i,j,k,depth_mm\nA,1,0,0,1,0,0,9"
    columns = {"x_mm": "LOCX [in]", "y_mm": "locy [IN]", "z_mm": "LOCZ [in]"}
    for unit in (None, "in"):
        assert numbers(read(text, columns=columns, unit=unit).rows[0]) == pytest.approx([25.4, 0, 0, 1, 0, 0, 9])


def test_entry_and_exit_points():
    names = [f"{end}_{axis}_mm" for end in ("entry", "exit") for axis in "xyz"]
    listed = read(f"id,{','.join(names)},depth_mm\nA,0,0,0,3,0,4,99\n", normals="out", depth_mm=50)
    assert numbers(listed.rows[0]) == [3, 0, 4, 3, 0, 4, 5]
    assert "depth_mm" in listed.notes[0]
    listed = read(f"id,{','.join(names)}\nA,0,0,0,3,0,4\n", breakthrough_mm=5)
    assert numbers(listed.rows[0]) == [6, 0, 8, 3, 0, 4, 10]
    (row,) = read(f"id,{','.join(names[:3])},i,j,k,depth_mm\nA,1,0,0,0,0,-1,9\n").rows
    assert numbers(row) == [1, 0, -9, 0, 0, -1, 9]
    assert "no column exit_z_mm" in refused(f"id,{','.join(names[:-1])}\nA,0,0,0,3,0")
    assert "both x_mm and entry_x_mm" in refused(f"{HEADER},{','.join(names[:3])}\nA,0,0,0,1,0,0,9,0,0,0")
    assert "depth_mm: 0.0 is too small" in refused(f"id,{','.join(names)}\nA,1,1,1,1,1,1\n")


def in_base(listed):
    from zerorev.files.io import read_tool

    return in_base_frame(listed, "base_y", read_tool("thesis_drill"), np.eye(4))


@pytest.mark.parametrize(
    ("meaning", "expected"),
    [
        ({}, [1, 2, 3, 0, 0, -2, 10]),
        ({"normals": "out"}, [1, 2, 3, 0, 0, 2, 10]),
        ({"point": "entry"}, [1, 2, -7, 0, 0, -2, 10]),
        ({"point": "entry", "normals": "out"}, [1, 2, 13, 0, 0, 2, 10]),
        ({"point": "entry", "breakthrough_mm": 2}, [1, 2, -9, 0, 0, -2, 12]),
        ({"breakthrough_mm": 2}, [1, 2, 1, 0, 0, -2, 12]),
    ],
)
def test_what_points_and_directions_mean(meaning, expected):
    (row,) = read(f"{HEADER}\nA,1,2,3,0,0,-2,10", **meaning).rows
    assert numbers(row) == expected
    frame = {"robot": "kuka_kr6_r700_2", "tool": "thesis_drill", "psi_reference": "part_x"}
    hole = {"id": "A", "target_mm": [1, 2, 3], "direction": [0, 0, -2], "depth_mm": 10}
    (listed,) = job_from_dict(frame | meaning | {"holes": [hole]}).holes
    np.testing.assert_allclose(listed.target * 1e3, expected[:3], atol=1e-12)
    np.testing.assert_allclose(listed.direction, np.array(expected[3:6]) / 2, atol=1e-15)
    assert listed.depth * 1e3 == pytest.approx(expected[6])


# --- numbers that may be two things -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("cells", "said"),
    [
        (("1,200", "0.5"), "'1,200' and '0.5' (line 2) have two decimal signs"),
        (("1.200", "0,5"), "have two decimal signs"),
        (("1,200", "7"), "'1,200' may be 1.200 or 1200"),
        (("-1,250", "1,000"), "'-1,250' may be -1.250 or -1250"),
        (("1.200", "300"), "'1.200' may be 1.200 or 1200"),
        (("1,200.5", "0"), "'1,200.5' has a separator of thousands"),
        (("1.200,5", "0"), "'1.200,5' has a separator of thousands"),
        (("1 200", "0"), "'1 200' has a separator of thousands"),
        (("1\u00a0200", "0"), "has a separator of thousands"),
        (("1\u202f200,5", "0,5"), "has a separator of thousands"),
        (("1'200", "0"), "has a separator of thousands"),
        (("1,200,300", "0"), "has a separator of thousands"),
    ],
)
@pytest.mark.parametrize("delimiter", ["\t", ";", ","])
def test_thousands_are_never_decimals(cells, said, delimiter):
    if delimiter == "," and cells == ("1.200", "300"):
        return  # who separates cells by commas writes a decimal point
    quoted = [f'"{cell}"' if delimiter == "," else cell for cell in cells]
    text = delimiter.join(COLUMNS) + "\n" + delimiter.join(("H1", *quoted, "0", "1", "0", "0", "12"))
    message = refused(text)
    assert said in message
    assert "line 2" in message


@pytest.mark.parametrize(("decimal", "x"), [("comma", 1.2), ("point", None)])
def test_who_knows_the_decimal_sign_can_say_so(decimal, x):
    text = f"{HEADER}\nH1,1,200,0,0,1,0,0,12".replace(",", ";").replace("1;200", "1,200")
    if x is None:
        assert "'1,200' has a separator of thousands" in refused(text, decimal=decimal)
    else:
        assert numbers(read(text, decimal=decimal).rows[0])[0] == x


def test_three_digits_behind_each_sign_are_decimals_where_one_number_shows_it():
    (row,) = read(f"{HEADER}\nH1,1,200,300,000,0,000,1,000,0,000,0,000,12,500".replace(",", ";")
                  .replace(";200", ",200").replace(";000", ",000").replace(";500", ",500")).rows  # fmt: skip
    assert numbers(row) == [1.2, 300, 0, 1, 0, 0, 12.5]


# --- rows that are not good -------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("cells", "said"),
    [
        ("B\tx\t0\t0\t1\t0\t0\t5", "line 2, column x_mm: 'x' is not a finite number"),
        ("B\t\t0\t0\t1\t0\t0\t5", "column x_mm: '' is not a finite number"),
        ("B\t1e999\t0\t0\t1\t0\t0\t5", "column x_mm: '1e999' is not a finite number"),
        ("B\t1_0\t0\t0\t1\t0\t0\t5", "column x_mm: '1_0' is not a finite number"),
        ("B\t1\t0\t0\t0\t0\t0\t5", "the zero vector has no direction"),
        ("B\t1\t0\t0\t0\t1\t0\t5", "parallel to the drill axis"),
        ("B\t1\t0\t0\t1\t0\t0\t0", "depth_mm: 0.0 is too small"),
        ("\t1\t0\t0\t1\t0\t0\t5", "id:"),
        ("A\t1\t0\t0\t1\t0\t0\t5", "'A' is used twice"),
        ("T\t1\t0\t0\t1\t0\t0\t5", "'T' is used twice"),
        ("B\t1\t0\t0\t1\t0\t0", "7 cells"),
        ("B\t1\t0\t0\t1\t0\t0\t5\t6", "9 cells"),
        ('B\t"1\t0\t0\t1\t0\t0\t5', "unexpected end of data"),
        ("#B\t1\t0\t0\t1\t0\t0\t5", "begins like a comment and reads like a hole"),
    ],
)
def test_a_bad_row_says_what_where_and_what_is_accepted_and_spoils_no_other(cells, said):
    text = "\n".join(["\t".join(ROW), cells, "C\t1\t0\t0\t1\t0\t0\t5"])
    first, bad, last = in_base(read(text, header=False, taken={"T"})).rows
    assert (first.hole.id, last.hole.id) == ("A", "C")
    assert (bad.line, bad.hole, bad.form) == (2, None, None)
    assert said in str(bad.problem)
    assert str(bad.problem).startswith("line 2")
    assert bad.problem.accepted


def test_all_bad_rows_are_named_up_to_a_number():
    rows = [f"h{n},{'x' if n % 2 else n},0,0,1,0,0,5" for n in range(60)]
    message = refused("\n".join([HEADER, *rows]))
    assert message.startswith("30 of 60 rows cannot be read\n  - line 3, column x_mm: 'x' is not a finite number")
    assert message.count("\n") == 21
    assert message.endswith("... and 10 more")


def test_an_empty_cell_behind_the_row_may_be_a_cell_too_many_within():
    """A decimal comma in a table of commas moves the cells behind it: the last column must show that there is none."""
    text = f"{HEADER},note\nH1,0,5,1,0,1,2,1,12,"
    assert "line 2: 10 cells (accepted: 9 cells; a decimal comma needs another separator" in refused(text)
    assert numbers(read(f"{HEADER},note\nH1,5,1,0,1,2,1,12,").rows[0]) == [5, 1, 0, 1, 2, 1, 12]


def test_an_id_keeps_its_comma_and_its_hash():
    rows = read('1,5\t500\t300\t800\t1\t0\t0\t40\n"#2"\t500\t300\t800\t1\t0\t0\t40', header=False).rows
    assert [row.form.id for row in rows] == ["1,5", "#2"]


def test_a_row_is_the_hole_that_a_job_has_of_it(tool):
    frame = {"xyz_mm": [400, 20, 700], "rpy_deg": [3, -8, 30]}
    hole = {"id": "A", "target_mm": [1, 2, 3], "direction": [0.2, 0.9, -0.1], "depth_mm": 40}
    job = job_from_dict(
        {"robot": "kuka_kr6_r700_2", "tool": "thesis_drill", "part_frame": frame, "psi_reference": "part_x",
         "holes": [hole]}
    )  # fmt: skip
    T = transform(rotation_rpy(*np.deg2rad(frame["rpy_deg"])), np.array(frame["xyz_mm"]) / 1e3)
    (row,) = in_base_frame(read("A;1;2;3;0,2;0,9;-0,1;40", header=False), "part_x", tool, T).rows
    for name in ("target", "direction", "psi_zero"):
        np.testing.assert_array_equal(getattr(row.hole, name), getattr(job.holes[0], name))


@pytest.mark.parametrize(
    ("text", "said", "options"),
    [
        ("", "no column id", {}),
        (HEADER, "no holes", {}),
        ("name;x;y\nA;1;2", "no column id, x_mm", {}),
        ("id,x_mm,colour\nA,1,red", "no column y_mm, z_mm, i, j, k, depth_mm; there is 'colour'", {}),
        (f"{HEADER},id\n{','.join(ROW)},A", "a column appears twice: id", {}),
        ("\n".join([",".join(ROW)] * 21), "21 rows (accepted: 20 at most)", {"header": False, "most": 20}),
        (f"sep=|\n{HEADER}", "line 1: cells separated by '|'", {}),
        (f"{HEADER}\n{','.join(ROW)}".replace(",", "|"), "no column id", {}),
        (f"{','.join(ROW)}\n{HEADER}\n{','.join(ROW)}", "no header", {}),
        (f"{','.join(ROW)}\n{HEADER}\n{','.join(ROW)}", "line 2: a header below the first row", {"header": False}),
        (f"{HEADER}\n{','.join(ROW)}", "no column 'LOCX' (x_mm)", {"columns": {"x_mm": "LOCX"}}),
        (f"{HEADER}\n{','.join(ROW)}", "'X' stands for x_mm and y_mm", {"columns": {"x_mm": "x", "y_mm": "X"}}),
        ("id,x_mm,y_mm,z_mm,i,j,k,depht_mm\nA,1,2,3,1,0,0,5", "did you mean 'depth_mm'", {"depth_mm": 3.0}),
        ("id,x_mm,y_mm,z_mm,i,j,k\nA,1,2,3,1,0,0", "depth_mm (hole A): is missing", {"depth_needed": False,
                                                                                    "point": "entry"}),
        (f"{HEADER}\nA,1,2,3,1,0,0,\x00", "line 2: holds a control character", {}),
    ],
)  # fmt: skip
def test_a_table_that_is_none(text, said, options):
    assert said in refused(text, **options)


def test_any_text_is_rows_or_one_clear_error():
    rng = np.random.default_rng(4)
    letters = list("A1.,;\t\n\"' -eE_x\x00é#%")
    for n in range(400):
        text = "".join(rng.choice(letters, size=rng.integers(0, 60)))
        with suppress(InputError):
            rows = read(text, header=n % 2 == 0).rows
            assert all((row.form is None) != (row.problem is None) for row in rows)
