"""What the readers of all languages share: which characters a line may have, and when two printed numbers are alike.

Where it is not certain how a controller takes a character, the character is refused, in comments too: what zerorev
takes for a comment must not be a statement to the controller. So a line ends with a line feed, or with a carriage
return and a line feed, and with nothing else; the only other control character is the tab; all text is ASCII.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from decimal import Decimal
from typing import NoReturn

__all__ = ["Refuse", "ascii_lines", "rounds_alike"]

Refuse = Callable[[int, str], NoReturn]
"""Called with the number of a line and what is wrong there."""

_ODD = re.compile(r"[^\t -~]")


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
