"""A robot program as it is printed: every number an exact decimal, in the units of the file."""

from __future__ import annotations

from dataclasses import dataclass, field
from decimal import Decimal
from typing import NamedTuple

__all__ = ["Drilled", "Six", "Statement", "Word", "WrittenHole", "WrittenMove", "WrittenProgram"]

Six = tuple[Decimal, Decimal, Decimal, Decimal, Decimal, Decimal]
Word = str | Decimal


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
    """A straight move of the tool.

    Attributes:
        line: of the file, from 1.
        point_mm_deg: X, Y, Z [mm] and A, B, C [deg] of its end in the part frame; R = Rz(A) Ry(B) Rx(C).
        blend_mm: radius at its end [mm]; 0 is an exact stop.
        feed_m_s: of the tip [m/s].
    """

    line: int = field(compare=False)
    point_mm_deg: Six
    blend_mm: Decimal
    feed_m_s: Decimal


@dataclass(frozen=True)
class WrittenHole:
    """The moves of one hole.

    Attributes:
        line: of the file at which the robot moves to the first point, from 1.
        axes_deg: the six axis values there [deg], turns included.
        moves: the straight moves from there on; the last one ends in an exact stop.
        statements: all of them, from the move to the first point on.
        way: those before it, which lead there from the hole before.
        file: name of the file; empty where the program is one file.
    """

    line: int = field(compare=False)
    axes_deg: Six
    moves: tuple[WrittenMove, ...]
    statements: tuple[Statement, ...]
    way: tuple[Statement, ...] = ()
    file: str = field(default="", compare=False)


@dataclass(frozen=True)
class WrittenProgram:
    """A program: the tool goes straight from point to point and turns evenly about one axis on each move.

    Attributes:
        name: in the program.
        tool_mm_deg: the tool frame in the flange frame, as a point.
        base_mm_deg: the part frame in the robot's base frame, as a point.
        holes: in order.
        head: all statements before the first hole; of a program of several files, all outside of holes but for the
            end of the last file.
        tail: all after the last hole.
        parts: how many holes each of its parts has; empty where it is one file.
    """

    name: str = field(compare=False)  # in capitals it is in the head
    tool_mm_deg: Six
    base_mm_deg: Six
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
