"""A KRL program of ours read back, as data: what a certificate is to speak of is what stands in the file.

Strict: a line that `zerorev.program.krl` does not write is an error, for it might move the robot in a way that nobody
has looked at. Numbers are kept as the decimals that they are.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, field
from decimal import Decimal
from pathlib import Path
from typing import NoReturn

from zerorev.errors import InputError
from zerorev.model.plan import Plan
from zerorev.model.text import read_text
from zerorev.model.written import Six, WrittenHole, WrittenMove, WrittenProgram
from zerorev.program.krl import LONGEST_ID
from zerorev.program.krl_text import clean

__all__ = ["holes_of", "read_krl", "read_program"]

NUMBER = r"-?\d{1,9}(?:\.\d{1,12})?"
POINT, AXIS = "X Y Z A B C", "A1 A2 A3 A4 A5 A6"
HELD = {"$IPO_MODE": "#BASE", "$ORI_TYPE": "#VAR"}  # on these the straight move of the certificate rests
NEEDED = ("$TOOL", "$BASE", *HELD, "$ADVANCE", "$VEL.ORI1", "$VEL.ORI2")
NUMBERS = ("$ADVANCE", "$VEL.ORI1", "$VEL.ORI2", "$VEL.CP", "$APO.CDIS")


def read_program(path: str | Path) -> WrittenProgram:
    """Read a program that `zerorev export` has written.

    Args:
        path: of the .src file.

    Raises:
        InputError: a file that cannot be read, or a line that `export` does not write.
    """
    return read_krl(read_text(Path(path), "a program that zerorev has exported (KRL, .src)"), str(path))


def read_krl(text: str, file: str = "program") -> WrittenProgram:
    """Read the text of a program.

    Args:
        text: of the file.
        file: how a message calls it.

    Raises:
        InputError: a line that `export` does not write; the message has its number.
    """
    reading = _Reading(file)
    for number, line in enumerate(text.splitlines(), start=1):
        reading.line = number
        reading.take(line)
    return reading.end()


def holes_of(program: WrittenProgram, plan: Plan) -> tuple[WrittenHole | None, ...]:
    """Which hole of a program is which of a plan, by their order and ids: one entry a hole of the plan.

    Args:
        program: as read back.
        plan: from which it was exported; holes may have been left out.

    Raises:
        InputError: the program drills a hole that the plan does not have there.
    """
    left, found = list(program.holes), []
    for hole in plan.holes:
        here = bool(left) and left[0].id.strip() == clean(hole.hole.id)[:LONGEST_ID].strip()
        found.append(left.pop(0) if here else None)
    if left:
        raise InputError(
            f"hole {left[0].id} is not in the plan, or not in this place",
            where=f"program {program.name}, line {left[0].line}",
            accepted="the holes of the plan from which it was exported, in their order",
        )
    return tuple(found)


@dataclass
class _Hole:
    id: str
    line: int = 0
    axes: Six | None = None
    moves: list[WrittenMove] = field(default_factory=list)


@dataclass
class _Reading:
    """What is known up to a line."""

    file: str
    line: int = 0
    name: str = ""
    ended: bool = False
    settings: dict[str, str] = field(default_factory=dict)
    frames: dict[str, Six] = field(default_factory=dict)
    hole: _Hole | None = None
    holes: list[WrittenHole] = field(default_factory=list)

    def take(self, line: str) -> None:
        """One line of the file."""
        if not line.isascii():
            self.refuse("a character that is not ASCII")
        if title := re.fullmatch(r";FOLD Hole \d+ of \d+: (.*)", line):
            self.close()
            self.hole = _Hole(title[1])
        statement = line.partition(";")[0].strip()
        if not statement:
            return
        if self.ended:
            self.refuse("a statement after END")
        for pattern, act in STATEMENTS:
            if found := re.fullmatch(pattern, statement):
                act(self, *found.groups())
                return
        self.refuse(f"'{statement[:60]}' is not a statement that zerorev writes")

    def begin(self, name: str) -> None:
        if self.name:
            self.refuse("a second program")
        self.name = name

    def reset(self) -> None:
        if self.settings:
            self.refuse("INITMOV would undo what is set before it")

    def set_frame(self, name: str, fields: str) -> None:
        self.set(name, fields)
        self.frames[name] = self.six(fields, POINT)

    def set(self, name: str, value: str) -> None:
        if not self.name:
            self.refuse("a statement before DEF")
        if name in NEEDED and (name in self.settings or self.hole is not None):
            self.refuse(f"{name} is set a second time, or within a hole")
        if name in HELD and value != HELD[name]:
            self.refuse(f"{name}={value}", accepted=HELD[name])
        if name in NUMBERS and not (re.fullmatch(NUMBER, value) and Decimal(value) > 0):
            self.refuse(f"{name}={value}", accepted="a number above 0")
        if name not in NEEDED and name not in NUMBERS:
            self.refuse(f"{name} is not a variable that zerorev sets")
        self.settings[name] = value

    def go(self, fields: str) -> None:
        if missing := [name for name in NEEDED if name not in self.settings]:
            self.refuse(f"a move before {', '.join(missing)} is set")
        if self.hole is None or self.hole.axes is not None:
            self.refuse("a PTP that is not the first move of a hole")
        self.hole.line, self.hole.axes = self.line, self.six(fields, AXIS)

    def go_straight(self, fields: str, blended: str | None) -> None:
        if self.hole is None or self.hole.axes is None:
            self.refuse("a LIN before the PTP of its hole")
        for name in ("$VEL.CP", "$APO.CDIS") if blended else ("$VEL.CP",):
            if name not in self.settings:
                self.refuse(f"a LIN before {name} is set")
        blend = Decimal(self.settings["$APO.CDIS"]) if blended else Decimal(0)
        feed = Decimal(self.settings["$VEL.CP"])
        self.hole.moves.append(WrittenMove(self.line, self.six(fields, POINT), blend, feed))

    def finish(self) -> None:
        self.close()
        self.ended = True

    def close(self) -> None:
        """End the hole that is being read."""
        hole, self.hole = self.hole, None
        if hole is None:
            return
        if hole.axes is None or not hole.moves:
            self.refuse(f"hole {hole.id} ends without a PTP and a LIN")
        if hole.moves[-1].blend_mm:
            self.refuse(f"the last move of hole {hole.id} (line {hole.moves[-1].line}) is blended", accepted="no C_DIS")
        self.holes.append(WrittenHole(hole.id, hole.line, hole.axes, tuple(hole.moves)))

    def end(self) -> WrittenProgram:
        if not self.ended or not self.name:
            self.refuse("the program is not complete", accepted="DEF to END")
        if not self.holes:
            self.refuse("the program has no holes")
        return WrittenProgram(self.name, self.frames["$TOOL"], self.frames["$BASE"], tuple(self.holes))

    def six(self, fields: str, names: str) -> Six:
        """Six numbers, each after its name and in the order of the names."""
        pattern = ",".join(rf"{name} ({NUMBER})" for name in names.split())
        if not (found := re.fullmatch(pattern, fields)):
            self.refuse(f"'{fields[:60]}'", accepted=f"a number for each of {names}, in this order")
        a, b, c, d, e, f = (Decimal(number) for number in found.groups())
        return a, b, c, d, e, f

    def refuse(self, what: str, *, accepted: str = "a program as zerorev exports it") -> NoReturn:
        raise InputError(what, where=f"{self.file}, line {self.line}", accepted=accepted)


def _nothing(*_: object) -> None:
    """Has no part in the motion."""


STATEMENTS: tuple[tuple[str, Callable[..., None]], ...] = (
    (r"&(?:ACCESS|REL|COMMENT) .*", _nothing),
    (r"EXT BAS \(BAS_COMMAND :IN,REAL :IN \)", _nothing),
    (r"BAS \(#INITMOV,0 \)", _Reading.reset),
    (r"BAS \(#(?:VEL|ACC)_PTP,\d+ \)", _nothing),
    (r"DEF ([A-Za-z][A-Za-z0-9_]{0,23}) \( \)", _Reading.begin),
    (r"(\$TOOL|\$BASE)=\{FRAME: ([^{}]*)\}", _Reading.set_frame),
    (r"(\$[A-Z_.0-9]+)=([^{}]*)", _Reading.set),
    (r"PTP \{AXIS: ([^{}]*)\}", _Reading.go),
    (r"LIN \{([^{}:]*)\}( C_DIS)?", _Reading.go_straight),
    (r"END", _Reading.finish),
)
