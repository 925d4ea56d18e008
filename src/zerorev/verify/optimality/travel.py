"""How far the joints of a box of legs travel at least, and with which turns they fit their limits (theory §8.4)."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from flint import arb

from zerorev.verify.optimality.arm import Directions, directions
from zerorev.verify.optimality.box import SIX, Examiner, Extent, Look, denominators

__all__ = ["ANY_TURN", "Travel", "Turns", "travel_of"]

ANY_TURN = (-100, 100)
NO_TURN = (1, 0)
ROUNDING = 1e-9  # [turns] more than the rounding of what limits are compared with
STEEP = 0.02  # [rad] if a joint may vary by more over the box, its direction is tried, too

Turns = tuple[tuple[int, int], ...]


class Travel(NamedTuple):
    """Travel and limits of a box.

    Attributes:
        least: no leg at the centre travels less [rad].
        by_psi: derivative of a lower bound of the travel by the spin.
        by_slope: likewise by the slope [m].
        turns: least and greatest multiple of a turn with which each joint may lie within its limits, counted from where
            it is at the centre, at the target; on either flip.
    """

    least: arb
    by_psi: arb
    by_slope: arb
    turns: tuple[Turns, Turns]


class _Angle(NamedTuple):
    """A joint at a stand-off, in model angles [rad].

    Over the box it is within `by_psi` times the change of the spin, and `off`, of `at`; or, regardless of the spin,
    within `radius` of it.
    """

    at: arb
    by_psi: arb
    off: arb
    radius: arb


NOWHERE = _Angle(arb(0), arb(0), arb.pos_inf(), arb.pos_inf())


def travel_of(of: Examiner, extent: Extent, samples: Sequence[Look]) -> Travel:
    """Travel and limits, from samples of a box in the order of their stand-offs."""
    columns = [_angles(of, extent, sample) for sample in samples]
    s = [sample.standoff for sample in samples]
    swept = [of.swept(extent, a, b) for a, b in pairwise(s)]
    turns: tuple[list[tuple[int, int]], list[tuple[int, int]]] = ([], [])
    least, by_psi, by_slope = arb(0), arb(0), arb(0)
    for i in SIX:
        angles = [column[i] for column in columns]
        followed, linked, factors = [angles[0].at], True, [0] * len(s)
        for j in range(1, len(s)):
            a, b = angles[j - 1], angles[j]
            step = b.at - a.at
            step -= 2 * arb.pi() * _whole(step)
            change = (b.by_psi - a.by_psi) * extent.d_psi + (s[j] * b.by_psi - s[j - 1] * a.by_psi) * extent.d_slope
            wide = (change.abs_upper() + a.off + b.off).min(a.radius + b.radius)
            # between any two places a joint moves by the shorter way at least
            clear = abs(step) + wide < arb.pi()
            linked = bool(linked and clear and swept[j - 1][i] < arb.pi())
            if linked:
                followed.append(followed[-1] + step)
            if clear and abs(step) > wide:
                direction = 1 if step > 0 else -1
                least += abs(step)
                factors[j] += direction
                factors[j - 1] -= direction
        for factor, angle, standoff in zip(factors, angles, s, strict=True):
            if factor:
                least -= abs(factor) * angle.off
                by_psi += factor * angle.by_psi
                by_slope += factor * standoff * angle.by_psi
        for flip in range(2):
            turns[flip].append(_fitting(of.limits[i], i, flip, angles, followed))
    return Travel(least, by_psi, by_slope, (tuple(turns[0]), tuple(turns[1])))


def _fitting(
    limits: tuple[float, float], i: int, flip: int, angles: Sequence[_Angle], followed: Sequence[arb]
) -> tuple[int, int]:
    """Least and greatest multiple of a turn with which a joint may lie within its limits; least > greatest: none.

    As far as it can be followed it is the same multiple throughout; beyond, each place counts by itself.
    """
    least, most = ANY_TURN
    for j, angle in enumerate(angles):
        at = followed[j] if j < len(followed) else angle.at
        if flip and i >= 3:
            at = -at if i == 4 else at + arb.pi()
        low = float(((at - angle.radius) / (2 * arb.pi())).lower())
        high = float(((at + angle.radius) / (2 * arb.pi())).upper())
        if not (np.isfinite(low) and np.isfinite(high)):
            continue
        first, last = int(np.ceil(limits[0] - high - ROUNDING)), int(np.floor(limits[1] - low + ROUNDING))
        if first > last:
            return NO_TURN
        if j < len(followed):
            least, most = max(least, first), min(most, last)
    return least, most


def _angles(of: Examiner, extent: Extent, sample: Look) -> list[_Angle]:
    """The joints at a stand-off."""
    centre, whole = sample.centre, sample.whole
    if centre is None or whole is None:
        return [NOWHERE] * 6
    half = extent.half_at(sample.standoff)
    psi = extent.psi + sample.standoff * extent.slope
    there = directions(of.arm, (psi.cos(), psi.sin()), centre)
    by_psi = [M / den for M, den in zip(whole.spinning, denominators(whole), strict=True)]
    steepness = [(slope * half).abs_upper() for slope in by_psi]
    anywhere = None
    if not all(varies < STEEP for varies in steepness):
        spun = psi + half * arb(0, 1)
        anywhere = directions(of.arm, (spun.cos(), spun.sin()), whole)
        # a centre that is out of reach has no joints: any other direction of the box suffices
        there = [
            one if one[0].is_finite() and one[1].is_finite() else (other[0].mid(), other[1].mid())
            for one, other in zip(there, anywhere, strict=True)
        ]
    middle = [_angle(sine, cosine) for cosine, sine in there]
    middle[2] = middle[2] - middle[1]
    reached = centre.height.is_finite()
    return [
        _angle_of(i, middle[i], by_psi[i], steepness[i] if reached or i == 0 else arb.pos_inf(), there, anywhere)
        for i in SIX
    ]


def _angle_of(i: int, middle: arb, by_psi: arb, varies: arb, there: Directions, anywhere: Directions | None) -> _Angle:
    """A joint by its derivative, or where that is steep by its direction, whichever tells more."""
    if not middle.is_finite():
        return NOWHERE
    angle = _Angle(middle, by_psi, arb(0), varies) if varies.is_finite() else NOWHERE
    if varies < STEEP or anywhere is None:
        return angle
    off = sum((_between(there[k], anywhere[k]) for k in ((1, 2) if i == 2 else (i,))), arb(0))
    nearer = off < varies / 2 or (off.is_finite() and not varies.is_finite())
    return _Angle(middle, arb(0), off, off) if nearer else angle


def _between(one: tuple[arb, arb], other: tuple[arb, arb]) -> arb:
    """The greatest angle between a direction and a set of them [rad]; infinite where that may be a quarter turn."""
    (c, s), (C, S) = one, other
    ahead, aside = C * c + S * s, S * c - C * s
    return (aside / ahead).atan().abs_upper() if ahead > 0 else arb.pos_inf()


def _angle(sine: arb, cosine: arb) -> arb:
    """The angle of a direction; tight also where that is half a turn."""
    return arb.atan2(-sine, -cosine) + arb.pi() if cosine < 0 else arb.atan2(sine, cosine)


def _whole(angle: arb) -> int:
    """The number of turns next to an angle, or one beside it where two are as near."""
    turns = float(angle) / (2 * np.pi)
    return round(turns) if np.isfinite(turns) else 0
