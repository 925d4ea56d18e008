"""Methods against each other: what is counted, what it is counted with, and the command."""

from __future__ import annotations

import csv
import json
from dataclasses import replace

import numpy as np
import pytest
import yaml
from scipy.stats import binomtest

from zerorev import cli
from zerorev.cli import common, main
from zerorev.errors import InputError
from zerorev.model.job import Job, Settings
from zerorev.model.profile import Profile
from zerorev.motion.criteria import thesis_objective
from zerorev.motion.evaluation import evaluate
from zerorev.thesis.compare import WORST, Comparison, Rescored, compare, comparison, runs, wilson
from zerorev.thesis.methods import METHODS, Outcome

JOB = {
    "robot": "kuka_kr6_r700_2",
    "tool": "thesis_drill",
    "holes": [
        {"id": "P1", "target_mm": [500, 300, 800], "direction": [1, 0, 0], "depth_mm": 50},
        {"id": "far", "target_mm": [5000, 300, 800], "direction": [1, 0, 0], "depth_mm": 50},
    ],
}


@pytest.fixture(scope="module")
def job(robot, tool, positions):
    return Job(robot, tool, tuple(position.hole for position in positions), name="thesis")


@pytest.fixture(scope="module")
def answer(job):
    """Three methods, three seeds, part of the thesis' budget."""
    return compare(job, ["exact", "swarm", "differential_evolution"], range(3), budget=2000)


