"""Sweeps as KRL: PTP moves of one axis at a time, with exact stops."""

from __future__ import annotations

from importlib.metadata import version as installed_version

import numpy as np

from zerorev.model._arrays import Array
from zerorev.program.krl.controller import AXIS_DECIMALS
from zerorev.program.krl.names import KRL_NAMES, krl_label
from zerorev.program.krl.text import KRL_COMMENTS, aggregate
from zerorev.program.krl.write import PTP_ACCELERATION, PTP_SPEED
from zerorev.program.letters import fixed
from zerorev.program.refusals import refuse_other_makers
from zerorev.program.sweeps import AMPLITUDE, Sweep, Sweeps

__all__ = ["sweeps_to_krl"]

REST = "WAIT SEC 0.5"  # lets friction come to rest, and stops the advance run before the override is lowered

SAFETY = (
    "Run the program in T1 first, the spindle off and no part in place: every axis moves, and the tool with it.",
    "Nothing may stand in the box that the tip passes through (below), nor where links, hoses and cables pass.",
    "PTP moves are not checked for collisions, the first one least of all.",
    "Payload ($LOAD) is not set here: set what is mounted, and mount what is used to drill.",
    "The override is only ever lowered. Start at 100 percent; at less all is slower. Set it by hand afterwards.",
    "After a stop start from the first line again.",
    "Record axis positions and torques of all axes from before the start until after the end, every 12 ms or finer.",
)


def sweeps_to_krl(sweeps: Sweeps, name: str, *, version: str | None = None) -> str:
    """The text of a .src file; the file must be called like the program in it.

    Args:
        sweeps: what to write.
        name: of the program, made a KRL identifier.
        version: of zerorev, stated in the comment block; by default the installed one.

    Raises:
        NotExportableError: the robot is not a KUKA.
    """
    robot = sweeps.drilling.robot
    refuse_other_makers("krl", robot)
    lines = [
        "&ACCESS RVP", "&REL 1", "&COMMENT sweeps of single axes", f"DEF {KRL_NAMES.of(name)} ( )",
        "EXT BAS (BAS_COMMAND :IN,REAL :IN )",
        *_head(sweeps, version or installed_version("zerorev")),
        ";FOLD INI", "BAS (#INITMOV,0 )", f"BAS (#VEL_PTP,{PTP_SPEED} )", f"BAS (#ACC_PTP,{PTP_ACCELERATION} )",
        "$ADVANCE=1", ";ENDFOLD (INI)",
        _ptp(sweeps.posture),
    ]  # fmt: skip
    override = 100
    for number, sweep in enumerate(sweeps.sweeps, start=1):
        lines += _sweep(sweeps, sweep, f"Sweep {number} of {len(sweeps.sweeps)}", sweep.override < override)
        override = sweep.override
    return "\n".join([*lines, "END", ""])


def _head(sweeps: Sweeps, version: str) -> list[str]:
    robot, degrees = sweeps.drilling.robot, np.degrees(AMPLITUDE)
    tip = ", ".join(
        f"{axis} {fixed(low, 0)} to {fixed(high, 0)}"
        for axis, low, high in zip("XYZ", *(sweeps.box * 1e3), strict=True)
    )
    lasting = sum(4 * AMPLITUDE * sweep.cycles / sweep.speed for sweep in sweeps.sweeps)
    facts = (
        ("Robot     ", f"{robot.manufacturer} {robot.model} ({robot.name})"),
        ("Tool      ", sweeps.drilling.tool.name),
        ("Posture   ", f"where the motion of hole {krl_label(sweeps.drilling.hole.id)} begins"),
        ("Sweeps    ", f"{len(sweeps.sweeps)}, each axis alone, {degrees:.0f} deg to either side"),
        ("Tip       ", f"{tip} [mm], robot base"),
        ("Lasts     ", f"some {lasting / 60 + 1:.0f} minutes"),
    )
    lines = [KRL_COMMENTS.rule, *KRL_COMMENTS.lines(f"Written by zerorev {version}")]
    for first, text in facts:
        lines += KRL_COMMENTS.lines(text, first=first)
    lines.append(";")
    for text in SAFETY:
        lines += KRL_COMMENTS.lines(text, first="- ")
    return [*lines, KRL_COMMENTS.rule]


def _sweep(sweeps: Sweeps, sweep: Sweep, title: str, lowers: bool) -> list[str]:
    name = KRL_COMMENTS.clean(sweeps.drilling.robot.joint_names[sweep.joint])
    lines = [f";FOLD {title}: {name} at {sweep.speed:.3g} rad/s", REST]
    if lowers:
        lines += [f"IF $OV_PRO>{sweep.override} THEN", f"$OV_PRO={sweep.override}", "ENDIF"]
    lines.append(f"BAS (#VEL_PTP,{sweep.percent} )")
    for _ in range(sweep.cycles):
        for side in (1.0, -1.0):
            posture = sweeps.posture.copy()
            posture[sweep.joint] += side * AMPLITUDE
            lines.append(_ptp(posture))
    return [*lines, _ptp(sweeps.posture), f";ENDFOLD ({title})"]


def _ptp(posture: Array) -> str:
    values = [fixed(angle, AXIS_DECIMALS) for angle in np.rad2deg(posture)]
    return f"PTP {aggregate('AXIS', 'A1 A2 A3 A4 A5 A6', values)}"
