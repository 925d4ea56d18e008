"""A RAPID module of ours read back, as data: what a certificate is to speak of is what stands in the file.

Strict: a statement of another form than `rapid.write` writes is an error, for it might move the robot in a way that
nobody has examined. Numbers are kept as the decimals that they are. What the certificate assumes of the controller is
required here, independent of the plan: how a zone takes tip and turn, that no displacement is active, that the wrist is
not led past a singularity otherwise, and that each move has the module's own tool and work object.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from decimal import Decimal

from zerorev.model.written import Pace, Statement, Word, WrittenFrame, WrittenJoints, WrittenProgram
from zerorev.program.rapid.source import PART, RAPID_WORDS, TOOL, is_call, shape_of, statements, with_roles
from zerorev.program.reading import Forms, Numbers, SourceReading, Starter, Words
from zerorev.program.source import Refuse

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
    return _Reading(file).read(text)


def read_starter(text: str, file: str = "program") -> Starter | None:
    """A module that sets and moves nothing itself, but calls others; None: any other.

    Raises:
        InputError: as `read_rapid`.
    """
    return _Reading(file).starter(text)


@dataclass
class _Reading(SourceReading):
    opening, closing, unit, stop = "MODULE", "ENDMODULE", "module", "fine"

    closed: bool = False  # the procedure
    frames: dict[str, WrittenFrame] = field(default_factory=dict)
    speeds: dict[str, Decimal] = field(default_factory=dict)  # of the tip [mm/s]
    zones: dict[str, Decimal] = field(default_factory=dict)  # [mm]

    @property
    def forms(self) -> Forms:
        return FORMS

    @property
    def prepared(self) -> bool:
        return bool(self.settings.keys() - {"PROC"})

    def statements(self, text: str, refuse: Refuse) -> Iterator[Statement]:
        return statements(text, refuse)

    def take(self, statement: Statement) -> None:
        roles = with_roles(statement.words, self.name) if self.name else statement.words
        super().take(replace(statement, words=roles))

    def keep(self, statement: Statement) -> None:
        if statement.words[0] != "ENDPROC":
            super().keep(statement)

    def calls(self, words: Words) -> bool:
        return is_call(words)

    def tool_and_base(self) -> tuple[WrittenFrame, WrittenFrame]:
        return self.frames[TOOL], self.frames[PART]

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
        self.settings[name] = ()

    def declare_tool(self, _: Words, numbers: Numbers) -> None:
        self.once(TOOL, declaration=True)
        if not numbers[7] > 0:
            self.refuse(f"a load of {numbers[7]} kg", accepted="a mass above 0: a controller refuses 0")
        self.frames[TOOL] = _frame(numbers[:7])

    def declare_part(self, _: Words, numbers: Numbers) -> None:
        self.once(PART, declaration=True)
        if numbers[7:] != IDENTITY:
            self.refuse("an object frame within the user frame", accepted="[[0,0,0],[1,0,0,0]]")
        self.frames[PART] = _frame(numbers[:7])

    def declare_speed(self, words: Words, numbers: Numbers) -> None:
        name = str(words[3])
        self.once(name, declaration=True)
        if not all(number > 0 for number in numbers):
            self.refuse(f"{name} is not above 0", accepted="numbers above 0")
        self.speeds[name] = numbers[0]

    def declare_zone(self, words: Words, numbers: Numbers) -> None:
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

    def set(self, words: Words, numbers: Numbers) -> None:
        self.once(str(words[0]), declaration=False)
        wanted = WANTED.get(str(words[0]), ())
        if numbers != wanted:
            accepted = f"{words[0]} {','.join(map(str, wanted))}"
            self.refuse(f"{words[0]} {','.join(map(str, numbers))}", accepted=accepted)

    def stand_still(self, what: str) -> None:
        if "PROC" not in self.settings or self.closed:
            self.refuse(f"{what} outside of the procedure")
        super().stand_still(what)

    def ready(self) -> None:
        """Refuse a move before all is set that it depends on, or after what follows the last one."""
        self.need(NEEDED)
        if self.tail is not None:
            self.refuse("a move after ConfL\\On")

    def to_a_stop(self, words: Words, numbers: Numbers) -> None:
        self.ready()
        self.speed(words[-10])
        self.go(WrittenJoints(numbers[:6]))

    def straight(self, words: Words, numbers: Numbers) -> None:
        # mm/s as m/s: the digits stay
        pace = Pace(self.speed(words[-10]).scaleb(-3))
        self.within(words, _frame(numbers[:7]), pace, linear=True)

    def evenly(self, words: Words, numbers: Numbers) -> None:
        self.speed(words[-14])
        if not numbers[-1] > 0:
            self.refuse(f"a time of {numbers[-1]} s", accepted="a time above 0")
        self.within(words, WrittenJoints(numbers[:6]), Pace(numbers[-1], "s"), linear=False)

    def within(self, words: Words, end: WrittenFrame | WrittenJoints, pace: Pace, *, linear: bool) -> None:
        self.ready()
        kind = "MoveL" if linear else "MoveAbsJ with a time"
        self.need_hole(f"a {kind} before the MoveAbsJ to the start of its hole")
        zone = str(words[-8])
        if zone != "FINE" and zone not in self.zones:
            self.refuse(f"the zone {zone} is not declared", accepted=" or ".join(["fine", *self.zones]))
        self.move(end, pace, self.zones.get(zone, Decimal(0)), linear=linear)

    def stand(self, _: Words, numbers: Numbers) -> None:
        self.wait("WaitTime", numbers[0])

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
        self.close_last()

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


def _frame(numbers: Numbers) -> WrittenFrame:
    """x, y, z and a quaternion."""
    return WrittenFrame(numbers[:3], numbers[3:], "quaternion")


FRAME = "[0,0,0],[0,0,0,0]"
OUTER = "[0,0,0,0,0,0]"
JOINTS = f"[[0,0,0,0,0,0],{OUTER}]"
TARGET = f"[{FRAME},[0,0,0,0],{OUTER}]"
FRAMES = "NAME_tool\\WObj:=NAME_part;"
SOURCES: dict[str, Callable[[_Reading, Words, Numbers], None]] = {
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
    f"MoveAbsJ {JOINTS},NAME,fine,{FRAMES}": _Reading.to_a_stop,
    f"MoveAbsJ {JOINTS},NAME\\T:=0,NAME,{FRAMES}": _Reading.evenly,
    f"MoveAbsJ {JOINTS},NAME\\T:=0,fine,{FRAMES}": _Reading.evenly,
    f"MoveL {TARGET},NAME,NAME,{FRAMES}": _Reading.straight,
    f"MoveL {TARGET},NAME,fine,{FRAMES}": _Reading.straight,
    "WaitTime 0;": _Reading.stand,
    "ConfL\\On;": _Reading.afterwards,
    "ENDPROC": _Reading.end_procedure,
    "ENDMODULE": _Reading.finish,
}
"""Every form of a statement after MODULE, and what it does; `0` stands for any number, `NAME` for a speed or a zone."""

FORMS = Forms(SOURCES, lambda form: with_roles(RAPID_WORDS.form(form), "NAME"), shape_of)
NEEDED = (TOOL, PART, "PROC", "CONFL", "CONFJ", "SINGAREA", "PDISPOFF", "EOFFSOFF", "ACCSET", "VELSET")
