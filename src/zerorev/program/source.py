"""Source texts of all languages: their characters, their words, and when two printed numbers or statements are alike.

Where it is not certain how a controller takes a character, the character is refused, in comments too: what zerorev
takes for a comment must not be a statement to the controller. So a line ends with a line feed, or with a carriage
return and a line feed, and with nothing else; the only other control character is the tab; all text is ASCII.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass
from decimal import Decimal
from functools import partial
from typing import NoReturn

from zerorev.model.written import Statement, Word

__all__ = ["Lexicon", "Refuse", "alike_but", "are_literals", "ascii_lines", "rounds_alike", "shape"]

Refuse = Callable[[int, str], NoReturn]
"""Called with the number of a line and what is wrong there."""

_ODD = re.compile(r"[^\t -~]")
_NUMBER = re.compile(r"-?[0-9]{1,9}(?:\.[0-9]{1,12})?")
_TEXT = re.compile(r'"[^"]*"')


def ascii_lines(text: str, refuse: Refuse) -> Iterator[tuple[int, str]]:
    """The lines of a source text with their numbers, from 1.

    Args:
        text: of the file.
        refuse: called where a controller may read something else than this does.
    """
    for number, line in enumerate(text.replace("\r\n", "\n").split("\n"), start=1):
        if odd := _ODD.search(line):
            refuse(number, _named(odd[0]))
        yield number, line


@dataclass(frozen=True)
class Lexicon:
    """What the statements of a language consist of, besides numbers, and texts in their quotes.

    Attributes:
        word: finds the next word, of any kind.
        signs: all that there are.
        name: matches a name.
        longest: characters of a statement; far more than `export` writes.
        capitals: whether the language does not tell case: names are then words in capitals.
    """

    word: re.Pattern[str]
    signs: Collection[str]
    name: re.Pattern[str]
    longest: int
    capitals: bool = False

    def words(self, source: str, refuse: Callable[[str], NoReturn]) -> tuple[Word, ...]:
        """The words of a statement.

        Args:
            source: one statement, without a comment.
            refuse: called with what is wrong.
        """
        found: list[Word] = []
        for word in self.word.findall(source):
            if _NUMBER.fullmatch(word):
                found.append(Decimal(word))
            elif _TEXT.fullmatch(word):
                found.append(word)
            elif word in self.signs or self.name.fullmatch(word):
                found.append(word.upper() if self.capitals else word)
            elif word.strip():
                begin = source.strip()[:60]
                refuse(f"'{word[:60]}' in '{begin}' is neither a name nor a number as zerorev writes it")
        return tuple(found)

    def form(self, source: str) -> tuple[Word, ...]:
        """The words of a statement that is known to be right."""

        def refuse(what: str) -> NoReturn:
            raise ValueError(what)

        return self.words(source, refuse)

    def statements(self, line: int, printed: str, refuse: Refuse) -> Iterator[Statement]:
        """The statement of a line, without its comment; none of an empty one.

        Args:
            line: its number.
            printed: what stands there.
            refuse: called where a controller may read something else than this does.
        """
        printed = printed.rstrip()
        if len(printed) > self.longest:
            refuse(line, f"a statement of {len(printed)} characters: a controller may not read all of it")
        if source := " ".join(printed.split()):
            yield Statement(self.words(printed, partial(refuse, line)), line, source)


def shape(words: Sequence[Word]) -> tuple[str, ...]:
    """The words of a statement, `0` in the place of every number."""
    return tuple("0" if isinstance(word, Decimal) else word for word in words)


def are_literals(words: Sequence[Word], names: Collection[str], marks: str = '"') -> bool:
    """Whether words are literals with commas between them; also of none.

    Args:
        words: between the brackets of a call.
        names: that stand for a value.
        marks: with which a literal begins that is not a number.
    """
    literals, commas = words[::2], words[1::2]
    return (
        all(isinstance(each, Decimal) or each in names or (len(each) > 1 and each[0] in marks) for each in literals)
        and all(comma == "," for comma in commas)
        and len(literals) in (0, len(commas) + 1)
    )


def alike_but(found: Sequence[Word], wanted: Sequence[Word], near: Callable[[int, Decimal, Decimal], bool]) -> bool:
    """Whether a statement is the one expected but for numbers that are near to those expected.

    Args:
        found: words of a program's statement.
        wanted: as `export` writes it.
        near: (place among the words, number found, number expected) -> whether it may stand there.
    """
    return len(found) == len(wanted) and all(
        own == other or (isinstance(own, Decimal) and isinstance(other, Decimal) and near(place, own, other))
        for place, (own, other) in enumerate(zip(found, wanted, strict=True))
    )


def rounds_alike(found: Decimal, wanted: Decimal, *, turns: bool = False) -> bool:
    """Whether a number is the one expected but for one in its last printed digit.

    Args:
        found: in a program.
        wanted: as `export` writes it.
        turns: whether it is an angle within (-180, 180] deg, so that the one next to 180 is close to -180.
    """
    unit, off = Decimal(1).scaleb(int(wanted.as_tuple().exponent)), abs(found - wanted)
    return off <= unit or (turns and abs(off - 360) <= unit and min(found, wanted) > -180 and max(found, wanted) <= 180)


def _named(character: str) -> str:
    if character == "\r":
        return "a carriage return without a line feed: it is not certain that it ends a line"
    kind = "that is not ASCII" if ord(character) > 0x7F else "of control"
    return f"a character {kind} (code {ord(character):#04x}): it is not certain how a controller reads it"
