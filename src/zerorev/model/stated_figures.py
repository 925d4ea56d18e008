"""What an answer is made of, as it is stated (`zerorev.model.stated`): figures, counts and texts."""

from __future__ import annotations

from dataclasses import dataclass

from zerorev.model.stated import UNSET, Number, Stated

__all__ = ["Count", "Figure", "SixCounts", "SixFigures", "Text", "Texts"]


@dataclass(frozen=True, kw_only=True)
class Figure(Number):
    """One number that was computed; its range goes without saying.

    Attributes:
        null: what null means inside, where a file may have it.
    """

    most: float | None = 1e15
    null: object = UNSET

    @property
    def nullable(self) -> bool:
        """Whether a file may have null."""
        return self.null is not UNSET

    @property
    def span(self) -> str:
        """Nothing."""
        return ""

    @property
    def or_null(self) -> str:
        """What goes before the meaning of null."""
        return "; or null: " if self.added else "; null: "


class SixFigures(Figure):
    """A computed number for each joint, in an array; NaN, null in a file, where it is undefined."""

    what = "six numbers"


class Count(Stated):
    """A whole number that was counted."""

    what = "a whole number"


@dataclass(frozen=True, kw_only=True)
class SixCounts(Stated):
    """A count for each joint, in a tuple.

    Attributes:
        total: key of their sum, which stands before them in a file; empty: it does not.
    """

    total: str = ""

    what = "six whole numbers"


class Text(Stated):
    """A text."""

    what = "text"


class Texts(Stated):
    """Texts, in a tuple."""

    what = "a list of text"
