"""From a job to a TP program and its certificate, by the command line."""

import json
import re

import pytest
import yaml

from oracles.places import ROOT
from zerorev import cli
from zerorev.cli import main
from zerorev.program.tp.read import read_tp

JOB = {
    "robot": "fanuc_lrmate200id",
    "tool": "thesis_drill",
    "tool_number": 3,
    "base_number": 2,
    "limit_margin_deg": 0.1,
    "proof_boxes": 0,
    "holes": [{"id": "first", "target_mm": [425, 285, 431], "direction": [1, 0, 0], "depth_mm": 30}],
}


@pytest.fixture(scope="module")
def planned(tmp_path_factory):
    folder = tmp_path_factory.mktemp("tp")
    (folder / "wing.yaml").write_text(json.dumps(JOB))
    assert main(["plan", str(folder / "wing.yaml"), "-o", str(folder / "wing.json"), "--json"]) == cli.FINE
    return folder / "wing.json"


def test_exported_read_back_and_certified(planned, capsys):
    program = planned.with_name("WING.ls")
    assert main(["export", str(planned), "--controller", "tp"]) == cli.FINE
    assert "program WING written to" in capsys.readouterr().out
    assert read_tp(program.read_text()).name == "WING"
    assert main(["check", "--certify", str(planned), "--program", str(program)]) == cli.FINE
    out = " ".join(capsys.readouterr().out.split())
    assert "yes, certified" in out
    assert "the program has the tool and the part frame by number alone" in out
    assert main(["check", "--certify", str(planned), "--program", str(program), "--json"]) == cli.FINE
    answer = json.loads(capsys.readouterr().out)
    assert [hole["certificate"]["verdict"] for hole in answer["holes"]] == ["certified"]
    assert [said[:50] for said in answer["not_examined"]] == ["the program has the tool and the part frame by num"]


def test_the_makers_language_without_being_asked(planned, tmp_path):
    assert main(["export", str(planned), "-o", str(tmp_path / "A.ls")]) == cli.FINE
    assert (tmp_path / "A.ls").read_text().startswith("/PROG  A\n/ATTR\n")


def test_an_edit_by_hand_is_refuted(planned, tmp_path, capsys):
    program = tmp_path / "WING.ls"
    assert main(["export", str(planned), "-o", str(program)]) == cli.FINE
    text = program.read_text()
    program.write_text(text.replace("UF : 2, UT : 3", "UF : 2, UT : 4", 1))
    assert main(["check", "--certify", str(planned), "--program", str(program)]) == cli.BAD_INPUT
    assert "P[1] is in other frames than the program selects" in capsys.readouterr().err
    program.write_text(text.replace("5mm/sec", "6mm/sec"))
    assert main(["check", "--certify", str(planned), "--program", str(program)]) == cli.FOUND
    assert "yes, refuted" in capsys.readouterr().out


def test_no_program_without_the_number_of_the_tool(planned, tmp_path, capsys):
    job, plan = tmp_path / "job.yaml", tmp_path / "plan.json"
    job.write_text(json.dumps({key: value for key, value in JOB.items() if key != "tool_number"}))
    assert main(["plan", str(job), "-o", str(plan), "--json"]) == cli.FINE
    assert main(["export", str(plan)]) == cli.FOUND
    assert "set tool_number in the job" in capsys.readouterr().err
    assert not list(tmp_path.glob("*.ls"))


def test_the_page_shows_what_is_written(planned, tmp_path):
    page = (ROOT / "docs/howto/controller_tp.md").read_text()
    (job,), (listing,) = (re.findall(rf"```{begin}.*?)```", page, re.DOTALL) for begin in (r"yaml\n(", r"\n(/PROG"))
    assert yaml.safe_load(job) | {"proof_boxes": 0} == JOB | {"controller": "tp"}
    assert main(["export", str(planned), "-o", str(tmp_path / "WING.ls")]) == cli.FINE
    written = {" ".join(line.split()) for line in (tmp_path / "WING.ls").read_text().splitlines()}
    shown = [" ".join(line.split()) for line in listing.splitlines()]
    assert len(shown) > 20
    assert {line for line in shown if line != "..."} <= written
