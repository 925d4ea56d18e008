"""What two legs of boxes cost and travel at least, in ball arithmetic (theory §8.4).

A pair is weighed as it is, and with the conditions that its node names: the travel less multiples of what rates have
above the least that they must have. For legs that keep those conditions that is no more than their travel, for any
multiples that are not negative.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from flint import arb

from zerorev.model.proof_tree import PER_REVERSAL
from zerorev.verify.optimality.box import AROUND, SIX
from zerorev.verify.optimality.legs import BoxLegs
from zerorev.verify.optimality.travel import Turns

__all__ = ["Term", "Weights", "least_value", "weights_of"]


class Term(NamedTuple):
    """A condition on a rate, with its multiplier.

    Attributes:
        leg: of the motion, 0 or 1.
        joint: 0..5.
        share: where on the leg, of the depth.
        direction: of the joint on that leg.
        multiplier: [m], more than 0.
    """

    leg: int
    joint: int
    share: float
    direction: float
    multiplier: float


class Weights(NamedTuple):
    """The conditions that pairs are weighed with.

    Attributes:
        terms: some, or none.
        of_travel: whether they are added to the travel; else they contradict each other.
    """

    terms: tuple[Term, ...] = ()
    of_travel: bool = True


def weights_of(terms: np.ndarray, of_travel: bool) -> Weights:
    """What a tree has for a node, shape (T, 5); multipliers that are not positive, or not numbers, are none."""
    rows = [row for row in terms.tolist() if np.isfinite(row).all() and row[4] > 0]
    sound = [row for row in rows if row[0] in (0, 1) and row[1] in SIX and 0 <= row[2] <= 1 and row[3] in (-1, 1)]
    return Weights(tuple(Term(int(leg), int(joint), *rest) for leg, joint, *rest in sound), of_travel)


def least_value(one: BoxLegs, other: BoxLegs, weights: Weights) -> arb | None:
    """A lower bound of what any two legs of two boxes cost and travel; None where no two keep the rules."""
    if one.dead is not None or other.dead is not None:
        return None
    of, claim = one.of, one.of.claim
    turns = _turns(one, other)
    cost = of.cost(turns)
    if cost > claim.most_cost + 1e-9 or not any(_meet(one.turns[flip], other.turns[flip]) for flip in of.flips):
        return None
    by_slope = (one.by_slope * one.extent.d_slope).abs_upper() + (other.by_slope * other.extent.d_slope).abs_upper()
    varies = (one.by_psi + other.by_psi).abs_upper() * _half(one) + by_slope
    travel = (one.least + other.least - varies).max(one.twist + other.twist)
    costs = arb(PER_REVERSAL) * arb(cost)
    one_more = cost + min(of.weights)
    if weights.terms and (one_more > claim.most_cost + 1e-9 or arb(PER_REVERSAL) * arb(one_more) >= claim.value):
        # a motion that reverses one joint more is not below the value, and where none does the terms may hold
        for first, second in ((one, other), (other, one)):
            if _hold(weights, turns, first, second):
                weighed = _weighed(weights, first, second)
                if not weights.of_travel and weighed > 0:
                    return None
                travel = travel.max(weighed) if weights.of_travel else travel
    return travel + costs


def _half(legs: BoxLegs) -> arb:
    box = legs.box
    return (arb(box.high) - arb(box.low)) / 2 + AROUND


def _hold(weights: Weights, turns: list[int], first: BoxLegs, second: BoxLegs) -> bool:
    """Whether each joint of the terms goes as these say on all motions of two boxes that do not reverse it."""
    for term in weights.terms:
        i, forth = term.joint, (term.direction > 0) == (term.leg == 0)  # forth: on the first leg; it comes back then
        (goes_forth, goes_back), (comes_forth, comes_back) = first.may[i], second.may[i]
        if turns[i] or ((goes_back and comes_forth) if forth else (goes_forth and comes_back)):
            return False
    return True


def _weighed(weights: Weights, first: BoxLegs, second: BoxLegs) -> arb:
    """The travel of two legs, if it counts, less the weighted conditions."""
    legs = first, second
    least, by_psi, by_slope = arb(0), arb(0), [arb(0), arb(0)]
    if weights.of_travel:
        least, by_psi = first.least + second.least, first.by_psi + second.by_psi
        by_slope = [first.by_slope, second.by_slope]
    for term in weights.terms:
        condition = legs[term.leg].condition(term.joint, term.share, term.direction)
        if condition is None:
            return arb.neg_inf()
        least -= term.multiplier * condition[0]
        by_psi -= term.multiplier * condition[1]
        by_slope[term.leg] -= term.multiplier * condition[2]
    varies = sum(((slope * leg.extent.d_slope).abs_upper() for slope, leg in zip(by_slope, legs, strict=True)), arb(0))
    return arb((least - by_psi.abs_upper() * _half(first) - varies).lower())


def _turns(one: BoxLegs, other: BoxLegs) -> list[int]:
    """Least reversals of each joint on a motion of two legs."""
    turns = []
    for i in SIX:
        across = min(one.forth[i] + other.back[i], one.back[i] + other.forth[i])
        n = min(across, 1 + min(one.forth[i] + other.forth[i], one.back[i] + other.back[i]))
        (forth, back), (forth_2, back_2) = one.may[i], other.may[i]
        turns.append(n or int(not ((forth and back_2) or (back and forth_2))))
    return turns


def _meet(one: Turns, other: Turns) -> bool:
    """Whether each joint has a turn that both legs allow."""
    return all(max(a[0], b[0]) <= min(a[1], b[1]) for a, b in zip(one, other, strict=True))
