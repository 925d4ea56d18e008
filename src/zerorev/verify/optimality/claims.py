"""What a plan states of its optimality, and the logged trees that it follows from (theory §8.4)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from zerorev.model.hole import Hole
from zerorev.model.job import Settings
from zerorev.model.plan import HolePlan
from zerorev.model.proof_tree import NO_VALUE, PER_REVERSAL, Claim, ProofTree

__all__ = ["Statement", "down_to_the_corner", "statements"]

SAME = 1e-9  # relative: more than the digits of a plan file leave out


class Statement(NamedTuple):
    """One statement of a plan.

    Attributes:
        field: of the plan file.
        words: what it says.
        trees: those that prove it, if they are right; the first suffices.
    """

    field: str
    words: str
    trees: tuple[ProofTree, ...]


def down_to_the_corner(hole: Hole, settings: Settings) -> Hole:
    """The hole that the legs drill, down to the programmed corner; its depth is that of the legs."""
    corner = settings.of(hole).corner_standoff
    return replace(hole, target=hole.target - corner * hole.direction, depth=hole.depth - corner, profile=None)


def statements(stated: HolePlan, settings: Settings, trees: Sequence[ProofTree]) -> Iterator[Statement]:
    """All that a hole states of its optimality and that is proven by a tree: nothing where legs are free.

    Args:
        stated: the hole's answer.
        settings: as planned.
        trees: of the hole down to the programmed corner.
    """
    if settings.legs == "free":
        return
    settings = settings.of(stated.hole)
    rules = _Rules(stated, settings)
    at_most = stated.deepest_at_most
    if at_most is not None:
        yield Statement(
            "deepest_at_most_mm",
            f"no stroke of {at_most * 1e3:.6g} mm has no reversal",
            tuple(tree for tree in trees if rules.exclude(tree.claim, 0.0, settings.min_rate, at_most, deeper=True)),
        )
    optimality = stated.optimality
    if optimality is None:
        return
    fewest, travel, depth = optimality.reversals_at_least, optimality.travel_at_least, stated.hole.depth
    least = settings.min_rate if settings.min_rate_rule == "pointwise" else 0.0
    if fewest > 0:
        yield Statement(
            "optimality.reversals_at_least",
            f"no motion has fewer reversals than {fewest:g}" if stated.motion else "no motion exists",
            tuple(tree for tree in trees if rules.bound(tree.claim, fewest, 0.0, 0.0, depth)),
        )
    if stated.score is None:
        return
    cost = float(np.dot(settings.reversal_weights, stated.score.reversals_per_joint))
    if travel is not None:
        yield Statement(
            "optimality.travel_at_least_deg",
            f"none with so few travels less than {np.rad2deg(travel):.4f} deg",
            tuple(tree for tree in trees if rules.bound(tree.claim, cost, travel, least, depth)),
        )
    elif optimality.proven and settings.objective == "travel" and not settings.weights:
        yield Statement(
            "optimality.proven",
            "none with so few keeps the motion threshold",
            tuple(tree for tree in trees if rules.exclude(tree.claim, cost, least, depth)),
        )


class _Rules:
    """What a claim must be about."""

    def __init__(self, stated: HolePlan, settings: Settings) -> None:
        self.hole, self.settings = stated.hole, settings
        self.weights = np.array(settings.reversal_weights, dtype=float)

    def bound(self, claim: Claim, cost: float, travel: float, min_rate: float, depth: float) -> bool:
        """Whether a claim says that a motion has at least so many reversals, and with so many this travel."""
        if not self.alike(claim, min_rate, depth, deeper=False):
            return False
        scale = self.scale(claim)
        if claim.most_cost < cost * scale * (1 - SAME):
            return False
        return claim.value >= PER_REVERSAL * cost * scale + travel * (1 - SAME) - SAME

    def exclude(self, claim: Claim, cost: float, min_rate: float, depth: float, *, deeper: bool = False) -> bool:
        """Whether a claim says that no motion has at most so many reversals."""
        none = claim.value >= NO_VALUE and claim.most_cost >= cost * self.scale(claim) * (1 - SAME)
        return none and self.alike(claim, min_rate, depth, deeper=deeper)

    def alike(self, claim: Claim, min_rate: float, depth: float, *, deeper: bool) -> bool:
        """Whether a claim is about the motions that are meant; with `deeper` one about a lesser depth suffices."""
        legs = depth - self.settings.corner_standoff
        deep = claim.depth <= legs * (1 + SAME) and (deeper or claim.depth >= legs * (1 - SAME))
        bound = self.settings.psi_bound or 0.0
        weights = claim.weights * self.weights.sum()
        same = np.allclose(weights, self.weights * claim.weights.sum(), rtol=SAME, atol=0)
        alike = claim.psi_bound == bound and claim.branch == self.hole.branch and same
        alike = alike and claim.limit_margin <= self.settings.limit_margin
        return bool(deep and alike and claim.min_rate <= min_rate)

    def scale(self, claim: Claim) -> float:
        """What a claim multiplies the weights by."""
        return float(claim.weights.sum() / self.weights.sum())
