"""Of motions that cost the same the one that its gears disturb least: itself, its twin, both on the other wrist flip.

The mirror law gives a motion run backwards the same reversals, travel and critical rates (theory §2.1), but every joint
then moves the other way against its load, so that gears cross to their other flank elsewhere, or not at all.
"""

from __future__ import annotations

import numpy as np

from zerorev.collision.arms import setting_of
from zerorev.model.settings import Settings
from zerorev.motion.drilling import Drilling
from zerorev.motion.loads import lost_motion
from zerorev.program.lead_in import find_lead_in
from zerorev.search.rank import Candidate, Order

__all__ = ["gentlest_first", "led_in"]

SAME_COST = 1e-9  # relative
WORTH = 1e-7  # [m] by which the predicted lost motion has to be less
WORTH_A_FLIP = 10e-6  # [m] likewise on the other wrist flip: from hole to hole the wrist is to turn over seldom
SAME_LENGTH = 1e-9  # [m]


def gentlest_first(drilling: Drilling, settings: Settings, motion: Candidate) -> tuple[Candidate, ...]:
    """One of a motion's likes with less predicted lost motion at the tip, where there is one, and the motion itself.

    One that costs more, or of which less of the lead-in runs, is not taken. For a robot without dynamics there is none.

    Args:
        drilling: what is drilled.
        settings: by which motions are ranked.
        motion: counted from the hole's own target.
    """
    branch = motion.branch
    now = lost_motion(drilling, motion.profile, branch, settings.thrust)
    if now is None:
        return (motion,)
    twin = motion.profile.reversed()
    likes = [(twin, branch, 0.0)]
    if drilling.hole.branch is None:
        likes += [(profile, branch ^ 1, WORTH_A_FLIP) for profile in (motion.profile, twin)]
    judged = []
    for k, (profile, other, worth) in enumerate(likes):
        lost = lost_motion(drilling, profile, other, settings.thrust)
        judged.append((np.inf if lost is None else lost + worth, k))
    order = Order(drilling.without_motion(), settings)
    for lost, k in sorted(judged):
        if lost > now - WORTH:
            break
        found = order.candidate(*likes[k][:2])
        if (
            found is not None
            and _as_good(order, found, motion)
            and led_in(drilling, settings, found) >= led_in(drilling, settings, motion)
        ):
            return found, motion
    return (motion,)


def _as_good(order: Order, one: Candidate, other: Candidate) -> bool:
    mine, best = order.rank(one), order.rank(other)
    return mine[:2] <= best[:2] and mine.cost <= best.cost + SAME_COST * abs(best.cost)


def led_in(drilling: Drilling, settings: Settings, motion: Candidate) -> float:
    """How much of the lead-in of a motion runs [m], rounded so that twins compare."""
    assert motion.evaluation.motion is not None
    setting = setting_of(drilling.robot, drilling.tool, settings)
    length = find_lead_in(drilling, motion.evaluation.motion, settings.lead_in, setting).length
    return round(length / SAME_LENGTH) * SAME_LENGTH
