"""The thesis, figure by figure and table by table: its numbers, ours by its own method, ours by the exact method."""

from __future__ import annotations

from zerorev.thesis.reproduce.chapters import CHAPTERS
from zerorev.thesis.reproduce.context import SEEDS, Context
from zerorev.thesis.reproduce.runner import PAGE, reproduce

__all__ = ["CHAPTERS", "PAGE", "SEEDS", "Context", "reproduce"]
