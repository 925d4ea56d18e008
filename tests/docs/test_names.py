"""Names of the code on the pages: each module, function and file that a page names is there."""

from __future__ import annotations

import re
from importlib import import_module
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGES = sorted([*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md"), *(ROOT / "benchmarks").glob("*.md")])
GROUPS = {"zerorev.quantities"}  # entry points, which are not modules


def _exists(name: str) -> bool:
    parts = name.split(".")
    for k in range(len(parts), 0, -1):
        try:
            found = import_module(".".join(parts[:k]))
        except ModuleNotFoundError:
            continue
        for part in parts[k:]:
            if not hasattr(found, part):
                return False
            found = getattr(found, part)
        return True
    return False


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_what_a_page_names_exists(page):
    text = page.read_text(encoding="utf-8")
    names = set(re.findall(r"`(zerorev(?:\.\w+)+)`", text)) - GROUPS
    names |= {
        f"{module}.{name.strip()}"
        for module, given in re.findall(r"(?m)^from (zerorev[\w.]*) import (.*)$", text)
        for name in given.split(",")
    }
    assert {name for name in names if not _exists(name)} == set()
    files = set(re.findall(r"`((?:examples|tests|benchmarks|docs|tools)/[\w/.]+)`", text))
    files |= {f"src/zerorev/{name}" for name in re.findall(r"`((?:kernels|search|verify)/[\w/]+\.py)`", text)}
    assert {name for name in files if not (ROOT / name).exists()} == set()


def test_many_names_are_found():
    text = "".join(page.read_text(encoding="utf-8") for page in PAGES)
    assert len(set(re.findall(r"`(zerorev(?:\.\w+)+)`", text))) > 30
