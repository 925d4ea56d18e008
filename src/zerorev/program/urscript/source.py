"""URScript source as a controller reads it: where a comment begins, and what separates words.

Capitals and small letters differ in URScript, so words are kept as they stand.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from zerorev.model.written import Statement, Word
from zerorev.program.source import Lexicon, Refuse, alike_but, ascii_lines, rounds_alike

__all__ = ["URSCRIPT_WORDS", "alike", "statements"]

_OPEN, _CLOSE = ("[", "p["), "]"
URSCRIPT_WORDS = Lexicon(
    word=re.compile(r'"[^"]*"|p\[|[\[\](),=:]|[^ \t"\[\](),=:]+|"'),
    signs=("[", "]", "p[", "(", ")", ",", "=", ":"),
    name=re.compile(r"[A-Za-z][A-Za-z0-9_]*"),
    longest=255,
)


def statements(text: str, refuse: Refuse) -> Iterator[Statement]:
    """The statements of a source text, in order: without comments and white space.

    Args:
        text: of the file.
        refuse: called where a controller may read something else than this does.
    """
    for number, line in ascii_lines(text, refuse):
        yield from URSCRIPT_WORDS.statements(number, line.partition("#")[0], refuse)


def alike(found: Sequence[Word], wanted: Sequence[Word]) -> bool:
    """Whether a statement is the one expected: poses and joints but for one in their last printed digits.

    Args:
        found: words of a program's statement.
        wanted: as `export` writes it.
    """
    listed, within = [], False  # the brackets of a pose or of joints
    for word in wanted:
        within = word in _OPEN or (within and word != _CLOSE)
        listed.append(within)
    return alike_but(found, wanted, lambda at, own, other: listed[at] and rounds_alike(own, other))
