"""Names in INFORM: jobs are called in eight capitals, which the oldest controllers in use take, too."""

from __future__ import annotations

from zerorev.program.inform.text import INFORM_COMMENTS
from zerorev.program.names import Names, label

__all__ = ["INFORM_NAMES", "inform_label"]

INFORM_NAMES = Names(longest=8, capitals=True, prefix="J")


def inform_label(hole_id: str) -> str:
    """What a comment calls a hole."""
    return label(hole_id, INFORM_COMMENTS)
