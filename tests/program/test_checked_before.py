"""What was checked just as it is, is exported without another check; anything else is checked again."""

import contextlib
import json
import os
import pickle
import sys
from dataclasses import replace

import numpy as np
import pytest

import zerorev as zr
import zerorev.program.export as export_module
from zerorev import cli
from zerorev.cli import main
from zerorev.files import checked_files
from zerorev.files.io import job_from_dict, plan_to_json, write_plan
from zerorev.files.part import Part
from zerorev.files.text import json_text
from zerorev.planning.job import unanswered
from zerorev.verify.check import verify_hole

HOLES = [
    {"id": f"h{k}", "target_mm": [500, 300, 800 + k], "direction": [1, 0, 0], "depth_mm": 20, "psi_deg": [15, 7, -5]}
    for k in range(3)
]
JOB = {"robot": "kuka_kr6_r700_2", "tool": "thesis_drill", "min_rate_deg_per_mm": 0, "holes": HOLES}


@pytest.fixture(scope="module")
def plan():
    return zr.plan_job(job_from_dict(JOB))


@pytest.fixture
def checks(monkeypatch):
    """Ids of the holes that an export has checked."""
    found, verify = [], export_module.verify_hole

    def counted(robot, tool, settings, hole):
        found.append(hole.hole.id)
        return verify(robot, tool, settings, hole)

    monkeypatch.setattr(export_module, "verify_hole", counted)
    return found


# --- in one process ---------------------------------------------------------------------------------------------------


def test_a_plan_of_this_process_is_not_checked_again(plan, checks):
    assert zr.export(plan).text
    assert checks == []


def test_a_plan_that_comes_from_a_worker_neither(plan, checks):
    assert zr.export(pickle.loads(pickle.dumps(plan))).text
    assert checks == []


def test_a_plan_that_was_read_is(plan, checks, tmp_path):
    write_plan(plan, tmp_path / "plan.json")
    read = zr.read_plan(tmp_path / "plan.json")
    assert zr.export(read).text
    assert checks == ["h0", "h1", "h2"]


def test_a_hole_that_was_replaced_is(plan, checks):
    first = plan.holes[0]
    forged = replace(first, score=replace(first.score, travel=first.score.travel / 2))
    with pytest.raises(zr.NotExportableError, match="did not pass the check"):
        zr.export(replace(plan, holes=(forged, *plan.holes[1:])))
    assert checks == ["h0"]


def test_what_was_checked_on_fewer_samples_is(plan, checks):
    coarse = verify_hole(plan.robot, plan.tool, plan.settings, plan.holes[0], samples=400)
    assert coarse.passed
    assert zr.export(replace(plan, holes=(replace(plan.holes[0], verified=coarse),))).text
    assert checks == ["h0"]


def test_an_array_that_was_written_to_is_seen(plan, checks):
    first = plan.holes[0]
    joints = first.motion.joints.copy()
    moved = replace(first, motion=replace(first.motion, joints=joints))
    assert zr.export(replace(plan, holes=(moved,))).text
    assert checks == []  # the same numbers
    joints += np.deg2rad(1.0)
    with pytest.raises(zr.NotExportableError, match="did not pass the check"):
        zr.export(replace(plan, holes=(moved,)))
    assert checks == ["h0"]


@pytest.mark.parametrize("change", [{"blend": 2e-3}, {"psi_bound": 0.01}])
def test_other_settings_are(change, plan, checks):
    other = replace(plan, settings=replace(plan.settings, **change))
    try:
        zr.export(other)
    except zr.NotExportableError:
        assert "psi_bound" in change
    assert checks == ["h0", "h1", "h2"]


# --- by way of a file -------------------------------------------------------------------------------------------------


@pytest.fixture
def files(tmp_path, checked_files):
    for path in checked_files.glob("*"):
        path.unlink()
    (tmp_path / "job.yaml").write_text(json.dumps(JOB))
    return tmp_path / "job.yaml", tmp_path / "plan.json", tmp_path / "plan.src"


def exported(path, program):
    return main(["export", str(path), "-o", str(program)])


