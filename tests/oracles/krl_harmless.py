"""What the name of a harmless mutation claims, proven from the two texts alone."""

from __future__ import annotations

import re
from collections.abc import Callable
from fractions import Fraction

from oracles.krl_reader import commands


def _statements(text):
    """Lines without comments, as they are printed."""
    return [code for line in text.split("\n") if (code := line.partition(";")[0].rstrip()) and code[0] != "&"]


def _bare(text):
    return re.sub(r"[ \t\n]", "", text)


def _one_last_digit(old, new):
    """One number differs, by one in the last digit that is printed, in a point or a frame."""
    pairs = [(a, b) for a, b in zip(commands(old), commands(new), strict=True) if a != b]
    if len(pairs) != 1 or len(pairs[0][0]) != len(pairs[0][1]):
        return False
    ((a, b),) = pairs
    differ = [k for k, (x, y) in enumerate(zip(a, b, strict=True)) if x != y]
    if len(differ) != 1 or "{" not in a:
        return False
    k = differ[0]
    decimals = 5 if a[0] == "PTP" else 6 if a[0] != "LIN" and a[k - 1] in ("A", "B", "C") else 4
    return abs(a[k] - b[k]) <= Fraction(1, 10**decimals)


PROOFS: dict[str, Callable[[str, str], bool]] = {
    "white space": lambda old, new: _bare(old) == _bare(new),
    "case of a name": lambda old, new: old.lower() == new.lower(),
    "comment": lambda old, new: _statements(old) == _statements(new),
    "file header": lambda old, new: old[old.index("DEF") :] == new[new.index("DEF") :],
    "line ending": lambda old, new: old == new.replace("\r\n", "\n"),
    "zeros of a number": lambda old, new: re.sub(r"[-.0]", "", old) == re.sub(r"[-.0]", "", new),
    "last printed digit": _one_last_digit,
}
"""Why a mutation is harmless. All but the last leave every command as it was, which is proven besides."""
