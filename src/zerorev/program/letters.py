"""What every language of a controller can print: ASCII, comments that are wrapped, and numbers with fixed decimals."""

from __future__ import annotations

import re
import textwrap
import unicodedata
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

__all__ = ["Comments", "degrees", "fixed", "in_ascii", "settled"]


@dataclass(frozen=True)
class Comments:
    """How a language has its comments.

    Attributes:
        sign: what begins one.
        width: characters of a line, at most.
        instead: what is written for characters that mean something in a comment, by their codes.
        narrow: whether lines are too short for columns.
    """

    sign: str
    width: int = 100
    instead: Mapping[int, str] = field(default_factory=dict)
    narrow: bool = False

    @property
    def rule(self) -> str:
        """A line across."""
        return f"{self.sign} ".ljust(self.width, "-")

    def clean(self, text: str) -> str:
        """A text on one line, in printable ASCII, without the characters that mean something in a comment."""
        one_line = " ".join(in_ascii(text).split())
        return re.sub(r"[^ -~]", "?", one_line).translate(self.instead)

    def lines(self, text: str, *, first: str = "", longest: int = 0) -> list[str]:
        """Comment lines of a text, wrapped; `first` leads the first line and the others are indented by as much.

        A comment ends with its line, and source is ASCII: what cannot stand is replaced.

        Args:
            text: any.
            first: before it.
            longest: characters of the text, at most; 0: all.
        """
        plain = self.clean(text)
        if longest and len(plain) > longest:
            plain = plain[: longest - 3] + "..."
        if self.narrow and first:
            first = f"{first.strip()} "
        indents = f"{self.sign} {first}", f"{self.sign} " + " " * (min(len(first), 1) if self.narrow else len(first))
        # an id with hyphens stays in one piece
        return textwrap.wrap(
            plain, self.width, initial_indent=indents[0], subsequent_indent=indents[1], break_on_hyphens=False
        ) or [self.sign]


def in_ascii(text: str) -> str:
    """Accents taken off their letters, everything else beyond ASCII made a question mark."""
    spread = unicodedata.normalize("NFKD", text)
    return "".join(c for c in spread if not unicodedata.combining(c)).encode("ascii", "replace").decode("ascii")


def fixed(value: float, decimals: int = 4) -> str:
    """A number with fixed decimals, never a negative zero."""
    return f"{round(float(value), decimals) + 0.0:.{decimals}f}"


def degrees(angle: float, decimals: int = 4) -> str:
    """An angle [rad] in degrees, wrapped to (-180, 180] after it is rounded, so that -180 is not written."""
    rounded = round(float(np.rad2deg(angle)), decimals)
    return fixed(rounded - 360.0 * np.ceil((rounded - 180.0) / 360.0), decimals)


def settled(value: float, decimals: int = 4) -> str:
    """A number above 0 as `fixed`, but one just between two decimals always goes down: its last bits do not decide."""
    return fixed(value - 1e-4 * 10.0**-decimals, decimals)
