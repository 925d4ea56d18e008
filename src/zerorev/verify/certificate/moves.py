"""The moves of a program, as it is printed, as straight moves in ball arithmetic.

A controller that holds its orientation control at variable (KUKA: `$ORI_TYPE=#VAR`) takes the tool straight from the
one printed point to the next, and turns it evenly, in proportion to the way, about the one axis by which the one
printed orientation goes over into the other, the short way round. The first move sets out from where the printed axis
values place the tool.
"""

from __future__ import annotations

from decimal import Decimal

import numpy as np
from flint import arb

from zerorev.model.hole import Hole
from zerorev.model.robot import ArmGeometry
from zerorev.model.written import Six, WrittenHole, WrittenProgram
from zerorev.verify.as_planned import Places
from zerorev.verify.certificate.arm import flange_at
from zerorev.verify.certificate.path import Motion, Rig, Segment, motion_of
from zerorev.verify.certificate.vector import Axes, Vector, axis_angle, combined, dot, onto, vector

__all__ = ["written_motion"]

Turn = tuple[arb, arb]


def written_motion(
    arm: ArmGeometry,
    program: WrittenProgram,
    written: WrittenHole,
    hole: Hole,
    at: Places,
    robroot: tuple[float, ...] | None = None,
) -> Motion:
    """The motion of one hole of a program.

    Args:
        arm: geometry.
        program: whose frames the points are given in.
        written: the moves.
        hole: as planned; only to tell stand-offs in messages.
        at: where its points lie.
        robroot: x, y, z [m], roll, pitch, yaw [rad] of the robot's base in the frame from which the part frame of the
            program counts; None: they are the same.
    """
    tip_in_flange, tool = _frame(program.tool_mm_deg)
    part, base = _seen_from(robroot, *_frame(program.base_mm_deg))
    in_tool = tuple((tool[0][k], tool[1][k], tool[2][k]) for k in range(3))  # axes of the flange
    wrist_in_flange = combined((tip_in_flange, arb(-1)), ((arb(0), arb(0), arb(-arm.c4)), arb(1)))

    origin, flange = flange_at(arm, [_rad(angle) for angle in written.axes_deg])
    tips = [combined((origin, arb(1)), (onto(flange, tip_in_flange), arb(1)))]
    flanges = [flange]
    for move in written.moves:
        tip, axes = _frame(move.point_mm_deg)
        tips.append(combined((part, arb(1)), (onto(base, tip), arb(1))))
        x, y, z = (onto(base, onto(axes, axis)) for axis in in_tool)
        flanges.append((x, y, z))
    standoff = [dot(combined((tip, arb(1)), (vector(hole.target), arb(-1))), vector(-hole.direction)) for tip in tips]
    segments = []
    for k, move in enumerate(written.moves):
        way = combined((tips[k + 1], arb(1)), (tips[k], arb(-1)))
        same = k > 0 and move.point_mm_deg[3:] == written.moves[k - 1].point_mm_deg[3:]
        axis, angle = (flanges[k][2], arb(0)) if same else axis_angle(flanges[k], flanges[k + 1])
        ends = (at.first, "approach"), (at.lead, "lead-in"), (at.corner, "plunge"), (at.last, "retract")
        leg = next((name for end, name in ends if k < end), "way out")
        blend = "blended corner" if k + 1 == at.corner else "blend"
        segments.append(
            Segment(
                where=f"on the {leg} (line {move.line})",
                bend=f"in the {blend} (line {move.line})",
                begin=tips[k],
                end=tips[k + 1],
                rig=Rig(onto(flanges[k], wrist_in_flange), flanges[k]),
                axis=axis,
                angle=(arb(0), angle),
                standoff=(standoff[k], standoff[k + 1]),
                length=dot(way, way).sqrt(),
                radius=_metre(move.blend_mm),
            )
        )
    return motion_of(segments, at.lead, at.corner, at.first, at.last)


def _seen_from(robroot: tuple[float, ...] | None, origin: Vector, axes: Axes) -> tuple[Vector, Axes]:
    """A frame as it is seen from the robot's base."""
    if robroot is None:
        return origin, axes
    place = vector(np.array(robroot[:3]))
    root = _axes(*(arb(angle).sin_cos() for angle in robroot[:2:-1]))

    def seen(direction: Vector) -> Vector:
        return dot(root[0], direction), dot(root[1], direction), dot(root[2], direction)

    x, y, z = (seen(axis) for axis in axes)
    return seen(combined((origin, arb(1)), (place, arb(-1)))), (x, y, z)


def _metre(length_mm: Decimal) -> arb:
    return arb(str(length_mm)) / 1000


def _rad(angle_deg: Decimal) -> arb:
    return arb(str(angle_deg)) * arb.pi() / 180


def _frame(values_mm_deg: Six) -> tuple[Vector, Axes]:
    """Origin [m] and axes of a frame: R = Rz(A) Ry(B) Rx(C)."""
    x, y, z = (_metre(length) for length in values_mm_deg[:3])
    return (x, y, z), _axes(*(_rad(angle).sin_cos() for angle in values_mm_deg[3:]))


def _axes(about_z: Turn, about_y: Turn, about_x: Turn) -> Axes:
    """Of R = Rz Ry Rx, each turn by its sine and cosine."""
    (sa, ca), (sb, cb), (sc, cc) = about_z, about_y, about_x
    return (
        (ca * cb, sa * cb, -sb),
        (ca * sb * sc - sa * cc, sa * sb * sc + ca * cc, cb * sc),
        (ca * sb * cc + sa * sc, sa * sb * cc - ca * sc, cb * cc),
    )
