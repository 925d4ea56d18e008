"""A box of legs at a stand-off, in ball arithmetic: the arm at its centre, and anywhere in it (theory §8.4).

A box is an interval of spins at the target and an interval of slopes, on one posture. At a given stand-off all of it is
a function of the spin there.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np
from flint import arb, arb_series, ctx

from zerorev.model.hole import Hole
from zerorev.model.proof_tree import Claim
from zerorev.model.robot import Robot
from zerorev.model.tool import Tool
from zerorev.verify.optimality.arm import Rates, arm_of, lifted, rates_at, root_of

__all__ = ["AROUND", "SIX", "Box", "Examiner", "Extent", "Look", "denominators", "smooth_denominators"]

AROUND = 2.0**-50  # [rad] added to either end of an interval of spins, so that 2 pi is closed
SIX = range(6)


class Box(NamedTuple):
    """Legs: interval of spins at the target [rad], interval of slopes [rad/m]."""

    low: float
    high: float
    least: float
    most: float


class Look(NamedTuple):
    """A box at a stand-off.

    Attributes:
        standoff: [m].
        centre: the arm at the centre of the box.
        whole: the arm anywhere in it; None: nothing is known of it.
        series: the same with derivatives by the spin; None: one of them may have no bound.
        beyond: whether all of the box is out of reach; then nothing else is known.
    """

    standoff: arb
    centre: Rates[arb] | None = None
    whole: Rates[arb] | None = None
    series: Rates[arb_series] | None = None
    beyond: bool = False


class Extent:
    """Centre and half widths of a box, in balls.

    Attributes:
        psi: spin at the centre, at the target [rad].
        psi_half: half width.
        slope: slope at the centre [rad/m].
        slope_half: half width.
        d_psi: how far a spin is off the centre's, as a ball about 0.
        d_slope: likewise a slope.
    """

    def __init__(self, box: Box) -> None:
        low, high, least, most = arb(box.low) - AROUND, arb(box.high) + AROUND, arb(box.least), arb(box.most)
        self.psi, self.psi_half = (low + high) / 2, (high - low) / 2
        self.slope, self.slope_half = (least + most) / 2, (most - least) / 2
        self.d_psi, self.d_slope = self.psi_half * arb(0, 1), self.slope_half * arb(0, 1)
        self.slopes = self.slope + self.d_slope

    def half_at(self, standoff: arb) -> arb:
        """How far a spin at a stand-off is off the centre's, at most [rad]."""
        return self.psi_half + standoff * self.slope_half


class Examiner:
    """One posture of a hole, and what is asked of its legs.

    Args:
        robot: the arm.
        tool: the drill.
        hole: the drill axis; its depth is that of the claim.
        claim: rules and value.
        posture: 0..3, branch // 2.

    Attributes:
        limits: of each joint in model angles, in turns, rounded to the nearest number.
        flips: the wrist flips that count; 0 is the one with sin q5 >= 0.
    """

    def __init__(self, robot: Robot, tool: Tool, hole: Hole, claim: Claim, posture: int) -> None:
        self.claim, self.posture = claim, posture
        self.nil, self.threshold, self.depth = arb(robot.nil_rate), arb(claim.min_rate), arb(claim.depth)
        self.arm = arm_of(robot.arm, tool, hole)
        self.lifted = lifted(self.arm)
        self.weights = [float(weight) for weight in claim.weights]
        sign, offset, limits, margin = robot.arm.sign, robot.arm.offset, robot.limits, claim.limit_margin
        ends = [
            sorted(
                float(end * int(sign[i]) - arb(offset[i]))
                for end in (arb(limits.lower[i]) + margin, arb(limits.upper[i]) - margin)
            )
            for i in SIX
        ]
        self.limits = [(lower / (2 * np.pi), upper / (2 * np.pi)) for lower, upper in ends]
        # where joint 5 is counted the other way, a controller's A5 < 0 has sin q5 > 0
        negative = sign[4] < 0
        self.flips = [f for f in range(2) if claim.branch is None or f == (claim.branch % 2) ^ negative]

    def cost(self, turns: Iterable[int]) -> float:
        """What so many turns of each joint cost."""
        return sum(weight * n for weight, n in zip(self.weights, turns, strict=True))

    def sample(self, extent: Extent, share: float) -> Look:
        """A box at a stand-off, given as a share of the depth."""
        standoff = self.depth * arb(share)
        psi, off = extent.psi + standoff * extent.slope, extent.half_at(standoff) * arb(0, 1)
        reach: list[arb] = []
        centre = rates_at(self.arm, self.posture, standoff, (psi.cos(), psi.sin()), root_of, reach)
        ctx.cap = 2
        spin = arb_series([psi + off, 1])
        squares: list[arb_series] = []
        try:
            turn = spin.cos(), spin.sin()
            series = rates_at(self.lifted, self.posture, arb_series([standoff]), turn, _smooth_root, squares)
        except ValueError:  # a root, or a divisor, may be zero
            series = None
        for square, middle in zip(squares, reach, strict=False):
            if square[0] < 0 or middle + square[1] * off < 0:
                return Look(standoff, beyond=True)
        if series is not None:
            return Look(standoff, centre, _values(series), series)
        reach = []
        whole = rates_at(self.arm, self.posture, standoff, _turned(psi + off), root_of, reach)
        if any(square < 0 for square in reach):
            return Look(standoff, beyond=True)
        return Look(standoff, centre, whole)

    def swept(self, extent: Extent, begin: arb, end: arb) -> list[arb]:
        """The greatest angle that each joint may move between two stand-offs [rad]."""
        standoff = begin.union(end)
        psi = extent.psi + extent.d_psi + standoff * extent.slopes
        at = rates_at(self.arm, self.posture, standoff, _turned(psi), root_of, [])
        pairs = zip(at.outwards, at.spinning, denominators(at), strict=True)
        return [abs((N + extent.slopes * M) / den) * (end - begin) for N, M, den in pairs]


def denominators(at: Rates[arb]) -> tuple[arb, ...]:
    """What the rates of the six joints are multiplied by."""
    part, full = at.height * root_of(at.sine_2), at.height * at.sine_2
    return arb(1), at.height, at.height, full, part, full


def smooth_denominators(at: Rates[arb_series]) -> tuple[arb_series, ...]:
    """The same with derivatives by the spin; ValueError where one of them may have none."""
    part, full = at.height * _smooth_root(at.sine_2), at.height * at.sine_2
    return arb_series([1, 0]), at.height, at.height, full, part, full


def _turned(psi: arb) -> tuple[arb, arb]:
    return psi.cos(), psi.sin()


def _smooth_root(x: arb_series) -> arb_series:
    if not x[0] > 0:
        raise ValueError("the root may have no derivative")
    return x.sqrt()


def _values(at: Rates[arb_series]) -> Rates[arb]:
    """The values without their derivatives."""

    def value(x: Any) -> Any:
        return x[0] if isinstance(x, arb_series) else tuple(map(value, x))

    return Rates(*map(value, at))
