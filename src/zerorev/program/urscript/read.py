"""A URScript program of ours read back, as data: what a certificate is to speak of is what stands in the file.

Strict: a statement of another form than `urscript.write` writes is an error, for it might move the robot in a way that
nobody has examined. Numbers are kept as the decimals that they are. What the certificate assumes of the controller is
required here, independent of the plan: one tool and one part frame, set before the first move; poses only of straight
moves and joints only of joint moves; within a hole nothing but moves, and no blend at its end.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from decimal import Decimal

from zerorev.model.written import Pace, Statement, WrittenFrame, WrittenJoints, WrittenProgram
from zerorev.program.reading import Forms, Numbers, SourceReading, Starter, Words
from zerorev.program.source import Refuse, are_literals
from zerorev.program.urscript.names import KEPT
from zerorev.program.urscript.source import URSCRIPT_WORDS, statements

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
    return _Reading(file).read(text)


def read_starter(text: str, file: str = "program") -> Starter | None:
    """A program that sets and moves nothing itself, but calls others; None: any other.

    Raises:
        InputError: as `read_urscript`.
    """
    return _Reading(file).starter(text)


@dataclass
class _Reading(SourceReading):
    opening, closing, stop = "def", "end", "no r"

    @property
    def forms(self) -> Forms:
        return FORMS

    def statements(self, text: str, refuse: Refuse) -> Iterator[Statement]:
        return statements(text, refuse)

    def begin(self, statement: Statement) -> None:
        name = str(statement.words[1]) if len(statement.words) > 1 else ""
        if statement.words != ("def", name, "(", ")", ":") or not NAME.fullmatch(name) or name in KEPT:
            accepted = "def name():, of at most 32 letters, digits and underscores"
            self.refuse(f"'{statement.source}'", accepted=accepted)
        self.name = name

    def calls(self, words: Words) -> bool:
        name = words[0]
        return (
            isinstance(name, str)
            and NAME.fullmatch(name) is not None
            and name not in KEPT
            and (words[1:2], words[-1:]) == (("(",), (")",))
            and are_literals(words[2:-1], ("True", "False"))
        )

    def tool_and_base(self) -> tuple[WrittenFrame, WrittenFrame]:
        return _pose(self.settings["set_tcp"]), _pose(self.settings["part"])

    def prepare(self, words: Words, numbers: Numbers) -> None:
        """What is set once, before the first move."""
        if (name := _name(words)) in self.settings or self.hole is not None:
            self.refuse(f"{name} is set a second time, or after a move")
        if name == "set_payload":
            self.above_zero("mass", numbers[0])
        self.settings[name] = numbers

    def above_zero(self, what: str, number: Decimal) -> None:
        if not number > 0:
            self.refuse(f"{what}={number}", accepted="a number above 0")

    def to_a_stop(self, _: Words, numbers: Numbers) -> None:
        self.need(NEEDED)
        self.above_zero("a", numbers[6])
        self.above_zero("v", numbers[7])
        self.go(WrittenJoints(numbers[:6], "rad"))

    def straight(self, _: Words, numbers: Numbers) -> None:
        """A straight move, with its acceleration, speed and, if it is blended, radius."""
        acceleration, speed, *radius = numbers[6:]
        self.above_zero("a", acceleration)
        self.above_zero("v", speed)
        self.within(_pose(numbers), Pace(speed), radius, linear=True)

    def jointly(self, _: Words, numbers: Numbers) -> None:
        """A joint move within a hole, with its time and, if it is blended, radius."""
        time, *radius = numbers[6:]
        self.above_zero("t", time)
        self.within(WrittenJoints(numbers[:6], "rad"), Pace(time, "s"), radius, linear=False)

    def within(self, end: WrittenFrame | WrittenJoints, pace: Pace, radius: list[Decimal], *, linear: bool) -> None:
        self.need_hole("a move of a hole before the movej to its first point")
        for each in radius:
            self.above_zero("r", each)
        self.move(end, pace, _mm(radius[0]) if radius else STOP, linear=linear)

    def stand(self, _: Words, numbers: Numbers) -> None:
        self.wait("sleep", numbers[0])

    def finish(self, *_: object) -> None:
        self.close_last()
        self.ended = True


def _name(words: Words) -> str:
    """How a message calls what a statement sets."""
    return str(words[1] if words[0] == "local" else words[0])


def _pose(numbers: Numbers) -> WrittenFrame:
    """Metres, and a rotation vector."""
    return WrittenFrame(tuple(_mm(length) for length in numbers[:3]), numbers[3:6], "vector_rad")


def _mm(length: Decimal) -> Decimal:
    return length.scaleb(3)


SIX = "0, 0, 0, 0, 0, 0"
SOURCES: dict[str, Callable[[_Reading, Words, Numbers], None]] = {
    f"set_tcp(p[{SIX}])": _Reading.prepare,
    "set_payload(0, [0, 0, 0])": _Reading.prepare,
    f"local part = p[{SIX}]": _Reading.prepare,
    f"movej([{SIX}], a=0, v=0)": _Reading.to_a_stop,
    f"movel(pose_trans(part, p[{SIX}]), a=0, v=0)": _Reading.straight,
    f"movel(pose_trans(part, p[{SIX}]), a=0, v=0, r=0)": _Reading.straight,
    f"movej([{SIX}], t=0)": _Reading.jointly,
    f"movej([{SIX}], t=0, r=0)": _Reading.jointly,
    "sleep(0)": _Reading.stand,
    "end": _Reading.finish,
}
"""Every form of a statement between def and end, and what it does; `0` stands for any number."""

FORMS = Forms(SOURCES, URSCRIPT_WORDS.form)
NEEDED = ("set_tcp", "part")
"""What the moves count from: set before the first one."""
