"""The joints' rates on a box of legs, without division, as a formula of interval arithmetic (theory §3).

With A the distance of the wrist centre from axis 1 (in the arm's plane), B = |Delta| and S5 the sine of joint 5, all of
them known not to be negative, rate_i = (N_i + u M_i) / den_i, and so the conditions on a rate become conditions on

    N_i + u M_i - m den_i,

which is finite and continuous at every singularity and at the edge of reach. Everything is in model angles: the signs
and offsets of the controller's counting are left to whoever asks.
"""

from __future__ import annotations

from decimal import Decimal, localcontext
from functools import lru_cache
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from zerorev.kernels import intervals as ops
from zerorev.kernels.layout import TwistPlane
from zerorev.model._arrays import Array
from zerorev.model.robot import ArmGeometry
from zerorev.search.bounds.expressions import Expression, Number, Sheet, Tape, added

__all__ = ["Formulas", "PostureFormulas", "formulas", "numbers_of"]

DIGITS = 50
Indices = npt.NDArray[np.int64]


class Formulas(NamedTuple):
    """The tapes of one posture and the rows that they use; a NamedTuple, so that kernels take it whole.

    Attributes:
        posture: 0..3.
        signs: the tape of rates and conditions, shape (T, 5).
        angles: the same with the angles, shape (T', 5).
        sweep: the tape of rates over a stretch of stand-offs, shape (T'', 5).
        constants: of the three tapes, which follow each other, shape (C,).
        starts: where each tape's constants start, shape (4,).
        rows: room for `signs` and `angles`, shape (R, 2 * LANES).
        unknown: likewise, shape (4, LANES).
        sweep_rows: room for `sweep`, shape (R', 2 * LANES).
        sweep_unknown: likewise, shape (4, LANES).
        inputs: rows of `signs`, `angles`, `sweep` to be filled in, shape (3, 10): cosine, sine, cosine and sine at the
            centre, stand-off, slope, slope at the centre, half widths of spin and of slope, threshold.
        rate: rows of the rate times its denominator, shape (2, 6), of `signs` and `angles`; likewise:
        denominator: of the rate.
        plus: of what the rate has above the threshold, times the denominator.
        minus: of what the opposite rate has above it.
        rate_middle: rows of the rate times its denominator at the centre, of `angles`, shape (6,); likewise:
        rate_psi: of its derivative by the spin.
        rate_slope: of that by the slope.
        denominator_middle: of the denominator at the centre.
        denominator_psi: of its derivative by the spin.
        middle: of the angles at the centre.
        whole: of the angles anywhere.
        turning: of d theta / d psi.
        swept: rows of the rates, of `sweep`, shape (6,).
    """

    posture: int
    signs: Indices
    angles: Indices
    sweep: Indices
    constants: Array
    starts: Indices
    rows: Array
    unknown: Array
    sweep_rows: Array
    sweep_unknown: Array
    inputs: Indices
    rate: Indices
    denominator: Indices
    plus: Indices
    minus: Indices
    rate_middle: Indices
    rate_psi: Indices
    rate_slope: Indices
    denominator_middle: Indices
    denominator_psi: Indices
    middle: Indices
    whole: Indices
    turning: Indices
    swept: Indices


INPUTS = ("cosine", "sine", "cosine_c", "sine_c", "standoff", "slope", "slope_c", "half_psi", "half_slope", "threshold")


