"""Every kind of finding has its line on the page, and each is made by the code; mypy sees to it that no other is."""

from __future__ import annotations

import ast
import re
from pathlib import Path
from typing import get_args

from zerorev.model.finding import FindingKind

ROOT = Path(__file__).parents[2]
SOURCES = [path for path in sorted((ROOT / "src/zerorev").rglob("*.py")) if path.name != "finding.py"]


def _strings(source: Path) -> set[str]:
    tree = ast.parse(source.read_text(encoding="utf-8"))
    return {each.value for each in ast.walk(tree) if isinstance(each, ast.Constant) and isinstance(each.value, str)}


def test_the_page_lists_every_kind():
    page = (ROOT / "docs/howto/findings.md").read_text(encoding="utf-8")
    listed = set(re.findall(r"(?m)^\| `([a-z_]+)` \| (?:error|warning|info)", page))
    assert listed == set(get_args(FindingKind))


def test_each_kind_is_made_somewhere():
    assert set(get_args(FindingKind)) <= set().union(*(_strings(source) for source in SOURCES))


def test_the_page_lists_the_errors():
    from zerorev import errors

    page = (ROOT / "docs/howto/findings.md").read_text(encoding="utf-8")
    assert set(re.findall(r"(?m)^\| `(\w*Error)` ", page)) == set(errors.__all__)
