"""The readers of all languages: that they are independent of the writers."""

import ast

import pytest

from oracles.places import ROOT
from zerorev.program.dialects import DIALECTS

PROGRAM = ROOT / "src" / "zerorev" / "program"
SHARED = {"letters", "names", "reading", "source"}


def imported(path):
    """Modules of the room that a file imports, and those that these import, from `program` on."""
    found, left = set(), [path]
    while left:
        for node in ast.walk(ast.parse(left.pop().read_text())):
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("zerorev.program."):
                name = node.module.removeprefix("zerorev.program.")
                if name not in found:
                    found.add(name)
                    left.append(PROGRAM / (name.replace(".", "/") + ".py"))
    return found


@pytest.mark.parametrize("name", DIALECTS)
def test_a_reader_knows_nothing_of_the_writer_but_words_and_names(name):
    found = imported(PROGRAM / name / "read.py")
    assert "reading" in found
    assert found <= SHARED | {f"{name}.source", f"{name}.names", f"{name}.text"}
