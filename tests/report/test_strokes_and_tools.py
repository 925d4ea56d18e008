"""What is shown of holes of several strokes and of jobs of several tools: all of them, not the first one alone."""

from __future__ import annotations

import json
import re
from dataclasses import replace

import numpy as np
import pytest
from rich.console import Console

from zerorev.errors import InputError
from zerorev.model.plan import Event
from zerorev.report.figures import critical_rates, joint_angles, twist_plane, write_figures
from zerorev.report.figures.plan_report import plan_report
from zerorev.report.figures.spin import spin_profile
from zerorev.report.words import tables
from zerorev.report.words.answer import ROWS, Shown


def texts(figure):
    return [text.get_text() for legend in figure.legends for text in legend.get_texts()]


def lines(axes, label):
    return [line for line in axes.lines if line.get_label() == label]


def cells(page, tag="tr"):
    """The rows of all tables of a page, each as the texts of its cells."""
    rows = re.findall(rf"<{tag}[^>]*>(.*?)</{tag}>", page, re.S)
    return [[re.sub("<[^>]*>", "", cell) for cell in re.findall(r"<td[^>]*>(.*?)</td>", row, re.S)] for row in rows]


class TestTable:
    @staticmethod
    def rows(plan):
        with open("/dev/null", "w") as nowhere:
            console = Console(width=180, record=True, file=nowhere)
            console.print(tables.plan_table(plan))
        return [line for line in console.export_text().splitlines() if "→" in line and "baseline" not in line]

    def test_each_stroke_has_a_row_under_its_hole(self, two_tools):
        names = [re.split(r"  +\d+ →", row)[0].strip() for row in self.rows(two_tools)]
        assert names == ["a", "stroke 1, 10 mm", "stroke 2, 20 mm", "b"]

    def test_the_strokes_come_to_the_hole(self, two_tools):
        hole, *strokes = self.rows(two_tools)[:3]
        travel = [float(re.search(r"→ 0 +([\d.]+)", row)[1]) for row in (hole, *strokes)]
        assert travel[0] == pytest.approx(travel[1] + travel[2], abs=0.11)
        before = [int(re.search(r"(\d+) →", row)[1]) for row in (hole, *strokes)]
        assert before == [12, 6, 6]
        assert "2 strokes" in hole  # the spins are those of the strokes

    def test_reversals_in_the_air_stand_beside(self, two_tools):
        first, second = two_tools.holes[0].strokes
        turned = replace(two_tools.holes[0], strokes=(first, replace(second, reversals_in_air=3)))
        assert "6 → 0, 3 in the air" in self.rows(replace(two_tools, holes=(turned,)))[2]

    def test_branches_of_all_strokes_are_named(self, two_tools):
        assert tables.branch_cell(two_tools.holes[0]) == "4"
        first, second = two_tools.holes[0].strokes
        other = replace(second.answer, motion=replace(second.answer.motion, branch=2))
        assert tables.branch_cell(replace(two_tools.holes[0], strokes=(first, replace(second, answer=other)))) == "2, 4"

    def test_many_strokes_are_summarised_as_many_holes_are(self, two_tools):
        hole = two_tools.holes[0]
        few = [replace(hole, hole=replace(hole.hole, id=f"h{n}")) for n in range(ROWS // 3)]
        assert Shown(two_tools, few).table().row_count == ROWS
        more = [*few, two_tools.holes[1]]
        assert Shown(two_tools, more).table().columns[0].header.plain == "over all holes"


class TestReport:
    def test_each_tool_has_its_section(self, two_tools):
        page = plan_report(two_tools, "two.json")
        assert re.findall(r'<h1 class="tool">(.*?)</h1>', page) == ["Tool 1 of 2: tool", "Tool 2 of 2: tool"]
        first, second = page.split('<h1 class="tool">')[1:]
        assert (first.count("<img"), second.count("<img")) == (5, 5)
        assert "(100, 0, 65) mm" in first
        assert "(120, 0, 80) mm" in second
        assert [row[1] for row in cells(first) if "→" in "".join(row)] == [
            "a",
            "stroke 1",
            "stroke 2",
            "b",
        ]
        assert [row[1:5:3] for row in cells(second) if "→" in "".join(row)] == [["a", "22"], ["b", "22"]]
        assert "Joint angles of hole a along its strokes" in first
        assert "with the motions of its 2 strokes" in first

    def test_what_is_wrong_with_the_second_tool_is_at_the_top(self, two_tools):
        lost = replace(two_tools.further[0].holes[0], motion=None, score=None, verified=None)
        second = replace(two_tools.further[0], holes=(lost, two_tools.further[0].holes[1]))
        page = plan_report(replace(two_tools, further=(second,)), "two.json")
        said = [re.sub("<[^>]*>", "", each) for each in re.findall(r'<p class="verdict.*?</p>', page)]
        assert said[0].startswith("Tool 1, tool: All is well")
        assert said[1].startswith("Tool 2, tool: Something is wrong")

    def test_one_tool_has_no_headings_of_tools(self, two_tools):
        page = plan_report(replace(two_tools, further=()), "two.json")
        assert '<h1 class="tool">' not in page
        assert "<b>All is well:</b>" in page


def test_a_notebook_shows_every_tool_and_stroke(two_tools):
    page = two_tools._repr_html_()
    assert re.findall(r"KUKA KR 6 R700-2, (tool \d: tool)", page) == ["tool 1: tool", "tool 2: tool"]
    names = [row[0].strip() for row in cells(page) if row]
    assert names == ["a", "stroke 1", "stroke 2", "b", "a", "b"]
    assert page.count("<img") == 2


class TestFigures:
    def test_joint_angles_show_the_strokes_one_after_the_other(self, two_tools):
        """At the breakpoints of each stroke the joints of its motion, behind the whole path of those before."""
        hole = two_tools.holes[0]
        figure = joint_angles(two_tools, "a")
        begins = [0.0, 20.0]  # 10 mm in and out, then 20 mm
        for i, axes in enumerate(figure.axes):
            (planned,) = lines(axes, f"A{i + 1} planned")
            x, y = planned.get_data()
            assert x[-1] == pytest.approx(60)
            for start, stroke in zip(begins, hole.strokes, strict=True):
                motion = stroke.answer.motion
                expected = np.rad2deg(motion.joints[:, i])
                inside = start + motion.profile.distance * 1e3 + np.array([1e-9, 0, -1e-9])
                np.testing.assert_allclose(np.interp(inside, x, y), expected, atol=1e-3)
            assert np.isnan(y).sum() == 1  # nothing is drawn from one to the next
            marked = sorted(line.get_xdata()[0] for line in axes.lines if len(set(line.get_xdata())) == 1 < len(x))
            assert {10.0, 40.0} <= set(np.round(marked, 6))

    def test_the_baseline_turns_round_in_each_stroke(self, two_tools):
        shown = [axes.get_title("right") for axes in joint_angles(two_tools, "a").axes]
        assert shown == ["reversals 2 → 0"] * 6

    def test_the_twist_plane_has_every_stroke_where_it_turns(self, two_tools):
        figure = twist_plane(two_tools, "a")
        axes, hole = figure.axes[0], two_tools.holes[0]
        corners = [line.get_xydata()[0] for line in lines(axes, "target")]
        psi = [np.rad2deg(stroke.answer.motion.profile.psi[1]) for stroke in hole.strokes]
        np.testing.assert_allclose(corners, [[-10, psi[0]], [0, psi[1]]], atol=1e-9)
        assert axes.get_xlim() == pytest.approx((-20, 20))
        assert [text.get_text() for text in axes.texts if text.get_text() in ("1", "2")] == ["1", "2"]
        assert len(lines(axes, "plunge leg")) == len(lines(axes, "retract leg")) == 2
        assert "the planned strokes" in texts(figure)
        assert "2 strokes" in figure.texts[1].get_text()

    def test_reversals_of_each_stroke_are_marked_there(self, two_tools):
        hole = two_tools.holes[0]
        first, second = hole.strokes
        turned = replace(first.answer, score=replace(first.answer.score, events=(Event(3, "plunge", 4e-3),)))
        hole = replace(hole, strokes=(replace(first, answer=turned), second))
        axes = twist_plane(two_tools, hole).axes[0]
        (mark,) = lines(axes, "reversals")  # 4 mm above where the first stroke ends, which is 10 mm above the target
        assert mark.get_xdata() == pytest.approx([-14])
        curve = joint_angles(two_tools, hole).axes[2]
        marks = [x for line in lines(curve, "A3 reversals") for x in line.get_xdata()]
        assert pytest.approx(6) in marks

    def test_strokes_on_another_branch_are_named_not_drawn(self, two_tools):
        hole = two_tools.holes[0]
        first, second = hole.strokes
        other = replace(second.answer, motion=replace(second.answer.motion, branch=5))
        figure = twist_plane(two_tools, replace(hole, strokes=(first, replace(second, answer=other))))
        assert len(lines(figure.axes[0], "target")) == 1
        assert "on another branch: 2" in texts(figure)

    def test_the_critical_rates_at_the_target_are_those_of_the_last_stroke(self, two_tools):
        heading = [critical_rates(two_tools, name).texts[1].get_text() for name in ("a", "a, stroke 2", "a, stroke 1")]
        assert heading[0] == heading[1] != heading[2]
        assert "hole a, stroke 2" in heading[0]

    def test_a_stroke_alone_is_shown_by_its_id(self, two_tools):
        assert "hole a, stroke 1 " in twist_plane(two_tools, "a, stroke 1").texts[1].get_text()
        with pytest.raises(InputError, match="no hole 'a, stroke 3'"):
            twist_plane(two_tools, "a, stroke 3")

    def test_the_spin_alone_is_that_of_all_strokes(self, two_tools):
        hole = two_tools.holes[0]
        axes = spin_profile(hole).axes[0]
        planned = [line.get_xydata() for line in lines(axes, "planned")]
        for begins, drawn, stroke in zip((0, 20), planned, hole.strokes, strict=True):
            profile = stroke.answer.motion.profile
            np.testing.assert_allclose(drawn[:, 0], begins + profile.distance * 1e3)
            np.testing.assert_allclose(drawn[:, 1], np.rad2deg(profile.psi))

    def test_files_of_every_tool_and_stroke(self, two_tools, tmp_path):
        files = write_figures(two_tools, tmp_path, ids=["a"])
        stems = ["a_stroke_1", "a_stroke_2", "a_tool_2"]
        expected = ["a_joint_angles.png", "a_twist_plane.png"]
        expected += [
            f"{stem}_{name}.png" for stem in stems for name in ("joint_angles", "twist_plane", "critical_rates")
        ]
        assert [file.name for file in files] == expected
        assert (tmp_path / "a_tool_2_twist_plane.png").read_bytes() != (tmp_path / "a_twist_plane.png").read_bytes()


class TestReplay:
    @staticmethod
    def made(*args):
        pytest.importorskip("nicegui", reason="the replay takes three.js from NiceGUI (pip install 'zerorev[view]')")
        from zerorev.report.scene.replay import replay_page

        page = replay_page(*args)
        data = re.search(r'<script type="application/json" id="data">(.*?)</script>', page, re.S)
        return page, json.loads(data[1])

    def test_every_stroke_is_played_and_its_hole_is_one(self, two_tools):
        page, data = self.made(two_tools)
        assert [hole["id"] for hole in data["holes"]] == ["a, stroke 1", "a, stroke 2", "b"]
        assert [(hole["hole"], hole["stroke"]) for hole in data["holes"]] == [
            ("a", [1, 2]),
            ("a", [2, 2]),
            ("b", [1, 1]),
        ]
        assert data["scene"]["ids"] == ["a", "b"]
        assert "tool tool (the first of 2), 2 holes, 3 strokes</p>" in page

    def test_a_hole_or_a_single_stroke_may_be_chosen(self, two_tools):
        assert [hole["id"] for hole in self.made(two_tools, ["a"])[1]["holes"]] == ["a, stroke 1", "a, stroke 2"]
        assert [hole["id"] for hole in self.made(two_tools, ["a, stroke 2"])[1]["holes"]] == ["a, stroke 2"]

    def test_another_tool(self, two_tools):
        page, data = self.made(two_tools.further[0])
        assert [hole["id"] for hole in data["holes"]] == ["a", "b"]
        assert data["arm"]["tip"] == [120, 0, 80]
        assert "tool tool, 2 holes</p>" in page
