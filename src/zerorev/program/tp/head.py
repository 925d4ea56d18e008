"""The comment block of a TP program: what an operator should read before pressing start."""

from __future__ import annotations

from collections.abc import Iterator

from zerorev.model._arrays import Array
from zerorev.model.controller import Calls
from zerorev.program.dialect import Z_ALONG_PLUNGE
from zerorev.program.neutral import Program
from zerorev.program.tp.listing import lengths_and_angles, part_in_world

__all__ = ["sentences"]


def sentences(program: Program) -> tuple[str, ...]:
    """What has to be known before the program, or a part of it, is started."""
    return (
        "Run the program in T1 first, the spindle off and no part in place.",
        *_frames(program),
        *_not_set(program),
        "J moves at 20 % are checked against the surface of the part alone, and the first one not at all: not for "
        "fixtures, the cell or the arm's own links.",
        "Start at line 1: the numbers of the frames are set there.",
        "After a stop in a hole pull the drill out along the drill axis (tool Z) before a new start: a J comes first.",
        *_corner(program),
        "Open, not tried on a controller: CNT100 from L to J and back, moves of a few ms, the letters of CONFIG. If an "
        "L stops with a position or configuration alarm, stop there.",
    )


def _frames(program: Program) -> Iterator[str]:
    settings, tool = program.settings, program.tool.T_flange_tcp @ Z_ALONG_PLUNGE
    yield (
        f"UTOOL {settings.tool_number} is selected, not set. It must hold {_values(tool)} (flange to tip, Z along the "
        "plunge)."
    )
    counted = "the world frame, which counts Z from the height of axis 2" if program.robot.base_in_root else "world"
    if settings.base_number is None:
        yield f"UFRAME 0: points are given in {counted}."
    else:
        yield (
            f"UFRAME {settings.base_number} is selected, not set. It must hold {_values(part_in_world(program))}, "
            f"given in {counted}. Do not correct it for a part that was measured again: J moves would stay where they "
            "are. Plan again."
        )
    if program.robot.display.j3_less_j2:
        yield "J3 is printed as the pendant shows it: its angle against the ground."


def _not_set(program: Program) -> Iterator[str]:
    by_calls = "" if program.settings.calls == Calls() else ", but by the calls that the job states"
    yield (f"Spindle, coolant and PAYLOAD are not set here{by_calls}. The spindle must run before the drill enters.")


def _corner(program: Program) -> Iterator[str]:
    turning = program.settings.turning
    if turning.kind == "stop":
        return
    spins = ", and on those between them the tool spins on" if turning.kind == "spin" else ""
    yield (
        f"The last of the plunge and the first of the retract{spins} are J moves by time (msec), blended with CNT100. "
        "How far CNT reaches depends on speed, acceleration and override and is not known: "
        f"{turning.interval[0] * 1e3:g} to {turning.interval[1] * 1e3:g} mm of depth are lost there, at every "
        "override. Measure at the override with which you drill."
    )


def _values(T: Array) -> str:
    return ", ".join(f"{name} {value}" for name, value in zip("XYZWPR", lengths_and_angles(T), strict=True))
