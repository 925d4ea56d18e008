"""A KRL program of ours read back, as data: what a certificate is to speak of is what stands in the file.

Strict: a statement of another form than `krl.write` writes is an error, for it might move the robot in a way that
nobody has examined. Numbers are kept as the decimals that they are. What the certificate assumes of the controller
is required here, independent of the plan: how the tool turns, in which frames, and that nothing undoes it.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from decimal import Decimal

from zerorev.model.written import Pace, Statement, WrittenFrame, WrittenJoints, WrittenProgram
from zerorev.program.krl.names import KEPT
from zerorev.program.krl.source import KRL_WORDS, statements
from zerorev.program.reading import Forms, Numbers, SourceReading, Starter, Words
from zerorev.program.source import Refuse, are_literals, shape

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
    return _Reading(file).read(text)


def read_starter(text: str, file: str = "program") -> Starter | None:
    """A program that sets and moves nothing itself, but calls others; None: any other.

    Raises:
        InputError: as `read_krl`.
    """
    return _Reading(file).starter(text)


@dataclass
class _Reading(SourceReading):
    opening, closing, stop = "DEF", "END", "no C_DIS"

    @property
    def forms(self) -> Forms:
        return FORMS

    def statements(self, text: str, refuse: Refuse) -> Iterator[Statement]:
        return statements(text, refuse)

    def begin(self, statement: Statement) -> None:
        name = statement.source[3:].rstrip("() ").strip()
        if statement.words != ("DEF", name.upper(), "(", ")") or not NAME.fullmatch(name):
            self.refuse(f"'{statement.source}'", accepted="DEF name ( ), of at most 24 letters, digits and underscores")
        self.name = name

    def calls(self, words: Words) -> bool:
        name = words[0]
        return (
            isinstance(name, str)
            and NAME.fullmatch(name) is not None
            and name not in KEPT
            and (words[1:2], words[-1:]) == (("(",), (")",))
            and are_literals(words[2:-1], ("TRUE", "FALSE"), marks='#"')
        )

    def tool_and_base(self) -> tuple[WrittenFrame, WrittenFrame]:
        return _frame(self.settings["$TOOL"]), _frame(self.settings["$BASE"])

    def reset(self, words: Words, _: Numbers) -> None:
        if self.settings.keys() - {"EXT BAS"}:
            self.refuse("INITMOV would undo what is set before it")
        self.settings[_name(words)] = ()

    def prepare(self, words: Words, numbers: Numbers) -> None:
        """What is set once, before the first move."""
        if (name := _name(words)) in self.settings or self.hole is not None:
            self.refuse(f"{name} is set a second time, or within a hole")
        self.set(words, numbers)

    def choose(self, words: Words, numbers: Numbers) -> None:
        """What a job may have set, once, before the first move."""
        self.prepare(words, numbers)

    def rest(self, _: Words, numbers: Numbers) -> None:
        if numbers[0] == 0:  # before a call
            self.stand_still("WAIT SEC")
        else:
            self.wait("WAIT SEC", numbers[0])

    def set(self, words: Words, numbers: Numbers) -> None:
        name = _name(words)
        if len(numbers) == 1 and not numbers[0] > 0:
            self.refuse(f"{name} is set to {numbers[0]}", accepted="a number above 0")
        self.settings[name] = numbers

    def all_axes(self, _: Words, numbers: Numbers) -> None:
        self.need(NEEDED)
        self.go(WrittenJoints(numbers[:6]))

    def straight(self, _: Words, numbers: Numbers) -> None:
        self.line_to(numbers, Decimal(0))

    def blended(self, _: Words, numbers: Numbers) -> None:
        self.line_to(numbers, self.settings.get("$APO.CDIS", (None,))[0])

    def line_to(self, numbers: Numbers, blend: Decimal | None) -> None:
        self.need_hole("a LIN before the PTP of its hole")
        for name, given in (("$VEL.CP", "$VEL.CP" in self.settings), ("$APO.CDIS", blend is not None)):
            if not given:
                self.refuse(f"a LIN before {name} is set")
        self.move(_frame(numbers), Pace(self.settings["$VEL.CP"][0]), blend, linear=True)

    def finish(self, *_: object) -> None:
        self.close_last()
        self.ended = True


def _shape(words: Words) -> tuple[str, ...]:
    """The shape of a statement; $BASE counts from what any variable holds."""
    if words[:2] == ("$BASE", "=") and words[3:4] == (":",) and len(str(words[2])) > 1:
        return shape((*words[:2], "$ROBROOT", *words[3:]))
    return shape(words)


def _name(words: Words) -> str:
    """How a message calls what a statement sets."""
    match words:
        case ("EXT", *_):
            return "EXT BAS"
        case ("BAS", _, kind, *_):
            return f"BAS ({kind})"
    return str(words[0])


def _frame(numbers: Numbers) -> WrittenFrame:
    """X, Y, Z and A, B, C."""
    return WrittenFrame(numbers[:3], numbers[3:])


POINT, AXES = "X 0,Y 0,Z 0,A 0,B 0,C 0", "A1 0,A2 0,A3 0,A4 0,A5 0,A6 0"
OUTER = [",".join(f"E{number} 0" for number in range(1, 7) if chosen >> (number - 1) & 1) for chosen in range(1, 2**6)]
SOURCES: dict[str, Callable[[_Reading, Words, Numbers], None]] = {
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
    f"PTP {{AXIS: {AXES}}}": _Reading.all_axes,
    **{f"PTP {{E6AXIS: {AXES},{outer}}}": _Reading.all_axes for outer in OUTER},
    "WAIT SEC 0": _Reading.rest,
    "$VEL.CP=0": _Reading.set,
    "$APO.CDIS=0": _Reading.set,
    f"LIN {{{POINT}}}": _Reading.straight,
    f"LIN {{{POINT}}} C_DIS": _Reading.blended,
    "END": _Reading.finish,
}
"""Every form of a statement between DEF and END, and what it does; `0` stands for any number."""

FORMS = Forms(SOURCES, KRL_WORDS.form, _shape, lambda form: "E6AXIS" not in form)
NEEDED = tuple(
    dict.fromkeys(
        _name(KRL_WORDS.form(form)) for form, act in SOURCES.items() if act in (_Reading.reset, _Reading.prepare)
    )
)
