"""CHANGELOG and CITATION: their form, and that they agree with the package."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import yaml

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def test_changelog_has_the_form_of_keep_a_changelog():
    text = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    assert re.findall(r"(?m)^# (.*)$", text) == ["Changelog"]
    assert re.findall(r"(?m)^## (.*)$", text)[0] == "[Unreleased]"
    sections = set(re.findall(r"(?m)^### (.*)$", text))
    assert sections <= {"Added", "Changed", "Deprecated", "Removed", "Fixed", "Security"}
    bullets = re.findall(r"(?m)^- (.*)$", text)
    assert [bullet for bullet in bullets if not re.match(r"[A-Z][\w ,]*: ", bullet)] == []
    assert len(bullets) > 50


def test_citation_has_what_cff_1_2_0_needs():
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    assert citation["cff-version"] == "1.2.0"
    assert {"message", "title", "authors"} <= set(citation)
    assert all("name" in author or "family-names" in author for author in citation["authors"])
    assert (citation["version"], citation["license"]) == (PROJECT["version"], PROJECT["license"])
