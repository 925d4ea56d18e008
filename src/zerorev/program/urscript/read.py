"""A URScript program of ours read back, as data: what a certificate is to speak of is what stands in the file.

Strict: a statement of another form than `urscript.write` writes is an error, for it might move the robot in a way that
nobody has examined. Numbers are kept as the decimals that they are. What the certificate assumes of the controller is
required here, independent of the plan: one tool and one part frame, set before the first move; poses only of straight
moves and joints only of joint moves; within a hole nothing but moves, and no blend at its end.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, field
from decimal import Decimal
from typing import NoReturn

from zerorev.errors import InputError
from zerorev.model.written import (
    Pace,
    Statement,
    Word,
    WrittenFrame,
    WrittenHole,
    WrittenJoints,
    WrittenMove,
    WrittenProgram,
)
from zerorev.program.urscript.names import KEPT
from zerorev.program.urscript.source import shape, statements, words

__all__ = ["read_starter", "read_urscript"]

NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,31}")
STOP = Decimal(0)  # radius of a blend where the robot stands


def read_urscript(text: str, file: str = "program") -> WrittenProgram:
    """Read the text of a program that moves the robot.

    Args:
        text: of the file.
        file: how a message calls it.

    Raises:
        InputError: a statement that `export` does not write; the message has its line.
    """
    reading = _Reading(file)
    for statement in statements(text, reading.refuse_at):
        reading.take(statement)
    return reading.end()


def read_starter(text: str, file: str = "program") -> tuple[str, tuple[Statement, ...]] | None:
    """Name and statements of a program that sets and moves nothing itself, but calls others; None: of any other.

    Raises:
        InputError: as `read_urscript`.
    """
    reading = _Reading(file)
    for statement in statements(text, reading.refuse_at):
        reading.take(statement)
        if reading.set or reading.hole:
            return None
    return (reading.name, tuple(reading.head)) if reading.ended else None


@dataclass
class _Hole:
    line: int
    start: WrittenJoints
    way: tuple[Statement, ...] = ()
    moves: list[WrittenMove] = field(default_factory=list)
    statements: list[Statement] = field(default_factory=list)


@dataclass
class _Reading:
    """What is known up to a statement."""

    file: str
    line: int = 0
    name: str = ""
    ended: bool = False
    set: dict[str, tuple[Decimal, ...]] = field(default_factory=dict)
    head: list[Statement] = field(default_factory=list)
    hole: _Hole | None = None
    holes: list[WrittenHole] = field(default_factory=list)
    tail: tuple[Statement, ...] = ()

    def take(self, statement: Statement) -> None:
        """One statement of the file."""
        self.line = statement.line
        if self.ended:
            self.refuse(f"'{statement.source}' after end")
        if (statement.words[0] == "def") == bool(self.name):
            self.refuse("a second program" if self.name else f"'{statement.source}' before def")
        if not self.name:
            self.begin(statement)
        elif (form := FORMS.get(shape(statement.words))) is not None:
            form(self, _name(statement.words), tuple(word for word in statement.words if isinstance(word, Decimal)))
        elif is_call(statement.words):
            if self.hole is not None and self.hole.moves and not self.hole.moves[-1].stops:
                self.refuse(f"{statement.source} is called between blended moves")
        else:
            self.refuse_form(statement)
        if not self.ended:
            (self.head if self.hole is None else self.hole.statements).append(statement)

    def begin(self, statement: Statement) -> None:
        name = str(statement.words[1]) if len(statement.words) > 1 else ""
        if statement.words != ("def", name, "(", ")", ":") or not NAME.fullmatch(name) or name in KEPT:
            accepted = "def name():, of at most 32 letters, digits and underscores"
            self.refuse(f"'{statement.source}'", accepted=accepted)
        self.name = name

    def prepare(self, name: str, numbers: tuple[Decimal, ...]) -> None:
        """What is set once, before the first move."""
        if name in self.set or self.hole is not None:
            self.refuse(f"{name} is set a second time, or after a move")
        if name == "set_payload":
            self.above_zero("mass", numbers[0])
        self.set[name] = numbers

    def above_zero(self, what: str, number: Decimal) -> None:
        if not number > 0:
            self.refuse(f"{what}={number}", accepted="a number above 0")

    def go(self, _: str, numbers: tuple[Decimal, ...]) -> None:
        """A joint move to a stop: to a point on the way, if another follows before the first move of the hole."""
        if missing := [name for name in NEEDED if name not in self.set]:
            self.refuse(f"a move before {' and '.join(missing)}")
        self.above_zero("a", numbers[6])
        self.above_zero("v", numbers[7])
        before: tuple[Statement, ...] = ()
        if self.hole is not None and not self.hole.moves:
            before = (*self.hole.way, *self.hole.statements)
        else:
            self.close()
        self.hole = _Hole(self.line, WrittenJoints(numbers[:6], "rad"), before)

    def go_straight(self, _: str, numbers: tuple[Decimal, ...]) -> None:
        """A straight move, with its acceleration, speed and, if it is blended, radius."""
        acceleration, speed, *radius = numbers[6:]
        self.above_zero("a", acceleration)
        self.above_zero("v", speed)
        self.move(_pose(numbers), Pace(speed), radius, linear=True)

    def go_jointly(self, _: str, numbers: tuple[Decimal, ...]) -> None:
        """A joint move within a hole, with its time and, if it is blended, radius."""
        time, *radius = numbers[6:]
        self.above_zero("t", time)
        self.move(WrittenJoints(numbers[:6], "rad"), Pace(time, "s"), radius, linear=False)

    def move(self, end: WrittenFrame | WrittenJoints, pace: Pace, radius: list[Decimal], *, linear: bool) -> None:
        if self.hole is None:
            self.refuse("a move of a hole before the movej to its first point")
        for each in radius:
            self.above_zero("r", each)
        blend = _mm(radius[0]) if radius else STOP
        self.hole.moves.append(WrittenMove(self.line, end, pace, blend, linear))

    def finish(self, *_: object) -> None:
        if self.hole is not None and not self.hole.moves:
            self.tail, self.hole = (*self.hole.way, *self.hole.statements), None
        self.close()
        self.ended = True

    def close(self) -> None:
        """End the hole that is being read."""
        hole, self.hole = self.hole, None
        if hole is None:
            return
        if not hole.moves[-1].stops:
            self.refuse(f"the last move of a hole (line {hole.moves[-1].line}) is blended", accepted="no r")
        self.holes.append(WrittenHole(hole.line, hole.start, tuple(hole.moves), tuple(hole.statements), hole.way))

    def end(self) -> WrittenProgram:
        if not self.ended or not self.name:
            self.refuse("the program is not complete", accepted="def to end")
        if not self.holes:
            self.refuse("the program has no holes")
        tool, part = (_pose(self.set[name]) for name in NEEDED)
        return WrittenProgram(self.name, tool, part, tuple(self.holes), tuple(self.head), self.tail)

    def refuse_form(self, statement: Statement) -> NoReturn:
        alike = [form for form in SOURCES if words(form, self.refuse)[0] == statement.words[0]]
        accepted = " or ".join(alike) + ", a number for each 0" * any("0" in form for form in alike)
        what = f"'{statement.source[:80]}' is not a statement that zerorev writes"
        self.refuse(what, accepted=accepted or "a program as zerorev exports it")

    def refuse(self, what: str, *, accepted: str = "a program as zerorev exports it") -> NoReturn:
        raise InputError(what, where=f"{self.file}, line {self.line}", accepted=accepted)

    def refuse_at(self, line: int, what: str) -> NoReturn:
        self.line = line
        self.refuse(what)


def is_call(words: tuple[Word, ...]) -> bool:
    """Whether a statement calls a function that is not one of the language's own, with nothing but literals."""
    name, *rest = words
    if not isinstance(name, str) or not NAME.fullmatch(name) or name in KEPT or rest[:1] != ["("] or rest[-1:] != [")"]:
        return False
    arguments, commas = rest[1:-1:2], rest[2:-1:2]
    literal = all(isinstance(each, Decimal) or each in ("True", "False") or each[0] == '"' for each in arguments)
    return literal and all(comma == "," for comma in commas) and len(arguments) in (0, len(commas) + 1)


