"""KRL of what fits a program to its controller: frames, load, external axes, calls, lines of the header."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from zerorev.errors import NotExportableError
from zerorev.model._arrays import Array, rotation_rpy, transform
from zerorev.model.controller import Call, Calls
from zerorev.model.dynamics import Load
from zerorev.model.job import Settings
from zerorev.program.krl.names import KEPT
from zerorev.program.krl.text import T_TCP_TOOL, aggregate, frame_angles
from zerorev.program.letters import degrees, fixed
from zerorev.program.neutral import Program

__all__ = [
    "AT_REST", "AXIS_DECIMALS", "axis_target", "base", "called", "frame", "frames_and_load", "header", "not_set",
    "refuse_calls", "tool_and_load",
]  # fmt: skip

FRAME_ANGLE_DECIMALS, AXIS_DECIMALS = 6, 5
AT_REST = "WAIT SEC 0.0"  # holds the advance run back until the robot stands: what follows runs neither ahead nor late
HEADER = ("&ACCESS RVP", "&REL 1", "&COMMENT drilling without joint reversals")


def header(lines: Sequence[str]) -> list[str]:
    """The lines before `DEF`: the usual ones, or the job's own of the same word, and after them its others."""
    own = {line.split()[0].upper(): line for line in lines}
    usual = {line.split()[0]: line for line in HEADER}
    return [own.get(word, line) for word, line in usual.items()] + [
        line for line in lines if line.split()[0].upper() not in usual
    ]


def frames_and_load(program: Program) -> list[str]:
    """$TOOL, $BASE, and what display, PLC and supervision of a controller go by beside them."""
    number = program.settings.base_number
    numbered = [] if number is None else [f"$ACT_BASE={number}"]
    return [*tool_and_load(program), f"$BASE={base(program.T_base_part, program.settings)}", *numbered]


def tool_and_load(program: Program) -> list[str]:
    """$TOOL, its number, and what it weighs."""
    lines = [f"$TOOL={frame(program.tool.T_flange_tcp @ T_TCP_TOOL)}"]
    if (number := program.settings.tool_number) is not None:
        load = f"LOAD_DATA[{number}]" if program.tool.load is None else _load(program.tool.load)
        lines += [f"$ACT_TOOL={number}", f"$LOAD={load}"]
    return lines


def base(T_base_part: Array, settings: Settings) -> str:
    """The value of $BASE for a frame given from the robot's own base, shape (4, 4), translation [m]."""
    if isinstance(settings.robroot, str):
        return f"{settings.robroot}:{frame(T_base_part)}"
    if settings.robroot is None:
        return frame(T_base_part)
    x, y, z, roll, pitch, yaw = settings.robroot
    return frame(transform(rotation_rpy(roll, pitch, yaw), np.array([x, y, z])) @ T_base_part)


def _load(load: Load) -> str:
    """Mass, its centre in the flange frame, axes of inertia that lie there, and the moments about these."""
    R, moments = np.eye(3), np.diag(load.inertia)
    if np.abs(load.inertia - np.diag(moments)).max() > 1e-9 * max(moments.max(), 1e-9):
        moments, R = np.linalg.eigh(load.inertia)
        R[:, 2] *= np.sign(np.linalg.det(R))
    angles = [degrees(angle) for angle in frame_angles(R)]
    centre = aggregate("", "X Y Z A B C", [*(fixed(length * 1e3) for length in load.com), *angles])
    inertia = aggregate("", "X Y Z", [fixed(max(moment, 0.0), 6) for moment in moments])
    return aggregate("LOAD", "M CM J", [fixed(load.mass), centre, inertia])


def frame(T: Array) -> str:
    """A frame, shape (4, 4), translation [m], as KUKA has it."""
    angles = [degrees(angle, FRAME_ANGLE_DECIMALS) for angle in frame_angles(T[:3, :3])]
    return aggregate("FRAME", "X Y Z A B C", [*(fixed(x * 1e3) for x in T[:3, 3]), *angles])


def axis_target(joints: Array, settings: Settings) -> str:
    """Six axis values [rad], shape (6,), and those of the external axes where the job has any.

    Axis values carry the turns of A4 and A6, which a pose with S and T would leave to the controller.
    """
    values = [fixed(angle, AXIS_DECIMALS) for angle in np.rad2deg(joints)]
    if not settings.external_axes:
        return aggregate("AXIS", "A1 A2 A3 A4 A5 A6", values)
    outer = {axis.name: fixed(axis.at) for axis in settings.external_axes}
    names = " ".join(sorted(outer))
    return aggregate("E6AXIS", f"A1 A2 A3 A4 A5 A6 {names}", [*values, *(outer[name] for name in sorted(outer))])


def called(calls: Sequence[Call]) -> list[str]:
    """The statements that call programs of the controller, once the robot stands; none where nothing is called."""
    return [AT_REST, *(f"{call.name}({','.join(call.arguments) or ' '})" for call in calls)] if calls else []


def not_set(settings: Settings) -> Iterator[str]:
    """What an operator has to know of load, spindle, frames and outer axes, one sentence each."""
    load = " and payload ($LOAD)" if settings.tool_number is None else ""
    by_calls = "" if settings.calls == Calls() else ", but by the calls that the job states"
    spindle = f"Spindle, coolant{load}" if load else "Spindle and coolant"
    yield f"{spindle} are not set here{by_calls}. The spindle must run before the drill enters."
    if isinstance(settings.robroot, str):
        yield f"$BASE is given from the robot's own base, whose place in $WORLD is what {settings.robroot} holds."
    elif settings.robroot is not None:
        place = ", ".join(fixed(value * 1e3, 3) for value in settings.robroot[:3])
        turn = ", ".join(fixed(value, 4) for value in np.rad2deg(settings.robroot[:2:-1]))
        yield (
            f"$BASE is given in $WORLD, for a robot whose base ($ROBROOT) stands there at X, Y, Z {place} mm and "
            f"A, B, C {turn} deg."
        )
    else:
        yield "$BASE is given from the robot's own base: it holds as written where $ROBROOT equals $WORLD."
    if settings.external_axes:
        places = ", ".join(f"{axis.name} {fixed(axis.at)}" for axis in settings.external_axes)
        yield f"Every PTP brings the external axes to {places}. A LIN does not name them: they stay where they are."


def refuse_calls(program: Program, own: Iterable[str]) -> None:
    """Refuse a call that would be another statement, or that would start the program itself.

    Args:
        program: with its settings.
        own: names of the program and of its parts.

    Raises:
        NotExportableError: there is one.
    """
    ours = {name.upper() for name in own}
    reasons = []
    for place, calls in program.settings.calls.places():
        for call in calls:
            if call.name.upper() in KEPT:
                reasons.append(f"{call.name}, called {place}, is a word of KRL, not a program")
            elif call.name.upper() in ours:
                reasons.append(f"{call.name}, called {place}, is this program itself")
    if reasons:
        raise NotExportableError(tuple(reasons))
