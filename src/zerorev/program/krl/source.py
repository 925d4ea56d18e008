"""KRL source as a controller reads it: where a comment begins, and what separates words."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from decimal import Decimal
from functools import partial
from typing import NoReturn

from zerorev.model.written import Statement, Word
from zerorev.program.source import Refuse, ascii_lines, rounds_alike

__all__ = ["alike", "shape", "statements", "words"]

LONGEST_STATEMENT = 255  # characters: twice what `export` writes

_ANGLES = ("A", "B", "C")
_SIGNS = "{}(),:="
_WORD = re.compile(rf'"[^"]*"|[{_SIGNS}]|[^ \t"{_SIGNS}]+|"')
_TEXT = re.compile(r'"[^"]*"')
_NUMBER = re.compile(r"-?[0-9]{1,9}(?:\.[0-9]{1,12})?")
_NAME = re.compile(r"[$#]?[A-Z_][A-Z0-9_]*(?:\.[A-Z0-9_]+)*|LOAD_DATA\[[0-9]{1,2}\]", re.IGNORECASE)


def statements(text: str, refuse: Refuse) -> Iterator[Statement]:
    """The statements of a source text, in order: without comments, white space, and the header before `DEF`.

    The header is what a controller keeps of its own about a file, in lines that begin with `&`.

    Args:
        text: of the file.
        refuse: called where a controller may read something else than this does.
    """
    begun = False
    for number, line in ascii_lines(text, refuse):
        if not begun and line.startswith("&"):
            continue
        printed = line.partition(";")[0].rstrip()
        if len(printed) > LONGEST_STATEMENT:
            refuse(number, f"a statement of {len(printed)} characters: a controller may not read all of it")
        if source := " ".join(printed.split()):
            begun = True
            yield Statement(words(printed, partial(refuse, number)), number, source)


def words(source: str, refuse: Callable[[str], NoReturn]) -> tuple[Word, ...]:
    """The words of a statement: signs, names in capitals (KRL does not tell case), numbers, and texts in their quotes.

    Args:
        source: one statement, without a comment.
        refuse: called with what is wrong.
    """
    found: list[Word] = []
    for word in _WORD.findall(source):
        if _NUMBER.fullmatch(word):
            found.append(Decimal(word))
        elif _TEXT.fullmatch(word):
            found.append(word)
        elif word in _SIGNS or _NAME.fullmatch(word):
            found.append(word.upper())
        else:
            refuse(f"'{word[:60]}' in '{source[:60]}' is neither a name nor a number as zerorev writes it")
    return tuple(found)


def shape(words: tuple[Word, ...]) -> tuple[str, ...]:
    """The words of a statement, `0` in the place of every number."""
    return tuple("0" if isinstance(word, Decimal) else word for word in words)


def alike(found: Sequence[Word], wanted: Sequence[Word]) -> bool:
    """Whether a statement is the one expected: points and frames but for one in their last printed digits.

    Args:
        found: words of a program's statement.
        wanted: as `export` writes it.
    """
    if len(found) != len(wanted):
        return False
    rounded = "{" in wanted
    names = ("", *wanted)
    return all(
        own == other
        or (
            rounded
            and isinstance(own, Decimal)
            and isinstance(other, Decimal)
            and rounds_alike(own, other, turns=name in _ANGLES)
        )
        for own, other, name in zip(found, wanted, names, strict=False)
    )