def _name(words: tuple[Word, ...]) -> str:
    """How a message calls what a statement sets."""
    return str(words[1] if words[0] == "local" else words[0])


def _pose(numbers: tuple[Decimal, ...]) -> WrittenFrame:
    """Metres, and a rotation vector."""
    return WrittenFrame(tuple(_mm(length) for length in numbers[:3]), numbers[3:6], "vector_rad")


def _mm(length: Decimal) -> Decimal:
    return length.scaleb(3)


SIX = "0, 0, 0, 0, 0, 0"
SOURCES: dict[str, Callable[[_Reading, str, tuple[Decimal, ...]], None]] = {
    f"set_tcp(p[{SIX}])": _Reading.prepare,
    "set_payload(0, [0, 0, 0])": _Reading.prepare,
    f"local part = p[{SIX}]": _Reading.prepare,
    f"movej([{SIX}], a=0, v=0)": _Reading.go,
    f"movel(pose_trans(part, p[{SIX}]), a=0, v=0)": _Reading.go_straight,
    f"movel(pose_trans(part, p[{SIX}]), a=0, v=0, r=0)": _Reading.go_straight,
    f"movej([{SIX}], t=0)": _Reading.go_jointly,
    f"movej([{SIX}], t=0, r=0)": _Reading.go_jointly,
    "end": _Reading.finish,
}
"""Every form of a statement between def and end, and what it does; `0` stands for any number."""

FORMS = {shape(words(source, _Reading("").refuse)): act for source, act in SOURCES.items()}
NEEDED = ("set_tcp", "part")
"""What the moves count from: set before the first one."""
