"""The report of a plan: it says what the plan says, needs nothing from elsewhere, and shows text as text."""

from __future__ import annotations

import base64
import io
import re
from dataclasses import replace
from html.parser import HTMLParser

import numpy as np
import pytest
import yaml
from PIL import Image

from oracles.places import JOBS
from zerorev.cli import common as cli
from zerorev.cli import main
from zerorev.model.finding import Finding
from zerorev.model.plan import Transition
from zerorev.report.figures.part_view import part_view
from zerorev.report.figures.plan_report import plan_report
from zerorev.report.words.plan_facts import grouped, worst_holes

HOSTILE = '<script>alert("1")</script> \'"><img src=x onerror=alert(1)> {{ 7 * 7 }} \u202e$x_1$'
SHOWN = '<script>alert("1")</script> \'"><img src=x onerror=alert(1)> {{ 7 * 7 }} \\u202e$x_1$'


class _Page(HTMLParser):
    """Tags with their attributes, the rows of tables, and the text of a page."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.rows: list[list[str]] = []
        self.text, self._in_cell = "", False
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.tags.append((tag, dict(attributes)))
        if tag == "tr":
            self.rows.append([])
        elif tag in ("td", "th"):
            self.rows[-1].append("")
            self._in_cell = True

    def handle_endtag(self, tag):
        self._in_cell &= tag not in ("td", "th")

    def handle_data(self, data):
        self.text += data
        if self._in_cell:
            self.rows[-1][-1] += data


@pytest.fixture(scope="module")
def plan(published):
    """The thesis' plan in an order, with a move between its first two holes."""
    ids = [hole.hole.id for hole in published.holes if hole.motion is not None]
    joints = np.array([published.holes[0].motion.joints[-1], published.holes[1].motion.joints[0]])
    said = Finding("warning", "long_turn", "A6 turns by 245 deg", ids[1])
    move = Transition(ids[0], ids[1], joints, 1.25, True, np.deg2rad(245.0), -0.0, (said,))
    return replace(published, order=tuple(ids), transitions=(move,), cycle_time=83.0, name="plate")


@pytest.fixture(scope="module")
def page(plan):
    """Its report."""
    return _Page(plan_report(plan, "plate.json"))


def test_nothing_comes_from_elsewhere_and_nothing_runs(page, plan):
    names = {name for name, _ in page.tags}
    assert not names & {"script", "link", "iframe", "object", "embed", "form", "base"}
    for name, attributes in page.tags:
        assert not any(key.startswith("on") or key in ("href", "srcset", "style") for key in attributes)
        if name == "img":
            assert attributes["alt"]
            data = attributes["src"].removeprefix("data:image/png;base64,")
            with Image.open(io.BytesIO(base64.b64decode(data, validate=True))) as image:
                image.load()
                assert image.width == 1200
        else:
            assert "src" not in attributes
    text = plan_report(plan, "plate.json")
    assert not re.search(r"https?:|url\(|@import|//[a-z]", re.sub(r"base64,[^\"]+", "", text))


def test_a_row_for_each_hole_and_each_move(page, plan):
    rows = {row[1]: row for row in page.rows if len(row) > 10 and row[1] != "hole"}
    assert list(rows) == [hole.hole.id for hole in plan.in_order]
    first = rows["position 1"]
    for part in ("500, 300, 800", "1, 0, 0", "50", "6 → 0", "107.1", "14.16  -5.94  -30.46", "0.0018 A6"):
        assert part in first, part
    assert sum(row[5] == "no motion" for row in rows.values()) == sum(hole.motion is None for hole in plan.holes)
    (move,) = (row for row in page.rows if row[:2] == ["position 1", "position 2"])
    assert move[2:] == ["1.25", "changes", "245.0", "0.0", "A6 turns by 245 deg"]


def test_the_summary_counts_what_the_plan_holds(page, plan):
    scores = [hole.score for hole in plan.holes if hole.score]
    before = sum(hole.baseline.reversals for hole in plan.holes if hole.baseline)
    assert f"{len(scores)} of {len(plan.holes)} have a motion" in page.text
    assert f"{before} at constant spin → {sum(score.reversals for score in scores)} as planned" in page.text
    assert "1 min 23 s" in page.text
    assert "Something is wrong" in page.text  # one of the holes has no motion
    assert "kuka_kr6_r700_2" in page.text
    assert "thesis_drill" in page.text
    assert "blend_mm" in page.text


def test_the_same_plan_makes_the_same_page(plan):
    assert plan_report(plan, "plate.json") == plan_report(plan, "plate.json")


