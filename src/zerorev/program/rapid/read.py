"""A RAPID module of ours read back, as data: what a certificate is to speak of is what stands in the file.

Strict: a statement of another form than `rapid.write` writes is an error, for it might move the robot in a way that
nobody has examined. Numbers are kept as the decimals that they are. What the certificate assumes of the controller is
required here, independent of the plan: how a zone takes tip and turn, that no displacement is active, that the wrist is
not led past a singularity otherwise, and that each move has the module's own tool and work object.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, field, replace
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
from zerorev.program.rapid.source import PART, TOOL, any_name, is_call, shape, statements, with_roles, words

__all__ = ["read_rapid", "read_starter"]

NAME = re.compile(r"[A-Z][A-Z0-9_]{0,26}", re.IGNORECASE)
IDENTITY = tuple(map(Decimal, (0, 0, 0, 1, 0, 0, 0)))
WANTED = {"ACCSET": (Decimal(100), Decimal(100)), "VELSET": (Decimal(100), Decimal(5000))}  # all that there is


def read_rapid(text: str, file: str = "program") -> WrittenProgram:
    """Read the text of a module.

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
    """Name and statements of a module that sets and moves nothing itself, but calls others; None: of any other.

    Raises:
        InputError: as `read_rapid`.
    """
    reading = _Reading(file)
    for statement in statements(text, reading.refuse_at):
        reading.take(statement)
        if reading.settings - {"PROC"} or reading.hole:
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
    closed: bool = False  # the procedure
    ended: bool = False
    settings: set[str] = field(default_factory=set)
    frames: dict[str, WrittenFrame] = field(default_factory=dict)
    speeds: dict[str, Decimal] = field(default_factory=dict)  # of the tip [mm/s]
    zones: dict[str, Decimal] = field(default_factory=dict)  # [mm]
    head: list[Statement] = field(default_factory=list)
    hole: _Hole | None = None
    holes: list[WrittenHole] = field(default_factory=list)
    tail: list[Statement] | None = None

    def take(self, statement: Statement) -> None:
        """One statement of the file."""
        self.line = statement.line
        if self.ended:
            self.refuse(f"'{statement.source}' after ENDMODULE")
        if (statement.words[0] == "MODULE") == bool(self.name):
            self.refuse("a second module" if self.name else f"'{statement.source}' before MODULE")
        if not self.name:
            self.begin(statement)
            self.head.append(statement)
            return
        statement = replace(statement, words=with_roles(statement.words, self.name))
        found = statement.words
        if (form := FORMS.get(shape(any_name(found)))) is not None:
            form(self, found, tuple(word for word in found if isinstance(word, Decimal)))
        elif is_call(found):
            self.stand_still(f"'{statement.source}'")
        else:
            self.refuse_form(statement)
        if found[0] not in ("ENDPROC", "ENDMODULE"):
            self.keep(statement)

    def keep(self, statement: Statement) -> None:
        """Put a statement where it belongs."""
        if self.tail is not None:
            self.tail.append(statement)
        else:
            (self.head if self.hole is None else self.hole.statements).append(statement)

    def begin(self, statement: Statement) -> None:
        name = statement.source[6:].strip()
        if statement.words != ("MODULE", name.upper()) or not NAME.fullmatch(name):
            accepted = "MODULE name, of at most 27 letters, digits and underscores"
            self.refuse(f"'{statement.source}'", accepted=accepted)
        self.name = name

    def once(self, name: str, *, declaration: bool) -> None:
        """What stands once, as data before the procedure or in it before the first move."""
        if name in self.settings or self.hole is not None or self.tail is not None:
            self.refuse(f"{name} is set a second time, or within a hole")
        if declaration == ("PROC" in self.settings):
            self.refuse(f"{name} {'within' if declaration else 'before'} the procedure")
        self.settings.add(name)

    def declare_tool(self, _: tuple[Word, ...], numbers: tuple[Decimal, ...]) -> None:
        self.once(TOOL, declaration=True)
        if not numbers[7] > 0:
            self.refuse(f"a load of {numbers[7]} kg", accepted="a mass above 0: a controller refuses 0")
        self.frames[TOOL] = _frame(numbers[:7])

    def declare_part(self, _: tuple[Word, ...], numbers: tuple[Decimal, ...]) -> None:
        self.once(PART, declaration=True)
        if numbers[7:] != IDENTITY:
            self.refuse("an object frame within the user frame", accepted="[[0,0,0],[1,0,0,0]]")
        self.frames[PART] = _frame(numbers[:7])

    def declare_speed(self, words: tuple[Word, ...], numbers: tuple[Decimal, ...]) -> None:
        name = str(words[3])
        self.once(name, declaration=True)
        if not all(number > 0 for number in numbers):
            self.refuse(f"{name} is not above 0", accepted="numbers above 0")
        self.speeds[name] = numbers[0]

    def declare_zone(self, words: tuple[Word, ...], numbers: tuple[Decimal, ...]) -> None:
        name = str(words[3])
        self.once(name, declaration=True)
        if not all(number > 0 for number in numbers):
            self.refuse(f"{name} is not above 0", accepted="numbers above 0; fine for a stop")
        radius = numbers[0]
        if any(number != radius for number in (*numbers[1:3], *numbers[4:])):
            accepted = "equal radii: a greater one for the turn of the tool than for its tip brings reversals back"
            self.refuse(f"{name} has different radii", accepted=accepted)
        self.zones[name] = radius

    def begin_procedure(self, *_: object) -> None:
        self.once("PROC", declaration=True)

    def set(self, words: tuple[Word, ...], numbers: tuple[Decimal, ...]) -> None:
        self.once(str(words[0]), declaration=False)
        wanted = WANTED.get(str(words[0]), ())
        if numbers != wanted:
            accepted = f"{words[0]} {','.join(map(str, wanted))}"
            self.refuse(f"{words[0]} {','.join(map(str, numbers))}", accepted=accepted)

    def stand_still(self, what: str) -> None:
        """Refuse what would make a zone a stop."""
        if "PROC" not in self.settings or self.closed:
            self.refuse(f"{what} outside of the procedure")
        if self.hole is not None and self.hole.moves and not self.hole.moves[-1].stops:
            self.refuse(f"{what} between blended moves")

    def ready(self) -> None:
        """Refuse a move before all is set that it depends on, or after what follows the last one."""
        if missing := [name for name in NEEDED if name not in self.settings]:
            self.refuse(f"a move before {', '.join(missing)}")
        if self.tail is not None:
            self.refuse("a move after ConfL\\On")

    def go(self, words: tuple[Word, ...], numbers: tuple[Decimal, ...]) -> None:
        """A move of all axes to a stop: to a point on the way, if another follows before the hole's moves."""
        self.ready()
        self.speed(words[-10])
        before: tuple[Statement, ...] = ()
        if self.hole is not None and not self.hole.moves:
            before = (*self.hole.way, *self.hole.statements)
        else:
            self.close()
        self.hole = _Hole(self.line, WrittenJoints(numbers[:6]), before)

    def go_straight(self, words: tuple[Word, ...], numbers: tuple[Decimal, ...]) -> None:
        # mm/s as m/s: the digits stay
        pace = Pace(self.speed(words[-10]).scaleb(-3))
        self.move(words, _frame(numbers[:7]), pace, linear=True)

    def go_evenly(self, words: tuple[Word, ...], numbers: tuple[Decimal, ...]) -> None:
        self.speed(words[-14])
        if not numbers[-1] > 0:
            self.refuse(f"a time of {numbers[-1]} s", accepted="a time above 0")
        self.move(words, WrittenJoints(numbers[:6]), Pace(numbers[-1], "s"), linear=False)

    def move(self, words: tuple[Word, ...], end: WrittenFrame | WrittenJoints, pace: Pace, *, linear: bool) -> None:
        self.ready()
        if self.hole is None:
            self.refuse(
                f"a {'MoveL' if linear else 'MoveAbsJ with a time'} before the MoveAbsJ to the start of its hole"
            )
        zone = str(words[-8])
        if zone != "FINE" and zone not in self.zones:
            self.refuse(f"the zone {zone} is not declared", accepted=" or ".join(["fine", *self.zones]))
        self.hole.moves.append(WrittenMove(self.line, end, pace, self.zones.get(zone, Decimal(0)), linear))

    def speed(self, name: Word) -> Decimal:
        """Of the tip [mm/s]."""
        if name not in self.speeds:
            self.refuse(f"the speed {name} is not declared", accepted=" or ".join(self.speeds))
        return self.speeds[str(name)]

    def afterwards(self, *_: object) -> None:
        """What follows the last move: all of it belongs to no hole."""
        self.ready()
        if self.hole is None:
            self.refuse("ConfL\\On before the first hole")
        tail: list[Statement] = []
        if not self.hole.moves:
            tail, self.hole = [*self.hole.way, *self.hole.statements], None
        self.close()
        self.tail = tail

    def end_procedure(self, *_: object) -> None:
        if "PROC" not in self.settings or self.closed:
            self.refuse("ENDPROC without PROC")
        if self.hole is not None:
            self.refuse("ENDPROC before ConfL\\On")
        self.closed = True

    def finish(self, *_: object) -> None:
        if not self.closed:
            self.refuse("ENDMODULE before ENDPROC")
        self.ended = True

    def close(self) -> None:
        """End the hole that is being read."""
        hole, self.hole = self.hole, None
        if hole is None:
            return
        if not hole.moves[-1].stops:
            self.refuse(f"the last move of a hole (line {hole.moves[-1].line}) is blended", accepted="fine")
        self.holes.append(WrittenHole(hole.line, hole.start, tuple(hole.moves), tuple(hole.statements), hole.way))

    def end(self) -> WrittenProgram:
        if not self.ended:
            self.refuse("the program is not complete", accepted="MODULE to ENDMODULE")
        if not self.holes:
            self.refuse("the program has no holes")
        frames = self.frames[TOOL], self.frames[PART]
        return WrittenProgram(self.name, *frames, tuple(self.holes), tuple(self.head), tuple(self.tail or ()))

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


