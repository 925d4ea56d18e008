"""The table of extras has every extra for users, and sizes that are those of what is installed here."""

from __future__ import annotations

import re
import tomllib

from tools import extras

FOR_BUILDERS = {"docs", "bench", "dev"}


def _rows(text):
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in text.splitlines() if line.startswith("|")]


def test_every_extra_for_users_is_listed():
    project = tomllib.loads((extras.ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    listed = [re.sub("`", "", row[0]) for row in _rows(extras.PAGE.read_text(encoding="utf-8"))[2:]]
    assert listed == ["(none)", *extras.FOR_USERS]
    assert set(extras.FOR_USERS) == set(project["optional-dependencies"]) - FOR_BUILDERS


def test_the_sizes_are_about_those_of_what_is_installed_here():
    page = extras.PAGE.read_text(encoding="utf-8")
    assert page.startswith(extras.HEAD)
    for stated, measured in zip(_rows(page)[2:], _rows(extras.table()), strict=True):
        assert stated[:2] == measured[:2]
        assert abs(int(stated[2]) - int(measured[2])) <= 3, stated
        assert 0.6 < int(measured[3]) / int(stated[3]) < 1.7, stated
