"""A KRL program of ours read back, as data: what a certificate is to speak of is what stands in the file.

Strict: a statement of another form than `krl.write` writes is an error, for it might move the robot in a way that
nobody has examined. Numbers are kept as the decimals that they are. What the certificate assumes of the controller
is required here, independent of the plan: how the tool turns, in which frames, and that nothing undoes it.
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
from zerorev.program.krl.names import KEPT
from zerorev.program.krl.source import shape, statements, words

__all__ = ["read_krl", "read_starter"]

NAME = re.compile(r"[A-Z][A-Z0-9_]{0,23}", re.IGNORECASE)


def read_krl(text: str, file: str = "program") -> WrittenProgram:
    """Read the text of a program.

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
        InputError: as `read_krl`.
    """
    reading = _Reading(file)
    for statement in statements(text, reading.refuse_at):
        reading.take(statement)
        if reading.settings or reading.hole:
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
    settings: dict[str, tuple[Decimal, ...]] = field(default_factory=dict)
    head: list[Statement] = field(default_factory=list)
    hole: _Hole | None = None
    holes: list[WrittenHole] = field(default_factory=list)
    tail: tuple[Statement, ...] = ()

    def take(self, statement: Statement) -> None:
        """One statement of the file."""
        self.line = statement.line
        if self.ended:
            self.refuse(f"'{statement.source}' after END")
        if (statement.words[0] == "DEF") == bool(self.name):
            self.refuse("a second program" if self.name else f"'{statement.source}' before DEF")
        if not self.name:
            self.begin(statement)
        elif (form := FORMS.get(_any_variable(shape(statement.words)))) is not None:
            form(self, _name(statement.words), tuple(word for word in statement.words if isinstance(word, Decimal)))
        elif is_call(statement.words):
            self.stand_still(f"{statement.source} is called")
        else:
            self.refuse_form(statement)
        if not self.ended:
            (self.head if self.hole is None else self.hole.statements).append(statement)

    def begin(self, statement: Statement) -> None:
        name = statement.source[3:].rstrip("() ").strip()
        if statement.words != ("DEF", name.upper(), "(", ")") or not NAME.fullmatch(name):
            self.refuse(f"'{statement.source}'", accepted="DEF name ( ), of at most 24 letters, digits and underscores")
        self.name = name

    def reset(self, name: str, _: tuple[Decimal, ...]) -> None:
        if self.settings.keys() - {"EXT BAS"}:
            self.refuse("INITMOV would undo what is set before it")
        self.settings[name] = ()

    def prepare(self, name: str, numbers: tuple[Decimal, ...]) -> None:
        """What is set once, before the first move."""
        if name in self.settings or self.hole is not None:
            self.refuse(f"{name} is set a second time, or within a hole")
        self.set(name, numbers)

    def choose(self, name: str, numbers: tuple[Decimal, ...]) -> None:
        """What a job may have set, once, before the first move."""
        self.prepare(name, numbers)

    def rest(self, _: str, numbers: tuple[Decimal, ...]) -> None:
        if numbers[0] != 0:
            self.refuse(f"'WAIT SEC {numbers[0]}' is not a statement that zerorev writes", accepted="WAIT SEC 0.0")
        self.stand_still("WAIT SEC")

    def stand_still(self, what: str) -> None:
        """Refuse what would make a blend a stop, or what would run ahead of the moves."""
        if self.hole is not None and self.hole.moves and self.hole.moves[-1].blend_mm:
            self.refuse(f"{what} between blended moves")

    def set(self, name: str, numbers: tuple[Decimal, ...]) -> None:
        if len(numbers) == 1 and not numbers[0] > 0:
            self.refuse(f"{name} is set to {numbers[0]}", accepted="a number above 0")
        self.settings[name] = numbers

    def go(self, _: str, numbers: tuple[Decimal, ...]) -> None:
        """A move of all axes: to a point on the way, if another follows before the first straight move."""
        if missing := [name for name in NEEDED if name not in self.settings]:
            self.refuse(f"a move before {', '.join(missing)} is set")
        before: tuple[Statement, ...] = ()
        if self.hole is not None and not self.hole.moves:
            before = (*self.hole.way, *self.hole.statements)
        else:
            self.close()
        self.hole = _Hole(self.line, WrittenJoints(numbers[:6]), before)

    def go_straight(self, _: str, numbers: tuple[Decimal, ...]) -> None:
        self.move(numbers, blended=False)

    def go_blended(self, _: str, numbers: tuple[Decimal, ...]) -> None:
        self.move(numbers, blended=True)

    def move(self, numbers: tuple[Decimal, ...], *, blended: bool) -> None:
        if self.hole is None:
            self.refuse("a LIN before the PTP of its hole")
        for name in ("$VEL.CP", "$APO.CDIS") if blended else ("$VEL.CP",):
            if name not in self.settings:
                self.refuse(f"a LIN before {name} is set")
        blend = self.settings["$APO.CDIS"][0] if blended else Decimal(0)
        self.hole.moves.append(WrittenMove(self.line, _frame(numbers), Pace(self.settings["$VEL.CP"][0]), blend))

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
        if hole.moves[-1].blend_mm:
            self.refuse(f"the last move of a hole (line {hole.moves[-1].line}) is blended", accepted="no C_DIS")
        self.holes.append(WrittenHole(hole.line, hole.start, tuple(hole.moves), tuple(hole.statements), hole.way))

    def end(self) -> WrittenProgram:
        if not self.ended or not self.name:
            self.refuse("the program is not complete", accepted="DEF to END")
        if not self.holes:
            self.refuse("the program has no holes")
        tool, base = (_frame(self.settings[name]) for name in ("$TOOL", "$BASE"))
        return WrittenProgram(self.name, tool, base, tuple(self.holes), tuple(self.head), self.tail)

    def refuse_form(self, statement: Statement) -> NoReturn:
        alike = [form for form in SOURCES if words(form, self.refuse)[0] == statement.words[0] and "E6AXIS" not in form]
        accepted = " or ".join(alike) + ", a number for each 0" * any("0" in form for form in alike)
        what = f"'{statement.source[:80]}' is not a statement that zerorev writes"
        self.refuse(what, accepted=accepted or "a program as zerorev exports it")

    def refuse(self, what: str, *, accepted: str = "a program as zerorev exports it") -> NoReturn:
        raise InputError(what, where=f"{self.file}, line {self.line}", accepted=accepted)

    def refuse_at(self, line: int, what: str) -> NoReturn:
        self.line = line
        self.refuse(what)


def is_call(words: tuple[Word, ...]) -> bool:
    """Whether a statement calls a program that is not a word of KRL, with nothing but literals."""
    name, *rest = words
    if not isinstance(name, str) or not NAME.fullmatch(name) or name in KEPT or rest[:1] != ["("] or rest[-1:] != [")"]:
        return False
    arguments, commas = rest[1:-1:2], rest[2:-1:2]
    literal = all(
        isinstance(each, Decimal) or each in ("TRUE", "FALSE") or (len(each) > 1 and each[0] in '#"')
        for each in arguments
    )
    return literal and all(comma == "," for comma in commas) and len(arguments) in (0, len(commas) + 1)


def _any_variable(words: tuple[str, ...]) -> tuple[str, ...]:
    """$BASE counts from what any variable holds."""
    if words[:2] == ("$BASE", "=") and words[3:4] == (":",) and len(words[2]) > 1:
        return (*words[:2], "$ROBROOT", *words[3:])
    return words


def _name(words: tuple[Word, ...]) -> str:
    """How a message calls what a statement sets."""
    match words:
        case ("EXT", *_):
            return "EXT BAS"
        case ("BAS", _, kind, *_):
            return f"BAS ({kind})"
    return str(words[0])


def _frame(numbers: tuple[Decimal, ...]) -> WrittenFrame:
    """X, Y, Z and A, B, C."""
    return WrittenFrame(numbers[:3], numbers[3:])


POINT, AXES = "X 0,Y 0,Z 0,A 0,B 0,C 0", "A1 0,A2 0,A3 0,A4 0,A5 0,A6 0"
OUTER = [",".join(f"E{number} 0" for number in range(1, 7) if chosen >> (number - 1) & 1) for chosen in range(1, 2**6)]
SOURCES: dict[str, Callable[[_Reading, str, tuple[Decimal, ...]], None]] = {
    "EXT BAS (BAS_COMMAND :IN,REAL :IN )": _Reading.prepare,
    "BAS (#INITMOV,0 )": _Reading.reset,
    "BAS (#VEL_PTP,0 )": _Reading.prepare,
    "BAS (#ACC_PTP,0 )": _Reading.prepare,
    f"$TOOL={{FRAME: {POINT}}}": _Reading.prepare,
    f"$BASE={{FRAME: {POINT}}}": _Reading.prepare,
    f"$BASE=$ROBROOT:{{FRAME: {POINT}}}": _Reading.prepare,
    "$ACT_TOOL=0": _Reading.choose,
    **{f"$LOAD=LOAD_DATA[{number}]": _Reading.choose for number in range(1, 17)},
    f"$LOAD={{LOAD: M 0,CM {{{POINT}}},J {{X 0,Y 0,Z 0}}}}": _Reading.choose,
    "$ACT_BASE=0": _Reading.choose,
    # on these two the straight move of the certificate rests
    "$IPO_MODE=#BASE": _Reading.prepare,
    "$ORI_TYPE=#VAR": _Reading.prepare,
    "$ADVANCE=0": _Reading.prepare,
    "$VEL.ORI1=0": _Reading.prepare,
    "$VEL.ORI2=0": _Reading.prepare,
    f"PTP {{AXIS: {AXES}}}": _Reading.go,
    **{f"PTP {{E6AXIS: {AXES},{outer}}}": _Reading.go for outer in OUTER},
    "WAIT SEC 0": _Reading.rest,
    "$VEL.CP=0": _Reading.set,
    "$APO.CDIS=0": _Reading.set,
    f"LIN {{{POINT}}}": _Reading.go_straight,
    f"LIN {{{POINT}}} C_DIS": _Reading.go_blended,
    "END": _Reading.finish,
}
"""Every form of a statement between DEF and END, and what it does; `0` stands for any number."""

FORMS = {shape(words(source, _Reading("").refuse)): act for source, act in SOURCES.items()}
NEEDED = tuple(
    dict.fromkeys(
        _name(words(source, _Reading("").refuse))
        for source, act in SOURCES.items()
        if act in (_Reading.reset, _Reading.prepare)
    )
)
