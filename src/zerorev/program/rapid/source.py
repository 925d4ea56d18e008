"""RAPID source as a controller reads it: where a comment begins, and what separates words."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from zerorev.model.written import Statement, Word
from zerorev.program.rapid.names import KEPT, part_frame, procedure, tool
from zerorev.program.source import Lexicon, Refuse, alike_but, are_literals, ascii_lines, rounds_alike, shape

__all__ = ["PART", "RAPID_WORDS", "TOOL", "alike", "is_call", "shape_of", "statements", "with_roles"]

TOOL, PART, RUN = "the tool", "the work object", "the procedure"
"""What stands among the words for the names that a module makes of its own."""

_SIGNS = "[](),;\\"
RAPID_WORDS = Lexicon(
    word=re.compile(rf'"[^"]*"|:=|[{re.escape(_SIGNS)}]|[^ \t:"{re.escape(_SIGNS)}]+|.'),
    signs=(*_SIGNS, ":="),
    name=re.compile(r"[A-Z][A-Z0-9_]{0,31}|9E9", re.IGNORECASE),
    longest=400,
    capitals=True,
)
_COMMENT = re.compile(r'((?:[^"!]|"[^"]*")*)(?:!.*)?')
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
        yield from RAPID_WORDS.statements(number, found[1], refuse)


def with_roles(words: tuple[Word, ...], name: str) -> tuple[Word, ...]:
    """The words with what the names are that begin with the module's own: a program may be called otherwise."""
    roles = {tool(name).upper(): TOOL, part_frame(name).upper(): PART, procedure(name).upper(): RUN}
    return tuple(roles.get(word, word) if isinstance(word, str) else word for word in words)


def shape_of(words: tuple[Word, ...]) -> tuple[str, ...]:
    """The shape of a statement, `NAME` for each speed and zone, and `0` for each external axis: these may be any."""
    match words:
        case ("LOCAL", "CONST", kind, name, *rest) if kind in ("SPEEDDATA", "ZONEDATA") and _is_datum(name):
            return shape(("LOCAL", "CONST", kind, "NAME", *rest))
        case ("MOVEL" | "MOVEABSJ", *_):
            last = max((k for k, word in enumerate(words) if word == "]"), default=0)
            kept = ("FINE", "WOBJ", "T")
            axes = ["0" if word == "9E9" else word for word in words[: last + 1]]
            names = ["NAME" if _is_datum(word) and word not in kept else word for word in words[last + 1 :]]
            return shape((*axes, *names))
    return shape(words)


def is_call(words: Sequence[Word]) -> bool:
    """Whether a statement calls a procedure that is not a word of RAPID, with nothing but literals."""
    return _is_datum(words[0]) and words[-1] == ";" and are_literals(words[1:-1], ("TRUE", "FALSE"))


def _is_datum(word: Word) -> bool:
    return isinstance(word, str) and _DATUM.fullmatch(word) is not None and word not in KEPT


def alike(found: Sequence[Word], wanted: Sequence[Word]) -> bool:
    """Whether a statement is the one expected: points and frames but for one in their last printed digits.

    Quadrants of a target have no decimals, and times stand in no brackets: these must be equal.

    Args:
        found: words of a program's statement.
        wanted: as `export` writes it.
    """
    listed, depth = [], 0
    for word in wanted:
        depth += (word == "[") - (word == "]")
        listed.append(depth > 0 and wanted[0] in _ROUNDED)
    return alike_but(
        found,
        wanted,
        lambda at, own, other: listed[at] and int(other.as_tuple().exponent) < 0 and rounds_alike(own, other),
    )
