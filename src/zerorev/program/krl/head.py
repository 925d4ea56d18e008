"""The comment block of a KRL program: what an operator should read before pressing start."""

from __future__ import annotations

from zerorev.program.krl.controller import not_set
from zerorev.program.neutral import Program

__all__ = ["sentences"]

SAFETY = (
    "Run the program in T1 first, the spindle off and no part in place.",
    "PTP moves are checked against the surface of the part alone, and the first one not at all: not for fixtures, "
    "the cell or the arm's own links.",
    "$TOOL, $BASE and the speeds are set at the top: after a reset do not start from a line further down.",
    "After a stop in a hole pull the drill out along the drill axis (tool X) before a new start: a PTP comes first.",
)

FRAMES = (
    "$TOOL has X along the plunge, so A and B are constant along a hole and only C varies: it falls by as much as psi "
    "grows. C is written within (-180, 180]. No LIN turns the tool by more than 120 deg: the short way round is meant.",
)


def sentences(program: Program) -> tuple[str, ...]:
    """What has to be known before the program, or a part of it, is started."""
    return (*SAFETY[:2], *not_set(program.settings), *SAFETY[2:], *FRAMES)
