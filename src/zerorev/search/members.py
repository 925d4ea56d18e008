"""The good motions of one hole, among which a sequence of holes may choose: one per branch, with their mirror twins.

They have as few reversals as the best motion and lack no more of the motion threshold; what they cost beyond it is left
to who chooses (`zerorev.planning.sequence`).
"""

from __future__ import annotations

import numpy as np

from zerorev.model.job import Settings
from zerorev.motion.drilling import Drilling
from zerorev.motion.loads import lost_motion
from zerorev.search.clear import keeps_clear
from zerorev.search.optimum import on_each_branch
from zerorev.search.rank import Candidate, Order
from zerorev.search.twins import led_in

__all__ = ["members"]

HARSHER = 10e-6  # [m] of predicted lost motion by which one of two twins is left out


def members(drilling: Drilling, settings: Settings, best: Candidate) -> tuple[Candidate, ...]:
    """The good motions of a hole, the best one first.

    Where joints reverse, the best motion on the other wrist flip and the twins are all that is offered.

    Args:
        drilling: what is drilled; its `branch`, if any, is the only one searched.
        settings: by which motions are ranked.
        best: of the hole, counted from its own target.
    """
    order = Order(drilling.without_motion(), settings)
    as_good = order.rank(best)[:2]
    found = [best]
    if drilling.hole.branch is None:
        flipped = order.candidate(best.profile, best.branch ^ 1)
        found += [] if flipped is None else [flipped]
        found += on_each_branch(drilling, settings) if best.reversals == 0 else []
    of_branches = {best.branch: best}
    for one in sorted(found, key=order.rank):
        if order.rank(one)[:2] <= as_good:
            of_branches.setdefault(one.branch, one)
    kept = [best]
    for one in of_branches.values():
        twin = order.candidate(one.profile.reversed(), one.branch)
        pair = [one] if twin is None or order.rank(twin)[:2] > as_good else [one, twin]
        kept += [each for each in _gentle(drilling, settings, pair) if each is not best]
    return tuple(one for one in kept if one is best or keeps_clear(drilling, settings, one))


def _gentle(drilling: Drilling, settings: Settings, pair: list[Candidate]) -> list[Candidate]:
    """Those of a motion and its twin that lead in as far as the other and lose hardly more motion in the gears."""
    if len(pair) == 1:
        return pair
    lengths = [led_in(drilling, settings, each) for each in pair]
    lost = [lost_motion(drilling, each.profile, each.branch, settings.thrust) for each in pair]
    losses = np.array([0.0 if each is None else each for each in lost])
    fits = losses <= losses.min() + HARSHER
    return [each for each, fit, length in zip(pair, fits, lengths, strict=True) if fit and length == max(lengths)] or [
        pair[0]
    ]
