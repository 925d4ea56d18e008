"""An INFORM job of ours read back, as data: what a certificate is to speak of is what stands in the file.

Strict: a line of another form than a job of ours has is an error, for it might move the robot in a way that nobody has
examined. Positions are pulses, and each belongs to one move, in order; so a statement here has the pulses themselves in
the place of the position's number.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from decimal import Decimal

from zerorev.model.written import Pace, Statement, Word, WrittenJoints, WrittenProgram
from zerorev.program.reading import Reading, Starter, Words
from zerorev.program.source import alike_but, ascii_lines

__all__ = ["alike", "read_job", "read_starter"]

NAME = r"[A-Z0-9_-]{1,32}"
CALLED = r"[A-Za-z0-9_-]{1,32}"
WHOLE = r"-?(?:0|[1-9]\d{0,8})"
MOVE = re.compile(r"(MOVJ|MOVL) C(\d{5}) (VJ|V)=(\d{1,4}\.\d{1,2}) PL=([0-8])", re.ASCII)
TIMER = re.compile(r"TIMER T=(\d{1,3}\.\d{2})", re.ASCII)
CALL = re.compile(rf"CALL JOB:({CALLED})")
FASTEST_SHARE = 100
AXES = "SLURBT"
INSTRUCTIONS = (
    "MOVJ C00000 VJ=0.00 PL=0 or MOVL C00000 V=0.0 PL=0 (PL 0 to 8), TIMER T=0.00, CALL JOB:NAME, a comment or END"
)


def read_job(text: str, file: str = "job") -> WrittenProgram:
    """Read the text of a job.

    Args:
        text: of the file.
        file: how a message calls it.

    Raises:
        InputError: a line that `export` does not write; the message has its number.
    """
    reading = _Reading(file)
    reading.read(text)
    return reading.end()


def read_starter(text: str, file: str = "job") -> Starter | None:
    """A job that moves nothing itself, but calls others; None: any other.

    Raises:
        InputError: as `read_job`.
    """
    reading = _Reading(file)
    reading.read(text)
    return None if reading.positions else (reading.name, tuple(reading.head))


def alike(found: Sequence[Word], wanted: Sequence[Word]) -> bool:
    """Whether a statement is the one expected: the pulses of a position but for one of each axis.

    Args:
        found: words of a program's statement.
        wanted: as `export` writes it.
    """
    moves = wanted[0] in ("MOVJ", "MOVL")
    return alike_but(found, wanted, lambda at, own, other: moves and 1 <= at <= 6 and abs(own - other) <= 1)


@dataclass
class _Reading(Reading):
    """What is known up to a line."""

    accepted, stop = "a job as zerorev exports it", "PL=0"

    lines: list[tuple[int, str]] = field(default_factory=list)
    positions: list[tuple[int, tuple[Decimal, ...]]] = field(default_factory=list)
    used: int = 0

    def read(self, text: str) -> None:
        self.lines = list(ascii_lines(text, self.refuse_at))
        while self.lines and not self.lines[-1][1]:
            self.lines.pop()
        self.lines.reverse()
        self.begin()
        while (source := self.take()) != "END":
            self.instruction(source)
        if self.lines:
            self.take()
            self.refuse("a line after END", accepted="END as the last line")
        if self.used < len(self.positions):
            self.refuse(f"no move uses C{self.used:05d}", accepted="each position in one move, in order")
        self.close_last()

    def begin(self) -> None:
        """The head of the job, and its positions."""
        self.expect("/JOB")
        self.name = self.expect(rf"//NAME ({NAME})", "//NAME and a name of at most 32 capitals, digits, - and _")[1]
        self.note(("//NAME", self.name), f"//NAME {self.name}")
        self.expect("//POS")
        shown = "///NPOS 0,0,0,0,0,0, the first number being that of the positions"
        count = int(self.expect(r"///NPOS (0|[1-9]\d{0,4}),0,0,0,0,0", shown)[1])
        if count:
            tool = self.expect(r"///TOOL ([1-9]\d?|0)", "///TOOL and the number of the tool")[1]
            self.note(("///TOOL", Decimal(tool)), f"///TOOL {tool}")
            self.expect("///POSTYPE PULSE")  # with the next line: axis values, and no frame
            self.expect("///PULSE")
        for number in range(count):
            form = f"C{number:05d}="
            found = self.expect(rf"{form}({WHOLE}(?:,{WHOLE}){{5}})", f"{form}0,0,0,0,0,0, whole pulses of six axes")
            self.positions.append((self.line, tuple(Decimal(each) for each in found[1].split(","))))
        self.expect("//INST")
        self.expect(r"///DATE \d{4}/\d{2}/\d{2} \d{2}:\d{2}", "///DATE 0000/00/00 00:00")
        if self.lines and self.lines[-1][1].startswith("///COMM "):
            self.expect(r"///COMM .{1,32}", "///COMM and at most 32 characters")
        self.expect("///ATTR SC,RW")
        self.expect("///GROUP1 RB1")  # the six axes of the one robot
        self.expect("NOP")

    def instruction(self, source: str) -> None:
        """One line between NOP and END."""
        if source.startswith("'"):
            self.stand_still("a comment")
        elif (move := MOVE.fullmatch(source)) is not None:
            self.moved(move)
        elif (timer := TIMER.fullmatch(source)) is not None:
            seconds = Decimal(timer[1])
            self.wait("TIMER", seconds)
            self.note(("TIMER", "T=", seconds), source)
        elif (call := CALL.fullmatch(source)) is not None:
            self.stand_still(f"CALL JOB:{call[1]}")
            self.note(("CALL", "JOB:", call[1]), source)
        else:
            self.refuse(f"'{source[:80]}' is not an instruction that zerorev writes", accepted=INSTRUCTIONS)

    def moved(self, found: re.Match[str]) -> None:
        kind, number, tag, printed, level = found.groups()
        if tag != {"MOVJ": "VJ", "MOVL": "V"}[kind]:
            self.refuse(f"{tag}= of a {kind}", accepted="MOVJ with VJ= [%], MOVL with V= [mm/s]")
        speed = Decimal(printed)
        if not speed > 0 or (kind == "MOVJ" and speed > FASTEST_SHARE):
            self.refuse(f"{tag}={printed}", accepted="above 0, and VJ= 100 at most")
        if int(number) != self.used or self.used >= len(self.positions):
            self.refuse(
                f"the move uses C{number}, out of turn",
                accepted=f"C{self.used:05d}: each position in one move, in order",
            )
        at, counts = self.positions[self.used]
        self.used += 1
        words: Words = (kind, *counts, f"{tag}=", speed, "PL=", Decimal(level))
        source = f"{found[0]} with C{number}={','.join(map(str, counts))} (line {at})"
        if kind == "MOVJ" and level == "0":
            self.go(WrittenJoints(counts, "pulses"))
        else:
            self.need_hole("a move of a hole before the MOVJ with PL=0 that leads to it")
            pace = Pace(speed.scaleb(-3)) if kind == "MOVL" else Pace(speed, "%")
            blend = None if level != "0" else Decimal(0)
            self.move(WrittenJoints(counts, "pulses"), pace, blend, linear=kind == "MOVL")
        self.note(words, source)

    def tool_and_base(self) -> tuple[None, None]:
        return None, None

    def note(self, words: Words, source: str) -> None:
        """Keep what a line tells the controller."""
        self.keep(Statement(words, self.line, source))

    def take(self) -> str:
        """The next line."""
        if not self.lines:
            self.refuse("the job is not complete", accepted="/JOB to END")
        self.line, source = self.lines.pop()
        return source

    def expect(self, form: str, shown: str = "") -> re.Match[str]:
        """The next line, which has to be of a form."""
        source = self.take()
        if (found := re.compile(form, re.ASCII).fullmatch(source)) is None:
            self.refuse(f"'{source[:80]}' is not the line that a job has here", accepted=shown or form)
        return found
