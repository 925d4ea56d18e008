"""KRL, the language of KUKA's controllers (KR C4): a program's text.

Decimals: LIN targets have 4 (round-off 0.00005 mm and deg), far below what an axis resolves. Angles of frames and axes
act over a lever of a metre or more and have more; a REAL of the controller holds about seven digits.
"""

from __future__ import annotations

from importlib.metadata import version as installed_version

import numpy as np

from zerorev.model._arrays import Array
from zerorev.model.finding import Finding
from zerorev.model.job import Settings
from zerorev.program.head import about, head, part_head
from zerorev.program.krl.controller import axis_target, called, frames_and_load, header, refuse_calls
from zerorev.program.krl.head import sentences
from zerorev.program.krl.names import KRL_NAMES, krl_label
from zerorev.program.krl.text import KRL_COMMENTS, T_TCP_TOOL, aggregate, axis_angles, turn_about_x
from zerorev.program.letters import degrees, fixed, settled
from zerorev.program.neutral import HoleProgram, Move, Program, split
from zerorev.program.notes import notes, turn_speed
from zerorev.program.refusals import refuse_other_makers

__all__ = ["krl_modules", "to_krl"]

PTP_SPEED, PTP_ACCELERATION = 20, 50  # [%] of what the axes can: the PTP moves are not checked for collisions
LEAST_TURN_SPEED = 200.0  # [deg/s]
TURN_SPEED_RESERVE = 1.2
SPEED_DECIMALS = 6
KUKA_AXES = ("A1", "A2", "A3", "A4", "A5", "A6")
EXT_BAS = "EXT BAS (BAS_COMMAND :IN,REAL :IN )"


def to_krl(
    program: Program,
    *,
    name: str | None = None,
    findings: tuple[Finding, ...] | None = None,
    version: str | None = None,
) -> str:
    """The text of the .src file that is started; the file must be called like the program in it.

    Args:
        program: what to write.
        name: of the program, made a KRL identifier; by default the plan's.
        findings: stated in the comment block; by default what the program tells about itself.
        version: of zerorev, stated in the comment block; by default the installed one.

    Raises:
        NotExportableError: the robot is not a KUKA.
    """
    return next(iter(krl_modules(program, name=name, findings=findings, version=version).values()))


def krl_modules(
    program: Program,
    name: str | None = None,
    findings: tuple[Finding, ...] | None = None,
    version: str | None = None,
) -> dict[str, str]:
    """The text of each module by its name, the one that is started first; the arguments are those of `to_krl`.

    Raises:
        NotExportableError: the robot is not a KUKA; a call that would be something else.
    """
    called_so, version = KRL_NAMES.of(name or program.name), version or installed_version("zerorev")
    parts = {KRL_NAMES.part(called_so, n): part for n, part in enumerate(split(program), start=1)}
    refuse_other_makers("krl", program.robot)
    refuse_calls(program, [called_so, *parts])
    calls = program.settings.calls
    known = notes(program) if findings is None else findings
    begin = head(program, known, version, KRL_COMMENTS, sentences(program))
    if not parts:
        body = [*_settings(program), *called(calls.before_job), *_moves(program), *called(calls.after_job)]
        return {called_so: _module(program, called_so, [EXT_BAS, *begin], body)}
    steps = [f"{part}( )" for part in parts]
    modules = {
        called_so: _module(program, called_so, begin, [*called(calls.before_job), *steps, *called(calls.after_job)])
    }
    for number, (called_as, part) in enumerate(parts.items(), start=1):
        title = f"Part {number} of {len(parts)} of {called_so}, which starts it: {len(part.holes)} holes"
        body = [*_settings(program), *_moves(part)]
        modules[called_as] = _module(
            program, called_as, [EXT_BAS, *part_head(program, title, version, KRL_COMMENTS, sentences(program))], body
        )
    return modules


def _module(program: Program, name: str, begin: list[str], body: list[str]) -> str:
    """One module; its declaration, if it has one, comes before its comments."""
    return "\n".join([*header(program.settings.header), f"DEF {name} ( )", *begin, *body, "END", ""])


def _moves(program: Program) -> list[str]:
    """The holes, and what leads away from the last one."""
    lines = []
    for hole in program.holes:
        lines += _hole(hole, f"Hole {hole.number} of {program.listed}", program.settings)
    if len(program.end):
        away = [_ptp(joints, program.settings) for joints in program.end]
        lines += [";FOLD Away from the last hole", *away, ";ENDFOLD"]
    return lines


def _settings(program: Program) -> list[str]:
    turn = TURN_SPEED_RESERVE * np.rad2deg(max(turn_speed(hole) for hole in program.holes))
    # the twist must never throttle the feed, so the greater of the usual value and the needed one with a reserve; the
    # last bits of a turn that is a whole number must not decide what is written
    allowed = fixed(max(LEAST_TURN_SPEED, np.ceil(turn - 1e-6)), 1)
    return [
        ";FOLD INI",
        "BAS (#INITMOV,0 )",
        f"BAS (#VEL_PTP,{PTP_SPEED} )",
        f"BAS (#ACC_PTP,{PTP_ACCELERATION} )",
        *frames_and_load(program),
        "$IPO_MODE=#BASE",
        "$ORI_TYPE=#VAR",
        "$ADVANCE=3",
        f"$VEL.ORI1={allowed}",
        f"$VEL.ORI2={allowed}",
        ";ENDFOLD (INI)",
    ]


def _hole(hole: HoleProgram, title: str, settings: Settings) -> list[str]:
    """PTP moves by axis values, then absolute linear moves.

    Never LIN_REL: selected again after a stop within the stroke it runs its whole stroke again from there, into the
    material or the fixture; an absolute LIN only runs what is left. Between the linear moves stand nothing but
    assignments to $VEL and $APO, which do not stop the advance run: an output or a WAIT would make the blend a stop.
    Where the tool is to stand, the move ends in one, and a WAIT follows.
    """
    lines = [f";FOLD {title}: {krl_label(hole.id)}", *about(hole, KUKA_AXES, KRL_COMMENTS)]
    lines += [_ptp(joints, settings) for joints in (*hole.way, hole.start.joints)]
    lines += called(settings.calls.before_hole)
    A, B = axis_angles(hole.axis)
    feed, radius = None, ""
    for move in hole.moves:
        if move.feed != feed:
            feed = move.feed
            lines.append(f"$VEL.CP={settled(feed, SPEED_DECIMALS)} ; {move.leg}: {feed * 1e3:g} mm/s")
        if move.blend > 0 and (printed := settled(move.blend * 1e3)) != radius:
            radius = printed
            lines.append(f"$APO.CDIS={radius}")
        lines.append(_lin(move, A, B))
        if move.wait > 0:
            lines.append(f"WAIT SEC {fixed(move.wait, 2)}")
    return [*lines, *called(settings.calls.after_hole), f";ENDFOLD ({title})"]


def _ptp(joints: Array, settings: Settings) -> str:
    return f"PTP {axis_target(joints, settings)}"


def _lin(move: Move, A: float, B: float) -> str:
    T = move.end.T_part_tcp @ T_TCP_TOOL
    angles = [degrees(angle) for angle in (A, B, turn_about_x(T[:3, :3], A, B))]
    target = aggregate("", "X Y Z A B C", [*(fixed(x * 1e3) for x in T[:3, 3]), *angles])
    return f"LIN {target}{' C_DIS' if move.blend > 0 else ''} ; {move.comment}"
