"""What stands around the arm, in the page: the zone of the map, the least clearance, bodies and nearest points."""

from __future__ import annotations

import time

import numpy as np
import pytest

from oracles.page_moves import DRAWN, MOVES
from oracles.places import ROOT
from zerorev.files.io import read_job
from zerorev.model.arm_bodies import bodies_of
from zerorev.model.plan import Plan
from zerorev.model.profile import Profile
from zerorev.motion.drilling import Drilling
from zerorev.motion.evaluation import evaluated
from zerorev.planning.clearance import clearance_of
from zerorev.planning.hole import plan
from zerorev.report.scene.clearance import clearance_zone
from zerorev.report.scene.replay import replay_page

pytestmark = pytest.mark.xdist_group("browser")
expect = pytest.importorskip("playwright.sync_api", reason="the tests in a browser need playwright").expect

JOB = ROOT / "examples" / "jobs" / "panel_clamped" / "job.yaml"
CELL = "document.querySelector('[data-testid=\"cell\"], #cell').cell"


@pytest.fixture(scope="module")
def job():
    return read_job(JOB)


@pytest.fixture(scope="module")
def planned(job):
    return plan(job.robot, job.tool, job.holes[0], job.settings)


@pytest.fixture(scope="module")
def server(serve):
    return serve(JOB)


@pytest.fixture
def page(open_page, server):
    """The first hole, planned, and drawn to its last piece."""
    page = open_page(server)
    expect(page.get_by_test_id("reversals")).to_have_text("0", timeout=120_000)
    expect(page.get_by_test_id("clearance")).not_to_have_text("–", timeout=120_000)
    expect(page.get_by_test_id("curves")).to_contain_text("→ 0")
    until(page, f"{CELL}?.line?.near")
    return page


def until(page, expression, patience=60.0):
    end = time.monotonic() + patience
    while not page.evaluate(f"Boolean({expression})"):
        assert time.monotonic() < end, f"never true: {expression}"
        page.wait_for_timeout(50)


def spins(page):
    """Spins [deg] at start, target and end, as the handles state them."""
    return [
        float(page.get_by_test_id(f"handle-{name}").get_attribute("aria-valuenow"))
        for name in ("start", "target", "end")
    ]


def least(job, hole, planned, psi_deg):
    """What the library says of the least clearance of a hole with these spins."""
    drilling = Drilling.of(job, hole)
    profile = Profile.straight(hole.depth, *np.deg2rad(psi_deg).tolist())
    motion = evaluated(drilling, profile, planned.motion.branch, job.settings).motion
    return clearance_of(drilling, job.settings, motion)


def shows(page, wanted):
    """Wait until the page shows a least clearance, of spins that the handles state to hundredths of a degree."""
    text = "document.querySelector('[data-testid=\"clearance\"]').textContent"
    until(page, f"Math.abs(Number({text}.replace('−', '-')) - {wanted.least * 1e3}) < 0.06")
    expect(page.get_by_test_id("clearance-between")).to_have_text(" – ".join(wanted.between))


def test_the_map_shows_where_the_clearance_is_not_kept(page, job, planned):
    zone, switch = page.get_by_test_id("tight"), page.get_by_test_id("clearance-zone")
    expect(zone).to_have_count(1)
    expect(switch).to_have_attribute("aria-pressed", "true")
    legend = page.locator(".zr-tw-legend")
    expect(legend).to_contain_text("nearer than 2 mm to part, fixtures or itself")
    found = clearance_zone(Drilling.of(job, job.holes[0]), job.settings, planned.motion.branch)
    # each outline on either side of the target, in every turn of which some is shown
    drawn = zone.get_attribute("d").count("M")
    assert drawn % (2 * len(found.region.rings)) == 0 < drawn
    box = page.locator(".zr-tw-frame").bounding_box()
    s, p = np.argwhere(found.near)[5]  # at the target
    assert s == 0
    y = box["y"] + (0.5 - np.rad2deg(found.psi[p]) / 360) * box["height"]
    page.mouse.move(box["x"] + box["width"] / 2, y)
    expect(page.get_by_test_id("readout")).to_contain_text("too near")
    page.mouse.move(5, 5)
    switch.click()
    expect(zone).to_have_count(0)
    expect(legend).not_to_contain_text("nearer than 2 mm")
    switch.click()
    expect(zone).to_have_count(1)
    page.get_by_test_id("branch").select_option("all")  # it is of one branch
    expect(switch).to_have_count(0)
    expect(zone).to_have_count(0)


