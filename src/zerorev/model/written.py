"""A robot program as it is printed: every number an exact decimal, in the units of the file."""

from __future__ import annotations

from dataclasses import dataclass, field
from decimal import Decimal
from typing import Literal, NamedTuple

__all__ = [
    "Drilled", "Pace", "Statement", "Word", "WrittenFrame", "WrittenHole", "WrittenJoints", "WrittenMove",
    "WrittenProgram",
]  # fmt: skip

Numbers = tuple[Decimal, ...]
Word = str | Decimal


@dataclass(frozen=True)
class WrittenFrame:
    """A pose as it is printed.

    Attributes:
        xyz_mm: origin [mm], three numbers.
        turn: its rotation R.
        form: what `turn` has: `zyx_deg`, three angles [deg], R = Rz(t0) Ry(t1) Rx(t2); `quaternion`, w, x, y, z of any
            length; `vector_rad`, the rotation vector [rad].
    """

    xyz_mm: Numbers
    turn: Numbers
    form: Literal["zyx_deg", "quaternion", "vector_rad"] = "zyx_deg"


@dataclass(frozen=True)
class WrittenJoints:
    """Six joint values as they are printed, turns included.

    Attributes:
        values: as the controller shows them (`Robot.display`), or counts.
        unit: of all six; pulses are what `Robot.pulses_per_deg` says.
    """

    values: Numbers
    unit: Literal["deg", "rad", "pulses"] = "deg"


class Pace(NamedTuple):
    """How fast a move is.

    Attributes:
        value: as printed.
        unit: of the tip [m/s] or [cm/min], or the time of the whole move [s], or a share of what the joints can [%].
    """

    value: Decimal
    unit: Literal["m/s", "cm/min", "s", "%"] = "m/s"


@dataclass(frozen=True)
class Statement:
    """What one line of a program tells the controller to do; equal where the controller sees no difference.

    Attributes:
        words: names and signs in capitals, and numbers.
        line: of the file, from 1.
        source: as it stands there, without comment and surplus white space.
        file: name of the file; empty where the program is one file.
    """

    words: tuple[Word, ...]
    line: int = field(compare=False)
    source: str = field(compare=False)
    file: str = field(default="", compare=False)

    @property
    def at(self) -> str:
        """Where it stands, in words."""
        return f"{self.file}, line {self.line}" if self.file else f"line {self.line}"


@dataclass(frozen=True)
class WrittenMove:
    """A move of the tool.

    Attributes:
        line: of the file, from 1.
        end: where it ends: a pose in the part frame, or joints.
        pace: how fast it is.
        blend_mm: radius at its end [mm]; 0 is an exact stop, None a blend whose size the program does not have.
        linear: whether the tip goes straight, the tool turning evenly about one axis; else all joints move evenly.
        wait: for which the robot stands at its end [s].
    """

    line: int = field(compare=False)
    end: WrittenFrame | WrittenJoints
    pace: Pace
    blend_mm: Decimal | None
    linear: bool = True
    wait: Decimal = Decimal(0)

    @property
    def stops(self) -> bool:
        """Whether the robot stands at its end."""
        return self.blend_mm == 0


@dataclass(frozen=True)
class WrittenHole:
    """The moves of one hole.

    Attributes:
        line: of the file at which the robot moves to the first point, from 1.
        start: the joints there.
        moves: those from there on; the last one ends in an exact stop.
        statements: all of them, from the move to the first point on.
        way: those before it, which lead there from the hole before.
        file: name of the file; empty where the program is one file.
    """

    line: int = field(compare=False)
    start: WrittenJoints
    moves: tuple[WrittenMove, ...]
    statements: tuple[Statement, ...]
    way: tuple[Statement, ...] = ()
    file: str = field(default="", compare=False)


@dataclass(frozen=True)
class WrittenProgram:
    """A program.

    Attributes:
        name: in the program.
        tool: the tool frame in the flange frame; None: the program has only its number.
        base: the part frame in the controller's base frame; None: the program has only its number.
        holes: in order.
        head: all statements before the first hole; of a program of several files, all outside of holes but for the
            end of the last file.
        tail: all after the last hole.
        parts: how many holes each of its parts has; empty where it is one file.
    """

    name: str = field(compare=False)  # in capitals it is in the head
    tool: WrittenFrame | None
    base: WrittenFrame | None
    holes: tuple[WrittenHole, ...]
    head: tuple[Statement, ...]
    tail: tuple[Statement, ...] = ()
    parts: tuple[int, ...] = ()


class Drilled(NamedTuple):
    """One hole of a plan, and what a program has for it.

    Attributes:
        hole: of the program; None where it leaves the hole out.
        wrong: one sentence for each statement that is not the plan's.
    """

    hole: WrittenHole | None
    wrong: tuple[str, ...] = ()
