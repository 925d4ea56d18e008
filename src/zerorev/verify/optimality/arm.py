"""The arm at a stand-off as a function of the spin, in ball arithmetic and without division by what can vanish.

The rate of joint i on a leg of slope u is (N_i + u M_i) / den_i, where the denominators are products of the height of
the triangle of shoulder, elbow and wrist centre, and of sin q5: all of them are 0 or more. So the sign of a rate is
known at a singularity and at the edge of reach, too. The formulas serve numbers (`arb`) and series in the spin
(`arb_series`) alike, and are written apart from the search. Everything is in model angles with sin q5 >= 0.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Generic, NamedTuple, TypeVar

from flint import arb, arb_series

from zerorev.model.hole import Hole
from zerorev.model.robot import ArmGeometry
from zerorev.model.tool import Tool
from zerorev.verify.certificate.legs import rig_of
from zerorev.verify.certificate.vector import Vector, combined, cross, dot, scaled, vector

__all__ = ["Arm", "Directions", "Rates", "arm_of", "directions", "lifted", "rates_at", "root_of"]

Kind = TypeVar("Kind", arb, arb_series)
Three = tuple[Kind, Kind, Kind]


class Carried(NamedTuple, Generic[Kind]):
    """A vector that turns with the spin: still + cos(psi) across + sin(psi) aside."""

    still: Three[Kind]
    across: Three[Kind]
    aside: Three[Kind]


class Arm(NamedTuple, Generic[Kind]):
    """Arm, tool and hole.

    Attributes:
        lengths: a1, a2, b, c1, c2, c3 [m].
        z: unit vector out of the hole.
        wrist: wrist centre at stand-off 0 [m].
        flange: axes of the flange.
        one: the number 1, of the kind that is calculated with.
    """

    lengths: tuple[Kind, Kind, Kind, Kind, Kind, Kind]
    z: Three[Kind]
    wrist: Carried[Kind]
    flange: tuple[Carried[Kind], Carried[Kind], Carried[Kind]]
    one: Kind


class Rates(NamedTuple, Generic[Kind]):
    """Six rates at a place, each times its denominator, and what the denominators are made of.

    Attributes:
        outwards: N: per metre of moving straight out.
        spinning: M: per radian of spin.
        height: of the triangle of shoulder, elbow and wrist centre, times its base; 0 or more.
        sine_2: square of sin q5.
        q1: cosine and sine of q1.
        upper: shoulder to elbow, up and ahead [m].
        q23: cosine and sine of q2 + q3.
        axis_6: axis 6 seen from the forearm.
    """

    outwards: tuple[Kind, ...]
    spinning: tuple[Kind, ...]
    height: Kind
    sine_2: Kind
    q1: tuple[Kind, Kind]
    upper: tuple[Kind, Kind]
    q23: tuple[Kind, Kind]
    axis_6: Three[Kind]


Directions = list[tuple[arb, arb]]
"""Cosine and sine, up to a factor above 0, of q1, q2, q2 + q3, q4, q5, q6."""


def arm_of(arm: ArmGeometry, tool: Tool, hole: Hole) -> Arm[arb]:
    """Everything that does not vary, in numbers."""
    z = scaled(vector(-hole.direction))
    rig = rig_of(arm, tool, hole, z)
    lever = _carried(rig.lever, z)
    x, y, axis = (_carried(v, z) for v in rig.flange)
    wrist = Carried(combined((lever.still, arb(1)), (vector(hole.target), arb(1))), lever.across, lever.aside)
    a1, a2, b, c1, c2, c3 = (arb(length) for length in (arm.a1, arm.a2, arm.b, arm.c1, arm.c2, arm.c3))
    return Arm((a1, a2, b, c1, c2, c3), z, wrist, (x, y, axis), arb(1))


def _carried(v: Vector, z: Vector) -> Carried[arb]:
    still = combined((z, dot(v, z)))
    across = combined((v, arb(1)), (still, arb(-1)))
    return Carried(still, across, cross(z, across))


def lifted(arm: Arm[arb]) -> Arm[arb_series]:
    """The same for series."""

    def lift(value: Any) -> Any:
        if isinstance(value, arb):
            return arb_series([value])
        return Carried(*map(lift, value)) if isinstance(value, Carried) else tuple(map(lift, value))

    return Arm(*map(lift, arm))


def root_of(x: arb) -> arb:
    """The square root of the part of a number that is not negative."""
    return x.sqrt() if x > 0 else arb(0).union(x.upper().sqrt()) if x.upper() >= 0 else arb.nan()


def rates_at(
    arm: Arm[Kind],
    posture: int,
    standoff: Kind,
    turn: tuple[Kind, Kind],
    root: Callable[[Kind], Kind],
    reach: list[Kind],
) -> Rates[Kind]:
    """Everything at a stand-off and a spin.

    Args:
        arm: with tool and hole.
        posture: 0..3, branch // 2.
        standoff: [m].
        turn: cosine and sine of the spin.
        root: square root; it may raise where that has no derivative.
        reach: out, the squares of two lengths: what is out of reach has a negative one. It is filled in as far as
            possible also where `root` raises.
    """
    a1, a2, b, c1, c2, c3 = arm.lengths
    cos, sin = turn
    ahead, forward = posture < 2, (posture % 2 == 0) != (posture < 2)
    around = [p * cos + q * sin for p, q in zip(arm.wrist.across, arm.wrist.aside, strict=True)]
    x, y, z = (w + e * standoff + r for w, e, r in zip(arm.wrist.still, arm.z, around, strict=True))
    off_2 = x * x + y * y
    reach.append(off_2 - b * b)
    before = root(reach[0])
    out = before if ahead else -before
    share = arm.one / off_2
    C1, S1 = (x * out + y * b) * share, (y * out - x * b) * share

    # the elbow by its foot on the line from shoulder to wrist centre, and its height above it
    u, v = out - a1, z - c1
    line_2 = u * u + v * v
    fore_2 = a2 * a2 + c3 * c3
    foot = (line_2 + c2 * c2 - fore_2) / 2
    reach.append(line_2 * c2 * c2 - foot * foot)
    height = root(reach[1])
    lift = height if forward else -height
    share = arm.one / line_2
    upper_z, upper_x = (v * foot - u * lift) * share, (u * foot + v * lift) * share
    fore_z, fore_x = v - upper_z, u - upper_x
    share = arm.one / fore_2
    C23, S23 = (fore_z * c3 + fore_x * a2) * share, (fore_x * c3 - fore_z * a2) * share

    def seen(w: Carried[Kind]) -> Three[Kind]:
        """From the forearm."""
        wx, wy, wz = (p + q * cos + r * sin for p, q, r in zip(*w, strict=True))
        out_of_axis = C1 * wx + S1 * wy
        return C23 * out_of_axis - S23 * wz, C1 * wy - S1 * wx, S23 * out_of_axis + C23 * wz

    axis_6 = seen(arm.flange[2])
    hx, hy, C5 = axis_6
    sine_2 = hx * hx + hy * hy

    def joints(velocity: Three[Kind], spin: bool) -> tuple[Kind, ...]:
        """All six, from the velocity of the wrist centre, and from the tool's turning by a radian about z or not."""
        vx, vy, vz = velocity
        q1 = (C1 * vy - S1 * vx) / out
        vout = C1 * vx + S1 * vy + b * q1
        q2, q23 = -(fore_z * vz + fore_x * vout), upper_z * vz + upper_x * vout
        if not forward:
            q2, q23 = -q2, -q23
        if spin:
            zx, zy, zz = arm.z
            rolled, left = C1 * zx + S1 * zy, zz - q1
            turn_x, turn_z = C23 * rolled - S23 * left, S23 * rolled + C23 * left
            turn_y = (C1 * zy - S1 * zx) * height - q23
        else:
            turn_x, turn_z, turn_y = S23 * q1, -(C23 * q1), -q23
        turn_x = turn_x * height
        q6 = turn_x * hx + turn_y * hy
        return q1, q2, q23 - q2, turn_z * height * sine_2 - C5 * q6, turn_y * hx - turn_x * hy, q6

    swing = tuple(q * cos - p * sin for p, q in zip(arm.wrist.across, arm.wrist.aside, strict=True))
    outwards, spinning = joints(arm.z, False), joints((swing[0], swing[1], swing[2]), True)
    return Rates(outwards, spinning, height, sine_2, (C1, S1), (upper_z, upper_x), (C23, S23), axis_6)


def directions(arm: Arm[arb], turn: tuple[arb, arb], at: Rates[arb]) -> Directions:
    """The joints at a place."""
    (C1, S1), (C23, S23), (hx, hy, C5) = at.q1, at.q23, at.axis_6

    def beside(w: Carried[arb]) -> tuple[arb, arb]:
        wx, wy, wz = (p + q * turn[0] + r * turn[1] for p, q, r in zip(*w, strict=True))
        return C23 * (C1 * wx + S1 * wy) - S23 * wz, C1 * wy - S1 * wx

    (xx, xy), (yx, yy) = beside(arm.flange[0]), beside(arm.flange[1])
    return [at.q1, at.upper, at.q23, (hx, hy), (C5, root_of(at.sine_2)), (hx * yy - hy * yx, hx * xy - hy * xx)]
