"""Colours and dashes that mean the same in every figure and on the page; light to import, as the page needs it."""

from __future__ import annotations

from typing import Any

__all__ = [
    "BASELINE_COLOUR",
    "CANNOT_RUN",
    "DASHES",
    "INK",
    "JOINT_COLOURS",
    "JOINT_INKS",
    "MUTED",
    "REVERSAL_COLOURS",
    "signed",
]

# Okabe and Ito's colours, which stay apart for colour-blind eyes; one per joint, the same in every figure
JOINT_COLOURS = ("#0072B2", "#E69F00", "#009E73", "#D55E00", "#CC79A7", "#56B4E9")
# the same, dark enough for letters on white
JOINT_INKS = ("#005a8f", "#8a5f00", "#00694c", "#a84a00", "#99487a", "#1c6d9e")
# 0, 1, ... 5, and 6 or more reversals: none is blue, some are the darker the more; and a motion that cannot be run
REVERSAL_COLOURS = ("#0072B2", "#ffe8a3", "#fec44f", "#fb9a3c", "#e5691b", "#b53d0b", "#671f0a")
CANNOT_RUN = "#b8b8b8"
# can be distinguished without colour, too
DASHES: tuple[Any, ...] = (
    "-",
    (0, (6, 1.5)),
    (0, (3, 1)),
    (0, (6, 1.2, 1.2, 1.2)),
    (0, (1.2, 0.9)),
    (0, (9, 1.5, 3, 1.5)),
)
INK, MUTED, BASELINE_COLOUR = "#1a1a1a", "#5c5c5c", "#7f7f7f"


def signed(value: float, digits: int) -> str:
    """A number with its sign, a real minus, and never -0."""
    rounded = round(float(value), digits) + 0.0
    return f"{rounded:+.{digits}f}".replace("-", "−") if rounded else f"{0:.{digits}f}"
