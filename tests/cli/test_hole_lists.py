"""Lists of holes as users have them, at the command line: what is read, what is refused, and what is said of it."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from oracles.places import ROOT
from zerorev import cli
from zerorev.cli import main

PRACTICE = ROOT / "tests/data/practice"
JOB = """\
robot: kuka_kr6_r700_2
tool: thesis_drill
part_frame: {xyz_mm: [500, 300, 800]}
proof_boxes: 0
holes: holes.csv
"""


def planned(capsys, job: Path):
    """The plan of a job as data, and what was said beside it."""
    assert main(["plan", str(job), "--proof-boxes", "0", "--json"]) == cli.FINE
    said = capsys.readouterr()
    return json.loads(said.out), said.err


def refused(capsys, job: Path) -> str:
    assert main(["plan", str(job)]) == cli.BAD_INPUT
    said = capsys.readouterr()
    assert said.out == ""
    assert "Traceback" not in said.err
    return said.err


def test_semicolons_and_decimal_commas(capsys):
    plan, _ = planned(capsys, PRACTICE / "c05_csv_semicolon/semi.yaml")
    assert [hole["target_mm"] for hole in plan["holes"]] == [[500.5, 300, 800], [500.5, 320.25, 800]]
    assert [hole["depth_mm"] for hole in plan["holes"]] == [12.5, 12.5]


def test_a_column_more_is_left_out_and_said(capsys):
    plan, said = planned(capsys, PRACTICE / "c07_columns/extra.yaml")
    assert len(plan["holes"]) == 1
    assert "note: extra.csv: column left out, since it is not needed: dia_mm" in said


@pytest.mark.parametrize(
    "command",
    [
        ["plan", "{}", "--proof-boxes", "0"],
        ["depth", "{}", "--proof-boxes", "0"],
        ["place", "{}", "--x-mm=0:1", "--grid", "2"],
        ["share", "{}", "{}"],
        ["rates", "{}"],
        ["offset", "{}", "--offsets-mm", "100"],
    ],
    ids=lambda command: command[0],
)
def test_every_command_says_what_was_left_out(command, capsys):
    job = PRACTICE / "c07_columns/extra.yaml"
    main([part.format(job) for part in command])
    assert "note: extra.csv: column left out, since it is not needed: dia_mm" in capsys.readouterr().err


def test_a_header_in_capitals(capsys):
    plan, _ = planned(capsys, PRACTICE / "c07_columns/hdrcase.yaml")
    assert plan["holes"][0]["id"] == "H1"


def test_aliases_of_a_script(capsys):
    plan, _ = planned(capsys, PRACTICE / "c24_yaml_anchor/anchor.yaml")
    assert [hole["direction"] for hole in plan["holes"]] == [[1, 0, 0], [1, 0, 0]]


def test_thousands_are_refused(tmp_path, capsys):
    rows = (PRACTICE / "c06_thousands/paste.tsv").read_text(encoding="utf-8")
    (tmp_path / "holes.csv").write_text(
        "id,x_mm,y_mm,z_mm,i,j,k,depth_mm\n".replace(",", "\t") + rows, encoding="utf-8"
    )
    (tmp_path / "job.yaml").write_text(JOB)
    assert "line 2: '1,200' and '0.5' (line 2) have two decimal signs" in refused(capsys, tmp_path / "job.yaml")


@pytest.mark.parametrize("keys", ["", "normals: in\n"])
def test_normals_that_point_out_are_turned_where_the_job_says_so(capsys, tmp_path, keys):
    """The panel of the list is then drilled from the robot's side, and no hole reverses."""
    (tmp_path / "holes.csv").write_bytes((PRACTICE / "c08_normals/out.csv").read_bytes())
    (tmp_path / "job.yaml").write_text(JOB + (keys or "normals: out\npoint: entry\n"))
    plan, _ = planned(capsys, tmp_path / "job.yaml")
    into = -1 if keys else 1
    assert [hole["direction"] for hole in plan["holes"]] == [[into, 0, 0]] * 2
    assert plan["holes"][0]["target_mm"] == ([500, 300, 800] if keys else [512, 300, 800])


