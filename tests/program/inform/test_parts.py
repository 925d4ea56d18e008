"""A program of several jobs: one that is started, and the parts that it calls; and how long a job may be."""

from dataclasses import replace

import pytest

from oracles.inform_reader import read
from zerorev import cli
from zerorev.cli import main
from zerorev.errors import InputError
from zerorev.files.io import write_plan
from zerorev.model.controller import Call, Calls
from zerorev.program.as_exported import as_exported
from zerorev.program.dialects import read_program
from zerorev.program.export import export
from zerorev.program.inform import write
from zerorev.program.inform.dialect import INFORM
from zerorev.verify.certificate.program import certify_program

CALLS = Calls((Call("CLAMP"),), (Call("RUN"),), (Call("REST"),), (Call("UNCLAMP"),))


@pytest.fixture(scope="module")
def five(plan_for):
    plan = plan_for("ma2010", "panel", count=5)
    return replace(plan, settings=replace(plan.settings, calls=CALLS))


def verdicts(plan, program):
    return {
        (each.certificate.verdict, each.certificate.reasons)
        for each in certify_program(plan, program, as_exported(plan, program, INFORM)).holes
    }


def written(exported, folder):
    for file in exported.files:
        (folder / file.name).write_text(file.text)
    return folder / exported.files[0].name


@pytest.mark.parametrize("most", [1, 2, 4, 5])
def test_any_split_of_a_plan_is_its_program(most, five, tmp_path):
    exported = export(five, holes_per_program=most, plan_file="five.json")
    assert len(exported.files) == (1 if most == 5 else 1 + -(-5 // most))
    jobs = [read(file.text) for file in exported.files]
    assert sum(len(job.holes()) for job in jobs) == 5
    assert [call for _, call in jobs[0].calls][0::99] == ["CLAMP"]
    assert jobs[0].calls[-1][1] == "UNCLAMP"
    program = read_program(written(exported, tmp_path))
    assert verdicts(five, program) == {("certified", ())}


def test_the_way_home_is_in_the_last_part(five, tmp_path):
    plan = replace(five, settings=replace(five.settings, home_joints=(0.0, 0.0, 0.0, 0.0, -1.0, 0.0)))
    exported = export(plan, holes_per_program=2)
    assert verdicts(plan, read_program(written(exported, tmp_path))) == {("certified", ())}


def test_a_part_of_another_tool_is_refuted(five, tmp_path):
    path = written(export(five, holes_per_program=2), tmp_path)
    part = tmp_path / "PANEL_2.JBI"
    part.write_text(part.read_text().replace("///TOOL 3", "///TOOL 4"))
    ((verdict, reasons),) = verdicts(five, read_program(path))
    assert verdict == "refuted"
    assert "///TOOL 4" in reasons[0]


def test_a_part_that_is_empty_or_moves_before(five, tmp_path):
    path = written(export(five, holes_per_program=2), tmp_path)
    (tmp_path / "PANEL_1.JBI").write_text(path.read_text())
    with pytest.raises(InputError, match="no holes"):
        read_program(path)


def test_long_jobs_are_split_where_controllers_end(five, monkeypatch):
    assert len(export(five).files) == 1
    whole = export(five).text.count("\n")
    monkeypatch.setattr(write, "MOST_LINES", whole)
    assert len(export(five).files) == 1
    for least in range(whole - 80, whole, 20):
        monkeypatch.setattr(write, "MOST_LINES", least)
        files = export(five).files
        assert len(files) > 2
        assert all(file.text.count("\n") <= least for file in files)
    monkeypatch.setattr(write, "MOST_LINES", 10_000)
    monkeypatch.setattr(write, "MOST_POSITIONS", 13)
    files = export(five).files
    assert [read(file.text).tool for file in files] == [None, 3, 3, 3]
    assert all(len(read(file.text).moves) <= 13 for file in files)


def test_by_the_command_line(five, tmp_path, capsys):
    plan = tmp_path / "five.json"
    write_plan(five, plan)
    assert main(["export", str(plan), "--controller", "inform"]) == cli.FINE
    job = tmp_path / "PANEL.JBI"
    assert main(["check", "--certify", str(plan), "--program", str(job)]) == cli.FINE
    # the next export of the plan replaces it; another file of that name it does not
    assert main(["export", str(plan)]) == cli.FINE
    job.write_text(job.read_text().replace("V=5.0", "V=6.0", 1))
    assert main(["check", "--certify", str(plan), "--program", str(job)]) == cli.FOUND
    assert "line" in capsys.readouterr().out
    job.write_text(job.read_text().replace("Plan file", "plan file"))
    assert main(["export", str(plan)]) != cli.FINE
    assert main(["export", str(plan), "--retract", "R0C0"]) != cli.FINE
    said = " ".join(capsys.readouterr().err.split())
    assert "not offered in INFORM: before it moves" in said
    assert "$PX001" in said
