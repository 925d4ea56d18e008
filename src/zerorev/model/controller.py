"""What a program has besides its moves, so that it fits the controller and the cell that it runs in."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, fields

from zerorev.errors import InputError

__all__ = ["CALL", "HEADER_LINE", "ROBROOT", "VARIABLE", "Call", "Calls", "ExternalAxis", "check_controller"]

CALL = (
    "a name, or a name with literal arguments in brackets: numbers, TRUE, FALSE, #WORD, or a text in double quotes, "
    "e.g. SPINDLE_ON(6000)"
)
HEADER_LINE = "a line that begins with & and a word, of at most 100 printable ASCII characters"
ROBROOT = "$ROBROOT"
"""In which a controller keeps where the robot's own base stands in the world."""
VARIABLE = f"the name of a variable, e.g. {ROBROOT}"

_NAME = r"[A-Za-z][A-Za-z0-9_]{0,23}"
_LITERAL = rf'-?[0-9]{{1,9}}(?:\.[0-9]{{1,9}})?|TRUE|FALSE|#{_NAME}|"[ !#-:<-~]{{0,80}}"'
_CALL = re.compile(rf"\s*({_NAME})\s*(?:\(\s*((?:{_LITERAL})(?:\s*,\s*(?:{_LITERAL}))*)?\s*\))?\s*", re.IGNORECASE)
_ARGUMENT = re.compile(_LITERAL, re.IGNORECASE)
_HEADER = re.compile(r"&[A-Za-z]+( [!-:<-~]+)*")
_VARIABLE = re.compile(r"\$?[A-Za-z][A-Za-z0-9_]{0,22}")
_AXIS = re.compile("E[1-6]")
LONGEST_HEADER = 100


@dataclass(frozen=True)
class Call:
    """A call of a program that the controller has; what that does is nobody's business here.

    Attributes:
        name: of the program.
        arguments: literals, as they are written.
    """

    name: str
    arguments: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Hold the parts to what a call may have, so that no expression gets into a program."""
        if not re.fullmatch(_NAME, self.name) or not all(_ARGUMENT.fullmatch(each) for each in self.arguments):
            raise InputError(
                f"'{self.name}' with {', '.join(self.arguments) or 'nothing'}", where="call", accepted=CALL
            )

    @classmethod
    def parse(cls, text: str) -> Call:
        """A call as a job states it.

        Raises:
            InputError: an expression, a variable, a second statement, or anything else.
        """
        found = _CALL.fullmatch(text) if "\n" not in text else None
        if found is None:
            raise InputError(f"'{text[:80]}' is not a call with literal arguments", where="call", accepted=CALL)
        return cls(found[1], tuple(_ARGUMENT.findall(found[2] or "")))

    def __str__(self) -> str:
        """The call as a job states it."""
        return f"{self.name}({', '.join(self.arguments)})" if self.arguments else self.name


@dataclass(frozen=True)
class Calls:
    """Which programs are called where the robot stands still.

    Attributes:
        before_job: before the first move.
        before_hole: at the first point of each hole, before its linear moves.
        after_hole: at the last point of each hole.
        after_job: after the last move.
    """

    before_job: tuple[Call, ...] = ()
    before_hole: tuple[Call, ...] = ()
    after_hole: tuple[Call, ...] = ()
    after_job: tuple[Call, ...] = ()

    def places(self) -> Iterator[tuple[str, tuple[Call, ...]]]:
        """Where something is called, in words such as `before each hole`, and what."""
        for field in fields(self):
            calls: tuple[Call, ...] = getattr(self, field.name)
            if calls:
                yield field.name.replace("_hole", " each hole").replace("_job", " the job"), calls


@dataclass(frozen=True)
class ExternalAxis:
    """An axis besides the robot's six, which stands still while the job is drilled.

    Attributes:
        name: E1 to E6.
        at: where it stands, as the controller shows it [mm or deg].
    """

    name: str
    at: float


def check_controller(
    robroot: str | tuple[float, ...] | None, external_axes: tuple[ExternalAxis, ...], header: tuple[str, ...]
) -> None:
    """Hold what does not come from a file, or is only known together, to what a program may have.

    Raises:
        InputError: it may not.
    """
    if isinstance(robroot, str) and not _VARIABLE.fullmatch(robroot):
        raise InputError(f"'{robroot[:60]}' is not the name of a variable", where="robroot", accepted=VARIABLE)
    names = [axis.name for axis in external_axes]
    if len(set(names)) < len(names) or not all(_AXIS.fullmatch(name) for name in names):
        raise InputError(f"the axes {', '.join(names)}", where="external_axes", accepted="E1 to E6, each once")
    for line in header:
        if len(line) > LONGEST_HEADER or not _HEADER.fullmatch(line):
            raise InputError(f"'{line[:60]}' is not a line of a header", where="header", accepted=HEADER_LINE)