def numbers_of(arm: ArmGeometry, plane: TwistPlane) -> dict[str, float]:
    """Constants of a hole, each the double nearest to its exact value.

    z: drill axis, out of the material; foot: wrist centre at stand-off 0 without its lever [m]; leverc, levers: cosine
    and sine part of the lever of the spin [m]; fj, fjc, fjs: constant, cosine and sine part of the flange's column j;
    each with the number of a coordinate. k is the length of the forearm, from elbow to wrist centre.
    """
    with localcontext() as context:
        context.prec = DIGITS
        R = [Decimal(x) for x in plane.R_base_tcp0]
        F = [Decimal(x) for x in plane.R_tcp_flange]
        w, t = [Decimal(x) for x in plane.wrist], [Decimal(x) for x in plane.target]
        x, y, z = R[0::3], R[1::3], R[2::3]
        a1, a2, b, c1, c2, c3 = (Decimal(v) for v in (arm.a1, arm.a2, arm.b, arm.c1, arm.c2, arm.c3))
        k = (a2 * a2 + c3 * c3).sqrt()
        exact = {
            "a1": a1, "b": b, "b2": b * b, "c1": c1, "c2": c2, "k": k, "links2": c2 * c2 + k * k,
            "per_links": 1 / (2 * c2 * k), "c2k": c2 * k, "a2/k2": a2 / k**2, "c3/k2": c3 / k**2, "a2/k": a2 / k,
            "c3/k": c3 / k,
        }  # fmt: skip
        for i in range(3):
            exact[f"z{i}"], exact[f"foot{i}"] = z[i], t[i] + w[2] * z[i]
            exact[f"leverc{i}"], exact[f"levers{i}"] = x[i] * w[0] + y[i] * w[1], y[i] * w[0] - x[i] * w[1]
            for j in range(3):
                v = F[j::3]
                exact[f"f{j}{i}"] = z[i] * v[2]
                exact[f"f{j}c{i}"], exact[f"f{j}s{i}"] = x[i] * v[0] + y[i] * v[1], y[i] * v[0] - x[i] * v[1]
        return {name: float(value) for name, value in exact.items()}


class _Point(NamedTuple):
    """Rates and joints at one place, as expressions."""

    N: list[Expression]
    M: list[Expression]
    den: list[Expression]
    joints: list[tuple[Expression, Expression]]  # cosine and sine of each model angle, up to a common factor


