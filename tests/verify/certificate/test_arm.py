"""The certificate's arm against one of another make: link by link at 200 bits, rates from the geometric Jacobian."""

import numpy as np
import pytest
from flint import arb, arb_mat, ctx

from zerorev.verify.certificate.arm import Setting, angles, body_at, flange_at, posture_of, rates
from zerorev.verify.certificate.legs import planned_motion
from zerorev.verify.certificate.piece import ball_arithmetic, enclose


def turn(axis, angle):
    sin, cos = angle.sin_cos()
    i, j = [(1, 2), (2, 0), (0, 1)][axis]
    T = [[arb(int(r == c)) for c in range(4)] for r in range(4)]
    T[i][i] = T[j][j] = cos
    T[i][j], T[j][i] = -sin, sin
    return arb_mat(T)


def shift(x, y, z):
    return arb_mat([[1, 0, 0, x], [0, 1, 0, y], [0, 0, 1, z], [0, 0, 0, 1]])


def links(arm, joints):
    """The flange's pose, shape (4, 4), and each axis' direction and a point on it."""
    q = [joint * int(sign) - arb(offset) for joint, sign, offset in zip(joints, arm.sign, arm.offset, strict=True)]
    steps = [
        (2, shift(0, 0, 0)),
        (1, shift(arb(arm.a1), 0, arb(arm.c1))),
        (1, shift(0, 0, arb(arm.c2))),
        (2, shift(arb(arm.a2), arb(arm.b), arb(arm.c3))),
        (1, shift(0, 0, 0)),
        (2, shift(0, 0, 0)),
    ]
    T, axes = shift(0, 0, 0), []
    for (axis, link), angle, sign in zip(steps, q, arm.sign, strict=True):
        T = T * link
        axes.append(([T[k, axis] * int(sign) for k in range(3)], [T[k, 3] for k in range(3)]))
        T = T * turn(axis, angle)
    return T * shift(0, 0, arb(arm.c4)), axes


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def asked(setting_hole, tool, s, psi):
    """Pose of the tip, from the hole; its axes made exact as the certificate says."""

    def unit(v):
        length = sum((x * x for x in v), arb(0)).sqrt()
        return [x / length for x in v]

    z = unit([arb(float(-x)) for x in setting_hole.direction])
    y0 = [arb(float(x)) for x in setting_hole.psi_zero]
    y0 = unit([a - sum((p * q for p, q in zip(y0, z, strict=True)), arb(0)) * b for a, b in zip(y0, z, strict=True)])
    x0 = cross(y0, z)
    sin, cos = psi.sin_cos()
    tip = [arb(float(p)) + s * k for p, k in zip(setting_hole.target, z, strict=True)]
    columns = [cos * a + sin * b for a, b in zip(x0, y0, strict=True)], [
        cos * b - sin * a for a, b in zip(x0, y0, strict=True)
    ], z  # fmt: skip
    return tip, columns


@pytest.fixture(autouse=True)
def many_bits():
    with ball_arithmetic():
        ctx.prec = 200
        yield


def joints_at(setting, arc, t):
    pose, flange = arc.at(t)
    return angles(setting, body_at(setting, pose), flange)


def rates_at(setting, arc, t):
    """Rates of the six joints, per metre of path."""
    ctx.cap = 1
    pose, twist = arc.around(arb(t), arb(1))
    return [rate[0] / arc.length for rate in rates(setting, body_at(setting, pose), twist)]


