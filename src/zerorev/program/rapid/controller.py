"""RAPID of what fits a program to its controller: tool, load, work object, calls; and what RAPID cannot say."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from zerorev.errors import NotExportableError
from zerorev.model._arrays import Array, rotation_rpy, transform
from zerorev.model.controller import Call, Calls
from zerorev.model.dynamics import Load
from zerorev.model.job import Settings
from zerorev.model.tool import Tool
from zerorev.program.dialect import Z_ALONG_PLUNGE
from zerorev.program.letters import fixed
from zerorev.program.neutral import Program
from zerorev.program.rapid.names import KEPT, part_frame, tool
from zerorev.program.rapid.text import UNIT, aggregate, pose, quaternion

__all__ = ["called", "frames", "not_set", "problems", "refuse"]

LIGHTEST = 1e-3  # [kg], as it is printed: a load of 0 is an error on the controller
INERTIA_DECIMALS = 6


def frames(program: Program, name: str, T_base_object: Array) -> list[str]:
    """The tool with what it weighs, and a work object, as a module called so declares them."""
    T = program.tool.T_flange_tcp @ Z_ALONG_PLUNGE
    load = program.tool.load
    assert load is not None  # `refuse` has seen to it
    user_frame = pose(_in_world(program, T_base_object))
    return [
        f"PERS tooldata {tool(name)}:=[TRUE,[{pose(T)}],{_load(load)}];",
        f'PERS wobjdata {part_frame(name)}:=[FALSE,TRUE,"",[{user_frame}],[[0,0,0],{UNIT}]];',
    ]


def _in_world(program: Program, T_base_object: Array) -> Array:
    """A frame, given from the arm's base, in the controller's world, shape (4, 4), translation [m]."""
    T_base_object = np.asarray(np.linalg.inv(program.robot.T_root_base) @ T_base_object)
    root = program.settings.robroot
    if not isinstance(root, tuple):
        return T_base_object
    x, y, z, roll, pitch, yaw = root
    return np.asarray(transform(rotation_rpy(roll, pitch, yaw), np.array([x, y, z])) @ T_base_object)


def _load(load: Load) -> str:
    """Mass, its centre in the flange frame, axes of inertia that lie there, and the moments about these."""
    R, moments = np.eye(3), np.diag(load.inertia)
    if np.abs(load.inertia - np.diag(moments)).max() > 1e-9 * max(moments.max(), 1e-9):
        moments, R = np.linalg.eigh(load.inertia)
        R[:, 2] *= np.sign(np.linalg.det(R))
    turned = UNIT if (np.eye(3) == R).all() else aggregate(fixed(q, 6) for q in quaternion(R))
    centre = aggregate(fixed(length * 1e3) for length in load.com)
    return aggregate(
        [fixed(load.mass), centre, turned, *(fixed(max(moment, 0.0), INERTIA_DECIMALS) for moment in moments)]
    )


def called(calls: Sequence[Call]) -> list[str]:
    """The statements that call procedures of the controller; they stand where the robot does."""
    return [f"{call.name} {','.join(call.arguments)}".rstrip() + ";" for call in calls]


def not_set(settings: Settings) -> Iterator[str]:
    """What an operator has to know of spindle, frames and outer axes, one sentence each."""
    by_calls = "" if settings.calls == Calls() else ", but by the calls that the job states"
    yield f"Spindle and coolant are not set here{by_calls}. The spindle must run before the drill enters."
    if settings.robroot is not None:
        place = ", ".join(fixed(value * 1e3, 3) for value in settings.robroot[:3] if isinstance(value, float))
        yield f"The work object is given in the world, in which the robot's base stands at x, y, z {place} mm."
    else:
        yield "The work object is given from the robot's base: it holds where the base frame is not moved in the world."
    if settings.external_axes:
        places = ", ".join(f"eax_{'abcdef'[int(axis.name[1]) - 1]} {fixed(axis.at)}" for axis in settings.external_axes)
        yield f"Every move names the external axes: {places}."


def refuse(program: Program, own: Iterable[str] = ()) -> None:
    """Refuse what RAPID cannot say, or says otherwise.

    Raises:
        NotExportableError: there is something.
    """
    if reasons := tuple(problems(program, own)):
        raise NotExportableError(reasons)


def problems(program: Program, own: Iterable[str] = ()) -> Iterator[str]:
    """What RAPID cannot say of a program, or a controller refuses to run, one sentence each, with the cure.

    Args:
        program: with its settings.
        own: procedures of the program.
    """
    yield from _load_problems(program.tool)
    yield from _setting_problems(program.settings)
    ours = {name.upper() for name in own}
    for place, calls in program.settings.calls.places():
        for call in calls:
            if call.name.upper() in KEPT:
                yield f"{call.name}, called {place}, is a word or an instruction of RAPID, not a procedure of yours"
            elif call.name.upper() in ours:
                yield f"{call.name}, called {place}, is this program itself"
            elif odd := next((each for each in call.arguments if each[0] == "#" or "\\" in each), None):
                yield (
                    f"{odd}, with which {call.name} is called {place}, is nothing that RAPID reads: a number, TRUE, "
                    "FALSE, or a text without a backslash is"
                )


def _load_problems(tool: Tool) -> Iterator[str]:
    if tool.load is None:
        why = "a controller refuses a load of 0: state mass_kg and com_mm in the tool file"
        yield f"RAPID writes what the tool weighs, which is not known of {tool.name}; {why}"
    elif tool.load.mass < LIGHTEST:
        why = "a controller refuses a load of 0: state the mass with drill and holder"
        yield f"mass_kg of {tool.name} is {tool.load.mass:g} kg, which RAPID writes as 0; {why}"
    elif not tool.load.com.any():
        why = "state com_mm in the tool file"
        yield f"the centre of mass of {tool.name} lies in the flange's own origin, which a controller may refuse; {why}"


def _setting_problems(settings: Settings) -> Iterator[str]:
    stated = {
        "tool_number": settings.tool_number is not None,
        "base_number": settings.base_number is not None,
        "header": bool(settings.header),
        f"robroot: {settings.robroot}": isinstance(settings.robroot, str),
    }
    if names := [name for name, given in stated.items() if given]:
        yield f"{', '.join(names)}: made for KUKA's controllers, without a form in RAPID; leave them out of the job"
