"""Text of unknown origin, made visible: what a terminal, a page or an editor would obey instead of show.

Control characters move the cursor, hide text, or run what a terminal has to offer; marks of direction show a line in
another order than it is read by machines; separators of lines begin lines that nobody wrote. Text that comes out of a
file goes through `one_line` when it is read, a message through `visible` when it is made, and everything that is
written through the same characters once more: `terminal` and the writers of JSON, YAML and CSV do so for all that they
write.
"""

from __future__ import annotations

import re

__all__ = ["as_json", "is_visible", "one_line", "table_cell", "visible"]

# all of Unicode's Cc (control), Cf (format; marks of direction are among them), Cs (halves of characters), Zl and Zp
# (separators of lines), but the line feed and the tab
_UNSEEN = (
    r"\x00-\x08\x0b-\x1f\x7f-\x9f\xad\u0600-\u0605\u061c\u06dd\u070f\u0890\u0891\u08e2\u180e\u200b-\u200f"
    r"\u2028-\u202e\u2060-\u2064\u2066-\u206f\ud800-\udfff\ufeff\ufff9-\ufffb\U000110bd\U000110cd"
    r"\U00013430-\U0001343f\U0001bca0-\U0001bca3\U0001d173-\U0001d17a\U000e0001\U000e0020-\U000e007f"
)
_IN_LINES = re.compile(f"[{_UNSEEN}]")
_IN_A_LINE = re.compile(f"[{_UNSEEN}\t\n]")
_FORMULA = re.compile(r"[=+\-@\t\r\n]")
_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")


def visible(text: str) -> str:
    r"""The text with all that is unseen in it written out, as `\x1b` or `\u202e`; line feeds and tabs stay."""
    return _IN_LINES.sub(_written_out, text)


def one_line(text: str) -> str:
    r"""The same on one line: `\n` and `\t` are written out, too."""
    return _IN_A_LINE.sub(_written_out, text)


def is_visible(text: str) -> bool:
    """Whether `visible` leaves a text as it is."""
    return _IN_LINES.search(text) is None


def as_json(text: str) -> str:
    """JSON with the same meaning in which nothing is unseen: in JSON that can only stand within texts."""
    return _IN_LINES.sub(_escaped, text)


def table_cell(text: str) -> str:
    """A text as one cell of a CSV file: on one line, and no formula to the spreadsheet that opens it."""
    shown = one_line(text)
    return f"'{shown}" if _FORMULA.match(shown) and not _NUMBER.fullmatch(shown) else shown


def _written_out(match: re.Match[str]) -> str:
    return match.group().encode("unicode_escape").decode("ascii")


def _escaped(match: re.Match[str]) -> str:
    units = match.group().encode("utf-16-be", "surrogatepass").hex()
    return "".join(f"\\u{units[n : n + 4]}" for n in range(0, len(units), 4))
