"""The arm in ball arithmetic: joint rates and angles of a pose in motion, as numbers or as Taylor series.

One set of formulas serves all kinds of `Ball`: an `arb` gives a rigorous enclosure at a point, an `arb_series` one of
every Taylor coefficient, a `Taylor` model one over all placements of the part. The rates need the cosines and sines of
the joints alone, and these come out of the pose algebraically: seen from above the wrist centre turns axis 1; shoulder,
elbow and wrist centre are a triangle; what is then left of the tool's turning is the wrist's. Written apart from the
kernels and from the sampled check.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Generic, NamedTuple, TypeVar

from flint import arb

from zerorev.model._arrays import Array
from zerorev.model.robot import ArmGeometry
from zerorev.verify.certificate.taylor import Taylor
from zerorev.verify.certificate.vector import Axes, Ball, Vector, Vector3, combined, turned

__all__ = ["Body", "Pose", "Posture", "Setting", "Twist", "angles", "body_at", "flange_at", "posture_of", "rates"]

EX, EY, EZ = ((arb(int(k == 0)), arb(int(k == 1)), arb(int(k == 2))) for k in range(3))

Number = TypeVar("Number", arb, Taylor)


class Posture(NamedTuple):
    """Which way round the arm reaches: +1 or -1 each.

    Attributes:
        reach: +1 with the wrist centre ahead of axis 1.
        elbow: +1 where the upper arm leans further forward than the line from shoulder to wrist centre.
        flip: sign of the sine of model angle 5.
    """

    reach: int
    elbow: int
    flip: int


class Setting(NamedTuple):
    """What is constant along the motion of one hole.

    Attributes:
        arm: geometry.
        posture: which way round it reaches.
    """

    arm: ArmGeometry
    posture: Posture


class Pose(NamedTuple, Generic[Ball]):
    """Where the wrist is, base frame.

    Attributes:
        wrist: the wrist centre [m].
        axis_6: unit vector along axis 6, from the wrist centre to the flange.
    """

    wrist: Vector3[Ball]
    axis_6: Vector3[Ball]


class Twist(NamedTuple, Generic[Ball]):
    """How a pose moves, per unit of some parameter, base frame.

    Attributes:
        velocity: of the wrist centre [m].
        turning: of the flange [rad].
    """

    velocity: Vector3[Ball]
    turning: Vector3[Ball]


class Body(NamedTuple, Generic[Ball]):
    """A pose solved.

    Attributes:
        ahead: the wrist centre ahead of axis 1 [m].
        height: twice the signed area of the triangle of shoulder, elbow and wrist centre [m^2].
        q1: cosine and sine of q1.
        q23: cosine and sine of q2 + q3.
        upper: shoulder to elbow, up and ahead [m].
        fore: elbow to wrist centre, up and ahead [m].
        axis_6: axis 6 seen from the forearm: cos q4 sin q5, sin q4 sin q5, cos q5.
        squares: the squares of `ahead`, `height` and sin q5; all positive where the pose is in reach and not singular.
    """

    ahead: Ball
    height: Ball
    q1: tuple[Ball, Ball]
    q23: tuple[Ball, Ball]
    upper: tuple[Ball, Ball]
    fore: tuple[Ball, Ball]
    axis_6: Vector3[Ball]
    squares: Vector3[Ball]


def body_at(setting: Setting, pose: Pose[Ball]) -> Body[Ball]:
    """A pose solved in the setting's posture."""
    arm, posture = setting
    x, y, z = pose.wrist
    b = arb(arm.b)
    ahead_2 = x * x + y * y - b * b
    ahead = ahead_2.sqrt() * posture.reach
    # quotients of lengths are taken before products: what is linear cancels early, and models stay narrow
    share = 1 / ahead
    c1, s1 = x * share, y * share
    if setting.arm.b:
        aside = b * share
        share = 1 / (1 + aside * aside)
        c1, s1 = (c1 + s1 * aside) * share, (s1 - c1 * aside) * share

    up, out, c2 = z - arb(arm.c1), ahead - arb(arm.a1), arb(arm.c2)
    fore_2 = arb(arm.a2) ** 2 + arb(arm.c3) ** 2
    line_2 = up * up + ahead_2 - (ahead * 2 - arb(arm.a1)) * arb(arm.a1)
    along = (line_2 + (c2 * c2 - fore_2)) / 2
    height_2 = line_2 * (c2 * c2) - along * along
    height = height_2.sqrt() * posture.elbow
    share = 1 / line_2
    upper = (up * along - out * height) * share, (out * along + up * height) * share
    fore = up - upper[0], out - upper[1]
    # axis 4 lies atan2(a2, c3) short of the line from elbow to wrist centre
    e, f = arb(arm.c3) / fore_2, arb(arm.a2) / fore_2
    c23, s23 = fore[0] * e + fore[1] * f, fore[1] * e - fore[0] * f

    axis_6 = _from_forearm((c1, s1), (c23, s23), pose.axis_6)
    sine_2 = axis_6[0] * axis_6[0] + axis_6[1] * axis_6[1]
    squares = ahead_2, height_2, sine_2
    return Body(ahead, height, (c1, s1), (c23, s23), upper, fore, axis_6, squares)


