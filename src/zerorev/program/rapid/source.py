"""RAPID source as a controller reads it: where a comment begins, and what separates words."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from decimal import Decimal
from functools import partial
from typing import NoReturn

from zerorev.model.written import Statement, Word
from zerorev.program.rapid.names import KEPT, part_frame, procedure, tool
from zerorev.program.source import Refuse, ascii_lines, rounds_alike

__all__ = ["PART", "TOOL", "alike", "any_name", "is_call", "shape", "statements", "with_roles", "words"]

TOOL, PART, RUN = "the tool", "the work object", "the procedure"
"""What stands among the words for the names that a module makes of its own."""

LONGEST_STATEMENT = 400  # characters: some twice what `export` writes

_SIGNS = "[](),;\\"
_WORD = re.compile(rf'"[^"]*"|:=|[{re.escape(_SIGNS)}]|[^ \t:"{re.escape(_SIGNS)}]+|.')
_TEXT = re.compile(r'"[^"]*"')
_COMMENT = re.compile(r'((?:[^"!]|"[^"]*")*)(?:!.*)?')
_NUMBER = re.compile(r"-?[0-9]{1,9}(?:\.[0-9]{1,12})?")
_NAME = re.compile(r"[A-Z][A-Z0-9_]{0,31}|9E9", re.IGNORECASE)
_DATUM = re.compile(r"[A-Z][A-Z0-9_]{0,31}", re.IGNORECASE)
_ROUNDED = ("MOVEL", "MOVEABSJ", "PERS")


def statements(text: str, refuse: Refuse) -> Iterator[Statement]:
    """The statements of a source text, in order, one a line: without comments and white space.

    Args:
        text: of the file.
        refuse: called where a controller may read something else than this does.
    """
    for number, line in ascii_lines(text, refuse):
        found = _COMMENT.fullmatch(line)
        if found is None:
            refuse(number, "a text that does not end")
        printed = found[1].rstrip()
        if len(printed) > LONGEST_STATEMENT:
            refuse(number, f"a statement of {len(printed)} characters: a controller may not read all of it")
        if source := " ".join(printed.split()):
            yield Statement(words(printed, partial(refuse, number)), number, source)


def words(source: str, refuse: Callable[[str], NoReturn]) -> tuple[Word, ...]:
    """The words of a statement: signs, names in capitals (RAPID does not tell case), numbers, and texts in quotes.

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
        elif word in (*_SIGNS, ":=") or _NAME.fullmatch(word):
            found.append(word.upper())
        elif word.strip():
            refuse(f"'{word[:60]}' in '{source[:60]}' is neither a name nor a number as zerorev writes it")
    return tuple(found)


def shape(words: Sequence[Word]) -> tuple[str, ...]:
    """The words of a statement, `0` in the place of every number."""
    return tuple("0" if isinstance(word, Decimal) else word for word in words)


def with_roles(words: tuple[Word, ...], name: str) -> tuple[Word, ...]:
    """The words with what the names are that begin with the module's own: a program may be called otherwise."""
    roles = {tool(name).upper(): TOOL, part_frame(name).upper(): PART, procedure(name).upper(): RUN}
    return tuple(roles.get(word, word) if isinstance(word, str) else word for word in words)


def any_name(words: tuple[Word, ...]) -> tuple[Word, ...]:
    """The words with `NAME` for each speed and zone, and `0` for each external axis: these may be any."""
    match words:
        case ("LOCAL", "CONST", kind, name, *rest) if kind in ("SPEEDDATA", "ZONEDATA") and _is_datum(name):
            return ("LOCAL", "CONST", kind, "NAME", *rest)
        case ("MOVEL" | "MOVEABSJ", *_):
            last = max((k for k, word in enumerate(words) if word == "]"), default=0)
            kept = ("FINE", "WOBJ", "T")
            return (
                *("0" if word == "9E9" else word for word in words[: last + 1]),
                *("NAME" if _is_datum(word) and word not in kept else word for word in words[last + 1 :]),
            )
    return words


def is_call(words: Sequence[Word]) -> bool:
    """Whether a statement calls a procedure that is not a word of RAPID, with nothing but literals."""
    name, *rest = words
    if not _is_datum(name) or rest[-1:] != [";"]:
        return False
    arguments, commas = rest[:-1:2], rest[1:-1:2]
    literal = all(isinstance(each, Decimal) or each in ("TRUE", "FALSE") or each[0] == '"' for each in arguments)
    return literal and all(comma == "," for comma in commas) and len(arguments) in (0, len(commas) + 1)


def _is_datum(word: Word) -> bool:
    return isinstance(word, str) and _DATUM.fullmatch(word) is not None and word not in KEPT


def alike(found: Sequence[Word], wanted: Sequence[Word]) -> bool:
    """Whether a statement is the one expected: points and frames but for one in their last printed digits.

    Quadrants of a target have no decimals, and times stand in no brackets: these must be equal.

    Args:
        found: words of a program's statement.
        wanted: as `export` writes it.
    """
    if len(found) != len(wanted):
        return False
    rounded, depth = wanted[0] in _ROUNDED, 0
    for own, other in zip(found, wanted, strict=True):
        depth += (other == "[") - (other == "]")
        if own != other and not (
            rounded
            and depth
            and isinstance(own, Decimal)
            and isinstance(other, Decimal)
            and int(other.as_tuple().exponent) < 0
            and rounds_alike(own, other)
        ):
            return False
    return True
