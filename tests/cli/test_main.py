"""The command line as a user and as a machine meet it."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import time
from copy import deepcopy

import pytest
import yaml

from zerorev.cli import common as cli
from zerorev.cli import main
from zerorev.files.io import read_plan

GIVEN = {
    "id": "P1",
    "target_mm": [500, 300, 800],
    "direction": [1, 0, 0],
    "depth_mm": 50,
    "psi_deg": [14.1646, -5.9388, -30.4599],
    "branch": 4,
}
FAR = {"id": "far [away]", "target_mm": [5000, 300, 800], "direction": [1, 0, 0], "depth_mm": 50}
JOB = {"robot": "kuka_kr6_r700_2", "tool": "thesis_drill", "min_rate_deg_per_mm": 0, "holes": [GIVEN]}


@pytest.fixture
def write_job(tmp_path):
    """Changes to a sound job -> the path of its file."""

    def write(**changes):
        path = tmp_path / "panel.yaml"
        path.write_text(yaml.safe_dump(JOB | changes))
        return path

    return write


@pytest.fixture(scope="module")
def plan_file(tmp_path_factory):
    """The plan of a job with one published hole and one out of reach."""
    folder = tmp_path_factory.mktemp("plan")
    job = folder / "panel.yaml"
    job.write_text(yaml.safe_dump(JOB | {"holes": [GIVEN, FAR]}))
    assert main(["plan", str(job), "-o", str(folder / "panel.json"), "--json"]) == cli.FOUND
    return folder / "panel.json"


def one_message(capsys, *parts):
    """Standard error holds one message with these parts, standard output nothing."""
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("error: ")
    assert err.count("error:") == 1
    assert "Traceback" not in err
    for part in parts:
        assert part in err
    return err


class TestPlan:
    def test_table(self, write_job, capsys):
        began = time.monotonic()
        assert main(["plan", str(write_job())]) == cli.FINE
        out, err = capsys.readouterr()
        row = next(line for line in out.splitlines() if "P1" in line)
        for part in ("6 → 0", "107.1", " 4 ", "14.16  -5.94  -30.46", "0.0018 A6", "yes"):
            assert part in row
        assert "no plan written" in out
        assert "error" not in err
        assert "elapsed" not in out  # the answer is the same each time
        seconds = re.fullmatch(r"note: elapsed time (\d+\.\d) s", err.splitlines()[-1])
        assert seconds is not None
        assert float(seconds[1]) <= time.monotonic() - began + 0.05

    def test_search(self, write_job, capsys):
        hole = {key: GIVEN[key] for key in ("id", "target_mm", "direction", "depth_mm")}
        assert main(["plan", str(write_job(holes=[hole])), "--json"]) == cli.FINE
        (answer,) = json.loads(capsys.readouterr().out)["holes"]
        assert answer["status"] == "planned"
        assert answer["reversals"] == 0

    def test_one_hole_out_of_reach_leaves_the_others(self, plan_file):
        first, second = read_plan(plan_file).holes
        assert first.score.reversals == 0
        assert first.verified.passed
        assert second.status == "infeasible"

    def test_out_of_reach_is_a_finding(self, write_job, capsys):
        assert main(["plan", str(write_job(holes=[FAR, GIVEN]))]) == cli.FOUND
        out = capsys.readouterr().out
        assert "infeasible" in out
        assert any(line.startswith("error") and "hole far [away]: " in line for line in out.splitlines())

    def test_json_is_the_plan_and_nothing_else(self, write_job, tmp_path, capsys):
        target = tmp_path / "plan.json"
        assert main(["plan", str(write_job()), "-o", str(target), "--json"]) == cli.FINE
        out = capsys.readouterr().out
        assert json.loads(out)["format"] == "zerorev.plan/1"
        assert json.loads(target.read_text()) == json.loads(out)

    def test_figures(self, write_job, tmp_path, capsys):
        assert main(["plan", str(write_job()), "--figures", str(tmp_path / "pictures")]) == cli.FINE
        names = sorted(path.name for path in (tmp_path / "pictures").iterdir())
        assert names == ["P1_critical_rates.png", "P1_joint_angles.png", "P1_twist_plane.png"]
        assert "pictures" in capsys.readouterr().out

    def test_figures_of_chosen_holes(self, write_job, tmp_path, capsys):
        job = str(write_job(holes=[GIVEN, GIVEN | {"id": "P2"}, GIVEN | {"id": "a,b"}]))
        folder = tmp_path / "pictures"
        assert main(["plan", job, "--figures", str(folder), "--figures-of", "P2"]) == cli.FINE
        assert sorted(file.name for file in folder.iterdir()) == [
            "P2_critical_rates.png", "P2_joint_angles.png", "P2_twist_plane.png"
        ]  # fmt: skip
        assert main(["plan", job, "--figures", str(folder), "--figures-of", "a,b"]) == cli.FINE
        assert len(list(folder.iterdir())) == 6
        capsys.readouterr()
        for arguments, part in (
            (["--figures", str(folder), "--figures-of", "P1,P3"], "no hole 'P3'"),
            (["--figures", str(folder), "--figures-of", " , "], "no id"),
            (["--figures-of", "P1"], "--figures DIR"),
        ):
            assert main(["plan", job, *arguments]) == cli.BAD_INPUT
            one_message(capsys, "--figures-of", part)

    @pytest.mark.parametrize(
        ("changes", "parts"),
        [
            ({"robot": "kuka_kr7"}, ("kuka_kr7", "kuka_kr7_r900_3")),
            ({"holes": [GIVEN | {"depth_mm": "deep"}]}, ("depth_mm", "deep")),
            ({"holes": [GIVEN | {"target_mm": [float("nan"), 0, 0]}]}, ("target_mm",)),
            ({"holes": [GIVEN | {"depth_mm": float("inf")}]}, ("depth_mm",)),
            ({"holes": [GIVEN | {"direction": [0, 0, 0]}]}, ("direction",)),
            ({"holes": [GIVEN | {"depth_mm": -5}]}, ("depth",)),
            ({"holes": [GIVEN | {"direction": [0, 1, 0]}]}, ("parallel", "part_x")),
            ({"holes": []}, ("holes",)),
            ({"holes": [GIVEN, deepcopy(GIVEN)]}, ("P1", "twice")),
            ({"holes": "none.csv"}, ("none.csv",)),
            ({"spin": 3}, ("spin",)),
        ],
        ids=lambda value: "-".join(value) if isinstance(value, dict) else "",
    )
    def test_a_bad_job_gets_one_message(self, write_job, tmp_path, changes, parts, capsys):
        job = write_job(**changes)
        target = tmp_path / "plan.json"
        assert main(["plan", str(job), "-o", str(target)]) == cli.BAD_INPUT
        one_message(capsys, "panel.yaml", *parts)
        assert not target.exists()

    @pytest.mark.parametrize(
        ("rows", "parts"),
        [
            ("id,x_mm,y_mm,z_mm,i,j,k\nA,500,300,800,1,0,0\n", ("depth_mm",)),
            ("id,x_mm,y_mm,z_mm,i,j,k,depth_mm\nA,500,300,high,1,0,0,50\n", ("line 2", "z_mm", "high")),
            ("id,x_mm,y_mm,z_mm,i,j,k,depth_mm\nA,500,300,nan,1,0,0,50\n", ("line 2", "z_mm")),
            ("id,x_mm,y_mm,z_mm,i,j,k,depth_mm\n", ("no holes",)),
        ],
        ids=["missing column", "text", "nan", "empty"],
    )
    def test_a_bad_table_gets_one_message(self, write_job, tmp_path, rows, parts, capsys):
        (tmp_path / "holes.csv").write_text(rows)
        assert main(["plan", str(write_job(holes="holes.csv"))]) == cli.BAD_INPUT
        one_message(capsys, "holes.csv", *parts)

    @pytest.mark.parametrize("option", ["-o", "--figures"])
    def test_bad_outputs_are_reported_before_the_work(self, option, write_job, tmp_path, capsys, no_planning):
        assert main(["plan", str(write_job()), option, str(tmp_path / "no" / "such")]) == cli.BAD_INPUT
        one_message(capsys, "such", "does not exist")

    @pytest.mark.parametrize("option", ["-o", "--figures"])
    def test_no_write_permission(self, option, write_job, tmp_path, capsys, no_planning, monkeypatch):
        job = write_job()
        monkeypatch.setattr(os, "access", lambda *_: False)  # the tests may run as root, who may write everywhere
        assert main(["plan", str(job), option, str(tmp_path / "x")]) == cli.BAD_INPUT
        one_message(capsys, "no write permission")

    def test_never_over_the_job(self, write_job, capsys, no_planning):
        job = write_job()
        before = job.read_text()
        assert main(["plan", str(job), "-o", str(job)]) == cli.BAD_INPUT
        one_message(capsys, "which is read")
        assert job.read_text() == before

    def test_an_interrupt_leaves_nothing(self, write_job, tmp_path, capsys, monkeypatch):
        def interrupted(*_, **__):
            raise KeyboardInterrupt

        monkeypatch.setattr("zerorev.planning.job.plan", interrupted)
        assert main(["plan", str(write_job()), "-o", str(tmp_path / "plan.json")]) == cli.INTERRUPTED
        one_message(capsys, "interrupted")
        assert [path.name for path in tmp_path.iterdir()] == ["panel.yaml"]

    def test_a_fault_is_distinguished_from_a_wrong_input(self, write_job, capsys, monkeypatch):
        def broken(*_, **__):
            raise ZeroDivisionError

        monkeypatch.setattr("zerorev.planning.job.plan", broken)
        assert main(["plan", str(write_job())]) == cli.BUG
        assert "ZeroDivisionError" in capsys.readouterr().err


def axis(name, **changes):
    """A hole without a depth."""
    return deepcopy({key: GIVEN[key] for key in ("target_mm", "direction", "branch")}) | {"id": name} | changes


@pytest.fixture(scope="module")
def depth_file(tmp_path_factory):
    """Depths of two holes without depth_mm, one of them out of reach."""
    folder = tmp_path_factory.mktemp("depth")
    job = folder / "panel.yaml"
    job.write_text(yaml.safe_dump(JOB | {"holes": [axis("P1"), axis("far", target_mm=[5000, 0, 0])]}))
    assert main(["depth", str(job), "-o", str(folder / "depths.json"), "--json"]) == cli.FOUND
    return folder / "depths.json"


class TestDepth:
    """Strokes and plans; that they are the deepest is for the tests of `deepest_stroke`."""

    def test_the_file_holds_depths_and_plans(self, depth_file):
        data = json.loads(depth_file.read_text())
        assert data["format"] == "zerorev.depth/1"
        assert data["settings"]["legs"] == "straight"
        first, second = data["holes"]
        assert set(first) == {"id", "deepest_mm", "plan"}
        assert first["id"] == "P1"
        assert 80 < first["deepest_mm"] < 104.7  # 104.6 mm on the best of all branches (theory §7)
        plan = first["plan"]
        assert plan["depth_mm"] == plan["standoff_mm"][0] == plan["deepest_mm"] == first["deepest_mm"]
        assert plan["status"] == "planned"
        assert plan["branch"] == 4
        assert plan["reversals"] == 0
        assert plan["verified"]["passed"]
        assert second["deepest_mm"] == 0
        assert second["plan"]["status"] == "infeasible"
        assert second["plan"]["findings"][0]["kind"] == "unreachable"

    def test_it_is_checked_certified_and_exported_as_a_plan_is(self, depth_file, tmp_path, capsys):
        pytest.importorskip("flint")
        copy, program = tmp_path / "depths.json", tmp_path / "deep.src"
        copy.write_bytes(depth_file.read_bytes())
        assert main(["check", "--certify", str(copy)]) == cli.FOUND  # for the hole that is out of reach
        assert (
            "deepest without a reversal: straight legs; no motion threshold; spin periodic" in capsys.readouterr().out
        )
        before, after = (json.loads(path.read_text()) for path in (depth_file, copy))
        assert after["holes"][0]["plan"].pop("certificate")["verdict"] == "certified"
        assert before["holes"][0]["plan"].pop("certificate") is None
        assert all(data["holes"][0]["plan"].pop("verified")["passed"] for data in (before, after))
        assert after == before
        assert main(["export", str(copy), "--skip-failed", "-o", str(program)]) == cli.FINE
        assert "DEF deep" in program.read_text()

    def test_what_contradicts_itself_is_refused(self, depth_file, tmp_path, capsys):
        forged = tmp_path / "forged.json"
        data = json.loads(depth_file.read_text())
        data["holes"][0]["deepest_mm"] += 10
        forged.write_text(json.dumps(data))
        assert main(["check", str(forged)]) == cli.BAD_INPUT
        one_message(capsys, "forged.json", "hole P1", "deepest_mm", "contradicts")

    def test_options_override_the_job(self, write_job, capsys):
        job = write_job(holes=[axis("P1")], min_rate_deg_per_mm=5, psi_bound_deg=90)
        assert main(["depth", str(job), "--min-rate-deg-per-mm", "0.02", "--psi-bound-deg", "30", "--json"]) == cli.FINE
        data = json.loads(capsys.readouterr().out)
        assert (data["settings"]["min_rate_deg_per_mm"], data["settings"]["psi_bound_deg"]) == (0.02, 30)
        plan = data["holes"][0]["plan"]
        assert min(plan["min_rate_deg_per_mm"]) >= 0.02 * (1 - 1e-6)
        assert max(map(abs, plan["psi_deg"])) <= 30 + 1e-9

    def test_a_table_of_holes_needs_no_column_of_depths(self, write_job, tmp_path, capsys):
        (tmp_path / "holes.csv").write_text("id,x_mm,y_mm,z_mm,i,j,k\nA,5000,300,800,1,0,0\n")
        assert main(["depth", str(write_job(holes="holes.csv"))]) == cli.FOUND
        assert "infeasible" in capsys.readouterr().out

    @pytest.mark.parametrize(
        ("options", "parts"),
        [
            (["--legs", "curved"], ("legs", "straight", "free")),
            (["--psi-bound-deg", "-1"], ("options, psi_bound_deg", "too small", "above 0 [deg]")),
            (["--min-rate-deg-per-mm", "nan"], ("options, min_rate_deg_per_mm", "finite")),
            (["--max-twist-deg-per-mm", "0"], ("options, max_twist_deg_per_mm", "too small", "above 0 [deg/mm]")),
            (["--min-rate-deg-per-mm", "few"], ("min-rate-deg-per-mm", "few")),
            (["--workers", "0"], ("--workers", "1 or more")),
        ],
        ids=lambda value: value[0] if isinstance(value, list) else "",
    )
    def test_bad_options(self, options, parts, write_job, capsys):
        assert main(["depth", str(write_job()), *options]) == cli.BAD_INPUT
        one_message(capsys, *parts)

    def test_a_plan_still_needs_its_depths(self, write_job, capsys, no_planning):
        assert main(["plan", str(write_job(holes=[GIVEN, axis("bare")]))]) == cli.BAD_INPUT
        one_message(capsys, "panel.yaml, line", "holes[1].depth_mm", "hole bare", "is missing", "above 0 [mm]")


@pytest.fixture
def no_planning(monkeypatch):
    def planned(*_, **__):
        pytest.fail("planned although the output cannot be written")

    monkeypatch.setattr("zerorev.planning.job.plan", planned)


class TestExport:
    def test_refused_while_a_hole_has_no_motion(self, plan_file, capsys):
        assert main(["export", str(plan_file)]) == cli.FOUND
        one_message(capsys, "not exported", "far [away]")
        assert list(plan_file.parent.glob("*.src")) == []

    def test_skip_failed(self, plan_file, capsys, tmp_path):
        target = tmp_path / "drill.src"
        assert main(["export", str(plan_file), "--skip-failed", "-o", str(target)]) == cli.FINE
        out, err = capsys.readouterr()
        assert "DEF drill" in target.read_text()
        assert "far [away]" in out
        assert out.index("incomplete") < out.index("written to")
        assert str(target) in out
        assert err == ""

    def test_lies_beside_the_plan_by_default(self, plan_file, capsys, tmp_path):
        copy = tmp_path / "any.json"
        copy.write_bytes(plan_file.read_bytes())
        assert main(["export", str(copy), "--skip-failed"]) == cli.FINE
        assert (tmp_path / "panel.src").exists()

    def test_a_name_that_the_controller_would_not_take(self, plan_file, capsys, tmp_path):
        assert main(["export", str(plan_file), "--skip-failed", "-o", str(tmp_path / "my-prog.src")]) == cli.FINE
        assert "called my_prog_" in capsys.readouterr().err

    def test_unknown_controller(self, plan_file, capsys):
        assert main(["export", str(plan_file), "--controller", "abacus"]) == cli.BAD_INPUT
        one_message(capsys, "abacus", "krl")

    def test_no_such_folder(self, plan_file, tmp_path, capsys):
        assert main(["export", str(plan_file), "-o", str(tmp_path / "no" / "p.src")]) == cli.BAD_INPUT
        one_message(capsys, "does not exist")


class TestCheck:
    def test_a_sound_plan(self, write_job, tmp_path, capsys):
        target = tmp_path / "plan.json"
        assert main(["plan", str(write_job()), "-o", str(target)]) == cli.FINE
        capsys.readouterr()
        assert main(["check", str(target)]) == cli.FINE
        assert "yes" in capsys.readouterr().out

    def test_a_forged_plan(self, plan_file, tmp_path, capsys):
        data = json.loads(plan_file.read_text())
        data["holes"] = data["holes"][:1]
        data["holes"][0]["psi_deg"][1] += 20.0
        forged = tmp_path / "forged.json"
        forged.write_text(json.dumps(data))
        assert main(["check", str(forged)]) == cli.FOUND
        out = capsys.readouterr().out
        assert "FAILED" in out
        assert any(line.startswith("error") and "verification" in line for line in out.splitlines())

    def test_json(self, plan_file, capsys):
        assert main(["check", str(plan_file), "--json"]) == cli.FOUND
        data = json.loads(capsys.readouterr().out)
        assert data["holes"][0]["verified"]["passed"] is True

    @pytest.mark.parametrize(
        "damage",
        [
            lambda t: t[: len(t) // 2],
            lambda t: t.replace("zerorev.plan/1", "other/1"),
            lambda t: "robot: x",
            lambda t: "",
        ],
        ids=["cut", "format", "yaml", "empty"],
    )
    @pytest.mark.parametrize("command", ["check", "export"])
    def test_not_a_plan(self, command, damage, plan_file, tmp_path, capsys):
        broken = tmp_path / "broken.json"
        broken.write_text(damage(plan_file.read_text()))
        assert main([command, str(broken)]) == cli.BAD_INPUT
        one_message(capsys, "broken.json")
        assert list(tmp_path.iterdir()) == [broken]


class TestRobots:
    def test_list(self, capsys):
        assert main(["robots"]) == cli.FINE
        out = capsys.readouterr().out
        for part in ("kuka_kr6_r700_2", "KUKA", "726", "A1 ±170", "yaskawa_gp8", "Staubli"):
            assert part in out

    def test_one(self, capsys):
        assert main(["robots", "kuka_kr6_r700_2"]) == cli.FINE
        out = capsys.readouterr().out
        assert "kroshu/kuka_robot_descriptions" in out
        assert "beware" in out
        assert "the controller counts" not in out

    def test_how_a_controller_counts(self, capsys):
        assert main(["robots", "fanuc_lrmate200id"]) == cli.FINE
        out = " ".join(capsys.readouterr().out.split())
        assert "the controller shows J3 less J2, its angle against the ground" in out
        assert "the controller counts from (0, 0, 330) mm" in out
        assert main(["robots", "yaskawa_ma2010"]) == cli.FINE
        assert "S 1341.38 L 1907.67 U 1592.89" in " ".join(capsys.readouterr().out.split())
        assert main(["robots"]) == cli.FINE
        out = " ".join(capsys.readouterr().out.split())
        assert out.count("the controller shows J3 less J2") == 1  # of all of them together
        assert "J3 -70..205" in out

    def test_json(self, capsys):
        assert main(["robots", "--json"]) == cli.FINE
        assert len(json.loads(capsys.readouterr().out)) >= 5
        assert main(["robots", "abb_irb4600_60_205", "--json"]) == cli.FINE
        assert json.loads(capsys.readouterr().out)["name"] == "abb_irb4600_60_205"

    def test_unknown(self, capsys):
        assert main(["robots", "r2d2"]) == cli.BAD_INPUT
        one_message(capsys, "r2d2", "one of the 126 that `zerorev robots` lists")


@pytest.mark.parametrize(
    "arguments",
    [["plann"], ["plan"], ["plan", "a", "b"], ["plan", "--colour", "a"], ["export", "a", "-o"]],
    ids=" ".join,
)
def test_arguments_that_make_no_sense(arguments, capsys):
    assert main(arguments) == cli.BAD_INPUT
    one_message(capsys)


def test_help_tells_the_exit_codes(capsys):
    assert main(["plan", "--help"]) == cli.FINE
    out = capsys.readouterr().out
    for code in (cli.FINE, cli.FOUND, cli.BAD_INPUT, cli.BUG, cli.INTERRUPTED):
        assert f" {code}: " in out


def run(*arguments, **options):
    command = [sys.executable, "-c", "import sys; from zerorev.cli import main; sys.exit(main())", *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False, **options)


def test_version():
    from importlib.metadata import version

    done = run("--version")
    assert (done.returncode, done.stdout.strip()) == (0, version("zerorev"))


def test_help_needs_nothing_heavy():
    code = (
        "import sys; from zerorev.cli import main; main(['--help']);"
        "sys.exit(any(name in sys.modules for name in ('numpy', 'numba', 'scipy', 'matplotlib', 'pydantic')))"
    )
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, check=False).returncode == 0


def test_a_closed_pipe_is_not_a_fault():
    read, written = os.pipe()
    os.close(read)
    done = subprocess.run(
        [sys.executable, "-c", "import sys; from zerorev.cli import main; sys.exit(main(['robots']))"],
        stdout=written, stderr=subprocess.PIPE, text=True, check=False,
    )  # fmt: skip
    os.close(written)
    assert (done.returncode, done.stderr) == (cli.PIPE_CLOSED, "")


def test_a_terminal_without_arrows():
    done = run("robots", env=os.environ | {"PYTHONIOENCODING": "ascii"})
    assert done.returncode == 0
    assert "A1 ?170" in done.stdout
