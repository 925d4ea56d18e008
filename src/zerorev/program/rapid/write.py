"""RAPID, the language of ABB's controllers (RobotWare 6 and 7): a program's text.

Every hole is one procedure's straight run of moves between exact stops. Speeds and zones are declared by their values
(`feed_5_000`, `zone_1_0000`), so that an operator sees them in the move, and the moves of a hole do not depend on
which other holes there are.
"""

from __future__ import annotations

from importlib.metadata import version as installed_version

import numpy as np

from zerorev.model._arrays import Array
from zerorev.model.finding import Finding
from zerorev.program.dialect import Z_ALONG_PLUNGE
from zerorev.program.head import about, head, part_head
from zerorev.program.letters import fixed, settled
from zerorev.program.names import LONGEST_ID
from zerorev.program.neutral import HoleProgram, Move, Program, split
from zerorev.program.notes import notes, segments, turn_speed
from zerorev.program.rapid.controller import called, frames, refuse
from zerorev.program.rapid.head import sentences
from zerorev.program.rapid.names import RAPID_COMMENTS, RAPID_NAMES, part_frame, procedure, rapid_label, tool
from zerorev.program.rapid.text import aggregate, confdata, external, joint_target, pose, quaternion
from zerorev.program.refusals import refuse_other_makers

__all__ = ["AFTERWARDS", "LEAST_TURN_SPEED", "OUTER_SPEEDS", "SETTINGS", "joined", "most_holes", "rapid_modules"]

LONGEST = 5_000  # lines of a module
HEAD = 200  # more lines than stand before and after the holes
WAY_SPEED = "way_speed"
WAY = (250.0, 45.0)  # [mm/s], [deg/s]: moves between the holes, which are not checked for collisions
LEAST_TURN_SPEED, TURN_SPEED_RESERVE = 500.0, 1.2  # [deg/s], as in the predefined speeds
OUTER_SPEEDS = ("5000", "1000")  # of external axes [mm/s], [deg/s], as in the predefined speeds
LEAST_ZONE_TURN, ZONE_TURN_RESERVE = 30.0, 1.5  # [deg], the greatest of the predefined zones
FEED_DECIMALS, TIME_DECIMALS = 3, 6  # [mm/s], [s]
SETTINGS = (
    "ConfL\\Off;",
    "ConfJ\\On;",
    "SingArea\\Off;",
    "PDispOff;",
    "EOffsOff;",
    "AccSet 100,100;",
    "VelSet 100,5000;",
)
AFTERWARDS = "ConfL\\On;"  # as a controller has it from the start


def rapid_modules(
    program: Program,
    name: str | None = None,
    findings: tuple[Finding, ...] | None = None,
    version: str | None = None,
) -> dict[str, str]:
    """The text of each module by its name, the one that is started first.

    Args:
        program: what to write.
        name: of the program, made a RAPID identifier; by default the plan's.
        findings: stated in the comment block; by default what the program tells about itself.
        version: of zerorev, stated in the comment block; by default the installed one.

    Raises:
        NotExportableError: the robot is not an ABB; what RAPID cannot say, or a controller refuses to run.
    """
    called_so, version = RAPID_NAMES.of(name or program.name), version or installed_version("zerorev")
    parts = {RAPID_NAMES.part(called_so, n): part for n, part in enumerate(split(program), start=1)}
    refuse_other_makers("rapid", program.robot)
    refuse(program, [procedure(each) for each in (called_so, *parts)])
    calls, known = program.settings.calls, notes(program) if findings is None else findings
    begin = head(program, known, version, RAPID_COMMENTS, tuple(sentences(program, called_so)))
    before, after = called(calls.before_job), called(calls.after_job)
    if not parts:
        return {called_so: _module(program, program, called_so, begin, before, after)}
    steps = [*before, *(f"{procedure(part)};" for part in parts), *after]
    modules = {called_so: joined(called_so, begin, [], steps)}
    for number, (called_as, part) in enumerate(parts.items(), start=1):
        title = f"Part {number} of {len(parts)} of {called_so}, which starts it: {len(part.holes)} holes"
        begin = part_head(program, title, version, RAPID_COMMENTS, tuple(sentences(program, called_as)))
        modules[called_as] = _module(program, part, called_as, begin, [], [])
    return modules


