"""README and how-to pages: their commands write what is shown; the Python of all pages runs and prints what it says."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

from oracles import shown

ROOT = Path(__file__).parents[2]
PAGES = {page.stem: page for page in (ROOT / "README.md", *sorted((ROOT / "docs/howto").glob("*.md")))}
SLOW = {"place_a_part", "methods", "parameter_map"}
NEEDING_A_MAP = {"maps", "map_pictures"}
WITH_OUTPUT = {"geometry", "own_robot", "own_tool", "python"}  # of pages that show what their Python prints
FAILING = {"findings": 2}  # exit code of the one command that is shown because it fails


def _with_files(page: Path, folder: Path) -> None:
    for language in ("yaml", "csv"):
        for after, text in shown.blocks(page, language):
            if name := re.search(r'title="([\w.]+)"', after):
                (folder / name[1]).write_text(text, encoding="utf-8")


@pytest.mark.long
@pytest.mark.parametrize("name", [name for name, page in PAGES.items() if shown.commands(page)])
def test_every_command_writes_what_the_page_shows(tmp_path, name):
    _with_files(PAGES[name], tmp_path)
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    for command in shown.commands(PAGES[name]):
        code, output = shown.run(command, tmp_path)
        assert code == FAILING.get(name, 0), output
        assert shown.missing(command, output) is None, output


def test_pages_with_commands_are_tested():
    assert {"README", "not_zero", "findings"} <= {name for name, page in PAGES.items() if shown.commands(page)}


def _with_python() -> list[Path]:
    pages = sorted((ROOT / "docs").rglob("*.md"))
    return [page for page in pages if page.stem not in NEEDING_A_MAP and shown.blocks(page, "python")]


@pytest.mark.parametrize(
    "page",
    [pytest.param(page, marks=pytest.mark.soak if page.stem in SLOW else ()) for page in _with_python()],
    ids=lambda page: page.stem,
)
def test_the_python_of_a_page_runs(tmp_path, page):
    _with_files(page, tmp_path)
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    code = "".join(text for _, text in shown.blocks(page, "python"))
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    assert done.stdout
    if page.stem in WITH_OUTPUT:
        text = page.read_text(encoding="utf-8")
        assert [line for line in done.stdout.splitlines() if line not in text] == []
