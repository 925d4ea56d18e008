"""KRL source as a controller reads it: where a comment begins, and what separates words."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from zerorev.model.written import Statement, Word
from zerorev.program.source import Lexicon, Refuse, alike_but, ascii_lines, rounds_alike

__all__ = ["KRL_WORDS", "alike", "statements"]

_ANGLES = ("A", "B", "C")
_SIGNS = "{}(),:="
KRL_WORDS = Lexicon(
    word=re.compile(rf'"[^"]*"|[{_SIGNS}]|[^ \t"{_SIGNS}]+|"'),
    signs=_SIGNS,
    name=re.compile(r"[$#]?[A-Z_][A-Z0-9_]*(?:\.[A-Z0-9_]+)*|LOAD_DATA\[[0-9]{1,2}\]", re.IGNORECASE),
    longest=255,
    capitals=True,
)


def statements(text: str, refuse: Refuse) -> Iterator[Statement]:
    """The statements of a source text, in order: without comments, white space, and the header before `DEF`.

    The header is what a controller keeps of its own about a file, in lines that begin with `&`.

    Args:
        text: of the file.
        refuse: called where a controller may read something else than this does.
    """
    begun = False
    for number, line in ascii_lines(text, refuse):
        if begun or not line.startswith("&"):
            for statement in KRL_WORDS.statements(number, line.partition(";")[0], refuse):
                begun = True
                yield statement


def alike(found: Sequence[Word], wanted: Sequence[Word]) -> bool:
    """Whether a statement is the one expected: points and frames but for one in their last printed digits.

    Args:
        found: words of a program's statement.
        wanted: as `export` writes it.
    """
    rounded, names = "{" in wanted, ("", *wanted)
    return alike_but(
        found, wanted, lambda at, own, other: rounded and rounds_alike(own, other, turns=names[at] in _ANGLES)
    )
