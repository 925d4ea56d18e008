"""README and how-to pages: their commands write what is shown, their Python runs and prints what its comments say."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

from oracles import shown

ROOT = Path(__file__).parents[2]
PAGES = {page.stem: page for page in (ROOT / "README.md", *sorted((ROOT / "docs/howto").glob("*.md")))}
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
    for command in shown.commands(PAGES[name]):
        code, output = shown.run(command, tmp_path)
        assert code == FAILING.get(name, 0), output
        assert shown.missing(command, output) is None, output


def test_pages_with_commands_are_tested():
    assert {"README", "not_zero", "findings"} <= {name for name, page in PAGES.items() if shown.commands(page)}


@pytest.mark.parametrize("name", ["own_robot", "own_tool"])
def test_the_python_of_a_page_prints_what_it_says(tmp_path, name):
    _with_files(PAGES[name], tmp_path)
    code = "".join(text for _, text in shown.blocks(PAGES[name], "python"))
    assert code
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    said = {"own_robot": "0.000 mm, 0.000 deg off\n0.005 mm, 0.006 deg off\n", "own_tool": "e = 155.0 mm\n"}[name]
    assert done.stdout == said
    assert all(line in PAGES[name].read_text(encoding="utf-8") for line in said.splitlines())
