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

from zerorev.model.written import Pace, Statement, WrittenFrame, WrittenJoints, WrittenProgram
from zerorev.program.reading import Reading, Starter, Words
from zerorev.program.tp.source import ACCEPTED, Listed, Position, listed

__all__ = ["read_starter", "read_tp"]

WORLD = WrittenFrame((Decimal(0),) * 3, (Decimal(0),) * 3)
MILLI = Decimal("0.001")

_FRAME = re.compile(r"(UFRAME_NUM|UTOOL_NUM) ?= ?([0-9]{1,2})")
_MOTION = re.compile(r"([JL]) P\[([0-9]{1,7})\] ([0-9]{1,5})(%|msec|mm/sec|cm/min) (FINE|CNT100)")
_WAIT = re.compile(r"WAIT ([0-9]{0,2}\.[0-9]{2}) ?\(sec\)")
_ARGUMENT = r"[0-9]{1,9}(?:\.[0-9]{1,9})?|'[^';]{0,34}'"
_CALL = re.compile(rf"CALL ([A-Z][A-Z0-9_]{{0,35}})(?: ?\( ?((?:{_ARGUMENT})(?: ?, ?(?:{_ARGUMENT}))*) ?\))?")
FORMS = (
    "UFRAME_NUM=n, UTOOL_NUM=n, CALL NAME, J P[n] n% FINE, J P[n] n msec, L P[n] n mm/sec or n cm/min, with FINE or "
    "CNT100, WAIT n.nn(sec), or a comment"
)


def read_tp(text: str, file: str = "program") -> WrittenProgram:
    """Read the text of a program.

    Args:
        text: of the file.
        file: how a message calls it.

    Raises:
        InputError: a statement that `export` does not write; the message has its line.
    """
    return _Reading(file).read(text)


def read_starter(text: str, file: str = "program") -> Starter | None:
    """A program that selects and moves nothing itself, but calls others; None: any other.

    Raises:
        InputError: as `read_tp`.
    """
    return _Reading(file).starter(text)


@dataclass
class _Reading(Reading):
    """What is known up to a statement."""

    accepted, stop = ACCEPTED, "FINE"

    source: Listed | None = None
    selected: dict[str, int] = field(default_factory=dict)
    reached: set[int] = field(default_factory=set)

    def read(self, text: str) -> WrittenProgram:
        for line, statement in self.begin(text).statements:
            self.take(line, statement)
        return self.end()

    def starter(self, text: str) -> Starter | None:
        source = self.begin(text)
        if source.positions or any(not statement.startswith("CALL") for _, statement in source.statements):
            return None
        for line, statement in source.statements:
            self.take(line, statement)
        return self.name, tuple(self.head)

    def begin(self, text: str) -> Listed:
        self.source = source = listed(text, self.refuse_at)
        self.name = source.name
        self.keep(Statement(("/PROG", source.name.upper()), source.line, f"/PROG {source.name}"))
        return source

    def take(self, line: int, statement: str) -> None:
        """One statement of the file."""
        self.line = line
        if frame := _FRAME.fullmatch(statement):
            words = self.select(frame[1], int(frame[2]))
        elif motion := _MOTION.fullmatch(statement):
            words = self.motion(*motion.groups())
        elif wait := _WAIT.fullmatch(statement):
            self.wait("WAIT", Decimal(wait[1]))
            words = ("WAIT", Decimal(wait[1]), "(sec)")
        elif call := _CALL.fullmatch(statement):
            words = self.call(*call.groups())
        else:
            self.refuse(f"'{statement[:80]}' is not a statement that zerorev writes", accepted=FORMS)
        self.keep(Statement(words, line, statement))

    def select(self, name: str, number: int) -> Words:
        """A frame, once, before the first motion."""
        if name in self.selected or self.hole is not None:
            self.refuse(f"{name} is set a second time, or after a motion")
        self.selected[name] = number
        return name, Decimal(number)

    def call(self, name: str, arguments: str | None) -> Words:
        """A program of the controller, called where the robot stands."""
        self.stand_still(f"{name} is called")
        return ("CALL", name, *re.findall(_ARGUMENT, arguments or ""))

    def motion(self, kind: str, number: str, value: str, unit: str, termination: str) -> Words:
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
            self.go(WrittenJoints(position.values))
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
        if missing := [name for name in ("UFRAME_NUM", "UTOOL_NUM") if name not in self.selected]:
            self.refuse(f"a motion before {' and '.join(missing)} is set")
        position = self.source.positions[number]
        if (position.user, position.tool) != (self.selected["UFRAME_NUM"], self.selected["UTOOL_NUM"]):
            self.refuse_at(position.line, f"P[{number}] is in other frames than the program selects")
        self.reached.add(number)
        return position

    def follow(self, end: WrittenFrame | WrittenJoints, pace: Pace, stops: bool, *, linear: bool) -> None:
        self.need_hole("a move of a hole before the J move to its start")
        self.move(end, pace, Decimal(0) if stops else None, linear=linear)

    def tool_and_base(self) -> tuple[None, WrittenFrame | None]:
        return None, WORLD if self.selected["UFRAME_NUM"] == 0 else None

    def end(self) -> WrittenProgram:
        assert self.source is not None
        self.close_last()
        program = super().end()
        if unused := sorted(self.source.positions.keys() - self.reached):
            self.refuse_at(self.source.positions[unused[0]].line, f"P[{unused[0]}] is not moved to")
        return program


def _pose(position: Position) -> WrittenFrame:
    """X, Y, Z, and the turns about Z, Y and X."""
    w, p, r = position.values[3:]
    return WrittenFrame(position.values[:3], (r, p, w))
