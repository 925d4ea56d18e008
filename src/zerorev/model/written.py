"""A robot program as it is printed: every number an exact decimal, in the units of the file."""

from __future__ import annotations

from dataclasses import dataclass
from decimal import Decimal

__all__ = ["Six", "WrittenHole", "WrittenMove", "WrittenProgram"]

Six = tuple[Decimal, Decimal, Decimal, Decimal, Decimal, Decimal]


@dataclass(frozen=True)
class WrittenMove:
    """A straight move of the tool.

    Attributes:
        line: of the file, from 1.
        point_mm_deg: X, Y, Z [mm] and A, B, C [deg] of its end in the part frame; R = Rz(A) Ry(B) Rx(C).
        blend_mm: radius at its end [mm]; 0 is an exact stop.
        feed_m_s: of the tip [m/s].
    """

    line: int
    point_mm_deg: Six
    blend_mm: Decimal
    feed_m_s: Decimal


@dataclass(frozen=True)
class WrittenHole:
    """The moves of one hole.

    Attributes:
        id: of the hole, as far as a comment can hold it.
        line: of the file at which the robot moves to the first point, from 1.
        axes_deg: the six axis values there [deg], turns included.
        moves: the straight moves from there on; the last one ends in an exact stop.
    """

    id: str
    line: int
    axes_deg: Six
    moves: tuple[WrittenMove, ...]


@dataclass(frozen=True)
class WrittenProgram:
    """A program: the tool goes straight from point to point and turns evenly about one axis on each move.

    Attributes:
        name: in the program.
        tool_mm_deg: the tool frame in the flange frame, as a point.
        base_mm_deg: the part frame in the robot's base frame, as a point.
        holes: in order.
    """

    name: str
    tool_mm_deg: Six
    base_mm_deg: Six
    holes: tuple[WrittenHole, ...]
