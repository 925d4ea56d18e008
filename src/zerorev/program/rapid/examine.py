"""What RAPID asks of a program beyond what every language does, as findings."""

from __future__ import annotations

from collections.abc import Iterator

from zerorev.model.finding import Finding
from zerorev.program.neutral import Program
from zerorev.program.rapid.controller import problems

__all__ = ["examine"]


def examine(program: Program) -> tuple[Finding, ...]:
    """Look at a program before it is written in RAPID; an error among the findings stops the export."""
    return (
        *(Finding("error", "controller", problem) for problem in problems(program)),
        *_corner(program),
    )


def _corner(program: Program) -> Iterator[Finding]:
    """What is open of the way in which the corner is passed; a stop, too, where joint moves would leave the axis."""
    kind = program.settings.turning.kind
    if kind == "blend":
        message = (
            "the corner is a zone between two MoveL that lead straight in and straight back: whether an ABB passes it "
            "without a stop of all joints is not known; try it in RobotStudio, or plan with corner: joint"
        )
        yield Finding("warning", "controller", message)
    elif kind == "stop":
        yield Finding("warning", "controller", "the corner is an exact stop, at which all joints rest")
    else:
        for hole in program.holes:
            if hole.corner_move.linear and hole.corner_move.blend > 0:
                message = "the plan has no joint moves at the corner, which is to be passed by them: plan it again"
                yield Finding("error", "controller", message, hole.id)
            elif hole.corner_move.blend == 0:
                message = "the corner is an exact stop, at which all joints rest, for joint moves would leave the axis"
                yield Finding("warning", "controller", message, hole.id)
