"""What a plan states of its optimality, checked: its true statements are confirmed, and others are not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import zerorev as zr
from oracles import holes
from oracles.places import CASES
from oracles.proof_trees import THESIS
from zerorev.cli import main
from zerorev.files.io import read_job, write_plan
from zerorev.model.job import Job
from zerorev.planning.job import plan_job

pytest.importorskip("flint")

from zerorev.planning.proof_check import check_proofs

FEW = 4  # boxes of each proof


def planned(robot, tool, hole, **settings):
    return plan_job(Job(robot, tool, (hole,), zr.Settings(**settings)))


def second(**changes):
    target, depth = THESIS[1]
    return zr.Hole("2", target=target, direction=[1, 0, 0], depth=depth, **changes)


@pytest.fixture(scope="module")
def plan(robot, tool):
    return planned(robot, tool, second())


def stating(plan, **changes):
    """The plan with other statements."""
    (hole,) = plan.holes
    optimality = replace(hole.optimality, **{k: v for k, v in changes.items() if k != "deepest_at_most"})
    at_most = changes.get("deepest_at_most", hole.deepest_at_most)
    return replace(plan, holes=(replace(hole, optimality=optimality, deepest_at_most=at_most),))


def fields(checks):
    return {one.field: one for one in checks}


class TestStatements:
    def test_true_ones_are_confirmed(self, plan):
        checks = check_proofs(plan, sample=FEW)
        assert [one.field for one in checks] == ["deepest_at_most_mm", "optimality.travel_at_least_deg"]
        assert all(one.confirmed and one.proof.boxes == FEW for one in checks)
        assert all(np.isinf(one.proof.most_reversals) for one in checks)

    @pytest.mark.parametrize(
        ("field", "changes"),
        [
            ("optimality.travel_at_least_deg", lambda hole: {"travel_at_least": hole.score.travel}),
            ("deepest_at_most_mm", lambda hole: {"deepest_at_most": hole.deepest * 1.0005}),
            ("optimality.reversals_at_least", lambda hole: {"reversals_at_least": 1.0}),
            ("optimality.proven", lambda hole: {"travel_at_least": None}),
        ],
    )
    def test_others_are_not(self, plan, field, changes):
        checks = fields(check_proofs(stating(plan, **changes(plan.holes[0])), sample=0))
        assert checks[field].proof is None
        assert not checks[field].confirmed

    def test_of_a_hole_that_takes_reversals(self):
        checks = fields(check_proofs(plan_job(read_job(CASES / "fewest_5239.yaml")), sample=FEW))
        assert checks["optimality.reversals_at_least"].words == "no motion has fewer reversals than 7"
        assert all(one.confirmed for one in checks.values())
        assert len(checks) == 3

    def test_of_a_hole_that_cannot_be_drilled(self, robot, tool):
        far = zr.Hole("far", target=[2.0, 0.0, 0.5], direction=[1, 0, 0], depth=0.02)
        checks = check_proofs(planned(robot, tool, far), sample=FEW)
        assert "no motion exists" in [one.words for one in checks]
        assert all(one.confirmed for one in checks)

    def test_of_a_bound_on_the_spin_a_branch_and_a_deeper_corner(self, robot, tool):
        """Position 1 on its branch: the settings that the rules of the legs depend on."""
        target, depth = THESIS[0]
        hole = zr.Hole("1", target=target, direction=[1, 0, 0], depth=depth, branch=4)
        asked = {"psi_bound": float(np.deg2rad(30)), "blend": 5e-3, "deepen_corner": True}
        checks = check_proofs(planned(robot, tool, hole, **asked), sample=FEW)
        assert len(checks) == 2
        assert all(one.confirmed for one in checks)

    def test_of_an_arm_of_another_size(self, robot, tool):
        """It is planned at size 1, and its trees are checked at its own."""
        settings = zr.Settings()
        same = holes.Drilled(robot, tool, second(), settings)
        large = holes.scaled(same, 4.0)
        assert large.robot.size == 4
        plan = plan_job(Job(large.robot, large.tool, (large.hole,), large.settings))
        checks = check_proofs(plan, sample=FEW)
        assert len(checks) == 2
        assert all(one.confirmed for one in checks)

    def test_of_a_depth_file(self, robot, tool):
        plan = plan_job(Job(robot, tool, (second(),), zr.Settings()), strokes="deepest")
        assert [one.field for one in check_proofs(plan, sample=FEW) if one.confirmed] == ["deepest_at_most_mm"]

    def test_what_is_said_of_free_legs_rests_on_no_tree(self, plan):
        free = replace(plan, settings=replace(plan.settings, legs="free"))
        assert check_proofs(free, sample=FEW) == []

    @pytest.mark.long
    @pytest.mark.parametrize("name", ["zero_missed_30018", "zero_missed_20023", "deepest_20008"])
    def test_of_cases_that_a_search_got_wrong(self, name):
        checks = check_proofs(plan_job(read_job(CASES / f"{name}.yaml")), sample=25)
        assert checks
        assert all(one.confirmed for one in checks)

    @pytest.mark.soak
    @pytest.mark.parametrize("seed", range(20))
    def test_a_random_hundred_of_random_holes(self, seed):
        drilled = holes.random_hole(seed, narrowed=seed % 4 == 0)
        depth = drilled.hole.depth * (0.3, 1.0, 2.0, 4.0)[seed // 4 % 4]
        hole = replace(drilled.hole, depth=depth)
        checks = check_proofs(plan_job(Job(drilled.robot, drilled.tool, (hole,), drilled.settings)), sample=100)
        assert checks
        assert not any(one.proof is None or one.proof.verdict == "refuted" for one in checks)

    @pytest.mark.soak
    @pytest.mark.parametrize("seed", range(40))
    def test_some_boxes_of_hostile_holes(self, seed):
        """Also where the budget did not suffice: what is stated nevertheless is proven."""
        drilled = holes.hostile_hole(seed)
        checks = check_proofs(plan_job(Job(drilled.robot, drilled.tool, (drilled.hole,), drilled.settings)), sample=60)
        assert not any(one.proof is None or one.proof.verdict == "refuted" for one in checks)


class TestTheCommand:
    @pytest.fixture
    def file(self, plan, tmp_path):
        write_plan(plan, tmp_path / "plan.json")
        return tmp_path / "plan.json"

    def test_says_what_is_confirmed(self, file, capsys):
        assert main(["check", str(file), "--proof", "--proof-sample", "3"]) == 0
        out = capsys.readouterr().out
        assert "2: none with so few travels less than 99.79" in out
        assert out.count("confirmed (3 of ") == 2

    def test_prints_it_as_json(self, file, capsys):
        import json

        assert main(["check", str(file), "--proof", "--proof-sample", "0", "--json"]) == 0
        proofs = json.loads(capsys.readouterr().out)["proofs"]
        assert [one["verdict"] for one in proofs] == ["confirmed", "confirmed"]
        assert all(one["boxes"] == 0 and one["boxes_of"] > 1000 and one["most_reversals"] is None for one in proofs)

    @pytest.mark.parametrize(
        ("options", "said"),
        [
            (["--proof-sample", "3"], "--proof beside it"),
            (["--proof", "--proof-sample", "-1"], "not a number of boxes"),
            (["--proof", "--certify", "--program", "x.src"], "a program states nothing of its optimality"),
        ],
    )
    def test_refuses_options_that_make_no_sense(self, file, capsys, options, said):
        assert main(["check", str(file), *options]) == 2
        assert said in capsys.readouterr().err
