"""Edits of a program in any language: one token at a time, in ways that a slip, an editor or a forger may.

Each edit says by name why it is harmless, or that it is not: what is not must be refuted or refused.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple

import numpy as np

__all__ = ["Edit", "Language", "edits"]

ODD = ["\f", "\v", "\r", "\0", "\x1a", "\x1b", "\x7f", "\x85", "\xa0", "ä", "\u2028"]


class Edit(NamedTuple):
    """An edited text.

    Attributes:
        kind: what was done.
        text: of the file.
        harmless: why it may pass; None: it must not.
    """

    kind: str
    text: str
    harmless: str | None


@dataclass(frozen=True)
class Language:
    """How a language is cut into tokens.

    Attributes:
        token: matches one token of a line without its comment.
        comment: matches a comment within a line, from where it begins to the end of the line.
        words: that may stand in the place of a word.
        statements: that may be put between two lines.
        rounded: whether the numbers of a line, given as it stands, may differ by one in their last digit.
        harmless: (kind, token, line) -> why an edit of that kind may pass, or None; for what else a language forgives.
    """

    token: re.Pattern[str]
    comment: re.Pattern[str]
    words: tuple[str, ...]
    statements: tuple[str, ...]
    rounded: Callable[[str], bool]
    harmless: Callable[[str, str, str], str | None] = lambda kind, token, line: None


def edits(text: str, language: Language, count: int, seed: int) -> Iterator[Edit]:
    """So many edits: every token in turn, in an order and in ways drawn from the seed."""
    rng, lines, made = np.random.default_rng(seed), text.split("\n"), 0
    places = [
        (number, match.start(), match.end())
        for number, line in enumerate(lines)
        for match in language.token.finditer(language.comment.sub("", line))
    ]
    while made < count:
        for at in rng.permutation(len(places)):
            if made == count:
                return
            number, start, end = places[at]
            line = lines[number]
            edit = None
            while edit is None:
                kind, new, name = _drawn(line, start, end, language, rng)
                changed = [*lines[:number], *new, *lines[number + 1 :]]
                if "\n".join(changed) != text:
                    edit = Edit(kind, "\n".join(changed), name or language.harmless(kind, line[start:end], line))
            made += 1
            yield edit


def _drawn(
    line: str, start: int, end: int, language: Language, rng: np.random.Generator
) -> tuple[str, list[str], str | None]:
    """One edit of a token: its kind, the lines in the place of its line, and why it may pass."""
    own = line[start:end]

    def pick(choices: list[str] | tuple[str, ...]) -> str:
        return choices[int(rng.integers(len(choices)))]

    def put(new: str) -> list[str]:
        return [line[:start] + new + line[end:]]

    if re.fullmatch(r"-?\d+(\.\d+)?", own) and rng.random() < 0.7:
        new = _number(own, rng)
        return "another number", put(new), _forgiven(own, new, language.rounded(line))
    what = pick(("delete", "double", "word", "odd", "space", "delete line", "double line", "insert", "cut", "swap"))
    match what:
        case "delete":
            return "delete a token", put(""), None
        case "double":
            return "double a token", put(f"{own} {own}"), None
        case "word":
            return "another word", put(pick([word for word in language.words if word != own])), None
        case "odd":
            return "an odd character", put(pick(ODD) + own), None
        case "space":
            return "white space before a token", put(f" {own}"), None
        case "delete line":
            return "delete a line", [], None
        case "double line":
            return "double a line", [line, line], None
        case "insert":
            return "insert a statement", [pick(language.statements), line], None
        case "cut":
            return "cut a line", [line[:end]], None
        case _:
            at = int(rng.integers(len(own)))
            return "another character", put(own[:at] + pick(list("AXZ071_-.")) + own[at + 1 :]), None


def _number(own: str, rng: np.random.Generator) -> str:
    decimals = len(own.partition(".")[2])
    match int(rng.integers(4)):
        case 0:
            moved = Fraction(own) + int(rng.choice([-2, -1, 1, 2])) * Fraction(1, 10**decimals)
            return f"{float(moved):.{decimals}f}"
        case 1:
            return own[1:] if own.startswith("-") else f"-{own}"
        case 2:
            at = int(rng.choice([k for k, digit in enumerate(own) if digit.isdigit()]))
            return own[:at] + "0123456789"[int(rng.integers(10))] + own[at + 1 :]
        case _:
            return f"{own}0" if "." in own else f"{own}.0"


def _forgiven(own: str, new: str, rounded: bool) -> str | None:
    change = abs(Fraction(new) - Fraction(own))
    if not change:
        return "zeros of a number"
    unit = Fraction(1, 10 ** len(own.partition(".")[2]))
    return "last printed digit" if rounded and change <= unit else None
