"""INFORM among the dialects."""

from __future__ import annotations

from zerorev.model.corner import CONTROLLERS
from zerorev.program.dialect import Dialect
from zerorev.program.inform.examine import examine
from zerorev.program.inform.names import INFORM_NAMES
from zerorev.program.inform.read import alike, read_job, read_starter
from zerorev.program.inform.write import inform_jobs, most_holes
from zerorev.program.neutral import Program
from zerorev.program.notes import notes

__all__ = ["INFORM"]


def _most_holes(program: Program) -> int | None:
    return most_holes(program, (*notes(program), *examine(program)))


INFORM = Dialect(
    CONTROLLERS["inform"],
    ".JBI",
    INFORM_NAMES,
    alike,
    inform_jobs,
    read_job,
    read_starter,
    lambda part: ("CALL", "JOB:", part),
    "TOOL",
    examine=examine,
    weighs_digits=True,
    most_holes=_most_holes,
    no_retract="before it moves it has to see that the tool stands in this hole, and in which frame and units a job "
    "reads its own position (GETS $PX001) is not known for sure; jog the drill out along Z of the tool",
)
