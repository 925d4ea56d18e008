"""Motions made of a known one by small steps.

A deeper one is cut to a lesser depth, which keeps every direction; two legs are moved to the greatest margin near them,
or a motion without a reversal down to the bottom of its valley.
"""

from __future__ import annotations

import numpy as np

from zerorev.model._arrays import Array
from zerorev.model.profile import Profile
from zerorev.search.rank import Candidate, Order
from zerorev.search.segments import Goal, SegmentedLegs, improved, motion_of, sense_at
from zerorev.search.straight import LEAST_RATE, constraints

__all__ = ["cut_short", "descended", "eased", "steadied"]

POINTS = 33  # of a leg at which the joints are examined
SAME_MARGIN = 1e-6  # relative
ENOUGH_LACK = 1e-6  # [rad/m]
ENOUGH_BOUND = 1e-9  # relative, of the bound on the spin
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


def descended(order: Order, motion: Candidate) -> Candidate:
    """The best motion of the valley in which one without a reversal lies, or the motion itself where none is better.

    Args:
        order: of the hole that is drilled.
        motion: two straight legs that keep the motion threshold at every point.
    """
    if motion.profile.psi.size > 3:
        return motion
    for guard in GUARDS:
        min_rate = max(order.settings.min_rate, LEAST_RATE) + guard
        found = _moved(order, motion.branch, motion.psi_target, motion.profile.twist_rate, min_rate, goal=None)
        if found is not None and found.reversals == 0 and found.keeps_threshold:
            return min(motion, found, key=order.rank)
    return motion


def eased(order: Order, motion: Candidate) -> Candidate:
    """The best motion of about the same margin near one below the threshold, or that itself where none is better.

    One leg may decide the margin: the other then has a choice that a search for the greatest margin leaves open.

    Args:
        order: of the hole that is drilled.
        motion: of straight legs, without a reversal.
    """
    least = order.margin(motion) * (1 - SAME_MARGIN)
    if motion.profile.psi.size > 3 or motion.reversals or least <= LEAST_RATE:
        return motion
    found = _moved(order, motion.branch, motion.psi_target, motion.profile.twist_rate, least, goal=None)
    return motion if found is None or found.reversals else min(motion, found, key=order.rank)


def steadied(order: Order, branch: int, psi_t: float, slopes: Array, min_rate: float) -> Candidate | None:
    """The motion of the greatest margin near two straight legs, which may break any rule.

    Args:
        order: of the hole that is drilled.
        branch: 0..7.
        psi_t: spin at the target [rad].
        slopes: twist rates of the legs, in any order [rad/m], shape (2,).
        min_rate: that the margin has to reach [rad/m].

    Returns:
        a motion without a reversal, or None where small steps lead to none.
    """
    found = _moved(order, branch, psi_t, slopes, min_rate, goal="margin")
    return found if found is not None and found.reversals == 0 else None


def _moved(
    order: Order, branch: int, psi_t: float, slopes: Array, min_rate: float, goal: Goal | None
) -> Candidate | None:
    """Two straight legs, improved by small steps; the goal is that of the settings, where none is given."""
    robot, settings, depth = order.drilling.robot, order.settings, order.drilling.hole.depth
    plane = order.drilling.plane
    sense = sense_at(robot.arm, plane, branch // 2, psi_t)
    if sense is None:
        return None
    psi = psi_t + depth * np.sort(slopes)[::-1, None] * np.array([[0.0, 1.0]])
    legs = SegmentedLegs(np.array([[0.0, depth]] * 2), psi)
    steepest = settings.max_twist if settings.legs == "free" else np.inf
    rules = constraints(order.drilling, settings, min_rate, steepest=steepest)
    moved, lack = improved(robot.arm, plane, branch, sense, rules, legs, goal or settings.objective, samples=POINTS)
    if lack > ENOUGH_LACK:
        return None
    profile, bound = motion_of(moved, periodic=settings.psi_bound is None), settings.psi_bound
    if bound is not None and np.abs(profile.psi).max() > bound * (1 + ENOUGH_BOUND):
        return None  # what the steps set out from was beyond the bound, and they have not brought it back
    return order.candidate(profile, branch)