def test_a_list_from_cad_with_other_names_in_inches_with_entry_points(capsys, tmp_path):
    text = "Report of 3 May\n\nNAME;LOCX;LOCY;LOCZ;WX;WY;WZ;DIA\nF1;0,5;0;0;-1;0;0;4,8\nF2;0;\u22121,25;0;-1;0;0;4,8\n"
    (tmp_path / "holes.csv").write_bytes(text.encode("utf-16"))
    keys = "columns: {id: name, x_mm: LOCX, y_mm: LOCY, z_mm: LOCZ, i: WX, j: WY, k: WZ}\n"
    keys += "unit: in\nnormals: out\npoint: entry\ndepth_mm: 10\nbreakthrough_mm: 2\n"
    (tmp_path / "job.yaml").write_text(JOB + keys)
    plan, said = planned(capsys, tmp_path / "job.yaml")
    assert [hole["target_mm"] for hole in plan["holes"]] == [[524.7, 300, 800], [512, 268.25, 800]]
    assert [hole["depth_mm"] for hole in plan["holes"]] == [12, 12]
    assert "1 line above the header left out" in said
    assert "DIA" in said


def test_all_bad_rows_are_named(capsys, tmp_path):
    rows = [
        "id,x_mm,y_mm,z_mm,i,j,k,depth_mm",
        "A,x,0,0,1,0,0,5",
        "B,1,0,0,1,0,0,5",
        "B,1,0,0,1,0,0,5",
        "C,1,0,0,0,0,0,5",
    ]
    (tmp_path / "holes.csv").write_text("\n".join(rows))
    (tmp_path / "job.yaml").write_text(JOB)
    said = refused(capsys, tmp_path / "job.yaml")
    for line, words in ((2, "'x' is not a finite number"), (4, "'B' is used twice"), (5, "zero vector")):
        assert any(f"line {line}" in each and words in each for each in said.splitlines()), said


@pytest.mark.parametrize("key", ["columns: {x_mm: LOCX}", "unit: in", "decimal: comma"])
def test_keys_for_a_table_go_with_a_table(capsys, tmp_path, key):
    hole = "{id: a, target_mm: [0, 0, 0], direction: [1, 0, 0], depth_mm: 9}"
    (tmp_path / "job.yaml").write_text(JOB.replace("holes.csv", f"[{hole}]") + key)
    assert "goes with a CSV file of holes" in refused(capsys, tmp_path / "job.yaml")


def test_some_holes_of_a_list_as_a_job_of_their_own_are_where_they_were(tmp_path):
    from zerorev.files.io import read_job
    from zerorev.files.moved_job import write_job

    (tmp_path / "holes.csv").write_text("N;X;Y;Z;i;j;k\nF1;0,5;0;0;-1;0;0\nF2;1;2;0;-1;0;0\n")
    keys = "columns: {id: N, x_mm: X, y_mm: Y, z_mm: Z}\nunit: in\nnormals: out\npoint: entry\ndepth_mm: 10\n"
    (tmp_path / "job.yaml").write_text(JOB + keys + "breakthrough_mm: 2\n")
    old = read_job(tmp_path / "job.yaml")
    write_job(tmp_path / "new.yaml", tmp_path / "job.yaml", ids={"F2"})
    (new,) = read_job(tmp_path / "new.yaml").holes
    assert new.target == pytest.approx(old.holes[1].target, abs=1e-15)
    assert (new.depth, list(new.direction)) == (old.holes[1].depth, list(old.holes[1].direction))
    write_job(tmp_path / "moved.yaml", tmp_path / "job.yaml", T_base_part=old.T_base_part)
    assert [list(hole.target) for hole in read_job(tmp_path / "moved.yaml").holes] == [
        list(h.target) for h in old.holes
    ]
