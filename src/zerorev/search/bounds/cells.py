"""Rates on a cell of the twist plane, stand-offs times spins, as a formula of interval arithmetic (theory §4).

At one slope u_0 per joint, near its critical rate, N + u_0 M is enclosed in mean-value form in the spin and in the
stand-off, so that what N and M have in common cancels; M by itself says how that changes with the slope.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from zerorev.kernels import intervals as ops
from zerorev.kernels.layout import TwistPlane
from zerorev.model._arrays import Array
from zerorev.model.robot import ArmGeometry
from zerorev.search.bounds.expressions import Expression, Sheet, Tape, added
from zerorev.search.bounds.rates import PostureFormulas, numbers_of

__all__ = ["CellFormulas", "cell_formulas"]

Indices = npt.NDArray[np.int64]
INPUTS = ("cosine", "sine", "cosine_c", "sine_c", "standoff", "standoff_c", "one", "half_psi", "half_standoff")


class CellFormulas(NamedTuple):
    """The tape of one posture and the rows that it uses; a NamedTuple, so that kernels take it whole.

    Attributes:
        tape: shape (T, 5).
        constants: shape (C,).
        rows: room, shape (R, 2 * LANES).
        unknown: likewise, shape (4, LANES).
        inputs: rows to be filled in, shape (9,): cosine and sine, cosine and sine at the centre, stand-off, stand-off
            at the centre, 1, half widths of spin and of stand-off.
        slope: rows of one slope per joint, to be filled in, shape (6,).
        rate: rows of N + slope M, shape (6,); likewise:
        by_slope: of M.
        denominator: of what both are to be divided by.
        middle: of the angle at the centre; -1 where angles are not wanted; likewise:
        whole: of the angle anywhere.
        turning: of d theta / d psi.
        outward: of d theta / d s.
    """

    tape: Indices
    constants: Array
    rows: Array
    unknown: Array
    inputs: Indices
    slope: Indices
    rate: Indices
    by_slope: Indices
    denominator: Indices
    middle: Indices
    whole: Indices
    turning: Indices
    outward: Indices


@lru_cache(maxsize=64)
def _tape(posture: int, limited: tuple[bool, ...], zero: frozenset[str]) -> Tape:
    """Rates, denominators and, of the limited joints, angles of a cell."""
    sheet = Sheet()
    c, s = sheet.turning("cosine", "sine")
    cc, sc = sheet.input("cosine_c"), sheet.input("sine_c")
    standoff, standoff_c = sheet.moving("standoff", "one"), sheet.input("standoff_c")
    half_psi, half_standoff = sheet.input("half_psi"), sheet.input("half_standoff")
    arm, joints = PostureFormulas(sheet, posture, zero), any(limited)
    cell = arm.at(c, s, standoff, ops.OUT_OF_REACH, joints=joints)
    centre = arm.at(cc, sc, standoff_c, ops.NOWHERE, joints=joints)
    out: dict[str, Expression] = {}

    def enclosed(
        natural: Expression, middle: Expression, by_psi: Expression | None, by_s: Expression | None
    ) -> Expression:
        """What the mean-value form and plain arithmetic have in common."""
        for slope, half in ((by_psi, half_psi), (by_s, half_standoff)):
            if slope is not None:
                middle = middle.spread(slope, half)
        return natural.met(middle)

    def along(u: Expression, dN: Expression | None, dM: Expression | None) -> Expression | None:
        return added(dN, None if dM is None else u * dM)

    for i in range(6):
        u = sheet.input(f"slope{i}")
        N, M, den, Nc, Mc = cell.N[i], cell.M[i], cell.den[i], centre.N[i], centre.M[i]
        by_psi, by_s = sheet.slope(M), sheet.outward_slope(M)
        out[f"rate{i}"] = enclosed(
            N + u * M, Nc + u * Mc, along(u, sheet.slope(N), by_psi), along(u, sheet.outward_slope(N), by_s)
        )
        out[f"by_slope{i}"], out[f"denominator{i}"] = enclosed(M, Mc, by_psi, by_s), den
        if limited[i]:
            out[f"turning{i}"], out[f"outward{i}"] = M.over(den), N.over(den)
            out[f"whole{i}"], out[f"middle{i}"] = (
                cosine.arc(sine) for cosine, sine in (cell.joints[i], centre.joints[i])
            )
    return sheet.compiled(out)


def cell_formulas(arm: ArmGeometry, plane: TwistPlane, posture: int, limited: tuple[bool, ...]) -> CellFormulas:
    """The tape of one posture.

    Args:
        arm: of the robot.
        plane: of the hole.
        posture: 0..3.
        limited: of which joints the angles are wanted.
    """
    numbers = numbers_of(arm, plane)
    tape = _tape(posture, limited, frozenset(name for name, value in numbers.items() if value == 0.0))

    def rows(name: str) -> Indices:
        return np.array([tape.outputs.get(f"{name}{i}", -1) for i in range(6)], dtype=np.int64)

    return CellFormulas(
        tape=tape.code,
        constants=np.array(tape.values(numbers)),
        rows=np.zeros((tape.rows, 2 * ops.LANES)),
        unknown=np.zeros((4, ops.LANES)),
        inputs=np.array([tape.inputs[name] for name in INPUTS], dtype=np.int64),
        slope=np.array([tape.inputs[f"slope{i}"] for i in range(6)], dtype=np.int64),
        rate=rows("rate"),
        by_slope=rows("by_slope"),
        denominator=rows("denominator"),
        middle=rows("middle"),
        whole=rows("whole"),
        turning=rows("turning"),
        outward=rows("outward"),
    )
