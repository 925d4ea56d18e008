"""The cell in the page: what the state has is shown; what is clicked goes to the state and the other views."""

from __future__ import annotations

import time

import pytest

CELL = "document.querySelector('[data-testid=\"cell\"]').cell"


def until(page, expression, patience=30.0):
    end = time.monotonic() + patience
    while not page.evaluate(expression):
        assert time.monotonic() < end, f"never true: {expression}"
        page.wait_for_timeout(50)


@pytest.fixture
def page(demo_page):
    demo_page.get_by_test_id("cell-canvas").wait_for()
    until(demo_page, f"Boolean({CELL}?.track)")  # the first hole is planned on its own
    return demo_page


def test_the_holes_and_the_motion_of_the_first_are_shown(page):
    assert page.evaluate(f"{CELL}.holes.ids.length") == 3
    assert page.evaluate(f"{CELL}.holes.selected") == 0
    assert page.evaluate(f"{CELL}.track.reversals") == 0
    until(page, f"{CELL}.holes.reversals[0] === 0")
    assert "0 reversals: 1 hole" in page.get_by_test_id("cell-legend").inner_text()


def test_an_answer_recolours_the_hole_and_builds_none_again(page):
    page.evaluate(f"window.holes = {CELL}.holes")
    page.get_by_test_id("hole-next").click()
    until(page, f"{CELL}.holes.reversals[1] === 0")
    assert page.evaluate(f"{CELL}.holes === window.holes")
    first, second, third = (f"{CELL}.holes.bodies[0].colour({n}).getHex()" for n in range(3))
    assert page.evaluate(f"{first} === {second}")
    assert page.evaluate(f"{second} !== {third}")
    assert "0 reversals: 2 holes" in page.get_by_test_id("cell-legend").inner_text()
    page.get_by_test_id("hole-before").click()
    until(page, f"{CELL}.holes.selected === 0")


def test_a_picked_hole_is_selected_everywhere(page):
    name = page.evaluate(f"{CELL}.holes.ids[1]")
    page.evaluate(f"{CELL}.on.pickHole({CELL}.holes.ids[1])")
    until(page, f"{CELL}.holes.selected === 1 && {CELL}.hole === '{name}' && Boolean({CELL}.track)")
    page.locator(".zr-summary", has_text=name).wait_for()
    page.evaluate(f"{CELL}.on.pickHole('no such hole')")  # as after a hole was taken out meanwhile
    page.evaluate(f"{CELL}.on.pickHole({CELL}.holes.ids[0])")
    until(page, f"{CELL}.holes.selected === 0")


def test_a_steered_motion_is_followed(page):
    before = page.evaluate(f"{CELL}.track.at(0).psi")
    handle = page.get_by_test_id("handle-target")
    handle.focus()
    for _ in range(3):
        handle.press("ArrowUp")
    until(page, f"Math.abs({CELL}.track.at(0).psi - {before}) > 0.05")
    held = page.evaluate(f"{CELL}.held.at(0).psi")  # the baseline is as it was
    assert held == pytest.approx(page.evaluate(f"{CELL}.track.at({CELL}.track.start).psi"), abs=1e-4)
