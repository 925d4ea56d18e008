"""The site from the disk, in a browser that reaches nothing else: formulas are drawn, the search finds."""

from __future__ import annotations

import pytest


@pytest.fixture
def offline(browser, site):
    """A page of the browser; all that is not a file is refused and noted, and so is every error."""
    context = browser.new_context(viewport={"width": 1280, "height": 900})
    page = context.new_page()
    page.elsewhere, page.errors = [], []

    def judge(route):
        if route.request.url.startswith(("file:", "data:", "blob:")):
            route.continue_()
        else:
            page.elsewhere.append(route.request.url)
            route.abort()

    context.route("**/*", judge)
    page.on("pageerror", lambda error: page.errors.append(str(error)))
    yield page
    assert page.elsewhere == []
    assert page.errors == []
    context.close()


@pytest.mark.parametrize("name", ["geometry", "search", "threshold_and_corner", "check"])
def test_every_formula_is_drawn(offline, site, name):
    offline.goto((site / f"explanation/{name}.html").as_uri())
    drawn = offline.locator(".arithmatex .katex-html").count()
    assert drawn == offline.locator(".arithmatex").count()
    assert drawn > 10
    assert offline.locator(".katex-error").count() == 0


def test_formulas_have_their_fonts(offline, site):
    offline.goto((site / "explanation/geometry.html").as_uri())
    assert offline.evaluate("document.fonts.ready.then(() => document.fonts.check('16px KaTeX_Math'))")
    loaded = offline.evaluate("[...document.fonts].filter(f => f.status === 'loaded').map(f => f.family)")
    assert {"KaTeX_Main", "KaTeX_Math"} <= {family.strip('"') for family in loaded}


def test_the_search_finds_a_word(offline, site):
    offline.goto((site / "index.html").as_uri())
    offline.locator("input.md-search__input").click()
    offline.keyboard.type("backlash", delay=20)
    found = offline.locator(".md-search-result__item a").first
    found.wait_for(state="visible")
    offline.locator(".md-search-result__item", has_text="lead-in").first.wait_for(state="attached")