def test_the_least_clearance_of_the_plan_and_of_a_motion_by_hand(page, job):
    hole = job.holes[5]
    planned = plan(job.robot, job.tool, hole, job.settings)
    page.evaluate(f"{CELL}.on.pickHole('{hole.id}')")
    expect(page.get_by_test_id("page")).to_contain_text("hole 6 of 20")
    expect(page.get_by_test_id("clearance")).to_have_text(f"{planned.clearance.least * 1e3:.2f}", timeout=120_000)
    expect(page.get_by_test_id("clearance-between")).to_have_text(" – ".join(planned.clearance.between))
    expect(page.get_by_test_id("nearest-mark")).to_be_visible()
    top = page.locator(".zr-tw-plot").bounding_box()
    page.get_by_test_id("handle-target").focus()
    for presses, touches in ((2, False), (4, True)):
        for _ in range(presses):
            page.keyboard.press("Shift+PageDown")
        expect(page.get_by_test_id("keep-this-motion")).to_be_visible()
        wanted = least(job, hole, planned, spins(page))
        assert (wanted.least < 0) == touches
        shows(page, wanted)
        row = page.get_by_test_id("nearest")
        expect(row).to_have_class("zr-tw-least low" if touches else "zr-tw-least")
    expect(page.get_by_test_id("why")).to_contain_text(f"the {wanted.between[0]} touches {wanted.between[1]}")
    assert page.locator(".zr-tw-plot").bounding_box() == top, "words that come and go have moved the map"
    page.get_by_test_id("clearance-where").click()  # the robot is shown there
    until(page, f"{CELL}.line.near.low && {CELL}.line.near.apart < 0.01")
    label = page.locator(".zrc-nearest:visible")
    expect(label).to_have_text(f"{wanted.between[0]} – {wanted.between[1]}: they touch")


def test_a_drag_is_answered_while_the_clearance_is_computed(page, job, planned, say):
    page.evaluate(DRAWN)
    first, _, last = spins(page)
    grips = [
        page.get_by_test_id(f"handle-{name}").locator("circle").bounding_box() for name in ("start", "target", "end")
    ]
    scale = (grips[2]["y"] - grips[0]["y"]) / (last - first)
    x, y = (grips[1][side] + grips[1][size] / 2 for side, size in (("x", "width"), ("y", "height")))
    page.mouse.move(x, y)
    page.mouse.down()
    page.evaluate(MOVES, [x, y, 15 * scale, 150])
    page.wait_for_function("window.drawn.length > 0")
    page.mouse.up()
    expect(page.get_by_test_id("keep-this-motion")).to_be_visible()
    wanted = least(job, job.holes[0], planned, spins(page))
    shows(page, wanted)
    times = [each["ms"] for each in page.evaluate("window.drawn")]
    half, most = np.percentile(times, (50, 95))
    say(f"pointer to drawn clearance, panel_clamped: {half:.0f} ms half of them, {most:.0f} ms 95 % of {len(times)}")


def test_the_cell_shows_part_fixtures_bodies_and_nearest_points(page, job):
    names = page.evaluate(f"{CELL}.around.root.children.map((solid) => solid.name)")
    assert names == ["part", "left clamp", "right clamp"]
    assert page.evaluate(f"{CELL}.holesData.plates") == []  # the part is there itself
    bodies = [body.id for body in bodies_of(job.robot, job.tool)]
    assert page.evaluate(f"{CELL}.around.bodies.map((body) => body.name)") == bodies
    switch = page.get_by_test_id("cell-bodies")
    shown = f"{CELL}.around.bodies.every((body) => body.visible)"
    expect(switch).to_have_attribute("aria-pressed", "false")
    assert not page.evaluate(f"{CELL}.around.bodies.some((body) => body.visible)")
    switch.click()
    expect(switch).to_have_attribute("aria-pressed", "true")
    assert page.evaluate(shown)
    clamp = np.array(
        page.evaluate(f"{CELL}.scene.updateMatrixWorld(true) ?? {CELL}.around.root.children[1].matrixWorld.elements")
    )
    assert clamp.reshape(4, 4).T[:3, 3] == pytest.approx(
        job.settings.surroundings.obstacles[1].T_base[:3, 3] * 1e3, abs=1e-3
    )
    # the line is as long as it says
    near = page.evaluate(f"{CELL}.line.near")
    points = np.array(near["points"]).reshape(2, 3)
    assert np.linalg.norm(points[0] - points[1]) == pytest.approx(near["apart"], abs=0.2)
    page.get_by_test_id("theme").click()  # drawn again, in other colours
    page.get_by_test_id("theme").click()
    assert page.evaluate(shown)
    assert page.evaluate(f"{CELL}.around.root.children.length") == 3
    page.get_by_test_id("hole-next").click()
    expect(page.get_by_test_id("reversals")).to_have_text("0", timeout=120_000)
    until(page, f"{CELL}.hole === '{job.holes[1].id}' && {CELL}.line.near")


def test_the_replay_shows_the_same(browser, job, planned, tmp_path):
    file = tmp_path / "replay.html"
    file.write_text(replay_page(Plan(job.robot, job.tool, job.settings, (planned,), T_base_part=job.T_base_part)))
    context = browser.new_context(offline=True, reduced_motion="reduce")
    page = context.new_page()
    page.goto(file.as_uri())
    expect(page.get_by_test_id("replay-verdict")).to_be_visible()
    until(page, f"{CELL}.line.near")
    assert page.evaluate(f"{CELL}.around.root.children.length") == 3
    expect(page.get_by_test_id("cell-bodies")).to_be_visible()
    assert page.evaluate(f"Math.min(...{CELL}.track.nearest.apart)") == pytest.approx(
        planned.clearance.least * 1e3, abs=0.05
    )
    expect(page.locator("#figures")).to_contain_text(f"{planned.clearance.least * 1e3:.2f}")
    context.close()
