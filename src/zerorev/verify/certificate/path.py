"""The motion in ball arithmetic: straight moves of the tool, each cut into arcs, and blends between them.

On a straight move the tip goes from one point to another, and the tool turns evenly about one fixed axis. A leg of a
plan is such a move, along the drill axis and about it; so is a LIN of a program, between two rounded poses that lie
beside the axis and are tilted against it by a hair.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

from flint import arb, arb_series

from zerorev.verify.certificate.arm import Pose, Twist
from zerorev.verify.certificate.vector import Axes, Vector, cross, turned

__all__ = ["Arc", "Blend", "JointLeg", "Motion", "Quadratic", "Rig", "Segment", "Turn", "motion_of"]

Quadratic = tuple[arb, arb, arb]
"""Coefficients of 1, t and t^2."""


class Rig(NamedTuple):
    """What the tool carries, base frame, before it is turned.

    Attributes:
        lever: from the tip to the wrist centre [m].
        flange: axes of the flange.
    """

    lever: Vector
    flange: Axes


class Turn(NamedTuple):
    """A turn of the tool, whose angle varies.

    Attributes:
        axis: unit, base frame.
        angle: of the parameter [rad].
    """

    axis: Vector
    angle: Quadratic


class Arc(NamedTuple):
    """A part of the motion, run through as its parameter t grows from 0 to 1.

    Attributes:
        where: `on the plunge`, `in the blended corner` or the like.
        tip: of each coordinate [m], base frame.
        rig: what the turns turn.
        turns: one after the other, each about an axis of the base frame; one at least.
        length: path by which rates are counted [m]; of a blend, that of the two bits of leg which it replaces.
        standoff: of the tip [m], for messages.
        knot: index of the breakpoint at t = 1, or None where there is none.
    """

    where: str
    tip: tuple[Quadratic, Quadratic, Quadratic]
    rig: Rig
    turns: tuple[Turn, ...]
    length: arb
    standoff: Quadratic
    knot: int | None = None

    def around(self, t: arb, half: arb) -> tuple[Pose[arb_series], Twist[arb_series]]:
        """Pose and its derivative as series in x, where the parameter is t + half x."""
        (px, vx), (py, vy), (pz, vz) = (_series(quadratic, t, half) for quadratic in self.tip)
        moved: list[tuple[Any, Any, Any]] = [self.rig.lever, self.rig.flange[2], (0, 0, 0)]
        for (i, j, k), quadratic in self.turns:
            angle, rate = _series(quadratic, t, half)
            sin, cos = angle.sin_cos()
            lever, axis_6, (wx, wy, wz) = (turned(v, (i, j, k), cos, sin) for v in moved)
            moved = [lever, axis_6, (wx + rate * i, wy + rate * j, wz + rate * k)]
        lever, axis_6, turning = moved
        ux, uy, uz = cross(turning, lever)
        wrist = px + lever[0], py + lever[1], pz + lever[2]
        return Pose(wrist, axis_6), Twist((vx + ux, vy + uy, vz + uz), turning)

    def at(self, t: float) -> tuple[Pose[arb], Axes]:
        """Pose at the parameter t, and the axes of the flange."""
        tip = tuple(_value(quadratic, t) for quadratic in self.tip)
        lever, (x, y, z) = self.rig
        for axis, angle in self.turns:
            sin, cos = _value(angle, t).sin_cos()
            lever, x, y, z = (turned(v, axis, cos, sin) for v in (lever, x, y, z))
        return Pose((tip[0] + lever[0], tip[1] + lever[1], tip[2] + lever[2]), z), (x, y, z)

    def turn(self) -> float:
        """No less than the tool turns [rad], but for the last digits."""
        return sum(abs(float(angle[1])) + abs(float(angle[2])) for _, angle in self.turns)

    def place(self, t: float) -> str:
        """Where the parameter t lies, for a message."""
        return f"{self.where}, stand-off {round(float(_value(self.standoff, t)) * 1e3, 9) + 0.0:.12g} mm"


class Segment(NamedTuple):
    """A straight move between two points at which the motion may bend.

    Attributes:
        where: how a message calls it.
        bend: how a message calls the blend at its end.
        begin: of the tip [m], base frame.
        end: of the tip [m].
        rig: of the tool where its angle is 0.
        axis: about which the tool turns, unit, base frame.
        angle: at the begin and at the end [rad].
        standoff: at the begin and at the end [m].
        length: [m].
        radius: of the blend at its end [m]; 0 for none.
    """

    where: str
    bend: str
    begin: Vector
    end: Vector
    rig: Rig
    axis: Vector
    angle: tuple[arb, arb]
    standoff: tuple[arb, arb]
    length: arb
    radius: arb

    def part(self, first: arb, last: arb, knot: int | None = None) -> Arc:
        """From one share of the way to another."""

        def linear(begin: arb, end: arb) -> Quadratic:
            return begin + (end - begin) * first, (end - begin) * (last - first), arb(0)

        x, y, z = (linear(a, b) for a, b in zip(self.begin, self.end, strict=True))
        turns = (Turn(self.axis, linear(*self.angle)),)
        length = self.length * (last - first)
        return Arc(self.where, (x, y, z), self.rig, turns, length, linear(*self.standoff), knot)

    def cut(self, behind: Segment) -> arb:
        """Length which the blend takes off this move's end, and off the begin of the next [m]."""
        return self.radius.min(self.length / 2).min(behind.length / 2)

    def blend(self, behind: Segment, cut: arb) -> Arc:
        """The parabola that replaces so much of the end of this move and of the begin of the next (theory §5.1).

        Of the tool's two turns the first dies away as the second sets in, both quadratically.
        """
        first, last = cut / self.length, cut / behind.length

        def parabola(begin: arb, knot: arb, end: arb) -> Quadratic:
            ahead, after = (knot - begin) * first, (end - knot) * last
            return knot - ahead, 2 * ahead, after - ahead

        x, y, z = (parabola(*of) for of in zip(self.begin, self.end, behind.end, strict=True))
        left, still = (self.angle[1] - self.angle[0]) * first, arb(0)
        turns = (
            Turn(self.axis, (self.angle[1] - left, 2 * left, -left)),
            Turn(behind.axis, (still, still, (behind.angle[1] - behind.angle[0]) * last)),
        )
        standoff = parabola(*self.standoff, behind.standoff[1])
        return Arc(self.bend, (x, y, z), self.rig, turns, 2 * cut, standoff)


