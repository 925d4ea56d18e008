"""`zerorev replay` as a user meets it."""

from __future__ import annotations

from dataclasses import replace

import pytest

from zerorev.cli import common as cli
from zerorev.cli import main
from zerorev.files.io import write_plan
from zerorev.model.job import Settings
from zerorev.model.plan import HolePlan, Plan
from zerorev.planning.hole import plan

pytest.importorskip("nicegui", reason="the replay takes three.js from NiceGUI (pip install 'zerorev[view]')")


@pytest.fixture
def plan_file(robot, tool, positions, tmp_path):
    position = positions[0]
    hole = replace(position.hole, profile=position.profile, branch=position.branch)
    answers = (plan(robot, tool, hole, Settings(min_rate=0.0)),)
    path = tmp_path / "plan.json"
    write_plan(Plan(robot, tool, Settings(min_rate=0.0), answers), path)
    return path


def refused(capsys, *parts):
    err = capsys.readouterr().err
    assert err.count("error:") == 1
    assert "Traceback" not in err
    assert all(part in err for part in parts), err


def test_one_file_and_nothing_beside_it(plan_file, tmp_path):
    out = tmp_path / "motion.html"
    assert main(["replay", str(plan_file), "-o", str(out)]) == cli.FINE
    assert out.read_text(encoding="utf-8").startswith("<!doctype html>")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["motion.html", "plan.json"]


def test_unknown_hole(plan_file, tmp_path, capsys):
    assert main(["replay", str(plan_file), "--hole", "nix", "-o", str(tmp_path / "x.html")]) == cli.BAD_INPUT
    refused(capsys, "no hole 'nix'", "accepted")
    assert not (tmp_path / "x.html").exists()


def test_not_over_its_own_plan(plan_file, capsys):
    before = plan_file.read_bytes()
    assert main(["replay", str(plan_file), "-o", str(plan_file)]) == cli.BAD_INPUT
    refused(capsys, "which is read")
    assert plan_file.read_bytes() == before


def test_no_folder_to_write_into(plan_file, tmp_path, capsys):
    assert main(["replay", str(plan_file), "-o", str(tmp_path / "no" / "x.html")]) == cli.BAD_INPUT
    refused(capsys, "does not exist")


def test_a_plan_without_a_motion(plan_file, robot, tool, positions, tmp_path, capsys):
    lost = HolePlan(positions[1].hole, "infeasible", 0.1)
    write_plan(Plan(robot, tool, Settings(), (lost,)), tmp_path / "lost.json")
    assert main(["replay", str(tmp_path / "lost.json"), "-o", str(tmp_path / "x.html")]) == cli.BAD_INPUT
    refused(capsys, "no motion to replay")
