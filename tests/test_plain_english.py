"""The check of the project's English that `make lint` runs."""

from __future__ import annotations

import pytest
from tools import plain_english

WORDS = plain_english.words(plain_english.WORDS.read_text(encoding="utf-8"))
ANEW, LOOKED, OVER = (
    "an" + "ew",
    "looked" + " at",
    "the map is made\n# an" + "ew",
)  # in parts, as this file is checked, too


def found(text: str) -> list[tuple[int, str]]:
    return [(line, words) for line, words, _ in plain_english.findings(text, WORDS)]


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("plain\nit is made anew.", [(2, "anew")]),
        ("It was Looked at", [(1, "Looked at")]),
        ("the map is looked\n# at again", [(1, "looked # at")]),
        ("def test_what_is_made_anew(): ...", [(1, "anew")]),
        (r'Column("\nanew")', [(1, "anew")]),
        ("12 is no number", [(1, "is no number")]),
        ("it is\nno number", [(1, "is no number")]),
        ("one row a hole", [(1, "one row a hole")]),
    ],
)
def test_finds(text, says):
    assert found(text) == says


@pytest.mark.parametrize(
    "text",
    [
        "predicted, examined, again, resumed",
        "it is no more than twice as long",
        "there is no number",
        "Keanewall, foretellersome",
        f"the thesis says 'anew'  # {plain_english.QUOTED}",
    ],
)
def test_lets_through(text):
    assert not found(text)


def test_exit_code(tmp_path, capsys):
    page = tmp_path / "page.md"
    page.write_text("made anew\n", encoding="utf-8")
    assert plain_english.main([str(page)]) == 1
    assert capsys.readouterr().out == f'{page}:1: "anew": write again\n'
    page.write_text("made again\n", encoding="utf-8")
    assert plain_english.main([str(page)]) == 0
