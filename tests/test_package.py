"""The package as a user meets it: its public names, how fast it imports, and its examples."""

import os
import runpy
import subprocess
import sys
from pathlib import Path

import pytest

import zerorev
from oracles.places import ROOT
from zerorev.cli import main
from zerorev.cli.common import FINE

EXAMPLES = sorted((ROOT / "examples").glob("[0-9]*.py"))
JOBS = sorted((ROOT / "examples" / "jobs").glob("*.yaml"))


def run(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, *arguments], capture_output=True, text=True, cwd=ROOT, check=False)


@pytest.mark.parametrize("name", zerorev.__all__)
def test_every_public_name_is_there_and_documented(name):
    assert getattr(zerorev, name).__doc__
    assert name in dir(zerorev)


def test_the_public_names_are_these():
    homes = {name for names in zerorev._HOMES.values() for name in names}
    assert sorted(homes) == zerorev.__all__ == sorted(zerorev.__all__)


def test_a_name_that_is_not_there_is_an_attribute_error():
    with pytest.raises(AttributeError, match="no attribute 'nonsense'"):
        _ = zerorev.nonsense


def test_importing_loads_nothing_heavy():
    heavy = "numpy numba scipy pydantic yaml matplotlib rich cyclopts"
    done = run("-c", f"import sys, zerorev; print([m for m in '{heavy}'.split() if m in sys.modules])")
    assert done.stdout.strip() == "[]", done.stderr


def test_planning_loads_no_compiler_once_the_kernels_are_cached():
    # numba.np.arraymath, which numba imports before it compiles, imports scipy.linalg: half of a first answer's time
    code = (
        "import sys, zerorev as zr; robot, tool = zr.read_robot('kuka_kr6_r700_2'), zr.read_tool('thesis_drill');"
        "plan = zr.plan(robot, tool, zr.Hole('1', target=[0.5, 0.3, 0.8], direction=[1, 0, 0], depth=0.05));"
        "print(plan.verified.passed, [m for m in ('numba.np.arraymath', 'scipy.linalg') if m in sys.modules])"
    )
    run("-c", code)  # so that they are
    done = run("-c", code)
    assert done.stdout.strip() == "True []", done.stderr


def test_types_are_published():
    assert (Path(zerorev.__file__).parent / "py.typed").exists()


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.name)
def test_example_runs(example, capsys):
    """Warnings are errors, as in all tests."""
    runpy.run_path(os.fspath(example), run_name="__main__")
    assert capsys.readouterr().out


def test_an_example_runs_by_itself():
    done = run("-W", "error", os.fspath(EXAMPLES[1]))
    assert done.returncode == 0, done.stderr
    assert done.stdout


def test_the_readme_shows_the_first_example():
    code = (ROOT / "examples" / "01_one_hole.py").read_text().splitlines()
    readme = (ROOT / "README.md").read_text()
    assert all(line in readme for line in code[2:-1])


@pytest.mark.long
def test_the_panel_of_a_hundred_holes(tmp_path):
    job = zerorev.read_job(ROOT / "examples" / "jobs" / "panel.yaml")
    seen = []
    plan = zerorev.plan_job(job, progress=lambda done, total: seen.append((done, total)))
    assert seen[-1] == (100, 100)
    assert len(plan.holes) == 100
    planned = [hole for hole in plan.holes if hole.status == "planned"]
    assert len(planned) == 99
    assert all(hole.score.reversals == 0 and hole.verified.passed for hole in planned)
    of_many = ("lost_motion", "tcp_calibration", "near_limit", "tool_turn")
    found = [(finding.kind, finding.hole) for finding in plan.all_findings if finding.kind not in of_many]
    assert found == [("unreachable", "R9C0")]
    assert {finding.level for finding in plan.all_findings if finding.kind in of_many} == {"info", "warning"}
    assert min(move.clearance for move in plan.transitions) > -2e-5
    assert not any(move.changes_posture for move in plan.transitions)
    program = zerorev.export(plan, "krl", skip_failed=True)
    assert program.text.count(";FOLD Hole ") == 99


@pytest.mark.parametrize(
    "job", [path for path in JOBS if path.stem not in ("panel", "place_panel")], ids=lambda path: path.stem
)
def test_job_is_planned_checked_and_exported(job, tmp_path):
    plan, program = tmp_path / "plan.json", tmp_path / "program.src"
    for arguments in (
        ["plan", os.fspath(job), "-o", os.fspath(plan)],
        ["check", os.fspath(plan)],
        ["export", os.fspath(plan), "--controller", "krl", "-o", os.fspath(program)],
    ):
        assert main(arguments) == FINE
    assert program.read_text().count(";FOLD Hole ") == (6 if job.stem == "cad_panel" else 3)