@pytest.mark.parametrize("seed", range(5))
def test_poses_and_rates(robot, drill, random_hole, seed):
    hole, profile, start = random_hole(robot, drill, seed)
    setting = Setting(robot.arm, posture_of(robot.arm, start))
    leg = planned_motion(robot.arm, drill, hole, profile).legs[0]
    t, spin = 0.625, float(profile.psi[1])  # from psi = 0 at the start
    s, psi, slope = arb(0.375 * hole.depth), arb(spin) * t, -arb(spin) / hole.depth
    joints = joints_at(setting, leg, t)

    flange, axes = links(robot.arm, joints)
    T = drill.T_flange_tcp
    tool_axes = [[arb(float(x)) for x in T[:3, k]] for k in range(3)]
    tip, columns = asked(hole, drill, s, psi)
    reached = [flange[k, 3] + sum((flange[k, j] * float(T[j, 3]) for j in range(3)), arb(0)) for k in range(3)]
    for k in range(3):
        assert abs(reached[k] - tip[k]) < 1e-11  # the tool's own matrix is a rotation but for its rounding
        for axis, column in zip(tool_axes, columns, strict=True):
            assert abs(sum((flange[k, j] * axis[j] for j in range(3)), arb(0)) - column[k]) < 1e-14

    # the flange's origin and its turning, by the motion's own geometry
    z = columns[2]
    lever = [flange[k, 3] - tip[k] for k in range(3)]
    velocity = [z[k] + slope * cross(z, lever)[k] for k in range(3)]
    twist = velocity + [slope * z[k] for k in range(3)]
    J = [cross(axis, [flange[k, 3] - point[k] for k in range(3)]) + axis for axis, point in axes]
    expected = arb_mat(J).transpose().solve(arb_mat([[x] for x in twist]))
    for joint, inwards in enumerate(rates_at(setting, leg, t)):
        rate = -inwards
        assert abs(rate - expected[joint, 0]) < 1e-10 * max(1.0, float(abs(rate)))


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("part", ["leg", "blend"])
def test_series_are_the_derivatives(robot, drill, random_hole, seed, part):
    """The rates integrate to the joints: angles at two ends of a small step, and the series between them."""
    hole, profile, start = random_hole(robot, drill, seed)
    setting = Setting(robot.arm, posture_of(robot.arm, start))
    motion = planned_motion(robot.arm, drill, hole, profile, 1e-3)
    arc = motion.legs[0] if part == "leg" else motion.blends[0].arc
    begin, step = 0.25, 2.0**-10
    ctx.cap = 20
    pose, twist = arc.around(arb(begin), arb(1))
    series = rates(setting, body_at(setting, pose), twist)
    first, last = (joints_at(setting, arc, t) for t in (begin, begin + step))
    for a, b, rate in zip(first, last, series, strict=True):
        turned = sum((rate[k] * arb(step) ** (k + 1) / (k + 1) for k in range(20)), arb(0))
        assert abs(b - a - turned) < 1e-25


@pytest.mark.parametrize("seed", range(5))
def test_forwards_and_back(robot, drill, random_hole, seed):
    """Forward kinematics against the other link-by-link product."""
    _, _, start = random_hole(robot, drill, seed)
    joints = [arb(float(angle)) for angle in start]
    origin, columns = flange_at(robot.arm, joints)
    expected, _ = links(robot.arm, joints)
    for k in range(3):
        assert abs(origin[k] - expected[k, 3]) < 1e-50
        assert all(abs(columns[j][k] - expected[k, j]) < 1e-50 for j in range(3))


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("pieces", [1, 4, 64])
def test_a_piece_holds_every_rate_on_it(robot, drill, random_hole, seed, pieces):
    hole, profile, start = random_hole(robot, drill, seed)
    setting = Setting(robot.arm, posture_of(robot.arm, start))
    rng = np.random.default_rng(seed)
    enclosed = 0
    for arc in (*(motion := planned_motion(robot.arm, drill, hole, profile, 1e-3)).legs, motion.blends[0].arc):
        k = int(rng.integers(pieces))
        begin, end = k / pieces, (k + 1) / pieces
        piece = enclose(setting, arc, begin, end)
        if piece is None:
            continue
        enclosed += 1
        for t in (begin, end, *rng.uniform(begin, end, 20).tolist()):  # not NumPy's, which make floats of balls
            for joint, rate in enumerate(rates_at(setting, arc, t)):
                assert float(piece.low[joint]) <= rate <= float(piece.high[joint])
                for at, ends in ((begin, piece.first), (end, piece.last)):
                    if t == at:
                        assert float(ends[0, joint]) <= rate <= float(ends[1, joint])
        first, last = (joints_at(setting, arc, t) for t in (begin, end))
        for a, b, turned in zip(first, last, piece.turned, strict=True):
            assert (
                turned.overlaps(b - a) or turned.overlaps(b - a + 2 * arb.pi()) or turned.overlaps(b - a - 2 * arb.pi())
            )
    assert enclosed or pieces < 64


def test_no_piece_across_a_singularity(kuka, drill, random_hole):
    """Axis 5 goes through 0: the enclosures cannot be finite, however small the piece."""
    hole, profile, start = random_hole(kuka, drill, 0, joints_deg=(10, -80, 60, 20, 0.0005, 30), depth=0.01)
    posture = posture_of(kuka.arm, start)
    arc = planned_motion(kuka.arm, drill, hole, profile).legs[0]
    assert enclose(Setting(kuka.arm, posture), arc, 0.0, 1.0) is None


def test_postures(robot):
    rng = np.random.default_rng(1)
    for joints in rng.uniform(-2, 2, (20, 6)):
        posture = posture_of(robot.arm, joints)
        flipped = joints.copy()
        flipped[4] = -flipped[4]
        assert posture_of(robot.arm, flipped) == posture._replace(flip=-posture.flip)
    assert posture_of(robot.arm, np.zeros(6)) is None or robot.arm.offset[4] != 0


def test_the_precision_is_put_back():
    before = ctx.prec, ctx.cap
    with ball_arithmetic():
        ctx.cap = 3
        assert ctx.prec == 128
    assert (ctx.prec, ctx.cap) == before