def _frame(numbers: tuple[Decimal, ...]) -> WrittenFrame:
    """x, y, z and a quaternion."""
    return WrittenFrame(numbers[:3], numbers[3:], "quaternion")


FRAME = "[0,0,0],[0,0,0,0]"
OUTER = "[0,0,0,0,0,0]"
JOINTS = f"[[0,0,0,0,0,0],{OUTER}]"
TARGET = f"[{FRAME},[0,0,0,0],{OUTER}]"
FRAMES = "NAME_tool\\WObj:=NAME_part;"
SOURCES: dict[str, Callable[[_Reading, tuple[Word, ...], tuple[Decimal, ...]], None]] = {
    f"PERS tooldata NAME_tool:=[TRUE,[{FRAME}],[0,[0,0,0],[0,0,0,0],0,0,0]];": _Reading.declare_tool,
    f'PERS wobjdata NAME_part:=[FALSE,TRUE,"",[{FRAME}],[{FRAME}]];': _Reading.declare_part,
    "LOCAL CONST speeddata NAME:=[0,0,0,0];": _Reading.declare_speed,
    "LOCAL CONST zonedata NAME:=[FALSE,0,0,0,0,0,0];": _Reading.declare_zone,
    "PROC NAME_run()": _Reading.begin_procedure,
    # on these the moves of the certificate rest
    "ConfL\\Off;": _Reading.set,
    "ConfJ\\On;": _Reading.set,
    "SingArea\\Off;": _Reading.set,
    "PDispOff;": _Reading.set,
    "EOffsOff;": _Reading.set,
    "AccSet 0,0;": _Reading.set,
    "VelSet 0,0;": _Reading.set,
    f"MoveAbsJ {JOINTS},NAME,fine,{FRAMES}": _Reading.go,
    f"MoveAbsJ {JOINTS},NAME\\T:=0,NAME,{FRAMES}": _Reading.go_evenly,
    f"MoveAbsJ {JOINTS},NAME\\T:=0,fine,{FRAMES}": _Reading.go_evenly,
    f"MoveL {TARGET},NAME,NAME,{FRAMES}": _Reading.go_straight,
    f"MoveL {TARGET},NAME,fine,{FRAMES}": _Reading.go_straight,
    "ConfL\\On;": _Reading.afterwards,
    "ENDPROC": _Reading.end_procedure,
    "ENDMODULE": _Reading.finish,
}
"""Every form of a statement after MODULE, and what it does; `0` stands for any number, `NAME` for a speed or a zone."""

FORMS = {shape(with_roles(words(source, _Reading("").refuse), "NAME")): act for source, act in SOURCES.items()}
NEEDED = (TOOL, PART, "PROC", "CONFL", "CONFJ", "SINGAREA", "PDISPOFF", "EOFFSOFF", "ACCSET", "VELSET")
