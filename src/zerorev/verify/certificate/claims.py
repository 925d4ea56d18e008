"""What a plan claims of its motion, held against what is proven of it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from flint import arb

from zerorev.model._arrays import Array
from zerorev.model.plan import Score
from zerorev.verify.certificate.piece import NIL_RATE
from zerorev.verify.certificate.walk import TIGHT
from zerorev.verify.claims import JOINT_TOLERANCE, TRAVEL_TOLERANCE

__all__ = ["Proven", "claimed_reversals", "false_claims"]


class Proven(NamedTuple):
    """What is known of a motion; joints are counted from 0.

    Attributes:
        names: of the six joints.
        steady: the joints that keep one direction.
        knots: the six joints at the start, the corner and the end [rad].
        legs: length of the two legs [m].
        slowest: rates that are met on the legs, or a little more [rad/m], shape (6,).
        limit_distance: distances to a limit that are met, or a little more [rad], shape (6,).
    """

    names: tuple[str, ...]
    steady: set[int]
    knots: tuple[list[arb], list[arb], list[arb]]
    legs: tuple[float, float]
    slowest: Array
    limit_distance: Array


def claimed_reversals(score: Score) -> set[int]:
    """The joints that are claimed to reverse, from reversals or from their places."""
    return {i for i in range(6) if score.reversals_per_joint[i] != 0} | {event.joint - 1 for event in score.events}


def false_claims(score: Score, proven: Proven) -> Iterator[str]:
    """One sentence for each figure of a score that is better than it can be.

    Args:
        score: what is claimed.
        proven: what is known.
    """
    start, corner, end = proven.knots
    for joint in sorted(proven.steady):
        name, slowest = proven.names[joint], float(proven.slowest[joint])
        if (claimed := float(score.min_rate[joint])) > slowest * (1 + TIGHT) + NIL_RATE:
            yield f"{name} slows down to {_rate(slowest)}, the plan claims {_rate(claimed)}"
        moved = abs(corner[joint] - start[joint]), abs(end[joint] - corner[joint])
        mean = min(float(turn.upper()) / length for turn, length in zip(moved, proven.legs, strict=True))
        if (claimed := float(score.mean_rate[joint])) > mean * (1 + TIGHT) + NIL_RATE:
            yield f"{name} has a mean rate of {_rate(mean)} on a leg, the plan claims {_rate(claimed)}"
    for joint, name in enumerate(proven.names):
        room, claimed = float(proven.limit_distance[joint]), float(score.limit_distance[joint])
        if claimed > room + JOINT_TOLERANCE:
            yield f"{name} comes within {_deg(room)} of a limit, the plan claims {_deg(claimed)}"
    if len(proven.steady) == len(proven.names):
        travel = sum((abs(last - first) for first, last in zip(start, end, strict=True)), arb(0))
        if abs(travel - score.travel) > TRAVEL_TOLERANCE * max(score.travel, 1e-3):
            yield f"the joints travel {_deg(float(travel))}, the plan claims {_deg(score.travel)}"


def _rate(rate: float) -> str:
    return f"{np.rad2deg(rate) / 1e3:.6g} deg/mm"


def _deg(angle: float) -> str:
    return f"{np.rad2deg(angle):.8g} deg"
