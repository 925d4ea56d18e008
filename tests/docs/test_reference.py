"""The reference is of what there is: commands, public names, and the commands that any page shows."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest
from tools import commands_page, tables

import zerorev

ROOT = Path(__file__).parents[2]
PAGES = sorted([*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md"), ROOT / "benchmarks/README.md"])


def test_the_page_of_commands_is_up_to_date():
    assert commands_page.PAGE.read_text(encoding="utf-8") == commands_page.text(), "run `make reference`"


def test_the_tables_of_settings_and_criteria_are_up_to_date():
    found = list(tables.pages())
    assert [page.name for page, text, made in found if text != made] == [], "run `make reference`"
    text = "".join(text for _, text, _ in found)
    assert "| `min_rate_deg_per_mm` | 0.01 |" in text
    assert "| `compliance_axial` |" in text


def test_every_public_name_is_documented(site):
    page = (ROOT / "docs/reference/python.md").read_text(encoding="utf-8")
    assert sorted(re.findall(r"(?m)^::: zerorev\.(\w+)$", page)) == sorted(zerorev.__all__)
    built = (site / "reference/python.html").read_text(encoding="utf-8")
    assert [name for name in zerorev.__all__ if f'id="zerorev.{name}"' not in built] == []


def test_stated_attributes_are_in_the_reference_of_python(site):
    built = (site / "reference/python.html").read_text(encoding="utf-8")
    for words in ("least motion of every joint along the path", "angle moved [rad]", "None: not looked for"):
        assert words in built
    assert "Annotated" not in built


def _commands() -> list[tuple[str, str]]:
    return [
        (page.name, line.strip().removeprefix("$ "))
        for page in PAGES
        if page != commands_page.PAGE
        for text in re.findall(r"(?ms)^```\w*[^\n]*\n(.*?)^```$", page.read_text(encoding="utf-8"))
        for line in text.splitlines()
        if re.match(r"\s*(\$ )?zerorev ", line)
    ]


@pytest.mark.parametrize(("page", "line"), sorted(set(_commands())))
def test_every_command_on_a_page_has_the_options_that_it_is_shown_with(page, line):
    from zerorev.cli import app

    app.parse_args(shlex.split(line, comments=True)[1:], exit_on_error=False, print_error=False)


def test_many_commands_are_shown():
    assert len(set(_commands())) > 40
