"""TP, the language of FANUC's teach pendants: a program's text as ASCII.

Points have three decimals, which is what the format has: 0.001 mm and 0.001 deg. No frame is set, for that would need
position registers, which belong to somebody: the program selects frames by their numbers, and its comments say what
must stand there.
"""

from __future__ import annotations

from importlib.metadata import version as installed_version

from zerorev.errors import NotExportableError
from zerorev.model.controller import Call
from zerorev.model.finding import Finding
from zerorev.program.head import about, head, part_head
from zerorev.program.names import label
from zerorev.program.neutral import HoleProgram, Move, Program, split
from zerorev.program.refusals import refuse_other_makers
from zerorev.program.tp.examine import errors
from zerorev.program.tp.head import sentences
from zerorev.program.tp.listing import Frames, Listing
from zerorev.program.tp.names import TP_NAMES, called
from zerorev.program.tp.text import TP_COMMENTS, Speed, joint_time, standing, tip_speed

__all__ = ["most_holes", "too_large", "tp_programs"]

COMMENT = "zerorev drilling"  # 16 characters
WAY_SPEED = Speed(20, "%")  # of what the joints can: these moves are not checked for collisions
MOST_LINES, MOST_POSITIONS = 9_999, 1_000  # of a file
MOST_FINDINGS = 60  # in the comments of a file


def tp_programs(
    program: Program, name: str, findings: tuple[Finding, ...], version: str | None = None
) -> dict[str, str]:
    """The text of each program by its name, the one that is started first.

    Args:
        program: what to write.
        name: of the program, as `TP_NAMES` makes it.
        findings: stated in the comment block.
        version: of zerorev, stated in the comment block; by default the installed one.

    Raises:
        NotExportableError: the robot is not a FANUC; what TP cannot say; a call of the program itself.
    """
    refuse_other_makers("tp", program.robot)
    if wrong := errors(program):
        raise NotExportableError(tuple(finding.message for finding in wrong))
    version = version or installed_version("zerorev")
    parts = {TP_NAMES.part(name, number): part for number, part in enumerate(split(program), start=1)}
    _refuse_own_calls(program, [name, *parts])
    begin = head(program, _as_many(findings), version, TP_COMMENTS, sentences(program))
    if not parts:
        return {name: _text(program, name, begin, whole=True)}
    texts = {name: _starter(program, name, begin, list(parts))}
    for number, (called_as, part) in enumerate(parts.items(), start=1):
        title = f"Part {number} of {len(parts)} of {name}, which starts it: {len(part.holes)} holes"
        texts[called_as] = _text(part, called_as, part_head(program, title, version, TP_COMMENTS, sentences(program)))
    return texts


def most_holes(program: Program) -> int:
    """How many holes one file may have, so that neither its lines nor its positions are too many."""
    if errors(program):
        return len(program.holes)
    begin = len(part_head(program, "", "", TP_COMMENTS, sentences(program))) + 4 * MOST_FINDINGS
    listings = [Listing(Frames.of(program)) for _ in program.holes]
    for listing, hole in zip(listings, program.holes, strict=True):
        _hole(listing, hole, program)
    lines, positions = (
        max(len(kind) for kind in kinds)
        for kinds in zip(*((each.lines, each.positions) for each in listings), strict=True)
    )
    return max(1, min((MOST_LINES - begin) // lines, (MOST_POSITIONS - len(program.end)) // positions))


def too_large(program: Program) -> tuple[Finding, ...]:
    """What is said of files that have more holes than a controller may take, as the job asks for."""
    most, size = most_holes(program), max(program.parts or (len(program.holes),))
    if size <= most:
        return ()
    message = (
        f"{size} holes in a file have more than {MOST_LINES:,} lines or {MOST_POSITIONS:,} positions, which a "
        f"controller may not load: holes_per_program of {most} or less"
    )
    return (Finding("warning", "controller", message),)


def _text(program: Program, name: str, begin: list[str], *, whole: bool = False) -> str:
    """The text of a program that moves the robot.

    Args:
        program: its holes.
        name: of the file.
        begin: its comment block.
        whole: whether it is all of the program.
    """
    listing, calls = Listing(Frames.of(program)), program.settings.calls
    listing.remarks(begin)
    listing.say(f"UFRAME_NUM={listing.frames.user} ")
    listing.say(f"UTOOL_NUM={listing.frames.tool} ")
    _call(listing, calls.before_job if whole else ())
    for hole in program.holes:
        _hole(listing, hole, program)
    if len(program.end):
        listing.remarks(TP_COMMENTS.lines("Away from the last hole"))
    for joints in program.end:
        listing.move("J", listing.frames.joints(joints), WAY_SPEED, stops=True)
    _call(listing, calls.after_job if whole else ())
    return listing.text(name, COMMENT)


def _starter(program: Program, name: str, begin: list[str], parts: list[str]) -> str:
    """The file that starts the parts, and moves nothing itself."""
    listing, calls = Listing(Frames.of(program)), program.settings.calls
    listing.remarks(begin)
    _call(listing, calls.before_job)
    _call(listing, tuple(Call(part) for part in parts))
    _call(listing, calls.after_job)
    return listing.text(name, COMMENT)


def _hole(listing: Listing, hole: HoleProgram, program: Program) -> None:
    """Joint moves to the start with a stop at each, then the moves of the hole, and nothing between them."""
    frames, calls = listing.frames, program.settings.calls
    title = f"Hole {hole.number} of {program.listed}: {label(hole.id, TP_COMMENTS)}"
    first = len(listing.positions) + len(hole.way) + 1
    points = [f"P[{first}] start", *(f"P[{n}] {move.comment}" for n, move in enumerate(hole.moves, start=first + 1))]
    listing.remarks(TP_COMMENTS.lines(title))
    listing.remarks(about(hole, program.robot.joint_names, TP_COMMENTS))
    listing.remarks(TP_COMMENTS.lines(", ".join(points)))
    for joints in (*hole.way, hole.start.joints):
        listing.move("J", frames.joints(joints), WAY_SPEED, stops=True)
    _call(listing, calls.before_hole)
    for move in hole.moves:
        _move(listing, move)
    _call(listing, calls.after_hole)


def _move(listing: Listing, move: Move) -> None:
    if move.linear:
        listing.move("L", listing.frames.pose(move.end), tip_speed(move.feed), stops=move.blend == 0)
    else:
        position = listing.frames.joints(move.end.joints)
        listing.move("J", position, joint_time(move.time), stops=move.blend == 0)
    if move.wait > 0:
        listing.say(f"WAIT {standing(move.wait)}(sec) ")


def _call(listing: Listing, calls: tuple[Call, ...]) -> None:
    for each in calls:
        listing.say(f"{called(each)} ")


def _as_many(findings: tuple[Finding, ...]) -> tuple[Finding, ...]:
    """Findings that a file has room for, and how many there are besides."""
    if len(findings) <= MOST_FINDINGS:
        return findings
    rest = f"{len(findings) - MOST_FINDINGS} findings more: see what zerorev export says"
    return (*findings[:MOST_FINDINGS], Finding("info", "controller", rest))


def _refuse_own_calls(program: Program, own: list[str]) -> None:
    """Refuse a call that would start the program itself.

    Raises:
        NotExportableError: there is one.
    """
    reasons = [
        f"{call.name}, called {place}, is this program itself"
        for place, calls in program.settings.calls.places()
        for call in calls
        if call.name.upper() in own
    ]
    if reasons:
        raise NotExportableError(tuple(reasons))
