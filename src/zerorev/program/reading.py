"""What the readers of all languages share: which statements belong to which hole, and how a statement is refused.

A language says which forms its statements have and what each does; here is what none may say otherwise: a hole begins
with a joint move to a stop and ends with a stop, moves to a stop before it are the way to it, nothing that may stop the
robot stands between blended moves, the tool waits only after a move of a hole that stops, and a message names file,
line and what would be accepted.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from decimal import Decimal
from typing import Any, ClassVar, NoReturn, TypeAlias

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
from zerorev.program.source import Refuse, shape

__all__ = ["Forms", "Numbers", "Reading", "SourceReading", "Starter", "Words"]

Words: TypeAlias = tuple[Word, ...]
Numbers: TypeAlias = tuple[Decimal, ...]

Starter = tuple[str, tuple[Statement, ...]]
"""Name and statements of a program that sets and moves nothing itself, but calls others."""


@dataclass
class _Hole:
    line: int
    start: WrittenJoints
    way: tuple[Statement, ...]
    moves: list[WrittenMove] = field(default_factory=list)
    statements: list[Statement] = field(default_factory=list)


@dataclass
class Reading(ABC):
    """What is known of a file up to a statement.

    Attributes:
        file: how a message calls it.
        line: that is being read, from 1.
        name: of the program; empty before it is read.
        head: statements before the first hole.
        hole: that is being read.
        holes: that have been read.
        tail: statements after the last hole; None before these begin.
    """

    accepted: ClassVar[str] = "a program as zerorev exports it"
    stop: ClassVar[str]
    """What a move that ends in an exact stop has, for a message."""

    file: str
    line: int = 1
    name: str = ""
    head: list[Statement] = field(default_factory=list)
    hole: _Hole | None = None
    holes: list[WrittenHole] = field(default_factory=list)
    tail: list[Statement] | None = None

    @abstractmethod
    def tool_and_base(self) -> tuple[WrittenFrame | None, WrittenFrame | None]:
        """The frames in which the holes are given; called when there are holes."""

    def keep(self, statement: Statement) -> None:
        """Put a statement where it belongs."""
        if self.tail is not None:
            self.tail.append(statement)
        else:
            (self.head if self.hole is None else self.hole.statements).append(statement)

    def stand_still(self, what: str) -> None:
        """Refuse what would make a blend a stop, or what would run ahead of the moves."""
        if self.hole is not None and self.hole.moves and not self.hole.moves[-1].stops:
            self.refuse(f"{what} between blended moves")

    def go(self, start: WrittenJoints) -> None:
        """A joint move to a stop: to a point on the way, if another follows before the first move of the hole."""
        before: tuple[Statement, ...] = ()
        if self.hole is not None and not self.hole.moves:
            before = (*self.hole.way, *self.hole.statements)
        else:
            self.close()
        self.hole = _Hole(self.line, start, before)

    def need_hole(self, what: str) -> None:
        """Refuse a move of a hole to whose first point nothing has led.

        Args:
            what: is wrong then.
        """
        if self.hole is None:
            self.refuse(what)

    def move(self, end: WrittenFrame | WrittenJoints, pace: Pace, blend_mm: Decimal | None, *, linear: bool) -> None:
        """A move of the hole that is being read, as `WrittenMove` has it."""
        assert self.hole is not None
        self.hole.moves.append(WrittenMove(self.line, end, pace, blend_mm, linear))

    def wait(self, what: str, seconds: Decimal) -> None:
        """The tool stands where the last move of the hole that is being read has ended in a stop.

        Args:
            what: the statement, for a message.
            seconds: how long.
        """
        self.stand_still(what)
        if not seconds > 0:
            self.refuse(f"{what} of {seconds} s", accepted="a time above 0")
        if self.hole is None or not self.hole.moves:
            self.refuse(f"{what} before the first move of a hole")
        last = self.hole.moves[-1]
        if last.wait > 0:
            self.refuse(f"a second {what} at the same place")
        self.hole.moves[-1] = replace(last, wait=seconds)

    def close(self) -> None:
        """End the hole that is being read."""
        hole, self.hole = self.hole, None
        if hole is None:
            return
        if not hole.moves[-1].stops:
            self.refuse(f"the last move of a hole (line {hole.moves[-1].line}) is blended", accepted=self.stop)
        self.holes.append(WrittenHole(hole.line, hole.start, tuple(hole.moves), tuple(hole.statements), hole.way))

    def close_last(self) -> None:
        """End the last hole; moves to a stop after it belong to none."""
        tail: list[Statement] = []
        if self.hole is not None and not self.hole.moves:
            tail, self.hole = [*self.hole.way, *self.hole.statements], None
        self.close()
        self.tail = tail

    def end(self) -> WrittenProgram:
        """The program, when all of it has been read."""
        if not self.holes:
            self.refuse("the program has no holes")
        return WrittenProgram(
            self.name, *self.tool_and_base(), tuple(self.holes), tuple(self.head), tuple(self.tail or ())
        )

    def refuse(self, what: str, *, accepted: str = "") -> NoReturn:
        """Refuse the line that is being read.

        Raises:
            InputError: always.
        """
        raise InputError(what, where=f"{self.file}, line {self.line}", accepted=accepted or self.accepted)

    def refuse_at(self, line: int, what: str) -> NoReturn:
        """Refuse another line.

        Raises:
            InputError: always.
        """
        self.line = line
        self.refuse(what)


class Forms:
    """Every form that a statement of a language may have, and what it does.

    Args:
        acts: method of the language's reading by a form as it is printed, `0` standing for any number.
        parse: words of a form.
        key: words and `0` as by them a statement is recognised.
        shown: whether a message names a form.
    """

    def __init__(
        self,
        acts: Mapping[str, Callable[[Any, Words, Numbers], None]],
        parse: Callable[[str], Words],
        key: Callable[[Words], tuple[str, ...]] = shape,
        shown: Callable[[str], bool] = lambda form: True,
    ) -> None:
        self._key = key
        self._acts = {key(parse(form)): act for form, act in acts.items()}
        self._shown = [(parse(form)[0], form) for form in acts if shown(form)]

    def act(self, words: Words) -> Callable[[Any, Words, Numbers], None] | None:
        """What a statement does; None: it has none of these forms."""
        return self._acts.get(self._key(words))

    def like(self, words: Words) -> list[str]:
        """The forms that begin with the same word."""
        return [form for first, form in self._shown if first == words[0]]


@dataclass
class SourceReading(Reading):
    """What is known of a text in which statements stand between two that begin and end a program.

    Attributes:
        ended: whether the last statement has been read.
        settings: what is set before the first move, and the numbers of each.
    """

    opening: ClassVar[str]
    closing: ClassVar[str]
    unit: ClassVar[str] = "program"

    ended: bool = False
    settings: dict[str, Numbers] = field(default_factory=dict)

    @property
    @abstractmethod
    def forms(self) -> Forms:
        """Those of the language, but for the first statement."""

    @property
    def prepared(self) -> bool:
        """Whether a statement has set what moves depend on."""
        return bool(self.settings)

    @abstractmethod
    def statements(self, text: str, refuse: Refuse) -> Iterator[Statement]:
        """The statements of a text, in order."""

    @abstractmethod
    def begin(self, statement: Statement) -> None:
        """Read the name in the first statement."""

    @abstractmethod
    def calls(self, words: Words) -> bool:
        """Whether a statement calls a program that is not a word of the language, with nothing but literals."""

    def read(self, text: str) -> WrittenProgram:
        """The program in a text.

        Raises:
            InputError: a statement that `export` does not write; the message has its line.
        """
        for statement in self.statements(text, self.refuse_at):
            self.take(statement)
        if not self.ended:
            self.refuse(f"the {self.unit} is not complete", accepted=f"{self.opening} to {self.closing}")
        return self.end()

    def starter(self, text: str) -> Starter | None:
        """What a text calls that sets and moves nothing itself; None: it does, or it is not complete.

        Raises:
            InputError: as `read`.
        """
        for statement in self.statements(text, self.refuse_at):
            self.take(statement)
            if self.prepared or self.hole:
                return None
        return (self.name, tuple(self.head)) if self.ended else None

    def take(self, statement: Statement) -> None:
        """One statement."""
        self.line = statement.line
        if self.ended:
            self.refuse(f"'{statement.source}' after {self.closing}")
        if (statement.words[0] == self.opening) == bool(self.name):
            self.refuse(f"a second {self.unit}" if self.name else f"'{statement.source}' before {self.opening}")
        if not self.name:
            self.begin(statement)
        elif (act := self.forms.act(statement.words)) is not None:
            act(self, statement.words, tuple(word for word in statement.words if isinstance(word, Decimal)))
        elif self.calls(statement.words):
            self.stand_still(f"'{statement.source}' is called")
        else:
            self.refuse_form(statement)
        if not self.ended:
            self.keep(statement)

    def need(self, names: Sequence[str]) -> None:
        """Refuse a move before all is set that it depends on."""
        if missing := [name for name in names if name not in self.settings]:
            self.refuse(f"a move before {', '.join(missing)} is set")

    def refuse_form(self, statement: Statement) -> NoReturn:
        """Refuse a statement, with the forms that begin like it."""
        alike = self.forms.like(statement.words)
        accepted = " or ".join(alike) + ", a number for each 0" * any("0" in form for form in alike)
        self.refuse(f"'{statement.source[:80]}' is not a statement that zerorev writes", accepted=accepted)