class PostureFormulas:
    """The formulas of a posture; `zero` names the constants that are 0."""

    def __init__(self, sheet: Sheet, posture: int, zero: frozenset[str]) -> None:
        self.sheet, self.zero = sheet, zero
        self.ahead = -1.0 if posture >= 2 else 1.0
        self.bend = -1.0 if (posture % 2 == 1) != (posture >= 2) else 1.0

    def sum(self, *terms: tuple[Number, Expression], constant: Number | None = None) -> Expression:
        """A sum of multiples and a constant; 0 where all of them are."""
        total = None
        for factor, term in terms:
            if factor.name not in self.zero:
                total = factor * term if total is None else total + factor * term
        total = 0.0 * terms[0][1] if total is None else total
        return total if constant is None or constant.name in self.zero else total + constant

    def at(self, c: Expression, s: Expression, standoff: Expression, reach: int, *, joints: bool) -> _Point:
        """Everything at a spin, given by its cosine and sine, and a stand-off.

        Args:
            c: cosine of the spin.
            s: sine of the spin.
            standoff: [m].
            reach: the row of `unknown` in which lanes that are out of reach are marked.
            joints: whether the joints are wanted, too.
        """
        total, ahead, bend, N = self.sum, self.ahead, self.bend, Number
        r = [total((N(f"leverc{i}"), c), (N(f"levers{i}"), s)) for i in range(3)]
        wx, wy, wz = (r[i] + total((N(f"z{i}"), standoff), constant=N(f"foot{i}")) for i in range(3))
        squared = wx.squared() + wy.squared()
        offset = "b" not in self.zero
        A = (squared + -N("b2") if offset else squared).root(reach)
        if offset:
            x_turned = ahead * A
            c1 = (wx * x_turned + N("b") * wy).ratio(squared)
            s1 = (wy * x_turned - N("b") * wx).ratio(squared)
        else:
            c1, s1 = (ahead * wx).ratio(A), (ahead * wy).ratio(A)
        x = ahead * A if "a1" in self.zero else ahead * A + -N("a1")
        z = wz if "c1" in self.zero else wz + -N("c1")
        reach2 = x.squared() + z.squared()
        cos_phi = N("per_links") * (reach2 + -N("links2"))
        bent = (-cos_phi.squared() + 1.0).root(reach)  # |sin phi|
        cos_phi = cos_phi.clipped()
        B = N("c2k") * bent
        past, across = N("k") * cos_phi + N("c2"), N("k", bend) * bent
        c2, s2 = (past * z + across * x).ratio(reach2), (past * x - across * z).ratio(reach2)
        ux, uz = N("c2") * s2, N("c2") * c2
        lx, lz = x - ux, z - uz
        c23 = total((N("a2/k2"), lx), (N("c3/k2"), lz)).clipped()
        s23 = total((N("c3/k2"), lx), (-N("a2/k2"), lz)).clipped()

        def column(j: int) -> list[Expression]:
            return [total((N(f"f{j}c{i}"), c), (N(f"f{j}s{i}"), s), constant=N(f"f{j}{i}")) for i in range(3)]

        ax, ay, az = column(2)
        forward = c1 * ax + s1 * ay
        m0, m1 = c23 * forward - s23 * az, c1 * ay - s1 * ax
        c5 = (s23 * forward + c23 * az).clipped()
        s5_squared = m0.squared() + m1.squared()
        s5 = s5_squared.root(ops.NOWHERE)
        AB = A * B
        zx, zy, zz = (N(f"z{i}") for i in range(3))
        sides, turned = total((zy, c1), (-zx, s1)), total((zx, c1), (zy, s1))
        fields = []
        for spinning in (False, True):
            if spinning:
                vx, vy, vz = (
                    total((zy, r[2]), (-zz, r[1])),
                    total((zz, r[0]), (-zx, r[2])),
                    total((zx, r[1]), (-zy, r[0])),
                )
                n1, dx = c1 * vy - s1 * vx, c1 * vx + s1 * vy
                rise_x, rise_z = lz * vz, uz * vz
            else:
                n1, dx = sides, turned
                rise_x, rise_z = total((zz, lz)), total((zz, uz))
            n1 = ahead * n1
            if offset:
                dx = dx + N("b") * self.sheet.divided(n1, A)
            # q2 = Q2 / B, q2 + q3 = Q23 / B
            Q2, Q23 = bend * (lx * dx + rise_x), -bend * (ux * dx + rise_z)
            if spinning:
                less = total((zz, A)) - n1
                ox, oy, oz = c23 * (turned * A) - s23 * less, sides * B - Q23, s23 * (turned * A) + c23 * less
            else:
                ox, oy, oz = s23 * n1, -Q23, -(c23 * n1)
            ox, oy = ox * B, oy * A
            H = m0 * ox + m1 * oy
            fields.append([n1, Q2, Q23 - Q2, (oz * B) * s5_squared - c5 * H, m0 * oy - m1 * ox, H])
        # derivatives by way of the rates repeat fewer quantities than those of the formulas above, so they are tighter
        q1, q2, q23 = (self.sheet.slope_divided(top, den) for top, den in ((n1, A), (Q2, B), (Q23, B)))
        self.sheet.slopes[A.number] = ahead * dx
        for cosine, sine, turning in ((c1, s1, q1), (c2, s2, q2), (c23, s23, q23)):
            self.sheet.slopes[cosine.number], self.sheet.slopes[sine.number] = -(sine * turning), cosine * turning
        den = [A, B, B, AB * s5_squared, AB * s5, AB * s5_squared]
        places: list[tuple[Expression, Expression]] = []
        if joints:
            first, second = column(0), column(1)
            g = [c1 * one[0] + s1 * one[1] for one in (first, second)]
            h = [c1 * one[1] - s1 * one[0] for one in (first, second)]
            c6 = m0 * h[1] - m1 * (c23 * g[1] - s23 * second[2])
            s6 = m0 * h[0] - m1 * (c23 * g[0] - s23 * first[2])
            # q3 is phi less the angle of the forearm's offset a2
            sin_phi = bend * bent
            c3 = total((N("c3/k"), cos_phi), (N("a2/k"), sin_phi))
            s3 = total((N("c3/k"), sin_phi), (-N("a2/k"), cos_phi))
            places = [(c1, s1), (c2, s2), (c3, s3), (m0, m1), (c5, s5), (c6, s6)]
        return _Point(fields[0], fields[1], den, places)


