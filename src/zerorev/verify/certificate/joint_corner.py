"""A bound, in ball arithmetic, of how far the tool leaves the drill axis between three joint vectors.

Two moves that are linear in the joints meet at a corner, and a controller blends them in a way of its own. All that it
can make of them lies in the triangle between entry, corner and exit, in the space of the joints, as long as it blends
all joints alike. The bound holds for the whole triangle.

The triangle is cut into four again and again. On a small one the tip differs from its linear interpolation between the
three vertices by no more than 2/9 of the greatest second derivative along a side: at a point with shares a, b, c of the
vertices the interpolation is off by half the sum of a f''[v_a - p] and the like, where no v_a - p is longer than 1 - a
sides, and a (1 - a)^2 + b (1 - b)^2 + c (1 - c)^2 is at most 4/9. The second derivative is bounded by the lengths of
the arm: joints that turn by w_i and w_j bend the way of a point by no more than w_i w_j times its distance from the
outer of the two. The distance from the axis is convex, so that it is greatest at a vertex, but for that.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from flint import arb

from zerorev.model._arrays import Array
from zerorev.model.hole import Hole
from zerorev.model.robot import ArmGeometry, Robot
from zerorev.model.tool import Tool
from zerorev.verify.certificate.arm import flange_at
from zerorev.verify.certificate.piece import ball_arithmetic, bounds
from zerorev.verify.certificate.vector import Vector, combined, dot, onto, scaled, vector

__all__ = ["CornerBounds", "Ray", "axis_of", "bound_corner", "drill_of"]

SHARE, CLOSE = 0.1, np.array([1e-6, np.deg2rad(1e-4)])  # of what is met, and [m], [rad]: a bound may be so much above
HALVINGS, MOST_TRIANGLES = 12, 20_000  # with more the bound holds as well, but is less close

Place = tuple[float, float]
"""The shares of entry and exit in a joint vector of the triangle, exact; the rest is the corner's."""

ENTRY, CORNER, EXIT = (1.0, 0.0), (0.0, 0.0), (0.0, 1.0)


class Ray(NamedTuple):
    """A place and a direction.

    Attributes:
        place: [m].
        direction: unit.
    """

    place: Vector
    direction: Vector


class CornerBounds(NamedTuple):
    """What is proven of two joint moves and of every blend of them.

    Attributes:
        off_axis: the tip is nowhere further from the drill axis [m].
        tilt: the tool is nowhere tilted more against it [rad].
        off_axis_met: so far from the axis the tip is somewhere, or further [m].
        tilt_met: so much the tool is tilted somewhere, or more [rad].
        signs: which way each joint goes on the move to the corner, and on the one from it: -1, +1, or 0 where it does
            not move (conventions: signature).
        triangles: into how many triangles the one was cut.
    """

    off_axis: float
    tilt: float
    off_axis_met: float
    tilt_met: float
    signs: tuple[tuple[int, ...], tuple[int, ...]]
    triangles: int

    @property
    def one_way(self) -> tuple[bool, ...]:
        """For each joint whether it goes the same way on both moves, or rests on both."""
        return tuple(first == last for first, last in zip(*self.signs, strict=True))


def drill_of(tool: Tool) -> Ray:
    """The tip of a drill and the direction out of the material, flange frame."""
    return Ray(vector(tool.T_flange_tcp[:3, 3]), scaled(vector(tool.T_flange_tcp[:3, 2])))


def axis_of(hole: Hole) -> Ray:
    """The drill axis, out of the material, base frame."""
    return Ray(vector(hole.target), scaled(vector(-hole.direction)))


def bound_corner(robot: Robot, drill: Ray, axis: Ray, joints: Sequence[Sequence[arb]]) -> CornerBounds:
    """How far the tool leaves the drill axis, and which way the joints go.

    Args:
        robot: the arm.
        drill: of the tool (`drill_of`), or as a program has it.
        axis: of the hole (`axis_of`).
        joints: controller angles at entry, corner and exit [rad], six each, as exact as they are known.
    """
    with ball_arithmetic():
        return _Triangle(robot, drill, axis, joints).bounds()


