"""The controller, by the baselines that it left; and the command from recordings to a cell file."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from oracles.sweeps import known_arm, recorded
from zerorev.cell.identify.controller import baseline_of, controller_ranges, nearest
from zerorev.cell.motions import compared
from zerorev.cell.parameters import drawn
from zerorev.cell.recordings.read import read_recording
from zerorev.cell.recordings.table import write_csv
from zerorev.cell.reference import Manner
from zerorev.cli import main
from zerorev.errors import InputError
from zerorev.files.cell_file import read_cell
from zerorev.model.ranges import RANGES
from zerorev.workers import Machines

MANNER = Manner(feed=0.2, corner=10e-3)
KNOWN = (*(f"friction_{joint}" for joint in range(1, 7)), "friction", "viscous", "breakaway", "stribeck", "tool_mass",
         "tool_lever")  # fmt: skip


def left_by(plan, arm, folder, every=4):
    """Recordings of the baseline of every hole, through their files."""
    found = []
    for n, hole in enumerate(plan.holes):
        reference = compared(plan, hole, MANNER, ("baseline",)).followed["baseline"]
        file = folder / f"{hole.hole.id}.csv"
        write_csv(recorded(reference, arm, every=every, seed=n), file)
        found.append(file)
    return found


def known_ranges(arm):
    """Of an arm of which friction and tool are known, as sweeps tell them."""
    known = {name: replace(RANGES[name], nominal=arm[name], low=arm[name], high=arm[name]) for name in KNOWN}
    return RANGES | known


@pytest.mark.long
def test_the_bandwidth_is_found(plan, tmp_path, request):
    off = []
    for bandwidth in (260.0, 560.0):
        arm = known_arm(5, bandwidth=bandwidth)
        baselines = [baseline_of(read_recording(file), plan, MANNER.corner) for file in left_by(plan, arm, tmp_path)]
        ranges = known_ranges(arm)
        kept = nearest(plan, drawn(240, 7, ranges), baselines, MANNER, machines=Machines(1))
        found = controller_ranges(kept, ranges, "baselines")["bandwidth"]
        assert found.low <= found.nominal <= found.high
        assert found.basis == "conditioned"
        assert np.log(found.high / found.low) < 0.75 * np.log(1000 / 150)
        off.append(found.nominal / bandwidth - 1)
    request.node.user_properties.append(("measured", f"bandwidth off by {[f'{100 * each:.0f} %' for each in off]}"))
    assert np.abs(off).max() <= 0.15, off


def test_a_set_that_made_the_baseline_is_the_nearest(plan, tmp_path):
    short = replace(plan, holes=plan.holes[1:2])
    arm = known_arm(5)
    (file,) = left_by(short, arm, tmp_path)
    baseline = baseline_of(read_recording(file), plan, MANNER.corner)
    assert baseline.hole == plan.holes[1].hole.id
    sets = [*drawn(9, 1), arm]
    kept = nearest(plan, sets, [baseline], MANNER, machines=Machines(1))
    assert kept.sets[0] == arm
    assert kept.distance[0] < 0.1
    assert kept.distance[1] > kept.distance[0]
    assert kept.tried == 10
    again = nearest(plan, sets, [baseline], MANNER, machines=Machines(2))
    assert np.array_equal(again.distance, kept.distance)


def test_a_baseline_of_another_plan_is_refused(plan, tmp_path):
    short = replace(plan, holes=plan.holes[1:2])
    (file,) = left_by(short, known_arm(5), tmp_path)
    with pytest.raises(InputError, match=r"the baseline of no hole of the plan.*accepted: recordings of joints"):
        baseline_of(read_recording(file), replace(plan, holes=plan.holes[:1]), MANNER.corner)


def test_a_baseline_that_is_sampled_too_slowly_is_refused(plan, tmp_path):
    short = replace(plan, holes=plan.holes[1:2])
    (file,) = left_by(short, known_arm(5), tmp_path, every=24)
    with pytest.raises(InputError, match=r"samples in the window.*accepted: a baseline sampled faster"):
        baseline_of(read_recording(file), plan, MANNER.corner)


def test_sets_that_are_all_far_off_are_refused(plan, tmp_path):
    short = replace(plan, holes=plan.holes[1:2])
    (file,) = left_by(short, known_arm(5, bandwidth=1000.0), tmp_path)
    baseline = baseline_of(read_recording(file), plan, MANNER.corner)
    with pytest.raises(InputError, match=r"the nearest of 1 sets is \d+ % off the recorded baseline"):
        nearest(plan, [known_arm(5, bandwidth=150.0)], [baseline], MANNER, machines=Machines(1))


def test_the_command_writes_a_cell_file(plan, folder, recording, monkeypatch, capsys):
    monkeypatch.chdir(folder)
    write_csv(recording, folder / "sweeps.csv")
    left_by(replace(plan, holes=plan.holes[1:2]), known_arm(3), folder)
    (folder / "gauge.csv").write_text("joint,value_deg,weight_kg\nA1,0.03,0\n")
    command = ["identify", "sweeps.csv", "--plan", "plan.json", "--hole", "position_1"]
    options = ["--feed-mm-s", "200", "--corner-mm", "10", "--sets", "20", "--workers", "1", "--json"]
    baseline = ["--baseline", "position_2.csv", "--reversal-values", "gauge.csv"]
    assert main([*command, *baseline, *options, "-o", "cell.yaml"]) == 0
    said = json.loads(capsys.readouterr().out)
    cell = read_cell(folder / "cell.yaml")
    assert cell.robot == "kuka_kr6_r700_2"
    assert {each.basis for each in cell.ranges.values()} == {"prior", "fitted", "conditioned"}
    assert {name for name, each in cell.ranges.items() if each.basis == "conditioned"} == {
        "bandwidth", "position_gain", "reset"
    }  # fmt: skip
    assert cell.ranges["behind"].basis == "prior"
    assert said["parameters"]["friction_2"]["nominal"] == cell.ranges["friction_2"].nominal
    assert cell.conditioning.feed == pytest.approx(0.2)
    assert cell.conditioning.baseline["position_2"] * 1e3 == pytest.approx(said["baselines_mm"]["position_2"])
    assert len(drawn(3, 0, cell.ranges)) == 3
    assert main(command) == 0
    words = " ".join(capsys.readouterr().out.split())
    assert "still a guess: gap, stiffness, behind, kind;" in words
    assert "still a guess: the controller" in words


def test_the_command_writes_the_program_of_the_sweeps(folder, monkeypatch, capsys):
    monkeypatch.chdir(folder)
    command = ["identify", "--plan", "plan.json", "--hole", "position_1"]
    assert main([*command, "--write-sweeps", "sweeps.src"]) == 0
    assert "DEF sweeps ( )" in (folder / "sweeps.src").read_text()
    for bad, said in (
        ([], "no recording of sweeps"),
        (["plan.json", "--write-sweeps", "sweeps.src"], "one or the other"),
        (["plan.json", "--torque-ratio", "1,2"], "six numbers other than 0"),
        (["plan.json", "--corner-mm", "-1"], "--corner-mm: -1 is not above 0"),
    ):
        capsys.readouterr()
        assert main([*command, *bad]) == 2
        error = " ".join(capsys.readouterr().err.split())
        assert said in error
        assert "Traceback" not in error
