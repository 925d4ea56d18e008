"""The quantities that maps compute. To add one: state it here, with the function that finds it in one cell."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from zerorev.model.hole import Hole
from zerorev.model.map_task import Question
from zerorev.model.profile import Profile
from zerorev.model.quantity import Found, Quantity
from zerorev.motion.drilling import Drilling
from zerorev.search.cycles import best_in_cycle, deepest_in_cycle
from zerorev.search.prediction import narrowest
from zerorev.search.rank import Candidate

__all__ = ["QUANTITIES", "stroke_found"]


def stroke_found(depth: float, profile: Profile | None, branch: int | None) -> Found | None:
    """A deepest stroke as the answer of a cell; None where no motion reaches it.

    Args:
        depth: [m].
        profile: the motion that reaches it, or None.
        branch: 0..7, or None.
    """
    if profile is None or branch is None:
        return None
    return Found(depth * 1e3, branch, profile, float(profile.psi[profile.corner]))


def _deepest(question: Question, hole: Hole, _: int) -> Found | None:
    found = deepest_in_cycle(Drilling.of(question, hole), question.settings.without_proof)
    return stroke_found(found.depth, found.profile, found.branch)


def _fewest_reversals(question: Question, hole: Hole, _: int) -> Found | None:
    best = _best_motion(question, hole)
    return None if best is None else _motion(float(best.reversals), best)


def _least_travel(question: Question, hole: Hole, _: int) -> Found | None:
    best = _best_motion(question, hole)
    if best is None or best.reversals > 0 or not best.keeps_threshold:
        return None
    return _motion(float(np.rad2deg(best.score.travel)), best)


def _greatest_margin(question: Question, hole: Hole, _: int) -> Found | None:
    margin = replace(question, settings=replace(question.settings, objective="margin"))
    best = _best_motion(margin, hole)
    if best is None or best.reversals > 0:
        return None
    return _motion(float(np.rad2deg(best.score.min_rate.min())) / 1e3, best)


def _twist_spread(question: Question, hole: Hole, _: int) -> Found | None:
    cheapest = narrowest(Drilling.of(question, hole), question.settings)
    if not np.isfinite(cheapest.width):
        return None
    return Found(float(np.rad2deg(cheapest.spread)) / 1e3, cheapest.branch, None, cheapest.psi)


def _best_motion(question: Question, hole: Hole) -> Candidate | None:
    return best_in_cycle(Drilling.of(question, hole), question.settings.without_proof)


def _motion(value: float, best: Candidate) -> Found:
    return Found(value, best.branch, best.profile, best.psi_target)


QUANTITIES = (
    Quantity(
        "deepest",
        "deepest_mm",
        "mm",
        title="deepest stroke with zero reversals",
        digits=1,
        more_is_better=True,
        nothing=0.0,
        solve=_deepest,
    ),
    Quantity(
        "fewest_reversals",
        "reversals",
        "1",
        title="fewest reversals",
        digits=0,
        more_is_better=False,
        needs_depth=True,
        solve=_fewest_reversals,
    ),
    Quantity(
        "least_travel",
        "travel_deg",
        "deg",
        title="least travel of all joints with zero reversals",
        digits=1,
        more_is_better=False,
        needs_depth=True,
        solve=_least_travel,
    ),
    Quantity(
        "greatest_margin",
        "margin_deg_per_mm",
        "deg/mm",
        title="greatest margin (slowest joint) with zero reversals",
        digits=4,
        more_is_better=True,
        needs_depth=True,
        solve=_greatest_margin,
    ),
    Quantity(
        "twist_spread",
        "twist_spread_deg_per_mm",
        "deg/mm",
        title="least twist spread at the target",
        digits=3,
        more_is_better=False,
        free_legs=False,
        cycles=False,
        solve=_twist_spread,
    ),
)
