"""One placement error under which a motion is proven to fail, in ball arithmetic."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from flint import arb, ctx

from zerorev.model._arrays import Array
from zerorev.model.robot import Robot
from zerorev.verify.certificate.arm import Setting, angles, body_at, rates
from zerorev.verify.certificate.path import Arc, Quadratic, Rig, Turn
from zerorev.verify.certificate.tolerance import Cause
from zerorev.verify.certificate.vector import Axes, Vector, combined, onto, turned, vector

__all__ = ["failure", "moved"]

PLACES = (0.0, 0.5, 1.0)  # parameters of an arc at which a joint is sought that moves its own way


def failure(
    robot: Robot, setting: Setting, arcs: Sequence[Arc], joints: Array, T_base_part: Array, cause: Cause, error: Array
) -> str | None:
    """What fails under a placement error, where it is expected to, as a sentence; None where that cannot be proven.

    Args:
        robot: the arm.
        setting: arm and posture.
        arcs: of the motion: legs first.
        joints: at begin and end, without an error [rad], shape (2, 6).
        T_base_part: part frame, shape (4, 4), translation [m].
        cause: where to look, and at what.
        error: shift and rotation vector along the axes of the part frame [m], [rad], shape (6,).
    """
    arc, name = moved(arcs[cause.arc], T_base_part, error), robot.joint_names[cause.joint]
    pose, flange = arc.at(cause.t)
    try:
        body = body_at(setting, pose)
        if cause.what == "reach":
            return f"the pose is out of reach {arc.place(cause.t)}" if any(s < 0 for s in body.squares[:2]) else None
        if cause.what == "limit":
            return _beyond(robot, angles(setting, body, flange), joints, cause, arc)
        way = float(np.sign(joints[1, cause.joint] - joints[0, cause.joint]))
        if not _rate(setting, arc, cause.t, cause.joint) * way < 0:
            return None
        others = ((moved(other, T_base_part, error), t) for other in arcs for t in PLACES)
        if any(_rate(setting, other, t, cause.joint) * way > 0 for other, t in others):
            return f"{name} turns round {arc.place(cause.t)}"
    except ValueError:  # flint's word for a divisor that may be zero
        pass
    return None


def moved(arc: Arc, T_base_part: Array, error: Array) -> Arc:
    """An arc fixed to a part that stands off where it should.

    Args:
        arc: as it should be.
        T_base_part: where the part frame should be, shape (4, 4), translation [m].
        error: shift and rotation vector along the axes of the part frame [m], [rad], shape (6,).
    """
    origin, part = vector(T_base_part[:3, 3]), [vector(T_base_part[:3, k]) for k in range(3)]
    x, y, z = part
    shift, rotation = (onto((x, y, z), vector(values)) for values in (error[:3], error[3:]))
    angle = sum((component * component for component in rotation), arb(0)).sqrt()
    axis = combined((rotation, 1 / angle)) if angle > 0 else z
    sin, cos = angle.sin_cos()

    def there(direction: Vector) -> Vector:
        return turned(direction, axis, cos, sin)

    c0, c1, c2 = ((arc.tip[0][k], arc.tip[1][k], arc.tip[2][k]) for k in range(3))
    from_origin = there(combined((c0, arb(1)), (origin, arb(-1))))
    start = combined((from_origin, arb(1)), (origin, arb(1)), (shift, arb(1)))
    columns = start, there(c1), there(c2)
    tip: list[Quadratic] = [(columns[0][i], columns[1][i], columns[2][i]) for i in range(3)]
    flange: Axes = (there(arc.rig.flange[0]), there(arc.rig.flange[1]), there(arc.rig.flange[2]))
    turns = tuple(Turn(there(turn.axis), turn.angle) for turn in arc.turns)
    return arc._replace(tip=(tip[0], tip[1], tip[2]), rig=Rig(there(arc.rig.lever), flange), turns=turns)


def _rate(setting: Setting, arc: Arc, t: float, joint: int) -> arb:
    """Rate of a joint at a parameter of an arc, per unit of it."""
    terms, ctx.cap = ctx.cap, 1
    try:
        pose, twist = arc.around(arb(t), arb(1))
        return rates(setting, body_at(setting, pose), twist)[joint][0]
    finally:
        ctx.cap = terms


def _beyond(robot: Robot, found: list[arb], joints: Array, cause: Cause, arc: Arc) -> str | None:
    """How far a joint is beyond its limits at one end of the motion; near its angle there without an error."""
    stated = joints[int(cause.t > 0), cause.joint]
    angle, i = found[cause.joint], cause.joint
    angle += 2 * arb.pi() * round((float(stated) - float(angle)) / (2 * np.pi))
    beyond = (float(robot.limits.lower[i]) - angle).max(angle - float(robot.limits.upper[i]))
    if not beyond > 0:
        return None
    return f"{robot.joint_names[i]} is {np.rad2deg(float(beyond)):.3g} deg beyond its limits {arc.place(cause.t)}"
