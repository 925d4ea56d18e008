"""The panel "on a real arm" as a user meets it: asked, simulated, out of date, and with a cell file."""

from __future__ import annotations

import re
from dataclasses import replace

import pytest

from oracles.page_looks import CUT, FAINT
from zerorev.files.cell_file import cell_text
from zerorev.files.yaml_text import yaml_text
from zerorev.model.ranges import RANGES, Cell

pytestmark = pytest.mark.xdist_group("browser")
expect = pytest.importorskip("playwright.sync_api", reason="the tests in a browser need playwright").expect

SIZES = ((1920, 1080), (1280, 800), (1024, 768))
SETTLED = "() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(done, 250))))"
# how many curves of a chart are drawn
CURVES = (
    """(name) => document.querySelectorAll(`[data-testid="${name}"] svg path[stroke-width="2"][fill="none"]`).length"""
)


def test_a_motion_is_simulated_and_says_when_it_is_out_of_date(demo_page, tmp_path):
    page = demo_page
    expect(page.get_by_test_id("reversals")).to_have_text("0", timeout=120_000)
    expect(page.get_by_test_id("arm-stands")).to_contain_text("Not simulated yet")
    expect(page.get_by_test_id("arm-lost")).to_have_text(re.compile(r"^0\.\d{3} mm$"))
    expect(page.get_by_test_id("arm-lost")).to_have_text(page.get_by_test_id("lost").text_content() + " mm")

    page.get_by_test_id("arm-arms").fill("0")
    page.get_by_test_id("simulate").click()
    expect(page.locator(".zr-arm")).to_contain_text("a whole number from 1 to 1,000")
    page.get_by_test_id("arm-arms").fill("4")
    page.get_by_test_id("arm-feed").fill("100")
    page.get_by_test_id("arm-thrust").fill("50")
    expect(page.get_by_test_id("arm-lost")).to_contain_text("with 50 N")
    page.get_by_test_id("simulate").click()
    expect(page.get_by_test_id("arm-stands")).to_have_text("4 arms, seed 0, 100 mm/s, thrust 50 N.", timeout=120_000)
    expect(page.get_by_test_id("arm-figures")).to_contain_text("at the tool [mm]")
    expect(page.get_by_test_id("arm-notes")).to_contain_text("With 50 N of thrust on a free tip")
    page.wait_for_function(f"() => ({CURVES})('arm-stray') >= 4 && ({CURVES})('arm-torques') >= 12")

    lost = page.get_by_test_id("arm-lost").text_content()
    page.get_by_test_id("handle-target").focus()
    page.keyboard.press("Shift+ArrowDown")
    expect(page.get_by_test_id("arm-stands")).to_contain_text("Out of date: the motion has changed since.")
    expect(page.get_by_test_id("arm-lost")).not_to_have_text(lost)
    for width, height in SIZES:
        page.set_viewport_size({"width": width, "height": height})
        for scheme in ("light", "dark"):
            page.emulate_media(color_scheme=scheme, reduced_motion="reduce")
            page.evaluate(SETTLED)
            assert page.evaluate(CUT) == [], (width, scheme)
            assert page.evaluate(FAINT) == [], (width, scheme)
            assert page.evaluate("document.documentElement.scrollWidth <= innerWidth"), (width, scheme)

    page.get_by_test_id("let-go").click()
    expect(page.get_by_test_id("arm-stands")).to_have_text("4 arms, seed 0, 100 mm/s, thrust 50 N.")
    page.reload()
    expect(page.get_by_test_id("arm-figures")).to_contain_text("at the tool [mm]", timeout=60_000)


@pytest.mark.long
def test_a_cell_file_is_opened_or_says_what_is_wrong_with_it(demo_page, tmp_path):
    page = demo_page
    upload = page.locator(".zr-arm-file input[type=file]")
    expect(page.get_by_test_id("arm-file")).to_contain_text("no cell file", timeout=120_000)
    fitted = Cell({"friction": replace(RANGES["friction"], low=0.9, high=1.1, basis="fitted")})
    (tmp_path / "mine.yaml").write_text(cell_text(fitted))
    upload.set_input_files(tmp_path / "mine.yaml")
    expect(page.get_by_test_id("arm-file")).to_have_text("mine.yaml")
    expect(page.get_by_test_id("arm-notes")).to_contain_text("Fitted to recordings: friction.")
    page.get_by_test_id("arm-ranges").click()
    expect(page.get_by_test_id("arm-ranges-form").locator("tbody tr").first).to_contain_text("fitted to recordings")
    page.evaluate(SETTLED)
    assert page.evaluate(CUT) == []
    page.get_by_test_id("arm-ranges-close").click()

    unordered = "format: zerorev.cell/1\nparameters: {friction: {nominal: 1, low: 2, high: 3}}\n"
    for name, content, why in (
        ("other.yaml", cell_text(Cell(robot="yaskawa_gp8")), "is of the robot yaskawa_gp8"),
        ("wrong.yaml", unordered, "are not a range"),
        ("bytes.yaml", b"\xff\xfe\xfd", "is not text"),
    ):
        (tmp_path / name).write_bytes(content if isinstance(content, bytes) else content.encode())
        upload.set_input_files(tmp_path / name)
        expect(page.locator(".q-notification", has_text=why)).to_be_visible()
        expect(page.get_by_test_id("arm-file")).to_have_text("mine.yaml")
    page.get_by_test_id("arm-away").click()
    expect(page.get_by_test_id("arm-file")).to_contain_text("no cell file")


@pytest.mark.long
def test_a_robot_without_masses_says_what_is_missing(serve, open_page, tmp_path):
    hole = {"id": "only", "target_mm": [700, 0, 600], "direction": [1, 0, 0], "depth_mm": 20}
    data = {"robot": "yaskawa_gp8", "tool": {"tcp_mm": [100, 0, 65], "rpy_deg": [0, -90, 0]}, "holes": [hole]}
    (tmp_path / "bare.yaml").write_text(yaml_text(data))
    page = open_page(serve(tmp_path / "bare.yaml"))
    missing = page.get_by_test_id("arm-missing")
    expect(missing).to_contain_text("The masses of the robot yaskawa_gp8 are not known", timeout=60_000)
    expect(missing).to_contain_text("under dynamics")
    expect(page.get_by_test_id("simulate")).to_have_count(0)
