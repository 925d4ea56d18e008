"""INFORM, the language of Yaskawa's controllers (NX100 to YRC1000): a job's text.

All positions are pulses, so that no frame, no angles of a pose, no configuration and no option of the controller comes
in between: joints are what the certificate is of. Each position belongs to one move, in order; a controller refuses one
that no move uses.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from importlib.metadata import version as installed_version

from zerorev.model._arrays import Array
from zerorev.model.controller import Call
from zerorev.model.finding import Finding
from zerorev.program.head import about, head, part_head
from zerorev.program.inform.head import sentences
from zerorev.program.inform.names import INFORM_NAMES, inform_label
from zerorev.program.inform.needs import refuse_calls, refuse_unwritable
from zerorev.program.inform.text import (
    BLENDED,
    INFORM_COMMENTS,
    LONGEST_COMMENT,
    STOPS,
    feed_written,
    position,
    pulses,
    share_needed,
    share_written,
)
from zerorev.program.letters import fixed
from zerorev.program.neutral import HoleProgram, Program, split
from zerorev.program.notes import notes
from zerorev.program.refusals import refuse_other_makers

__all__ = ["inform_jobs", "most_holes"]

WAY_SPEED = "20.00"  # [%] of what the joints can: these moves are not checked for collisions
DATE = "2000/01/01 00:00"
"""In every job: the same plan gives the same bytes, whenever it is exported."""
MOST_LINES, MOST_POSITIONS = 2_000, 9_500  # of one job


def inform_jobs(
    program: Program,
    name: str | None = None,
    findings: tuple[Finding, ...] | None = None,
    version: str | None = None,
) -> dict[str, str]:
    """The text of each job by its name, the one that is started first.

    Args:
        program: what to write.
        name: of the job, made one that a controller takes; by default the plan's.
        findings: stated in the comment block; by default what the program tells about itself.
        version: of zerorev, stated in the comment block; by default the installed one.

    Raises:
        NotExportableError: the robot is not a Yaskawa, its pulses or the number of the tool are not known, or a call or
            a speed cannot be written.
    """
    called, version = INFORM_NAMES.of(name or program.name), version or installed_version("zerorev")
    parts = {INFORM_NAMES.part(called, n): part for n, part in enumerate(split(program), start=1)}
    refuse_other_makers("inform", program.robot)
    refuse_unwritable(program)
    refuse_calls(program, [called, *parts])
    calls = program.settings.calls
    known = notes(program) if findings is None else findings
    begin = head(program, known, version, INFORM_COMMENTS, sentences(program))
    job = _Job(program, called, begin)
    job.call(calls.before_job)
    if not parts:
        job.holes(program)
    for called_so in parts:
        job.call([Call(called_so)])
    job.call(calls.after_job)
    jobs = {called: job.text()}
    for number, (called_so, part) in enumerate(parts.items(), start=1):
        title = f"Part {number} of {len(parts)} of {called}, which starts it: {len(part.holes)} holes"
        one = _Job(program, called_so, part_head(program, title, version, INFORM_COMMENTS, sentences(program)))
        one.holes(part)
        jobs[called_so] = one.text()
    return jobs


def most_holes(program: Program, findings: tuple[Finding, ...]) -> int | None:
    """How many holes one job may have, so that its lines and positions are not more than controllers take; None: all.

    Args:
        program: that can be written.
        findings: stated in the comment block.
    """
    (text,) = inform_jobs(program, findings=findings).values()
    if text.count("\n") <= MOST_LINES and text.count("\nC0") <= MOST_POSITIONS:
        return None
    sizes = []
    for hole in program.holes:
        job = _Job(program, "", [])
        job.hole(hole)
        sizes.append((len(job.body) + len(job.positions), len(job.positions)))
    longest, positions = (max(each) for each in zip(*sizes, strict=True))
    around = _Job(program, "", part_head(program, "", "", INFORM_COMMENTS, sentences(program)))
    around.away(program)
    fits: int = min((MOST_LINES - around.text().count("\n")) // longest, MOST_POSITIONS // positions)
    return max(1, min(fits, len(program.holes) - 1))


@dataclass
class _Job:
    """A job as it grows.

    Attributes:
        program: of which it is a part, or the whole.
        name: of the job.
        body: its instructions.
        positions: that they use, in order, in pulses.
    """

    program: Program
    name: str
    body: list[str]
    positions: list[Array] = field(default_factory=list)

    def holes(self, program: Program) -> None:
        """The holes of the whole or of a part, and what leads away from the last one."""
        for hole in program.holes:
            self.hole(hole)
        self.away(program)

    def hole(self, hole: HoleProgram) -> None:
        """MOVJ moves with a stop, then the moves of the hole.

        Nothing stands between these, not even a comment, which is a step of a job: nothing may hold the look-ahead up.
        """
        program, robot, calls = self.program, self.program.robot, self.program.settings.calls
        self.body += INFORM_COMMENTS.lines(f"Hole {hole.number} of {program.listed}: {inform_label(hole.id)}")
        self.body += about(hole, robot.joint_names, INFORM_COMMENTS)
        margin = program.settings.limit_margin
        for joints in hole.way:  # the home position, on the way, is the user's own
            self.move("MOVJ", joints, f"VJ={WAY_SPEED}", STOPS)
        self.move("MOVJ", hole.start.joints, f"VJ={WAY_SPEED}", STOPS, margin)
        self.call(calls.before_hole)
        begin = hole.start.joints
        for move in hole.moves:
            if move.linear:
                kind, pace = "MOVL", f"V={feed_written(move.feed)}"
            else:
                kind, pace = "MOVJ", f"VJ={share_written(share_needed(robot, begin, move))}"
            self.move(kind, move.end.joints, pace, BLENDED if move.blend > 0 else STOPS, margin)
            begin = move.end.joints
            if move.wait > 0:
                self.body.append(f"TIMER T={fixed(move.wait, 2)}")
        self.call(calls.after_hole)

    def away(self, program: Program) -> None:
        """What leads away from the last hole."""
        if len(program.end):
            self.body += INFORM_COMMENTS.lines("Away from the last hole")
        for joints in program.end:
            self.move("MOVJ", joints, f"VJ={WAY_SPEED}", STOPS)

    def move(self, kind: str, joints: Array, pace: str, level: int, margin: float = 0.0) -> None:
        """A move to the next position."""
        self.body.append(f"{kind} C{len(self.positions):05d} {pace} PL={level}")
        self.positions.append(pulses(self.program.robot, joints, margin))

    def call(self, calls: Sequence[Call]) -> None:
        """Jobs that are called where the robot stands: the move before ends in a stop."""
        self.body += [f"CALL JOB:{call.name}" for call in calls]

    def text(self) -> str:
        """Of the file."""
        comment = INFORM_COMMENTS.clean(self.program.name)[:LONGEST_COMMENT].strip()
        tool = [f"///TOOL {self.program.settings.tool_number}", "///POSTYPE PULSE", "///PULSE"]
        lines = [
            "/JOB",
            f"//NAME {self.name}",
            "//POS",
            f"///NPOS {len(self.positions)},0,0,0,0,0",
            *(tool if self.positions else []),
            *(position(number, counts) for number, counts in enumerate(self.positions)),
            "//INST",
            f"///DATE {DATE}",
            *([f"///COMM {comment}"] if comment else []),
            "///ATTR SC,RW",
            "///GROUP1 RB1",
            "NOP",
            *self.body,
            "END",
            "",
        ]
        return "\n".join(lines)
