"""URScript source as a controller reads it: where a comment begins, and what separates words.

Capitals and small letters differ in URScript, so words are kept as they stand.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from decimal import Decimal
from functools import partial
from typing import NoReturn

from zerorev.model.written import Statement, Word
from zerorev.program.source import Refuse, ascii_lines, rounds_alike

__all__ = ["alike", "shape", "statements", "words"]

LONGEST_STATEMENT = 255  # characters: half as many again as `export` writes

_OPEN, _CLOSE = ("[", "p["), "]"
_WORD = re.compile(r'"[^"]*"|p\[|[\[\](),=:]|[^ \t"\[\](),=:]+|"')
_TEXT = re.compile(r'"[^"]*"')
_SIGNS = ("[", "]", "p[", "(", ")", ",", "=", ":")
_NUMBER = re.compile(r"-?[0-9]{1,9}(?:\.[0-9]{1,12})?")
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")


def statements(text: str, refuse: Refuse) -> Iterator[Statement]:
    """The statements of a source text, in order: without comments and white space.

    Args:
        text: of the file.
        refuse: called where a controller may read something else than this does.
    """
    for number, line in ascii_lines(text, refuse):
        printed = line.partition("#")[0].rstrip()
        if len(printed) > LONGEST_STATEMENT:
            refuse(number, f"a statement of {len(printed)} characters: none that is written is as long")
        if source := " ".join(printed.split()):
            yield Statement(words(printed, partial(refuse, number)), number, source)


def words(source: str, refuse: Callable[[str], NoReturn]) -> tuple[Word, ...]:
    """The words of a statement: signs, names, numbers, and texts in their quotes.

    Args:
        source: one statement, without a comment.
        refuse: called with what is wrong.
    """
    found: list[Word] = []
    for word in _WORD.findall(source):
        if _NUMBER.fullmatch(word):
            found.append(Decimal(word))
        elif word in _SIGNS or _NAME.fullmatch(word) or _TEXT.fullmatch(word):
            found.append(word)
        else:
            refuse(f"'{word[:60]}' in '{source.strip()[:60]}' is neither a name nor a number as zerorev writes it")
    return tuple(found)


def shape(words: tuple[Word, ...]) -> tuple[str, ...]:
    """The words of a statement, `0` in the place of every number."""
    return tuple("0" if isinstance(word, Decimal) else word for word in words)


def alike(found: Sequence[Word], wanted: Sequence[Word]) -> bool:
    """Whether a statement is the one expected: poses and joints but for one in their last printed digits.

    Args:
        found: words of a program's statement.
        wanted: as `export` writes it.
    """
    if len(found) != len(wanted):
        return False
    listed = False  # within the brackets of a pose or of joints
    for own, other in zip(found, wanted, strict=True):
        numbers = isinstance(own, Decimal) and isinstance(other, Decimal)
        if own != other and not (listed and numbers and rounds_alike(Decimal(own), Decimal(other))):
            return False
        if other in _OPEN or other == _CLOSE:
            listed = other in _OPEN
    return True
