"""The moves of a program, as it is printed, in ball arithmetic.

On a straight move a controller takes the tool straight from the one printed point to the next, and turns it evenly, in
proportion to the way, about the one axis by which the one printed orientation goes over into the other, the short way
round (KUKA: `$ORI_TYPE=#VAR`). On a joint move every joint turns evenly. The first move sets out from where the printed
axis values place the tool.
"""

from __future__ import annotations

from collections.abc import Sequence
from decimal import Decimal

import numpy as np
from flint import arb

from zerorev.model._arrays import Array
from zerorev.model.hole import Hole
from zerorev.model.plan import Plan
from zerorev.model.robot import Robot
from zerorev.model.written import WrittenFrame, WrittenHole, WrittenJoints, WrittenMove, WrittenProgram
from zerorev.verify.as_planned import NUMBERED, Places
from zerorev.verify.certificate.arm import Pose, Setting, angles, body_at, flange_at, posture_of
from zerorev.verify.certificate.path import JointLeg, Motion, Rig, Segment, motion_of
from zerorev.verify.certificate.vector import Axes, Vector, axis_angle, columns, combined, dot, onto, vector
from zerorev.verify.printed import joints_of

__all__ = ["written_motion"]

Turn = tuple[arb, arb]


def written_motion(plan: Plan, program: WrittenProgram, written: WrittenHole, hole: Hole, at: Places) -> Motion:
    """The motion of one hole of a program.

    Args:
        plan: whose robot it is; of a program that has but the numbers of its frames, their values, too.
        program: whose frames the points are given in.
        written: the moves.
        hole: as planned; only to tell stand-offs in messages.
        at: where its points lie.
    """
    points = _Points(plan, program, joints_of(plan.robot, written.start))
    ends = [points.pose(end) for end in (written.start, *(move.end for move in written.moves))]
    joints = [_joints(plan.robot, each) for each in (written.start, *(move.end for move in written.moves))]
    standoff = [
        dot(combined((tip, arb(1)), (vector(hole.target), arb(-1))), vector(-hole.direction)) for tip, _ in ends
    ]
    legs: list[Segment | JointLeg] = []
    for k, move in enumerate(written.moves):
        names = (at.first, "approach"), (at.lead, "lead-in"), (at.corner, "plunge"), (at.last, "retract")
        leg = next((name for end, name in names if k < end), "way out")
        where = f"on the {leg} (line {move.line})"
        spans = standoff[k], standoff[k + 1]
        if move.linear:
            corner = "blended corner" if k + 1 == at.corner else "blend"
            bend = f"in the {corner} (line {move.line})"
            legs.append(points.straight(written.moves, k, (ends[k], ends[k + 1]), where, bend, spans))
        else:
            end = joints[k + 1]
            if end is None:
                raise ValueError(f"line {move.line}: a joint move to a point that is not joints")
            begin = joints[k] or points.joints_at(ends[k], end)
            legs.append(JointLeg(where, begin, end, abs(spans[1] - spans[0]), spans, printed=True))
    return motion_of(legs, at.lead, at.corner, at.first, at.last)


class _Points:
    """The poses of a program's points, seen from the robot's base."""

    def __init__(self, plan: Plan, program: WrittenProgram, start: Array) -> None:
        self.robot, self.start = plan.robot, start
        if program.tool is None:
            T = plan.tool.T_flange_tcp @ NUMBERED
            self.tip_in_flange, tool = vector(T[:3, 3]), columns(T[:3, :3])
        else:
            self.tip_in_flange, tool = _frame(program.tool)
        self.in_tool = tuple((tool[0][k], tool[1][k], tool[2][k]) for k in range(3))  # axes of the flange
        root = plan.settings.robroot
        if program.base is None:
            self.part, self.base = vector(plan.T_base_part[:3, 3]), columns(plan.T_base_part[:3, :3])
        else:
            part = _seen_from(root if isinstance(root, tuple) else None, *_frame(program.base))
            self.part, self.base = _from_the_controllers_base(plan.robot.base_in_root, *part)
        self.wrist = combined((self.tip_in_flange, arb(-1)), ((arb(0), arb(0), arb(-plan.robot.arm.c4)), arb(1)))

    def pose(self, end: WrittenFrame | WrittenJoints) -> tuple[Vector, Axes]:
        """Tip [m] and axes of the flange."""
        if isinstance(end, WrittenJoints):
            joints = _joints(self.robot, end)
            assert joints is not None
            origin, flange = flange_at(self.robot.arm, joints)
            return combined((origin, arb(1)), (onto(flange, self.tip_in_flange), arb(1))), flange
        tip, axes = _frame(end)
        x, y, z = (onto(self.base, onto(axes, axis)) for axis in self.in_tool)
        return combined((self.part, arb(1)), (onto(self.base, tip), arb(1))), (x, y, z)

    def joints_at(self, place: tuple[Vector, Axes], near: Sequence[arb]) -> tuple[arb, ...]:
        """Joints of the posture of the start at a tip [m] and axes of the flange, on the turns of others [rad].

        NaN where they cannot be computed: what is to be proven of them remains undecided.
        """
        (tip, flange), posture = place, posture_of(self.robot.arm, self.start)
        if posture is None:
            return (arb("nan"),) * 6
        setting = Setting(self.robot.arm, posture)
        wrist = combined((tip, arb(1)), (onto(flange, self.wrist), arb(1)))
        found = angles(setting, body_at(setting, Pose(wrist, flange[2])), flange)
        return tuple(
            angle + 2 * arb.pi() * round(float(other - angle) / (2 * np.pi)) if angle.is_finite() else angle
            for angle, other in zip(found, near, strict=True)
        )

    def straight(
        self,
        moves: Sequence[WrittenMove],
        k: int,
        ends: tuple[tuple[Vector, Axes], tuple[Vector, Axes]],
        where: str,
        bend: str,
        standoff: tuple[arb, arb],
    ) -> Segment:
        """One straight move."""
        (begin, flange), (end, there) = ends
        way = combined((end, arb(1)), (begin, arb(-1)))
        same = k > 0 and _same_turn(moves[k - 1].end, moves[k].end)
        axis, angle = (flange[2], arb(0)) if same else axis_angle(flange, there)
        length = dot(way, way).sqrt()
        return Segment(
            where=where,
            bend=bend,
            begin=begin,
            end=end,
            rig=Rig(onto(flange, self.wrist), flange),
            axis=axis,
            angle=(arb(0), angle),
            standoff=standoff,
            length=length,
            # of a blend whose size is not known the greatest
            radius=length / 2 if moves[k].blend_mm is None else _metre(moves[k].blend_mm),
        )


