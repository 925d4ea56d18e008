"""TP among the dialects."""

from __future__ import annotations

from zerorev.model.corner import CONTROLLERS
from zerorev.model.finding import Finding
from zerorev.program.dialect import Dialect
from zerorev.program.neutral import Program
from zerorev.program.tp.examine import examine
from zerorev.program.tp.names import TP_NAMES
from zerorev.program.tp.read import read_starter, read_tp
from zerorev.program.tp.source import alike
from zerorev.program.tp.write import most_holes, too_large, tp_programs

__all__ = ["TP"]


def _examine(program: Program) -> tuple[Finding, ...]:
    return (*examine(program), *too_large(program))


TP = Dialect(
    CONTROLLERS["tp"],
    ".ls",
    TP_NAMES,
    alike,
    tp_programs,
    read_tp,
    read_starter,
    lambda part: ("CALL", part),
    "the user frame",
    examine=_examine,
    most_holes=most_holes,
    no_retract="before it moves it has to see that the tool stands in this hole, for which it would write over "
    "position registers, registers and a user frame of the controller, and they belong to somebody; jog the drill out "
    "along Z of the tool",
)
