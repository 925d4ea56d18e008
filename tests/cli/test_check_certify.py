"""`zerorev check --certify` writes the proof into the plan file; the numbers certified are those that stand there."""

import json

import numpy as np
import pytest

from zerorev import cli
from zerorev.cli import main
from zerorev.files.io import read_plan, write_plan
from zerorev.verify.certificate.certify import certify_plan

HOLE = {"id": "P1", "target_mm": [500, 300, 800], "direction": [1, 0, 0], "depth_mm": 50, "branch": 4}
GIVEN = HOLE | {"psi_deg": [14.1646, -5.9388, -30.4599]}
STILL = HOLE | {"id": "P2", "psi_deg": [10.0, 10.0, 10.0]}
JOB = {"robot": "kuka_kr6_r700_2", "tool": "thesis_drill", "min_rate_deg_per_mm": 0}


@pytest.fixture(scope="module")
def text(tmp_path_factory):
    """Texts of the plan files of one published hole, and of one beside it with constant spin."""
    folder, texts = tmp_path_factory.mktemp("plan"), []
    for holes in ([GIVEN], [GIVEN, STILL]):
        job, plan = folder / "job.yaml", folder / f"{len(holes)}.json"
        job.write_text(json.dumps(JOB | {"holes": holes}))
        assert main(["plan", str(job), "-o", str(plan), "--json"]) in (cli.FINE, cli.FOUND)
        texts.append(plan.read_text())
    return texts


@pytest.fixture
def plan_file(text, tmp_path):
    path = tmp_path / "plan.json"
    path.write_text(text[0])
    return path


@pytest.fixture
def holes_file(text, tmp_path):
    path = tmp_path / "plan.json"
    path.write_text(text[1])
    return path


def test_it_is_written_into_the_plan(plan_file, capsys):
    assert json.loads(plan_file.read_text())["holes"][0]["certificate"] is None
    assert main(["check", "--certify", str(plan_file)]) == cli.FINE
    out, _ = capsys.readouterr()
    assert "yes, certified" in out
    assert f"check and certificates written into {plan_file}" in out
    (hole,) = json.loads(plan_file.read_text())["holes"]
    assert hole["certificate"]["verdict"] == "certified"
    assert hole["certificate"]["reasons"] == []
    assert all(
        bound <= claimed
        for bound, claimed in zip(hole["certificate"]["min_rate_deg_per_mm"], hole["min_rate_deg_per_mm"], strict=True)
    )


def test_the_file_is_read_back_as_it_is(plan_file):
    assert main(["check", "--certify", str(plan_file), "--json"]) == cli.FINE
    first = plan_file.read_text()
    write_plan(read_plan(plan_file), plan_file)
    assert plan_file.read_text() == first
    assert main(["check", "--certify", str(plan_file), "--json"]) == cli.FINE
    assert plan_file.read_text() == first


def test_bounds_still_hold_as_rounded_in_the_file(plan_file):
    plan = certify_plan(read_plan(plan_file))
    write_plan(plan, plan_file)
    (before,), (after,) = plan.holes, read_plan(plan_file).holes
    a, b = before.certificate, after.certificate
    for name in ("min_rate", "blend_min_rate", "limit_distance"):
        # what is taken off for rounding is 2e-12
        assert (getattr(b, name) <= getattr(a, name) * (1 + 1e-12)).all()


def test_json(plan_file, capsys):
    assert main(["check", "--certify", "--json", str(plan_file)]) == cli.FINE
    shown = json.loads(capsys.readouterr().out)
    assert shown == json.loads(plan_file.read_text())


def test_what_is_not_certified_is_reported(holes_file, capsys):
    assert main(["check", "--certify", str(holes_file)]) == cli.FOUND
    out, _ = capsys.readouterr()
    assert "yes, undecided" in out
    assert "hole P2: A1 is claimed to reverse: not certified" in out
    assert main(["check", str(holes_file)]) == cli.FINE


