"""A TP program of ours read back, as data: what a certificate is to speak of is what stands in the file.

Strict: a statement of another form than `tp.write` writes is an error, for it might move the robot in a way that nobody
has examined. What the certificate assumes of the controller is required here, independent of the plan: the frames
selected by number before the first motion and named in each position, straight moves to poses and joint moves to joint
values, and nothing that offsets or interrupts them.
"""

from __future__ import annotations

import re
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
from zerorev.program.tp.source import ACCEPTED, Listed, Position, listed

__all__ = ["read_starter", "read_tp"]

WORLD = WrittenFrame((Decimal(0),) * 3, (Decimal(0),) * 3)
MILLI = Decimal("0.001")

_FRAME = re.compile(r"(UFRAME_NUM|UTOOL_NUM) ?= ?([0-9]{1,2})")
_MOTION = re.compile(r"([JL]) P\[([0-9]{1,7})\] ([0-9]{1,5})(%|msec|mm/sec|cm/min) (FINE|CNT100)")
_ARGUMENT = r"[0-9]{1,9}(?:\.[0-9]{1,9})?|'[^';]{0,34}'"
_CALL = re.compile(rf"CALL ([A-Z][A-Z0-9_]{{0,35}})(?: ?\( ?((?:{_ARGUMENT})(?: ?, ?(?:{_ARGUMENT}))*) ?\))?")
FORMS = (
    "UFRAME_NUM=n, UTOOL_NUM=n, CALL NAME, J P[n] n% FINE, J P[n] n msec, L P[n] n mm/sec or n cm/min, with FINE or "
    "CNT100, or a comment"
)


def read_tp(text: str, file: str = "program") -> WrittenProgram:
    """Read the text of a program.

    Args:
        text: of the file.
        file: how a message calls it.

    Raises:
        InputError: a statement that `export` does not write; the message has its line.
    """
    reading = _Reading(file)
    source = listed(text, reading.refuse_at)
    reading.begin(source)
    for line, statement in source.statements:
        reading.take(line, statement)
    return reading.end()


