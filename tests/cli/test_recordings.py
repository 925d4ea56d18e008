"""`zerorev recordings`: real files in, figures out; what cannot be measured is one message."""

from __future__ import annotations

import json

import numpy as np
import pytest

from oracles.published import POSITIONS
from oracles.recordings import kick, run_of
from zerorev.cell.recordings.krc4_write import write_krc4
from zerorev.cell.recordings.table import write_csv
from zerorev.cli import main
from zerorev.files.io import job_from_dict, write_plan
from zerorev.planning.job import plan_job


@pytest.fixture(scope="module")
def folder(tmp_path_factory, robot, tool):
    """Runs of position 2, its baseline and its plan, as files."""
    folder = tmp_path_factory.mktemp("recordings")
    holes = [
        {"id": each.name[-1], "target_mm": list(each.target_mm), "direction": [1, 0, 0], "depth_mm": each.depth_mm,
         "psi_deg": list(each.psi_deg), "branch": each.branch}
        for each in POSITIONS
    ]  # fmt: skip
    job = {"robot": robot.name, "tool": tool.name, "proof_boxes": 0, "holes": holes}
    write_plan(plan_job(job_from_dict(job)), folder / "plan.json")
    for name, held, share in (("baseline", True, 1.0), ("optimised", False, 0.4)):
        run = run_of(
            robot, tool, POSITIONS[1], held=held, error=lambda path, share=share: [share * each for each in kick(path)]
        )  # fmt: skip
        write_csv(run.recording, folder / f"{name}.csv")
        write_krc4(run.recording, folder / name)
    return folder


def run(capsys, *arguments):
    code = main([*map(str, arguments)])
    said = capsys.readouterr()
    assert "Traceback" not in said.out + said.err
    return code, said.out, said.err


PLAN = ("--plan", "plan.json", "--hole", "2")


@pytest.fixture(autouse=True)
def there(folder, monkeypatch):
    monkeypatch.chdir(folder)


def test_show(capsys):
    code, out, _ = run(capsys, "recordings", "show", "baseline.csv", "optimised", *PLAN)
    assert code == 0
    assert "1 1 1 0 1 1" in out
    assert "0 0 0 0 0 0" in out
    assert "baseline.csv: aligned at its first commanded torque" in out


def test_show_as_json(capsys):
    code, out, _ = run(capsys, "recordings", "show", "optimised.csv", *PLAN, "--json")
    assert code == 0
    one = json.loads(out)
    assert {"alignment", "path_mm", "window_mm", "deviation_mm", "offset_mm", "reversals_per_joint"} <= set(one)
    assert one["alignment"] == {"by": "commanded_torque", "time_s": 0.3, "sample": 75}
    assert one["window_mm"] == 10
    assert one["path_mm"] == pytest.approx(40, abs=0.02)
    assert one["deviation_mm"]["max"] == pytest.approx(0.4 * 0.155, abs=1e-3)
    assert one["hole"] == "2"
    _, out, _ = run(capsys, "recordings", "show", "optimised_NextGenDrive#4.r64", "optimised.csv", *PLAN, "--json")
    trace, table = json.loads(out)
    assert trace["deviation_mm"]["max"] == pytest.approx(table["deviation_mm"]["max"], abs=1e-9)
    _, out, _ = run(capsys, "recordings", "show", "optimised", *PLAN, "--window-mm", "4", "--json")
    assert json.loads(out)["window_mm"] == 4


def test_repeat(capsys):
    code, out, _ = run(capsys, "recordings", "repeat", "baseline.csv", "baseline", *PLAN, "--json")
    found = json.loads(out)
    assert code == 0
    assert found["recordings"] == 2
    assert found["tip_mm"]["max"] == pytest.approx(0, abs=1e-9)
    assert np.allclose(found["torque_nm"]["max"], 0, atol=1e-9)
    code, out, _ = run(capsys, "recordings", "repeat", *["baseline"] * 5, *PLAN)
    assert "mean + 3 sigma" in out
    assert "A1 0, A2 0" in out


def test_compare(capsys, tmp_path):
    page = tmp_path / "page.html"
    code, out, _ = run(capsys, "recordings", "compare", "baseline", "optimised.csv", "-o", page, *PLAN)
    assert code == 0
    assert f"page written to {page}" in out
    assert "optimised.csv" in page.read_text()
    before = (page.parent / "page.html").read_bytes()
    code, _, err = run(capsys, "recordings", "compare", "baseline.csv", "optimised.csv", "-o", "optimised.csv", *PLAN)
    assert code == 2
    assert "which is read" in err
    code, _, err = run(capsys, "recordings", "compare", "baseline.csv", "optimised.csv", "-o", page)
    assert code == 2
    assert page.read_bytes() == before


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["show"], "no recording"),
        (["show", "missing.csv"], "missing.csv: no such file"),
        (["show", "baseline.csv"], "only joint angles are recorded"),
        (["show", "baseline.csv", "--hole", "2"], "--hole: is of no plan"),
        (["show", "baseline.csv", "--plan", "plan.json"], "has 3 holes with a motion"),
        (["show", "baseline.csv", "--plan", "plan.json", "--hole", "1"], "is not the plan's: the tip stays"),
        (["show", "baseline.csv", *PLAN, "--window-mm", "-1"], "a window of -1 mm"),
        (["show", "baseline", *PLAN, "--gear-ratio", "1,2"], "gear_ratio: gear ratios that cannot be"),
        (["show", "baseline", *PLAN, "--gear-ratio", "1,1,1,1,1,-2"], "is not the plan's"),
        (["show", "baseline.csv", *PLAN, "--channels", "plan.json"], "plan.json: is not a mapping of channels"),
        (["show", "plan.json"], "no column t_s"),
        (["show", "."], "is a folder"),
        (["show", "/dev/zero"], "is not a regular file"),
        (["repeat", "baseline.csv", *PLAN], "two or more of one motion"),
    ],
)
def test_what_cannot_be_measured_is_one_message(capsys, arguments, says):
    code, out, err = run(capsys, "recordings", *arguments)
    assert code == 2
    assert out == ""
    assert err.startswith("error: ")
    assert says in " ".join(err.split())