def test_a_file_that_was_planned_or_checked_here(files, checks, checked_files):
    job, plan, program = files
    assert main(["plan", str(job), "-o", str(plan), "--json"]) == cli.FINE
    assert exported(plan, program) == cli.FINE
    assert checks == []
    text = program.read_text()
    plan.write_text(plan.read_text() + "\n")  # other bytes
    assert exported(plan, program) == cli.FINE
    assert checks == ["h0", "h1", "h2"]
    assert main(["check", str(plan)]) == cli.FINE
    assert exported(plan, program) == cli.FINE
    assert len(checks) == 3
    assert program.read_text() == text
    for path in checked_files.iterdir():
        path.unlink()
    assert exported(plan, program) == cli.FINE
    assert len(checks) == 6


def test_what_was_edited_is_checked(files, checks, capsys):
    job, plan, program = files
    assert main(["plan", str(job), "-o", str(plan), "--json"]) == cli.FINE
    data = json.loads(plan.read_text())
    data["holes"][0]["travel_deg"] /= 2
    plan.write_text(json_text(data))
    assert exported(plan, program) == cli.FOUND
    assert "did not pass the check" in capsys.readouterr().err
    # a failed check is kept as little as a passed one is believed
    assert main(["check", str(plan)]) == cli.FOUND
    assert exported(plan, program) == cli.FOUND
    assert len(checks) == 6


def test_the_proof_that_check_writes_into_the_file(files, checks):
    job, plan, program = files
    assert main(["plan", str(job), "-o", str(plan), "--json"]) == cli.FINE
    main(["check", "--certify", str(plan), "--json"])
    assert exported(plan, program) == cli.FINE
    assert checks == []


def test_what_another_run_left_is_checked(files, checks, monkeypatch):
    """A part may have been altered; the run that resumes it checks only its own holes."""
    job, plan, program = files
    asked, answer = zr.read_job(job), zr.plan_job(zr.read_job(job))
    with contextlib.suppress(KeyboardInterrupt), Part(plan, unanswered(asked, "asked"), asked.holes) as part:
        part.append(answer.holes[0])
        raise KeyboardInterrupt
    assert main(["plan", str(job), "-o", str(plan), "--json"]) == cli.FINE
    assert exported(plan, program) == cli.FINE
    assert checks == ["h0", "h1", "h2"]


def test_another_version_of_the_check(files, checks, monkeypatch):
    job, plan, program = files
    assert main(["plan", str(job), "-o", str(plan), "--json"]) == cli.FINE
    monkeypatch.setattr(checked_files, "_checker", lambda: b"another")
    assert exported(plan, program) == cli.FINE
    assert checks == ["h0", "h1", "h2"]


@pytest.mark.skipif(sys.platform == "win32", reason="has no such permissions")
def test_a_folder_that_others_may_write_to_is_not_used(files, checks, monkeypatch, tmp_path):
    job, plan, program = files
    folder = tmp_path / "open" / "checked"
    monkeypatch.setattr(checked_files, "_folder", lambda: folder)
    assert main(["plan", str(job), "-o", str(plan), "--json"]) == cli.FINE
    assert exported(plan, program) == cli.FINE
    assert checks == []
    os.chmod(folder, 0o777)
    assert exported(plan, program) == cli.FINE
    assert checks == ["h0", "h1", "h2"]


@pytest.mark.parametrize("where", ["a file in the way", None])
def test_without_a_place_to_keep_it(where, files, checks, monkeypatch, tmp_path):
    job, plan, program = files
    (tmp_path / "in_the_way").touch()
    folder = None if where is None else tmp_path / "in_the_way" / "checked"
    monkeypatch.setattr(checked_files, "_folder", lambda: folder)
    assert main(["plan", str(job), "-o", str(plan), "--json"]) == cli.FINE
    assert exported(plan, program) == cli.FINE
    assert checks == ["h0", "h1", "h2"]


def test_the_oldest_are_forgotten(monkeypatch, tmp_path):
    monkeypatch.setattr(checked_files, "_folder", lambda: tmp_path / "checked")
    monkeypatch.setattr(checked_files, "MOST", 3)
    for k in range(5):
        checked_files.remember(str(k))
        for age, path in enumerate(sorted((tmp_path / "checked").iterdir(), key=lambda p: -p.stat().st_mtime)):
            os.utime(path, (1000 - age, 1000 - age))
    assert [checked_files.is_checked(str(k)) for k in range(5)] == [False, False, True, True, True]


def test_the_fingerprint_is_not_in_the_file(plan):
    assert all("subject" not in hole["verified"] for hole in plan_to_json(plan)["holes"])