def read_starter(text: str, file: str = "program") -> tuple[str, tuple[Statement, ...]] | None:
    """Name and statements of a program that selects and moves nothing itself, but calls others; None: of any other.

    Raises:
        InputError: as `read_tp`.
    """
    reading = _Reading(file)
    source = listed(text, reading.refuse_at)
    reading.begin(source)
    if source.positions or any(not statement.startswith("CALL") for _, statement in source.statements):
        return None
    for line, statement in source.statements:
        reading.take(line, statement)
    return source.name, tuple(reading.head)


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
    line: int = 1
    source: Listed | None = None
    frames: dict[str, int] = field(default_factory=dict)
    head: list[Statement] = field(default_factory=list)
    hole: _Hole | None = None
    holes: list[WrittenHole] = field(default_factory=list)
    reached: set[int] = field(default_factory=set)

    def begin(self, source: Listed) -> None:
        self.source = source
        self.head.append(Statement(("/PROG", source.name.upper()), source.line, f"/PROG {source.name}"))

    def take(self, line: int, statement: str) -> None:
        """One statement of the file."""
        self.line = line
        if frame := _FRAME.fullmatch(statement):
            words = self.select(frame[1], int(frame[2]))
        elif motion := _MOTION.fullmatch(statement):
            words = self.move(*motion.groups())
        elif call := _CALL.fullmatch(statement):
            words = self.call(*call.groups())
        else:
            self.refuse(f"'{statement[:80]}' is not a statement that zerorev writes", accepted=FORMS)
        (self.head if self.hole is None else self.hole.statements).append(Statement(words, line, statement))

    def select(self, name: str, number: int) -> tuple[Word, ...]:
        """A frame, once, before the first motion."""
        if name in self.frames or self.hole is not None:
            self.refuse(f"{name} is set a second time, or after a motion")
        self.frames[name] = number
        return name, Decimal(number)

    def call(self, name: str, arguments: str | None) -> tuple[Word, ...]:
        """A program of the controller, called where the robot stands."""
        if self.hole is not None and self.hole.moves and not self.hole.moves[-1].stops:
            self.refuse(f"{name} is called between blended moves")
        return ("CALL", name, *re.findall(_ARGUMENT, arguments or ""))

    def move(self, kind: str, number: str, value: str, unit: str, termination: str) -> tuple[Word, ...]:
        """A motion to a position that no other one leads to."""
        position = self.position(int(number))
        if bool(position.posture) != (kind == "L"):
            self.refuse(f"P[{number}] is {'a pose' if position.posture else 'in joint values'}, for a move {kind}")
        if Decimal(value) == 0:
            self.refuse("a speed of 0", accepted="a number above 0")
        speed, stops = Decimal(value), termination == "FINE"
        if (kind, unit) == ("J", "%"):
            if not stops:
                self.refuse("a J move at a share of the speed that is blended", accepted="FINE")
            self.go(position)
        elif (kind, unit) == ("J", "msec"):
            self.follow(WrittenJoints(position.values), Pace(speed * MILLI, "s"), stops, linear=False)
        elif (kind, unit) == ("L", "mm/sec"):
            self.follow(_pose(position), Pace(speed * MILLI), stops, linear=True)
        elif (kind, unit) == ("L", "cm/min"):
            self.follow(_pose(position), Pace(speed, "cm/min"), stops, linear=True)
        else:
            self.refuse(f"a move {kind} in {unit}", accepted="J in % or msec, L in mm/sec or cm/min")
        return (kind, *position.words, "SPEED", value, unit, termination)

    def position(self, number: int) -> Position:
        """A position, in the frames that are selected."""
        assert self.source is not None
        if number not in self.source.positions:
            self.refuse(f"P[{number}] is not among the positions")
        if number in self.reached:
            self.refuse(f"P[{number}] is moved to a second time", accepted="a position for each motion")
        if missing := [name for name in ("UFRAME_NUM", "UTOOL_NUM") if name not in self.frames]:
            self.refuse(f"a motion before {' and '.join(missing)} is set")
        position = self.source.positions[number]
        if (position.user, position.tool) != (self.frames["UFRAME_NUM"], self.frames["UTOOL_NUM"]):
            self.refuse_at(position.line, f"P[{number}] is in other frames than the program selects")
        self.reached.add(number)
        return position

    def go(self, position: Position) -> None:
        """A move of all axes: to a point on the way, if another follows before the first move of a hole."""
        before: tuple[Statement, ...] = ()
        if self.hole is not None and not self.hole.moves:
            before = (*self.hole.way, *self.hole.statements)
        else:
            self.close()
        self.hole = _Hole(self.line, WrittenJoints(position.values), before)

    def follow(self, end: WrittenFrame | WrittenJoints, pace: Pace, stops: bool, *, linear: bool) -> None:
        if self.hole is None:
            self.refuse("a move of a hole before the J move to its start")
        self.hole.moves.append(WrittenMove(self.line, end, pace, Decimal(0) if stops else None, linear))

    def close(self) -> None:
        """End the hole that is being read."""
        hole, self.hole = self.hole, None
        if hole is None:
            return
        if not hole.moves[-1].stops:
            self.refuse(f"the last move of a hole (line {hole.moves[-1].line}) is blended", accepted="FINE")
        self.holes.append(WrittenHole(hole.line, hole.start, tuple(hole.moves), tuple(hole.statements), hole.way))

    def end(self) -> WrittenProgram:
        assert self.source is not None
        tail: tuple[Statement, ...] = ()
        if self.hole is not None and not self.hole.moves:
            tail, self.hole = (*self.hole.way, *self.hole.statements), None
        self.close()
        if not self.holes:
            self.refuse("the program has no holes")
        if unused := sorted(self.source.positions.keys() - self.reached):
            self.refuse_at(self.source.positions[unused[0]].line, f"P[{unused[0]}] is not moved to")
        base = WORLD if self.frames["UFRAME_NUM"] == 0 else None
        return WrittenProgram(self.source.name, None, base, tuple(self.holes), tuple(self.head), tail)

    def refuse(self, what: str, *, accepted: str = ACCEPTED) -> NoReturn:
        raise InputError(what, where=f"{self.file}, line {self.line}", accepted=accepted)

    def refuse_at(self, line: int, what: str) -> NoReturn:
        self.line = line
        self.refuse(what)


def _pose(position: Position) -> WrittenFrame:
    """X, Y, Z, and the turns about Z, Y and X."""
    w, p, r = position.values[3:]
    return WrittenFrame(position.values[:3], (r, p, w))