def _same_turn(before: WrittenFrame | WrittenJoints, end: WrittenFrame | WrittenJoints) -> bool:
    return isinstance(before, WrittenFrame) and isinstance(end, WrittenFrame) and before.turn == end.turn


def _joints(robot: Robot, end: WrittenFrame | WrittenJoints) -> tuple[arb, ...] | None:
    """The joints that turn [rad]; None of a pose."""
    if isinstance(end, WrittenFrame):
        return None
    if end.unit == "pulses":  # of the joints that turn
        assert robot.pulses_per_deg is not None  # no program of pulses is written for a robot without them
        pairs = zip(end.values, robot.pulses_per_deg, strict=True)
        return tuple(arb(str(count)) / arb(each) * arb.pi() / 180 for count, each in pairs)
    shown = [arb(str(value)) if end.unit == "rad" else _rad(value) for value in end.values]
    if robot.display.j3_less_j2:
        shown[2] = shown[2] + shown[1]
    return tuple(shown)


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


def _from_the_controllers_base(
    base_in_root: tuple[float, ...] | None, origin: Vector, axes: Axes
) -> tuple[Vector, Axes]:
    """A frame that is counted from the controller's base, as it is seen from that of the arm."""
    if base_in_root is None:
        return origin, axes
    place = vector(np.array(base_in_root[:3]))
    turn = _axes(*(arb(angle).sin_cos() for angle in base_in_root[:2:-1]))
    x, y, z = (onto(turn, axis) for axis in axes)
    return combined((place, arb(1)), (onto(turn, origin), arb(1))), (x, y, z)


def _metre(length_mm: Decimal | None) -> arb:
    return arb(str(length_mm)) / 1000


def _rad(angle_deg: Decimal) -> arb:
    return arb(str(angle_deg)) * arb.pi() / 180


def _frame(frame: WrittenFrame) -> tuple[Vector, Axes]:
    """Origin [m] and axes of a frame."""
    x, y, z = (_metre(length) for length in frame.xyz_mm)
    if frame.form == "zyx_deg":
        about_z, about_y, about_x = (_rad(angle).sin_cos() for angle in frame.turn)
        return (x, y, z), _axes(about_z, about_y, about_x)
    numbers = [arb(str(number)) for number in frame.turn]
    return (x, y, z), _of_quaternion(numbers if frame.form == "quaternion" else _to_quaternion(numbers))


def _to_quaternion(v: Sequence[arb]) -> list[arb]:
    """Of a rotation vector [rad]."""
    angle = sum((part * part for part in v), arb(0)).sqrt()
    if angle == 0:
        return [arb(1), arb(0), arb(0), arb(0)]
    sin, cos = (angle / 2).sin_cos()
    return [cos, *(part / angle * sin for part in v)]


def _of_quaternion(q: Sequence[arb]) -> Axes:
    """Columns of the rotation of a quaternion of any length."""
    w, x, y, z = q
    share = 2 / (w * w + x * x + y * y + z * z)
    return (
        (1 - share * (y * y + z * z), share * (x * y + w * z), share * (x * z - w * y)),
        (share * (x * y - w * z), 1 - share * (x * x + z * z), share * (y * z + w * x)),
        (share * (x * z + w * y), share * (y * z - w * x), 1 - share * (x * x + y * y)),
    )


def _axes(about_z: Turn, about_y: Turn, about_x: Turn) -> Axes:
    """Of R = Rz Ry Rx, each turn by its sine and cosine."""
    (sa, ca), (sb, cb), (sc, cc) = about_z, about_y, about_x
    return (
        (ca * cb, sa * cb, -sb),
        (ca * sb * sc - sa * cc, sa * sb * sc + ca * cc, cb * sc),
        (ca * sb * cc + sa * sc, sa * sb * cc - ca * sc, cb * cc),
    )