def rates(setting: Setting, body: Body[Ball], twist: Twist[Ball]) -> list[Ball]:
    """Rates of the six controller angles [rad], per unit of the twist's parameter."""
    (c1, s1), (c23, s23) = body.q1, body.q23
    (vx, vy, vz), (wx, wy, wz) = twist
    q1 = (c1 * vy - s1 * vx) / body.ahead
    v_out = c1 * vx + s1 * vy + q1 * arb(setting.arm.b)

    (upper_z, upper_x), (fore_z, fore_x) = body.upper, body.fore
    share = 1 / body.height
    q2 = -(fore_z * vz + fore_x * v_out) * share
    q23 = (upper_z * vz + upper_x * v_out) * share

    turn_x, turn_y, turn_z = c1 * wx + s1 * wy, c1 * wy - s1 * wx - q23, wz - q1
    left_x, left_z = c23 * turn_x - s23 * turn_z, s23 * turn_x + c23 * turn_z
    hx, hy, c5 = body.axis_6
    share = 1 / body.squares[2].sqrt()
    c4, s4 = hx * share, hy * share
    q6 = (left_x * c4 + turn_y * s4) * share
    q4 = left_z - c5 * q6
    q5 = (turn_y * c4 - left_x * s4) * setting.posture.flip
    return [rate * int(sign) for rate, sign in zip((q1, q2, q23 - q2, q4, q5, q6), setting.arm.sign, strict=True)]


def angles(
    setting: Setting, body: Body[Number], flange: tuple[Vector3[Number], Vector3[Number], Vector3[Number]]
) -> list[Number]:
    """The six controller angles [rad], turns as they fall.

    Args:
        setting: arm and posture.
        body: the pose, solved.
        flange: axes of the flange, base frame.
    """
    (c1, s1), (c23, s23), flip = body.q1, body.q23, setting.posture.flip
    hx, hy, c5 = body.axis_6
    sine = body.squares[2].sqrt()
    c4, s4 = hx * flip / sine, hy * flip / sine
    # axis 5 is (-s4, c4, 0) seen from the forearm; axes x and y of the flange turn about axis 6 from it
    x, y = (_from_forearm(body.q1, body.q23, axis) for axis in flange[:2])
    q2 = _angle(body.upper[1], body.upper[0])
    q = (
        _angle(s1, c1),
        q2,
        _angle(s23, c23) - q2,
        _angle(s4, c4),
        _angle(sine * flip, c5),
        _angle(c4 * x[1] - s4 * x[0], c4 * y[1] - s4 * y[0]),
    )
    sign, offset = setting.arm.sign, setting.arm.offset
    return [(q[k] + arb(offset[k])) * int(sign[k]) for k in range(6)]


def posture_of(arm: ArmGeometry, joints: Array) -> Posture | None:
    """The posture of controller angles [rad], shape (6,), by forward kinematics; None where it is undecided."""
    q = [arb(float(joint)) * int(arm.sign[k]) - arb(arm.offset[k]) for k, joint in enumerate(joints)]
    (s2, c2), (s23, c23) = q[1].sin_cos(), (q[1] + q[2]).sin_cos()
    length = arb(arm.c2)
    upper = length * c2, length * s2
    up = upper[0] + arb(arm.c3) * c23 - arb(arm.a2) * s23
    out = upper[1] + arb(arm.c3) * s23 + arb(arm.a2) * c23
    signs = [_sign(value) for value in (out + arb(arm.a1), upper[1] * up - upper[0] * out, q[4].sin())]
    return Posture(*signs) if all(signs) else None


def flange_at(arm: ArmGeometry, joints: Sequence[arb]) -> tuple[Vector, Axes]:
    """Origin [m] and axes of the flange at six controller angles [rad], link by link from the flange inwards."""
    q = [joint * int(sign) - arb(offset) for joint, sign, offset in zip(joints, arm.sign, arm.offset, strict=True)]
    zero = arb(0)
    links = (
        (EZ, (arb(arm.a1), zero, arb(arm.c1))),
        (EY, (zero, zero, arb(arm.c2))),
        (EY, (arb(arm.a2), arb(arm.b), arb(arm.c3))),
        (EZ, (zero, zero, zero)),
        (EY, (zero, zero, zero)),
        (EZ, (zero, zero, arb(arm.c4))),
    )
    origin, x, y, z = (zero, zero, zero), EX, EY, EZ
    for (axis, link), angle in zip(reversed(links), reversed(q), strict=True):
        sin, cos = angle.sin_cos()
        shifted = combined((origin, arb(1)), (link, arb(1)))
        origin, x, y, z = (turned(v, axis, cos, sin) for v in (shifted, x, y, z))
    return origin, (x, y, z)


def _sign(value: arb) -> int:
    """+1 or -1 where that is proven, else 0."""
    return 1 if value > 0 else -1 if value < 0 else 0


def _angle(sine: Number, cosine: Number) -> Number:
    """The angle of a direction; tight also where that is +-180 deg."""
    if isinstance(sine, Taylor):
        return sine.atan2(cosine)
    if cosine < 0 and not (sine > 0 or sine < 0):
        return arb.atan2(-sine, -cosine) + arb.pi()
    return arb.atan2(sine, cosine)


def _from_forearm(q1: tuple[Ball, Ball], q23: tuple[Ball, Ball], vector: Vector3[Ball]) -> Vector3[Ball]:
    """A vector of the base frame in the frame that axes 1 to 3 have turned."""
    (c1, s1), (c23, s23), (x, y, z) = q1, q23, vector
    out = c1 * x + s1 * y
    return c23 * out - s23 * z, c1 * y - s1 * x, s23 * out + c23 * z
