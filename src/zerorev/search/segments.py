"""Legs of a few straight segments, and how they are improved (theory §4); the work is done in `kernels.slp`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from zerorev.kernels import segments as kernels
from zerorev.kernels import slp
from zerorev.kernels.arm import twist_field
from zerorev.kernels.layout import Constraints, TwistPlane
from zerorev.model._arrays import Array
from zerorev.model.profile import Profile
from zerorev.model.robot import ArmGeometry

__all__ = ["Goal", "SegmentedLegs", "breakpoints_of", "improved", "legs_through", "motion_of", "sense_at"]

Goal = Literal["depth", "travel", "margin", "plunge_rotation"]
GOALS: dict[Goal, int] = {
    "depth": slp.DEPTH, "travel": slp.TRAVEL, "margin": slp.MARGIN, "plunge_rotation": slp.PLUNGE_ROTATION,
}  # fmt: skip

STEPS = 120
ENOUGH = 1e-6  # relative: a smaller gain does not count
EVENLY = 0.3  # of the breakpoints: as many for each length of the leg
BENT = 400  # points at which it is asked how much a leg bends, at least


@dataclass(frozen=True)
class SegmentedLegs:
    """Two legs of K segments each out of one point of the target line, on either side of the critical rates.

    Attributes:
        standoff: breakpoints from the target outwards [m], shape (2, K + 1); the last two are the same.
        psi: their spins [rad], shape (2, K + 1); the first two are the same.
    """

    standoff: Array
    psi: Array

    @property
    def depth(self) -> float:
        """Length of both [m]."""
        return float(self.standoff[0, -1])


def legs_through(tubes: list[Array], narrowed: list[Array], segments: int) -> SegmentedLegs:
    """Two legs through the middles of narrowed tubes.

    Args:
        tubes: rows of each, shape (rows, WIDTH).
        narrowed: what `kernels.segments.narrow` leaves of them, shape (rows, 2).
        segments: of each leg.
    """
    standoff, psi = np.empty((2, 2, segments + 1))
    for k, (tube, viable) in enumerate(zip(tubes, narrowed, strict=True)):
        knots = np.empty(segments + 1, dtype=np.int64)
        kernels.place_knots(tube, len(tube), viable, knots)
        standoff[k], psi[k] = tube[knots, 0], viable[knots].mean(axis=1)
    psi[:, 0] = psi[:, 0].mean()
    return SegmentedLegs(standoff, psi)


def motion_of(legs: SegmentedLegs, *, periodic: bool) -> Profile:
    """The motion of two legs; of the two twins the one that turns the tool less while it cuts (theory §2).

    Args:
        legs: the two.
        periodic: whether full turns of the tool do not matter: the spin at the target is then within (-pi, pi].
    """
    plunge, retract = np.argsort(np.abs(legs.psi[:, -1] - legs.psi[:, 0]), kind="stable")
    standoff = np.concatenate([legs.standoff[plunge, ::-1], legs.standoff[retract, 1:]])
    psi = np.concatenate([legs.psi[plunge, ::-1], legs.psi[retract, 1:]])
    if periodic:
        psi = psi - 2 * np.pi * np.ceil((legs.psi[0, 0] - np.pi) / (2 * np.pi))
    return Profile(standoff, psi)


def improved(
    arm: ArmGeometry,
    plane: TwistPlane,
    branch: int,
    sense: Array,
    rules: Constraints,
    legs: SegmentedLegs,
    goal: Goal,
    *,
    samples: int = 9,
    steps: int = STEPS,
    enough: float = ENOUGH,
    weighed: bool = False,
) -> tuple[SegmentedLegs, float]:
    """The best legs that small steps reach from these, and by how much they violate the constraints.

    Args:
        arm: of the robot.
        plane: of the hole.
        branch: 0..7.
        sense: signs of the outward rates of the first leg on the unflipped wrist, shape (6,).
        rules: what they are held to.
        legs: to begin with; they need not keep the rules.
        goal: `depth`: as deep as can be; the others keep the depth: least `travel`, greatest `margin`, or the least
            `plunge_rotation` of the two.
        samples: points of a segment at which the joints are examined.
        steps: at most.
        enough: less gain than this, relative, is none.
        weighed: see `kernels.slp.better`.

    Returns:
        legs; by how much a rate, or the room to a limit over the depth, lacks what is asked [rad/m], 0 or less where
        none does, inf where the legs to begin with cannot be run.
    """
    standoff, psi = legs.standoff.copy(), legs.psi.copy()
    shares = 0.5 - 0.5 * np.cos(np.linspace(0, np.pi, samples))
    lack = slp.better(arm, plane, branch, sense, rules, GOALS[goal], shares, steps, enough, weighed, standoff, psi)
    return SegmentedLegs(standoff, psi), float(lack)


def sense_at(arm: ArmGeometry, plane: TwistPlane, posture: int, psi_t: float) -> Array | None:
    """Signs of the outward rates of the first leg, out of a spin at the target; None where it is out of reach.

    Where no joint reverses, they are those of d theta / d psi: the first leg has the greater slope (theory §2).

    Args:
        arm: of the robot.
        plane: of the hole.
        posture: 0..3.
        psi_t: spin at the target [rad].

    Returns:
        on the unflipped wrist, shape (6,).
    """
    cs, theta_s, theta_psi = np.empty((6, 2)), np.empty(6), np.empty(6)
    if not twist_field(arm, plane, 0.0, psi_t, posture, cs, theta_s, theta_psi):
        return None
    return np.where(theta_psi > 0, 1.0, -1.0)


def breakpoints_of(standoff: Array, psi: Array, count: int) -> Array:
    """Shares of a leg at which segments meet: as many as the root of its bend asks for, and some evenly.

    What a segment loses against a curve is in proportion to its length times the change of the slope along it, so that
    with a given number the least is lost where both are balanced.

    Args:
        standoff: of a curve, from the target outwards [m], shape (n,).
        psi: its spins [rad], shape (n,).
        count: of segments.

    Returns:
        shares, 0 to 1, shape (count + 1,).
    """
    slope = np.diff(psi) / np.diff(standoff)
    bend = np.sqrt(np.abs(np.diff(slope)) / (0.5 * (standoff[2:] - standoff[:-2])))
    s = np.linspace(0.0, standoff[-1], max(BENT, 2 * count))
    dense = np.interp(s, standoff[1:-1], bend)
    dense = dense / max(dense.mean(), 1e-12) + EVENLY
    passed = np.append(0.0, np.cumsum(0.5 * (dense[1:] + dense[:-1])))
    share: Array = np.interp(np.linspace(0.0, passed[-1], count + 1), passed, s) / standoff[-1]
    return share