def test_text_from_files_is_text(make_plan):
    plan = make_plan(name=HOSTILE)
    hole = replace(plan.holes[0], findings=(Finding("error", "jump", HOSTILE, HOSTILE),))
    move = Transition(HOSTILE, None, np.zeros((2, 6)), 1.0, False, 0.1, None, ())
    robot = replace(plan.robot, name=HOSTILE, manufacturer=HOSTILE)
    plan = replace(plan, name=HOSTILE, holes=(hole,), transitions=(move,), robot=robot,
                   tool=replace(plan.tool, name=HOSTILE))  # fmt: skip
    page = _Page(plan_report(plan, HOSTILE))
    assert not {name for name, _ in page.tags} & {"script"}
    assert all(set(attributes) <= {"alt", "src"} for name, attributes in page.tags if name == "img")
    assert page.text.count(SHOWN) >= 8
    assert "\u202e" not in page.text
    assert "49" not in re.sub(r"[\d.]*\d49\d*|\d*49[\d.]+|-?\d+\.49", "", "".join(page.text.split(SHOWN)[:2]))


def test_the_worst_holes_come_first(plan):
    ids = [hole.hole.id for hole in worst_holes(plan)]
    infeasible = [hole.hole.id for hole in plan.holes if hole.motion is None]
    assert ids[: len(infeasible)] == infeasible
    reversing = replace(plan.holes[1], score=replace(plan.holes[1].score, reversals_per_joint=(2, 0, 0, 0, 0, 0)))
    holes = (plan.holes[0], reversing, *plan.holes[2:])
    assert worst_holes(replace(plan, holes=holes))[len(infeasible)].hole.id == reversing.hole.id


def test_many_findings_of_a_kind_are_counted_and_no_error_is_left_out():
    infos = [Finding("info", "tcp_calibration", f"by {n}", f"h{n}") for n in range(30)]
    errors = [Finding("error", "jump", f"at {n}", f"h{n}") for n in range(30)]
    said = grouped([*infos, *errors, Finding("info", "tool_turn", "over the job")])
    assert [line.level for line in said[:30]] == ["error"] * 30
    assert [(line.where, line.message) for line in said[30:]] == [
        ("hole h0", "by 0"), ("holes h1, h2, h3, h4, h5, h6 and 23 more", "likewise, 29 more of this kind"),
        ("", "over the job"),
    ]  # fmt: skip


class TestPartView:
    def test_holes_lie_where_the_part_has_them(self, plan):
        figure = part_view(plan)
        (axes,) = figure.axes
        drawn = np.vstack([np.column_stack(line.get_data()) for line in axes.lines if line.get_marker() in "oDXs"])
        places = np.array([hole.hole.target for hole in plan.holes]) * 1e3
        right, up = sorted(np.argsort(-np.ptp(places, axis=0), kind="stable")[:2])
        for place in places[:, [right, up]]:
            assert np.abs(drawn - place).sum(axis=1).min() < 1e-9

    def test_a_hole_far_away_does_not_shrink_the_others(self, plan):
        far = replace(plan.holes[-1], motion=None, score=None)
        far = replace(far, hole=replace(far.hole, target=np.array([90.0, 0, 0])))
        (axes,) = part_view(replace(plan, holes=(*plan.holes[:-1], far))).axes
        assert np.ptp(axes.get_xlim()) < 5_000
        assert "outside the picture" in " ".join(text.get_text() for text in axes.figure.legends[0].get_texts())


class TestCommand:
    def test_plan_and_check_write_the_same_page(self, tmp_path, capsys):
        plan, one, two = tmp_path / "plan.json", tmp_path / "one.html", tmp_path / "two.html"
        asked = ["plan", str(JOBS / "thesis_published.yaml"), "--proof-boxes", "0"]
        assert main([*asked, "-o", str(plan), "--report", str(one)]) == cli.FINE
        assert f"report written to {one}" in capsys.readouterr().out
        assert main(["check", str(plan), "--report", str(two)]) == cli.FINE
        assert f"report written to {two}" in capsys.readouterr().out
        assert one.read_text().replace("thesis_published.yaml, by", "plan.json, by") == two.read_text()

    def test_it_is_not_written_over_what_is_read(self, tmp_path, capsys, monkeypatch):
        job = tmp_path / "job.yaml"
        job.write_text(yaml.safe_dump({"robot": "kuka_kr6_r700_2", "tool": "thesis_drill", "holes": []}))
        assert main(["plan", str(job), "--report", str(job)]) == cli.BAD_INPUT
        assert "which is read" in capsys.readouterr().err
        assert main(["check", str(job), "--report", str(job)]) == cli.BAD_INPUT
        assert main(["plan", str(job), "--report", str(tmp_path / "no/page.html")]) == cli.BAD_INPUT
        assert "does not exist" in capsys.readouterr().err
        monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
        assert main(["plan", str(job), "--report", str(tmp_path / "page.html")]) == cli.BAD_INPUT
        assert "pip install 'zerorev[report]'" in capsys.readouterr().err
