"""Studies: the same for any number of workers, resumed where they were left, and near what the thesis recorded."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from zerorev.cell.ensemble import HoleStudy, band, study
from zerorev.cell.parameters import drawn
from zerorev.cell.possible import conditioned
from zerorev.cell.reference import Manner
from zerorev.cli import main
from zerorev.files.cell_file import write_cell
from zerorev.files.io import write_plan
from zerorev.model.ranges import RANGES, Cell, Conditioning
from zerorev.workers import Machines

FIGURES = ("deviation", "vertical", "offset", "swing", "position", "tilt", "ovality", "profile", "torque", "speed")
THESIS = Manner(feed=0.2, corner=10e-3)
RECORDED = {"position 1": 0.20e-3, "position 2": 0.14e-3, "position 3": 0.15e-3}


@pytest.fixture(scope="module")
def recorded(published_plan):
    return dict(zip([hole.hole.id for hole in published_plan.holes], RECORDED.values(), strict=True))


def same(one, other):
    assert one.id == other.id
    assert one.motions == other.motions
    for name in FIGURES:
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))


def test_the_same_on_two_processes(published_plan):
    sets = drawn(30, 2)
    here, there = (
        list(study(published_plan, sets, manner=THESIS, motions=(), machines=Machines(count))) for count in (1, 2)
    )
    assert len(here) == 3
    for one, other in zip(here, there, strict=True):
        same(one, other)


def test_the_recorded_deviations_lie_among_those_of_the_prior(published_plan, recorded):
    """Not fitted to anything: medians of the baseline at 200 mm/s, and the plane of the error at position 3."""
    found = list(study(published_plan, drawn(60, 5), manner=THESIS, motions=()))
    for hole in found:
        row = hole.of("baseline")
        assert 0.10e-3 < np.median(hole.deviation[row, 0]) < 0.35e-3
    third, row = found[2], found[2].of("baseline")
    horizontal = np.sqrt(np.maximum(third.deviation[row, 0] ** 2 - third.vertical[row, 0] ** 2, 0))
    assert np.median(third.vertical[row, 0]) > 2 * np.median(horizontal)


@pytest.mark.long
def test_gains_of_the_conditioned_ensemble(published_plan, recorded):
    """20 mm/s, no thrust, corner, acceleration, smoothing and tool centre point at nominal."""
    sets = drawn(300, 1, held=("tool_lever",))
    kept = conditioned(published_plan, sets, recorded, THESIS)
    assert 0.08 <= len(kept) / len(sets) <= 0.30
    slow = Manner(feed=0.02, corner=10e-3)
    found = list(study(published_plan, kept, manner=slow, motions=("twin", "compensated")))
    for hole in found:
        assert band(hole.gain()[0]).median >= 0.75
        assert band(hole.gain()[1]).median >= 0.60
        assert band(hole.gain("compensated")[0]).median < 0.5 * band(hole.gain()[0]).median
    tool = np.stack([hole.gain()[1] for hole in found])
    assert (tool >= 0.4).all(axis=0).mean() >= 0.70


def test_the_curves_are_of_the_stroke_with_the_turn_in_their_middle(published_plan):
    """Of one arm: what is greatest in the window is the greatest of the curve there, and a lead-in shifts nothing."""
    found = []
    for lead_in in (0.0, 5e-3):
        settings = replace(published_plan.settings, lead_in=lead_in)
        plan = replace(published_plan, settings=settings, holes=published_plan.holes[:1])
        (hole,) = study(plan, drawn(1, 0), manner=Manner(feed=0.1, corner=2e-3), motions=())
        window = np.abs(hole.path) <= 0.5
        torque = hole.torque[..., window]
        greatest = hole.profile[:, :, 1][..., window].max(axis=-1)
        np.testing.assert_allclose(greatest, hole.deviation[..., 0], rtol=0.15)
        np.testing.assert_allclose(np.ptp(torque[:, :, 1], axis=-1), hole.swing[..., 0], rtol=0.1)
        found.append(torque)
    assert (np.abs(found[0] - found[1]).max(axis=-1)[:, :, 1] < 0.2 * hole.swing[..., 0]).all()


def test_a_study_grows_block_by_block_to_the_same(published_plan):
    plan, sets = replace(published_plan, holes=published_plan.holes[:2]), drawn(5, 1)
    whole = list(study(plan, sets, manner=THESIS, motions=()))
    growing = list(study(plan, sets, manner=THESIS, motions=(), block=2, growing=True))
    assert [(hole.id, hole.sets) for hole in growing] == [(hole.id, n) for hole in whole for n in (2, 4, 5)]
    for one, other in zip(whole, growing[2::3], strict=True):
        same(one, other)
    first = growing[0]
    np.testing.assert_array_equal(first.deviation, whole[0].deviation[..., :2])


def test_thrust_takes_the_gain_away(published_plan):
    """On a free tip 100 N bend the arm by more than it strays; at positions 1 and 3 little is left of the gain."""
    sets = drawn(6, 4)
    medians = []
    for thrust in (0.0, 100.0):
        found = list(study(published_plan, sets, manner=Manner(feed=0.02, corner=2e-3), motions=(), thrust=thrust))
        medians.append([np.median(hole.gain()[1]) for hole in found])
    without, loaded = medians
    assert min(without) > 0.3
    assert loaded[0] < 0.5 * without[0]
    assert loaded[2] < 0.5 * without[2]


@pytest.fixture(scope="module")
def plan_file(published_plan, tmp_path_factory):
    path = tmp_path_factory.mktemp("study") / "plan.json"
    write_plan(published_plan, path)
    return path


class TestCommand:
    def test_answers_as_others_build_on(self, plan_file, tmp_path, capsys):
        arguments = ["simulate", str(plan_file), "--sets", "4", "--feed-mm-s", "100", "--json"]
        assert main(arguments) == 0
        found = json.loads(capsys.readouterr().out)
        assert (found["sets"], found["seed"], found["cell"]) == (4, 0, None)
        hole = found["holes"][0]
        assert set(hole["gain_percent"]) == {"encoder", "tool"}
        assert set(hole["gain_percent"]["tool"]) == {"median", "p05", "p95"}
        assert set(hole["deviation_mm"]["baseline"]) == {"encoder", "tool"}
        assert {"baseline", "plan"} <= set(hole["feed_mm_s"])
        assert set(hole["hole"]) == set(hole["deviation_mm"])
        estimate = hole["hole"]["plan"]
        assert set(estimate) == {"position_mm", "tilt_deg", "ovality_mm"}
        assert set(estimate["ovality_mm"]) == {"entry", "exit"}
        for each in (estimate["position_mm"], estimate["tilt_deg"], *estimate["ovality_mm"].values()):
            assert 0 < each["p05"] <= each["median"] <= each["p95"] < 5

    def test_resumes(self, plan_file, tmp_path, capsys):
        folder = tmp_path / "STUDY.zarr"
        arguments = ["simulate", str(plan_file), "--sets", "3", "--feed-mm-s", "100", "-o", str(folder), "--json"]
        assert main(arguments) == 0
        whole = capsys.readouterr().out
        second = folder / "hole_00001"
        for part in sorted(second.rglob("*"), reverse=True):
            part.unlink() if part.is_file() else part.rmdir()
        second.rmdir()
        assert main(arguments) == 0
        again = capsys.readouterr()
        assert again.out == whole
        assert "resuming after 2 of 3 holes" in again.err
        assert main([*arguments, "--seed", "1"]) == 2
        assert "there is another study" in capsys.readouterr().err

    def test_a_study_of_another_version_is_refused(self, plan_file, tmp_path, capsys):
        import zarr

        folder = tmp_path / "STUDY.zarr"
        arguments = ["simulate", str(plan_file), "--sets", "2", "--feed-mm-s", "100", "-o", str(folder)]
        assert main(arguments) == 0
        said = capsys.readouterr().out
        assert "upper bounds" in said
        assert "ovality at" in said
        zarr.open_group(folder, mode="r+").attrs["format"] = "zerorev.study/1"
        assert main(arguments) == 2
        said = capsys.readouterr().err
        assert "another version (zerorev.study/1)" in said
        assert "STUDY.zarr" in said

    def test_what_is_known_of_the_arm(self, plan_file, recorded, tmp_path, capsys):
        """Ranges of a cell file, and only the sets near what was measured; one of another robot is refused."""
        cell = Cell({"gap": replace(RANGES["gap"], low=0.9, high=1.1, nominal=1.0)},
                    Conditioning(recorded, 0.2, 10e-3), "kuka_kr6_r700_2")  # fmt: skip
        write_cell(cell, tmp_path / "cell.yaml")
        arguments = ["simulate", str(plan_file), "--sets", "20", "--feed-mm-s", "100", "--json", "--cell"]
        assert main([*arguments, str(tmp_path / "cell.yaml")]) == 0
        out, err = capsys.readouterr()
        found = json.loads(out)
        assert found["cell"] == "cell.yaml"
        assert 0 < found["sets"] < 20
        assert f"{found['sets']} of 20 sets have baselines near those that were measured" in err
        write_cell(replace(cell, robot="yaskawa_gp8"), tmp_path / "other.yaml")
        assert main([*arguments, str(tmp_path / "other.yaml")]) == 2
        assert "is of the robot yaskawa_gp8" in capsys.readouterr().err

    def test_draws_pictures(self, plan_file, tmp_path, capsys):
        assert main(["simulate", str(plan_file), "--sets", "3", "--feed-mm-s", "100", "--figures", str(tmp_path)]) == 0
        assert "constant spin" in capsys.readouterr().out
        kinds = [path.name.split("_")[0].removesuffix(".png") for path in sorted(tmp_path.iterdir())]
        assert kinds == ["gains", "holes", *["stray"] * 3, *["torques"] * 3]

    def test_an_arm_without_masses(self, published_plan, tmp_path, capsys):
        bare = replace(published_plan, robot=replace(published_plan.robot, dynamics=None))
        write_plan(bare, tmp_path / "bare.json")
        assert main(["simulate", str(tmp_path / "bare.json")]) == 2
        said = capsys.readouterr().err
        assert "masses of the robot kuka_kr6_r700_2 are not known" in said
        assert "dynamics" in said

    @pytest.mark.parametrize(
        ("option", "value"), [("--sets", "0"), ("--feed-mm-s", "-1"), ("--thrust-n", "-1"), ("--corner-mm", "nan")]
    )
    def test_what_is_out_of_range(self, plan_file, option, value, capsys):
        assert main(["simulate", str(plan_file), option, value]) == 2
        assert option in capsys.readouterr().err


def test_a_hole_without_a_motion_is_left_out_and_said(published_plan):
    holes = (replace(published_plan.holes[0], motion=None), *published_plan.holes[1:2])
    found = list(study(replace(published_plan, holes=holes), drawn(2, 0), manner=THESIS, motions=()))
    assert found[0] == (published_plan.holes[0].hole.id, "it has no motion")
    assert isinstance(found[1], HoleStudy)
