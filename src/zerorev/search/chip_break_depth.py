"""The deepest stroke that breaks chips and has no reversal, as far as it is found.

The deepest stroke without a break is where the search begins, both ways, since a motion that breaks chips is not as
good run backwards. Each break spins the tool further, so strokes with breaks are mostly less deep; how much so depends
on how many there are, and how many there are on the depth. What is found is a lower bound: nothing proves that there is
no deeper one, and the bound on straight legs does not hold for a plunge that breaks chips, which is none.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from zerorev.model.cycle import Cycle
from zerorev.model.profile import Profile
from zerorev.model.settings import Settings
from zerorev.motion.drilling import Drilling
from zerorev.motion.evaluation import evaluated
from zerorev.program.lead_in import find_lead_in
from zerorev.search.broken_legs import CLEAN, GUARDS, BrokenLegs, Numbers
from zerorev.search.deepest import Deepest

__all__ = ["deepest_breaking", "made_shallower", "runs"]

KEPT_BACK = (1e-5, 1e-3, 1e-2)  # of the deepest: there a joint just keeps the threshold
MOST_COUNTS = 12  # numbers of breaks that are tried
SHORTER = 0.8  # of the deepest plain stroke: where breaks are put in first
NEARLY = 0.9  # of the deepest found: what is less deep with breaks spread evenly is left
EVENLY = 6  # breaks that are spread evenly
SAME = 1e-6  # relative: depths that are one
ROUGH, ENOUGH = 1e-3, 1e-5  # relative: a smaller gain does not count


def deepest_breaking(drilling: Drilling, settings: Settings, cycle: Cycle, plain: Deepest) -> Deepest:
    """The deepest stroke that breaks chips and has no reversal, as far as it is found: at least so deep.

    Each way of the deepest plain motion is improved with the breaks in it, on both flips of the wrist.

    Args:
        drilling: where to drill; its depth does not matter.
        settings: of which every joint keeps `min_rate` at every point.
        cycle: how often and how far the tool draws back.
        plain: the deepest stroke without a break, counted from the hole's own target.
    """
    if plain.profile is None or plain.branch is None or plain.profile.psi.size > 3:
        return Deepest(0.0)
    starts = []
    for way in (plain.profile, plain.profile.reversed()):
        # the rates of both flips of the wrist are the same: only the limits tell them apart
        for branch in (plain.branch, plain.branch ^ 1):
            legs = BrokenLegs(drilling, settings, branch, cycle, EVENLY, evenly=True)
            start = Numbers.of(way)
            numbers, lack = legs.improved(start._replace(depth=SHORTER * start.depth), "depth", ROUGH)
            if lack < np.inf:
                starts.append((legs, numbers))
            if drilling.hole.branch is not None or (lack <= CLEAN and not legs.at_a_limit(numbers)):
                break
    best = Deepest(0.0)
    for legs, numbers in sorted(starts, key=lambda start: -start[1].depth):
        if numbers.depth > best.depth * NEARLY:
            found = _furthest(replace(legs, evenly=False), numbers, best.depth)
            best = best if found is None else _settled(*found, best)
    return best


def _settled(legs: BrokenLegs, numbers: Numbers, best: Deepest) -> Deepest:
    """The deepest motion next to one that is as deep as can be that has no reversal; `best`, if none is deeper."""
    for guard in GUARDS:
        if guard:
            numbers, lack = replace(legs, guard=guard, deepest=numbers.depth).improved(numbers, "depth", ENOUGH)
            if lack > CLEAN:
                continue
        for back in KEPT_BACK:
            depth = numbers.depth * (1 - back)
            if depth <= best.depth or len(legs.cycle.breaks(depth)) != legs.count:
                break
            profile = legs.motion(numbers._replace(depth=depth))
            if runs(legs.drilling, legs.settings, profile, legs.branch):
                return Deepest(depth, profile, legs.branch)
    return best


def _furthest(legs: BrokenLegs, numbers: Numbers, beaten: float) -> tuple[BrokenLegs, Numbers] | None:
    """With how many breaks motions get deepest, and the deepest of them; None where none is deeper than `beaten`.

    More breaks spin the tool further, so that a motion with more of them is less deep; and it has to be deep enough for
    so many.

    Args:
        legs: of any count.
        numbers: of a motion about as deep, from which to begin.
        beaten: [m].
    """
    cycle, peck = legs.cycle, legs.cycle.depth or np.inf
    count, best, tried = len(cycle.breaks(numbers.depth)), None, set[int]()
    while count >= 0 and count not in tried and len(tried) < MOST_COUNTS:
        tried.add(count)
        most = cycle.nearest + (count + 1) * peck
        legs = replace(legs, count=count, deepest=most)
        found, lack = legs.improved(numbers._replace(depth=min(numbers.depth, most)), "depth", ENOUGH)
        if lack == np.inf:
            break
        fits = len(cycle.breaks(found.depth))
        if lack <= CLEAN:
            numbers = found
            if fits == count and found.depth > (best[1].depth if best else beaten):
                best = legs, found
        if fits < count or lack > CLEAN:
            count -= 1
        elif found.depth >= most * (1 - SAME):
            count += 1
    return best


def runs(drilling: Drilling, settings: Settings, profile: Profile, branch: int) -> bool:
    """Whether a motion has no reversal, keeps the threshold at every point, and has the lead-in that is wanted.

    Args:
        drilling: robot, tool and hole, whose depth does not matter.
        settings: with the motion threshold, the bound on the spin, and the lead-in.
        profile: the motion.
        branch: 0..7.
    """
    deep = drilling.deep(float(profile.standoff[0]))
    seen = evaluated(deep, profile, branch, settings)
    if seen.score is None or seen.score.reversals or seen.score.min_rate.min() < settings.min_rate:
        return False
    if settings.psi_bound is not None and np.abs(profile.psi).max() > settings.psi_bound:
        return False
    assert seen.motion is not None
    wanted = settings.lead_in
    return not settings.keep_lead_in or find_lead_in(deep, seen.motion, wanted).length == wanted


def made_shallower(
    drilling: Drilling, settings: Settings, cycle: Cycle, motion: Deepest, depth: float
) -> tuple[Profile, int] | None:
    """The deepest motion with the breaks of a lesser depth, and its branch: it has not always no reversal.

    Args:
        drilling: robot, tool and hole.
        settings: as it was found.
        cycle: how often and how far the tool draws back.
        motion: the deepest stroke.
        depth: no greater [m].
    """
    if motion.profile is None or motion.branch is None:
        return None
    legs = BrokenLegs.at(drilling, settings, motion.branch, cycle, depth)
    return legs.motion(Numbers.of(motion.profile)._replace(depth=depth)), motion.branch
