"""The built site: every link leads somewhere, every page is in the menu, and nothing comes from the network."""

from __future__ import annotations

import re
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

import pytest

ROOT = Path(__file__).parents[2]
LOADED = {("script", "src"), ("img", "src"), ("iframe", "src"), ("source", "src")}
LOADED_RELATIONS = {"stylesheet", "icon", "preload", "modulepreload", "manifest"}


class _Page(HTMLParser):
    """What a page links to, loads, and can be linked to by.

    Attributes:
        links: of `<a>`.
        loads: scripts, pictures, style sheets.
        ids: of its elements.
    """

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.links: list[str] = []
        self.loads: list[str] = []
        self.ids: set[str] = set()
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = {name: value or "" for name, value in attrs}
        self.ids |= {given[name] for name in ("id", "name") if name in given}
        if tag == "a" and "href" in given:
            self.links.append(given["href"])
        if tag == "link" and LOADED_RELATIONS & set(given.get("rel", "").split()):
            self.loads.append(given["href"])
        self.loads += [given[name] for kind, name in LOADED if kind == tag and name in given]


@pytest.fixture(scope="module")
def pages(site) -> dict[Path, _Page]:
    """Every page of the site."""
    return {path: _Page(path) for path in site.rglob("*.html") if path.name != "404.html"}


def test_every_link_leads_to_a_page_and_an_anchor(pages):
    lost = []
    for path, page in pages.items():
        for link in page.links + page.loads:
            parts = urlsplit(link)
            if parts.scheme or parts.netloc:
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            if not target.is_file():
                lost.append(f"{path.name}: {link}")
            elif parts.fragment and target in pages and unquote(parts.fragment) not in pages[target].ids:
                lost.append(f"{path.name}: {link} (no such anchor)")
    assert not lost
    assert sum(len(page.links) for page in pages.values()) > 1000


def test_nothing_is_loaded_from_elsewhere(pages):
    assert all(page.loads for page in pages.values())
    assert [load for page in pages.values() for load in page.loads if urlsplit(load).netloc or ":" in load] == []


def test_style_sheets_load_nothing_from_elsewhere(site):
    sheets = [path.read_text(encoding="utf-8") for path in site.rglob("*.css")]
    addresses = [found for text in sheets for found in re.findall(r"url\(\s*['\"]?([^'\")]+)", text)]
    assert len(addresses) >= 20, "the fonts of the formulas"
    assert [address for address in addresses if not address.startswith(("data:", "fonts/"))] == []


def test_every_page_is_built_from_the_menu(site):
    """MkDocs fails on a page that the menu does not name; here all Markdown files are compared with it."""
    sources = {path.relative_to(ROOT / "docs").with_suffix(".html") for path in (ROOT / "docs").rglob("*.md")}
    menu = (ROOT / "mkdocs.yml").read_text(encoding="utf-8")
    assert {path for path in sources if str(path.with_suffix(".md")) not in menu} == set()
    assert all((site / path).is_file() for path in sources)


def test_links_of_files_beside_the_documentation_lead_somewhere():
    """Of the README and its like, which are read where the code lies."""
    links = {
        (page, link.partition("#")[0])
        for page in [*ROOT.glob("*.md"), ROOT / "benchmarks/README.md"]
        for link in re.findall(r"\]\(([^)\s]+)\)", page.read_text(encoding="utf-8"))
        if not urlsplit(link).scheme
    }
    assert len(links) > 10
    assert [link for page, link in links if not (page.parent / link).exists()] == []


def test_sections_that_the_code_cites_exist():
    pages = [*(ROOT / "docs/explanation").glob("*.md"), ROOT / "docs/thesis/index.md"]
    sections = {
        number
        for page in pages
        for number in re.findall(r"(?m)^#{2,3} (\d+(?:\.\d+)?)\.? ", page.read_text(encoding="utf-8"))
    }
    cited = {
        number
        for folder in ("src", "tests", "benchmarks")
        for source in (ROOT / folder).rglob("*.py")
        for group in re.findall(r"[Tt]heory (§[\d.]+(?:(?:, | and )§[\d.]+)*)", source.read_text(encoding="utf-8"))
        for number in re.findall(r"\d+(?:\.\d+)?", group)
    }
    assert {"1", "2", "3", "4", "5", "6", "7", "8.4"} <= cited
    assert cited <= sections


def test_pages_that_other_files_name_exist():
    """Names of pages in the code, the README and so on: `docs/howto/maps.md`."""
    named = {
        (str(source.relative_to(ROOT)), name)
        for pattern in ("src/**/*.py", "benchmarks/**/*.py", "examples/**/*.py", "benchmarks/*.md", "*.md", "Makefile")
        for source in ROOT.glob(pattern)
        for name in re.findall(r"docs/[\w./-]+\.(?:md|png|json|svg)", source.read_text(encoding="utf-8"))
    }
    assert len(named) > 20
    assert {(source, name) for source, name in named if not (ROOT / name).is_file()} == set()
