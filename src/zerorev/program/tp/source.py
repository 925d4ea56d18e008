"""A TP file as a controller reads it: its sections, the numbered lines, and the positions to which they refer.

Written from the format, which the controller has of a program in its memory: a file that was loaded, saved again and
given other attributes, tabs or zeros is read as the one that was written.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from decimal import Decimal

from zerorev.model.written import Word
from zerorev.program.source import Refuse, alike_but, ascii_lines, rounds_alike

__all__ = ["ACCEPTED", "Listed", "Position", "alike", "listed"]

ACCEPTED = "a program as zerorev exports it"

_ANGLES = ("W", "P", "R")
_VALUES = ("X", "Y", "Z", *_ANGLES, "J1", "J2", "J3", "J4", "J5", "J6")
_NUMBER = r"(-?[0-9]{0,6}\.[0-9]{1,9}|-?[0-9]{1,6})"
_PROGRAM = re.compile(r"/PROG[ \t]+([A-Za-z][A-Za-z0-9_]{0,35})[ \t]*")
_GROUP = re.compile(r"DEFAULT_GROUP[ \t]*=[ \t]*1,\*,\*,\*,\*;")
_ATTRIBUTE = re.compile(
    r'(OWNER|FILE_NAME)\s*=\s*\w*;|COMMENT\s*=\s*"[^";]{0,16}";|(PROG_SIZE|VERSION|LINE_COUNT|MEMORY_SIZE)\s*=\s*\d+;'
    r"|(CREATE|MODIFIED)\s*=\s*DATE\s+\d+-\d+-\d+\s+TIME\s+\d+:\d+:\d+;|PROTECT\s*=\s*(READ_WRITE|READ);"
    r"|TCD:\s*STACK_SIZE\s*=\s*\d+,|(TASK_PRIORITY|TIME_SLICE|BUSY_LAMP_OFF|ABORT_REQUEST)\s*=\s*\d+,"
    r"|PAUSE_REQUEST\s*=\s*\d+;|CONTROL_CODE\s*=\s*[0-9A-F]{8}\s+[0-9A-F]{8};"
)
_LINE = re.compile(r"[ \t]*([0-9]{1,7}):([^;]*);[ \t]*")
_POSITION = re.compile(r"P\[([0-9]{1,7})\]\{")
_FRAMES = re.compile(
    r"UF : ([0-9]{1,2}), UT : ([0-9]{1,2}),(?: CONFIG : '([NF]) ([UD]) ([TB]), (-?\d), (-?\d), (-?\d)',)?"
)
_POSE = re.compile(
    " ?".join(f"{name} ?= ?{_NUMBER} ?{unit}," for name, unit in zip("XYZWPR", 3 * ["mm"] + 3 * ["deg"], strict=True))[
        :-1
    ]
)
_JOINTS = re.compile(" ?".join(f"J{n} ?= ?{_NUMBER} ?deg," for n in range(1, 7))[:-1])


@dataclass(frozen=True)
class Position:
    """A position of a program.

    Attributes:
        line: of the file, from 1.
        user: number of the user frame.
        tool: number of the tool frame.
        posture: letters and turns; empty: it is given in joint values.
        values: X, Y, Z, W, P, R or J1 to J6.
    """

    line: int
    user: int
    tool: int
    posture: str
    values: tuple[Decimal, ...]

    @property
    def words(self) -> tuple[Word, ...]:
        """Of a statement that moves to it."""
        names = _VALUES[:6] if self.posture else _VALUES[6:]
        named = [word for pair in zip(names, self.values, strict=True) for word in pair]
        return ("UF", Decimal(self.user), "UT", Decimal(self.tool), self.posture, *named)


@dataclass(frozen=True)
class Listed:
    """What is in a file.

    Attributes:
        name: of the program.
        line: where it stands, from 1.
        statements: line of the file and text of each, comments left out.
        positions: by their numbers.
        last: number of the last line.
    """

    name: str
    line: int
    statements: tuple[tuple[int, str], ...]
    positions: dict[int, Position]
    last: int


def listed(text: str, refuse: Refuse) -> Listed:
    """The parts of a file.

    Args:
        text: of the file.
        refuse: called with a line and what is wrong there.
    """
    lines = [(number, line.strip(" \t")) for number, line in ascii_lines(text, refuse) if line.strip(" \t")]
    last = lines[-1][0] if lines else 1
    sections: dict[str, list[tuple[int, str]]] = {}
    order = ("/PROG", "/ATTR", "/APPL", "/MN", "/POS", "/END")
    for number, line in lines:
        if (line.startswith("/") and not sections) or line in order:
            name = line.split()[0]
            if name not in order or (sections and order.index(name) <= order.index(next(reversed(sections)))):
                refuse(number, f"'{line[:60]}' where another section of a program is expected")
            sections[name] = [(number, line)] if name == "/PROG" else []
        elif not sections:
            refuse(number, f"'{line[:60]}' before /PROG")
        else:
            sections[next(reversed(sections))].append((number, line))
    if missing := [name for name in order if name not in sections and name != "/APPL"]:
        refuse(last, f"{', '.join(missing)} is missing")
    (at, title), *surplus = sections["/PROG"]
    name_of = _PROGRAM.fullmatch(title)
    if name_of is None:
        refuse(at, f"'{title[:60]}' is not the begin of a program: /PROG and a name of letters, digits and underscores")
    for number, line in (*surplus, *sections.get("/APPL", ()), *sections["/END"]):
        refuse(number, f"'{line[:60]}' where nothing is expected")
    _attributes(sections["/ATTR"], at, refuse)
    statements = tuple(_statements(sections["/MN"], refuse))
    return Listed(name_of[1], at, statements, _positions(sections["/POS"], refuse), last)


def _attributes(lines: list[tuple[int, str]], at: int, refuse: Refuse) -> None:
    """What a controller keeps of a program besides its lines; the group that is moved must be the robot's."""
    groups = [number for number, line in lines if _GROUP.fullmatch(line)]
    if len(groups) != 1:
        refuse(groups[1] if groups else at, "DEFAULT_GROUP = 1,*,*,*,*; is expected once among the attributes")
    for number, line in lines:
        if number not in groups and not _ATTRIBUTE.fullmatch(line):
            refuse(number, f"'{line[:60]}' is not an attribute of a program that drills")


