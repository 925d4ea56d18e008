"""The tutorial, followed to the letter: its files are those to download, its commands write what it shows."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from oracles import shown

PAGE = Path(__file__).parents[2] / "docs/tutorial/index.md"
PANEL = PAGE.with_name("panel.md")


def test_the_files_shown_are_those_to_download():
    files = {
        after.partition('"')[2].rstrip('"'): text
        for language in ("csv", "yaml")
        for after, text in shown.blocks(PAGE, language)
    }
    assert set(files) == {"bracket.csv", "bracket.yaml"}
    assert {name: (PAGE.parent / name).read_text(encoding="utf-8") for name in files} == files


@pytest.mark.long
def test_every_command_writes_what_the_page_shows(tmp_path):
    for name in ("bracket.csv", "bracket.yaml"):
        shutil.copy(PAGE.parent / name, tmp_path)
    commands = shown.commands(PAGE)
    assert [command.arguments[0] for command in commands] == ["plan", "place", "plan", "check", "export", "check"]
    for command in commands:
        code, output = shown.run(command, tmp_path)
        assert code == 0, output
        assert shown.missing(command, output) is None, output
    assert (tmp_path / "pictures/H1_joint_angles.png").is_file()
    program = (tmp_path / "raised.src").read_text(encoding="utf-8")
    assert "$TOOL={FRAME: X 100.0000,Y 0.0000,Z 65.0000," in program  # as the list for T1 says
    assert "$BASE={FRAME: X 480.0000,Y 150.0000,Z 800.0000," in program


def test_the_files_of_the_panel_are_those_to_download():
    files = {after.partition('"')[2].rstrip('"'): text for after, text in shown.blocks(PANEL, "yaml")}
    assert set(files) == {"angle_head.yaml", "side_panel.yaml"}
    assert {name: (PAGE.parent / name).read_text(encoding="utf-8") for name in files} == files
    rows = (PAGE.parent / "side_panel.csv").read_text(encoding="utf-8-sig").splitlines()
    assert "\n".join(rows[:5]) in PANEL.read_text(encoding="utf-8")
    assert len(rows) == 63


@pytest.mark.long
def test_the_panel_from_the_list_to_the_certified_program(tmp_path):
    for name in ("side_panel.csv", "angle_head.yaml", "side_panel.yaml"):
        shutil.copy(PAGE.parent / name, tmp_path)
    commands = shown.commands(PANEL)
    assert [command.arguments[0] for command in commands] == ["plan", "check", "export", "check"]
    for command in commands:
        code, output = shown.run(command, tmp_path)
        assert code == 0, output
        assert shown.missing(command, output) is None, output
    program = (tmp_path / "side_panel.src").read_text(encoding="utf-8")
    for line in PANEL.read_text(encoding="utf-8").rpartition("over the skin:")[2].splitlines():
        assert not line.startswith(("$", "SPINDLE")) or f"{line}\n" in program
    assert program.count("\nCLAMP(TRUE)\n") == program.count("\nCOUNT_HOLE( )\n") == 60
    holes = json.loads((tmp_path / "side_panel.json").read_text(encoding="utf-8"))["holes"]
    assert {hole["reversals"] for hole in holes} == {0}
    assert min(hole["certified_within"]["mm"] for hole in holes) > 5


class TestComparison:
    """What counts as shown."""

    def test_a_number_may_differ_in_its_last_digit_and_an_axis_in_its_name(self):
        assert shown.same(" H1  6 → 0  224.3  0.0436 A1  yes", "H1 6 → 0 224.31 0.0437 A3 yes")

    @pytest.mark.parametrize(
        "written", ["H2 6 → 0 224.3 yes", "H1 6 → 1 224.3 yes", "H1 6 → 0 234.3 yes", "H1 6 → 0 224.3"]
    )
    def test_anything_else_may_not(self, written):
        assert not shown.same("H1 6 → 0 224.3 yes", written)

    def test_a_line_that_is_not_there_is_named(self):
        command = shown.Command([], ["one", "...", "three"])
        assert shown.missing(command, "one\ntwo\nthree\n") is None
        assert "three" in shown.missing(command, "one\ntwo\n")
        assert "more is written" in shown.missing(shown.Command([], ["one"]), "one\ntwo\n")
