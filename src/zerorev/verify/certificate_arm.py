"""The arm in ball arithmetic: joint rates and angles along a path, as numbers or as Taylor series.

One set of formulas serves both kinds of `Ball`: an `arb` gives a rigorous enclosure at a point, an `arb_series` one of
every Taylor coefficient. The rates need the cosines and sines of the joints alone, and these come out of the pose
algebraically: seen from above the wrist centre turns axis 1; shoulder, elbow and wrist centre are a triangle; what is
then left of the tool's turning is the wrist's. Written apart from the kernels and from the sampled check.
"""

from __future__ import annotations

from typing import Generic, NamedTuple, TypeVar

from flint import arb, arb_series

from zerorev.model._arrays import Array
from zerorev.model.hole import Hole
from zerorev.model.robot import ArmGeometry
from zerorev.model.tool import Tool

__all__ = ["Body", "Posture", "Setting", "Vector", "angles", "body_at", "posture_of", "rates", "setting_of"]

Ball = TypeVar("Ball", arb, arb_series)
Vector = tuple[arb, arb, arb]


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
    """All that is constant along the motion of one hole: base frame, lengths [m].

    At stand-off s and spin psi the wrist centre is wrist[0] + s axis + cos(psi) wrist[1] + sin(psi) wrist[2]; so are
    the flange's axes, but for s.
    """

    arm: ArmGeometry
    posture: Posture
    axis: Vector
    wrist: tuple[Vector, Vector, Vector]
    flange: tuple[tuple[Vector, Vector, Vector], ...]


class Body(NamedTuple, Generic[Ball]):
    """A pose solved.

    Attributes:
        cos_sin: cosine and sine of the spin.
        ahead: the wrist centre ahead of axis 1 [m].
        height: twice the signed area of the triangle of shoulder, elbow and wrist centre [m^2].
        q1: cosine and sine of q1.
        q23: cosine and sine of q2 + q3.
        upper: shoulder to elbow, up and ahead [m].
        fore: elbow to wrist centre, up and ahead [m].
        axis_6: axis 6 seen from the forearm: cos q4 sin q5, sin q4 sin q5, cos q5.
        squares: the squares of `ahead`, `height` and sin q5; all positive where the pose is in reach and not singular.
    """

    cos_sin: tuple[Ball, Ball]
    ahead: Ball
    height: Ball
    q1: tuple[Ball, Ball]
    q23: tuple[Ball, Ball]
    upper: tuple[Ball, Ball]
    fore: tuple[Ball, Ball]
    axis_6: tuple[Ball, Ball, Ball]
    squares: tuple[Ball, Ball, Ball]


def setting_of(arm: ArmGeometry, tool: Tool, hole: Hole, posture: Posture) -> Setting:
    """The constants of a motion.

    A plan's unit vectors and rotations are so but for the rounding of its file (4e-12). Here they are made exactly so,
    by Gram-Schmidt: that is the motion of which the certificate speaks.
    """
    axis = _scaled(_vector(-hole.direction))
    y0 = _across(_vector(hole.psi_zero), axis)
    x0 = _cross(y0, axis)
    R, p = tool.T_flange_tcp[:3, :3], _vector(tool.T_flange_tcp[:3, 3])
    z_tool = _scaled(_vector(R[:, 2]))
    y_tool = _across(_vector(R[:, 1]), z_tool)
    tool_axes = _cross(y_tool, z_tool), y_tool, z_tool

    def turned(x: arb, y: arb, z: arb) -> tuple[Vector, Vector, Vector]:
        """A vector of the tool in the base frame: what is fixed, goes with cos(psi), with sin(psi)."""
        return (
            _sum((axis, z)),
            _sum((x0, x), (y0, y)),
            _sum((y0, x), (x0, -y)),
        )

    wrist_in_flange = (-p[0], -p[1], -arb(arm.c4) - p[2])
    x, y, z = (_dot(wrist_in_flange, column) for column in tool_axes)
    fixed, cos, sin = turned(x, y, z)
    centre = _sum((_vector(hole.target), arb(1)), (fixed, arb(1)))
    flange = tuple(turned(*(column[k] for column in tool_axes)) for k in range(3))
    return Setting(arm, posture, axis, (centre, cos, sin), flange)


def body_at(setting: Setting, standoff: Ball, psi: Ball) -> Body[Ball]:
    """The pose at stand-off [m] and spin [rad], solved in the setting's posture."""
    arm, posture = setting.arm, setting.posture
    sin, cos = psi.sin_cos()
    centre, with_cos, with_sin = setting.wrist
    x, y, z = (
        standoff * setting.axis[k] + cos * with_cos[k] + sin * with_sin[k] + centre[k] for k in range(3)
    )  # fmt: skip
    b, squared = arb(arm.b), x * x + y * y
    ahead_2 = squared - b * b
    ahead = ahead_2.sqrt() * posture.reach
    share = 1 / squared
    c1, s1 = (x * ahead + y * b) * share, (y * ahead - x * b) * share

    up, out, c2 = z - arb(arm.c1), ahead - arb(arm.a1), arb(arm.c2)
    fore_2 = arb(arm.a2) ** 2 + arb(arm.c3) ** 2
    line_2 = up * up + out * out
    along = (line_2 + (c2 * c2 - fore_2)) / 2
    height_2 = line_2 * (c2 * c2) - along * along
    height = height_2.sqrt() * posture.elbow
    share = 1 / line_2
    upper = (up * along - out * height) * share, (out * along + up * height) * share
    fore = up - upper[0], out - upper[1]
    # axis 4 lies atan2(a2, c3) short of the line from elbow to wrist centre
    e, f = arb(arm.c3) / fore_2, arb(arm.a2) / fore_2
    c23, s23 = fore[0] * e + fore[1] * f, fore[1] * e - fore[0] * f

    axis_6 = _from_forearm((c1, s1), (c23, s23), _flange_axis(setting, 2, cos, sin))
    sine_2 = axis_6[0] * axis_6[0] + axis_6[1] * axis_6[1]
    squares = ahead_2, height_2, sine_2
    return Body((cos, sin), ahead, height, (c1, s1), (c23, s23), upper, fore, axis_6, squares)


