"""Holes of several strokes and jobs of several tools in the page: all of them can be chosen, seen and taken away."""

from __future__ import annotations

import time

import numpy as np
import pytest
import yaml

from zerorev.files.io import job_from_dict
from zerorev.planning.job import plan_job
from zerorev.web.state import opened_plan, selected, shown, shown_stroke, steered, with_stroke

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
