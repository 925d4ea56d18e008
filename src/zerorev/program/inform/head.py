"""The comment block of an INFORM job: what an operator should read before pressing start."""

from __future__ import annotations

from collections.abc import Iterator

from zerorev.model._arrays import rpy_of
from zerorev.model.controller import Calls
from zerorev.program.dialect import Z_ALONG_PLUNGE
from zerorev.program.inform.text import BLENDED
from zerorev.program.letters import degrees, fixed
from zerorev.program.neutral import Program

__all__ = ["sentences", "tool_shown"]

FIRST = (
    "Run the job in teach mode first, the spindle off and no part in place.",
    "MOVJ moves with PL=0 are checked against the surface of the part alone, and the first one not at all: not for "
    "fixtures, the cell or the arm's own links.",
    "Positions are pulses. Before the first run compare pulses and angles of all six axes with the pendant, signs too.",
)
LAST = (
    "V= and VJ= hold at 100 percent of speed override.",
    "After a stop in a hole pull the drill out along the drill axis (tool Z) before a new start: a MOVJ comes first.",
)


def sentences(program: Program) -> tuple[str, ...]:
    """What has to be known before a job, or a part of it, is started."""
    return (*FIRST, *_tool(program), *_not_set(program), *_open(program), *LAST)


def tool_shown(program: Program) -> str:
    """The tool as the screen of the controller has it: X, Y, Z [mm] and Rx, Ry, Rz [deg], R = Rz Ry Rx."""
    T = program.tool.T_flange_tcp @ Z_ALONG_PLUNGE
    values = [*(fixed(x * 1e3, 3) for x in T[:3, 3]), *(degrees(angle) for angle in rpy_of(T[:3, :3]))]
    return ", ".join(f"{name} {value}" for name, value in zip(("X", "Y", "Z", "Rx", "Ry", "Rz"), values, strict=True))


def _tool(program: Program) -> Iterator[str]:
    yield (
        f"TOOL {program.settings.tool_number} must be on the controller {tool_shown(program)} (mm, deg), with its "
        "mass: the job has only its number, and V= and the straight line of MOVL are of its tip."
    )


def _not_set(program: Program) -> Iterator[str]:
    by_calls = "" if program.settings.calls == Calls() else ", but by the calls that the plan states"
    yield f"Spindle and coolant are not set here{by_calls}. The spindle must run before the drill enters."


def _open(program: Program) -> Iterator[str]:
    yield "Not yet tried on a controller: that MOVL between pulse positions turns the tool evenly about one axis."
    if program.settings.turning.kind in ("joint", "spin"):
        yield (
            f"Not yet tried either: that the corner is passed without a stop. How far PL={BLENDED} reaches is a "
            "setting of the controller; the depth lost to it is not in the job: measure it."
        )