class _Triangle:
    """All joint vectors between three."""

    def __init__(self, robot: Robot, drill: Ray, axis: Ray, joints: Sequence[Sequence[arb]]) -> None:
        self.robot, self.drill, self.axis = robot, drill, axis
        self.entry, self.corner, self.exit = joints
        self.to_entry, self.to_exit = (
            [a - b for a, b in zip(end, self.corner, strict=True)] for end in (self.entry, self.exit)
        )
        self.known: dict[Place, Array] = {}

    def bounds(self) -> CornerBounds:
        """Of the whole triangle: it is cut until they are close to what is met."""
        ahead: list[tuple[Place, Place, Place]] = [(ENTRY, CORNER, EXIT)]
        curvature, count, above = self._curvature(), 0, np.zeros(2)
        for halving in range(HALVINGS + 1):
            rest = bounds([[bend * 2 / 9 / 4**halving for bend in curvature]])[1][0]
            met = np.array([[self._met(place) for place in triangle] for triangle in ahead])
            upper = np.nextafter(met[:, :, 1].max(axis=1) + rest, np.inf)
            greatest = np.array(list(self.known.values()))[:, 0].max(axis=0)
            close = (upper <= np.maximum(above, greatest * (1 + SHARE) + CLOSE)).all(axis=1)
            if halving == HALVINGS or count + 4 * np.count_nonzero(~close) > MOST_TRIANGLES:
                close[:] = True
            count += int(np.count_nonzero(close))
            above = np.maximum(above, upper[close].max(axis=0, initial=0.0))
            ahead = [part for triangle, done in zip(ahead, close, strict=True) if not done for part in _cut(*triangle)]
            if not ahead:
                break
        # the chord between the two directions, made unit, is 2 sin(tilt / 2)
        tilts = [[2 * (arb(float(chord)) / 2).min(arb(1)).asin() for chord in (greatest[1], above[1])]]
        tilt_met, tilt = max(0.0, bounds(tilts)[0][0, 0]), bounds(tilts)[1][0, 1]
        off_axis_met = max(0.0, greatest[0])
        return CornerBounds(float(above[0]), float(tilt), float(off_axis_met), float(tilt_met), self._signs(), count)

    def _pose(self, place: Place) -> tuple[Vector, Vector]:
        """The tip [m] and the direction of the tool, base frame."""
        a, b, rest = (arb(share) for share in (*place, 1 - sum(place)))
        joints = [a * e + rest * c + b * x for e, c, x in zip(self.entry, self.corner, self.exit, strict=True)]
        origin, flange = flange_at(self.robot.arm, joints)
        return combined((origin, arb(1)), (onto(flange, self.drill.place), arb(1))), onto(flange, self.drill.direction)

    def _met(self, place: Place) -> Array:
        """Below and above: the distance from the axis [m], and the chord of the tilt [1]; shape (2, 2)."""
        if place not in self.known:
            tip, direction = self._pose(place)
            from_target = combined((tip, arb(1)), (self.axis.place, arb(-1)))
            beside = combined((from_target, arb(1)), (self.axis.direction, -dot(from_target, self.axis.direction)))
            chord = combined((direction, arb(1)), (self.axis.direction, arb(-1)))
            squares = [dot(vector, vector) for vector in (beside, chord)]
            ends = [[square.abs_lower().sqrt(), square.abs_upper().sqrt()] for square in squares]
            lower, upper = bounds(ends)
            self.known[place] = np.array([lower[:, 0], upper[:, 1]])
        return self.known[place]

    def _curvature(self) -> tuple[arb, arb]:
        """No second derivative along a side is greater: of the tip [m], and of the direction of the tool [1]."""
        sides = zip(self.to_entry, self.to_exit, strict=True)
        turns = [abs(e).max(abs(x)).max(abs(x - e)) for e, x in sides]
        arms = _arms(self.robot.arm, self.drill.place)
        tip = sum((turns[i] * turns[j] * arms[max(i, j)] for i in range(6) for j in range(6)), arb(0))
        return tip, sum(turns, arb(0)) ** 2

    def _signs(self) -> tuple[tuple[int, ...], tuple[int, ...]]:
        """Which way each joint goes on the move to the corner, and on the one from it."""
        corner = self._pose(CORNER)[0]
        signs = []
        for end, turns, way in ((ENTRY, self.to_entry, -1), (EXIT, self.to_exit, 1)):
            line = combined((self._pose(end)[0], arb(1)), (corner, arb(-1)))
            nil = dot(line, line).sqrt() * self.robot.nil_rate
            signs.append(tuple(way * (int(turn > nil) - int(turn < -nil)) for turn in turns))
        return signs[0], signs[1]


def _arms(arm: ArmGeometry, tip: Vector) -> list[arb]:
    """No further is the tip ever from each of the six axes [m]."""
    past_wrist = combined((tip, arb(1)), (vector(np.array([0.0, 0.0, arm.c4])), arb(1)))
    wrist = dot(past_wrist, past_wrist).sqrt()
    elbow = wrist + (arb(arm.a2) ** 2 + arb(arm.b) ** 2 + arb(arm.c3) ** 2).sqrt()
    shoulder = elbow + arb(arm.c2)
    return [shoulder + abs(arb(arm.a1)), shoulder, elbow, wrist, wrist, wrist]


def _cut(a: Place, b: Place, c: Place) -> Iterator[tuple[Place, Place, Place]]:
    """A triangle in four, by the middles of its sides."""
    ab, bc, ca = (((p[0] + q[0]) / 2, (p[1] + q[1]) / 2) for p, q in ((a, b), (b, c), (c, a)))
    yield from ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))