def rates(setting: Setting, body: Body[Ball], standoff_rate: Ball, psi_rate: Ball) -> list[Ball]:
    """Rates of the six controller angles.

    Args:
        setting: the constants.
        body: the pose.
        standoff_rate: of the stand-off, in the path's parameter [m].
        psi_rate: of the spin [rad].
    """
    cos, sin = body.cos_sin
    (c1, s1), (c23, s23), (_, with_cos, with_sin) = body.q1, body.q23, setting.wrist
    around = (cos * with_sin[k] - sin * with_cos[k] for k in range(3))
    vx, vy, vz = (standoff_rate * z + psi_rate * turn for z, turn in zip(setting.axis, around, strict=True))
    q1 = (c1 * vy - s1 * vx) / body.ahead
    v_out = c1 * vx + s1 * vy + q1 * arb(setting.arm.b)

    (upper_z, upper_x), (fore_z, fore_x) = body.upper, body.fore
    share = 1 / body.height
    q2 = -(fore_z * vz + fore_x * v_out) * share
    q23 = (upper_z * vz + upper_x * v_out) * share

    zx, zy, zz = setting.axis
    turn_x = psi_rate * (c1 * zx + s1 * zy)
    turn_y = psi_rate * (c1 * zy - s1 * zx) - q23
    turn_z = psi_rate * zz - q1
    left_x, left_z = c23 * turn_x - s23 * turn_z, s23 * turn_x + c23 * turn_z
    hx, hy, c5 = body.axis_6
    sine_2 = body.squares[2]
    q6 = (left_x * hx + turn_y * hy) / sine_2
    q4 = left_z - c5 * q6
    q5 = (turn_y * hx - left_x * hy) / sine_2.sqrt() * setting.posture.flip
    return [rate * int(sign) for rate, sign in zip((q1, q2, q23 - q2, q4, q5, q6), setting.arm.sign, strict=True)]


def angles(setting: Setting, body: Body[arb]) -> list[arb]:
    """The six controller angles [rad], turns as they fall."""
    (c1, s1), (c23, s23), flip = body.q1, body.q23, setting.posture.flip
    hx, hy, c5 = body.axis_6
    sine = body.squares[2].sqrt()
    c4, s4 = hx * flip / sine, hy * flip / sine
    cos, sin = body.cos_sin
    # axis 5 is (-s4, c4, 0) seen from the forearm; axes x and y of the flange turn about axis 6 from it
    x, y = (_from_forearm(body.q1, body.q23, _flange_axis(setting, k, cos, sin)) for k in (0, 1))
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
    """The posture of controller angles [rad], shape (6,), by forward kinematics; None where it cannot be told."""
    q = [arb(float(joint)) * int(arm.sign[k]) - arb(arm.offset[k]) for k, joint in enumerate(joints)]
    (s2, c2), (s23, c23) = q[1].sin_cos(), (q[1] + q[2]).sin_cos()
    length = arb(arm.c2)
    upper = length * c2, length * s2
    up = upper[0] + arb(arm.c3) * c23 - arb(arm.a2) * s23
    out = upper[1] + arb(arm.c3) * s23 + arb(arm.a2) * c23
    signs = [_sign(value) for value in (out + arb(arm.a1), upper[1] * up - upper[0] * out, q[4].sin())]
    return Posture(*signs) if all(signs) else None


def _sign(value: arb) -> int:
    """+1 or -1 where that is proven, else 0."""
    return 1 if value > 0 else -1 if value < 0 else 0


def _angle(sine: arb, cosine: arb) -> arb:
    """The angle of a direction; tight also where that is +-180 deg."""
    if cosine < 0 and not (sine > 0 or sine < 0):
        return arb.atan2(-sine, -cosine) + arb.pi()
    return arb.atan2(sine, cosine)


def _flange_axis(setting: Setting, k: int, cos: Ball, sin: Ball) -> tuple[Ball, Ball, Ball]:
    fixed, with_cos, with_sin = setting.flange[k]
    x, y, z = (cos * with_cos[i] + sin * with_sin[i] + fixed[i] for i in range(3))
    return x, y, z


def _from_forearm(
    q1: tuple[Ball, Ball], q23: tuple[Ball, Ball], vector: tuple[Ball, Ball, Ball]
) -> tuple[Ball, Ball, Ball]:
    """A vector of the base frame in the frame that axes 1 to 3 have turned."""
    (c1, s1), (c23, s23), (x, y, z) = q1, q23, vector
    out = c1 * x + s1 * y
    return c23 * out - s23 * z, c1 * y - s1 * x, s23 * out + c23 * z


def _vector(values: Array) -> Vector:
    x, y, z = (arb(float(value)) for value in values)
    return x, y, z


def _dot(a: Vector, b: Vector) -> arb:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _cross(a: Vector, b: Vector) -> Vector:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def _sum(*terms: tuple[Vector, arb]) -> Vector:
    x, y, z = (sum((vector[k] * factor for vector, factor in terms), arb(0)) for k in range(3))
    return x, y, z


def _scaled(vector: Vector) -> Vector:
    return _sum((vector, 1 / _dot(vector, vector).sqrt()))


def _across(vector: Vector, axis: Vector) -> Vector:
    """The part of a vector across a unit axis, made unit."""
    return _scaled(_sum((vector, arb(1)), (axis, -_dot(vector, axis))))
