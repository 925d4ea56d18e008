"""Two plans side by side: made so that it is known which motion is the better, and what only one of them has."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
import yaml

import zerorev as zr
from zerorev.cli import common as cli
from zerorev.cli import main
from zerorev.files.io import job_from_dict, plan_from_text
from zerorev.planning.compared import compared
from zerorev.report.words.plan_comparison import comparison_data, comparison_lines, comparison_table

GOOD = [14.1646, -5.9388, -30.4599]  # the thesis' position 1: no reversal
BAD = [0.0, 0.0, 0.0]
HOLE = {"target_mm": [500, 300, 800], "direction": [1, 0, 0], "depth_mm": 50, "branch": 4}
FAR = {"target_mm": [5000, 300, 800], "direction": [1, 0, 0], "depth_mm": 50}
JOB = {"robot": "kuka_kr6_r700_2", "tool": "thesis_drill", "min_rate_deg_per_mm": 0, "proof_boxes": 0}


def job(**holes):
    """A job of given motions, a hole per spins; None: the hole out of reach."""
    listed = [{"id": name, **(FAR if spins is None else HOLE | {"psi_deg": spins})} for name, spins in holes.items()]
    return JOB | {"holes": listed}


@pytest.fixture(scope="module")
def plans():
    """Holes A, B and C, D: (good, bad, out of reach) and (bad, bad, good, good)."""
    return tuple(
        zr.plan_job(job_from_dict(job(**holes)))
        for holes in ({"A": GOOD, "B": BAD, "C": None, "X": GOOD}, {"A": BAD, "B": BAD, "C": GOOD, "Y": BAD})
    )


class TestHoles:
    def test_fewer_reversals_and_any_motion_before_none(self, plans):
        found = compared(*plans)
        assert [(pair.first.hole.id, pair.better) for pair in found.pairs] == [
            ("A", "first"), ("B", "alike"), ("C", "second")
        ]  # fmt: skip
        assert [hole.hole.id for hole in found.only_first] == ["X"]
        assert [hole.hole.id for hole in found.only_second] == ["Y"]

    def test_swapped_it_says_the_opposite(self, plans):
        there, back = compared(*plans), compared(*plans[::-1])
        opposite = {"first": "second", "second": "first", "alike": "alike"}
        assert {pair.first.hole.id: opposite[pair.better] for pair in there.pairs} == {
            pair.first.hole.id: pair.better for pair in back.pairs
        }
        assert back.better == opposite[there.better]

    def test_the_motion_threshold_and_the_objective_decide_between_motions_without_a_reversal(self):
        hole = {key: value for key, value in HOLE.items() if key != "branch"} | {"id": "A"}
        plans = [zr.plan_job(job_from_dict(JOB | {"holes": [hole], "min_rate_deg_per_mm": rate})) for rate in (0, 0.02)]
        scores = [plan.holes[0].score for plan in plans]
        assert [score.reversals for score in scores] == [0, 0]
        assert scores[0].travel < scores[1].travel
        assert scores[0].min_rate.min() < np.deg2rad(0.02) * 1e3 <= scores[1].min_rate.min() * (1 + 1e-6)
        assert compared(*plans).pairs[0].better == "first"  # without a threshold less travel is better
        assert compared(*plans[::-1]).pairs[0].better == "first"  # and with one who keeps it

    def test_the_same_hole_of_a_part_that_was_moved(self, plans):
        moved = job(A=GOOD) | {"part_frame": {"xyz_mm": [500, 300, 750]}}
        moved["holes"][0] |= {"target_mm": [0, 0, 0]}
        other = job(A=GOOD) | {"part_frame": {"xyz_mm": [500, 300, 800]}}
        other["holes"][0] |= {"target_mm": [0, 0, 0]}
        one, two = (zr.plan_job(job_from_dict(each)) for each in (moved, other))
        assert compared(one, two).pairs[0].same_hole
        deeper = job(A=GOOD)
        deeper["holes"][0] |= {"depth_mm": 49}
        assert not compared(plans[0], zr.plan_job(job_from_dict(deeper))).pairs[0].same_hole


class TestPlans:
    def test_totals_are_those_of_the_holes_that_both_drill(self, plans):
        found = compared(*plans)
        counts = [{hole.hole.id: hole.score for hole in plan.holes if hole.score} for plan in plans]
        assert found.reversals == tuple(sum(count[name].reversals for name in "AB") for count in counts)
        assert found.travel == pytest.approx([sum(count[name].travel for name in "AB") for count in counts])
        assert found.infeasible == (1, 0)
        assert found.better == "second"  # it drills C

    def test_it_is_alike_to_itself(self, plans):
        found = compared(plans[0], plans[0])
        assert {pair.better for pair in found.pairs} == {"alike"}
        assert found.better == "alike"
        assert all(pair.same_hole for pair in found.pairs)

    def test_words_and_data_say_the_same(self, plans):
        found, names = compared(*plans), ("one", "two")
        said = [line.plain for line in comparison_lines(found, names)]
        assert "better: two (it drills 1 more of the common holes)" in said
        assert "only in one: hole X" in said
        assert "only in two: hole Y" in said
        data = json.loads(json.dumps(comparison_data(found, names)))
        assert data["better"] == "second"
        first = next(hole for hole in data["holes"] if hole["id"] == "A")["first"]
        assert first["reversals"] == 0
        assert first["margin_mm"] == pytest.approx(first["deepest_mm"] - 50)
        assert data["only_first"] == ["X"]
        assert comparison_table(found, names).row_count == 3

    def test_no_hole_in_common(self, plans):
        alone = replace(plans[0], holes=plans[0].holes[3:])
        other = replace(plans[1], holes=plans[1].holes[3:])
        found = compared(alone, other)
        assert "they have no hole in common" in [line.plain for line in comparison_lines(found, ("one", "two"))]

    def test_of_depth_files_the_deeper_stroke_is_better(self, plans):
        hole = plans[0].holes[0]
        deeper = replace(hole, hole=replace(hole.hole, depth=0.06, profile=None))
        one, two = (replace(plans[0], strokes="deepest", holes=(each,)) for each in (hole, deeper))
        assert compared(one, two).pairs[0].better == "second"


class TestCommand:
    @pytest.fixture
    def files(self, tmp_path):
        """Two job files and the plan of the second."""
        for name, holes in (("one", {"A": GOOD}), ("two", {"A": BAD, "B": GOOD})):
            (tmp_path / f"{name}.yaml").write_text(yaml.safe_dump(job(**holes)))
        assert main(["plan", str(tmp_path / "two.yaml"), "-o", str(tmp_path / "two.json")]) == cli.FINE
        return tmp_path

    def test_a_job_and_a_plan(self, files, capsys):
        capsys.readouterr()
        assert main(["compare", str(files / "one.yaml"), str(files / "two.json")]) == cli.FINE
        out = capsys.readouterr().out
        assert "better: one (5 reversals fewer)" in out
        assert "only in two: hole B" in out

    def test_json_and_names_that_differ(self, files, capsys):
        capsys.readouterr()
        assert main(["compare", str(files / "two.yaml"), str(files / "two.json"), "--json"]) == cli.FINE
        data = json.loads(capsys.readouterr().out)
        assert (data["first"]["name"], data["second"]["name"]) == ("two.yaml", "two.json")
        assert {hole["better"] for hole in data["holes"]} == {"alike"}

    def test_a_hole_without_a_motion_is_an_answer_with_something_wrong(self, files, capsys):
        (files / "far.yaml").write_text(yaml.safe_dump(job(A=None)))
        assert main(["compare", str(files / "one.yaml"), str(files / "far.yaml")]) == cli.FOUND
        assert "better: one (it drills 1 more of the common holes)" in capsys.readouterr().out

    def test_the_old_way_gets_a_hint(self, files, capsys):
        capsys.readouterr()
        assert main(["compare", str(files / "one.yaml")]) == cli.BAD_INPUT
        assert "zerorev methods JOB.yaml" in capsys.readouterr().err

    def test_both_files_are_read_before_either_is_planned(self, files, capsys, monkeypatch):
        monkeypatch.setattr("zerorev.planning.job.plan_job", lambda *_, **__: pytest.fail("planned"))
        capsys.readouterr()
        assert main(["compare", str(files / "one.yaml"), str(files / "none.yaml")]) == cli.BAD_INPUT
        assert "none.yaml" in capsys.readouterr().err

    def test_another_kind_of_file(self, files, capsys):
        (files / "tool.yaml").write_text("format: zerorev.tool/1\n")
        assert main(["compare", str(files / "one.yaml"), str(files / "tool.yaml")]) == cli.BAD_INPUT
        assert "is a tool file, not a job" in capsys.readouterr().err
        assert plan_from_text((files / "two.json").read_text(), "two.json").holes
