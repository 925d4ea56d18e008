"""Curves of the twist plane on which the load of a joint changes its sign, without a reversal (theory §9)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from contourpy import contour_generator

from zerorev.model._arrays import Array
from zerorev.model.profile import Profile
from zerorev.motion.drilling import Drilling
from zerorev.motion.joint_path import sample_distances
from zerorev.motion.loads import LEVELS, gears_of, held_at, loads

__all__ = ["LoadLine", "Senses", "load_lines", "senses"]

Leg = Literal["plunge", "retract"]
LEGS: tuple[Leg, Leg] = ("plunge", "retract")
Senses = dict[Leg, tuple[tuple[int, ...], ...]]
SAMPLES = 100  # of a motion


@dataclass(frozen=True)
class LoadLine:
    """A curve on which the load of a joint is zero while it turns one way: the gear crosses to its other flank there.

    Attributes:
        joint: 1 to 6.
        sense: which way the joint turns, -1 or 1.
        level: share of the nominal dry friction that lies behind the gear.
        legs: of which legs it is: both are alike without thrust.
        points: stand-off [m] and spin [rad], shape (n, 2).
    """

    joint: int
    sense: int
    level: float
    legs: tuple[Leg, ...]
    points: Array


def load_lines(
    drilling: Drilling, branch: int, standoff: Array, psi: Array, thrust: float = 0.0
) -> tuple[LoadLine, ...]:
    """The curves of one branch in a patch of the twist plane; none for a robot without dynamics.

    Args:
        drilling: whose twist plane it is.
        branch: 0..7.
        standoff: of the patch [m], shape (S,).
        psi: of the patch [rad], shape (P,).
        thrust: of the drill while it plunges [N].
    """
    dynamics = drilling.robot.dynamics
    if dynamics is None:
        return ()
    friction = gears_of(dynamics.payload).friction
    sides = (((LEGS), 0.0),) if thrust == 0 else ((LEGS[:1], thrust), (LEGS[1:], 0.0))
    found = []
    for legs, push in sides:
        s, p = np.meshgrid(standoff, psi, indexing="ij")
        held = held_at(drilling, branch, s.ravel(), p.ravel(), push).reshape(*s.shape, 6)
        for i in range(6):
            contours = contour_generator(psi, standoff, np.ma.masked_invalid(held[..., i]))
            for level, share in zip(friction[:, i].tolist(), LEVELS, strict=True):
                for sense in (-1, 1):
                    found += [
                        LoadLine(i + 1, sense, share, legs, np.asarray(points)[:, ::-1])
                        for points in contours.lines(-sense * level)
                    ]
    return tuple(found)


def senses(drilling: Drilling, profile: Profile, branch: int) -> Senses:
    """Which ways each joint turns on each leg, in a tuple a joint.

    Args:
        drilling: of a robot with dynamics.
        profile: the spin along the path.
        branch: 0..7.
    """
    distance = sample_distances(profile, SAMPLES)
    turn = profile.distance[profile.corner]
    found: Senses = {}
    for leg, there in zip(LEGS, (distance <= turn, distance >= turn), strict=True):
        _, _, sense = loads(drilling, profile, branch, distance[there], np.full(int(there.sum()), leg == "retract"))
        found[leg] = tuple(tuple(way for way in (-1, 1) if (sense[:, i] == way).any()) for i in range(6))
    return found
