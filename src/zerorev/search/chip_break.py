"""Motions that draw the drill back on the way in, to break the chips, without a reversal.

Where the tool draws back each joint has to move the other way, seen outwards, than on the plunge, or it turns round
twice: the slope of the way back has to lie on the other side of all critical rates that are there (theory §2), which is
an interval of slopes at every break. Of it the slope nearest to the retract's is taken, so that from break to break the
spin is shifted by little: by the difference to the plunge's slope times the way back.

The search is the one for straight legs, asked for more and more margin, each of its answers with the breaks put in, and
the best of these improved with the breaks in them: good motions, of which none is proven to be the best.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

import numpy as np

from zerorev.model.cycle import Cycle
from zerorev.model.profile import Profile
from zerorev.model.settings import Settings
from zerorev.motion.drilling import Drilling
from zerorev.search.broken_legs import CLEAN, GUARDS, BrokenLegs, Numbers
from zerorev.search.optimum import best_motion, on_each_branch
from zerorev.search.rank import Candidate, Order

__all__ = ["chip_breaking", "quickly", "straight_motions", "with_breaks"]

MARGINS = (0.0, 0.02, 0.05, 0.1, 0.2, 0.4, 0.8, 1.5, 3.0)  # beyond the motion threshold, as shares of it
LEAST = float(np.deg2rad(2.0))  # [rad/m] of which they are shares where there is no threshold: 0.002 deg/mm
IMPROVED = 3  # motions that are improved with the breaks in them
ENOUGH = 1e-6  # relative: a smaller gain does not count


def chip_breaking(
    drilling: Drilling, settings: Settings, cycle: Cycle, known: Iterable[Candidate] = ()
) -> list[Candidate]:
    """Motions of straight legs that break chips, the best first; empty where none can be run.

    Args:
        drilling: what is drilled.
        settings: by which they are ranked.
        cycle: how often and how far the tool draws back.
        known: motions that break chips, found otherwise.
    """
    order = Order(drilling, settings)
    found = [*known, *_broken(order, cycle, straight_motions(drilling, settings))]
    best = sorted(found, key=order.rank)[:IMPROVED]
    return sorted([*found, *(better for one in best for better in _improved(order, cycle, one))], key=order.rank)


def quickly(drilling: Drilling, settings: Settings, cycle: Cycle, known: Iterable[Candidate] = ()) -> Candidate | None:
    """A motion that breaks chips, for a map: the best one without breaks, both ways, improved with the breaks put in.

    Args:
        drilling: what is drilled.
        settings: by which motions are ranked.
        cycle: how often and how far the tool draws back.
        known: see `chip_breaking`.
    """
    order = Order(drilling, settings)
    plain = best_motion(drilling, replace(settings, legs="straight", proof_boxes=0))
    ways = [] if plain is None else [plain, order.candidate(plain.profile.reversed(), plain.branch)]
    found = [*known, *_broken(order, cycle, [way for way in ways if way is not None])]
    return order.best([*found, *(better for one in found for better in _improved(order, cycle, one))])


def with_breaks(drilling: Drilling, settings: Settings, profile: Profile, branch: int, cycle: Cycle) -> Profile:
    """A motion of two straight legs with the breaks of the chips put in; corner and retract stay as they are.

    Args:
        drilling: robot, tool and hole.
        settings: with the motion threshold, the greatest twist, and the stand-off of the corner.
        profile: of three breakpoints.
        branch: 0..7.
        cycle: how often and how far the tool draws back.
    """
    return BrokenLegs.at(drilling, settings, branch, cycle, float(profile.standoff[0])).motion(Numbers.of(profile))


def _broken(order: Order, cycle: Cycle, motions: Iterable[Candidate]) -> Iterator[Candidate]:
    """Motions with the breaks put in, as far as they can be run."""
    bound = order.settings.psi_bound
    for one in motions:
        profile = with_breaks(order.drilling, order.settings, one.profile, one.branch, cycle)
        found = order.candidate(profile, one.branch)
        if found is not None and (bound is None or np.abs(profile.psi).max() <= bound):
            yield found


def _improved(order: Order, cycle: Cycle, motion: Candidate) -> Iterator[Candidate]:
    """What a motion becomes in small steps, its depth kept: of less travel, or of more margin where that is asked."""
    settings, start = order.settings, Numbers.of(motion.profile)
    legs = BrokenLegs.at(order.drilling, settings, motion.branch, cycle, motion.depth)
    unit = settings.min_rate or LEAST
    for guard in (*GUARDS, *(unit * margin for margin in MARGINS[1:] if settings.objective == "margin")):
        guarded = replace(legs, guard=guard)
        numbers, lack = guarded.improved(start, "travel", ENOUGH)
        if lack > CLEAN:
            break
        found = order.candidate(guarded.motion(numbers), motion.branch)
        if found is None:
            continue
        yield found
        if found.reversals == 0 and found.keeps_threshold:
            start = numbers
            if settings.objective != "margin":
                break


def straight_motions(drilling: Drilling, settings: Settings) -> Iterator[Candidate]:
    """Good motions of straight legs, those of more margin and of every branch among them.

    Args:
        drilling: what is drilled.
        settings: by which they are sought.
    """
    plain = replace(settings, legs="straight", proof_boxes=0)
    unit = settings.min_rate or LEAST
    for margin in MARGINS:
        asked = replace(plain, min_rate=settings.min_rate + margin * unit)
        motion = best_motion(drilling, asked)
        if motion is not None:
            yield motion
        yield from on_each_branch(drilling, asked)
