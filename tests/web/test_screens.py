"""Pictures of the page for people to look at, in out/screens; and at every size nothing sticks out to the side."""

from __future__ import annotations

import pytest

from oracles.places import ROOT

pytestmark = [pytest.mark.xdist_group("browser"), pytest.mark.long]
expect = pytest.importorskip("playwright.sync_api", reason="the tests in a browser need playwright").expect

SCREENS = ROOT / "out" / "screens"
SIZES = {"1280": (1280, 900), "1920": (1920, 1080), "1920 at 125 %": (1536, 864)}


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("size", SIZES)
def test_screens(demo, open_page, size, scheme):
    width, height = SIZES[size]
    scale = 1.25 if "125" in size else 1.0
    page = open_page(demo, viewport={"width": width, "height": height}, color_scheme=scheme, device_scale_factor=scale)
    expect(page.get_by_test_id("reversals")).to_have_text("0", timeout=120_000)
    expect(page.get_by_test_id("map-cover")).to_be_hidden(timeout=120_000)
    expect(page.get_by_test_id("curves")).to_contain_text("→ 0")
    page.wait_for_timeout(1500)
    SCREENS.mkdir(parents=True, exist_ok=True)
    name = f"{size} {scheme}".replace(" %", "").replace(" ", "_")
    page.screenshot(path=SCREENS / f"{name}.png", full_page=True, timeout=120_000)
    assert page.evaluate("document.documentElement.scrollWidth <= window.innerWidth")
