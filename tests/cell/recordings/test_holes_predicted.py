"""Measured holes beside the prediction of their plan: where each figure lies, and what does not belong to the plan."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from oracles.drilled_hole import centres, out_of_round
from zerorev.cell.ensemble import HoleStudy, band
from zerorev.cell.hole_estimate import calibrated_axis, hole_estimate
from zerorev.cell.motions import compared
from zerorev.cell.parameters import nominal
from zerorev.cell.plant import run
from zerorev.cell.recordings.holes_predicted import Basis, Beside, beside_prediction, check_of_plan
from zerorev.cell.recordings.run import across
from zerorev.cell.reference import Manner
from zerorev.cli import main
from zerorev.errors import InputError
from zerorev.files.io import write_plan
from zerorev.model.measured_hole import MeasuredHole

BASIS = Basis("plan", 4, 0, 0.0)
RADIUS = 3e-3


def study_of(hole_id, motions=("baseline", "plan")):
    """One of which each figure is known: 1, 2, 3, 4 in its unit for the plan, nothing for the baseline."""
    ramp = np.array([1.0, 2.0, 3.0, 4.0])
    values = np.stack([0 * ramp, ramp])[: len(motions)]
    both = np.stack([values, 10 * values], axis=1)
    none = np.zeros(1)
    hole = values * 1e-5, values * 1e-3, both * 1e-5
    return HoleStudy(hole_id, motions, none, none, none, none, *hole, none, none, none, none)


@pytest.fixture
def first(published_plan):
    return published_plan.holes[0].hole


def measured(first, *, offset=2.5e-5, slope=2.5e-3, roundness=(1.25e-5, 12.5e-5), depths=(1e-3, 25e-3, 49e-3)):
    depth = np.array(depths)
    centre = np.stack([offset + 0 * depth, slope * (depth - depth.mean())], axis=1)
    return MeasuredHole(first.id, depth, None, centre, np.interp(depth, depth[[0, -1]], roundness))


def places(hole, plan, study=None):
    found = beside_prediction([hole], plan, {hole.id: study or study_of(hole.id)}, {}, BASIS)
    return {name: each.place for name, each in found.holes[hole.id].items()}


class TestPlaces:
    @pytest.mark.parametrize(
        ("offset", "slope", "roundness", "where"),
        [
            (2.5e-5, 2.5e-3, (1.25e-5, 12.5e-5), "inside"),
            (1e-6, 1e-5, (1e-6, 1e-6), "below"),
            (1e-3, 0.1, (1e-3, 1e-3), "above"),
        ],
    )
    def test_inside_below_and_above(self, published_plan, first, offset, slope, roundness, where):
        hole = measured(first, offset=offset, slope=slope, roundness=roundness)
        assert set(places(hole, published_plan).values()) == {where}

    def test_each_figure_is_beside_its_own_range(self, published_plan, first):
        figures = beside_prediction([measured(first)], published_plan, {first.id: study_of(first.id)}, {}, BASIS).holes[
            first.id
        ]
        ramp = np.array([1.0, 2.0, 3.0, 4.0])
        scales = {"position": 1e-5, "tilt": 1e-3, "roundness_entry": 0.5e-5, "roundness_exit": 5e-5}
        for name, scale in scales.items():
            np.testing.assert_allclose(figures[name].predicted, band(ramp * scale))
        assert figures["position"].measured == pytest.approx(2.5e-5)
        assert figures["tilt"].measured == pytest.approx(np.arctan(2.5e-3))
        assert (figures["roundness_entry"].measured, figures["roundness_exit"].measured) == (1.25e-5, 12.5e-5)

    def test_a_section_far_from_an_end_does_not_speak_for_it(self, published_plan, first):
        middle = measured(first, depths=(20e-3, 25e-3, 30e-3))
        found = places(middle, published_plan)
        assert found == {"position": "inside", "tilt": "inside", "roundness_entry": None, "roundness_exit": None}

    def test_what_was_not_measured_has_no_place(self, published_plan, first):
        round_only = MeasuredHole(first.id, np.array([1e-3, 49e-3]), None, None, np.array([1.25e-5, 12.5e-5]))
        assert places(round_only, published_plan) == {
            "position": None, "tilt": None, "roundness_entry": "inside", "roundness_exit": "inside",
        }  # fmt: skip
        assert Beside(None, band(np.ones(3))).place is None

    def test_roundness_of_two_circles_is_half_their_ovality(self):
        chance = np.random.default_rng(2)
        for _ in range(5):
            one, other = chance.normal(0, 0.1e-3, (2, 2))
            apart = np.linalg.norm(one - other)
            assert out_of_round(one, other, RADIUS) == pytest.approx(apart / 2, rel=0.05)


class TestLeftOut:
    def test_why(self, published_plan, first):
        others = [replace(measured(first), id=each.hole.id) for each in published_plan.holes]
        others[1] = MeasuredHole(others[1].id, np.array([1e-3]), np.array([6e-3]))
        predicted = {others[1].id: study_of(others[1].id), others[2].id: study_of(others[2].id, ("baseline",))}
        found = beside_prediction(others, published_plan, predicted, {first.id: "it has no motion"}, BASIS)
        assert found.holes == {}
        assert found.left_out == {
            first.id: "it has no motion", others[1].id: "neither places nor roundness were measured",
            others[2].id: "the motion 'plan' of it was not simulated",
        }  # fmt: skip
        found = beside_prediction(others[:1], published_plan, {}, {}, BASIS)
        assert found.left_out == {first.id: "the study does not have it"}
        assert found.not_measured == (others[1].id, others[2].id)

    def test_holes_of_another_plan(self, published_plan, first):
        with pytest.raises(InputError, match=r"holes\.csv: no hole 'A7' in the plan") as refused:
            check_of_plan([replace(measured(first), id="A7")], published_plan, "holes.csv")
        assert first.id in str(refused.value)
        deep = measured(first, depths=(1e-3, 25e-3, first.depth + 1e-3))
        with pytest.raises(InputError, match="a section at 51 mm, but it is planned 50 mm deep"):
            check_of_plan([deep], published_plan, "holes.csv")
        check_of_plan([measured(first)], published_plan, "holes.csv")


@pytest.fixture(scope="module")
def drilled(published_plan, tmp_path_factory):
    """A plan file, its study, and the table of a machine that measures what the nominal arm has drilled with it."""
    folder = tmp_path_factory.mktemp("drilled")
    write_plan(published_plan, folder / "plan.json")
    manner = Manner(feed=0.1, corner=2e-3)
    parameters = nominal()
    lines, estimates = ["hole,depth_mm,x_mm,y_mm,roundness_mm"], {}
    for planned in published_plan.holes[:2]:
        hole = planned.hole
        references = compared(published_plan, planned, manner, ("baseline", "plan")).followed
        axis = calibrated_axis(references["baseline"], parameters)
        done = run(references["plan"], parameters)
        estimates[hole.id] = hole_estimate(done, axis)
        standoff, turn = done.reference.standoff, done.reference.turn
        entry = min(hole.depth, standoff[:turn].max(), standoff[turn:].max())
        sections = np.linspace(entry, standoff.min() + 2e-3, 41)
        both = centres(standoff, across(done.tool - axis, hole.direction), sections)
        for z, down, up in zip(sections, *both, strict=True):
            cells = (entry - z) * 1e3, *(down * 1e3), out_of_round(down, up, RADIUS) * 1e3
            lines.append(",".join([hole.id, *(repr(float(cell)) for cell in cells)]))
    (folder / "holes.csv").write_text("\n".join(lines), encoding="utf-8")
    options = ["--feed-mm-s", "100", "--corner-mm", "2", "--sets", "20", "-o", str(folder / "study.zarr")]
    assert main(["simulate", str(folder / "plan.json"), *options]) == 0
    return folder, estimates


class TestCommand:
    def test_what_a_simulated_arm_has_drilled(self, drilled, capsys):
        """Measured section by section it is the hole estimated of that arm, and most of it lies in the range."""
        folder, estimates = drilled
        arguments = ["recordings", "holes", str(folder / "holes.csv"), "--plan", str(folder / "plan.json"), "--json"]
        assert main([*arguments, "--study", str(folder / "study.zarr")]) == 0
        found = json.loads(capsys.readouterr().out)
        assert (found["sets"], found["study"], found["motion"], found["cell"]) == (20, "study.zarr", "plan", None)
        assert len(found["not_measured"]) == 1
        assert found["places"]["inside"] >= 6
        for hole in found["holes"]:
            estimate = estimates[hole["id"]]
            beside = hole["beside"]
            assert beside["position"]["measured_mm"] == pytest.approx(estimate.position * 1e3, abs=1e-3)
            assert beside["tilt"]["measured_deg"] == pytest.approx(np.degrees(estimate.tilt), rel=0.05)
            for k, end in enumerate(("entry", "exit")):
                measured_mm = beside[f"roundness_{end}"]["measured_mm"]
                assert measured_mm == pytest.approx(estimate.ovality[k] / 2 * 1e3, rel=0.03, abs=1e-3)

    def test_a_table_and_a_page(self, drilled, tmp_path, capsys):
        folder, _ = drilled
        arguments = ["recordings", "holes", str(folder / "holes.csv"), "--plan", str(folder / "plan.json")]
        assert main([*arguments, "--study", str(folder / "study.zarr"), "-o", str(tmp_path / "page.html")]) == 0
        said = capsys.readouterr().out
        assert "roundness at the exit" in said
        assert "20 sets, without thrust, of a free tip" in said
        page = (tmp_path / "page.html").read_text(encoding="utf-8")
        assert page.count("<td>") == 2 * 4 * 3
        assert "data:image/png;base64" in page

    def test_without_a_study_it_is_simulated(self, drilled, capsys):
        folder, _ = drilled
        arguments = ["recordings", "holes", str(folder / "holes.csv"), "--plan", str(folder / "plan.json"), "--json"]
        assert main([*arguments, "--sets", "2", "--seed", "3", "--motion", "baseline"]) == 0
        found = json.loads(capsys.readouterr().out)
        assert (found["sets"], found["seed"], found["study"], found["motion"]) == (2, 3, None, "baseline")
        assert found["holes"][0]["beside"]["tilt"]["place"] in ("below", "inside", "above")

    def test_a_study_of_another_plan(self, published_plan, drilled, tmp_path, capsys):
        folder, _ = drilled
        other = replace(published_plan, settings=replace(published_plan.settings, feed_plunge=1e-3))
        write_plan(other, tmp_path / "other.json")
        arguments = ["recordings", "holes", str(folder / "holes.csv"), "--plan", str(tmp_path / "other.json")]
        assert main([*arguments, "--study", str(folder / "study.zarr")]) == 2
        assert "is a study of another plan" in capsys.readouterr().err
        assert main([*arguments, "--study", str(folder)]) == 2
        assert "no study" in capsys.readouterr().err

    @pytest.mark.parametrize(
        ("options", "says"),
        [
            (("--study", "S"), "--study: has no meaning without a plan"),
            (("--sets", "3"), "--sets: has no meaning without a plan"),
            (("--motion", "baseline"), "--motion: has no meaning without a plan"),
            (("--plan", "P", "--study", "S", "--cell", "C"), "--cell: has no meaning beside a study"),
            (("--plan", "P", "--study", "S", "--seed", "1"), "--seed: has no meaning beside a study"),
        ],
    )
    def test_options_that_do_not_go_together(self, drilled, options, says, capsys):
        assert main(["recordings", "holes", str(drilled[0] / "holes.csv"), *options]) == 2
        assert says in capsys.readouterr().err

    def test_a_hole_that_the_plan_does_not_have(self, drilled, tmp_path, capsys):
        folder, _ = drilled
        text = (folder / "holes.csv").read_text(encoding="utf-8")
        (tmp_path / "holes.csv").write_text(text.replace("\nposition_1,", "\nA7,"), encoding="utf-8")
        assert main(["recordings", "holes", str(tmp_path / "holes.csv"), "--plan", str(folder / "plan.json")]) == 2
        assert "no hole 'A7' in the plan" in capsys.readouterr().err
