"""Mutations of a KRL program: every token of it, one at a time, in every way that a slip, an editor or a forger may.

Each mutation says by name why it is harmless, or that it is not: what is not must be refuted or refused.
`oracles.krl_harmless` proves a name.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from fractions import Fraction
from typing import NamedTuple

import numpy as np

ODD = ["\f", "\v", "\r", "\0", "\x1a", "\x1b", "\x1c", "\x1d", "\x1e", "\x7f", "\x85", "\xa0", "ä", "\u2028", "\u2029"]
WORDS = [
    "LIN",
    "PTP",
    "LIN_REL",
    "CIRC",
    "SLIN",
    "C_PTP",
    "C_VEL",
    "C_ORI",
    "#TCP",
    "#JOINT",
    "#CONSTANT",
    "$ACC.CP",
    "END",
]
STATEMENTS = [
    "HALT", "WAIT SEC 1", "$OUT[1]=TRUE", "$OV_PRO=50", "$VEL.CP=0.1", "$ACC.CP=9", "$APO.CDIS=0.5", "$ADVANCE=0",
    "BAS (#INITMOV,0 )", "BAS (#VEL_PTP,100 )", "BAS (#BASE,1 )", "$TOOL=TOOL_DATA[1]", "LIN_REL {X 1}", "GOTO a",
    "LIN {X 480.0000,Y 300.0000,Z 800.0000,A 0.0000,B 0.0000,C 0.0000} C_DIS", "PTP $POS_ACT", "END", "RETURN",
    "DEF other ( )", "TRIGGER WHEN DISTANCE=0 DELAY=0 DO $OUT[1]=TRUE", "INTERRUPT ON 3", "IF TRUE THEN", "x()",
]  # fmt: skip
LEXED = re.compile(r"(?P<word>[$#]?[A-Za-z_][\w.]*)|(?P<number>-?\d+(?:\.\d+)?)|(?P<sign>[{}(),:=])")


class Token(NamedTuple):
    """A piece of a text: a word, number, sign, comment, header line or newline, and the number of its line."""

    sort: str
    start: int
    end: int
    line: int


class Mutation(NamedTuple):
    kind: str
    text: str
    harmless: str | None


def tokens(text: str) -> list[Token]:
    """All but white space. The text is one that was just exported."""
    found, at = [], 0
    for number, line in enumerate(text.split("\n")):
        code, mark, _ = line.partition(";")
        if line.startswith("&"):
            found.append(Token("header", at, at + len(line), number))
        else:
            found += [Token(m.lastgroup, at + m.start(), at + m.end(), number) for m in LEXED.finditer(code)]
            if mark:
                found.append(Token("comment", at + len(code), at + len(line), number))
        at += len(line) + 1
        if at <= len(text):
            found.append(Token("newline", at - 1, at, number))
    return found


def mutations(text: str, count: int, seed: int) -> Iterator[Mutation]:
    """So many mutations: every token in turn, in an order and in ways drawn from the seed."""
    rng, all_tokens, made = np.random.default_rng(seed), tokens(text), 0
    while True:
        for at in rng.permutation(len(all_tokens)):
            if made == count:
                return
            mutation = None
            while mutation is None or mutation.text == text:
                ways = WAYS[all_tokens[at].sort]
                mutation = ways[rng.integers(len(ways))](Draw(text, all_tokens, int(at), rng))
            made += 1
            yield mutation


class Draw:
    """A token of a text, and what is around it."""

    def __init__(self, text, all_tokens, at, rng):
        self.text, self.tokens, self.at, self.rng = text, all_tokens, at, rng
        self.token = all_tokens[at]
        self.own = text[self.token.start : self.token.end]
        self.lines = text.split("\n")
        line = self.lines[self.token.line]
        self.code = "" if line.startswith("&") else line.partition(";")[0].strip()

    def pick(self, choices):
        return choices[self.rng.integers(len(choices))]

    def put(self, new, kind, harmless=None):
        """Something else in the place of the token."""
        return Mutation(kind, self.text[: self.token.start] + new + self.text[self.token.end :], harmless)

    def put_lines(self, lines, kind, harmless=None):
        return Mutation(kind, "\n".join(lines), harmless)

    @property
    def first(self):
        """Whether it is the first token of its line."""
        return self.at == 0 or self.tokens[self.at - 1].line < self.token.line

    def printed_to_the_last_digit(self):
        """Whether a unit in the last digit may differ: the numbers of points and frames."""
        return "{" in self.code


# --- words, numbers and signs -----------------------------------------------------------------------------------------


def delete(d):
    return d.put("", "delete a token")


def duplicate(d):
    return d.put(f"{d.own} {d.own}", "duplicate a token")


def swap(d):
    after = d.tokens[d.at + 1]
    if after.line != d.token.line or after.sort not in ("word", "number", "sign"):
        return None
    other = d.text[after.start : after.end]
    between = d.text[d.token.end : after.start]
    text = d.text[: d.token.start] + other + between + d.own + d.text[after.end :]
    return Mutation("swap two tokens", text, None)


def begin_comment(d):
    return d.put(f"; {d.own}", "a comment begins before a token")


def break_line(d):
    return d.put(f"\n{d.own}", "a line breaks before a token", "white space" if d.first else None)


def odd_before(d):
    return d.put(d.pick(ODD) + d.own, "an odd character in a statement")


def space_around(d):
    return d.put(
        d.pick([" {}", "{} ", "\t{}", "{}\t ", "  {}  "]).format(d.own), "white space around a token", "white space"
    )


def space_within(d):
    if len(d.own) < 2:
        return None
    at = int(d.rng.integers(1, len(d.own)))
    return d.put(d.own[:at] + " " + d.own[at:], "white space within a token")


def other_case(d):
    return d.put(d.pick([d.own.lower(), d.own.swapcase(), d.own.capitalize()]), "other case", "case of a name")


def other_letter(d):
    at = d.pick([k for k, letter in enumerate(d.own) if letter.isalnum()])
    letter = d.pick([a for a in "ABDEIKLMNOPRSTXZ" if a != d.own[at].upper()])
    return d.put(d.own[:at] + letter + d.own[at + 1 :], "another letter in a name")


def other_word(d):
    return d.put(d.pick([word for word in WORDS if word != d.own]), "another name")


def other_number(d, new, kind):
    """Names the change of a value by what it comes to."""
    change = abs(Fraction(new) - Fraction(d.own))
    unit = Fraction(1, 10 ** len(d.own.partition(".")[2])) if "." in d.own else 0
    if not change:
        return d.put(new, kind, "zeros of a number")
    return d.put(new, kind, "last printed digit" if change <= unit and d.printed_to_the_last_digit() else None)


def other_digit(d):
    at = d.pick([k for k, digit in enumerate(d.own) if digit.isdigit()])
    return other_number(d, d.own[:at] + d.pick("0123456789") + d.own[at + 1 :], "another digit")


def last_digit(d):
    decimals = len(d.own.partition(".")[2])
    moved = Fraction(d.own) + d.pick([-2, -1, 1, 2]) * Fraction(1, 10**decimals)
    return other_number(d, f"{float(moved):.{decimals}f}", "another last digit")


def other_sign(d):
    return other_number(d, d.own[1:] if d.own.startswith("-") else f"-{d.own}", "another sign")


def more_zeros(d):
    new = f"{d.own}{'0' * int(d.rng.integers(1, 5))}" if "." in d.own else f"{d.own}.0"
    return other_number(d, new, "zeros behind a number")


def zeros_before(d):
    sign, digits = ("-", d.own[1:]) if d.own.startswith("-") else ("", d.own)
    return other_number(d, f"{sign}00{digits}", "zeros before a number")


def times_ten(d):
    whole, _, decimals = d.own.partition(".")
    return other_number(
        d, f"{whole}{decimals[:1]}.{decimals[1:] or 0}" if decimals else f"{whole}0", "ten times a number"
    )


def another_notation(d):
    return d.put(
        d.pick([f"{d.own}e1", f"{d.own}E-1", f"+{d.own}", f"'H{d.own}'", f"{d.own}*1", f"({d.own})", f".{d.own}"]),
        "an expression for a number",
    )


# --- lines ------------------------------------------------------------------------------------------------------------


def delete_line(d):
    return d.put_lines(d.lines[: d.token.line] + d.lines[d.token.line + 1 :], "delete a line")


def duplicate_line(d):
    return d.put_lines([*d.lines[: d.token.line + 1], *d.lines[d.token.line :]], "duplicate a line")


def move_line(d):
    """To another place among the statements, so that their order is another one."""
    rest = d.lines[: d.token.line] + d.lines[d.token.line + 1 :]
    to = int(d.rng.integers(len(rest) + 1))
    moved = [*rest[:to], d.lines[d.token.line], *rest[to:]]
    order = [[line.partition(";")[0].strip() for line in lines] for lines in (d.lines, moved)]
    if [line for line in order[0] if line] == [line for line in order[1] if line]:
        return None  # only past comments
    return d.put_lines(moved, "move a line")


def comment_out_line(d):
    return d.put_lines(
        [*d.lines[: d.token.line], f";{d.lines[d.token.line]}", *d.lines[d.token.line + 1 :]], "comment out"
    )


def hide_line(d):
    hidden = f"; see{d.pick(ODD)}{d.lines[d.token.line]}"
    return d.put_lines([*d.lines[: d.token.line], hidden, *d.lines[d.token.line + 1 :]], "hide a line in a comment")


def insert_statement(d):
    end = d.pick(["", " ; a comment"])
    new = [*d.lines[: d.token.line], d.pick(STATEMENTS) + end, *d.lines[d.token.line :]]
    return d.put_lines(new, "insert a statement")


# --- comments, header, ends of lines ----------------------------------------------------------------------------------


def other_comment(d):
    return d.put(
        d.pick(["", ";", "; LIN {X 1}", d.own + " and more", d.own.upper(), ";FOLD Hole 7 of 9: x", ";%{PE}%R 8"]),
        "another comment",
        "comment",
    )


def odd_in_comment(d):
    at = int(d.rng.integers(1, len(d.own) + 1))
    odd = d.pick(ODD)
    harmless = "line ending" if odd == "\r" and at == len(d.own) else None
    return d.put(d.own[:at] + odd + d.own[at:], "an odd character in a comment", harmless)


def break_comment(d):
    at = int(d.rng.integers(1, len(d.own) + 1))
    rest = d.own[at:].strip()
    return d.put(
        d.own[:at] + "\n" + d.own[at:], "a line breaks in a comment", None if rest and rest[0] != ";" else "comment"
    )


def uncomment(d):
    return d.put(d.own[1:], "a comment made a statement") if d.own[1:].strip() else None


def other_header(d):
    keyword, _, rest = d.own.partition(" ")
    return d.put(
        d.pick(["", f"{keyword} 9{rest}", f"{d.own}\n&PARAM EDITMASK = *", f"& {d.own[1:]}", d.own.lower()]),
        "another header",
        "file header",
    )


def spoilt_header(d):
    return d.put(
        d.pick([d.own[1:], f"&NO{d.own[1:]}", f"{d.own[:2]}{d.pick(ODD)}{d.own[2:]}", f" {d.own}", f"{d.own}\nHALT"]),
        "a spoilt header",
    )


def late_header(d):
    after = 1 + next(k for k, line in enumerate(d.lines) if line.startswith("DEF"))
    return d.put_lines([*d.lines[:after], d.own, *d.lines[after:]], "a header behind DEF")


def end_of_line(d):
    return d.put("\r\n", "another end of a line", "line ending")


def ends_of_lines(d):
    return Mutation("other ends of all lines", d.text.replace("\n", "\r\n"), "line ending")


def odd_end(d):
    """An end of a line that is none, where it would join what stands in the line behind it to a comment."""
    return d.put(d.pick(["\r", "\v", "\f", "\x85", "\u2028", "\u2029", "\x1e"]), "a line that ends in an odd way")


def join_lines(d):
    after = d.lines[d.token.line + 1]
    if after.startswith("&"):
        return d.put("", "two lines joined", "file header")
    code = after.partition(";")[0].strip()
    return d.put(" ", "two lines joined", None if code else "comment" if after else "white space")


def blank_line(d):
    return d.put(d.pick(["\n\n", "\n \t\n", "  \n"]), "white space between lines", "white space")


ANY = [
    delete, duplicate, swap, begin_comment, break_line, odd_before, space_around, space_within, delete_line,
    duplicate_line, move_line, comment_out_line, hide_line, insert_statement,
]  # fmt: skip
VALUES = [other_digit, last_digit, other_sign, more_zeros, zeros_before, times_ten, another_notation]
WAYS: dict[str, list[Callable[[Draw], Mutation | None]]] = {
    "word": [*ANY, other_case, other_letter, other_word, other_letter, other_word],
    "number": [*ANY, *VALUES, *VALUES],
    "sign": ANY,
    "comment": [other_comment, odd_in_comment, break_comment, uncomment, insert_statement],
    "header": [other_header, spoilt_header, late_header],
    "newline": [end_of_line, ends_of_lines, odd_end, join_lines, blank_line],
}
