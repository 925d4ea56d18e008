"""URScript, the language of the controllers of Universal Robots (PolyScope 5 and X): a program's text."""

from __future__ import annotations

from collections.abc import Iterator
from importlib.metadata import version as installed_version

from zerorev.model._arrays import Array
from zerorev.model.finding import Finding
from zerorev.program.dialect import Z_ALONG_PLUNGE
from zerorev.program.head import about, head, part_head
from zerorev.program.letters import fixed, settled
from zerorev.program.names import label
from zerorev.program.neutral import HoleProgram, Move, Program, split
from zerorev.program.refusals import refuse_other_makers
from zerorev.program.urscript.controller import PART, called, frames_and_payload
from zerorev.program.urscript.head import AXES, sentences
from zerorev.program.urscript.names import URSCRIPT_NAMES
from zerorev.program.urscript.text import INDENT, URSCRIPT_COMMENTS, joint_list, pose

__all__ = ["ACCELERATION", "FEW_DECIMALS", "urscript_files"]

JOINT_SPEED, JOINT_ACCELERATION = "0.4", "0.8"  # [rad/s], [rad/s^2] of the moves that are not checked for collisions
ACCELERATION = "0.5"  # [m/s^2]: 20 mm/s within half a millimetre
FEW_DECIMALS = 7  # [m/s], [m], [s]: a feed, a radius, a time


def urscript_files(
    program: Program, name: str, findings: tuple[Finding, ...], version: str | None = None
) -> dict[str, str]:
    """The text of each file by the name of the function in it, the one that is called first.

    Args:
        program: what to write.
        name: of the program.
        findings: stated in the comment block.
        version: of zerorev, stated in the comment block; by default the installed one.

    Raises:
        NotExportableError: the robot is another maker's.
    """
    called_so, version = URSCRIPT_NAMES.of(name), version or installed_version("zerorev")
    parts = {URSCRIPT_NAMES.part(called_so, n): part for n, part in enumerate(split(program), start=1)}
    refuse_other_makers("urscript", program.robot)
    calls, comments = program.settings.calls, URSCRIPT_COMMENTS
    begin = head(program, findings, version, comments, sentences(program, called_so, tuple(parts)))
    if not parts:
        body = [*frames_and_payload(program), *called(calls.before_job), *_moves(program), *called(calls.after_job)]
        return {called_so: _function(called_so, [*begin, *body])}
    steps = [f"{part}()" for part in parts]
    files = {called_so: _function(called_so, [*begin, *called(calls.before_job), *steps, *called(calls.after_job)])}
    for number, (called_as, part) in enumerate(parts.items(), start=1):
        title = f"Part {number} of {len(parts)} of {called_so}, which calls it: {len(part.holes)} holes"
        begin = part_head(program, title, version, comments, sentences(program, called_as))
        files[called_as] = _function(called_as, [*begin, *frames_and_payload(program), *_moves(part)])
    return files


def _function(name: str, lines: list[str]) -> str:
    return "\n".join([f"def {name}():", *(INDENT + line for line in lines), "end", ""])


def _moves(program: Program) -> list[str]:
    """The holes, and what leads away from the last one."""
    lines = []
    for hole in program.holes:
        lines += _hole(program, hole)
    if len(program.end):
        lines += ["# Away from the last hole", *(_go(program.robot.shown(joints)) for joints in program.end)]
    return lines


def _hole(program: Program, hole: HoleProgram) -> list[str]:
    """Joint moves with exact stops, then the moves of the hole, which nothing comes between."""
    title = f"Hole {hole.number} of {program.listed}: {label(hole.id, URSCRIPT_COMMENTS)}"
    return [
        f"# {title}",
        *about(hole, AXES, URSCRIPT_COMMENTS),
        *(_go(program.robot.shown(joints)) for joints in (*hole.way, hole.start.joints)),
        *called(program.settings.calls.before_hole),
        *(line for move in hole.moves for line in _move(move, program.robot.shown(move.end.joints))),
        *called(program.settings.calls.after_hole),
    ]


def _go(joints: Array) -> str:
    return f"movej({joint_list(joints)}, a={JOINT_ACCELERATION}, v={JOINT_SPEED})"


def _move(move: Move, joints: Array) -> Iterator[str]:
    """One move of a hole; a time in place of a speed holds the feed of the tip where all joints move."""
    blend = f", r={settled(move.blend, FEW_DECIMALS)}" if move.blend > 0 else ""
    if move.linear:
        end = f"pose_trans({PART}, {pose(move.end.T_part_tcp @ Z_ALONG_PLUNGE)})"
        yield f"movel({end}, a={ACCELERATION}, v={settled(move.feed, FEW_DECIMALS)}{blend}) # {move.comment}"
    else:
        yield f"movej({joint_list(joints)}, t={settled(move.time, FEW_DECIMALS)}{blend}) # {move.comment}"
    if move.wait > 0:
        yield f"sleep({fixed(move.wait, 2)})"
