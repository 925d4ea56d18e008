"""The page in windows of every size: map and robot in sight together, no text cut, nothing over the drill."""

from __future__ import annotations

import pytest

from oracles.page_looks import CUT
from oracles.places import ROOT

pytestmark = pytest.mark.xdist_group("browser")
expect = pytest.importorskip("playwright.sync_api", reason="the tests in a browser need playwright").expect

SIZES = ((1280, 800), (1024, 768), (1920, 1080), (1024, 640))  # [px]; the last one is 1280 x 800 at a zoom of 125 %
LONG = """\
name: Left wing panel 7, lower skin, stringer side
robot: kuka_kr6_r700_2
tool: thesis_drill
psi_reference: base_y
min_rate_deg_per_mm: 0.01
objective: {travel: 1, margin: 0.5, limit_distance: 0.25}
holes:
  - id: panel_07_lower_skin_stringer_12_rivet_0001
    target_mm: [500.123456, -300.654321, 800.111111]
    direction: [0.99, -0.1234567, 0.05]
    depth_mm: 50
  - id: panel_07_lower_skin_stringer_12_rivet_0002
    target_mm: [-1200.123456, -1400.654321, -1600.111111]
    direction: [-0.1234567, -0.1234567, -0.9876543]
    depth_mm: 20
"""
CELL = "document.querySelector('[data-testid=\"cell\"]').cell"

# what of the map and of the robot is not in the window
OUT_OF_SIGHT = """() => [".zr-tw-plot", '[data-testid="cell-canvas"]', '[data-testid="cell-legend"]'].filter((name) => {
    const box = document.querySelector(name).getBoundingClientRect();
    const least = name.includes("legend") ? 10 : 150;
    return box.top < 0 || box.left < 0 || box.bottom > innerHeight || box.right > innerWidth || box.height < least;
})"""
# what lies over the drill, or over a hole
COVERED = f"""() => {{
    const cell = {CELL}, canvas = cell.canvas.getBoundingClientRect();
    cell.camera.updateMatrixWorld();
    const cards = [...document.querySelectorAll(".zrc-card:not([hidden])")].map((card) => card.getBoundingClientRect());
    return cell.holes.ids.filter((id, i) => cell.arm && cards.some((card) => {{
        const at = cell.holes.at(i, 0, cell.camera.position.clone()).project(cell.camera);
        const x = canvas.left + ((at.x + 1) / 2) * canvas.width, y = canvas.top + ((1 - at.y) / 2) * canvas.height;
        return x > card.left && x < card.right && y > card.top && y < card.bottom;
    }}));
}}"""
# names of controls that are not there to be read
NAMES = ("Constant spin", "View", "Speed", "branch")
UNNAMED = """names => names.filter((name) => ![...document.querySelectorAll(".zrc-name, .zr-tw-tools label")].some(
    (each) => each.textContent.trim().startsWith(name) && each.checkVisibility({ visibilityProperty: true })))"""
SETTLED = "() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(done, 250))))"


def in_every_size(page):
    for width, height in SIZES:
        page.set_viewport_size({"width": width, "height": height})
        for scheme in ("light", "dark"):
            page.emulate_media(color_scheme=scheme, reduced_motion="reduce")
            page.evaluate("window.scrollTo(0, 0)")
            page.evaluate(SETTLED)
            where = f"{width} x {height}, {scheme}"
            assert page.evaluate(CUT) == [], where
            assert page.evaluate(UNNAMED, NAMES) == [], where
            assert page.evaluate(OUT_OF_SIGHT) == [], where
            assert page.evaluate("document.documentElement.scrollWidth <= innerWidth"), where
        page.get_by_test_id("cell-camera-iso").click()
        assert page.evaluate(COVERED) == [], where
    page.get_by_test_id("cell-baseline-side").click()  # in the smallest
    expect(page.locator(".zrc-caption").first).to_have_text("planned: 0 reversals")
    page.evaluate(SETTLED)
    assert page.evaluate(CUT) == []
    readout, half = (page.locator(name).bounding_box() for name in (".zrc-readout", ".zrc-stage"))
    assert readout["height"] < 0.25 * half["height"], "it hides one of the two robots"
    page.get_by_test_id("cell-baseline-off").click()


def is_drawn(page, hole):
    expect(page.get_by_test_id("page")).to_contain_text(hole)
    expect(page.get_by_test_id("reversals")).to_have_text("0", timeout=120_000)
    expect(page.get_by_test_id("curves")).to_contain_text("→ 0")
    expect(page.get_by_test_id("map-cover")).to_be_hidden()
    expect(page.get_by_test_id("holes").get_by_text(hole)).to_be_visible()
    page.wait_for_function(f"() => {CELL}.track")


def test_nothing_is_cut_where_something_stands_around(serve, open_page):
    page = open_page(serve(ROOT / "examples" / "jobs" / "panel_clamped" / "job.yaml"))
    expect(page.get_by_test_id("clearance")).to_have_text("45.27", timeout=120_000)
    is_drawn(page, "R0C0")
    in_every_size(page)


def test_nothing_is_cut_nor_hidden_in_any_size(demo_page, tmp_path):
    page = demo_page
    is_drawn(page, "position_1")
    in_every_size(page)

    (tmp_path / "long.yaml").write_text(LONG)
    page.locator('input[type="file"]').first.set_input_files(tmp_path / "long.yaml")
    is_drawn(page, "panel_07_lower_skin_stringer_12_rivet_0001")
    in_every_size(page)

    page.get_by_test_id("cell-baseline-side").click()
    page.get_by_test_id("hole-next").click()  # which is out of reach
    expect(page.locator(".zrc-caption").first).to_have_text("planned: no motion", timeout=120_000)
    page.get_by_test_id("hole-before").click()
    page.get_by_test_id("cell-baseline-off").click()
    expect(page.get_by_test_id("reversals")).to_have_text("0")
    page.evaluate(SETTLED)

    top = page.locator(".zr-tw-plot").bounding_box()  # at 1024 x 640
    page.get_by_test_id("handle-target").focus()
    for _ in range(4):
        page.keyboard.press("Shift+ArrowDown")
    expect(page.get_by_test_id("keep-this-motion")).to_be_visible()
    expect(page.get_by_test_id("why")).not_to_be_empty()
    assert page.evaluate(CUT) == []
    assert page.locator(".zr-tw-plot").bounding_box() == top, "the map moves while it is dragged on"

    for button, name in (("settings", "settings-form"), ("edit-hole", "hole-form")):
        page.get_by_test_id(button).click()
        expect(page.get_by_test_id(name)).to_be_visible()
        for width, height in SIZES:
            page.set_viewport_size({"width": width, "height": height})
            page.evaluate(SETTLED)
            assert page.evaluate(CUT) == [], (name, width)
        page.get_by_test_id(name).get_by_test_id("form-cancel").click()
        expect(page.get_by_test_id(name)).to_be_hidden()
