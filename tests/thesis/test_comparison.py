"""What is shown and written of a comparison: table, data, rows, box plot."""

from __future__ import annotations

import csv
import io
import json

import numpy as np
import pytest
from rich.console import Console

from zerorev.files.text import json_text
from zerorev.model.job import Job
from zerorev.thesis import comparison as shown
from zerorev.thesis.compare import Comparison, Rescored, wilson
from zerorev.thesis.methods import METHODS, Outcome

SPINS = np.deg2rad([10.0, -20.0, 30.0])


def run(method, seed, reversals, *, first_zero=None, hole="position 1", seconds=0.25):
    outcome = Outcome(SPINS, 4, 0.01, 0, 0 if method == "exact" else 5100, first_zero)
    score = 1.0 if reversals is None else reversals / 7 + 0.0067
    travel = None if reversals is None else np.deg2rad(100.0 + (seed or 0))
    return Rescored(hole, method, seed, outcome, score, reversals, travel, seconds)


@pytest.fixture
def answer(robot, tool, positions):
    """Eight methods; the exact one, one that mostly succeeds, one that never does, one that cannot be run."""
    job = Job(robot, tool, tuple(position.hole for position in positions), name="thesis")
    names = ["exact", "swarm", "cma", "direct", "dual_annealing", "pymoo_pso", "pymoo_ga", "pymoo_de"]
    found = [run("exact", None, 0, seconds=0.0123)]
    found += [run("swarm", seed, int(seed == 3), first_zero=100 * (seed + 1)) for seed in range(4)]
    found += [run("cma", seed, 2 + seed) for seed in range(4)]
    found += [run("direct", None, None)]
    found += [
        run(name, seed, seed % 2, first_zero=seed or None, seconds=2.5) for name in names[4:] for seed in range(4)
    ]
    methods = {name: METHODS[name] for name in names}
    return Comparison(job, job.holes, methods, (0, 1, 2, 3), 5100, runs=tuple(found))


def text_of(table):
    console = Console(file=io.StringIO(), width=200)
    console.print(table)
    return console.file.getvalue()


class TestTable:
    def test_each_method_has_a_row_with_its_figures(self, answer):
        rows = {
            line.split()[-1 if not line.strip() else 0]: line
            for line in text_of(shown.comparison_table(answer)).splitlines()
            if line.strip()
        }
        swarm = rows["swarm"]
        for part in ("3 of 4", "75% [30, 95]", "0.00670", "100.00", "101.00", "250", "250 ms"):
            assert part in swarm
        assert "4" in swarm.split()  # as sampled
        cma = rows["cma"]
        for part in ("0 of 4", "0% [0, 49]", f"{2 / 7 + 0.0067:.5f}", "–"):
            assert part in cma
        assert "(3 runs)" in rows["pymoo_ga"]
        assert "2.50 s" in rows["pymoo_ga"]
        assert "no chance" in rows["direct"]

    def test_lines_say_what_it_is_of(self, answer):
        text = "\n".join(line.plain for line in shown.comparison_lines(answer))
        for part in ("4 seeds", "5,100 evaluations", "200 samples", "+-180 deg", "no motion threshold"):
            assert part in text


class TestData:
    def test_figures_and_units(self, answer):
        data = shown.comparison_data(answer)
        assert json.loads(json_text(data)) == data
        assert data["format"] == "zerorev.comparison/1"
        assert data["complete"] is False  # two holes have not been run
        assert (data["samples"], data["budget"], data["psi_bound_deg"], data["seeds"]) == (200, 5100, 180, [0, 1, 2, 3])
        first, second, _ = data["holes"]
        assert second["methods"] == []
        exact, swarm, cma, direct, *_ = first["methods"]
        assert (exact["zero"], exact["runs"], exact["zero_interval"]) == (1, 1, None)
        assert swarm["zero_interval"] == pytest.approx(wilson(3, 4))
        assert (swarm["zero"], swarm["zero_as_sampled"], swarm["median_travel_deg"]) == (3, 4, 101)
        assert swarm["median_evaluations_to_first_zero"] == 250
        assert (cma["best_travel_deg"], cma["median_evaluations_to_first_zero"]) == (None, None)
        assert (direct["outcomes"][0]["reversals"], direct["outcomes"][0]["travel_deg"]) == (None, None)
        assert swarm["outcomes"][2]["psi_deg"] == pytest.approx([10, -20, 30])

    def test_a_row_per_run(self, answer):
        rows = list(csv.DictReader(io.StringIO(shown.comparison_csv(answer))))
        assert len(rows) == len(answer.runs)
        assert rows[0]["seed"] == ""
        assert rows[3] | {"seconds": ""} == {
            "hole": "position 1", "method": "swarm", "seed": "2", "score": "0.0067", "reversals": "0",
            "travel_deg": "102.0", "psi_start_deg": "10.0", "psi_target_deg": "-20.0", "psi_end_deg": "30.0",
            "branch": "4", "score_as_sampled": "0.01", "reversals_as_sampled": "0", "evaluations": "5100",
            "evaluations_to_first_zero": "300", "seconds": "",
        }  # fmt: skip

    def test_a_method_that_found_no_motion(self, answer):
        none = Rescored("position 1", "exact", None, None, 1.0, None, None, 0.1)
        (row,) = csv.DictReader(io.StringIO(shown.comparison_csv(Comparison(
            answer.job, answer.holes, answer.methods, (0,), 400, runs=(none,)))))  # fmt: skip
        assert (row["psi_start_deg"], row["branch"], row["score"]) == ("", "", "1.0")

    @pytest.mark.parametrize(("seconds", "words"), [(2.5, "2.50 s"), (0.0123, "12.3 ms"), (0.5, "500 ms")])
    def test_times(self, seconds, words):
        assert shown.duration(seconds) == words


class TestFigure:
    @pytest.fixture
    def figure(self, answer):
        pytest.importorskip("matplotlib")
        from zerorev.thesis.figures.comparison import comparison_boxes

        return comparison_boxes(answer)

    def test_every_axis_has_its_unit(self, figure):
        assert len(figure.axes) == 3  # one hole has been run
        assert all(axes.get_xlabel().endswith(("[1]", "[s]")) for axes in figure.axes)

    def test_every_run_is_a_dot_in_the_colour_of_its_reversals(self, figure, answer):
        from matplotlib.colors import to_hex

        from zerorev.report.figures import style

        score, first, seconds = figure.axes
        assert [label.get_text() for label in score.get_yticklabels()] == list(answer.methods)
        dots = [points for points in score.collections if len(points.get_offsets())]
        assert sum(len(points.get_offsets()) for points in dots) == len(answer.runs)
        for points, summary in zip(dots, answer.summaries(), strict=True):
            np.testing.assert_allclose(points.get_offsets()[:, 0], summary.scores)
            expected = [
                style.CANNOT_RUN if each.reversals is None else style.REVERSAL_COLOURS[min(6, each.reversals)]
                for each in summary.runs
            ]
            assert [to_hex(colour) for colour in points.get_facecolors()] == [colour.lower() for colour in expected]
        assert {text.get_text() for text in first.texts} >= {"never", "1 never", "looks at legs, not at motions"}
        assert "12.3 ms" in {text.get_text() for text in seconds.texts}
        (legend,) = figure.legends
        labels = [text.get_text() for text in legend.get_texts()]
        assert labels[0] == "zero reversals"
        assert labels[-1] == "cannot be run"

    def test_it_can_be_written(self, figure):
        from zerorev.report.figures.style import png

        assert png(figure).startswith(b"\x89PNG")