def most_holes(program: Program) -> int:
    """How many holes a module may have, so that it has no more lines than a controller takes well."""
    longest = max(len(_hole(program, hole, "x", "")) for hole in program.holes)
    return max(1, (LONGEST - HEAD) // longest)


def _module(whole: Program, part: Program, name: str, begin: list[str], before: list[str], after: list[str]) -> str:
    """A module that moves the robot: its data, and one procedure."""
    body = [*SETTINGS, *before]
    for hole in part.holes:
        body += _hole(whole, hole, name, f"Hole {hole.number} of {part.listed}")
    if len(part.end):
        body += ["! Away from the last hole", *(_go(whole, joints, name) for joints in part.end)]
    return joined(
        name, begin, [*frames(whole, name, whole.T_base_part), *_data(whole, part)], [*body, AFTERWARDS, *after]
    )


def joined(name: str, begin: list[str], data: list[str], body: list[str]) -> str:
    """The text of a module: its comments, its data, and its procedure."""
    lines = [f"  {line}" for line in body]
    return "\n".join([f"MODULE {name}", *begin, *data, f"PROC {procedure(name)}()", *lines, "ENDPROC", "ENDMODULE", ""])


def _data(whole: Program, part: Program) -> list[str]:
    """The speeds and zones of a part, in the order in which they come; how fast the tool may turn is the program's."""
    turn = TURN_SPEED_RESERVE * np.rad2deg(max(turn_speed(hole) for hole in whole.holes))
    # the twist must never throttle the feed; the last bits of a turn that is a whole number must not decide
    allowed = fixed(max(LEAST_TURN_SPEED, np.ceil(turn - 1e-6)), 1)
    speeds = {WAY_SPEED: tuple(fixed(value, 1) for value in WAY)}
    zones = dict[str, str]()
    turns = _zone_turns(whole)
    for move in (move for hole in part.holes for move in hole.moves):
        speeds[_feed_name(move)] = (_feed(move), allowed)
        if move.blend > 0:
            radius = _radius(move)
            turned = fixed(max(LEAST_ZONE_TURN, np.ceil(ZONE_TURN_RESERVE * turns[radius] - 1e-6)), 1)
            zones[_zone_name(move)] = aggregate(["FALSE", radius, radius, radius, turned, radius, radius])
    return [
        *(f"LOCAL CONST speeddata {name}:={aggregate((*speed, *OUTER_SPEEDS))};" for name, speed in speeds.items()),
        *(f"LOCAL CONST zonedata {name}:={zone};" for name, zone in zones.items()),
    ]


def _zone_turns(program: Program) -> dict[str, float]:
    """How far the tool turns within each blend, by its printed radius [deg].

    A zone has equal radii for tip and turn, for a greater one for the turn brings reversals back. A controller cuts it
    to the smallest of its shares of the move: of the length, and of the turn, for which the zone has an angle of its
    own. With a greater angle than these, that never is the smallest.
    """
    turns = dict[str, float]()
    for hole in program.holes:
        rates = [abs(move.psi - psi) / move.length for _, psi, move in segments(hole)]
        for move, rate, ahead in zip(hole.moves, rates, rates[1:], strict=False):
            turn = float(np.rad2deg(move.blend * max(rate, ahead)))
            turns[_radius(move)] = max(turn, turns.get(_radius(move), 0.0))
    return turns


def _hole(program: Program, hole: HoleProgram, name: str, title: str) -> list[str]:
    """Joint moves to the start, and from there on nothing but moves until the end of the stroke.

    An output or a wait between them would make a zone a stop; where the tool is to stand, the move ends in one.
    """
    settings = program.settings
    lines = [
        *RAPID_COMMENTS.lines(f"{title}: {rapid_label(hole.id)}", longest=3 * LONGEST_ID),
        *about(hole, program.robot.joint_names, RAPID_COMMENTS),
    ]
    lines += [_go(program, joints, name) for joints in (*hole.way, hole.start.joints)]
    lines += called(settings.calls.before_hole)
    # no move turns the tool by more than 120 deg, so that of its two quaternions the nearer one is certain
    turned = quaternion((hole.start.T_part_tcp @ Z_ALONG_PLUNGE)[:3, :3])
    for move in hole.moves:
        lines += [f"! {move.leg}: {move.comment}", _move(program, move, name, turned)]
        turned = quaternion((move.end.T_part_tcp @ Z_ALONG_PLUNGE)[:3, :3], turned)
        if move.wait > 0:
            lines.append(f"WaitTime {fixed(move.wait, 2)};")
    return [*lines, *called(settings.calls.after_hole)]


def _go(program: Program, joints: Array, name: str) -> str:
    """A move of all axes to a stop."""
    return f"MoveAbsJ {joint_target(program.robot, joints, program.settings)},{WAY_SPEED},fine,{_frames(name)};"


def _move(program: Program, move: Move, name: str, turned: Array) -> str:
    """One move of a hole; that of all joints takes the time that its length and feed ask for."""
    zone = _zone_name(move) if move.blend > 0 else "fine"
    feed, settings = _feed_name(move), program.settings
    if not move.linear:
        target, time = joint_target(program.robot, move.end.joints, settings), settled(move.time, TIME_DECIMALS)
        return f"MoveAbsJ {target},{feed}\\T:={time},{zone},{_frames(name)};"
    place, posture = pose(move.end.T_part_tcp @ Z_ALONG_PLUNGE, turned), confdata(program.robot, move.end.joints)
    return f"MoveL [{place},{posture},{external(settings)}],{feed},{zone},{_frames(name)};"


def _frames(name: str) -> str:
    return f"{tool(name)}\\WObj:={part_frame(name)}"


def _feed(move: Move) -> str:
    """[mm/s]."""
    return settled(move.feed * 1e3, FEED_DECIMALS)


def _feed_name(move: Move) -> str:
    return f"feed_{_feed(move).replace('.', '_')}"


def _radius(move: Move) -> str:
    """[mm]."""
    return settled(move.blend * 1e3)


def _zone_name(move: Move) -> str:
    return f"zone_{_radius(move).replace('.', '_')}"
