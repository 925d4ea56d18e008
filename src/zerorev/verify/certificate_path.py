"""The motion as arcs: stand-off and spin as polynomials of a parameter in [0, 1], in ball arithmetic.

A piece of a leg is linear in both; a blend is the quadratic Bezier curve of `zerorev.verify.path.blend`.
"""

from __future__ import annotations

from typing import NamedTuple

from flint import arb, arb_series

from zerorev.model.profile import Profile

__all__ = ["Arc", "Blend", "Motion", "motion_of"]

Quadratic = tuple[arb, arb, arb]
Point = tuple[arb, arb]


class Arc(NamedTuple):
    """A part of the motion, run through as its parameter t grows from 0 to 1.

    Attributes:
        where: `on the plunge`, `on the retract`, `in the blended corner` or the like.
        standoff: coefficients of 1, t and t^2 [m].
        psi: the same of the spin [rad].
        length: path by which rates are counted [m]; of a blend, that of the two bits of leg which it replaces.
        knot: index of the profile's breakpoint at t = 1, or None where there is none.
    """

    where: str
    standoff: Quadratic
    psi: Quadratic
    length: arb
    knot: int | None = None

    def around(self, t: arb, half: arb) -> tuple[arb_series, arb_series, arb_series, arb_series]:
        """Stand-off, spin and their derivatives as series in x, where the parameter is t + half x."""
        value, rate = [], []
        for c0, c1, c2 in (self.standoff, self.psi):
            slope, bend = (c1 + 2 * t * c2) * half, c2 * half * half
            value.append(arb_series([c0 + t * (c1 + t * c2), slope, bend]))
            rate.append(arb_series([slope, 2 * bend]))
        return value[0], value[1], rate[0], rate[1]

    def at(self, t: float) -> Point:
        """Stand-off [m] and spin [rad] at the parameter t."""
        (s0, s1, s2), (p0, p1, p2) = self.standoff, self.psi
        return s0 + t * (s1 + t * s2), p0 + t * (p1 + t * p2)

    def place(self, t: float) -> str:
        """Where the parameter t lies, for a message."""
        return f"{self.where}, stand-off {round(float(self.at(t)[0]) * 1e3, 9) + 0.0:.12g} mm"


class Blend(NamedTuple):
    """A breakpoint cut by a parabola.

    Attributes:
        arc: the parabola.
        first: index in the motion's `legs` of the bit ending at the breakpoint; the parabola replaces it and the next.
    """

    arc: Arc
    first: int


class Motion(NamedTuple):
    """A whole motion.

    Attributes:
        legs: in order of motion, each beginning where the one before ends.
        blends: the blended breakpoints.
        turn: how many of `legs` lie on the plunge.
    """

    legs: list[Arc]
    blends: list[Blend]
    turn: int

    @property
    def leg_lengths(self) -> tuple[float, float]:
        """Path of the plunge and of the retract [m]."""
        lengths = [float(arc.length) for arc in self.legs]
        return sum(lengths[: self.turn]), sum(lengths[self.turn :])


def motion_of(profile: Profile, radius: float, passing: float) -> Motion:
    """The legs of a profile, and its inner breakpoints cut by parabolas (theory §5).

    Args:
        profile: spin along the path.
        radius: of the blend at the corner [m], clipped to half the shorter of the two segments; 0 for none.
        passing: the same at the other inner breakpoints.
    """
    knots = [(arb(float(s)), arb(float(psi))) for s, psi in zip(profile.standoff, profile.psi, strict=True)]
    legs: list[Arc] = []
    blends: list[Blend] = []
    here, turn = knots[0], 0
    for k in range(1, len(knots)):
        leg = "on the plunge" if k <= profile.corner else "on the retract"
        behind = "on the plunge" if k < profile.corner else "on the retract"
        size = radius if k == profile.corner else passing
        if size > 0 and k < len(knots) - 1:
            before, knot, after = knots[k - 1 : k + 2]
            cut = arb(size).min(abs(before[0] - knot[0]) / 2).min(abs(after[0] - knot[0]) / 2)
            entry, leave = _towards(knot, before, cut), _towards(knot, after, cut)
            if abs(entry[0] - here[0]) > 0:  # else the blend before ends where this one begins
                legs.append(_line(leg, here, entry))
            where = "in the blended corner" if k == profile.corner else f"in the blend at breakpoint {k + 1}"
            blends.append(Blend(_parabola(where, entry, knot, leave, 2 * cut), len(legs)))
            legs += [_line(leg, entry, knot, k), _line(behind, knot, leave)]
            here = leave
        else:
            legs.append(_line(leg, here, knots[k], k))
            here = knots[k]
        if k == profile.corner:
            turn = next(i for i, arc in enumerate(legs) if arc.knot == k) + 1
    return Motion(legs, blends, turn)


def _towards(knot: Point, end: Point, distance: arb) -> Point:
    share = distance / abs(end[0] - knot[0])
    return knot[0] + (end[0] - knot[0]) * share, knot[1] + (end[1] - knot[1]) * share


def _line(where: str, begin: Point, end: Point, knot: int | None = None) -> Arc:
    standoff, psi = ((a, b - a, arb(0)) for a, b in zip(begin, end, strict=True))
    return Arc(where, standoff, psi, abs(standoff[1]), knot)


def _parabola(where: str, entry: Point, knot: Point, leave: Point, length: arb) -> Arc:
    standoff, psi = ((a, 2 * (b - a), a - 2 * b + c) for a, b, c in zip(entry, knot, leave, strict=True))
    return Arc(where, standoff, psi, length)