@lru_cache(maxsize=64)
def _tape(posture: int, threshold: bool, angles: bool, zero: frozenset[str]) -> Tape:
    """Rates, denominators and conditions of a box; with `angles` the joints, too."""
    sheet = Sheet()
    c, s = sheet.turning("cosine", "sine")
    cc, sc, standoff, u, uc, half_psi, half_slope, m = (sheet.input(name) for name in INPUTS[2:])
    arm = PostureFormulas(sheet, posture, zero)
    box = arm.at(c, s, standoff, ops.OUT_OF_REACH, joints=angles)
    centre = arm.at(cc, sc, standoff, ops.NOWHERE, joints=angles)
    out: dict[str, Expression] = {}

    def enclosed(
        natural: Expression, middle: Expression, by_psi: Expression | None, by_slope: Expression
    ) -> Expression:
        """What the mean-value form and plain arithmetic have in common."""
        if by_psi is not None:
            middle = middle.spread(by_psi, half_psi)
        return natural.met(middle.spread(by_slope, half_slope))

    for i in range(6):
        N, M, den, Nc, Mc, denc = (part[i] for part in (box.N, box.M, box.den, centre.N, centre.M, centre.den))
        dN, dM, dden = sheet.slope(N), sheet.slope(M), sheet.slope(den)
        natural, middle = N + u * M, Nc + uc * Mc
        by_psi = added(dN, None if dM is None else u * dM)
        by_slope = M if by_psi is None else M + standoff * by_psi
        out[f"rate{i}"], out[f"denominator{i}"] = enclosed(natural, middle, by_psi, by_slope), den
        if threshold:
            least, least_c, dleast = m * den, m * denc, None if dden is None else m * dden
            for name, sign in (("plus", 1.0), ("minus", -1.0)):
                by = added(None if by_psi is None else sign * by_psi, None if dleast is None else -dleast)
                by_u = sign * by_slope if dleast is None else sign * by_slope - standoff * dleast
                out[f"{name}{i}"] = enclosed(sign * natural - least, sign * middle - least_c, by, by_u)
        if angles:
            still = 0.0 * den
            out[f"rate_middle{i}"], out[f"denominator_middle{i}"] = middle, denc
            out[f"rate_psi{i}"], out[f"rate_slope{i}"] = by_psi or still, by_slope
            out[f"denominator_psi{i}"] = dden or still
            out[f"turning{i}"] = M.over(den)
            out[f"whole{i}"], out[f"middle{i}"] = (
                cosine.arc(sine) for cosine, sine in (box.joints[i], centre.joints[i])
            )
    return sheet.compiled(out)


@lru_cache(maxsize=16)
def _swept(posture: int, zero: frozenset[str]) -> Tape:
    """Rates over a stretch of stand-offs."""
    sheet = Sheet()
    c, s = sheet.turning("cosine", "sine")
    standoff, u = sheet.input("standoff"), sheet.input("slope")
    point = PostureFormulas(sheet, posture, zero).at(c, s, standoff, ops.NOWHERE, joints=False)
    return sheet.compiled(
        {f"swept{i}": (N + u * M).over(den) for i, (N, M, den) in enumerate(zip(*point[:3], strict=True))}
    )


def formulas(arm: ArmGeometry, plane: TwistPlane, posture: int, *, threshold: bool) -> Formulas:
    """The tapes of one posture.

    Args:
        arm: of the robot.
        plane: of the hole.
        posture: 0..3.
        threshold: whether there is a motion threshold.
    """
    numbers = numbers_of(arm, plane)
    zero = frozenset(name for name, value in numbers.items() if value == 0.0)
    signs, angles = _tape(posture, threshold, False, zero), _tape(posture, threshold, True, zero)
    sweep = _swept(posture, zero)
    tapes = [signs, angles, sweep]
    constants = [tape.values(numbers) for tape in tapes]

    def rows(name: str, of: list[Tape]) -> Indices:
        return np.array([[tape.outputs.get(f"{name}{i}", -1) for i in range(6)] for tape in of], dtype=np.int64)

    return Formulas(
        posture=posture,
        signs=signs.code,
        angles=angles.code,
        sweep=sweep.code,
        constants=np.concatenate(constants),
        starts=np.cumsum([0, *map(len, constants)]).astype(np.int64),
        rows=np.zeros((max(signs.rows, angles.rows), 2 * ops.LANES)),
        unknown=np.zeros((4, ops.LANES)),
        sweep_rows=np.zeros((sweep.rows, 2 * ops.LANES)),
        sweep_unknown=np.zeros((4, ops.LANES)),
        inputs=np.array([[tape.inputs.get(name, -1) for name in INPUTS] for tape in tapes], dtype=np.int64),
        rate=rows("rate", [signs, angles]),
        denominator=rows("denominator", [signs, angles]),
        plus=rows("plus", [signs, angles]),
        minus=rows("minus", [signs, angles]),
        rate_middle=rows("rate_middle", [angles])[0],
        rate_psi=rows("rate_psi", [angles])[0],
        rate_slope=rows("rate_slope", [angles])[0],
        denominator_middle=rows("denominator_middle", [angles])[0],
        denominator_psi=rows("denominator_psi", [angles])[0],
        middle=rows("middle", [angles])[0],
        whole=rows("whole", [angles])[0],
        turning=rows("turning", [angles])[0],
        swept=rows("swept", [sweep])[0],
    )
