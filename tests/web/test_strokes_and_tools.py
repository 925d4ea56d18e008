"""Holes of several strokes and jobs of several tools in the page: all of them can be chosen, seen and taken away."""

from __future__ import annotations

import json
import time
from dataclasses import replace

import numpy as np
import pytest
import yaml

from zerorev.errors import InputError
from zerorev.files.io import job_from_dict, plan_to_json
from zerorev.planning.job import plan_job
from zerorev.web import files
from zerorev.web.job_edits import answered, with_hole, with_holes, with_settings, without_hole
from zerorev.web.of_tools import tool_names, whole_plan, with_tool
from zerorev.web.session import Session
from zerorev.web.state import (
    opened_job,
    opened_plan,
    plan_of,
    selected,
    shown,
    shown_stroke,
    steered,
    with_stroke,
)

DRILL = {"tcp_mm": [100, 0, 65], "rpy_deg": [0, -90, 0]}
PECKS = {
    "format": "zerorev.job/1",
    "name": "pecks",
    "robot": "kuka_kr6_r700_2",
    "tool": DRILL,
    "proof_boxes": 0,
    "cycle": {"kind": "peck", "depth_mm": 10},
    "holes": [
        {"id": "a", "target_mm": [500, 300, 800], "direction": [1, 0, 0], "depth_mm": 20},
        {"id": "b", "target_mm": [500, 340, 800], "direction": [1, 0, 0], "depth_mm": 8},
    ],
}
TOOLS = {key: value for key, value in PECKS.items() if key not in ("tool", "cycle")} | {
    "name": "two",
    "tools": [
        {"tool": DRILL, "tool_number": 2},
        {"tool": {"tcp_mm": [120, 0, 80], "rpy_deg": [0, -90, 0]}, "tool_number": 3, "depth_mm": 22},
    ],
}
CELL = "document.querySelector('[data-testid=\"cell\"]').cell"


def until(page, expression, patience=30.0):
    end = time.monotonic() + patience
    while not page.evaluate(expression):
        assert time.monotonic() < end, f"never true: {expression}"
        page.wait_for_timeout(50)


class TestStrokes:
    @pytest.fixture(scope="class")
    @classmethod
    def plan(cls):
        return plan_job(job_from_dict(PECKS))

    def test_the_motion_that_is_shown_is_that_of_the_chosen_stroke(self, plan):
        state = opened_plan(plan)
        for number, stroke in enumerate(plan.holes[0].strokes):
            chosen = with_stroke(state, number)
            motion, own = shown(chosen), stroke.answer.motion.profile
            np.testing.assert_allclose(motion.profile.psi, own.psi)
            up = plan.holes[0].hole.depth - stroke.answer.hole.depth  # its stand-offs count from the hole's target
            np.testing.assert_allclose(motion.profile.standoff, own.standoff + up)
            assert shown_stroke(chosen) is stroke.answer

    def test_another_hole_begins_with_its_first_stroke_and_an_edit_is_let_go(self, plan):
        state = with_stroke(opened_plan(plan), 1)
        assert selected(state, "b").stroke == 0
        edited = steered(state, shown(state))
        assert with_stroke(edited, 0).steered is None
        assert with_stroke(edited, 1) is edited

    def test_fewer_strokes_than_before_show_the_last(self, plan):
        state = with_stroke(opened_plan(plan), 5)
        assert shown_stroke(state) is plan.holes[0].strokes[-1].answer

    def test_a_stroke_is_chosen_and_every_picture_follows(self, serve, open_page, plan, tmp_path):
        job = tmp_path / "pecks.yaml"
        job.write_text(yaml.safe_dump(PECKS))
        page = open_page(serve(job))
        choice = page.get_by_test_id("stroke")
        choice.wait_for()
        page.get_by_test_id("cell-canvas").wait_for()
        until(page, f"Boolean({CELL}?.track)")
        ends = [np.rad2deg(stroke.answer.motion.profile.psi[-1]) for stroke in plan.holes[0].strokes]
        end = f"{CELL}.track.at({CELL}.track.end).psi"
        until(page, f"Math.abs({end} - {ends[0]}) < 1e-3")
        choice.click()
        page.get_by_role("option", name="stroke 2, 20 mm").click()
        until(page, f"Math.abs({end} - {ends[1]}) < 1e-3")
        assert page.evaluate(f"{CELL}.track.end") == pytest.approx(20)
        page.get_by_test_id("handle-target").press("ArrowUp")
        page.get_by_text("the hole is drilled in 2 strokes: one by hand cannot be kept").wait_for()
        assert page.get_by_test_id("keep-this-motion").is_hidden()
        page.get_by_test_id("hole-next").click()  # drilled in one
        choice.wait_for(state="hidden")


