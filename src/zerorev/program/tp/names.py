"""Names in TP: what every controller takes, and what a call may hand over."""

from __future__ import annotations

import re

from zerorev.model.controller import Call
from zerorev.program.names import Names
from zerorev.program.tp.text import LONGEST_TEXT

__all__ = ["TP_NAMES", "argument", "called"]

TP_NAMES = Names(8, prefix="DRILL_", capitals=True)
"""Eight characters, which the oldest controllers take; newer ones are said to take 36."""


def argument(text: str) -> str | None:
    """An argument of a call as TP has it: a number, or a text in single quotes; None of anything else.

    Args:
        text: a literal of a job's call.
    """
    if re.fullmatch(r"[0-9]+(\.[0-9]+)?", text):
        return text
    if re.fullmatch(rf'"[^\'";]{{1,{LONGEST_TEXT}}}"', text):
        return f"'{text[1:-1]}'"
    return None


def called(call: Call) -> str:
    """The statement that calls a program of the controller; its arguments are such as `argument` takes."""
    arguments = ", ".join(argument(each) or "" for each in call.arguments)
    return f"CALL {call.name.upper()}({arguments})" if arguments else f"CALL {call.name.upper()}"
