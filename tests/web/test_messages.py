"""What the page says of what was done: in full, and in letters that stand out from their ground, light and dark."""

from __future__ import annotations

import json

import pytest

from oracles.page_looks import FAINT

pytestmark = pytest.mark.xdist_group("browser")
expect = pytest.importorskip("playwright.sync_api", reason="the tests in a browser need playwright").expect

# messages for which something would have to break
BROKEN = """() => {
    const trouble = document.querySelector('[data-testid="trouble"]');
    trouble.classList.remove("hidden");
    trouble.children[1].textContent = "a fault in zerorev itself; the terminal says more";
    const others = { "zr-none": "This could not be drawn", "zr-map-error": "is not a number" };
    for (const [look, words] of Object.entries(others)) {
        const made = document.createElement("div");
        made.className = look;
        made.textContent = words;
        document.querySelector(".zr-cell").append(made);
    }
    document.querySelector(".zr-findings").innerHTML = ["error", "warning", "info"].map((level) =>
        `<p><span class="zr-level zr-${level}">!</span>why</p><p class="zr-${level}">why</p>`).join("");
    window.zerorevEnded();
    document.getElementById("popup").style.display = "";
    document.getElementById("popup").setAttribute("aria-hidden", "false");
}"""
GONE = """() => {
    const made = document.createElement("div");
    made.className = "zr-broken";
    made.textContent = "This page could not be drawn";
    document.body.append(made);
}"""
DARK = "dark => document.body.classList.contains('body--dark') === dark"
SETTLED = """() => document.getAnimations().every((each) =>
    each.playState !== "running" || each.effect.target.closest(".zr-tw-spinner, .q-linear-progress"))"""


def legible(page):
    """In both themes, as the system changes from one to the other."""
    for scheme in ("light", "dark"):
        page.emulate_media(color_scheme=scheme, reduced_motion="reduce")
        page.wait_for_function(
            f"() => document.body.classList.contains('body--dark') === {json.dumps(scheme == 'dark')}"
        )
        page.wait_for_function(SETTLED)
        assert page.evaluate(FAINT) == [], scheme
    page.emulate_media(color_scheme="light", reduced_motion="reduce")


def saved(page, name):
    """What is downloaded when a button is pressed."""
    with page.expect_download(timeout=60_000) as waiting:
        page.get_by_test_id(name).click()
    return waiting.value.path().read_text()


def from_menu(page, entry):
    page.get_by_test_id("download").click()
    page.get_by_test_id(entry).click()


def test_all_that_is_said_is_said_in_full_and_can_be_read(demo_page, tmp_path):
    page = demo_page
    expect(page.get_by_test_id("curves")).to_contain_text("→ 0", timeout=120_000)
    expect(page.get_by_test_id("findings")).to_contain_text("the tool turns by")

    from_menu(page, "download-plan")  # of one hole of three
    dialog = page.get_by_test_id("incomplete")
    expect(dialog).to_contain_text("only 1 of 3 holes planned; missing: holes position_2, position_3")
    legible(page)
    plan = json.loads(saved(page, "save-incomplete"))
    assert [hole["id"] for hole in plan["holes"]] == ["position_1"]
    assert [finding["kind"] for finding in plan["findings"]] == ["unfinished", "tool_turn"]

    from_menu(page, "download-program")
    dialog = page.get_by_test_id("preflight")
    expect(dialog).to_contain_text("The program drills 1 of 3 holes.", timeout=60_000)
    expect(dialog).to_contain_text("missing: holes position_2, position_3")
    expect(page.get_by_test_id("save-program")).to_contain_text("with 1 of 3 holes")
    legible(page)
    assert "only 1 of 3 holes planned; missing: holes position_2, position_3" in saved(page, "save-program")

    page.get_by_test_id("scope").get_by_text("All holes").click()
    page.get_by_test_id("plan").click()
    expect(page.get_by_test_id("outcome")).to_contain_text("2 holes planned in", timeout=120_000)
    expect(page.get_by_test_id("outcome")).to_contain_text(": 2 without a reversal.")
    page.get_by_test_id("plan").click()
    expect(page.locator(".q-notification").get_by_text("Every hole has its answer already.")).to_be_visible()
    (tmp_path / "no.json").write_text("[]")
    page.locator('input[type="file"]').first.set_input_files(tmp_path / "no.json")
    expect(page.locator(".q-notification").get_by_text("no.json")).to_be_visible()
    legible(page)
    with page.expect_download():  # all holes have an answer: nothing is to be confirmed
        from_menu(page, "download-plan")

    page.get_by_test_id("add-hole").click()
    page.get_by_test_id("hole-x").fill("far")
    page.get_by_test_id("form-done").click()
    expect(page.locator("label", has=page.get_by_test_id("hole-x")).get_by_role("alert")).to_be_visible()
    legible(page)
    page.get_by_test_id("form-cancel").click()

    page.evaluate(BROKEN)
    for name in ("trouble", "ended"):
        expect(page.get_by_test_id(name)).to_be_visible()
    expect(page.locator("#popup")).to_be_visible()
    legible(page)
    page.evaluate(GONE)
    legible(page)
