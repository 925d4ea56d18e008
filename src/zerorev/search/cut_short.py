"""Motions made of a deeper one: cut to a lesser depth, which keeps every direction, and descended from there."""

from __future__ import annotations

import numpy as np

from zerorev.kinematics import joint_rates, twist_plane
from zerorev.model.profile import Profile
from zerorev.search.rank import Candidate, Order
from zerorev.search.segments import Legs, Rules, bettered, motion_of
from zerorev.search.straight import LEAST_RATE, LIMIT_SLACK

__all__ = ["cut_short", "descended", "legs_swapped"]

POINTS = 33  # of a leg at which the joints are examined
ENOUGH_LACK = 1e-6  # [rad/m]
GUARDS = tuple((LEAST_RATE * np.array([0.0, 10.0, 1e4, 1e6])).tolist())  # [rad/m] for what lies between them


def cut_short(profile: Profile, depth: float) -> Profile:
    """The inner part of a motion: the same spins, from a lesser depth on.

    Args:
        profile: of a motion that is as deep as `depth`, or deeper.
        depth: [m].
    """
    plunge, retract = slice(profile.corner, None, -1), slice(profile.corner, None)
    standoff, psi = [], []
    for leg in (plunge, retract):
        s, spin = profile.standoff[leg], profile.psi[leg]
        inner = s < depth * (1 - 1e-9)  # no segment that is only rounding
        standoff.append(np.append(s[inner], depth))
        psi.append(np.append(spin[inner], np.interp(depth, s, spin)))
    return Profile(
        np.concatenate([standoff[0][:0:-1], standoff[1]]),
        np.concatenate([psi[0][:0:-1], psi[1]]),
    )


def legs_swapped(profile: Profile) -> Profile:
    """The same motion run backwards: the mirror law gives it the same reversals and travel (theory §7)."""
    return Profile(profile.standoff[::-1].copy(), profile.psi[::-1].copy())


def descended(order: Order, motion: Candidate) -> Candidate:
    """The best motion of the valley in which one without a reversal lies, or the motion itself where none is better.

    Args:
        order: of the hole that is drilled.
        motion: two straight legs that keep the motion threshold at every point.
    """
    if motion.profile.psi.size > 3:
        return motion
    robot, settings, branch = order.robot, order.settings, motion.branch
    plane = twist_plane(robot, order.tool, order.hole)
    _, theta_psi = joint_rates(robot, order.tool, order.hole, 0.0, motion.psi_target)
    sense = np.where(theta_psi[branch - branch % 2] > 0, 1.0, -1.0)
    slopes = np.sort(motion.profile.twist_rate)[::-1]
    psi = motion.psi_target + motion.depth * slopes[:, None] * np.array([[0.0, 1.0]])
    legs, limits = Legs(np.array([[0.0, motion.depth]] * 2), psi), robot.limits
    best = motion
    for guard in GUARDS:
        rules = Rules(
            limits.lower + LIMIT_SLACK, limits.upper - LIMIT_SLACK, max(settings.min_rate, LEAST_RATE) + guard,
            settings.max_twist if settings.legs == "free" else np.inf, settings.psi_bound or 0.0,
        )  # fmt: skip
        lower, lack = bettered(robot.arm, plane, branch, sense, rules, legs, settings.objective, looks=POINTS)
        found = (
            order.candidate(motion_of(lower, periodic=settings.psi_bound is None), branch)
            if lack <= ENOUGH_LACK
            else None
        )
        if found is not None and found.reversals == 0 and found.keeps_threshold:
            best = min(best, found, key=order.rank)
            break
    return best
