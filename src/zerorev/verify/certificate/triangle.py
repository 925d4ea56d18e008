"""The triangle of a bend: all places to which a blend of two straight moves can take the tool, along any curve.

A place in it is given by how much of the move before the bend is left, a, and how much of the move behind it is done,
b. The tool is a along the one move in front of the bend, and b along the other behind it, at once: it is turned about
the first axis, then about the second, as in the parabola (`path.Segment.blend`). The two moves themselves are the sides
b = 0 and a = 0.
"""

from __future__ import annotations

from typing import Any, Literal, NamedTuple

from flint import arb

from zerorev.verify.certificate.arm import Pose, Setting, Twist, body_at, rates
from zerorev.verify.certificate.path import Rig, Segment
from zerorev.verify.certificate.vector import Ball, Vector, Vector3, combined, cross, turned

__all__ = ["Fan", "Rates", "Triangle"]

Fan = Literal["bend", "entry", "exit"]
"""The corner of the triangle from which places are counted."""


class Rates(NamedTuple):
    """What the joints do at a place, d theta / d path [rad/m].

    Attributes:
        before: six rates of moving as on the first move.
        behind: six rates of moving as on the second.
        squares: all positive where the pose is in reach and not singular (`arm.Body`).
    """

    before: list[Any]
    behind: list[Any]
    squares: tuple[Any, Any, Any]


class Triangle(NamedTuple):
    """The triangle of one bend.

    Attributes:
        where: `in the blended corner` or the like.
        moves: how a message calls the two moves.
        tip: at the bend [m], base frame.
        along: the unit vectors of the two moves.
        rig: of the tool where its angle is 0.
        axes: about which the tool turns on the two moves, unit, base frame.
        angle: about the first axis at the bend [rad].
        turn: of the tool per path, on the two moves [rad/m].
        standoff: at the bend [m], and how much it grows per path, on the two moves.
        cut: length that the blend takes off either move [m].
    """

    where: str
    moves: tuple[str, str]
    tip: Vector
    along: tuple[Vector, Vector]
    rig: Rig
    axes: tuple[Vector, Vector]
    angle: arb
    turn: tuple[arb, arb]
    standoff: tuple[arb, arb, arb]
    cut: arb

    @classmethod
    def between(cls, before: Segment, behind: Segment) -> Triangle:
        """Of the blend at the end of a move."""
        first, second = before.where.removeprefix("on "), behind.where.removeprefix("on ")
        if first == second:
            first, second = "the move before it", "the move behind it"
        share, other = 1 / before.length, 1 / behind.length
        return cls(
            before.bend,
            (first, second),
            before.end,
            (
                combined((before.end, share), (before.begin, -share)),
                combined((behind.end, other), (before.end, -other)),
            ),
            before.rig,
            (before.axis, behind.axis),
            before.angle[1],
            ((before.angle[1] - before.angle[0]) * share, (behind.angle[1] - behind.angle[0]) * other),
            (
                before.standoff[1],
                (before.standoff[1] - before.standoff[0]) * share,
                (behind.standoff[1] - before.standoff[1]) * other,
            ),
            before.cut(behind),
        )

    def seen_from(self, fan: Fan, x: Ball, y: Ball) -> tuple[Ball, Ball]:
        """A place [m]: a, b.

        Args:
            fan: a corner of the triangle.
            x: share of the way from there to the opposite side, 0 to 1.
            y: share of that side, 0 to 1: beginning, of the bend, at the entry; of the entry or the exit, at the bend.
        """
        far, beside = x * self.cut, x * y * self.cut
        if fan == "bend":
            return far - beside, beside
        return (self.cut - far, beside) if fan == "entry" else (beside, self.cut - far)

    def rates(self, setting: Setting, a: Ball, b: Ball) -> Rates:
        """What the joints do at a place.

        Args:
            setting: arm and posture.
            a: path left on the first move [m].
            b: path done on the second [m].
        """
        pose, before, behind = self._around(a, b)
        body = body_at(setting, pose)
        return Rates(rates(setting, body, before), rates(setting, body, behind), body.squares)

    def place(self, a: float, b: float) -> str:
        """Where a place lies, for a message."""
        bend, first, second = (float(value) for value in self.standoff)
        return f"{self.where}, stand-off {round((bend - a * first + b * second) * 1e3, 9) + 0.0:.6g} mm"

    def _around(self, a: Ball, b: Ball) -> tuple[Pose[Ball], Twist[Ball], Twist[Ball]]:
        """The pose at a place, and how it moves per path as on the one move and as on the other."""
        lever: Any
        axis_6: Any
        first: Any
        sin, cos = (self.angle - a * self.turn[0]).sin_cos()
        lever, axis_6 = (turned(v, self.axes[0], cos, sin) for v in (self.rig.lever, self.rig.flange[2]))
        sin, cos = (b * self.turn[1]).sin_cos()
        lever, axis_6, first = (turned(v, self.axes[1], cos, sin) for v in (lever, axis_6, self.axes[0]))
        twists = []
        for axis, along, turn in zip((first, self.axes[1]), self.along, self.turn, strict=True):
            turning: Vector3[Ball] = (axis[0] * turn, axis[1] * turn, axis[2] * turn)
            ux, uy, uz = cross(lever, turning)
            twists.append(Twist((along[0] - ux, along[1] - uy, along[2] - uz), turning))
        x, y, z = (tip + lever[k] - a * self.along[0][k] + b * self.along[1][k] for k, tip in enumerate(self.tip))
        return Pose((x, y, z), axis_6), twists[0], twists[1]