def _statements(lines: list[tuple[int, str]], refuse: Refuse) -> Iterator[tuple[int, str]]:
    for count, (number, line) in enumerate(lines, start=1):
        found = _LINE.fullmatch(line)
        if found is None:
            refuse(number, f"'{line[:60]}' is not a numbered line that ends in a semicolon")
        if int(found[1]) != count:
            refuse(number, f"line number {found[1]} where {count} is expected")
        if not (statement := " ".join(found[2].split())).startswith("!"):
            yield number, statement


def _positions(lines: list[tuple[int, str]], refuse: Refuse) -> dict[int, Position]:
    """The positions, each of one group."""
    found: dict[int, Position] = {}
    body: list[str] = []
    begun: tuple[int, int] | None = None  # number of the position, and its line
    for number, line in lines:
        if begun is None:
            if (begin := _POSITION.fullmatch(line)) is None or int(begin[1]) in found:
                refuse(number, f"'{line[:60]}' where the next position begins: P[n]{{, each number once")
            begun, body = (int(begin[1]), number), []
        elif line == "};":
            found[begun[0]] = _position(begun[1], " ".join(" ".join(body).split()), refuse)
            begun = None
        else:
            body.append(line)
    if begun is not None:
        refuse(begun[1], f"P[{begun[0]}] does not end")
    return found


def _position(line: int, body: str, refuse: Refuse) -> Position:
    group, _, rest = body.partition("GP1: ")
    frames = _FRAMES.match(rest) if not group else None
    if frames is not None:
        pose = frames[3] is not None
        values = (_POSE if pose else _JOINTS).fullmatch(rest[frames.end() :].strip())
        if values is not None:
            posture = "{} {} {}, {}, {}, {}".format(*frames.groups()[2:]) if pose else ""
            return Position(line, int(frames[1]), int(frames[2]), posture, tuple(map(Decimal, values.groups())))
    refuse(line, "a position of another form: of GP1 alone, UF, UT, and J1 to J6, or CONFIG, X, Y, Z, W, P and R")


def alike(found: Sequence[Word], wanted: Sequence[Word]) -> bool:
    """Whether a statement is the one expected: its position but for one in the last printed digits.

    Args:
        found: words of a program's statement.
        wanted: as `export` writes it.
    """
    names = ("", *wanted)
    return alike_but(
        found,
        wanted,
        lambda at, own, other: names[at] in _VALUES and rounds_alike(own, other, turns=names[at] in _ANGLES),
    )