def test_an_altered_claim_is_refuted(holes_file, capsys):
    data = json.loads(holes_file.read_text())
    data["holes"][1] |= {"reversals": 0, "reversals_per_joint": [0] * 6, "events": []}
    holes_file.write_text(json.dumps(data))
    assert main(["check", "--certify", str(holes_file)]) == cli.FOUND
    out, _ = capsys.readouterr()
    assert "refuted" in out
    assert "A6 turns round: it moves the other way on the retract, stand-off 0 mm" in out
    assert read_plan(holes_file).holes[1].certificate.verdict == "refuted"
    assert np.isnan(read_plan(holes_file).holes[1].certificate.min_rate).all()


def test_without_python_flint(plan_file, capsys, monkeypatch):
    before = plan_file.read_text()
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    assert main(["check", "--certify", str(plan_file)]) == cli.BAD_INPUT
    assert "needs python-flint" in capsys.readouterr().err
    assert plan_file.read_text() == before


def test_a_plan_that_cannot_be_read_stays_as_it_is(plan_file):
    plan_file.write_text("{")
    assert main(["check", "--certify", str(plan_file)]) == cli.BAD_INPUT
    assert plan_file.read_text() == "{"


def test_plan_files_from_before_certificates(plan_file):
    data = json.loads(plan_file.read_text())
    del data["holes"][0]["certificate"]
    plan_file.write_text(json.dumps(data))
    assert read_plan(plan_file).holes[0].certificate is None


# --- a program read back ----------------------------------------------------------------------------------------------


@pytest.fixture
def program_file(plan_file):
    path = plan_file.with_name("program.src")
    assert main(["export", str(plan_file), "-o", str(path)]) == cli.FINE
    return path


def test_a_program_is_certified_as_read_back(plan_file, program_file, capsys):
    before = plan_file.read_text()
    assert main(["check", "--certify", str(plan_file), "--program", str(program_file)]) == cli.FINE
    out, _ = capsys.readouterr()
    assert "yes, certified" in out
    assert f"the certificates are of {program_file} as it was read back; {plan_file} is left as it is" in out
    assert plan_file.read_text() == before


def test_what_is_proven_of_a_program_as_json(plan_file, program_file, capsys):
    assert main(["check", "--certify", str(plan_file)]) == cli.FINE
    capsys.readouterr()
    assert main(["check", "--certify", "--json", str(plan_file), "--program", str(program_file)]) == cli.FINE
    shown = json.loads(capsys.readouterr().out)
    assert (shown["format"], shown["program"]) == ("zerorev.program_certificate/1", "program")
    (hole,), (planned,) = shown["holes"], json.loads(plan_file.read_text())["holes"]
    assert (hole["id"], hole["verified"]["passed"], hole["certificate"]["verdict"]) == ("P1", True, "certified")
    for own, legs in zip(
        hole["certificate"]["min_rate_deg_per_mm"], planned["certificate"]["min_rate_deg_per_mm"], strict=True
    ):
        assert own == pytest.approx(legs, rel=1e-2, abs=1e-5)
    assert hole["certificate"]["pieces"] > planned["certificate"]["pieces"]  # the lead-in is in it


def test_a_program_edited_by_hand_is_refuted(plan_file, program_file, capsys):
    text = program_file.read_text()
    program_file.write_text(text.replace("LIN {X 500.0000", "LIN {X 500.0100"))
    assert main(["check", "--certify", str(plan_file), "--program", str(program_file)]) == cli.FOUND
    out, _ = capsys.readouterr()
    assert "yes, refuted" in out
    assert "do not lead in to one deepest point and out again as planned" in " ".join(out.split())


def test_a_program_that_cannot_be_read(plan_file, program_file, capsys):
    program_file.write_text(program_file.read_text().replace("$ORI_TYPE=#VAR", "$ORI_TYPE=#JOINT"))
    assert main(["check", "--certify", str(plan_file), "--program", str(program_file)]) == cli.BAD_INPUT
    assert "(accepted: $ORI_TYPE=#VAR)" in " ".join(capsys.readouterr().err.split())
    assert main(["check", "--certify", str(plan_file), "--program", "none.src"]) == cli.BAD_INPUT


def test_a_program_is_not_read_for_nothing(plan_file, program_file, capsys):
    assert main(["check", str(plan_file), "--program", str(program_file)]) == cli.BAD_INPUT
    assert "--certify beside it" in capsys.readouterr().err
