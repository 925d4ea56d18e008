"""KRL source as a controller reads it: which characters end a line, begin a comment and separate words.

Where it is not certain how a controller takes a character, the character is refused, in comments too: what zerorev
takes for a comment must not be a statement to the controller. So a line ends with a line feed, or with a carriage
return and a line feed, and with nothing else; the only other control character is the tab; all text is ASCII.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from decimal import Decimal
from functools import partial
from typing import NoReturn

from zerorev.model.written import Statement, Word

__all__ = ["Refuse", "alike", "shape", "statements", "words"]

Refuse = Callable[[int, str], NoReturn]
"""Called with the number of a line and what is wrong there."""

LONGEST_STATEMENT = 255  # characters: twice what `export` writes

_ODD = re.compile(r"[^\t -~]")
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
    for number, line in enumerate(text.replace("\r\n", "\n").split("\n"), start=1):
        if odd := _ODD.search(line):
            refuse(number, _named(odd[0]))
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


def _named(character: str) -> str:
    if character == "\r":
        return "a carriage return without a line feed: it is not certain that it ends a line"
    kind = "that is not ASCII" if ord(character) > 0x7F else "of control"
    return f"a character {kind} (code {ord(character):#04x}): it is not certain how a controller reads it"


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
            and _rounds_alike(own, other, turns=name in _ANGLES)
        )
        for own, other, name in zip(found, wanted, names, strict=False)
    )


def _rounds_alike(found: Decimal, wanted: Decimal, *, turns: bool) -> bool:
    """Whether a number is the one expected but for one in its last printed digit.

    Angles are written within (-180, 180], so that the one next to 180 is close to -180.
    """
    unit, off = Decimal(1).scaleb(int(wanted.as_tuple().exponent)), abs(found - wanted)
    return off <= unit or (turns and abs(off - 360) <= unit and min(found, wanted) > -180 and max(found, wanted) <= 180)
