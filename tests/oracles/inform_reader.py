"""A small reader of INFORM jobs: which positions and moves a file has, as the manuals of NX100 and DX100 describe them.

It shares nothing with the writer. It is strict: a line that it does not know is an error, so that a golden job cannot
come to hold one that nobody has thought about. Pulses, mm/s and % as in the file.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field

import numpy as np

HEAD = (
    r"/JOB", r"//NAME [A-Z0-9_-]{1,8}", r"//POS", r"///NPOS \d+,0,0,0,0,0", r"(///TOOL \d+)?", r"(///POSTYPE PULSE)?",
    r"(///PULSE)?", r"//INST", r"///DATE \d{4}/\d\d/\d\d \d\d:\d\d", r"(///COMM .{1,32})?", r"///ATTR SC,RW",
    r"///GROUP1 RB1", r"NOP",
)  # fmt: skip


class InformError(Exception):
    """A line that a controller would refuse, or that no drilling job should hold."""


@dataclass(frozen=True)
class Move:
    """One motion."""

    kind: str  # MOVJ or MOVL
    pulses: np.ndarray
    speed: float  # of MOVJ in %, of MOVL in mm/s
    level: int


@dataclass
class InformJob:
    name: str = ""
    tool: int | None = None
    moves: list[Move] = field(default_factory=list)
    calls: list[tuple[int, str]] = field(default_factory=list)  # after how many moves, and what
    comments: list[str] = field(default_factory=list)
    waits: list[tuple[int, float]] = field(default_factory=list)  # after how many moves, and how long [s]

    def holes(self) -> list[list[Move]]:
        """The moves, one list per hole: each begins with the last stopping MOVJ that leads to it."""
        found: list[list[Move]] = []
        for number, move in enumerate(self.moves):
            if move.kind == "MOVJ" and move.level == 0:
                following = self.moves[number + 1 : number + 2]
                if following and not (following[0].kind == "MOVJ" and following[0].level == 0):
                    found.append([move])
            else:
                found[-1].append(move)
        return found


def read(text: str) -> InformJob:
    """One job."""
    job, counts, count, head, lines = InformJob(), [], 0, list(HEAD), text.split("\n")
    if lines.pop() or lines.pop() != "END":
        raise InformError("no END, or no line feed after it")
    for line in lines:
        if head:
            if pulses := re.fullmatch(r"C(\d{5})=(-?\d+(?:,-?\d+){5})", line):
                if int(pulses[1]) != len(counts):
                    raise InformError(line)
                counts.append(np.array([int(number) for number in pulses[2].split(",")]))
                continue
            while not re.fullmatch(head[0], line):
                if head.pop(0)[0] != "(":
                    raise InformError(line)
            head.pop(0)
            word, _, rest = line.partition(" ")
            match word:
                case "//NAME":
                    job.name = rest
                case "///TOOL":
                    job.tool = int(rest)
                case "///NPOS":
                    count = int(rest.split(",")[0])
        elif line.startswith("'"):
            if len(line) > 33:
                raise InformError(f"a comment of more than 32 characters: {line}")
            job.comments.append(line)
        elif move := re.fullmatch(r"(MOVJ|MOVL) C(\d{5}) (VJ|V)=(\d+\.\d+) PL=([0-8])", line):
            if int(move[2]) != len(job.moves) or (move[1] == "MOVJ") != (move[3] == "VJ"):
                raise InformError(line)
            decimals = len(move[4].partition(".")[2])
            if decimals != (2 if move[3] == "VJ" else 1) or not 0 < float(move[4]) <= (
                100 if move[3] == "VJ" else 1500
            ):
                raise InformError(line)
            job.moves.append(Move(move[1], counts[int(move[2])], float(move[4]), int(move[5])))
        elif wait := re.fullmatch(r"TIMER T=(\d{1,3}\.\d\d)", line):
            if not job.moves or job.moves[-1].level:
                raise InformError(f"{line} while the robot moves")
            job.waits.append((len(job.moves), float(wait[1])))
        elif call := re.fullmatch(r"CALL JOB:([A-Za-z0-9_-]{1,32})", line):
            job.calls.append((len(job.moves), call[1]))
        else:
            raise InformError(line)
    if head or not count == len(counts) == len(job.moves):
        raise InformError("the head is not complete, or positions and moves do not match")
    return job