class JointLeg(NamedTuple):
    """A move of all joints, each evenly, between two points of the motion.

    Where it is blended with a move before or after it, the joints move by a sum of what they do on both, each with a
    weight that is not negative: a joint that has one direction on both keeps it, regardless of the blend.

    Attributes:
        where: how a message calls it.
        begin: the six joints [rad], turns as they fall.
        end: the same at its end, on the turns of `begin`.
        length: path that it replaces [m].
        standoff: at the begin and at the end [m].
        knot: index of the breakpoint at its end.
        printed: whether the turns of `end` are those to which the robot is sent.
    """

    where: str
    begin: tuple[arb, ...]
    end: tuple[arb, ...]
    length: arb
    standoff: tuple[arb, arb]
    knot: int | None = None
    printed: bool = False

    def place(self, t: float) -> str:
        """Where its begin, t = 0, or its end, t = 1, lies, for a message."""
        return f"{self.where}, stand-off {round(float(self.standoff[int(t)]) * 1e3, 9) + 0.0:.12g} mm"


class Blend(NamedTuple):
    """A bend cut by a parabola.

    Attributes:
        arc: the parabola.
        first: index in the motion's `legs` of the bit ending at the bend; the parabola replaces it and the next.
        moves: the two straight moves that meet at the bend.
    """

    arc: Arc
    first: int
    moves: tuple[Segment, Segment]


class Motion(NamedTuple):
    """A whole motion.

    Attributes:
        legs: in order of motion, each beginning where the one before ends.
        blends: at the bends.
        first: how many of `legs` lie before the lead-in: there joints may reverse.
        start: how many of `legs` lie before the stroke.
        turn: how many of `legs` lie before the corner.
        last: how many of `legs` lie before the end of the stroke: after it joints may reverse.
    """

    legs: list[Arc | JointLeg]
    blends: list[Blend]
    first: int
    start: int
    turn: int
    last: int

    @property
    def leg_lengths(self) -> tuple[float, float]:
        """Path of the plunge and of the retract [m]."""
        lengths = [float(arc.length) for arc in self.legs]
        return sum(lengths[self.start : self.turn]), sum(lengths[self.turn : self.last])


def motion_of(
    segments: Sequence[Segment | JointLeg], start: int, corner: int, first: int = 0, last: int | None = None
) -> Motion:
    """Moves one after the other, and the blends between those that are straight.

    Args:
        segments: in order of motion.
        start: how many of them lie before the stroke.
        corner: how many of them lie before the corner.
        first: how many of them lie before the lead-in.
        last: how many of them lie before the end of the stroke; None: all.
    """
    legs: list[Arc | JointLeg] = []
    blends: list[Blend] = []
    counts = {0: 0}  # of legs before each breakpoint
    zero, one = arb(0), arb(1)
    here = zero
    for k, segment in enumerate(segments, start=1):
        behind = segments[k] if k < len(segments) else None
        if isinstance(segment, JointLeg):
            legs.append(segment._replace(knot=k))
            here, counts[k] = zero, len(legs)
        elif segment.radius > 0 and isinstance(behind, Segment):
            cut = segment.cut(behind)
            entry, leave = one - cut / segment.length, cut / behind.length
            if entry > here:  # else the blend before ends where this one begins
                legs.append(segment.part(here, entry))
            blends.append(Blend(segment.blend(behind, cut), len(legs), (segment, behind)))
            legs += [segment.part(entry, one, k), behind.part(zero, leave)]
            here, counts[k] = leave, len(legs) - 1
        else:
            legs.append(segment.part(here, one, k))
            here, counts[k] = zero, len(legs)
    end = len(segments) if last is None else last
    return Motion(legs, blends, counts[first], counts[start], counts[corner], counts[end])


def _series(quadratic: Quadratic, t: arb, half: arb) -> tuple[arb_series, arb_series]:
    """A quadratic and its derivative as series in x, where its variable is t + half x."""
    c0, c1, c2 = quadratic
    slope, bend = (c1 + 2 * t * c2) * half, c2 * half * half
    return arb_series([c0 + t * (c1 + t * c2), slope, bend]), arb_series([slope, 2 * bend])


def _value(quadratic: Quadratic, t: float) -> arb:
    c0, c1, c2 = quadratic
    return c0 + t * (c1 + t * c2)