class TestTools:
    @pytest.fixture(scope="class")
    @classmethod
    def job(cls):
        return job_from_dict(TOOLS)

    @pytest.fixture(scope="class")
    @classmethod
    def plan(cls, job):
        return plan_job(job)

    def test_each_tool_has_its_own_answers_and_the_hole_stays_selected(self, plan):
        first = selected(opened_plan(plan), "b")
        assert (first.tool, tool_names(first)) == (0, ["tool 1: tool", "tool 2: tool"])
        second = with_tool(first, 1)
        assert (second.selected, second.hole.depth) == ("b", 0.022)
        assert second.answer is plan.further[0].holes[1]
        assert second.job.settings.tool_number == 3
        assert with_tool(second, 0).answer is first.answer
        assert with_tool(second, 1) is second
        with pytest.raises(InputError, match=r"no tool 3 \(accepted: 1 to 2\)"):
            with_tool(second, 2)

    def test_what_is_found_for_one_tool_is_kept_while_another_is_shown(self, job, plan):
        state = answered(opened_job(job), *plan.holes)
        second = with_tool(state, 1)
        assert second.answers == {}
        back = with_tool(answered(second, *plan.further[0].holes), 0)
        assert back.answers == state.answers
        assert with_tool(back, 1).answers.keys() == {"a", "b"}

    def test_the_plan_taken_away_is_the_plan_of_the_command_line(self, plan):
        state = with_tool(opened_plan(plan), 1)
        made = json.loads(b"".join(files.plan_written(files.pieces(whole_plan(state)))))
        assert made == plan_to_json(plan)

    def test_the_program_is_that_of_the_tool_that_is_shown(self, plan):
        second = plan_of(with_tool(opened_plan(plan), 1))
        assert (second.name, second.settings.tool_number, second.further) == ("two_tool_2", 3, ())

    def test_a_plan_needs_a_hole_of_every_tool_and_says_which_are_missing(self, job, plan):
        state = answered(opened_job(job), *plan.holes)
        with pytest.raises(InputError, match="nothing is planned for tool 2 yet"):
            whole_plan(state)
        state = answered(with_tool(state, 1), plan.further[0].holes[1])
        made = whole_plan(state)
        assert [[hole.hole.id for hole in each.holes] for each in made.of_all_tools] == [["b"], ["b"]]
        missing = [each.message for tool in made.of_all_tools for each in tool.findings if each.kind == "unfinished"]
        assert missing == ["only 1 of 2 holes planned; missing: hole a"] * 2
        with pytest.raises(InputError, match="no hole is planned for all tools"):
            whole_plan(replace(state, answers={"a": plan.further[0].holes[0]}, tools=(
                replace(state.tools[0], answers={"b": plan.holes[1]}), state.tools[1])))  # fmt: skip

    def test_holes_that_several_tools_drill_are_not_changed_for_one(self, plan):
        state = opened_plan(plan)
        hole = state.hole
        for change in (
            lambda: with_hole(state, replace(hole, depth=0.015), hole.id),
            lambda: with_hole(state, replace(hole, id="c")),
            lambda: with_holes(state, [replace(hole, id="c")]),
            lambda: without_hole(state, "a"),
        ):
            with pytest.raises(InputError, match="its holes are those of 2 tools"):
                change()
        assert with_hole(state, replace(hole, branch=2), hole.id).hole.branch == 2

    def test_no_step_leads_back_to_another_tool(self, plan):
        session = Session(opened_plan(plan))
        session.change(with_settings(session.state, replace(session.state.job.settings, min_rate=0.0)))
        assert session.can_undo
        session.start_over(with_tool(session.state, 1))
        assert not session.can_undo
        assert with_tool(session.state, 0).job.settings.min_rate == 0.0

    def test_from_the_job_to_a_program_for_each_tool(self, serve, open_page, plan, tmp_path):
        job = tmp_path / "two.yaml"
        job.write_text(yaml.safe_dump(TOOLS))
        page = open_page(serve(job))
        choice = page.get_by_test_id("tool")
        choice.wait_for()
        page.get_by_test_id("cell-canvas").wait_for()
        until(page, f"Boolean({CELL}?.track)")
        tip = f"{CELL}.data.tip"
        assert page.evaluate(tip) == [100, 0, 65]

        def plan_all():
            page.get_by_test_id("scope").get_by_text("All holes").click()
            page.get_by_test_id("plan").click()
            until(page, f"{CELL}.holes.reversals.join() === '0,0'")
            page.get_by_test_id("progress").wait_for(state="hidden")

        def program():
            page.get_by_test_id("download").click()
            page.get_by_test_id("download-program").click()
            with page.expect_download() as taken:
                page.get_by_test_id("save-program").click()
            return taken.value.suggested_filename, taken.value.path().read_text()

        plan_all()
        name, text = program()
        assert name == "two.src"
        assert "$ACT_TOOL=2" in text
        choice.click()
        page.get_by_role("option", name="tool 2: tool").click()
        until(page, f"{tip}[0] === 120 && Boolean({CELL}?.track)")
        assert page.evaluate(f"{CELL}.track.end") == pytest.approx(22)
        plan_all()
        name, text = program()
        assert name == "two_tool_2.src"
        assert "$ACT_TOOL=3" in text
        page.get_by_test_id("download").click()
        with page.expect_download() as taken:
            page.get_by_test_id("download-plan").click()
        assert json.loads(taken.value.path().read_text()) == plan_to_json(plan)
        page.get_by_test_id("add-hole").click()
        page.get_by_text("its holes are those of 2 tools").wait_for()