@pytest.mark.parametrize("trials", [1, 2, 20, 200])
def test_wilson_is_scipys(trials):
    for successes in {0, 1, trials // 3, trials - 1, trials}:
        expected = binomtest(successes, trials).proportion_ci(confidence_level=0.95, method="wilson")
        assert wilson(successes, trials) == pytest.approx((expected.low, expected.high), abs=1e-12)


class TestCompare:
    def test_runs_hole_by_hole_method_by_method_seed_by_seed(self, answer):
        expected = [
            (hole.id, method, seed)
            for hole in answer.holes
            for method in ("exact", "swarm", "differential_evolution")
            for seed in ((None,) if method == "exact" else (0, 1, 2))
        ]
        assert [(run.hole, run.method, run.seed) for run in answer.runs] == expected
        assert len(expected) == answer.expected == 21

    def test_exact_has_zero_reversals_everywhere_and_the_least_travel_of_all(self, answer):
        summaries = {(each.hole, each.method): each for each in answer.summaries()}
        for hole in answer.holes:
            ours = summaries[hole.id, "exact"]
            assert (ours.zero, ours.interval) == (1, None)
            for method in ("swarm", "differential_evolution"):
                theirs = summaries[hole.id, method]
                assert min(theirs.travels, default=np.inf) >= ours.travels[0] * (1 - 1e-6)
                assert min(theirs.scores) >= ours.scores[0] * (1 - 1e-6)

    def test_what_counts_is_the_exact_evaluation(self, answer):
        fooled = 0
        for run in answer.runs:
            hole = next(hole for hole in answer.holes if hole.id == run.hole)
            profile = Profile.straight(hole.depth, *run.outcome.spins)
            evaluation = evaluate(answer.job.robot, answer.job.tool, hole, profile, run.outcome.branch)
            assert run.reversals == evaluation.score.reversals >= run.outcome.reversals
            assert run.travel == evaluation.score.travel
            assert run.score == pytest.approx(thesis_objective(evaluation))
            fooled += run.reversals > run.outcome.reversals
        assert fooled > 0  # least travel leads to where a joint turns round between two samples

    def test_a_seed_gives_the_same_regardless_of_earlier_runs(self, job, answer):
        one = job.holes[1].id
        alone = compare(job, ["differential_evolution"], [2], budget=2000, hole=one)
        again = next(
            run for run in answer.runs if (run.hole, run.method, run.seed) == (one, "differential_evolution", 2)
        )
        np.testing.assert_array_equal(alone.runs[0].outcome.spins, again.outcome.spins)
        assert alone.runs[0].outcome.first_zero == again.outcome.first_zero

    def test_progress_and_budget(self, job):
        reported = []
        answer = compare(
            job,
            ["direct", "exact"],
            [7],
            budget=400,
            hole=job.holes[0].id,
            progress=lambda *done: reported.append(done),
        )
        assert reported == [(1, 2), (2, 2)]
        assert [run.outcome.evaluations for run in answer.runs] == [400, 0]

    def test_the_bound_is_the_jobs_or_the_thesis(self, job):
        asked = comparison(job, ["differential_evolution"])
        assert asked.problem(job.holes[0]).bound == np.pi
        narrow = comparison(replace(job, settings=Settings(psi_bound=1.0)), ["differential_evolution", "exact"], [0])
        assert all(np.abs(run.outcome.spins).max() <= 1.0 + 1e-12 for run in runs(replace(narrow, budget=400)))

    def test_finer_samples_are_fooled_less(self, job):
        coarse, fine = (
            compare(job, ["differential_evolution"], [0], budget=1000, samples=samples, hole=job.holes[0].id).runs[0]
            for samples in (20, 1000)
        )
        assert coarse.reversals - coarse.outcome.reversals >= fine.reversals - fine.outcome.reversals
        assert fine.outcome.score == pytest.approx(fine.outcome.reversals / 7 + fine.travel / (84 * np.pi), abs=1e-5)

    def test_crowded_samples_are_fooled_less(self, job):
        even, crowded = (
            compare(
                job, ["differential_evolution"], range(4), budget=2000, crowded=crowded, hole=job.holes[0].id
            ).summaries()[0]
            for crowded in (False, True)
        )
        assert crowded.zero == crowded.zero_sampled == 4
        assert sum(run.reversals > run.outcome.reversals for run in crowded.runs) == 0
        assert even.zero < 4

    def test_where_nothing_can_be_run_all_fail(self, job):
        far = replace(job.holes[0], target=10 * job.holes[0].target)
        answer = compare(replace(job, holes=(far,)), ["exact", "swarm", "direct"], [0], budget=400)
        for run in answer.runs:
            assert (run.score, run.reversals, run.travel) == (WORST, None, None)
        assert all(summary.zero == summary.zero_sampled == 0 for summary in answer.summaries())

    @pytest.mark.parametrize(
        ("changes", "message"),
        [
            ({"methods": ["exact", "pso"]}, "no method 'pso' .*exact, swarm"),
            ({"methods": []}, "no method"),
            ({"seeds": []}, "seeds: no seed"),
            ({"seeds": [0, 1.5]}, "seeds: 1.5 is not a seed"),
            ({"seeds": [-1]}, "seeds: -1 is not a seed"),
            ({"seeds": [True]}, "seeds: True"),
            ({"budget": 399}, "budget: 399"),
            ({"samples": 201}, "samples: 201"),
            ({"hole": "P9"}, "hole: there is no hole 'P9' .*position 1, position 2"),
        ],
        ids=lambda value: "-".join(value) if isinstance(value, dict) else "",
    )
    def test_bad_input(self, job, changes, message):
        with pytest.raises(InputError, match=message):
            compare(**{"job": job, "methods": ["exact"]} | changes)


class TestSummary:
    def test_counts(self, job):
        def run(seed, reversals, first_zero, sampled=0):
            outcome = Outcome(np.zeros(3), 0, 0.1, sampled, 500, first_zero)
            return Rescored("position 1", "cma", seed, outcome, 0.1 * (seed + 1), reversals, 1.0 + seed, 0.5)

        found = (run(0, 0, 30), run(1, 2, 40), run(2, 0, None), run(3, 1, None, sampled=1))
        asked = Comparison(job, job.holes, {"cma": METHODS["cma"]}, (0, 1, 2, 3), 500, runs=found)
        (summary,) = asked.summaries()
        assert (summary.zero, summary.zero_sampled) == (2, 3)
        assert summary.interval == wilson(2, 4)
        assert summary.travels == [1.0, 3.0]
        assert summary.first_zeros == [30, 40]
        assert summary.scores == pytest.approx([0.1, 0.2, 0.3, 0.4])


class TestCommand:
    @pytest.fixture
    def job_file(self, tmp_path):
        path = tmp_path / "panel.yaml"
        path.write_text(yaml.safe_dump(JOB))
        return str(path)

    def test_table(self, job_file, capsys):
        arguments = ["methods", job_file, "--methods", "exact, direct", "--seeds", "2", "--budget", "400"]
        assert main(arguments) == common.FINE
        out = capsys.readouterr().out
        rows = [line for line in out.splitlines() if "exact" in line]
        assert "1 of 1" in rows[0]
        assert "0 of 1" in rows[1]  # out of reach
        assert "2 seeds, 400 evaluations" in out

    def test_json_and_file_are_the_same(self, job_file, tmp_path, capsys):
        target = tmp_path / "out.json"
        arguments = ["methods", job_file, "--methods=exact,swarm", "--seeds=2", "--budget=400", "--hole=P1", "--json"]
        assert main([*arguments, "-o", str(target)]) == common.FINE
        shown = json.loads(capsys.readouterr().out)
        assert json.loads(target.read_text()) == shown
        assert shown["format"] == "zerorev.comparison/1"
        assert [hole["id"] for hole in shown["holes"]] == ["P1"]

    def test_csv_has_a_row_per_run(self, job_file, tmp_path, capsys):
        target = tmp_path / "out.csv"
        arguments = ["methods", job_file, "--methods=exact,swarm", "--seeds=3", "--budget=400", "--hole=P1"]
        assert main([*arguments, "-o", str(target)]) == common.FINE
        rows = list(csv.DictReader(target.read_text().splitlines()))
        assert [row["seed"] for row in rows] == ["", "0", "1", "2"]
        assert float(rows[0]["travel_deg"]) == pytest.approx(102.03, abs=0.05)
        assert "answer written to" in capsys.readouterr().out

    @pytest.mark.parametrize(
        ("arguments", "parts"),
        [
            (["--methods", "exact,pso"], ("no method 'pso'", "dual_annealing")),
            (["--methods", ","], ("no method", "dual_annealing")),
            (["--seeds", "0"], ("--seeds", "1 or more")),
            (["--seeds", "many"], ("seeds", "many")),
            (["--seeds", "1.5"], ("seeds", "1.5")),
            (["--hole", "P9"], ("P9", "P1, far")),
            (["--budget", "4000.5"], ("budget", "4000.5")),
            (["--budget", "10"], ("budget", "400 or more")),
            (["--samples", "3"], ("samples", "even")),
            (["-o", "no/such/folder/out.json"], ("does not exist",)),
            (["--figure", "no/such/folder/out.png"], ("does not exist",)),
        ],
        ids=lambda value: " ".join(value) if isinstance(value, list) else "",
    )
    def test_bad_input_gets_one_message(self, job_file, arguments, parts, capsys):
        assert main(["methods", job_file, *arguments]) == common.BAD_INPUT
        out, err = capsys.readouterr()
        assert out == ""
        assert err.count("error:") == 1 or "seeds" in parts
        assert "Traceback" not in err
        for part in parts:
            assert part in err

    def test_an_interruption_shows_what_is_finished(self, job_file, tmp_path, monkeypatch, capsys):
        def interrupted(asked):
            for done, run in enumerate(runs(asked)):
                if done == 2:
                    raise KeyboardInterrupt
                yield run

        monkeypatch.setattr("zerorev.thesis.compare.runs", interrupted)
        target = tmp_path / "out.json"
        arguments = ["methods", job_file, "--methods=exact,direct,swarm", "--budget=400", "-o", str(target)]
        assert main(arguments) == common.INTERRUPTED
        out, err = capsys.readouterr()
        assert "direct" in out
        assert "swarm" not in out
        assert "2 of 44 runs" in err
        assert not target.exists()


def test_the_command_is_listed(capsys):
    assert main(["--help"]) == common.FINE
    assert "methods" in capsys.readouterr().out
    assert cli.app is common.app
